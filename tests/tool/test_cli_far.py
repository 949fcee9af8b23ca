#!/usr/bin/env python3
"""test_cli_far.py TOOL [reference] - coordinates far from zero, from file to file

A small grid of every kind is written twice, near zero and at UTM coordinates, in double precision. What is written of
its surface must be the same shape at the right place: VTP and PLY in doubles, OBJ in text, STL relative to a point that
is told or chosen.
"""
import itertools
import json
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from grid_files import HEXAHEDRON, attributes, bump, data_array, hexahedra, lattice, structured_text, vtk_file
from meshes import READERS, measures, read_ply, read_stl
from tool_case import GridCase

DIMS = (9, 8, 9)
UTM = (500000.0, 4649776.0, 200.0)
CELL = 0.25
ISO = "1.5"


def placed(at, dims=DIMS, first=(0, 0, 0)):
    """Points of a slightly bent lattice, exact in double precision wherever it lies."""
    bent = [(x + (y % 2) / 8, y, z + (x % 3) / 16) for x, y, z in lattice(dims, first)]
    return [tuple(at[axis] + CELL * p[axis] for axis in range(3)) for p in bent]


def field(first=(0, 0, 0), dims=DIMS):
    return [("bump", "f64", [bump(p) for p in lattice(dims, first)])]


def vtu_piece(points, cells, values):
    arrays = (data_array("connectivity", "i32", list(itertools.chain(*cells)))
              + data_array("offsets", "i32", [8 * (n + 1) for n in range(len(cells))])
              + data_array("types", "u8", [HEXAHEDRON] * len(cells)))
    return (f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}">'
            f'{attributes("PointData", [("bump", "f64", values)])}'
            f'<Points>{data_array("Points", "f64", list(itertools.chain(*points)), 3)}</Points>'
            f"<Cells>{arrays}</Cells></Piece>")


def vtu(at, extra=()):
    points, values = placed(at) + list(extra), field()[0][2] + [0.0] * len(extra)
    return vtk_file("UnstructuredGrid", ">" + vtu_piece(points, hexahedra(DIMS), values))


def vtu_pieces(*places, dims=DIMS):
    """A piece, and so a block, at each place: where it lies and its first index."""
    return vtk_file("UnstructuredGrid", ">" + "".join(
        vtu_piece(placed(at, dims, first), hexahedra(dims), field(first, dims)[0][2]) for at, first in places))


def vts_piece(at, first, dims):
    flat = list(itertools.chain(*placed(at, dims, first)))
    extent = " ".join(f"{first[axis]} {first[axis] + dims[axis] - 1}" for axis in range(3))
    return (f'<Piece Extent="{extent}">{attributes("PointData", field(first, dims))}'
            f'<Points>{data_array("Points", "f64", flat, 3)}</Points></Piece>')


def vts(at):
    """Two pieces that share a plane."""
    whole = " ".join(f"0 {n - 1}" for n in DIMS)
    return vtk_file("StructuredGrid", f' WholeExtent="{whole}">' + vts_piece(at, (0, 0, 0), (5, 8, 9))
                    + vts_piece(at, (4, 0, 0), (5, 8, 9)))


def vtr(at):
    axes = "".join(data_array("xyz"[axis], "f64", [at[axis] + CELL * n + (n % 2) / 16 for n in range(DIMS[axis])])
                   for axis in range(3))
    return structured_text("RectilinearGrid", DIMS, (0, 0, 0), f"<Coordinates>{axes}</Coordinates>", field())


def vti(at):
    more = ' Origin="{!r} {!r} {!r}" Spacing="{!r} {!r} {!r}"'.format(*at, CELL, CELL, CELL)
    return structured_text("ImageData", DIMS, (0, 0, 0), "", field(), more=more)


def legacy(at):
    flat = " ".join(f"{value!r}" for value in itertools.chain(*placed(at)))
    values = " ".join(f"{value!r}" for value in field()[0][2])
    count = math.prod(DIMS)
    return ("# vtk DataFile Version 3.0\nfar\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS {} {} {}\n".format(*DIMS)
            + f"POINTS {count} double\n{flat}\nPOINT_DATA {count}\nSCALARS bump double\nLOOKUP_TABLE default\n{values}\n")


