#!/usr/bin/env python3
"""test_cli_grids.py TOOL [reference] - the command line on grids beyond the uniform image

Writes small grids of every kind itself (Plot3D and VTK XML, as text) and runs extract, info and tetrahedralize on them:
the choice of a field, cells averaged, blocks joined or apart, missing data, fields carried, nothing left to contour.
With TETRACUBES_DATA set, every file there that is read opens with info, and published counts and ranges hold; those
checks are skipped where it is unset. With `reference` what needs an OpenCL device is left out. Standard library only.
"""
import array
import itertools
import json
import math
import os
import resource
import struct
import subprocess
import sys
import unittest

import test_cli

DATA = os.environ.get("TETRACUBES_DATA")
BLOCK_KEYS = {"kind", "points", "cells", "dims", "first", "cell_types", "bounds", "blanked_points", "blanked_cells",
              "fields"}
CONVERTED_KEYS = {"notices", "input", "output", "blocks", "points", "cells", "tetrahedra", "flat_cells", "curved_cells",
                  "blanked_cells", "inverted_cells", "folded_cells", "folded_faces", "unsupported_cells",
                  "surplus_cells", "fields", "total_ms"}
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


def plot3d_noise(block_count, size, path, density_path):
    """Grid and solution of cubes of size^3 points, in one file each, whose surfaces go through nearly all cells."""
    def record(file, content):
        mark = struct.pack("<i", len(content))
        file.write(mark + content + mark)
    places = lattice((size, size, size))
    head = struct.pack(f"<{3 * block_count}i", *[size] * 3 * block_count)
    density = array.array("f", [(n * 2654435761 >> 7) % 1000 / 1000 for n in range(len(places))]).tobytes()
    with open(path, "wb") as grid, open(density_path, "wb") as solution:
        for file in (grid, solution):
            record(file, struct.pack("<i", block_count))
            record(file, head)
        for block in range(block_count):
            shifts = (0, 0, block * size)
            record(grid, b"".join(array.array("f", [p[axis] + shifts[axis] for p in places]).tobytes()
                                  for axis in range(3)))
            record(solution, struct.pack("<4f", 0.5, 0, 100, 0))
            record(solution, density + bytes(4 * len(density)))


def peak_memory(*arguments):
    """(exit status, most resident bytes) of a run of the tool."""
    child = subprocess.Popen([test_cli.TOOL, *arguments], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    return child.returncode, 1024 * usage.ru_maxrss


def read_ply(path):
    """(rows of float properties by name, triangles) of a binary PLY file."""
    with open(path, "rb") as f:
        content = f.read()
    end = content.index(b"end_header\n") + len(b"end_header\n")
    lines = content[:end].decode().split("\n")
    counts = [int(line.split()[2]) for line in lines if line.startswith("element")]
    names = [line.split()[2] for line in lines if line.startswith("property float")]
    vertex = struct.Struct(f"<{len(names)}f")
    vertices = [dict(zip(names, vertex.unpack_from(content, end + n * vertex.size))) for n in range(counts[0])]
    at, faces = end + counts[0] * vertex.size, []
    for n in range(counts[1]):
        faces.append(struct.unpack_from("<3I", content, at + 13 * n + 1))
    return vertices, faces


class GridCase(test_cli.Case):
    def write(self, name, text):
        with open(self.path(name), "w") as f:
            f.write(text)
        return self.path(name)

    def write_plot3d(self, name, blocks):
        grid, solution = plot3d_texts(blocks)
        return [self.write(name + ".xyz", grid), self.write(name + ".q", solution)]

    def write_hexahedra(self, name, dims=(9, 8, 9), values=None, **more):
        points = lattice(dims)
        values = list(map(bump, points)) if values is None else values
        cells = hexahedra(dims)
        fields = [("bump", "f64", values), ("x", "f32", [float(p[0]) for p in points])]
        return self.write(name, vtu_text(points, cells, [HEXAHEDRON] * len(cells), fields, **more))

    def surface(self, *arguments, **how):
        """The report's one surface of extract --check, and on a device --verify."""
        verify = ["--verify"] if test_cli.HAS_DEVICE else ["--engine", "reference"]
        report = self.report("extract", *arguments, "--check", *verify, **how)
        self.assertEqual(set(report), test_cli.EXTRACT_KEYS)
        [surface] = report["surfaces"]
        return report, surface

    def needs_xml(self):
        if "VTK XML" not in self.expect(0, "--version").stdout:
            self.skipTest("built without VTK XML")


def counts(surface):
    return [surface[key] for key in ("vertices", "triangles", "boundary_edges", "euler_characteristic")]


class Usage(GridCase):
    def test_numbers_of_inputs(self):
        for command in (["extract", "--iso", "1"], ["info"], ["tetrahedralize", "-o", self.path("a.vtu")]):
            self.refuses(2, *command, "a.xyz", "b.q", "c.q", says="c.q")
            self.refuses(2, *command, "a.raw", "b.raw", "--dims", "2,2,2", "--type", "u8", says="b.raw")
            self.refuses(2, *command, "a.nrrd", "b.nrrd", says="b.nrrd")
            self.refuses(2, *command, "a.vtu", "b.vtu", says="b.vtu")
            self.refuses(2, *command, says="input")
            self.refuses(4, *command, self.path("none.xyz"), self.path("none.q"), says="none.xyz")

    def test_combinations(self):
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--carry", "a", says="-o FILE")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--blocks", "separate", says="-o FILE")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--blocks", "both", says="joined, separate")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--count", "--carry", "a", says="--count")
        for ending in ("stl", "obj"):
            self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--carry", "a", "-o", self.path(f"a.{ending}"),
                         says=ending)
        self.refuses(2, "tetrahedralize", "x.nrrd", says="-o FILE")
        self.refuses(2, "tetrahedralize", "x.nrrd", "-o", self.path("a.vtp"), says="vtu")

    def test_formats_that_are_not_read(self):
        for name, content, says in (("a.ex2", b"CDF\1", "Exodus"), ("a.h5", b"\x89HDF\r\n\x1a\n", "HDF5"),
                                    ("a.cgns", b"?", "CGNS"), ("a.obj", b"v 0 0 0", "surface"),
                                    ("a", b"?", "not known")):
            with open(self.path(name), "wb") as f:
                f.write(content)
            for command in (["info"], ["extract", "--iso", "1"]):
                result = self.refuses(4, *command, self.path(name), says=says)
                self.assertRegex(result.stderr, r"reads raw, NRRD.*Plot3D")


