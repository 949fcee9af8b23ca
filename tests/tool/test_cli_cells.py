#!/usr/bin/env python3
"""test_cli_cells.py TOOL [reference] - the command line on unstructured grids: extract and tetrahedralize

Cells of every kind, missing points, folded faces, cells that cannot be cut, pieces that know nothing of each other,
fields carried; complexes that are written and read again.
"""
import itertools
import json
import math
import os
import struct
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from grid_files import (bump, hexahedra, HEXAHEDRON, lattice, POLYHEDRON, TETRAHEDRON, TRIANGLE,
                        vti_text, vtu_text, WEDGE)
from meshes import ply_vertices
from tool_case import GridCase, counts

CONVERTED_KEYS = {"notices", "input", "output", "blocks", "points", "cells", "tetrahedra", "flat_cells", "curved_cells",
                  "blanked_cells", "inverted_cells", "folded_cells", "folded_faces", "unsupported_cells",
                  "surplus_cells", "fields", "total_ms"}


class Pieces(GridCase):
    """Pieces of one file know nothing of each other, and that is said once."""
    pattern = "pieces may not meet"

    def setUp(self):
        super().setUp()
        self.needs_xml()

    def told(self, path, *fields):
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
        self.assertEqual([self.told(one, "--field", "c"), self.told(two, "--field", "p")], [0, 0])
        self.assertEqual(self.told(two, "--field", "c"), 1)

    def test_cells_cut(self):
        points = lattice((3, 3, 3))
        fields = [("x", "f32", [float(p[0]) for p in points])]
        cells = hexahedra((3, 3, 3))
        text = vtu_text(points, cells, [HEXAHEDRON] * len(cells), fields)
        one, two = self.write("1.vtu", text), self.write("2.vtu", self.pieces(text))
        self.assertEqual([self.told(one), self.told(two)], [0, 1])
        tetrahedron = vtu_text(points, [[0, 2, 6, 18]], [TETRAHEDRON], fields)
        self.assertEqual(self.told(self.write("t.vtu", self.pieces(tetrahedron))), 0)


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
        self.assertRegex(self.expect(0, "extract", image, *how).stdout, "through 1 cell\n")

    def test_options_that_need_a_structured_grid(self):
        grid = self.write_hexahedra("a.vtu")
        self.refuses(2, "extract", grid, "--field", "bump", "--iso", "0.5", "--normals", "-o", self.path("a.ply"),
                     says="unstructured.*--normals")
        self.refuses(2, "extract", grid, "--field", "bump", "--iso", "0.5", "--method", "snap",
                     says="unstructured.*snap")

    def test_cells_kept_whole(self):
        """By method hybrid: fewer triangles, the same topology; of both engines the same."""
        grid = self.write_hexahedra("a.vtu")
        how = ["--field", "bump", "--iso", "0.5", "--check", "--carry", "x", "-o", self.path("a.ply")]
        hybrid, = self.report("extract", grid, *how, "--method", "hybrid", "--engine", "reference")["surfaces"]
        vertices, _ = ply_vertices(self.path("a.ply"))
        tetra, = self.report("extract", grid, *how, "--engine", "reference")["surfaces"]
        self.assertLess(hybrid["triangles"], 0.5 * tetra["triangles"])
        for key in ("euler_characteristic", "components", "nonmanifold_edges", "misoriented_edges"):
            self.assertEqual(hybrid[key], tetra[key], key)
        self.assertAlmostEqual(hybrid["volume"], tetra["volume"], delta=0.03 * tetra["volume"])
        for vertex in vertices:
            self.assertAlmostEqual(vertex["x_"], vertex["x"], places=4)
        text = self.expect(0, "extract", grid, *how[:4], "--method", "hybrid", "--engine", "reference").stdout
        self.assertRegex(text, "through %d cells\n" % hybrid["active_cells"])
        if tool_case.HAS_DEVICE:
            for more in ([], ["--max-memory", "1M"], ["--iso", "0.3,0.5"]):
                surfaces = self.report("extract", grid, *how[:4], "--method", "hybrid", "--verify", *more)["surfaces"]
                self.assertTrue(all(surface["verified"] for surface in surfaces), more)
                self.assertEqual(surfaces[-1]["hash"], hybrid["hash"], more)

    def test_closed(self):
        """The inside of the surface, and with --iso below all the grid; by kernels the same, in slabs too."""
        grid = self.write_hexahedra("a.vtu")
        how = ["--field", "bump", "--check", "--closed"]
        for method, iso in itertools.product(("tetra", "hybrid"), ("0.5", "3", "-1000")):
            closed, = self.report("extract", grid, *how, "--iso", iso, "--engine", "reference", "--method",
                                  method)["surfaces"]
            for key in ("boundary_edges", "nonmanifold_edges", "nonmanifold_vertices", "misoriented_edges"):
                self.assertEqual(closed[key], 0, (method, iso, key))
            self.assertEqual(closed["euler_characteristic"], 2, (method, iso))
        self.assertAlmostEqual(closed["volume"], 448, delta=25)  # as many cells, each a little out of shape
        self.refuses(2, "extract", grid, *how, "--iso", "0.5", "--method", "snap", says="unstructured.*snap")
        if tool_case.HAS_DEVICE:
            for method, more in itertools.product(("tetra", "hybrid"), ([], ["--max-memory", "100K"])):
                surfaces = self.report("extract", grid, *how, "--iso", "0.5,-1000", "--verify", "--method", method,
                                       *more)["surfaces"]
                for surface in surfaces:
                    self.assertTrue(surface["verified"], (method, more))
                    self.assertEqual(surface["boundary_edges"], 0, (method, more))

    def test_polyhedra_are_not_kept_whole(self):
        faces = [[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]]
        points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        grid = self.write("p.vtu", vtu_text(points, [[0, 1, 2, 3]], [POLYHEDRON], [("f", "f32", [0.0, 1.0, 2.0, 3.0])],
                                            [], faces))
        how = ["extract", grid, "--iso", "1.5", "--engine", "reference"]
        self.expect(0, *how)
        self.refuses(4, *how, "--method", "hybrid", says="cell 0 is a polyhedron.*method tetra")

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
            self.assertEqual(" folded: both cells" in result.stderr, faces > 0)
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
        self.assertRegex(result.stderr, "1 point is used by no cell")
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
                             "--json", says="1 cell has more points than cells of that type: the first ones are taken")
        self.assertEqual(json.loads(result.stdout)["surfaces"][0]["area"], 1)
        self.assertEqual(sum(self.report("info", grid, "--field", "c")["histogram"]["counts"]), 8)

    def test_nothing_to_contour(self):
        points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]
        grid = self.write("a.vtu", vtu_text(points, [[0, 1, 2], [1, 3, 2]], [TRIANGLE] * 2,
                                            [("f", "f32", [0.0, 1.0, 2.0, 3.0])]))
        verify = ["--verify"] if tool_case.HAS_DEVICE else ["--engine", "reference"]
        result = self.expect(0, "extract", grid, "--iso", "0.5", "--check", *verify, "--json", "-o", self.path("a.ply"))
        self.assertRegex(result.stderr, "2 cells of fewer than three dimensions: skipped")
        self.assertRegex(result.stderr, "nothing to contour")
        report = json.loads(result.stdout)
        self.assertEqual((report["cells"], report["tetrahedra"]), (0, 0))
        self.assertEqual(counts(report["surfaces"][0]), [0, 0, 0, 0])
        self.assertEqual(ply_vertices(self.path("a.ply")), ([], []))
        self.expect(0, "tetrahedralize", grid, "-o", self.path("t.vtu"), says="nothing to contour")
        [block] = self.report("info", self.path("t.vtu"))["blocks"]
        self.assertEqual((block["points"], block["cells"]), (4, 0))

    def test_carry(self):
        grid = self.write_hexahedra("a.vtu", cell_fields=[("seven, all", "i16", [7] * 448)])
        self.surface(grid, "--field", "bump", "--iso", "0.5", "--carry", "x,seven, all", "-o", self.path("a.ply"))
        vertices, _ = ply_vertices(self.path("a.ply"))
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


if __name__ == "__main__":
    tool_case.main()
