#!/usr/bin/env python3
"""test_results.py TOOL [reference] [fault=LIBRARY] - results that come back, and results that would be of no use

Numbers as people type them and as reports print them; missing values; notices of surfaces that are empty or degenerate;
names of written arrays.
"""
import itertools
import math
import os
import random
import struct
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from tool_case import GridCase

REPORTS = os.path.join(os.environ.get("TETRACUBES_DATA", ""), "reports")


def f32(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


class Missing(GridCase):
    """A ramp of 0 to 7 with a corner that is missing, as in files of weather and terrain."""
    TYPED = {"f32": ("1e20", "-999.9", "-3.4028235e+38", "-3.4028234663852886e38", "0.1", "9.96921e36", "-9999"),
             "f64": ("1e20", "-999.9", "-1.7976931348623157e308"), "i16": ("-9999", "-32768"), "u8": ("255",),
             "i32": ("-2147483648",), "u32": ("4294967295",)}

    def ramp(self, kind, missing):
        values = [x for _ in range(8) for _ in range(8) for x in range(8)]
        for x, y, z in itertools.product(range(3), range(4), range(6)):
            values[x + 2 + 8 * (y + 8 * z)] = missing
        return self.raw("ramp.raw", kind, (8, 8, 8), values)

    def expected(self):
        """Vertices and triangles where the corner is not a number."""
        [surface] = self.extract(self.ramp("f32", float("nan")), "3.5")["surfaces"]
        self.assertLess(surface["triangles"], self.extract(self.ramp("f32", 100), "3.5")["surfaces"][0]["triangles"])
        return surface["vertices"], surface["triangles"]

    def test_values_as_typed(self):
        expected = self.expected()
        for kind, typed in self.TYPED.items():
            for text in typed:
                with self.subTest(kind=kind, text=text):
                    number = float(text)
                    ramp = self.ramp(kind, f32(number) if kind == "f32" else number if kind == "f64" else int(number))
                    for engine in self.engines() if text == typed[0] else ["reference"]:
                        report = self.report("extract", *ramp, "--iso", "3.5", "--nodata=" + text, "--engine", engine)
                        [surface] = report["surfaces"]
                        self.assertEqual((surface["vertices"], surface["triangles"]), expected)
                        self.assertEqual(report["notices"], [])

    def test_values_as_printed(self):
        """What info prints as the end of the range is the missing value, and the rest is what is left."""
        expected = self.expected()
        for kind, typed in self.TYPED.items():
            for text in typed:
                number = float(text)
                stored = f32(number) if kind == "f32" else number if kind == "f64" else int(number)
                ramp = self.ramp(kind, stored)
                with self.subTest(kind=kind, text=text):
                    shown = self.expect(0, "info", *ramp).stdout
                    words = next(line.split() for line in shown.splitlines() if line.startswith("range"))
                    self.assertEqual(sorted(float(words[n]) for n in (1, 3)), [min(0, stored), max(7, stored)])
                    for end in (words[1], words[3]):
                        if float(end) != stored or 0 <= stored <= 7:
                            continue
                        [surface] = self.extract(ramp, "3.5", "--nodata", end)["surfaces"]
                        self.assertEqual((surface["vertices"], surface["triangles"]), expected)
                        left = self.report("info", *ramp, "--nodata", end)
                        self.assertEqual((left["range"], left["missing"]), ([0, 7], 72))
                        self.assertEqual(sum(left["histogram"]["counts"]), 8 ** 3 - 72)
                        self.assertTrue(all(0 < good["iso"] <= 7 for good in left["isovalues"]))

    def test_values_that_are_nowhere(self):
        for kind, text in (("u8", "-1"), ("u8", "3.5"), ("u8", "200"), ("f32", "0.3"), ("f32", "1e39"), ("f64", "8"),
                           ("i16", "40000"), ("f32", "1e300")):
            with self.subTest(kind=kind, text=text):
                ramp = self.ramp(kind, 100)
                [told] = self.notices(ramp, "3.5", "--nodata", text)
                self.assertRegex(told, r"--nodata .* no sample .*nothing is left out")
                self.assertEqual(float(told.split()[1].rstrip(":")), float(text))
                hashes = {self.extract(ramp, "3.5", *more)["surfaces"][0]["hash"] for more in ([], ["--nodata", text])}
                self.assertEqual(len(hashes), 1)
                self.assertIn("nothing is left out", self.expect(0, "info", *ramp, "--nodata", text).stderr)

    def test_cells_and_points(self):
        """Values of cells, and of unstructured grids, are compared before anything else is done with them."""
        points = [(x, y, z) for z in range(3) for y in range(3) for x in range(4)]
        head = ("# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 4 3 3\nPOINTS 36 float\n" +
                " ".join(str(c) for p in points for c in p) + "\n")
        values = [0.1 if n == 5 else n % 3 for n in range(12)]
        with open(self.path("cells.vtk"), "w") as out:
            out.write(head + "CELL_DATA 12\nSCALARS v float\nLOOKUP_TABLE default\n")
            out.write(" ".join(map(str, values)) + "\n")
        whole, left = (self.extract([self.path("cells.vtk")], "0.9", *more) for more in ([], ["--nodata", "0.1"]))
        self.assertNotEqual(whole["surfaces"][0]["triangles"], left["surfaces"][0]["triangles"])
        self.assertIn("cell's value", self.extract([self.path("cells.vtk")], "0.9", "--nodata", "0.2")["notices"][-1])


class Numbers(GridCase):
    def test_ranges_and_isovalues_come_back(self):
        generator = random.Random(7)
        for kind in ("f32", "f64"):
            values = [generator.uniform(-1, 1) * 10.0 ** generator.randrange(-6, 7) for _ in range(60)]
            stored = [f32(value) for value in values] if kind == "f32" else values
            grid = self.raw("a.raw", kind, (5, 4, 3), stored)
            lines = self.expect(0, "info", *grid).stdout.splitlines()
            words = next(line.split() for line in lines if line.startswith("range"))
            self.assertEqual((float(words[1]), float(words[3])), (min(stored), max(stored)))
            info = self.report("info", *grid)
            self.assertEqual(info["range"], [min(stored), max(stored)])
            shown = [float(line.split()[0]) for line in lines[lines.index("isovalues     worth trying:") + 1:]]
            self.assertEqual(shown, [good["iso"] for good in info["isovalues"]])
            self.assertGreater(self.extract(grid, words[3])["surfaces"][0]["triangles"], 0)  # the greatest is inside
            self.assertEqual(self.extract(grid, words[1])["surfaces"][0]["triangles"], 0)  # and none below the least

    def test_placement_comes_back(self):
        place = ["--spacing", "0.1,0.7,1e-3", "--origin", "0.3,-1e7,123456.789"]
        grid = self.raw("a.raw", "u8", (3, 3, 3), [n % 5 for n in range(27)]) + place
        text = self.expect(0, "info", *grid).stdout
        self.assertIn("spacing       0.1 0.7 0.001\n", text)
        for fact in (" + 0.3\n", " + -10000000\n", " + 123456.789\n"):
            self.assertIn(fact, text)

    def test_bounds_come_back(self):
        noise = self.raw("a.raw", "f32", (3, 3, 3), [f32(n * 0.37 % 1) for n in range(27)])
        pyramid = self.raw("b.raw", "f32", (3, 3, 3), [f32(math.prod(1 - abs(c - 1) for c in p) * 7)
                                                       for p in itertools.product(range(3), repeat=3)])
        for grid in (noise, pyramid):
            [surface] = self.extract(grid, "0.5")["surfaces"]
            text = self.expect(0, "extract", *grid, "--iso", "0.5", "--engine", "reference").stdout
            words = next(line.split() for line in text.splitlines() if line.startswith("  bounds"))
            self.assertEqual([f32(float(word)) for word in words[1:4] + words[5:]],
                             [number for end in surface["bounds"] for number in end])


class Notices(GridCase):
    def ball(self):
        values = [9 - sum((c - 3) ** 2 for c in p) for p in itertools.product(range(7), repeat=3)]
        return self.raw("ball.raw", "i16", (7, 7, 7), values)

    def empty(self, arguments, iso, *more):
        [told] = self.notices(arguments, iso, *more)
        report = self.extract(arguments, iso, *more)
        self.assertEqual((report["surfaces"][0]["triangles"], report["surfaces"][0].get("bounds")), (0, None))
        self.assertIn("the surface is empty", told)
        if "--count" not in more:
            text = self.expect(0, "extract", *arguments, "--iso", iso, "--engine", "reference", *more).stdout
            self.assertIn("bounds      none\n", text)
        return told

    def test_isovalues_out_of_range(self):
        for iso in ("99", "-18.5", "1e300"):
            for more in ((), ("--count",)):
                self.assertRegex(self.empty(self.ball(), iso, *more),
                                 f"isovalue {iso} is outside the range of the samples, -18 to 9")
        self.assertIn("least sample", self.empty(self.ball(), "-18"))
        self.assertEqual(self.notices(self.ball(), "8.5"), [])

    def test_constant_and_missing(self):
        constant = self.raw("c.raw", "f32", (3, 3, 3), [0.5] * 27)
        self.assertIn("constant, every sample is 0.5", self.empty(constant, "0.5"))
        self.assertIn("constant", self.empty(constant, "7"))
        self.assertIn("constant: every sample is 0.5", " ".join(self.report("info", *constant)["notices"]))
        self.assertIn("every sample is missing", self.empty(constant, "0.5", "--nodata", "0.5"))
        apart = self.raw("a.raw", "f32", (4, 2, 2), [0, float("nan"), float("nan"), 5] * 4)
        self.assertIn("range is 0 to 5", self.empty(apart, "2"))

    def test_zero_area(self):
        labels = self.raw("l.raw", "u8", (7, 7, 7), [int(all(2 <= c <= 4 for c in p))
                                                      for p in itertools.product(range(7), repeat=3)])
        [told] = self.notices(labels, "1")
        self.assertRegex(told, r"\d+ of \d+ triangles have no area.*as 0\.5.*--drop-degenerate")
        self.assertEqual(self.notices(labels, "0.5"), [])
        self.assertEqual(self.notices(labels, "1", "--drop-degenerate"), [])

    def test_places_that_float_does_not_tell_apart(self):
        """Cells of 0.01 at the end of axes that begin at 0 and are 1e9 long: no origin brings all of them near."""
        axis = " ".join(f"{place:.12g}" for place in [0] + [1e9 + 0.01 * n for n in range(8)])
        with open(self.path("far.vtk"), "w") as out:
            out.write("# vtk DataFile Version 3.0\nx\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 9 9 9\n")
            out.write("".join(f"{name}_COORDINATES 9 double\n{axis}\n" for name in "XYZ"))
            out.write("POINT_DATA 729\nSCALARS v float\nLOOKUP_TABLE default\n")
            out.write(" ".join(f"{sum((c - 4.6) ** 2 for c in p):.6f}" for p in itertools.product(range(9), repeat=3)))
        report = self.extract([self.path("far.vtk")], "9.03")
        [surface] = report["surfaces"]
        self.assertGreater(surface["degenerate_triangles"], surface["triangles"] // 5)
        [told] = report["notices"]
        self.assertRegex(told, "float32 is coarse at [0-9]+ of [0-9]+ vertices: cells are as thin as [0-9.e-]+ of its steps")

    def test_zero_area_for_other_reasons(self):
        """A value that stands for none lies so far away that crossings fall onto the samples beside it."""
        ball = [1e20 if p[2] < 2 else 4 - math.dist(p, (4.1, 4.2, 4.3)) for p in itertools.product(range(9), repeat=3)]
        filled = self.raw("filled.raw", "f32", (9, 9, 9), ball)
        [told] = self.notices(filled, "2.05")
        self.assertRegex(told, r"have no area: samples lie so far from the isovalue, up to 1\S*e\+20, .*--nodata")
        self.assertEqual(self.notices(filled, "2.05", "--nodata", "1e20"), [])

    def test_fields_that_are_not_there(self):
        ball = self.ball()
        result = self.refuses(2, "extract", *ball, "--iso", "1", "--field", "foo", says="no field is named 'foo'")
        self.assertNotIn("one of:  (", result.stderr)
        self.assertIn("leave out --field", result.stderr)

    def test_limits_are_no_reason_to_fall_back(self):
        if not tool_case.FAULT_LIBRARY or not tool_case.HAS_DEVICE:
            self.skipTest("no OpenCL device, or no library of faults")
        result = self.expect(1, "extract", *self.ball(), "--iso", "1", "--engine", "auto",
                             env={"LD_PRELOAD": tool_case.FAULT_LIBRARY, "MESH_FAULT": "limit"})
        self.assertNotIn("takes over", result.stderr)

    def test_files_named_once(self):
        with open(self.path("once.nrrd"), "wb") as out:
            out.write(b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 3 3 3\nencoding: raw\nspacings: nan 1 1\n\n")
            out.write(bytes(range(27)))
        [told] = self.notices([self.path("once.nrrd")], "7.5")
        self.assertIn("axis 1 is not known", told)
        self.assertEqual(told.count("once.nrrd"), 1)

    @unittest.skipUnless(os.path.isdir(REPORTS), "TETRACUBES_DATA has no reports")
    def test_published_files_named_once(self):
        path = os.path.join(REPORTS, "array_too_long.vti")
        [told] = self.notices([path], "0.5")
        self.assertEqual(told.count("array_too_long.vti"), 1)


class Names(GridCase):
    def grid(self, *fields):
        values = " ".join(str(n % 4) for n in range(27))
        with open(self.path("n.vtk"), "w") as out:
            out.write("# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 3 3\n"
                      f"ORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA 27\nFIELD f {len(fields)}\n")
            for name in fields:
                out.write(f"{name} 1 27 float\n{values}\n")
        return self.path("n.vtk")

    def names(self, path):
        with open(path, "rb") as file:
            head = file.read().split(b"<AppendedData")[0].decode()
        return [part.split('"')[0] for part in head.split(' Name="')[1:]]

    def test_names_are_given_once(self):
        taken = ("s", "Normals", "Normals_", "Points", "connectivity", "offsets", "types", "nx", "x")
        grid = self.grid(*taken)
        for more in ([], ["--normals"], ["--soup"]):
            self.expect(0, "extract", grid, "--field", "s", "--iso", "1.5", "--engine", "reference", "--quiet", *more,
                        "--carry", ",".join(taken[1:]), "-o", self.path("o.vtp"))
            names = self.names(self.path("o.vtp"))
            self.assertEqual(len(names), len(set(names)), names)
            self.assertEqual("Normals__" in names, "--normals" in more)
            self.assertTrue({"Points", "Points_", "connectivity_", "offsets_", "types", "nx", "x"} <= set(names))
            self.expect(0, "extract", grid, "--field", "s", "--iso", "1.5", "--engine", "reference", "--quiet", *more,
                        "--carry", ",".join(taken[1:]), "-o", self.path("o.ply"))
            with open(self.path("o.ply"), "rb") as file:
                head = file.read().split(b"end_header")[0].decode()
            properties = [line.split()[-1] for line in head.splitlines() if line.startswith("property float")]
            self.assertEqual(len(properties), len(set(properties)), properties)
        self.expect(0, "tetrahedralize", grid, "--quiet", "-o", self.path("o.vtu"))
        names = self.names(self.path("o.vtu"))
        self.assertEqual(len(names), len(set(names)), names)


if __name__ == "__main__":
    tool_case.main()