class Choice(GridCase):
    def setUp(self):
        super().setUp()
        dims = (6, 5, 4)
        points = lattice(dims)
        self.inputs = self.write_plot3d("a", [(dims, points, [float(p[0] + p[1]) for p in points])])

    def test_open_choice_lists_the_fields(self):
        for fields in ([], ["--field", "Density"]):
            result = self.refuses(2, "extract", *self.inputs, "--iso", "1.5", *fields)
            for name in ("density", "momentum-x", "momentum-z", "energy", "pressure"):
                self.assertIn(f"{name} (point)", result.stderr)
        self.refuses(2, "extract", *self.inputs, "--iso", "1.5", "--field", "density", "--component", "1",
                     says="--component 1")
        self.refuses(2, "extract", *self.inputs, "--iso", "1.5", "--field", "density", "--carry", "energy,none", "-o",
                     self.path("a.ply"), says="none")
        self.refuses(2, "extract", *self.inputs, "--iso", "1.5", "--field", "density", "--carry", "energy,energy", "-o",
                     self.path("a.ply"), says="twice")
        self.refuses(2, "info", *self.inputs, "--field", "no", says="density")

    def test_frames(self):
        self.needs_xml()
        image = self.write("f.vti", vti_text((2, 2, 2), [("f", "f32", [float(n) for n in range(8)])]))
        for inputs in (self.inputs, self.inputs[:1], [image]):
            self.refuses(2, "info", *inputs, "--frame", "1", says="has one frame; leave out --frame")
            self.expect(0, "info", *inputs, "--frame", "0")

    def test_output_is_an_input(self):
        os.rename(self.inputs[1], self.path("q.ply"))
        self.refuses(2, "extract", self.inputs[0], self.path("q.ply"), "--iso", "1", "--field", "density", "-o",
                     self.path("q.ply"), says="input itself")

    def test_components(self):
        self.needs_xml()
        points = lattice((4, 4, 4))
        vectors = [float(n) for p in points for n in p]
        volume = self.write("a.vti", vti_text((4, 4, 4), [("v", "f32", vectors, 3)]))
        self.refuses(2, "extract", volume, "--iso", "0.5", says="3 components.*--component")
        for axis in range(3):
            report, surface = self.surface(volume, "--iso", "0.5", "--component", axis)
            self.assertEqual([corner[axis] for corner in surface["bounds"]], [0.5, 0.5])
        self.refuses(2, "extract", volume, "--iso", "0.5", "--component", "3", says="--component 3")
        self.assertIsNone(self.report("info", volume)["histogram"]["counts"] or None)
        self.assertEqual(self.report("info", volume, "--component", "1")["range"], [0, 3])

    def test_cells_are_averaged(self):
        self.needs_xml()
        values = [float(x * x + 3 * y - z) for x, y, z in lattice((4, 3, 2))]
        volume = self.write("c.vti", vti_text((5, 4, 3), (), [("c", "f32", values)]))
        means = []
        for x, y, z in lattice((5, 4, 3)):
            around = [values[a + 4 * (b + 3 * c)] for a, b, c in lattice((4, 3, 2))
                      if x - 1 <= a <= x and y - 1 <= b <= y and z - 1 <= c <= z]
            means.append(sum(around) / len(around))
        same = self.write("p.vti", vti_text((5, 4, 3), [("p", "f32", means)]))
        result = self.expect(0, "extract", volume, "--iso", "4.1", "--engine", "reference", "--json")
        self.assertRegex(result.stderr, "'c' is of cells: averaged")
        [of_cells] = json.loads(result.stdout)["surfaces"]
        [of_points] = self.report("extract", same, "--iso", "4.1", "--engine", "reference")["surfaces"]
        self.assertEqual(of_cells["hash"], of_points["hash"])
        self.assertGreater(of_cells["triangles"], 10)
        quiet = self.expect(0, "extract", volume, "--iso", "4.1", "--engine", "reference", "--quiet")
        self.assertEqual((quiet.stdout, quiet.stderr), ("", ""))


    def test_points_and_cells_of_one_name(self):
        self.needs_xml()
        of_points = [float(p[0]) for p in lattice((4, 3, 3))]
        of_cells = [float(p[1]) for p in lattice((3, 2, 2))]
        both = self.write("b.vti", vti_text((4, 3, 3), [("t", "f32", of_points), ("u", "f32", of_points)],
                                            [("t", "f32", of_cells)]))
        how = ["--iso", "0.3"]
        for name, axis in (("t", 0), ("point:t", 0), ("cell:t", 1)):
            _, surface = self.surface(both, "--field", name, *how)
            low, high = surface["bounds"]
            self.assertEqual([a == b for a, b in zip(low, high)], [n == axis for n in range(3)], name)
        result = self.refuses(2, "extract", both, "--field", "cell:u", *how, says="'cell:u'")
        self.assertIn("t (point), cell:t (cell), u (point)", result.stderr)
        self.surface(both, "--field", "u", *how, "--carry", "cell:t,t", "-o", self.path("a.ply"))
        vertices, _ = read_ply(self.path("a.ply"))
        for vertex in vertices:
            self.assertAlmostEqual(vertex["t"], 0.3, places=6)
            self.assertAlmostEqual(vertex["cell_t"], vertex["y"] / 2, places=6)
        named = self.write("n.vti", vti_text((4, 3, 3), [("cell:t", "f32", of_points)], [("t", "f32", of_cells)]))
        _, surface = self.surface(named, "--field", "cell:t", *how)
        self.assertEqual(surface["bounds"][0][0], surface["bounds"][1][0])


class Pieces(GridCase):
    """Pieces of one file know nothing of each other, and that is said once."""
    pattern = "pieces may not meet"

    def setUp(self):
        super().setUp()
        self.needs_xml()

    def notices(self, path, *fields):
        result = self.expect(0, "extract", path, "--iso", "1.5", "--engine", "reference", *fields)
        return result.stderr.count(self.pattern)

    def pieces(self, text):
        """The file with its piece twice."""
        begin, end = text.index("<Piece"), text.index("</Piece>") + len("</Piece>")
        return text[:end] + text[begin:end] + text[end:]

    def test_cells_averaged(self):
        text = vti_text((3, 3, 3), [("p", "f32", [float(p[0]) for p in lattice((3, 3, 3))])],
                        [("c", "f32", [float(n) for n in range(8)])])
        one, two = self.write("1.vti", text), self.write("2.vti", self.pieces(text))
        self.assertEqual([self.notices(one, "--field", "c"), self.notices(two, "--field", "p")], [0, 0])
        self.assertEqual(self.notices(two, "--field", "c"), 1)

    def test_cells_cut(self):
        points = lattice((3, 3, 3))
        fields = [("x", "f32", [float(p[0]) for p in points])]
        cells = hexahedra((3, 3, 3))
        text = vtu_text(points, cells, [HEXAHEDRON] * len(cells), fields)
        one, two = self.write("1.vtu", text), self.write("2.vtu", self.pieces(text))
        self.assertEqual([self.notices(one), self.notices(two)], [0, 1])
        tetrahedron = vtu_text(points, [[0, 2, 6, 18]], [TETRAHEDRON], fields)
        self.assertEqual(self.notices(self.write("t.vtu", self.pieces(tetrahedron))), 0)


class Structured(GridCase):
    dims = (9, 8, 9)

    def image(self):
        """The same samples as a uniform image."""
        with open(self.path("image.raw"), "wb") as f:
            f.write(struct.pack("<648f", *map(bump, lattice(self.dims))))
        return [self.path("image.raw"), "--dims", "9,8,9", "--type", "f32"]

    def test_curvilinear_as_uniform(self):
        points = lattice(self.dims)
        inputs = self.write_plot3d("a", [(self.dims, points, list(map(bump, points)))])
        report, surface = self.surface(*inputs, "--field", "density", "--iso", "0.5")
        self.assertEqual((report["dims"], report["cells"], report["tetrahedra"]), ([9, 8, 9], 448, 2240))
        _, uniform = self.surface(*self.image(), "--iso", "0.5")
        self.assertEqual(counts(surface), counts(uniform))
        self.assertAlmostEqual(surface["volume"], uniform["volume"], places=3)

    def test_stretched(self):
        points = [(2.0 * x, y - 0.25 * x, 3.0 * z + 1) for x, y, z in lattice(self.dims)]
        inputs = self.write_plot3d("a", [(self.dims, points, list(map(bump, lattice(self.dims))))])
        _, surface = self.surface(*inputs, "--field", "density", "--iso", "0.5")
        _, uniform = self.surface(*self.image(), "--iso", "0.5")
        self.assertEqual(counts(surface), counts(uniform))
        self.assertAlmostEqual(surface["volume"], 6 * uniform["volume"], places=2)
        mirrored = self.write_plot3d("m", [(self.dims, [(-x, y, z) for x, y, z in points],
                                            list(map(bump, lattice(self.dims))))])
        _, other = self.surface(*mirrored, "--field", "density", "--iso", "0.5")
        self.assertAlmostEqual(surface["volume"], other["volume"], places=3)

    def test_hybrid(self):
        points = lattice(self.dims)
        inputs = self.write_plot3d("a", [(self.dims, points, list(map(bump, points)))])
        _, tetra = self.surface(*inputs, "--field", "density", "--iso", "0.5")
        report, hybrid = self.surface(*inputs, "--field", "density", "--iso", "0.5", "--method", "hybrid")
        self.assertEqual(report["method"], "hybrid")
        self.assertLess(hybrid["triangles"], 0.6 * tetra["triangles"])
        for key in ("euler_characteristic", "components", "nonmanifold_edges"):
            self.assertEqual(hybrid[key], tetra[key], key)

    def test_parity_goes_by_extent(self):
        self.needs_xml()
        points = lattice(self.dims)
        values = list(map(bump, points))
        hashes = {}
        for first in (0, 2, 3):
            name = self.write(f"{first}.vts", vts_text(self.dims, points, [("f", "f32", values)], (), (first, 0, 0)))
            report, surface = self.surface(name, "--iso", "0.5")
            self.assertEqual(report["dims"], [9, 8, 9])
            hashes[first] = surface["hash"]
        self.assertEqual(hashes[0], hashes[2])
        self.assertNotEqual(hashes[0], hashes[3])

    def test_rectilinear(self):
        self.needs_xml()
        axes = [[0.5 * n * n for n in range(self.dims[0])], [float(n) for n in range(self.dims[1])],
                [float(-n) for n in range(self.dims[2])]]
        geometry = "<Coordinates>" + "".join(data_array("xyz"[axis], "f32", axes[axis]) for axis in range(3)) \
            + "</Coordinates>"
        grid = self.write("a.vtr", structured_text("RectilinearGrid", self.dims, (0, 0, 0), geometry,
                                                   [("f", "f32", list(map(bump, lattice(self.dims))))]))
        _, surface = self.surface(grid, "--iso", "0.5")
        _, uniform = self.surface(*self.image(), "--iso", "0.5")
        self.assertEqual(counts(surface), counts(uniform))
        self.assertGreater(surface["volume"], 0)
        self.assertLessEqual(surface["bounds"][1][2], 0)

    def test_blanked(self):
        """A hidden point, a hidden cell and a sample that is no number leave out the same cubes, whatever says so."""
        self.needs_xml()
        points = lattice(self.dims)
        values = list(map(bump, points))
        middle = points.index((6, 4, 4))
        hidden = [2 if n == middle else 0 for n in range(len(points))]
        fields = [("f", "f32", values)]
        blanked = self.write("b.vts", vts_text(self.dims, points, fields + [("vtkGhostType", "u8", hidden)]))
        around = [all(abs(c + 0.5 - m) < 1 for c, m in zip(cell, points[middle]))
                  for cell in lattice([n - 1 for n in self.dims])]
        self.assertEqual(sum(around), 8)
        cells = self.write("c.vts", vts_text(self.dims, points, fields,
                                             [("vtkGhostType", "u8", [32 * hide for hide in around])]))
        missing = self.write("n.vts", vts_text(self.dims, points,
                                               [("f", "f32", [-99.0 if n == middle else value
                                                              for n, value in enumerate(values)])]))
        _, whole = self.surface(*self.image(), "--iso", "0.5")
        _, one = self.surface(blanked, "--iso", "0.5")
        _, two = self.surface(cells, "--iso", "0.5")
        _, three = self.surface(missing, "--iso", "0.5", "--nodata", "-99")
        self.assertEqual(one["hash"], two["hash"])
        self.assertEqual(one["hash"], three["hash"])
        self.assertLess(one["triangles"], whole["triangles"])
        self.assertGreater(one["boundary_edges"], whole["boundary_edges"])
        self.assertRegex(self.expect(0, "extract", blanked, "--iso", "0.5", "--engine", "reference").stderr,
                         "1 points are blanked")
        self.assertRegex(self.expect(0, "extract", cells, "--iso", "0.5", "--engine", "reference").stderr,
                         "8 blanked cells")


