#!/usr/bin/env python3
"""test_cli_vtkhdf.py TOOL [reference] - unstructured grids of VTKHDF, written by h5py (Debian: python3-h5py): the surface of the
same grid as VTK XML, in one part or in several, of any step of time; files that are damaged are refused"""
import itertools
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from grid_files import HEXAHEDRON, POLYHEDRON, bump, hexahedra, lattice, vtu_text
from tool_case import GridCase

try:
    import h5py
    import numpy
except ImportError:
    h5py = numpy = None

SIZE = (9, 8, 9)
FACES = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


class Part:
    """Points by their numbers in the whole, and cells of these, in an order of its own."""
    def __init__(self, cells, taken, owned):
        self.cells = sorted(taken, key=lambda n: n * 7919 % 4801)
        self.points = sorted({p for n in self.cells for p in cells[n]}, key=lambda p: p * 7907 % 1009)
        local = {p: n for n, p in enumerate(self.points)}
        self.corners = [[local[p] for p in cells[n]] for n in self.cells]
        self.ghosts = [int(n not in owned) for n in self.cells]


def joined(lists):
    return list(itertools.chain(*lists))


def ends(lists):
    return [0, *itertools.accumulate(map(len, lists))]


class Grid:
    def __init__(self):
        self.points, self.cells = lattice(SIZE), hexahedra(SIZE)
        self.steps = [self.values(step) for step in range(3)]

    def values(self, step):
        return [bump(p) + step * 0.75 * p[0] for p in self.points]

    def whole(self):
        """One part, in the order of the grid."""
        part = Part(self.cells, range(len(self.cells)), range(len(self.cells)))
        part.cells, part.points, part.corners = sorted(part.cells), sorted(part.points), self.cells
        return part

    def parts(self, count, ghosts=False):
        owners = [n * 31 % 97 % count for n in range(len(self.cells))]
        parts = []
        for part in range(count):
            owned = {n for n, owner in enumerate(owners) if owner == part}
            near = {p for n in owned for p in self.cells[n]}
            taken = [n for n, cell in enumerate(self.cells) if n in owned or (ghosts and near & set(cell))]
            parts.append(Part(self.cells, taken, owned))
        return parts

    def write(self, path, parts, numbered=True, faces=False, kinds=("<f8", "<i8"), steps=None, **form):
        """steps: the same grid in steps of time, each with other values."""
        real, whole = kinds
        number = [n for part in parts for n in part.points]

        def add(group, name, values, kind=whole, attribute=None, plain=False):
            made = group.create_dataset(name, data=numpy.array(values).astype(kind), **({} if plain else form))
            if attribute:
                made.attrs["Attribute"] = numpy.bytes_(attribute)

        with h5py.File(path, "w") as file:
            root = file.create_group("VTKHDF")
            root.attrs["Version"] = numpy.array([2, 3])
            root.attrs["Type"] = numpy.bytes_("UnstructuredGrid")
            add(root, "NumberOfPoints", [len(p.points) for p in parts], plain=True)
            add(root, "NumberOfCells", [len(p.cells) for p in parts], plain=True)
            add(root, "NumberOfConnectivityIds", [8 * len(p.cells) for p in parts], plain=True)
            add(root, "Points", [self.points[n] for n in number], real)
            add(root, "Types", [POLYHEDRON if faces else HEXAHEDRON] * sum(len(p.cells) for p in parts), "u1")
            add(root, "Offsets", joined(ends(p.corners) for p in parts))
            add(root, "Connectivity", joined(joined(p.corners) for p in parts))
            points, cells = root.create_group("PointData"), root.create_group("CellData")
            add(points, "bump", [self.steps[s][n] for s in (steps or [0]) for n in number], "<f8", "Scalars")
            add(points, "x", [self.points[n][0] for n in number] * len(steps or [0]), real)
            add(cells, "number", [n % 89 for part in parts for n in part.cells] * len(steps or [0]), "<f4")
            if numbered:
                add(points, "pid", number * len(steps or [0]), whole, "GlobalIds")
                add(cells, "cid", [n for p in parts for n in p.cells] * len(steps or [0]), whole, "GlobalIds")
            if any(joined(p.ghosts for p in parts)):
                add(cells, "vtkGhostType", joined(p.ghosts for p in parts) * len(steps or [0]), "u1")
            if faces:
                self.write_faces(root, parts, add)
            if steps:
                self.write_steps(root, len(number), sum(len(p.cells) for p in parts), len(parts), len(steps), add)
        return path

    @staticmethod
    def write_faces(root, parts, add):
        streams = [[[cell[n] for n in face] for cell in p.corners for face in FACES] for p in parts]
        add(root, "NumberOfFaces", [len(s) for s in streams], plain=True)
        add(root, "NumberOfFaceConnectivityIds", [4 * len(s) for s in streams], plain=True)
        add(root, "NumberOfPolyhedronToFaceIds", [len(s) for s in streams], plain=True)
        add(root, "FaceOffsets", joined(ends(s) for s in streams))
        add(root, "FaceConnectivity", joined(joined(s) for s in streams))
        add(root, "PolyhedronToFaces", joined(range(len(s)) for s in streams))
        add(root, "PolyhedronOffsets", joined(range(0, 6 * len(p.cells) + 1, 6) for p in parts))

    @staticmethod
    def write_steps(root, points, cells, parts, count, add):
        """One mesh for all."""
        group = root.create_group("Steps")
        group.attrs["NSteps"] = count
        for name in ("PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"):
            add(group, name, [0] * count, plain=True)
        add(group, "NumberOfParts", [parts] * count, plain=True)
        of_points, of_cells = group.create_group("PointDataOffsets"), group.create_group("CellDataOffsets")
        for name in root["PointData"]:
            add(of_points, name, [n * points for n in range(count)], plain=True)
        for name in root["CellData"]:
            add(of_cells, name, [n * cells for n in range(count)], plain=True)


