#!/usr/bin/env python3
"""test_cli_info.py TOOL [reference] - what info says of grids: blocks, fields, names, what is used, what hinders

Range, histogram and isovalues are of the samples that a surface can depend on; where there is none, info says why, and
extract agrees. Names of fields and arrays that are left out are told as the files have them.
"""
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from grid_files import (hexahedra, HEXAHEDRON, lattice, numbers, plot3d_texts, TETRAHEDRON, TRIANGLE,
                        vti_text, vtu_text)
from tool_case import GridCase

BLOCK_KEYS = {"kind", "points", "cells", "dims", "first", "cell_types", "bounds", "blanked_points", "blanked_cells",
              "fields"}


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

    def floats(self, dims, values, *more):
        return [*self.raw("a.raw", "f32", dims, values), *more]

    def test_images(self):
        for dims in ((8, 8, 1), (1, 8, 8), (8, 1, 8)):
            self.check("one sample along an axis", *self.floats(dims, [float(n) for n in range(64)]), status=4)
        self.check("every sample is missing", *self.floats((4, 4, 4), [math.nan] * 64))
        self.check("every sample is missing", *self.floats((4, 4, 4), [7.0] * 64, "--nodata", "7"))
        board = [float(sum(p)) if sum(p) % 2 else math.nan for p in lattice((4, 4, 4))]
        self.check("no cell of three dimensions has samples at all", *self.floats((4, 4, 4), board))
        cell = [float(sum(p)) if min(p) > 1 else math.nan for p in lattice((4, 4, 4))]
        self.assertNotEqual(self.report("info", *self.floats((4, 4, 4), cell))["isovalues"], [])

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
        self.assertRegex("\n".join(info["notices"]), "2 cells of fewer than three dimensions: skipped")
        inverted = self.write("b.vtu", vtu_text(points, [[0, 2, 1, 4]], [TETRAHEDRON], fields))
        info = self.report("info", inverted)
        self.assertRegex("\n".join(info["notices"]), "1 cell of negative volume: turned over")
        self.assertNotEqual(info["isovalues"], [])
        uncut = self.write("c.vtu", vtu_text(points, [[0, 1, 2, 4]], [41], fields))
        self.check("cell 0 is of type 41", uncut, status=4)


class Info(GridCase):
    def test_blocks(self):
        blocks = [((3, 2, 2), lattice((3, 2, 2)), [float(n) for n in range(12)]),
                  ((2, 2, 2), lattice((2, 2, 2), (2, 0, 0)), [float(20 + n) for n in range(8)])]
        inputs = self.write_plot3d("a", blocks)
        info = self.report("info", *inputs)
        self.assertEqual(set(info), tool_case.INFO_KEYS)
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
        """Range and count are so; advised isovalues give surfaces; one above the range is told with the range."""
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


if __name__ == "__main__":
    tool_case.main()