class Blocks(GridCase):
    def setUp(self):
        super().setUp()
        self.blocks = []
        for n, dims in enumerate(((6, 8, 9), (4, 8, 9), (2, 2, 2))):
            points = lattice(dims, (5 * n, 0, 0))
            self.blocks.append((dims, points, list(map(bump, points))))
        self.inputs = self.write_plot3d("a", self.blocks)

    def test_joined(self):
        report, surface = self.surface(*self.inputs, "--field", "density", "--iso", "0.5", "-o", self.path("all.ply"))
        self.assertIsNone(report["dims"])
        self.assertEqual((report["cells"], report["tetrahedra"]), (280 + 168 + 1, 5 * 449))
        parts = []
        for n, block in enumerate(self.blocks):
            single = self.write_plot3d(f"b{n}", [block])
            parts.append(self.surface(*single, "--field", "density", "--iso", "0.5")[1])
        self.assertGreater(min(part["triangles"] for part in parts[:2]), 0)
        self.assertEqual(parts[2]["triangles"], 0)
        for key in ("vertices", "triangles", "active_cells", "boundary_edges", "components"):
            self.assertEqual(surface[key], sum(part[key] for part in parts), key)
        vertices, faces = read_ply(self.path("all.ply"))
        self.assertEqual((len(vertices), len(faces)), (surface["vertices"], surface["triangles"]))
        [counted] = self.report("extract", *self.inputs, "--field", "density", "--iso", "0.5", "--count", "--engine",
                                "reference")["surfaces"]
        self.assertEqual((counted["vertices"], counted["triangles"]), (surface["vertices"], surface["triangles"]))

    def test_separate(self):
        extract = ["extract", *self.inputs, "--field", "density", "--iso", "0.5,2", "--engine", "reference"]
        self.expect(0, *extract, "-o", self.path("joined-%.ply"))
        text = self.expect(0, *extract, "-o", self.path("s.x-%.ply"), "--blocks", "separate").stdout
        self.assertIn("s.x-0.5_b0.ply to ", text)
        for iso in ("0.5", "2"):
            whole, whole_faces = read_ply(self.path(f"joined-{iso}.ply"))
            vertices, faces = [], []
            for n in range(3):
                part, part_faces = read_ply(self.path(f"s.x-{iso}_b{n}.ply"))
                faces += [tuple(len(vertices) + corner for corner in face) for face in part_faces]
                vertices += part
            self.assertEqual((vertices, faces), (whole, whole_faces))
        self.assertEqual(len([name for name in self.files() if "_b" in name]), 6)

    def test_separate_has_the_figures_of_joined(self):
        for more in ([], ["--drop-degenerate"], ["--soup"], ["--normals", "--carry", "momentum-x"]):
            extract = ["extract", *self.inputs, "--field", "density", "--iso", "0.5", "--engine", "reference", "--check",
                       *more, "-o", self.path("a.ply")]
            [joined] = self.report(*extract)["surfaces"]
            report = self.report(*extract, "--blocks", "separate")
            [separate] = report["surfaces"]
            for surface in (joined, separate):
                del surface["timings_ms"]
                for key in "area", "volume":
                    surface[key] = surface[key] and round(surface[key], 9)
            self.assertNotEqual(separate.pop("hash"), joined.pop("hash"))  # of numbers that begin anew
            self.assertEqual(separate, joined)
            self.assertEqual(report["notices"], self.report(*extract)["notices"])

    def test_separate_keeps_one_block(self):
        """Blocks are written as they are extracted: no two surfaces are in memory."""
        inputs = [self.path("n.xyz"), self.path("n.q")]
        plot3d_noise(16, 28, *inputs)
        peaks = {}
        for blocks in "joined", "separate":
            status, peaks[blocks] = peak_memory("extract", *inputs, "--field", "density", "--iso", "0.5", "--engine",
                                                "reference", "--quiet", "--blocks", blocks, "-o", self.path("n.ply"))
            self.assertEqual(status, 0)
        mesh = os.path.getsize(self.path("n.ply"))
        self.assertGreater(mesh, 20 << 20)
        self.assertLess(peaks["separate"], peaks["joined"] - mesh // 2)

    def test_separate_appears_whole_or_not_at_all(self):
        """The second block's file is too large for the system: the first one's does not appear either."""
        small, large = ((dims, lattice(dims), list(map(bump, lattice(dims)))) for dims in ((4, 4, 4), (12, 12, 12)))
        inputs = self.write_plot3d("w", [small, large])
        with open(self.path("w_b0.ply"), "wb") as before:
            before.write(b"as it was")
        sizes = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (8192, sizes[1]))
        try:
            self.refuses(1, "extract", *inputs, "--field", "density", "--iso", "0.5", "--engine", "reference", "--blocks",
                         "separate", "-o", self.path("w.ply"), says="w_b1.ply: cannot be written")
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, sizes)
        self.expect(0, "extract", *inputs, "--field", "density", "--iso", "0.5", "--engine", "reference", "--blocks",
                    "separate", "-o", self.path("w.ply"))
        self.assertLess(os.path.getsize(self.path("w_b0.ply")), 8192)
        self.assertGreater(os.path.getsize(self.path("w_b1.ply")), 8192)

    def test_separate_of_more_blocks_than_files_may_be_open(self):
        dims, most = (2, 2, 2), 64
        inputs = self.write_plot3d("m", [(dims, lattice(dims), [0.0, 1.0] * 4)] * (2 * most))
        files = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, files[1]))
        try:
            self.expect(0, "extract", *inputs, "--field", "density", "--iso", "0.5", "--engine", "reference", "--blocks",
                        "separate", "-o", self.path("m.ply"))
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, files)
        self.assertEqual(len([name for name in self.files() if name.startswith("m_b")]), 2 * most)

    def test_flat_blocks_are_skipped(self):
        flat = ((4, 4, 1), lattice((4, 4, 1)), list(map(bump, lattice((4, 4, 1)))))
        [whole] = self.report("extract", *self.inputs, "--field", "density", "--iso", "0.5", "--engine",
                              "reference")["surfaces"]
        inputs = self.write_plot3d("f", [flat] + self.blocks)
        report, surface = self.surface(*inputs, "--field", "density", "--iso", "0.5")
        self.assertEqual((report["cells"], surface["hash"]), (449, whole["hash"]))
        self.assertRegex(self.expect(0, "extract", *inputs, "--field", "density", "--iso", "0.5", "--engine",
                                     "reference").stderr, "1 blocks of one point along an axis are skipped")
        for blocks in ([flat], [flat, flat]):
            inputs = self.write_plot3d("g", blocks)
            self.refuses(4, "extract", *inputs, "--field", "density", "--iso", "0.5", "--engine", "reference")

    def test_separate_never_overwrites_the_input(self):
        os.rename(self.inputs[1], self.path("s_b1.ply"))
        self.expect(2, "extract", self.inputs[0], self.path("s_b1.ply"), "--field", "density", "--iso", "0.5",
                    "--engine", "reference", "--blocks", "separate", "-o", self.path("s.ply"), says="input itself")

    def test_normals_and_soup(self):
        _, surface = self.surface(*self.inputs, "--field", "density", "--iso", "0.5", "--normals", "--soup", "-o",
                                  self.path("a.ply"))
        vertices, faces = read_ply(self.path("a.ply"))
        self.assertEqual(len(vertices), 3 * surface["triangles"])
        for v in vertices:
            self.assertAlmostEqual(v["nx"] ** 2 + v["ny"] ** 2 + v["nz"] ** 2, 1, places=5)
            outward = [v[axis] - centre for axis, centre in zip("xyz", (4.3, 3.6, 4.1))]
            self.assertGreater(sum(a * v["n" + axis] for a, axis in zip(outward, "xyz")), 0)

    def test_carry(self):
        _, surface = self.surface(*self.inputs, "--field", "density", "--iso", "0.5", "--carry", "momentum-x,energy",
                                  "-o", self.path("a.ply"))
        vertices, _ = read_ply(self.path("a.ply"))
        self.assertEqual(len(vertices), surface["vertices"])
        for vertex in vertices:
            self.assertAlmostEqual(vertex["momentum_x"], vertex["x"], places=4)
            self.assertEqual(vertex["energy"], 2.5)

    def test_carry_where_the_surface_meets_samples(self):
        """Where a vertex lies on a sample, what is missing at the other end of the edge plays no part."""
        self.needs_xml()
        points = lattice((3, 2, 2))
        volume = self.write("a.vti", vti_text((3, 2, 2), [
            ("f", "f32", [float(p[0] == 1) for p in points]),
            ("k", "f32", [5.0 if p[0] == 1 else math.nan for p in points])]))
        self.surface(volume, "--field", "f", "--iso", "1", "--carry", "k", "-o", self.path("a.ply"))
        vertices, _ = read_ply(self.path("a.ply"))
        self.assertGreater(len(vertices), 7)
        self.assertEqual({vertex["k"] for vertex in vertices}, {5.0})

    def test_carry_of_several_components(self):
        self.needs_xml()
        points = lattice((4, 3, 3))
        places = [float(n) for p in points for n in p]
        volume = self.write("a.vti", vti_text((4, 3, 3), [
            ("f", "f32", [float(sum(p)) for p in points]), ("place", "f32", places, 3)]))
        self.surface(volume, "--field", "f", "--iso", "2.5", "--carry", "place,f", "-o", self.path("a.ply"))
        vertices, _ = read_ply(self.path("a.ply"))
        self.assertGreater(len(vertices), 7)
        for vertex in vertices:
            self.assertAlmostEqual(vertex["f"], 2.5, places=6)
            for axis, name in enumerate("xyz"):
                self.assertAlmostEqual(vertex[f"place_{axis}"], vertex[name], places=6)

    def test_carry_to_separate_files(self):
        self.expect(0, "extract", *self.inputs, "--field", "density", "--iso", "0.5", "--engine", "reference",
                    "--carry", "momentum-x", "--blocks", "separate", "-o", self.path("a.ply"))
        for n in range(2):
            vertices, _ = read_ply(self.path(f"a_b{n}.ply"))
            self.assertGreater(len(vertices), 0)
            for vertex in vertices:
                self.assertAlmostEqual(vertex["momentum_x"], vertex["x"], places=4)


