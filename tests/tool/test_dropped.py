#!/usr/bin/env python3
"""test_dropped.py TOOL [reference] - surfaces without triangles of zero area, read back and examined by code of its own

With --drop-degenerate no triangle of zero area is left, all others stay, what was closed is closed and what was a
manifold is one.
"""
import collections
import itertools
import os
import random
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from meshes import measures, ply_read
from tool_case import GridCase


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


class Dropped(GridCase):
    def both(self, grid, iso, *more):
        """The surface with its triangles of zero area, and without."""
        meshes = []
        for extra in ([], ["--drop-degenerate"]):
            report = self.extract(grid, iso, *more, *extra, "-o", self.path("o.ply"))
            _, _, rows, triangles, _ = ply_read(self.path("o.ply"))
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
        self.assertAlmostEqual(measures(rows, triangles)[1], measures(whole[0], whole[1])[1], places=5)
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
        parts = [ply_read(self.path(f"p_b{n}.ply"))[2:] for n in range(2)]
        self.assertEqual([len(part[0]) for part in parts], [len(rows) // 2] * 2)
        self.assertEqual(parts[0][0] + parts[1][0], rows)
        self.assertEqual(sum(len(part[1]) for part in parts), len(triangles))

    def test_stl_tells(self):
        """Programs join an STL's vertices by position: where few triangles have no area, they are told of all the same."""
        values = [x + 10 * (y * y + z * z) for z, y, x in itertools.product(range(9), repeat=3)]
        grid = [*self.raw("ties.raw", "u16", (9, 9, 9), values), "--iso", "52"]
        for ending, extra, says in (("stl", [], True), ("ply", [], False), ("stl", ["--drop-degenerate"], False)):
            result = self.expect(0, "extract", *grid, "--engine", "reference", *extra, "-o", self.path("ties." + ending))
            self.assertEqual("--drop-degenerate leaves them out" in result.stderr, says, (ending, extra, result.stderr))

    def test_needs_a_mesh(self):
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--count", "--drop-degenerate", says="--count makes no mesh")


if __name__ == "__main__":
    tool_case.main()
