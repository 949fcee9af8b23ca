#!/usr/bin/env python3
"""test_results.py TOOL [reference] [fault=LIBRARY] - results that come back, and results that would be of no use

Numbers as people type them and as reports print them; missing values; notices of surfaces that are empty or degenerate;
names of written arrays; surfaces without triangles of zero area, read back and examined by code of their own; results
beside a mesh on standard output. Standard library only.
"""
import collections
import itertools
import json
import math
import os
import random
import struct
import subprocess
import sys
import threading
import unittest

import test_cli
from test_cli import Case

REPORTS = os.path.join(os.environ.get("TETRACUBES_DATA", ""), "reports")


def f32(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


class DataCase(Case):
    def raw(self, name, kind, dims, values):
        """A raw file of these values, and the arguments that read it."""
        codes = dict(zip(("u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64"), "BbHhIifd"))
        with open(self.path(name), "wb") as out:
            out.write(struct.pack(f"<{len(values)}{codes[kind]}", *values))
        return [self.path(name), "--dims", ",".join(map(str, dims)), "--type", kind]

    def extract(self, arguments, iso, *more, status=0, **how):
        return self.report("extract", *arguments, "--iso", iso, "--engine", "reference", *more, status=status, **how)

    def notices(self, arguments, iso, *more):
        """Those of the report; the same stand on standard error, but for --quiet."""
        words = ["extract", *arguments, "--iso", iso, "--engine", "reference", "--json", *more]
        loud = self.expect(0, *words)
        told = json.loads(loud.stdout)["notices"]
        self.assertEqual(loud.stderr.splitlines(), ["tetracubes: " + notice for notice in told])
        quiet = self.expect(0, *words, "--quiet")
        self.assertEqual((quiet.stderr, json.loads(quiet.stdout)["notices"]), ("", told))
        return told


class Missing(DataCase):
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


class Numbers(DataCase):
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


class Notices(DataCase):
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
        if not test_cli.FAULT_LIBRARY or not test_cli.HAS_DEVICE:
            self.skipTest("no OpenCL device, or no library of faults")
        result = self.expect(1, "extract", *self.ball(), "--iso", "1", "--engine", "auto",
                             env={"LD_PRELOAD": test_cli.FAULT_LIBRARY, "MESH_FAULT": "limit"})
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


class Names(DataCase):
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


def ply_read(path):
    """Positions and triangles of a binary PLY of this program's."""
    with open(path, "rb") as file:
        head, body = file.read().split(b"end_header\n", 1)
    lines = head.decode().splitlines()
    vertices, faces = (int(line.split()[2]) for line in lines if line.startswith("element"))
    floats = sum(line.startswith("property float") for line in lines)
    numbers = struct.unpack(f"<{floats * vertices}f", body[:4 * floats * vertices])
    rows = [numbers[n:n + floats] for n in range(0, len(numbers), floats)]
    triangles = [struct.unpack_from("<3I", body, 4 * floats * vertices + 13 * n + 1) for n in range(faces)]
    return rows, triangles


def has_no_area(a, b, c):
    u, v = ([q - p for p, q in zip(a, other)] for other in (b, c))
    return all(u[i - 2] * v[i - 1] == u[i - 1] * v[i - 2] for i in range(3))


def border(rows, triangles):
    """Edges between places, each counted by its direction: what a surface leaves open, whatever its vertices are."""
    sums = collections.Counter()
    for triangle in triangles:
        for a, b in zip(triangle, triangle[1:] + triangle[:1]):
            p, q = rows[a][:3], rows[b][:3]
            if p != q:
                sums[min((p, q), (q, p))] += 1 if p < q else -1
    return {edge: count for edge, count in sums.items() if count}


def volume(rows, triangles):
    total = 0
    for a, b, c in (map(lambda v: rows[v][:3], triangle) for triangle in triangles):
        total += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                  a[2] * (b[0] * c[1] - b[1] * c[0]))
    return total / 6