class Unstructured(GridCase):
    def setUp(self):
        super().setUp()
        self.needs_xml()

    def test_surface(self):
        grid = self.write_hexahedra("a.vtu")
        report, surface = self.surface(grid, "--field", "bump", "--iso", "0.5")
        self.assertIsNone(report["dims"])
        self.assertEqual(report["cells"], 448)
        self.assertIn(report["tetrahedra"], range(5 * 448, 6 * 448 + 1))
        self.assertEqual((surface["nonmanifold_edges"], surface["misoriented_edges"]), (0, 0))
        self.assertEqual(surface["euler_characteristic"], 2 if not surface["boundary_edges"] else 1)
        self.assertAlmostEqual(surface["volume"], 4 / 3 * math.pi * 9.87 ** 1.5, delta=12)
        self.assertGreater(surface["volume"], 0)

    def test_text_counts_tetrahedra(self):
        how = ["--iso", "0.5", "--engine", "reference"]
        text = self.expect(0, "extract", self.write_hexahedra("a.vtu"), "--field", "bump", *how).stdout
        self.assertRegex(text, r"triangles \(.*\), through \d+ tetrahedra\n")
        image = self.write("a.vti", vti_text((2, 2, 2), [("f", "f32", [0.0] + 7 * [1.0])]))
        self.assertRegex(self.expect(0, "extract", image, *how).stdout, "through 1 cells\n")

    def test_options_that_need_a_structured_grid(self):
        grid = self.write_hexahedra("a.vtu")
        self.refuses(2, "extract", grid, "--field", "bump", "--iso", "0.5", "--normals", "-o", self.path("a.ply"),
                     says="unstructured.*--normals")
        self.refuses(2, "extract", grid, "--field", "bump", "--iso", "0.5", "--method", "hybrid",
                     says="unstructured.*hybrid")

    def test_missing_points(self):
        values = list(map(bump, lattice((9, 8, 9))))
        middle = lattice((9, 8, 9)).index((6, 4, 4))
        values[middle] = -99.0
        grid = self.write_hexahedra("a.vtu", values=values)
        report, surface = self.surface(grid, "--field", "bump", "--iso", "0.5", "--nodata", "-99")
        left = [cell for cell in hexahedra((9, 8, 9)) if middle not in cell]
        self.assertEqual(len(left), 440)
        fields = [("bump", "f64", values)]
        without = self.write("b.vtu", vtu_text(lattice((9, 8, 9)), left, [HEXAHEDRON] * len(left), fields))
        _, same = self.surface(without, "--iso", "0.5")
        self.assertEqual(surface["hash"], same["hash"])
        self.assertRegex(self.expect(0, "extract", grid, "--field", "bump", "--iso", "0.5", "--nodata", "-99",
                                     "--engine", "reference").stderr, "8 cells are left out")

    def test_points_that_are_nowhere(self):
        points = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (math.nan, math.inf, 0.0)]
        fields = [("f", "f32", [0.0, 1.0, 2.0, 3.0, 4.0])]
        for nowhere in ("nan", "inf", "-inf", "2e38"):
            points[3] = (0.0, float(nowhere), 1.0)
            grid = self.write("a.vtu", vtu_text(points, [[0, 1, 2, 3]], [TETRAHEDRON], fields))
            for command in (["extract", grid, "--iso", "0.5", "--engine", "reference"],
                            ["tetrahedralize", grid, "-o", self.path("t.vtu")]):
                self.refuses(4, *command, says="point 3 of cell 0.*finite")
        points[3] = (0.0, 0.0, 1.0)
        grid = self.write("a.vtu", vtu_text(points, [[0, 1, 2, 3]], [TETRAHEDRON], fields))
        self.assertEqual(self.surface(grid, "--iso", "0.5")[1]["triangles"], 1)

    def test_folded_faces(self):
        """Cells that overlap: what they do to the surface is told; misoriented edges they account for are no fault."""
        points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.2, 0.2, 1), (0.3, 0.3, 2), (0.2, 0.2, -1)]
        fields = [("f", "f64", [1.0, 0.0, 0.0, 0.0, 0.0, 0.0])]
        check = ["--iso", "0.5", "--check", "--engine", "reference", "--json", "-o", self.path("a.ply")]
        for cells, status, faces, edges, says in (
                ([[0, 1, 2, 3], [0, 1, 2, 5]], 0, 0, (0, 0), None),
                ([[0, 1, 2, 3], [0, 1, 2, 4]], 0, 1, (1, 0), "crosses 1 faces.*same side; these are"),
                ([[0, 1, 2, 3], [0, 1, 2, 3]], 0, 4, (3, 0), "crosses 3 faces.*same side; these are"),
                ([[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]], 3, 0, (0, 1), "1 faces of three cells or more")):
            grid = self.write("a.vtu", vtu_text(points, cells, [TETRAHEDRON] * len(cells), fields))
            result = self.expect(status, "extract", grid, *check)
            [surface] = json.loads(result.stdout)["surfaces"]
            self.assertEqual((surface["misoriented_edges"], surface["nonmanifold_edges"]), edges)
            self.assertEqual("overlap" in result.stderr, says is not None)
            if says:
                self.assertRegex(result.stderr, says)
            result = self.expect(0, "tetrahedralize", grid, "-o", self.path("t.vtu"), "--json")
            self.assertEqual(json.loads(result.stdout)["folded_faces"], faces)
            self.assertEqual("faces are folded" in result.stderr, faces > 0)
            self.assertEqual("three cells or more" in result.stderr, status == 3)
            quiet = self.expect(0, "tetrahedralize", grid, "-o", self.path("t.vtu"), "--quiet")
            self.assertEqual(quiet.stderr, "")

    def test_folded_faces_beside_missing_points(self):
        """A cell that is left out folds nothing."""
        points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.2, 0.2, 1), (0.3, 0.3, 2)]
        grid = self.write("a.vtu", vtu_text(points, [[0, 1, 2, 3], [0, 1, 2, 4]], [TETRAHEDRON] * 2,
                                            [("f", "f64", [1.0, 0.0, 0.0, 0.0, math.nan])]))
        _, surface = self.surface(grid, "--iso", "0.5")
        self.assertEqual((surface["triangles"], surface["misoriented_edges"]), (1, 0))

    def test_prisms_and_polyhedra(self):
        """Columns of a pentagonal and a hexagonal prism and a polyhedron, side by side, cut in the middle."""
        base = [(0, 0), (2, 0), (3, 1), (2, 2), (0, 2), (5, 1), (6, 0), (6, 3), (3, 3), (8, 0), (8, 2)]
        polygons = [[0, 1, 2, 3, 4], [2, 5, 6, 1], [3, 2, 5, 7, 8], [6, 9, 10, 7, 5]]
        polygons[1] = [1, 6, 5, 2]
        area = sum(base[a][0] * base[b][1] - base[a][1] * base[b][0]
                   for polygon in polygons for a, b in zip(polygon, polygon[1:] + polygon[:1])) / 2
        points = [(x, y, z) for z in (0, 1) for x, y in base]
        up = len(base)
        cells = [polygon + [n + up for n in polygon] for polygon in polygons]
        faces = [None] * 4
        for n, flip in ((2, 1), (3, -1)):
            sides = [[a, b, b + up, a + up] for a, b in zip(polygons[n], polygons[n][1:] + polygons[n][:1])]
            faces[n] = [polygons[n][::flip], [m + up for m in polygons[n]]] + sides
        grid = self.write("a.vtu", vtu_text(points, cells, [15, HEXAHEDRON, POLYHEDRON, POLYHEDRON],
                                            [("z", "f64", [float(p[2]) for p in points])],
                                            [("c", "f32", [5.0] * 4)], faces))
        _, surface = self.surface(grid, "--field", "z", "--iso", "0.5")
        self.assertAlmostEqual(surface["area"], area, places=5)
        self.assertEqual((surface["components"], surface["euler_characteristic"], surface["nonmanifold_edges"],
                          surface["misoriented_edges"]), (1, 1, 0, 0))
        self.assertEqual(self.report("info", grid, "--field", "c")["range"], [5, 5])
        self.assertEqual(self.report("info", grid)["blocks"][0]["cell_types"],
                         {"pentagonal prism": 1, "hexahedron": 1, "polyhedron": 2})
        report = self.report("tetrahedralize", grid, "--field", "z", "-o", self.path("t.vtu"))
        self.assertEqual((report["folded_cells"], report["folded_faces"], report["inverted_cells"]), (0, 0, 0))

    def test_cells_that_cannot_be_cut(self):
        points = lattice((2, 2, 2)) + [(5, 5, 5)]
        fields = [("x", "f32", [float(p[0]) for p in points])]
        closed = [[0, 1, 3], [0, 1, 4], [1, 3, 4], [0, 3, 4]]
        cells = hexahedra((2, 2, 2)) + [list(range(8)), [0, 1, 3, 4], [0, 1, 3, 4]]
        faces = [None, None, closed[:3], closed]
        grid = self.write("a.vtu", vtu_text(points, cells, [HEXAHEDRON, 41, POLYHEDRON, POLYHEDRON], fields, (), faces))
        how = [grid, "--field", "x", "--iso", "0.5", "--engine", "reference"]
        self.refuses(4, "extract", *how, says="cell 1 is of type 41.*--skip-unsupported leaves out the 2 cells")
        result = self.expect(0, "extract", *how, "--skip-unsupported", "--check", "--json")
        self.assertRegex(result.stderr, "2 cells are left out: of a type that is not cut, or polyhedra")
        self.assertRegex(result.stderr, "1 points are used by no cell")
        self.assertEqual(json.loads(result.stdout)["cells"], 4)
        report = self.report("tetrahedralize", grid, "--skip-unsupported", "--field", "x", "-o", self.path("t.vtu"))
        self.assertEqual((report["unsupported_cells"], report["surplus_cells"]), (2, 0))
        broken = self.write("b.vtu", vtu_text(points, [[0, 1, 3]], [TETRAHEDRON], fields))
        said = self.expect(4, "extract", broken, "--iso", "0.5", "--engine", "reference").stderr
        self.assertNotIn("--skip-unsupported", said)

    def test_more_points_than_the_type_has(self):
        points = lattice((2, 2, 2)) + [(9, 9, 9)] * 12
        cells = [hexahedra((2, 2, 2))[0] + list(range(8, 20))]
        grid = self.write("a.vtu", vtu_text(points, cells, [HEXAHEDRON],
                                            [("x", "f32", [float(p[0]) for p in points])], [("c", "f32", [3.0])]))
        result = self.expect(0, "extract", grid, "--field", "x", "--iso", "0.5", "--engine", "reference", "--check",
                             "--json", says="1 cells have more points than their type: the first ones are taken")
        self.assertEqual(json.loads(result.stdout)["surfaces"][0]["area"], 1)
        self.assertEqual(sum(self.report("info", grid, "--field", "c")["histogram"]["counts"]), 8)

    def test_nothing_to_contour(self):
        points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]
        grid = self.write("a.vtu", vtu_text(points, [[0, 1, 2], [1, 3, 2]], [TRIANGLE] * 2,
                                            [("f", "f32", [0.0, 1.0, 2.0, 3.0])]))
        verify = ["--verify"] if test_cli.HAS_DEVICE else ["--engine", "reference"]
        result = self.expect(0, "extract", grid, "--iso", "0.5", "--check", *verify, "--json", "-o", self.path("a.ply"))
        self.assertRegex(result.stderr, "2 cells of fewer than three dimensions are skipped")
        self.assertRegex(result.stderr, "nothing to contour")
        report = json.loads(result.stdout)
        self.assertEqual((report["cells"], report["tetrahedra"]), (0, 0))
        self.assertEqual(counts(report["surfaces"][0]), [0, 0, 0, 0])
        self.assertEqual(read_ply(self.path("a.ply")), ([], []))
        self.expect(0, "tetrahedralize", grid, "-o", self.path("t.vtu"), says="nothing to contour")
        [block] = self.report("info", self.path("t.vtu"))["blocks"]
        self.assertEqual((block["points"], block["cells"]), (4, 0))

    def test_carry(self):
        grid = self.write_hexahedra("a.vtu", cell_fields=[("seven, all", "i16", [7] * 448)])
        self.surface(grid, "--field", "bump", "--iso", "0.5", "--carry", "x,seven, all", "-o", self.path("a.ply"))
        vertices, _ = read_ply(self.path("a.ply"))
        self.assertGreater(len(vertices), 0)
        for vertex in vertices:
            self.assertAlmostEqual(vertex["x_"], vertex["x"], places=4)
            self.assertEqual(vertex["seven__all"], 7)


