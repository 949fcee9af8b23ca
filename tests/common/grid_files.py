"""grid_files.py - small grids of every kind as the text of a file: VTK XML, Plot3D"""
import itertools
import math

VTK_TYPES = {"u8": "UInt8", "i16": "Int16", "i32": "Int32", "f32": "Float32", "f64": "Float64"}
HEXAHEDRON_ORDER = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
HEXAHEDRON, TETRAHEDRON, TRIANGLE, WEDGE, POLYHEDRON = 12, 10, 5, 13, 42


def lattice(dims, first=(0, 0, 0)):
    """Points of integers, x fastest."""
    ranges = [range(first[axis], first[axis] + dims[axis]) for axis in (2, 1, 0)]
    return [(x, y, z) for z, y, x in itertools.product(*ranges)]


def hexahedra(dims):
    def number(x, y, z):
        return x + dims[0] * (y + dims[1] * z)
    return [[number(x + a, y + b, z + c) for a, b, c in HEXAHEDRON_ORDER]
            for x, y, z in lattice([n - 1 for n in dims])]


def bump(point):
    """Smooth, with no value that a small isovalue hits."""
    return 10 - math.dist(point, (4.3, 3.6, 4.1)) ** 2 + 0.37


def numbers(values):
    return " ".join(map(repr, values))


def data_array(name, kind, values, components=1):
    return (f'<DataArray type="{VTK_TYPES[kind]}" Name="{name}" NumberOfComponents="{components}" format="ascii">'
            f"{numbers(values)}</DataArray>")


def attributes(element, fields):
    return f"<{element}>{''.join(data_array(*field) for field in fields)}</{element}>"


def vtk_file(kind, body):
    return (f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="0.1" byte_order="LittleEndian">\n'
            f"<{kind}{body}</{kind}>\n</VTKFile>\n")


def vtu_text(points, cells, types, point_fields=(), cell_fields=(), faces=()):
    """faces: of each cell that is a polyhedron its faces, else None."""
    ends = list(itertools.accumulate(map(len, cells)))
    flat = list(itertools.chain(*points))
    joined = list(itertools.chain(*cells))
    cell_arrays = (data_array("connectivity", "i32", joined) + data_array("offsets", "i32", ends)
                   + data_array("types", "u8", types))
    if faces:
        streams = [[len(all_of)] + [n for face in all_of for n in [len(face), *face]] if all_of else []
                   for all_of in faces]
        stream_ends = itertools.accumulate(map(len, streams))
        cell_arrays += data_array("faces", "i32", list(itertools.chain(*streams)))
        cell_arrays += data_array("faceoffsets", "i32", [end if all_of else -1
                                                         for all_of, end in zip(faces, stream_ends)])
    return vtk_file("UnstructuredGrid", f'><Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}">'
                    f'{attributes("PointData", point_fields)}{attributes("CellData", cell_fields)}'
                    f'<Points>{data_array("Points", "f32", flat, 3)}</Points><Cells>{cell_arrays}</Cells></Piece>')


def structured_text(kind, dims, first, geometry, point_fields=(), cell_fields=(), more=""):
    extent = " ".join(f"{first[axis]} {first[axis] + dims[axis] - 1}" for axis in range(3))
    return vtk_file(kind, f' WholeExtent="{extent}"{more}><Piece Extent="{extent}">'
                    f'{attributes("PointData", point_fields)}{attributes("CellData", cell_fields)}{geometry}</Piece>')


def vti_text(dims, point_fields=(), cell_fields=(), first=(0, 0, 0)):
    return structured_text("ImageData", dims, first, "", point_fields, cell_fields,
                           ' Origin="0 0 0" Spacing="1 1 1"')


def vts_text(dims, points, point_fields=(), cell_fields=(), first=(0, 0, 0)):
    flat = list(itertools.chain(*points))
    return structured_text("StructuredGrid", dims, first, f"<Points>{data_array('Points', 'f32', flat, 3)}</Points>",
                           point_fields, cell_fields)


def plot3d_texts(blocks):
    """Grid and solution of blocks (dims, points, density): momentum-x is x, energy a constant."""
    head = f"{len(blocks)}\n" + "".join("{} {} {}\n".format(*dims) for dims, _, _ in blocks)
    grid, solution = head, head
    for _, points, density in blocks:
        for axis in range(3):
            grid += numbers(float(point[axis]) for point in points) + "\n"
        zeros = [0.0] * len(points)
        solution += "0.5 0.0 100.0 0.0\n"
        for values in (density, [float(point[0]) for point in points], zeros, zeros, [2.5] * len(points)):
            solution += numbers(values) + "\n"
    return grid, solution
