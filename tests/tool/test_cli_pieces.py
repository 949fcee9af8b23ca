#!/usr/bin/env python3
"""test_cli_pieces.py TOOL [reference] - parallel VTK XML: grids that are cut into pieces here give the surface of the whole
grid, with and without ghost cells; pieces that do not fit are refused"""
import itertools
import os
import re
import struct
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from grid_files import (HEXAHEDRON, HEXAHEDRON_ORDER, POLYHEDRON, TETRAHEDRON, attributes, bump, data_array, hexahedra,
                        lattice, numbers, vtk_file, vtu_text)
from tool_case import GridCase, counts

DIMS, FIRST = (9, 8, 10), (-2, 3, 1)
CUTS = ((-2, 1, 6), (3, 5, 10), (1, 3, 10))  # planes of points between the pieces, and the ends
ENDINGS = {"ImageData": "vti", "RectilinearGrid": "vtr", "StructuredGrid": "vts"}
SPACING = ' Origin="-1 2 0.5" Spacing="0.5 0.25 2"'


def text_of(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def value(point):
    return bump([p + (2, -3, -1)[axis] for axis, p in enumerate(point)])


def extent_text(extent):
    return " ".join(f"{low} {high}" for low, high in extent)


def points_of(extent):
    return lattice([high - low + 1 for low, high in extent], [low for low, _ in extent])


def cells_of(extent):
    return lattice([high - low for low, high in extent], [low for low, _ in extent])


def place(point):
    """Of a curvilinear grid."""
    x, y, z = point
    return (x + 0.125 * y, y - 0.25 * z, 2.0 * z + 0.0625 * x)


def geometry(kind, extent):
    if kind == "RectilinearGrid":
        return "<Coordinates>" + "".join(
            data_array("xyz"[axis], "f64", [n * 1.25 + n * n / 64 for n in range(low, high + 1)])
            for axis, (low, high) in enumerate(extent)) + "</Coordinates>"
    if kind == "StructuredGrid":
        flat = list(itertools.chain(*map(place, points_of(extent))))
        return f"<Points>{data_array('Points', 'f32', flat, 3)}</Points>"
    return ""


def piece_text(kind, extent, more_points=(), more_cells=(), whole=None):
    fields = [("bump", "f64", list(map(value, points_of(extent)))),
              ("x", "f32", [0.5 * p[0] for p in points_of(extent)])]
    cells = [("number", "i32", [7 * x + 5 * y * y + 3 * z for x, y, z in cells_of(extent)])]
    place_text = SPACING if kind == "ImageData" else ""
    return vtk_file(kind, f' WholeExtent="{extent_text(whole or extent)}"{place_text}><Piece Extent="{extent_text(extent)}">'
                    f'{attributes("PointData", fields + list(more_points))}{attributes("CellData", cells + list(more_cells))}'
                    f"{geometry(kind, extent)}</Piece>")


def whole_extent():
    return [(FIRST[axis], FIRST[axis] + DIMS[axis] - 1) for axis in range(3)]


def boxes():
    return [list(pairs) for pairs in itertools.product(*(list(zip(c, c[1:])) for c in CUTS))]


def index_text(kind, pieces, levels=0, more=""):
    """pieces: extents and names."""
    place_text = SPACING if kind == "ImageData" else ""
    return vtk_file("P" + kind, f' WholeExtent="{extent_text(whole_extent())}" GhostLevel="{levels}"{place_text}{more}>' +
                    "".join(f'<Piece Extent="{extent_text(e)}" Source="{name}"/>' for e, name in pieces))


def appended(text, order):
    """The file with its arrays as raw appended data in this order of bytes."""
    codes = {"UInt8": "B", "Int32": "i", "Float32": "f", "Float64": "d"}
    data = bytearray()

    def move(match):
        values = list(map(float if match[1].startswith("Float") else int, match[3].split()))
        code = f"{order}{len(values)}{codes[match[1]]}"
        data.extend(bytes((4 - len(data)) % 8))  # values are aligned
        place = len(data)
        data.extend(struct.pack(order + "I", struct.calcsize(code)) + struct.pack(code, *values))
        return f'<DataArray type="{match[1]}"{match[2]}format="appended" offset="{place}"/>'

    text = re.sub(r'<DataArray type="(\w+)"([^>]*)format="ascii">([^<]*)</DataArray>', move, text)
    if order == ">":
        text = text.replace("LittleEndian", "BigEndian")
    head = text.replace("</VTKFile>", '<AppendedData encoding="raw">').rstrip("\n")
    return (head + " " * (-len(head) % 8 + 7) + "_").encode() + bytes(data) + b"</AppendedData></VTKFile>"


class Pieces(GridCase):
    def setUp(self):
        super().setUp()
        self.needs_xml()
        os.mkdir(self.path("p"))

    def divided(self, kind, ghosts=0, marks="vtkGhostType", hidden=False, names=None):
        """An index of pieces that have so many layers of ghost cells, marked or not."""
        pieces = []
        for n, box in enumerate(boxes()):
            wide = [(max(low - ghosts, all_low), min(high + ghosts, all_high))
                    for (low, high), (all_low, all_high) in zip(box, whole_extent())]
            outside = [any(not low <= c < high for c, (low, high) in zip(cell, box)) for cell in cells_of(wide)]
            flags = [("vtkGhostType", "u8", [int(out) | 32 * int(hidden and c == (0, 5, 4))
                                             for out, c in zip(outside, cells_of(wide))])]
            if marks == "vtkGhostLevels":
                flags = [("vtkGhostLevels", "u8", list(map(int, outside)))]
            name = f"p/{kind}_{n}.{ENDINGS[kind]}"
            self.write(name, piece_text(kind, wide, more_cells=flags if marks and (ghosts or hidden) else [],
                                        whole=whole_extent()))
            pieces.append((wide, names[n] if names else name))
        return self.write(f"a.p{ENDINGS[kind]}", index_text(kind, pieces, ghosts))

    def same(self, first, second, *arguments):
        """The file of the mesh, byte for byte."""
        results = []
        for path in (first, second):
            _, surface = self.surface(path, *arguments, "-o", self.path("out.ply"))
            self.assertGreater(surface["triangles"], 0)
            with open(self.path("out.ply"), "rb") as mesh:
                results.append((surface["boundary_edges"], mesh.read()))
            os.remove(self.path("out.ply"))
        self.assertTrue(results[0] == results[1], f"{first} and {second} differ: {arguments}")
        return results[0][0]

    def test_grids(self):
        """Pieces with layers of ghosts, marked in either way or only said to be there, and without."""
        for kind, ending in ENDINGS.items():
            whole = self.write("whole." + ending, piece_text(kind, whole_extent()))
            for ghosts, marks in ((0, None), (1, "vtkGhostType"), (2, "vtkGhostType"), (1, "vtkGhostLevels"), (1, None)):
                with self.subTest(kind=kind, ghosts=ghosts, marks=marks):
                    parts = self.divided(kind, ghosts, marks)
                    self.assertEqual(self.same(whole, parts, "--field", "bump", "--iso", "0.5", "--carry", "x"), 0)
                    self.same(whole, parts, "--field", "number", "--iso", "200")
                    self.same(whole, parts, "--field", "bump", "--iso", "0.5", "--roi", "-1:5,4:10,:", "--step", "2,1,1")
        self.assertIn("parallel VTK XML", self.expect(0, "--version").stdout)

    def test_hidden_cells(self):
        for kind, ending in ENDINGS.items():
            flags = [("vtkGhostType", "u8", [32 * int(c == (0, 5, 4)) for c in cells_of(whole_extent())])]
            whole = self.write("whole." + ending, piece_text(kind, whole_extent(), more_cells=flags))
            for ghosts in (0, 1):
                self.same(whole, self.divided(kind, ghosts, hidden=True), "--field", "bump", "--iso", "0.5")

    def test_placement(self):
        """Options go for the whole; what pieces say of it has to agree."""
        whole = self.write("whole.vti", piece_text("ImageData", whole_extent()))
        parts = self.divided("ImageData")
        self.same(whole, parts, "--field", "bump", "--iso", "0.5", "--spacing", "2,3,4", "--origin", "1,1,1")
        text = text_of(self.path("p/ImageData_3.vti"))
        self.write("p/ImageData_3.vti", text.replace('Origin="-1 ', 'Origin="-0.9 '))
        self.refuses(4, "info", parts, says=r"ImageData_3\.vti: has another Origin, Spacing or Direction than .*a\.pvti")

    def test_gaps_and_overlaps(self):
        kind = "RectilinearGrid"
        parts = self.divided(kind)
        pieces = [(box, f"p/{kind}_{n}.vtr") for n, box in enumerate(boxes())]
        self.write("a.pvtr", index_text(kind, pieces[:-1]))
        self.refuses(4, "info", parts, says=r"a\.pvtr: its pieces leave a gap: they have \d+ of the 504 cells")
        wide = [(-2, 2), (3, 5), (1, 3)]
        self.write("p/wide.vtr", piece_text(kind, wide))
        self.write("a.pvtr", index_text(kind, [(wide, "p/wide.vtr")] + pieces[1:]))
        self.refuses(4, "info", parts, says=r"p/wide\.vtr and .*_4\.vtr overlap: .*vtkGhostType")
        self.write("a.pvtr", index_text(kind, [(wide, pieces[0][1])] + pieces[1:]))
        self.refuses(4, "info", parts, says=r"has the points -2 to 1 along x, but .*a\.pvtr says that it has -2 to 2")
        early = [(0, 6), *boxes()[4][1:]]
        self.write("a.pvtr", index_text(kind, pieces[:4] + [(early, pieces[4][1])] + pieces[5:]))
        self.refuses(4, "info", parts, says=r"has the points 1 to 6 along x, but .*a\.pvtr says that it has 0 to 6")
        self.write("a.pvtr", index_text(kind, pieces + [([(6, 7), (5, 6), (3, 4)], "p/more.vtr")]))
        self.write("p/more.vtr", piece_text(kind, [(6, 7), (5, 6), (3, 4)]))
        self.refuses(4, "info", parts, says="outside of WholeExtent")
        odd = [("vtkGhostType", "u8", [int(c == (-1, 3, 1)) for c in cells_of(boxes()[0])])]
        self.write(pieces[0][1], piece_text(kind, boxes()[0], more_cells=odd))
        self.write("a.pvtr", index_text(kind, pieces))
        self.refuses(4, "info", parts, says="no ghosts .* fill no box")

    def test_pieces_differ(self):
        """In their arrays: an error. In a value at a point that they share: a notice."""
        kind = "StructuredGrid"
        parts = self.divided(kind)
        name = f"p/{kind}_1.vts"
        text = text_of(self.path(name))
        for change, says in (((' Name="x"', ' Name="y"'), r"_1\.vts: has no array 'x' of points"),
                             (('Float32" Name="x"', 'Float64" Name="x"'), "'x' has 1 values of Float64 each"),
                             (('Int32" Name="number"', 'Int16" Name="number"'), "'number' has 1 values of Int16"),
                             (("<CellData>", "<CellData>" + data_array("z", "u8", [1] * 500)),
                              r"_0\.vts: has no array 'z' of cells, which .*_1\.vts has"),
                             (('Float32" Name="Points"', 'Float64" Name="Points"'), "coordinates are of double"),
                             (("StructuredGrid", "UnstructuredGrid"), "holds UnstructuredGrid, but .* StructuredGrid"),
                             (("<VTKFile", "<Other"), "is no VTK XML file")):
            self.assertIn(change[0], text)
            self.write(name, text.replace(*change))
            self.refuses(4, "info", parts, says=says)
        first = numbers([value(boxes()[1][axis][0] for axis in range(3))])
        self.write(name, text.replace(first, "9.75", 1))
        self.assertIn("pieces differ in 'bump' where they meet; the later one's is taken",
                      " ".join(self.notices([parts, "--field", "bump"], 0.5)))
        self.write(name, text.replace(numbers(place((-2, 3, 3))), "-1.5 2.5 3.75", 1))
        self.assertIn("pieces differ in coordinates", " ".join(self.notices([parts, "--field", "bump"], 0.5)))

        parts = self.divided("RectilinearGrid")
        name = self.path("p/RectilinearGrid_4.vtr")  # behind the first along x
        text = text_of(name)
        first = repr(1.25 + 1 / 64)
        self.assertIn(f">{first} ", text)
        self.write("p/RectilinearGrid_4.vtr", text.replace(f">{first} ", ">1.3 "))
        self.assertIn("pieces differ in coordinates", " ".join(self.notices([parts, "--field", "bump"], 0.5)))

    def test_appended(self):
        """Values that are used in the mapped file, or swapped: regions take them from the whole."""
        for kind, ending in ENDINGS.items():
            whole = self.write("whole." + ending, piece_text(kind, whole_extent()))
            for order in "<", ">", "<>":  # of all pieces, or one after the other
                parts = self.divided(kind, 1)
                for n in range(8):
                    name = f"p/{kind}_{n}.{ending}"
                    self.write(name, appended(text_of(self.path(name)), order[n % len(order)]))
                for more in ([], ["--roi", "-1:5,4:10,:"], ["--step", "2,1,1"]):
                    self.same(whole, parts, "--field", "bump", "--iso", "0.5", *more)
                    self.same(whole, parts, "--field", "number", "--iso", "200", *more)

    def test_files(self):
        """Only in the index file's folder or below, each once, and there."""
        kind = "ImageData"
        names = [f"p/{kind}_{n}.vti" for n in range(8)]
        parts = self.divided(kind)
        self.expect(0, "info", parts)
        for name, says in (("/tmp/a.vti", "no absolute path"), ("p/../p/" + names[0][2:], r"no '\.\.'"),
                           ("p/missing.vti", "missing.vti: cannot be opened"), (names[1], "twice"), ("", "characters")):
            self.divided(kind, names=[name] + names[1:])
            self.refuses(4, "info", parts, says=says)
        os.symlink(os.path.join("..", "p", names[1][2:]), self.path("p/link.vti"))
        self.divided(kind, names=["p/link.vti"] + names[1:])
        self.refuses(4, "info", parts, says="twice")
        self.write("a.pvti", index_text(kind, []))
        self.refuses(4, "info", parts, says="names no file that holds a piece")
        empty = '<Piece Extent="0 -1 0 -1 0 -1"/>'
        self.divided(kind)
        text = text_of(parts)
        self.write("a.pvti", text.replace("</PImageData>", empty + "</PImageData>"))
        self.same(self.write("whole.vti", piece_text(kind, whole_extent())), parts, "--field", "bump", "--iso", "0.5")
        self.write("a.pvti", text.replace("</PImageData>", '<Piece Extent="0 1 0 1 0 1"/></PImageData>'))
        self.refuses(4, "info", parts, says="has no Source")
        self.write("a.pvti", text[:-20])
        self.refuses(4, "info", parts, says="not XML to its end")


# ---------------------------------------------------------------------------------------------------------- unstructured

SIZE = (9, 9, 9)


def six_tetrahedra(cell):
    """Kuhn's: neighbours agree, whatever the numbers."""
    corner = dict(zip(HEXAHEDRON_ORDER, cell))
    for order in itertools.permutations(range(3)):
        at, path = [0, 0, 0], [corner[0, 0, 0]]
        for axis in order:
            at[axis] = 1
            path.append(corner[tuple(at)])
        yield path


def unstructured(kind):
    cells = hexahedra(SIZE)
    if kind == TETRAHEDRON:
        cells = [tetrahedron for cell in cells for tetrahedron in six_tetrahedra(cell)]
    return lattice(SIZE), cells


def with_numbers(text, points, cells):
    """GlobalIds of points and cells: two more arrays, which VTK calls by an attribute of the section."""
    for section, name, values in (("PointData", "pid", points), ("CellData", "cid", cells)):
        array = data_array(name, "i32", values)
        text = text.replace(f"<{section}>", f'<{section} GlobalIds="{name}">{array}', 1)
    return text


class Cells(GridCase):
    def setUp(self):
        super().setUp()
        self.needs_xml()

    def write_divided(self, kind, owner, numbered=False, ghosts=False, marked=True, faces=None, values=bump):
        """owner: of a cell, by its number, its piece of three; neighbours are ghosts in it. Returns whole and index."""
        points, cells = unstructured(kind)
        owners = [owner(n, [points[p] for p in cell]) for n, cell in enumerate(cells)]
        whole = vtu_text(points, cells, [kind] * len(cells), [("bump", "f64", list(map(values, points)))],
                         [("number", "f32", [float(n % 89) for n in range(len(cells))])],
                         faces and list(map(faces, cells)))
        index = []
        for piece in range(3):
            own = {p for n, cell in enumerate(cells) if owners[n] == piece for p in cell}
            taken = [n for n, cell in enumerate(cells) if owners[n] == piece or (ghosts and own & set(cell))]
            taken.sort(key=lambda n: n * 7919 % 4801)  # in an order of its own
            used = sorted({p for n in taken for p in cells[n]}, key=lambda p: p * 7907 % 1009)
            local = {p: n for n, p in enumerate(used)}
            marks = [("vtkGhostType", "u8", [int(owners[n] != piece) for n in taken])] if ghosts and marked else []
            text = vtu_text([points[p] for p in used], [[local[p] for p in cells[n]] for n in taken], [kind] * len(taken),
                            [("bump", "f64", [values(points[p]) for p in used])],
                            [("number", "f32", [float(n % 89) for n in taken])] + marks,
                            faces and [[[local[p] for p in face] for face in faces(cells[n])] for n in taken])
            self.write(f"piece{piece}.vtu", with_numbers(text, used, taken) if numbered else text)
            index.append(f'<Piece Source="piece{piece}.vtu"/>')
        return (self.write("whole.vtu", with_numbers(whole, range(len(points)), range(len(cells))) if numbered else whole),
                self.write("a.pvtu", vtk_file("PUnstructuredGrid", ' GhostLevel="0">' + "".join(index))))

    @staticmethod
    def scattered(n, _):
        return n * 31 % 97 % 3

    @staticmethod
    def halves(_, corners):
        return min(sum(c[0] for c in corners) // len(corners) // 3, 2)

    def compare(self, whole, parts, *arguments, same=True):
        one, other = (self.surface(path, *arguments)[1] for path in (whole, parts))
        self.assertEqual([one[key] for key in ("boundary_edges", "nonmanifold_edges", "misoriented_edges",
                                               "euler_characteristic", "components")],
                         [other[key] for key in ("boundary_edges", "nonmanifold_edges", "misoriented_edges",
                                                 "euler_characteristic", "components")])
        if same:
            self.assertEqual(one["hash"], other["hash"])
        return one, other

    def test_numbered(self):
        """With global numbers of points and cells the whole is the grid that was divided, byte for byte."""
        def faces(cell):
            return [[cell[n] for n in face] for face in ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5),
                                                         (2, 3, 7, 6), (3, 0, 4, 7))]
        for kind, of in ((HEXAHEDRON, None), (TETRAHEDRON, None), (POLYHEDRON, faces)):
            for owner in (self.scattered, self.halves):
                for ghosts in (False, True):
                    with self.subTest(kind=kind, owner=owner.__name__, ghosts=ghosts):
                        whole, parts = self.write_divided(kind, owner, True, ghosts, faces=of)
                        self.compare(whole, parts, "--field", "bump", "--iso", "0.5")
                        self.compare(whole, parts, "--field", "number", "--iso", "40")

    def test_by_place(self):
        """Without them the same surface, closed across the pieces."""
        for kind in (TETRAHEDRON, HEXAHEDRON):
            for ghosts in (False, True):
                whole, parts = self.write_divided(kind, self.scattered, False, ghosts)
                one, other = self.compare(whole, parts, "--field", "bump", "--iso", "0.5", same=False)
                self.assertEqual((one["boundary_edges"], one["components"]), (0, 1))
                if kind == TETRAHEDRON:
                    self.assertEqual(counts(one), counts(other))
                    self.assertAlmostEqual(one["area"], other["area"], places=4)
                    self.compare(whole, parts, "--field", "number", "--iso", "40", same=False)

    def test_overlap(self):
        for numbered in (False, True):
            _, parts = self.write_divided(HEXAHEDRON, self.halves, numbered, ghosts=True, marked=False)
            self.refuses(4, "info", parts, says=r"piece\d\.vtu and .*piece\d\.vtu overlap: both have one cell")

    def test_cracks(self):
        """Two points at a place in one piece: told apart by their values; not joined where these are equal."""
        points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1)]
        cells = [[0, 1, 2, 3], [0, 2, 1, 4]]

        def pair(name, values):
            """Both tetrahedra in one file, with points of their own where the values differ."""
            flat = [points[p] for cell in cells for p in cell]
            return self.write(name, vtu_text(flat, [[0, 1, 2, 3], [4, 5, 6, 7]], [TETRAHEDRON] * 2,
                                             [("a", "f32", [v[p] for v, cell in zip(values, cells) for p in cell])]))
        pair("p0.vtu", [[0.0, 1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0, 9.0]])
        far = [(1, 1, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        self.write("p1.vtu", vtu_text(far, [[0, 1, 2, 3]], [TETRAHEDRON], [("a", "f32", [0.5, 1.0, 2.0, 3.0])]))
        index = self.write("a.pvtu", vtk_file("PUnstructuredGrid", '><Piece Source="p0.vtu"/><Piece Source="p1.vtu"/>'))
        _, surface = self.surface(index, "--iso", "1.5")  # in the first cell and the one of the other file
        self.assertEqual(surface["components"], 1)
        pair("p0.vtu", [[0.0, 1.0, 2.0, 3.0, 4.0]] * 2)
        told = self.notices([index], 1.5)
        self.assertTrue(any("at 3 places a piece has several points" in text for text in told), told)

    def test_zeros(self):
        """0 and -0 are one place."""
        for n, (last, zero) in enumerate((((0, 0, 1), 0.0), ((0, 0, -1), -0.0))):
            points = [(zero, zero, 0), (1, zero, 0), (zero, 1, 0), last]
            self.write(f"p{n}.vtu", vtu_text([tuple(map(float, p)) for p in points], [[0, 1, 2, 3]], [TETRAHEDRON],
                                             [("a", "f32", [0.0, 1.0, 1.0, 0.25])]))
        index = self.write("a.pvtu", vtk_file("PUnstructuredGrid", '><Piece Source="p0.vtu"/><Piece Source="p1.vtu"/>'))
        self.assertEqual(self.surface(index, "--iso", "0.5")[1]["components"], 1)

    def test_differences(self):
        _, parts = self.write_divided(TETRAHEDRON, self.halves)
        text = text_of(self.path("piece1.vtu"))
        ours = repr(bump((3, 0, 0)))
        self.assertEqual(text.count(ours), 1)
        self.write("piece1.vtu", text.replace(ours, "9.125"))
        told = self.notices([parts, "--field", "bump"], 0.5)
        self.assertTrue(any("pieces differ at 1 of the points" in text for text in told), told)
        _, parts = self.write_divided(TETRAHEDRON, self.halves, True)
        text = text_of(self.path("piece1.vtu"))
        at = text.index('Name="pid"')
        begin, end = text.index(">", at) + 1, text.index("<", at)
        first, second, *_ = text[begin:end].split()
        self.write("piece1.vtu", text[:begin] + text[begin:end].replace(second, first, 1) + text[end:])
        self.refuses(4, "info", parts, says=r"piece1\.vtu: has several points of the global number " + first)


class Blocks(GridCase):
    def setUp(self):
        super().setUp()
        self.needs_xml()

    def test_blocks(self):
        """Every block of a list, lists of pieces among them; surfaces are left out."""
        halves = [[(0, 4), (0, 8), (0, 8)], [(4, 8), (0, 8), (0, 8)]]

        def image(name, extent):
            fields = [("bump", "f64", list(map(bump, points_of(extent))))]
            return self.write(name, vtk_file("ImageData", f' WholeExtent="{extent_text(extent)}"><Piece Extent="'
                              f'{extent_text(extent)}">{attributes("PointData", fields)}</Piece>'))
        files = [image(f"{n}.vti", half) for n, half in enumerate(halves)]
        single = [self.surface(path, "--iso", "0.5")[1] for path in files]
        blocks = '<Block index="0" name="a"><DataSet index="0" file="0.vti"/><DataSet index="3"/></Block>'
        rest = '<DataSet index="1" name="b" file="1.vti"/>'
        joined = self.write("a.vtm", vtk_file("vtkMultiBlockDataSet", ">" + blocks + rest))
        report, surface = self.surface(joined, "--iso", "0.5")
        self.assertEqual(surface["triangles"], sum(s["triangles"] for s in single))
        self.assertEqual(len(self.report("info", joined, "--field", "bump")["blocks"]), 2)
        pieces = "".join(f'<Piece Extent="{extent_text(half)}" Source="{n}.vti"/>' for n, half in enumerate(halves))
        self.write("b.pvti", vtk_file("PImageData", ' WholeExtent="0 8 0 8 0 8">' + pieces))
        self.write("c.vtp", vtk_file("PolyData", ">"))
        nested = self.write("b.vtmb", vtk_file("vtkMultiBlockDataSet",
                                               '><Block><Piece><DataSet file="b.pvti"/></Piece></Block><DataSet file="c.vtp"/>'))
        _, one = self.surface(nested, "--iso", "0.5")
        _, other = self.surface(image("whole.vti", [(0, 8)] * 3), "--iso", "0.5")
        self.assertEqual(one["hash"], other["hash"])
        self.assertIn("surfaces, are left out", " ".join(self.notices([nested], 0.5)))
        self.write("d.vtm", vtk_file("vtkMultiBlockDataSet", '><DataSet file="d.vtm"/>'))
        self.refuses(4, "info", self.path("d.vtm"), says="twice|more than 3 deep")
        self.write("d.vtm", vtk_file("vtkMultiBlockDataSet", '><DataSet file="c.vtp"/>'))
        self.refuses(4, "info", self.path("d.vtm"), says="none of its blocks")
        self.write("d.vtm", vtk_file("vtkMultiBlockDataSet", '><DataSet file="0.vti"/><DataSet file="b.pvti"/>'))
        self.refuses(4, "info", self.path("d.vtm"), says="twice")


if __name__ == "__main__":
    tool_case.main()