class Tetrahedralize(GridCase):
    def setUp(self):
        super().setUp()
        self.needs_xml()

    def test_image_gives_the_same_surface(self):
        image = self.generate("torus", "a.nrrd", "20,19,18", "f32")
        report = self.report("tetrahedralize", image, "-o", self.path("a.vtu"))
        self.assertEqual(set(report), CONVERTED_KEYS)
        self.assertEqual((report["points"], report["cells"], report["tetrahedra"]), (6840, 5814, 29070))
        of_image, one = self.surface(image, "--iso", "127.5")
        of_complex, two = self.surface(self.path("a.vtu"), "--iso", "127.5")
        self.assertEqual(of_image["tetrahedra"], of_complex["tetrahedra"])
        self.assertEqual(counts(one), counts(two))
        for low, high in zip(itertools.chain(*one["bounds"]), itertools.chain(*two["bounds"])):
            self.assertAlmostEqual(low, high, places=6)

    def test_missing_samples(self):
        """Cubes beside a missing sample are left out before they are cut, as the structured path leaves them out."""
        values = list(map(bump, lattice((9, 8, 9))))
        values[lattice((9, 8, 9)).index((6, 4, 4))] = -99.0
        with open(self.path("a.raw"), "wb") as f:
            f.write(struct.pack("<648f", *values))
        raw = [self.path("a.raw"), "--dims", "9,8,9", "--type", "f32", "--nodata", "-99"]
        report = self.report("tetrahedralize", *raw, "-o", self.path("a.vtu"))
        self.assertEqual((report["cells"], report["tetrahedra"], report["blanked_cells"]), (448, 5 * 440, 8))
        _, one = self.surface(*raw, "--iso", "0.5")
        _, two = self.surface(self.path("a.vtu"), "--iso", "0.5")
        self.assertEqual(counts(one), counts(two))

    def test_blocks_and_fields(self):
        blocks = []
        for n, dims in enumerate(((4, 3, 3), (3, 3, 3))):
            points = lattice(dims, (3 * n, 0, 0))
            blocks.append((dims, points, list(map(bump, points))))
        inputs = self.write_plot3d("a", blocks)
        report = self.report("tetrahedralize", *inputs, "-o", self.path("a.vtu"))
        self.assertEqual((report["blocks"], report["points"], report["tetrahedra"]), (2, 63, 100))
        self.assertIn("momentum-x", report["fields"])
        [block] = self.report("info", self.path("a.vtu"))["blocks"]
        self.assertEqual((block["kind"], block["points"], block["cell_types"]),
                         ("unstructured", 63, {"tetrahedron": 100}))
        self.assertEqual(block["bounds"], [[0, 0, 0], [5, 2, 2]])
        ranges = {field["name"]: field["ranges"] for field in block["fields"]}
        self.assertEqual(ranges["momentum-x"], [[0, 5]])

    def test_inverted_cells(self):
        points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)]
        values = [("f", "f64", [0.0, 1.0, 2.0, 3.0, 4.0, 5.0])]
        volumes = []
        for n, order in enumerate(([0, 1, 2, 3, 4, 5], [3, 4, 5, 0, 1, 2])):
            grid = self.write(f"{n}.vtu", vtu_text(points, [order], [WEDGE], values))
            report = self.report("tetrahedralize", grid, "-o", self.path("t.vtu"))
            volumes.append(report["inverted_cells"])
            self.assertEqual(report["tetrahedra"], 3)
        self.assertEqual(sorted(volumes), [0, 1])

    def test_output_is_the_input(self):
        grid = self.write_hexahedra("a.vtu")
        self.refuses(2, "tetrahedralize", grid, "-o", grid, says="input itself")