KINDS = {"far.vtu": vtu, "far.vts": vts, "far.vtr": vtr, "far.vti": vti, "far.vtk": legacy}


class Far(GridCase):
    def both(self, name, *more):
        """Reports of the grid near and far."""
        make = KINDS[name]
        near = self.surface(self.write("near" + name[3:], make((0.0, 0.0, 0.0))), "--iso", ISO)[1]
        far = self.surface(self.write(name, make(UTM)), "--iso", ISO, *more)[1]
        return near, far

    def setUp(self):
        super().setUp()
        self.needs_xml()

    def test_every_kind_keeps_its_shape(self):
        for name in KINDS:
            with self.subTest(file=name):
                near, far = self.both(name)
                for key in ("vertices", "triangles", "boundary_edges", "euler_characteristic", "components"):
                    self.assertEqual(near[key], far[key], key)
                self.assertGreater(near["triangles"], 100)
                self.assertLess(abs(far["area"] / near["area"] - 1), 1e-6)
                self.assertEqual([far[key] for key in ("misoriented_edges", "nonmanifold_edges")], [0, 0])
                for axis in range(3):
                    for end in range(2):
                        self.assertAlmostEqual(far["bounds"][end][axis], near["bounds"][end][axis] + UTM[axis], delta=1e-5)
                self.assertEqual(near["origin"], [0, 0, 0])
                self.assertNotEqual(far["origin"][1], 0)

    def test_files_hold_full_coordinates(self):
        for name, ending in itertools.product(KINDS, ("ply", "vtp", "obj")):
            with self.subTest(file=name, written=ending):
                near, _ = self.both(name)
                out = self.path("out." + ending)
                self.expect(0, "extract", self.path(name), "--iso", ISO, "-o", out, "--engine", "reference")
                points, faces, layout = READERS[ending](out)
                self.assertEqual(layout, "ddd")
                area, _ = measures(points, faces)
                self.assertLess(abs(area / near["area"] - 1), 1e-6)
                for axis in range(3):
                    low, high = min(p[axis] for p in points), max(p[axis] for p in points)
                    self.assertAlmostEqual(low, near["bounds"][0][axis] + UTM[axis], delta=1e-5)
                    self.assertAlmostEqual(high, near["bounds"][1][axis] + UTM[axis], delta=1e-5)

    def test_near_files_stay_float32(self):
        source = self.write("near.vtu", vtu((0.0, 0.0, 0.0)))
        for ending in ("ply", "vtp"):
            out = self.path("out." + ending)
            self.expect(0, "extract", source, "--iso", ISO, "-o", out, "--engine", "reference")
            self.assertEqual(READERS[ending](out)[2], "fff")

    def test_stl(self):
        near, far = self.both("far.vtu")
        source, out = self.path("far.vtu"), self.path("out.stl")
        result = self.expect(0, "extract", source, "--iso", ISO, "-o", out, "--engine", "reference")
        self.assertRegex(result.stderr, r"relative to 500000,\d+,\d+.*--origin-at")
        points, faces, _ = read_stl(out)
        self.assertLess(abs(measures(points, faces)[0] / near["area"] - 1), 1e-5)
        for axis in range(3):
            self.assertAlmostEqual(min(p[axis] for p in points) + far["origin"][axis], far["bounds"][0][axis], delta=1e-5)
        result = self.expect(0, "extract", source, "--iso", ISO, "-o", out, "--quiet", "--engine", "reference")
        self.assertEqual(result.stderr, "")

    def test_stl_where_float32_is_fine(self):
        """As of a CT whose table lies 1,000 mm away: world coordinates, in streams, parts and regions too."""
        source, iso = self.path("ct.nrrd"), "127.5"
        at = ["--spacing", "1,1,1", "--origin", "-10,-10,1000", "--engine", "reference"]
        self.expect(0, "generate", "sphere", "--dims", "20,20,24", "--type", "f32", "-o", source)
        for ending, read in (("stl", read_stl), ("ply", read_ply)):
            out = self.path("ct." + ending)
            result = self.expect(0, "extract", source, "--iso", iso, "-o", out, *at)
            self.assertEqual(result.stderr, "")
            points, _, _ = read(out)
            self.assertGreater(min(p[2] for p in points), 1000)
        stl = self.path("ct.stl")
        streamed = self.path("streamed.stl")
        self.expect(0, "extract", source, "--iso", iso, "-o", streamed, "--stream", *at)
        parts = [self.path(f"{n}.part") for n in (0, 1)]
        for n, part in enumerate(parts):
            self.expect(0, "extract", source, "--iso", iso, "-o", part, "--part", f"{n}/2", *at)
        joined = self.path("joined.stl")
        self.assertEqual(self.expect(0, "join", *parts, "-o", joined).stderr, "")
        with open(stl, "rb") as file:
            whole = file.read()
        for path in (streamed, joined):
            with open(path, "rb") as file:
                self.assertEqual(file.read(), whole, path)
        half = self.path("half.stl")
        self.expect(0, "extract", source, "--iso", iso, "-o", half, "--roi", ":,:,0:8", *at)
        self.assertGreater(min(p[2] for p in read_stl(half)[0]), 1000)
        far = self.path("far.stl")
        result = self.expect(0, "extract", source, "--iso", iso, "-o", far, "--spacing", "1,1,1", "--origin", "-10,-10,1e6", *at[4:])
        self.assertIn("relative to", result.stderr)

    def test_origin_at(self):
        near, _ = self.both("far.vtu")
        at = [value - 3 for value in UTM]
        for ending, reader in READERS.items():
            with self.subTest(written=ending):
                out = self.path("out." + ending)
                result = self.expect(0, "extract", self.path("far.vtu"), "--iso", ISO, "-o", out, "--origin-at",
                                     ",".join(map(repr, at)), "--engine", "reference")
                self.assertNotIn("relative", result.stderr)
                points, faces, _ = reader(out)
                self.assertLess(abs(measures(points, faces)[0] / near["area"] - 1), 1e-5)
                for axis in range(3):
                    self.assertAlmostEqual(min(p[axis] for p in points), near["bounds"][0][axis] + 3, delta=1e-5)
        self.refuses(2, "extract", "x.vtu", "--iso", "1", "--origin-at", "1,2", says="--origin-at")

    def test_origin_at_too_far(self):
        source = self.write("far.vtu", vtu(UTM))
        for ending, at in (("stl", "0,0,0"), ("stl", "1e9,0,0"), ("ply", "1e300,0,0"), ("obj", "1e17,0,0")):
            report = self.report("extract", source, "--iso", ISO, "--engine", "reference", "-o",
                                 self.path("out." + ending), "--origin-at", at)
            self.assertRegex(" ".join(report["notices"]), "--origin-at lies so far")
        self.refuses(2, "extract", source, "--iso", ISO, "--engine", "reference", "-o", self.path("beyond.stl"),
                     "--origin-at", "1e39,0,0", says="beyond float32")
        self.assertFalse(os.path.exists(self.path("beyond.stl")))

    def test_parts_far_from_each_other(self):
        """Of one block: they share its origin, and no check passes what is left of them."""
        points = placed((0.0, 0.0, 0.0)) + placed((1e8, 0.0, 0.0))
        cells = hexahedra(DIMS)
        cells += [[n + math.prod(DIMS) for n in cell] for cell in cells]
        source = self.write("apart.vtu", vtk_file("UnstructuredGrid", ">" + vtu_piece(points, cells,
                                                                                      2 * field()[0][2])))
        self.fails_check(source, ISO)
        near = self.report("extract", self.write("near.vtu", vtu((0.0, 0.0, 0.0))), "--iso", ISO, "--engine",
                           "reference", "--check")
        self.assertEqual(near["notices"], [])
        self.assertEqual(near["surfaces"][0]["coarse_vertices"], 0)

    def fails_check(self, source, iso):
        out = self.path("coarse.ply")
        result = self.expect(3, "extract", source, "--iso", iso, "--engine", "reference", "--check", "-o", out)
        self.assertRegex(result.stderr, "float32 is coarse at .*: cells are as thin as .* of its steps")
        self.assertRegex(result.stderr, "check failed: .* where cells are thinner than 8 steps")
        self.assertFalse(os.path.exists(out))
        report = self.report("extract", source, "--iso", iso, "--engine", "reference", "--check", status=3)
        self.assertGreater(report["surfaces"][0]["coarse_vertices"], 0)

    def test_cells_too_small_for_the_axis(self):
        """Rectilinear: 2 mm cells at 4,000 km, on an axis that begins at 0."""
        dims = (13, 4, 4)
        axes = [[0.0, 1.0, 2.0, 1e6, 3e6] + [4e6 + 0.002 * n for n in range(8)], [0.0, 1.0, 2.0, 3.0],
                [0.0, 1.0, 2.0, 3.0]]
        places = lattice(dims, (0, 0, 0))
        text = "".join(data_array("xyz"[axis], "f64", axes[axis]) for axis in range(3))
        for at, fails in ((9, True), (1, False)):
            values = [float(x == at and y in (1, 2) and z in (1, 2)) for x, y, z in places]
            source = self.write("long.vtr", structured_text("RectilinearGrid", dims, (0, 0, 0),
                                                            f"<Coordinates>{text}</Coordinates>",
                                                            [("f", "f64", values)]))
            if fails:
                self.fails_check(source, "0.5")
            else:
                self.expect(0, "extract", source, "--iso", "0.5", "--engine", "reference", "--check")

    def test_thin_cells_that_lie_oblique(self):
        """Their box is large along every axis, and they are thinner than steps of float32."""
        root = math.sqrt(0.5)
        values = [p for p in field()[0][2]]
        for thick, fails in ((1e-7, True), (1e-3, False)):
            points = [(root * x + root * thick * z, float(y), root * thick * z - root * x)
                      for x, y, z in lattice(DIMS, (0, 0, 0))]
            cells = self.write("thin.vtu", vtk_file("UnstructuredGrid", ">" + vtu_piece(points, hexahedra(DIMS), values)))
            grid = f' Origin="0 0 0" Spacing="1 1 {thick!r}" Direction="{root!r} 0 {root!r} 0 1 0 {-root!r} 0 {root!r}"'
            image = self.write("thin.vti", structured_text("ImageData", DIMS, (0, 0, 0), "", field(), more=grid))
            whole = " ".join(f"0 {n - 1}" for n in DIMS)
            bent = self.write("thin.vts", vtk_file("StructuredGrid", f' WholeExtent="{whole}"><Piece Extent="{whole}">'
                                                   f'{attributes("PointData", field())}<Points>'
                                                   + data_array("Points", "f64", list(itertools.chain(*points)), 3)
                                                   + "</Points></Piece>"))
            for source in (cells, image, bent):
                with self.subTest(source=source, thick=thick):
                    if fails:
                        self.fails_check(source, ISO)
                    else:
                        self.expect(0, "extract", source, "--iso", ISO, "--engine", "reference", "--check")

    def test_files_whose_numbers_are_coarse(self):
        """--check fails where the file would hold another shape than the mesh, and writes none."""
        image = self.write("a.vti", vti((1e15, 0.0, 0.0)))
        apart = self.write("apart.vtu", vtu_pieces((UTM, (0, 0, 0)), ((1e8, 0.0, 0.0), (0, 0, 0))))
        for source, out, more, says in ((image, "a.ply", (), "so far from zero"), (apart, "a.stl", (), "blocks lie so far"),
                                        (image, "a.vtp", ("--origin-at", "-1e17,0,0"), "--origin-at lies so far")):
            with self.subTest(out=out, more=more):
                result = self.expect(3, "extract", source, "--iso", ISO, "-o", self.path(out), "--engine", "reference",
                                     "--check", *more)
                self.assertRegex(result.stderr, says)
                self.assertRegex(result.stderr, "check failed")
                self.assertFalse(os.path.exists(self.path(out)))
        near = self.surface(self.write("near.vti", vti((0.0, 0.0, 0.0))), "--iso", ISO)[1]
        out = self.path("b.ply")
        self.expect(0, "extract", image, "--iso", ISO, "-o", out, "--engine", "reference", "--check", "--origin-at",
                    "1e15,0,0")
        points, faces, _ = read_ply(out)
        self.assertLess(abs(measures(points, faces)[0] / near["area"] - 1), 1e-6)

    def test_origins_where_doubles_have_no_room(self):
        near = self.surface(self.write("near.vti", vti((0.0, 0.0, 0.0))), "--iso", ISO)[1]
        far = self.surface(self.write("far.vti", vti((1e18, -1e20, 0.0))), "--iso", ISO)[1]
        self.assertEqual(near["hash"], far["hash"])

    def test_small_triangles_are_not_coarse(self):
        """Just beside values of samples all triangles are tiny, and the cells are not."""
        values = [float((x, y, z) == (4, 4, 4)) for x, y, z in lattice(DIMS, (0, 0, 0))]
        source = self.write("tie.vti", structured_text("ImageData", DIMS, (0, 0, 0), "", [("f", "f64", values)],
                                                       more=' Origin="0 0 0" Spacing="1 1 1"'))
        report = self.report("extract", source, "--iso", "0.999999", "--engine", "reference", "--check")
        self.assertEqual(report["surfaces"][0]["coarse_vertices"], 0)
        self.assertNotIn("coarse", " ".join(report["notices"]))

    def test_blocks_far_from_each_other(self):
        """Each has an origin of its own, and every file full coordinates."""
        near = self.surface(self.write("near.vtu", vtu((0.0, 0.0, 0.0))), "--iso", ISO)[1]
        places = [(0.0, 0.0, 0.0), UTM, (1e8, 0.0, 0.0)]
        source = self.write("apart.vtu", vtu_pieces(*((at, (0, 0, 0)) for at in places)))
        for more in ((), ("--drop-degenerate",)):
            both = self.surface(source, "--iso", ISO, *more)[1]
            self.assertLess(abs(both["area"] / near["area"] - 3), 1e-5)
            self.assertIsNone(both["origin"])
            self.assertEqual(both["coarse_vertices"], 0)
            for axis in range(3):
                self.assertAlmostEqual(both["bounds"][0][axis], near["bounds"][0][axis], delta=1e-5)
                self.assertAlmostEqual(both["bounds"][1][axis], near["bounds"][1][axis] + max(p[axis] for p in places),
                                       delta=1e-5)
            for ending, soup in itertools.product(("ply", "vtp", "obj"), ((), ("--soup",))):
                with self.subTest(written=ending, soup=soup, more=more):
                    out = self.path("out." + ending)
                    self.expect(0, "extract", source, "--iso", ISO, "-o", out, "--engine", "reference", *more, *soup)
                    points, faces, layout = READERS[ending](out)
                    self.assertEqual(layout, "ddd")
                    parts = [[f for f in faces if math.dist(points[f[0]], at) < 100] for at in places]
                    self.assertEqual(sum(map(len, parts)), len(faces))
                    for part in parts:
                        self.assertLess(abs(measures(points, part)[0] / near["area"] - 1), 1e-5)

    def test_stl_of_blocks_far_from_each_other(self):
        near = self.surface(self.write("near.vtu", vtu((0.0, 0.0, 0.0))), "--iso", ISO)[1]
        source = self.write("apart.vtu", vtu_pieces((UTM, (0, 0, 0)), ((1e8, 0.0, 0.0), (0, 0, 0))))
        for name, more, says in (("all.stl", (), "blocks lie so far from each other"),
                                 ("one.stl", ("--blocks", "separate"), "relative to each block's origin"),
                                 ("at.stl", ("--blocks", "separate", "--origin-at", "0,0,0"), "--origin-at")):
            report = self.report("extract", source, "--iso", ISO, "-o", self.path(name), "--engine", "reference", *more)
            self.assertRegex(" ".join(report["notices"]), says)
        for block in range(2):
            points, faces, _ = read_stl(self.path(f"one_b{block}.stl"))
            self.assertLess(abs(measures(points, faces)[0] / near["area"] - 1), 1e-5)

    def test_blocks_that_meet_share_an_origin(self):
        dims = (5, 8, 9)
        source = self.write("meet.vtu", vtu_pieces((UTM, (0, 0, 0)), (UTM, (4, 0, 0)), dims=dims))
        out = self.path("meet.ply")
        report = self.report("extract", source, "--iso", ISO, "-o", out, "--engine", "reference")
        self.assertIsNotNone(report["surfaces"][0]["origin"])
        points, _, _ = read_ply(out)
        seam = [p for p in points if p[0] == UTM[0] + 4 * CELL or p[0] == UTM[0] + 4 * CELL + CELL / 8]
        self.assertGreater(len(seam), 20)
        self.assertEqual(2 * len(set(seam)), len(seam))

    def test_separate_blocks_need_files(self):
        source = self.write("far.vts", vts(UTM))
        self.refuses(2, "extract", source, "--iso", ISO, "--engine", "reference", "--blocks", "separate", "-o",
                     "/dev/null", "--format", "ply", says="/dev/null is no file")
        self.assertFalse(os.path.exists("/dev/null_b0"))

    def test_carried_values_that_float32_rounds(self):
        count = math.prod(DIMS)
        extra = [("large", "f64", [1e39] * count), ("fine", "f64", [4.6e6 + n / 100 for n in range(count)])]
        more = ' Origin="0 0 0" Spacing="1 1 1"'
        source = self.write("c.vti", structured_text("ImageData", DIMS, (0, 0, 0), "", field() + extra, more=more))
        for name, says in (("large", "infinite"), ("fine", "carried as float32")):
            report = self.report("extract", source, "--field", "bump", "--iso", ISO, "--engine", "reference",
                                 "--carry", name, "-o", self.path("c.vtp"))
            self.assertRegex(" ".join(report["notices"]), says)

    def test_options_given_twice(self):
        self.refuses(2, "extract", "x.vtu", "--iso", "1", "--nodata", "0", "--nodata", "255", says="given twice")

    def test_raw(self):
        raw = self.path("sphere.raw")
        self.expect(0, "generate", "sphere", "--dims", "24,22,20", "--type", "u8", "-o", raw)
        shape = [raw, "--dims", "24,22,20", "--type", "u8", "--iso", "100", "--spacing", "0.01,0.01,0.01"]
        near = self.surface(*shape)[1]
        far = self.surface(*shape, "--origin", "1e9,1e9,1e9")[1]
        self.assertEqual(near["hash"], far["hash"])
        self.assertEqual(far["origin"], [1e9, 1e9, 1e9])

    def test_unused_point_at_zero(self):
        alone = self.surface(self.write("a.vtu", vtu(UTM)), "--iso", ISO)[1]
        beside = self.surface(self.write("b.vtu", vtu(UTM, extra=[(0.0, 0.0, 0.0)])), "--iso", ISO)[1]
        self.assertEqual(alone["hash"], beside["hash"])

    def test_tetrahedralize(self):
        near, far = self.both("far.vts")
        for name in KINDS:
            with self.subTest(file=name):
                out = self.path("cut.vtu")
                self.expect(0, "tetrahedralize", self.write(name, KINDS[name](UTM)), "-o", out)
                with open(out, "rb") as f:
                    self.assertRegex(f.read(4096), rb'type="Float64" Name="Points"')
                direct = self.surface(self.path(name), "--iso", ISO)[1]
                cut = self.surface(out, "--iso", ISO)[1]
                self.assertEqual(direct["triangles"], cut["triangles"])
                self.assertLess(abs(direct["area"] / cut["area"] - 1), 1e-6)
                info = json.loads(self.expect(0, "info", out, "--json").stdout)
                self.assertGreaterEqual(info["blocks"][0]["bounds"][0][1], UTM[1])

    def test_info_gives_doubles(self):
        info = json.loads(self.expect(0, "info", self.write("far.vtu", vtu(UTM)), "--json").stdout)
        self.assertEqual(info["blocks"][0]["bounds"][0], list(UTM))


if __name__ == "__main__":
    tool_case.main()