@tool_case.unittest.skipUnless(h5py, "Python has no h5py (Debian: python3-h5py)")
class Unstructured(GridCase):
    def setUp(self):
        super().setUp()
        self.needs_xml()
        if "VTKHDF" not in self.expect(0, "--version").stdout:
            self.skipTest("built without libhdf5")
        self.grid = Grid()
        self.file = self.path("a.vtkhdf")

    def wanted(self, step=0, faces=False):
        g = self.grid
        streams = [[[cell[n] for n in face] for face in FACES] for cell in g.cells] if faces else ()
        text = vtu_text(g.points, g.cells, [POLYHEDRON if faces else HEXAHEDRON] * len(g.cells),
                        [("bump", "f64", g.steps[step])], [("number", "f32", [float(n % 89) for n in range(len(g.cells))])],
                        streams)
        self.write("whole.vtu", text)
        return [self.surface(self.path("whole.vtu"), "--field", name, "--iso", iso)[1]["hash"]
                for name, iso in (("bump", "0.5"), ("number", "40"))]

    def found(self, *more):
        return [self.surface(self.file, "--field", name, "--iso", iso, *more)[1]["hash"]
                for name, iso in (("bump", "0.5"), ("number", "40"))]

    def test_one_part(self):
        for faces in (False, True):
            wanted = self.wanted(faces=faces)
            for kinds, form in itertools.product((("<f8", "<i8"), (">f4", "<i4"), ("<f4", ">u8"), (">f8", "u2")),
                                                 ({}, dict(chunks=True), dict(chunks=True, compression="gzip"))):
                with self.subTest(faces=faces, kinds=kinds, form=form):
                    self.grid.write(self.file, [self.grid.whole()], faces=faces, kinds=kinds, **form)
                    self.assertEqual(self.found(), wanted)

    def test_parts(self):
        """With numbers the whole, byte for byte; without them the same surface."""
        for faces, ghosts in itertools.product((False, True), repeat=2):
            wanted = self.wanted(faces=faces)
            self.grid.write(self.file, self.grid.parts(3, ghosts), faces=faces)
            self.assertEqual(self.found(), wanted)
            self.grid.write(self.file, self.grid.parts(3, ghosts), numbered=False, faces=faces)
            _, surface = self.surface(self.file, "--field", "bump", "--iso", "0.5")
            self.assertEqual((surface["boundary_edges"], surface["nonmanifold_edges"], surface["components"]), (0, 0, 1))
        info = self.report("info", self.file, "--field", "bump")
        self.assertEqual(info["format"], "VTKHDF")

    def test_active_scalars(self):
        self.grid.write(self.file, self.grid.parts(1))
        self.assertIn("'bump' is taken, its active scalars", " ".join(self.notices([self.file], 0.5)))

    def test_steps(self):
        self.grid.write(self.file, self.grid.parts(2), steps=range(3))
        for step in range(3):
            self.assertEqual(self.found("--frame", step), self.wanted(step))
        self.refuses(2, "extract", self.file, "--iso", "1", "--count", says="3 steps of time: choose by --frame")
        self.refuses(2, "info", self.file, "--frame", "3", says="there is no --frame 3")
        self.expect(0, "info", self.file, "--field", "bump", says="the first is described")
        self.grid.write(self.file, self.grid.parts(2))
        self.refuses(2, "info", self.file, "--frame", "1", says="has one frame")

    def test_overlap(self):
        parts = self.grid.parts(2, ghosts=True)
        for part in parts:
            part.ghosts = [0] * len(part.cells)
        self.grid.write(self.file, parts)
        self.refuses(4, "info", self.file, says="part 0 and .*part 1 overlap")

    def test_damaged(self):
        def change(name, values):
            self.grid.write(self.file, self.grid.parts(2), faces=True)
            with h5py.File(self.file, "a") as file:
                del file["VTKHDF/" + name]
                if values is not None:
                    file["VTKHDF/" + name] = numpy.array(values)
        self.grid.write(self.file, self.grid.parts(2), faces=True)
        with h5py.File(self.file) as file:
            arrays = {name: file["VTKHDF/" + name][()] for name in
                      ("NumberOfPoints", "Offsets", "Connectivity", "Types", "FaceOffsets", "PolyhedronToFaces",
                       "PolyhedronOffsets", "NumberOfFaces", "Points", "PointData/bump")}
        for name, values, says in (
                ("NumberOfPoints", None, "NumberOfPoints"), ("NumberOfPoints", [-1, 5], "makes no sense"),
                ("NumberOfPoints", [2**62, 2**62], "makes no sense"), ("NumberOfPoints", [5], "tell of 1 parts, and of 2"),
                ("NumberOfPoints", arrays["NumberOfPoints"] + 10**9, "has .* rows, but"),
                ("NumberOfPoints", [0, 0], "holds no points"), ("NumberOfPoints", [1.5, 2], "not of single integers"),
                ("Points", arrays["Points"][:, :2], "not of three numbers"), ("Points", arrays["Points"][:-1], "rows, but"),
                ("Offsets", arrays["Offsets"] + 1, "other Offsets"), ("Offsets", arrays["Offsets"][::-1], "Offsets"),
                ("Offsets", arrays["Offsets"][[0, 2, 1, *range(3, len(arrays["Offsets"]))]], "Offsets that fall"),
                ("Connectivity", arrays["Connectivity"] + 10**6, "name a point"), ("Connectivity", -arrays["Connectivity"],
                                                                                   "name a point"),
                ("Types", arrays["Types"].astype("i4"), "Types"), ("PolyhedronToFaces", arrays["PolyhedronToFaces"] + 9**9,
                                                                  "faces"),
                ("FaceOffsets", arrays["FaceOffsets"] + 2**40, "faces"), ("PolyhedronOffsets", None, "PolyhedronOffsets"),
                ("NumberOfFaces", arrays["NumberOfFaces"] + 2**50, "rows, but"),
                ("PointData/bump", arrays["PointData/bump"][:-1], "rows, but"),
                ("PointData/bump", numpy.zeros((9, 9, 9)), "not one row")):
            with self.subTest(name=name, says=says):
                change(name, values)
                self.refuses(4, "info", self.file, says=says)
        self.grid.write(self.file, self.grid.parts(2))
        with h5py.File(self.file, "a") as file:
            file["VTKHDF/PointData/text"] = numpy.array([b"a", b"b"])
            file["VTKHDF/PointData/far"] = h5py.ExternalLink("b.h5", "/x")
        told = " ".join(self.notices([self.file], 0.5))
        self.assertIn("'text' is left out", told)
        self.assertNotIn("'far'", told)
        with h5py.File(self.file, "a") as file:
            del file["VTKHDF/Points"]
            file["VTKHDF/Points"] = h5py.ExternalLink("b.h5", "/x")
        self.refuses(4, "info", self.file, says="link to another file")
        for kind, says in (("PolyData", "PolyData, a surface"), ("OverlappingAMR", "holds OverlappingAMR; of VTKHDF")):
            with h5py.File(self.file, "a") as file:
                file["VTKHDF"].attrs["Type"] = numpy.bytes_(kind)
            self.refuses(4, "info", self.file, says=says)

    def test_shared_arrays(self):
        """Many names of one array do not ask for more memory than the file bounds."""
        self.grid.write(self.file, self.grid.parts(1), chunks=True)
        with h5py.File(self.file, "a") as file:
            for n in range(4000):
                file[f"VTKHDF/PointData/n{n}"] = file["VTKHDF/PointData/bump"]
        self.refuses(4, "info", self.file, says="share the same data")


if __name__ == "__main__":
    tool_case.main()