class Names(GridCase):
    """Names of arrays that would steer a terminal, or break a file."""

    def check(self, path, name):
        values = [n[0] for n in lattice((3, 3, 3))]
        info = self.report("info", path)
        self.assertEqual([field["name"] for field in info["blocks"][0]["fields"]], ["f", name])
        self.assertNotRegex(self.expect(0, "info", path).stdout, r"[\x00-\x09\x0b-\x1f\x7f-\x9f]")
        said = self.expect(2, "info", path, "--field", "\x1b[2J").stderr
        self.assertIn(name, said)
        self.assertNotRegex(said, r"[\x00-\x09\x0b-\x1f\x7f-\x9f]")
        self.assertEqual(self.report("info", path, "--field", name)["range"], [min(values), max(values)])
        mesh = self.path("a.vtp")
        self.expect(0, "extract", path, "--field", "f", "--iso", "0.5", "--carry", name, "--engine", "reference", "-o",
                    mesh)
        with open(mesh, "rb") as f:
            head = f.read().partition(b"<AppendedData")[0].decode("utf-8")
        self.assertIn(f'Name="{name}"', head)

    def test_legacy(self):
        values = numbers(float(p[0]) for p in lattice((3, 3, 3)))
        arrays = "".join(f"SCALARS {name} float\nLOOKUP_TABLE default\n{values}\n"
                         for name in ("f", "a%20b%09%0a%1B[2J%7f%C2%9B"))
        path = self.write("a.vtk", "# vtk DataFile Version 3.0\nnone\nASCII\nDATASET STRUCTURED_POINTS\n"
                          f"DIMENSIONS 3 3 3\nSPACING 1 1 1\nORIGIN 0 0 0\nPOINT_DATA 27\n{arrays}")
        self.check(path, "a b%09%0A%1B[2J%7F%C2%9B")

    def test_xml(self):
        self.needs_xml()
        values = [float(p[0]) for p in lattice((3, 3, 3))]
        fields = [("f", "f32", values), ("a b&#9;&#10;&#127;&#155;", "f32", values)]
        path = self.write("a.vti", vti_text((3, 3, 3), fields))
        self.check(path, "a b%09%0A%7F%C2%9B")


class LeftOut(GridCase):
    """Arrays that are not read, or stand twice: told with their names."""

    def check(self, path, absent, kind):
        info = self.report("info", path)
        self.assertEqual(info["notices"], [notice for notice in info["notices"] if notice.startswith(path)])
        said = "\n".join(info["notices"])
        self.assertIn(f"the array '{absent}' is left out: its type {kind} cannot be read", said)
        self.assertEqual(said.count("several arrays of points have the name 'f': the first is taken"), 1)
        self.assertEqual(info["range"], [0, 2])
        for name in (absent, "point:" + absent):
            self.refuses(4, "info", path, "--field", name, says=f"'{absent}' is left out: its type {kind} cannot be")
        self.refuses(4, "extract", path, "--iso", "1", "--field", "f", "--carry", absent, "--engine", "reference",
                     "-o", self.path("a.vtp"), says=f"its type {kind} cannot be read")
        self.refuses(2, "info", path, "--field", "none", says="no field .*is named 'none'")

    def test_legacy(self):
        values = [numbers(float(p[n]) for p in lattice((3, 3, 3))) for n in range(3)]
        head = ("# vtk DataFile Version 3.0\nnone\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 3 3\n"
                "SPACING 1 1 1\nORIGIN 0 0 0\nPOINT_DATA 27\n")
        words = "FIELD t 1\nwords 1 27 string\n" + "a\n" * 27
        floats = "".join(f"SCALARS f float\nLOOKUP_TABLE default\n{text}\n" for text in values)
        self.check(self.write("a.vtk", head + floats + words), "words", "string")
        self.refuses(4, "info", self.write("b.vtk", head + words), "--field", "f", says="no field.*'words' is left out")

    def test_xml(self):
        self.needs_xml()
        fields = [("f", "f32", [float(p[n]) for p in lattice((3, 3, 3))]) for n in range(3)]
        text = vti_text((3, 3, 3), fields)
        odd = '<DataArray type="Float16" Name="odd" format="ascii">' + "1 " * 27 + "</DataArray></PointData>"
        self.check(self.write("a.vti", text.replace("</PointData>", odd)), "odd", "Float16")
        start, _, end = text.partition("<PointData>")
        alone = self.write("b.vti", start + "<PointData>" + odd + end.partition("</PointData>")[2])
        self.refuses(4, "extract", alone, "--iso", "1", "--engine", "reference", says="no field.*'odd'.*Float16")