class Dropped(DataCase):
    def both(self, grid, iso, *more):
        """The surface with its triangles of zero area, and without."""
        meshes = []
        for extra in ([], ["--drop-degenerate"]):
            report = self.extract(grid, iso, *more, *extra, "-o", self.path("o.ply"))
            rows, triangles = ply_read(self.path("o.ply"))
            [surface] = report["surfaces"]
            self.assertEqual((surface["vertices"], surface["triangles"]), (len(rows), len(triangles)))
            meshes.append((rows, triangles, surface, report["notices"]))
        return meshes

    def judge(self, grid, iso, *more):
        whole, left = self.both(grid, iso, *more)
        rows, triangles, surface, told = left
        flat = sum(has_no_area(*(rows[v][:3] for v in triangle)) for triangle in triangles)
        self.assertEqual(surface["degenerate_triangles"], flat)
        self.assertEqual(surface["dropped_triangles"] + len(triangles), len(whole[1]))
        for triangle in triangles:
            self.assertEqual(len({rows[v][:3] for v in triangle}), 3)
        kept = [[rows[v] for v in triangle] for triangle in triangles]
        there = collections.Counter(map(tuple, ([whole[0][v] for v in triangle] for triangle in whole[1])))
        self.assertFalse(collections.Counter(map(tuple, kept)) - there, "a triangle that was not there")
        self.assertEqual(border(rows, triangles), border(whole[0], whole[1]))
        self.assertAlmostEqual(volume(rows, triangles), volume(whole[0], whole[1]), places=5)
        edges = collections.Counter(tuple(sorted(edge)) for t in triangles for edge in zip(t, t[1:] + t[:1]))
        crowded = sum(count > 2 for count in edges.values())
        said = [notice for notice in told if "more than two triangles" in notice]
        self.assertEqual((crowded, said), (0, []))
        self.assertEqual({v for t in triangles for v in t}, set(range(len(rows))))
        self.assert_fans(triangles)
        return whole, left

    def assert_fans(self, triangles):
        """The triangles at each vertex follow each other over edges in one run."""
        around = collections.defaultdict(dict)
        for a, b, c in triangles:
            for v, first, second in ((a, b, c), (b, c, a), (c, a, b)):
                around[v][first] = second
        for v, fan in around.items():
            starts = [first for first in fan if first not in fan.values()] or [next(iter(fan))]
            self.assertEqual(len(starts), 1, f"vertex {v} has several fans")
            at, count = starts[0], 0
            while at in fan and count < len(fan):
                at, count = fan[at], count + 1
            self.assertEqual(count, len(fan), f"vertex {v} has several fans")

    def test_box(self):
        labels = [3 if x == 5 and y == 5 and z == 5 else int(2 <= x <= 4 and 2 <= y <= 4 and 2 <= z <= 4)
                  for z, y, x in itertools.product(range(8), repeat=3)]
        grid = self.raw("l.raw", "u8", (8, 8, 8), labels)
        for method in ("tetra", "hybrid"):
            _, (rows, triangles, surface, told) = self.judge(grid, "1", "--method", method)
            self.assertEqual((told, border(rows, triangles), surface["degenerate_triangles"]), ([], {}, 0))
        checked = self.extract(grid, "1", "--drop-degenerate", "--check")["surfaces"][0]
        self.assertEqual((checked["boundary_edges"], checked["nonmanifold_edges"], checked["nonmanifold_vertices"]),
                         (0, 0, 0))

    def test_random_labels(self):
        generator = random.Random(11)
        for trial in range(60):
            dims = [generator.randrange(2, 8) for _ in range(3)]
            share = generator.random()
            values = [generator.choice((0, 2)) if generator.random() > share else 1
                      for _ in range(dims[0] * dims[1] * dims[2])]
            grid = self.raw("r.raw", "u8", dims, values)
            with self.subTest(trial=trial, dims=dims):
                self.judge(grid, "1", "--method", generator.choice(("tetra", "hybrid")))

    def test_hundreds_of_label_maps(self):
        """Sheets that only triangles of zero area held apart: a manifold stays one, and what was closed closed."""
        generator = random.Random(12)
        met = 0
        for trial in range(300):
            dims = [generator.randrange(4, 6) for _ in range(3)]
            weights = generator.choice(((6, 2, 2), (1, 1, 1), (3, 1, 0), (4, 4, 1)))
            is_framed = generator.random() < 0.7  # nothing touches the border of the grid
            values = [0 if is_framed and any(p in (0, n - 1) for p, n in zip((x, y, z), dims))
                      else generator.choices((0, 1, 2), weights)[0]
                      for z, y, x in itertools.product(*map(range, reversed(dims)))]
            grid, method = self.raw("m.raw", "u8", dims, values), generator.choice(("tetra", "hybrid"))
            with self.subTest(trial=trial, dims=dims, method=method, values=values):
                meshes = self.both(grid, "1", "--method", method)
                sides = [collections.Counter(edge for t in mesh[1] for edge in zip(t, t[1:] + t[:1]))
                         for mesh in meshes]
                for passed in sides:  # at most once each way
                    self.assertEqual(set(passed.values()) - {1}, set())
                opened = [sum((b, a) not in passed for a, b in passed) for passed in sides]
                if is_framed:
                    self.assertEqual(opened, [0, 0])
                self.assertEqual(border(*meshes[1][:2]), border(*meshes[0][:2]))
                self.assert_fans(meshes[1][1])
                self.assertEqual(meshes[1][2]["degenerate_triangles"], 0)
                self.assertNotIn("more than two triangles", " ".join(meshes[1][3]))
                places = collections.Counter(tuple(sorted((rows[a], rows[b]))) for rows, t, *_ in meshes[1:]
                                             for t in t for a, b in zip(t, t[1:] + t[:1]))
                met += any(count > 2 for count in places.values())
        self.assertGreater(met, 50)  # of these maps sheets meet in edges, so that there was something to do

    def test_single_sample_goes(self):
        grid = self.raw("s.raw", "u8", (5, 5, 5), [int(n == 62) for n in range(125)])
        _, (rows, triangles, surface, told) = self.both(grid, "1")
        self.assertEqual((rows, triangles, surface["bounds"]), ([], [], None))

    def test_nothing_to_drop(self):
        volume_path = self.generate("noise", "n.nrrd", "9,8,7", "f32")
        whole, left = self.both([volume_path], "127.5")
        self.assertEqual((whole[:2], left[2]["dropped_triangles"]), (left[:2], 0))

    def test_fields_normals_and_blocks(self):
        """What belongs to a vertex stays with it, block by block."""
        values = [int((x + y) % 3 > 0) + int(z == 2) for z, y, x in itertools.product(range(4), repeat=3)]
        with open(self.path("b.xyz"), "w") as out:
            out.write("2\n4 4 4\n4 4 4\n")
            for shift in (0, 10):
                for axis in range(3):
                    out.write(" ".join(str(p[2 - axis] + shift) for p in itertools.product(range(4), repeat=3)) + "\n")
        with open(self.path("b.f"), "w") as out:
            out.write("2\n4 4 4 2\n4 4 4 2\n")
            for shift in (0, 10):
                out.write(" ".join(map(str, values)) + "\n")
                out.write(" ".join(str(x + shift) for z, y, x in itertools.product(range(4), repeat=3)) + "\n")
        fields = self.report("info", self.path("b.xyz"), self.path("b.f"))["blocks"][0]["fields"]
        names = [field["name"] for field in fields]
        grid = [self.path("b.xyz"), self.path("b.f"), "--field", names[0], "--carry", names[1]]
        _, (rows, triangles, surface, told) = self.judge(grid, "1", "--normals")
        for row in rows:
            self.assertAlmostEqual(row[0], row[6], places=5)  # the field is x
        self.expect(0, "extract", *grid, "--iso", "1", "--engine", "reference", "--quiet", "--drop-degenerate",
                    "--normals", "--blocks", "separate", "-o", self.path("p.ply"))
        parts = [ply_read(self.path(f"p_b{n}.ply")) for n in range(2)]
        self.assertEqual([len(part[0]) for part in parts], [len(rows) // 2] * 2)
        self.assertEqual(parts[0][0] + parts[1][0], rows)
        self.assertEqual(sum(len(part[1]) for part in parts), len(triangles))

    def test_needs_a_mesh(self):
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--count", "--drop-degenerate", says="--count makes no mesh")


class Streams(DataCase):
    def setUp(self):
        super().setUp()
        self.volume = self.generate("sphere", "s.nrrd", "12,11,10")
        self.words = [test_cli.TOOL, "extract", self.volume, "--iso", "127.5", "--engine", "reference"]

    def expected(self, ending):
        self.expect(0, *self.words[1:], "-o", self.path("good." + ending), "--quiet")
        with open(self.path("good." + ending), "rb") as file:
            return file.read()

    def run_split(self, *more, **how):
        return subprocess.run([*self.words, *more], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=400, **how)

    def test_mesh_on_standard_output(self):
        for ending in ("stl", "ply", "vtp", "obj"):
            good = self.expected(ending)
            for name in ("-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"):
                for more in ([], ["--json"], ["--quiet"]):
                    done = self.run_split("-o", name, "--format", ending, *more)
                    self.assertEqual((done.returncode, done.stdout), (0, good), (name, more))
                    self.assertEqual(b"bounds" in done.stderr, more != ["--quiet"])
        report = json.loads(self.run_split("-o", "-", "--format", "obj", "--json").stderr)
        self.assertEqual(report["surfaces"][0]["iso"], 127.5)
        self.assertNotIn("-", self.files())

    def test_file_that_the_shell_opened(self):
        good = self.expected("ply")
        with open(self.path("out.ply"), "wb") as out:
            done = subprocess.run([*self.words, "-o", self.path("out.ply")], stdout=out, stderr=subprocess.PIPE,
                                  timeout=400)
        with open(self.path("out.ply"), "rb") as file:
            self.assertEqual((done.returncode, file.read()), (0, good))

    def test_one_stream_for_both(self):
        good = self.expected("obj")
        for name in ("-", "/dev/stdout", "/dev/stderr"):
            done = subprocess.run([*self.words, "-o", name, "--format", "obj", "--nodata", "77.5"],
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=400)
            self.assertEqual((done.returncode, done.stdout), (0, good))

    def test_mesh_on_standard_error(self):
        done = self.run_split("-o", "/dev/stderr", "--format", "obj", "--nodata", "77.5")
        self.assertEqual((done.returncode, done.stderr), (0, self.expected("obj")))
        self.assertIn(b"--nodata 77.5", done.stdout)

    def test_pipe_by_name(self):
        os.mkfifo(self.path("pipe.obj"))
        read = []

        def reader():
            with open(self.path("pipe.obj"), "rb") as file:
                read.append(file.read())
        thread = threading.Thread(target=reader)
        thread.start()
        done = self.run_split("-o", self.path("pipe.obj"))
        thread.join(100)
        self.assertEqual((done.returncode, read), (0, [self.expected("obj")]))
        self.assertIn(b"bounds", done.stdout)

    def test_other_commands(self):
        for words in (["generate", "sphere", "--dims", "12,11,10", "--type", "u8"], ["tetrahedralize", self.volume]):
            name = self.path("good.nrrd" if words[0] == "generate" else "good.vtu")
            self.expect(0, *words, "--quiet", "-o", name)
            with open(name, "rb") as file:
                good = file.read()
            done = subprocess.run([test_cli.TOOL, *words, "-o", "-"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  timeout=400)
            self.assertEqual((done.returncode, done.stdout), (0, good))
            self.assertIn(b"-:", done.stderr)

    def test_usage(self):
        self.refuses(2, *self.words[1:], "-o", "-", says="--format")
        self.refuses(2, *self.words[1:], "-o", "-", "--format", "ply", "--blocks", "separate", says="one stream")
        self.refuses(2, *self.words[1:4], "100,120", "-o", "-", "--format", "ply", says="%")


class Homes(DataCase):
    """Users of containers have no home; PoCL then has no device, or builds nothing."""
    NOBODY = 65534

    def as_nobody(self, *words, **variables):
        environment = {name: value for name, value in os.environ.items()
                       if name not in ("POCL_CACHE_DIR", "XDG_CACHE_HOME", "HOME")}
        drop = None if os.getuid() else lambda: os.setuid(self.NOBODY)
        try:
            return subprocess.run([test_cli.TOOL, *words], env=dict(environment, **variables), stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, text=True, preexec_fn=drop, timeout=1000)
        except PermissionError:
            self.skipTest("nobody may not run the tool here")

    def test_cache_folder_that_nobody_can_make(self):
        if not test_cli.HAS_DEVICE or "Portable Computing" not in tool_platforms():
            self.skipTest("no PoCL")
        # /proc: whose permissions let root do what cannot be done
        for folder in ["/dev/null/kcache"] + ["/proc/kcache"] * os.path.exists("/proc/self"):
            self.refuses(1, "devices", says=f"cannot write its cache folder {folder}.*POCL_CACHE_DIR",
                         env={"POCL_CACHE_DIR": folder})

    def test_cache_folder_is_named(self):
        os.chmod(self.folder.name, 0o755)
        volume = self.generate("sphere", "s.nrrd", "12,11,10")
        os.chmod(volume, 0o644)
        os.mkdir(self.path("locked"), 0o555)  # for whoever runs this, unless that is root, who becomes nobody
        devices = self.as_nobody("devices", POCL_CACHE_DIR=self.path("locked/made"), HOME="/nonexistent")
        if not test_cli.HAS_DEVICE or "Portable Computing" not in tool_platforms():
            self.skipTest("no PoCL")
        self.assertIn("cache folder " + self.path("locked/made"), devices.stderr)
        os.makedirs(self.path("home/.cache/pocl/kcache"), 0o555)
        for variables, folder in (({"HOME": "/nonexistent"}, "/nonexistent/.cache/pocl/kcache"),
                                  ({"HOME": "/", "XDG_CACHE_HOME": "/nonexistent"}, "/nonexistent/pocl/kcache"),
                                  ({"HOME": self.path("home")}, self.path("home/.cache/pocl/kcache"))):
            words = ["extract", volume, "--iso", "127.5"]
            result = self.as_nobody(*words, **variables)
            self.assertEqual(result.returncode, 1, result)
            self.assertRegex(result.stderr, f"cannot write its cache folder {folder}.*POCL_CACHE_DIR.*HOME")
            self.assertNotIn("install", result.stderr.replace("is installed", ""))
            self.assertEqual(self.as_nobody(*words, "--engine", "auto", "--quiet", **variables).returncode, 0)


def tool_platforms():
    return test_cli.tool("devices").stdout


if __name__ == "__main__":
    test_cli.TOOL = os.path.abspath(sys.argv[1])
    test_cli.HAS_DEVICE = "reference" not in sys.argv[2:]
    test_cli.FAULT_LIBRARY = next((os.path.abspath(w[6:]) for w in sys.argv[2:] if w.startswith("fault=")), None)
    unittest.main(argv=[sys.argv[0], *test_cli.chosen()])