class Obstacles(GridCase):
    """Where no isovalue gives a surface info advises on none, and says why; extract agrees."""

    def check(self, why, *inputs, status=0):
        info = self.report("info", *inputs)
        self.assertEqual(info["isovalues"], [])
        self.assertRegex("\n".join(info["notices"]), "nothing can be extracted: .*" + why)
        self.assertRegex(self.expect(0, "info", *inputs).stdout, "isovalues +none: .*" + why)
        if status:
            self.refuses(status, "extract", *inputs, "--iso", "0.5", "--engine", "reference")
        else:
            report = self.report("extract", *inputs, "--iso", "0.5", "--engine", "reference")
            self.assertEqual(report["surfaces"][0]["triangles"], 0)
        return info

    def raw(self, dims, values, *more):
        with open(self.path("a.raw"), "wb") as f:
            f.write(struct.pack(f"<{len(values)}f", *values))
        return [self.path("a.raw"), "--dims", ",".join(map(str, dims)), "--type", "f32", *more]

    def test_images(self):
        for dims in ((8, 8, 1), (1, 8, 8), (8, 1, 8)):
            self.check("one sample along an axis", *self.raw(dims, [float(n) for n in range(64)]), status=4)
        self.check("every sample is missing", *self.raw((4, 4, 4), [math.nan] * 64))
        self.check("every sample is missing", *self.raw((4, 4, 4), [7.0] * 64, "--nodata", "7"))
        board = [float(sum(p)) if sum(p) % 2 else math.nan for p in lattice((4, 4, 4))]
        self.check("no cell of three dimensions has samples at all", *self.raw((4, 4, 4), board))
        cell = [float(sum(p)) if min(p) > 1 else math.nan for p in lattice((4, 4, 4))]
        self.assertNotEqual(self.report("info", *self.raw((4, 4, 4), cell))["isovalues"], [])

    def test_blanked(self):
        self.needs_xml()
        values = [("f", "f32", [float(p[0]) for p in lattice((3, 3, 3))])]
        ghosts = ("vtkGhostType", "u8", [32] * 8)
        hidden = self.write("a.vti", vti_text((3, 3, 3), values, [ghosts]))
        self.check("no cell of three dimensions has samples", hidden)
        ghosts = ("vtkGhostType", "u8", [2] * 27)
        self.check("every sample is missing", self.write("b.vti", vti_text((3, 3, 3), values + [ghosts])))

    def test_blocks(self):
        points = lattice((3, 3, 3))
        good, bad = [float(p[0]) for p in points], ["nan"] * 27
        grid, solution = plot3d_texts([((3, 3, 3), points, good), ((3, 3, 3), points, bad)])
        pair = [self.write("a.xyz", grid), self.write("a.q", solution.replace("'", ""))]
        info = self.report("info", *pair, "--field", "density")
        self.assertIn("every sample is missing in 1 of 2 blocks", "\n".join(info["notices"]))
        self.assertNotEqual(info["isovalues"], [])
        grid, solution = plot3d_texts([((3, 3, 3), points, bad)])
        pair = [self.write("b.xyz", grid), self.write("b.q", solution.replace("'", ""))]
        self.check("every sample is missing", *pair, "--field", "density")

    def test_unstructured(self):
        self.needs_xml()
        points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (0, 0, 1)]
        fields = [("f", "f32", [0.0, 1.0, 2.0, 3.0, 4.0])]
        flat = self.write("a.vtu", vtu_text(points, [[0, 1, 2], [1, 3, 2]], [TRIANGLE] * 2, fields))
        info = self.check("no cell of three dimensions", flat)
        self.assertRegex("\n".join(info["notices"]), "2 cells of fewer than three dimensions are skipped")
        inverted = self.write("b.vtu", vtu_text(points, [[0, 2, 1, 4]], [TETRAHEDRON], fields))
        info = self.report("info", inverted)
        self.assertRegex("\n".join(info["notices"]), "1 cells of negative volume are turned over")
        self.assertNotEqual(info["isovalues"], [])
        uncut = self.write("c.vtu", vtu_text(points, [[0, 1, 2, 4]], [41], fields))
        self.check("cell 0 is of type 41", uncut, status=4)


class Info(GridCase):
    def test_blocks(self):
        blocks = [((3, 2, 2), lattice((3, 2, 2)), [float(n) for n in range(12)]),
                  ((2, 2, 2), lattice((2, 2, 2), (2, 0, 0)), [float(20 + n) for n in range(8)])]
        inputs = self.write_plot3d("a", blocks)
        info = self.report("info", *inputs)
        self.assertEqual(set(info), test_cli.INFO_KEYS)
        self.assertEqual((info["format"], info["field"], info["dims"], info["isovalues"]), ("Plot3D", None, None, []))
        self.assertEqual([set(block) for block in info["blocks"]], [BLOCK_KEYS] * 2)
        first, second = info["blocks"]
        self.assertEqual((first["kind"], first["dims"]), ("curvilinear", [3, 2, 2]))
        self.assertEqual((first["points"], first["cells"]), (12, 2))
        self.assertEqual(second["bounds"], [[2, 0, 0], [3, 1, 1]])
        self.assertEqual(second["fields"][0], {"name": "density", "on": "points", "components": 1, "type": "f32",
                                               "ranges": [[20, 27]]})
        chosen = self.report("info", *inputs, "--field", "density")
        self.assertEqual((chosen["field"], chosen["range"]), ("density", [0, 27]))
        self.assertEqual(sum(chosen["histogram"]["counts"]), 20)
        text = self.expect(0, "info", *inputs).stdout
        for fact in ("block 1 of 2", "curvilinear", "'density' f32, 20 to 27", "--field"):
            self.assertIn(fact, text)

    def test_unstructured(self):
        self.needs_xml()
        points = lattice((2, 2, 2)) + [(0, 0, 2)]
        cells = hexahedra((2, 2, 2)) + [[4, 5, 8]]
        grid = self.write("a.vtu", vtu_text(points, cells, [HEXAHEDRON, TRIANGLE],
                                            [("v", "f64", [0.1 * n for n in range(27)], 3)], [("c", "i32", [5, 9])]))
        info = self.report("info", grid)
        [block] = info["blocks"]
        self.assertEqual((block["kind"], block["points"], block["cells"]), ("unstructured", 9, 2))
        self.assertEqual(block["cell_types"], {"hexahedron": 1, "triangle": 1})
        self.assertEqual(block["bounds"], [[0, 0, 0], [1, 1, 2]])
        fields = {field["name"]: field for field in block["fields"]}
        self.assertEqual(fields["v"]["ranges"], [[0, 0.1 * 24], [0.1, 0.1 * 25], [0.2, 0.1 * 26]])
        self.assertEqual((fields["c"]["on"], fields["c"]["type"], fields["c"]["ranges"]), ("cells", "i32", [[5, 9]]))
        self.assertEqual(self.report("info", grid, "--field", "c")["range"], [5, 5])
        text = self.expect(0, "info", grid).stdout
        self.assertIn("triangle 1, hexahedron 1", text)


class Used(GridCase):
    """Range, histogram and isovalues are of the samples that a surface can depend on."""

    def check(self, inputs, low, high, count, *more):
        """And every isovalue that info advises gives a surface, while one above the range is told with that range."""
        info = self.report("info", *inputs, *more)
        self.assertEqual((info["range"], sum(info["histogram"]["counts"])), ([low, high], count))
        self.assertEqual((info["missing"], info["nonfinite"]), (0, 0))
        self.assertTrue(info["isovalues"])
        extract = ["extract", *inputs, *more, "--engine", "reference", "--iso"]
        for advice in info["isovalues"]:
            self.assertGreater(self.report(*extract, repr(advice["iso"]))["surfaces"][0]["triangles"], 0, advice)
        self.expect(0, *extract, "1e40", says=f"outside the range of the samples, {low} to {high}:")

    def cells(self, extra_points, extra_values, extra_cells=(), extra_types=()):
        """2 x 2 x 2 points with a hexahedron and values 0 to 7, and others."""
        values = [float(n) for n in range(8)] + extra_values
        cells = hexahedra((2, 2, 2)) + list(extra_cells)
        return [self.write("a.vtu", vtu_text(lattice((2, 2, 2)) + extra_points, cells, [HEXAHEDRON, *extra_types],
                                             [("f", "f64", values)]))]

    def test_points_of_no_cell(self):
        self.needs_xml()
        self.check(self.cells([(0, 0, 9), (0, 9, 0)], [1e30, float("nan")]), 0, 7, 8)

    def test_points_of_flat_cells(self):
        self.needs_xml()
        self.check(self.cells([(0, 0, 9)], [-1e30], [[0, 1, 8]], [TRIANGLE]), 0, 7, 8)

    def test_points_inside_edges(self):
        self.needs_xml()
        corners = [(0, 0, 0), (2, 0, 0), (0, 2, 0), (0, 0, 2)]
        middles = [tuple((a + b) / 2 for a, b in zip(corners[i], corners[j]))
                   for i, j in ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))]
        grid = self.write("q.vtu", vtu_text(corners + middles, [list(range(10))], [24],
                                            [("f", "f64", [0.0, 1.0, 2.0, 3.0] + [50.0] * 6)]))
        self.check([grid], 0, 3, 4)

    def test_flat_cells_alone(self):
        self.needs_xml()
        fields = [("f", "f64", [1.0, 2.0, 3.0, 4.0])]
        grid = self.write("t.vtu", vtu_text(lattice((2, 2, 1)), [[0, 1, 2]], [TRIANGLE], fields))
        self.assertEqual(self.report("info", grid)["range"], [1, 4])

    def test_flat_blocks(self):
        blocks = [((2, 2, 2), lattice((2, 2, 2)), [float(n) for n in range(8)]),
                  ((3, 3, 1), lattice((3, 3, 1)), [1e30] * 9)]
        self.check(self.write_plot3d("b", blocks), 0, 7, 8, "--field", "density")

    def test_cells_that_are_hidden(self):
        self.needs_xml()
        values = [float(x) if x < 3 else 1e30 for x, y, z in lattice((4, 2, 2))]
        grid = self.write("g.vti", vti_text((4, 2, 2), [("f", "f64", values)], [("vtkGhostType", "u8", [0, 0, 32])]))
        self.check([grid], 0, 2, 12, "--field", "f")


@unittest.skipUnless(DATA, "TETRACUBES_DATA is unset; it names the folder of published data")
class Published(GridCase):
    REFUSED = {"unstructured/disk_out_ref.ex2": "Exodus"}
    PAIRS = {"bluntfinxyz.bin": "bluntfinq.bin", "combxyz.bin": "combq.bin", "postxyz.bin": "postq.bin",
             "multi-ascii.xyz": "multi-ascii.q", "multi-bin.xyz": "multi-bin.q", "multi-bin-C.xyz": "multi-bin-C.q",
             "tiny.xyz": "tiny.q"}
    # file or grid, field, dims, range of the field; digits as the data's description gives them
    FACTS = [("uniform/ironProt.vtk", "scalars", [68, 68, 68], [0, 255]),
             ("uniform/vase.vti", "SLCImage", [115, 101, 75], [0, 239]),
             ("uniform/hydrogen.vti", None, [64, 64, 64], [0, 1]),
             ("uniform/heart.vti", None, [32, 32, 12], [0, 255]),
             ("uniform/heart.vtk", None, [32, 32, 12], [0, 255]),
             ("curvilinear/bluntfinxyz.bin", "density", [40, 32, 32], [0.1926, 4.9775]),
             ("curvilinear/combxyz.bin", "density", [57, 33, 25], [0.198, 0.710]),
             ("curvilinear/postxyz.bin", "energy", [38, 76, 38], [-0.54, 4.40]),
             ("curvilinear/SampleStructGrid.vtk", "scalars", [20, 30, 40], [0, 1.305]),
             ("unstructured/CylinderLinear.vtk", "vel_norm", None, [0, 1.004]),
             ("unstructured/hexa.vtk", None, None, [0.75, 17.3]),
             ("unstructured/fire_ug.vtu", "t", None, [298, 692]),
             ("unstructured/notch_stress_fixed.vtk", None, None, [3.2e3, 8.1e6])]
    CLOSED = [("unstructured/hexa.vtk", 5.0)]
    BORDERED = [("unstructured/fire_ug.vtu", "t", 400), ("unstructured/fichera-mixed.vtu", "f", 0.5),
                ("unstructured/fichera-mixed-16.vtu", "f", 0.5)]

    def inputs(self, path):
        whole = os.path.join(DATA, path)
        second = self.PAIRS.get(os.path.basename(path))
        return [whole] + ([os.path.join(os.path.dirname(whole), second)] if second else [])

    def lacks(self, path):
        formats = self.expect(0, "--version").stdout
        return (path.endswith((".vti", ".vtr", ".vts", ".vtu")) and "VTK XML" not in formats
                or ".nii" in path and "NIfTI" not in formats)

    def test_everything_readable_opens(self):
        readable = (".vtk", ".vti", ".vtr", ".vts", ".vtu", ".nrrd", ".nhdr", ".mhd", ".nii", ".nii.gz")
        opened = 0
        for kind in ("uniform", "curvilinear", "unstructured"):
            for name in sorted(os.listdir(os.path.join(DATA, kind))):
                if not name.endswith(readable) and name not in self.PAIRS or self.lacks(name):
                    continue
                with self.subTest(file=name):
                    info = self.report("info", *self.inputs(f"{kind}/{name}"))
                    self.assertGreaterEqual(len(info["blocks"]), 1)
                    opened += 1
        self.assertGreater(opened, 20)
        for name, says in self.REFUSED.items():
            self.refuses(4, "info", os.path.join(DATA, name), says=says)

    def test_facts(self):
        for path, name, dims, wanted in self.FACTS:
            with self.subTest(file=path):
                if self.lacks(path):
                    continue
                blocks = self.report("info", *self.inputs(path))["blocks"]
                self.assertEqual([block["dims"] for block in blocks], [dims])
                scalars = [field for field in blocks[0]["fields"] if field["name"] == name or not name]
                near = [field["ranges"][0] for field in scalars if field["components"] == 1 and all(
                    abs(got - end) <= 0.006 * max(abs(end), abs(wanted[1]))
                    for got, end in zip(field["ranges"][0], wanted))]
                self.assertTrue(near, f"{wanted} is none of {scalars}")

    def test_surfaces_of_unstructured_grids(self):
        for path, iso in self.CLOSED:
            with self.subTest(file=path):
                _, surface = self.surface(os.path.join(DATA, path), "--iso", iso, *self.only_scalar(path))
                self.assertEqual((surface["boundary_edges"], surface["nonmanifold_vertices"]), (0, 0))
                self.assertGreater(surface["triangles"], 0)
        for path, field, iso in self.BORDERED:
            with self.subTest(file=path):
                if self.lacks(path):
                    continue
                _, surface = self.surface(os.path.join(DATA, path), "--iso", iso, "--field", field)
                self.assertGreater(surface["triangles"], 0)

    def only_scalar(self, path):
        fields = self.report("info", os.path.join(DATA, path))["blocks"][0]["fields"]
        scalars = [field["name"] for field in fields if field["components"] == 1]
        return ["--field", scalars[0]] if len(fields) > 1 else []

    def test_pieces_hold_the_points_of_the_whole(self):
        """The combustor in three pieces against the same in one: cubes, and the surface but for what pieces share."""
        if self.lacks(".vts"):
            self.skipTest("built without VTK XML")
        pieces = [self.report("info", os.path.join(DATA, f"curvilinear/multicomb_{n}.vts"))["blocks"][0]
                  for n in range(3)]
        whole = self.report("info", *self.inputs("curvilinear/combxyz.bin"))["blocks"][0]
        for piece in pieces:
            for axis in range(3):
                self.assertGreaterEqual(piece["bounds"][0][axis], whole["bounds"][0][axis] - 1e-4)
                self.assertLessEqual(piece["bounds"][1][axis], whole["bounds"][1][axis] + 1e-4)
        for n in range(3):
            _, surface = self.surface(os.path.join(DATA, f"curvilinear/multicomb_{n}.vts"), "--field", "Density",
                                      "--iso", 0.37)
            self.assertGreater(surface["triangles"], 0)

    def test_nothing_to_contour(self):
        blow = os.path.join(DATA, "unstructured/blow.vtk")
        fields = self.report("info", blow)["blocks"][0]["fields"]
        scalars = [field["name"] for field in fields if field["components"] == 1]
        if scalars:
            result = self.expect(0, "extract", blow, "--field", scalars[0], "--iso", "0.5", "--engine", "reference")
            self.assertRegex(result.stderr, "nothing to contour")

    def test_quadratic_cells_are_linearised(self):
        for name in ("QuadraticTetra.vtu", "QuadraticPyramid.vtu", "QuadraticWedge.vtu"):
            with self.subTest(file=name):
                if self.lacks(name):
                    continue
                result = self.expect(0, "extract", os.path.join(DATA, "unstructured", name), "--field",
                                     "DistanceToCenter", "--iso", "0.8", "--engine", "reference", "--check")
                self.assertRegex(result.stderr, "taken as linear")


if __name__ == "__main__":
    test_cli.TOOL = os.path.abspath(sys.argv[1])
    test_cli.HAS_DEVICE = "reference" not in sys.argv[2:]
    print("all checks" if test_cli.HAS_DEVICE else "checks that need an OpenCL device are left out", flush=True)
    unittest.main(argv=[sys.argv[0], *test_cli.chosen()])
