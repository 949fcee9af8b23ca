#!/usr/bin/env python3
"""test_simplified.py TOOL [reference] [faults=LIBRARY] [all] - simplified surfaces, examined by code of its own

What --simplify leaves of a surface has its border, edge by edge, its components, each with its Euler characteristic and
its orientation, one fan at every vertex, no triangle twice, no new fold, and only vertices that were there. With `all`
random surfaces are 10,000, else 1,000; 120 in the quick tier, which tries some goals for each surface.
"""
import collections
import itertools
import math
import os
import random
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import grid_files
import tool_case
from meshes import ply_read
from tool_case import GridCase

FOLDED = math.cos(math.radians(150))
FAULTS = next((os.path.abspath(word[7:]) for word in sys.argv[2:] if word.startswith("faults=")), None)
IS_QUICK = "TEST_PLAIN_KERNELS" in os.environ
SURFACES = 10000 if "all" in sys.argv[2:] else 120 if IS_QUICK else 1000


def edges_of(triangle):
    return zip(triangle, triangle[1:] + triangle[:1])


def difference(p, q):
    return tuple(a - b for a, b in zip(p, q))


def cross(u, v):
    return tuple(u[i - 2] * v[i - 1] - u[i - 1] * v[i - 2] for i in range(3))


def dot(u, v):
    return sum(a * b for a, b in zip(u, v))


def normal(points, triangle):
    a, b, c = (points[v] for v in triangle)
    return cross(difference(b, a), difference(c, a))


def border(points, triangles):
    """Edges with one triangle, as directed pairs of places."""
    sides = collections.Counter(edge for t in triangles for edge in edges_of(t))
    return collections.Counter((points[a], points[b]) for (a, b), n in sides.items() for _ in range(n)
                               if (b, a) not in sides)


def components(points, triangles):
    """Of each component the vertices and its Euler characteristic, by its vertices' places."""
    parent = {}

    def root(v):
        while parent.setdefault(v, v) != v:
            parent[v] = parent[parent[v]]
            v = parent[v]
        return v
    for a, b, c in triangles:
        parent[root(a)] = root(b)
        parent[root(b)] = root(c)
    places, edges, faces = collections.defaultdict(set), collections.defaultdict(set), collections.Counter()
    for t in triangles:
        faces[root(t[0])] += 1
        places[root(t[0])].update(t)
        edges[root(t[0])].update(frozenset(edge) for edge in edges_of(t))
    return [({points[v] for v in used}, len(used) - len(edges[of]) + faces[of]) for of, used in places.items()]


def folds(points, triangles):
    """Edges whose two triangles are folded onto each other."""
    sides = {edge: t for t in triangles for edge in edges_of(t)}
    count = 0
    for (a, b), t in sides.items():
        other = sides.get((b, a))
        if a < b and other:
            n, m = normal(points, t), normal(points, other)
            lengths = math.sqrt(dot(n, n) * dot(m, m))
            count += lengths > 0 and dot(n, m) < FOLDED * lengths
    return count


def doubles(triangles):
    """Sets of three vertices that are corners of several triangles."""
    return [corners for corners, n in collections.Counter(map(frozenset, triangles)).items() if n > 1]


def crowded_edges(triangles):
    """Edges that several triangles pass in one direction."""
    return [edge for edge, n in collections.Counter(edge for t in triangles for edge in edges_of(t)).items() if n > 1]


def fan_faults(triangles):
    """Vertices whose triangles are not one run over edges, once around or from border to border."""
    around, faults = collections.defaultdict(dict), set()
    for a, b, c in triangles:
        for v, first, second in ((a, b, c), (b, c, a), (c, a, b)):
            if first in around[v]:
                faults.add(v)
            around[v][first] = second
    for v, fan in around.items():
        starts = [first for first in fan if first not in fan.values()] or [next(iter(fan))]
        at, count = starts[0], 0
        while at in fan and count < len(fan):
            at, count = fan[at], count + 1
        if len(starts) > 1 or count < len(fan):
            faults.add(v)
    return faults


def segment_square(p, a, b):
    along, to = difference(b, a), difference(p, a)
    length = dot(along, along)
    t = min(1, max(0, dot(to, along) / length)) if length else 0
    return sum((x - t * y) ** 2 for x, y in zip(to, along))


def triangle_square(p, a, b, c):
    """The square of a point's distance from a triangle."""
    n = cross(difference(b, a), difference(c, a))
    if dot(n, n) and all(dot(cross(n, difference(v, u)), difference(p, u)) >= 0 for u, v in ((a, b), (b, c), (c, a))):
        return dot(n, difference(p, a)) ** 2 / dot(n, n)
    return min(segment_square(p, u, v) for u, v in ((a, b), (b, c), (c, a)))


def farthest(points, surface):
    corners, triangles = surface
    return math.sqrt(max(min(triangle_square(p, *(corners[v] for v in t)) for t in triangles) for p in points))


class Simplified(GridCase):
    def setUp(self):
        super().setUp()
        if "simplifies: meshoptimizer" not in self.expect(0, "--version").stdout:
            self.skipTest("built without meshoptimizer")

    def read(self, name):
        _, _, rows, triangles, _ = ply_read(self.path(name))
        return [row[:3] for row in rows], triangles

    def judge(self, whole, left):
        """What both PLY files hold is one surface. Returns (points, triangles) of both."""
        (was, before), (now, after) = self.read(whole), self.read(left)
        self.assertEqual({v for t in after for v in t}, set(range(len(now))), "vertices that no triangle uses")
        self.assertFalse(collections.Counter(now) - collections.Counter(was), "a vertex that was not there")
        self.assertEqual(border(now, after), border(was, before))
        for name, faults in (("a triangle twice", doubles), ("an edge of several triangles", crowded_edges),
                             ("a vertex with several fans", fan_faults)):
            self.assertEqual(len(faults(after)), len(faults(before)), name)
        self.assertLessEqual(folds(now, after), folds(was, before))
        self.assert_components(components(was, before), components(now, after))
        return (was, before), (now, after)

    def assert_components(self, before, after):
        self.assertEqual(len(after), len(before))
        left = list(after)
        for places, euler in before:
            same = [n for n, (some, _) in enumerate(left) if some <= places]
            self.assertTrue(same, "a component has gone")
            # components may touch in places: of those that fit, one has to have the number
            fits = [n for n in same if left[n][1] == euler]
            self.assertTrue(fits, "a component has another Euler characteristic")
            del left[fits[0]]

    def both(self, grid, iso, share, *more, simplifying=(), **how):
        """The surface and what --simplify leaves of it, judged. Returns (report of the latter, both meshes)."""
        self.extract(grid, iso, *more, "--drop-degenerate", "-o", self.path("whole.ply"))
        report = self.extract(grid, iso, *more, "--simplify", share, *simplifying, "-o", self.path("left.ply"), **how)
        [surface] = report["surfaces"]
        meshes = self.judge("whole.ply", "left.ply")
        self.assertEqual((surface["simplified"]["vertices_before"], surface["simplified"]["triangles_before"],
                          surface["vertices"], surface["triangles"]), tuple(map(len, meshes[0] + meshes[1])))
        return report, meshes

    def test_reaches_its_goal(self):
        """Smooth closed surfaces have nothing that keeps triangles."""
        cases = itertools.product(enumerate(("sphere", "torus", "tangle")), enumerate(("tetra", "hybrid", "snap")),
                                  enumerate(("0.5", "0.2", "0.05")))
        for (a, field), (b, method), (c, share) in cases:
            if IS_QUICK and (a + b + c) % 3:  # each field with each method, each of both with each share
                continue
            with self.subTest(field=field, method=method, share=share):
                grid = [self.generate(field, "s.nrrd", "30,29,28", "f32"), "--method", method]
                report, (before, after) = self.both(grid, "127.5", share, "--closed")
                self.assertLessEqual(len(after[1]), math.ceil(1.05 * float(share) * len(before[1])) + 8)
                self.assertEqual(border(*after), {})
                self.assertEqual(report["notices"], [])

    def test_random_surfaces(self):
        """Several isovalues of random grids: noise, ties, missing samples, borders."""
        generator, done, reduced = random.Random(21), 0, 0
        while done < SURFACES:
            dims = [generator.randrange(2, 10) for _ in range(3)]
            count = dims[0] * dims[1] * dims[2]
            levels = generator.choice((4, 12, 200))
            values = [generator.randrange(levels) for _ in range(count)]
            if generator.random() < 0.5:  # smoother, with larger triangles to contract
                values = [round(levels / 2 + levels / 3 * math.sin(0.9 * x + y) * math.cos(0.7 * z + done)) +
                          generator.randrange(2) for z, y, x in itertools.product(*map(range, reversed(dims)))]
            grid = self.raw("r.raw", "f32", dims, values)
            more = ["--method", generator.choice(("tetra", "hybrid", "snap"))]
            more += ["--closed"] if generator.random() < 0.4 else []
            more += ["--nodata", str(values[0])] if generator.random() < 0.2 else []
            isovalues = ",".join(f"{generator.randrange(1, 2 * levels) / 2:g}" for _ in range(8))
            isovalues = ",".join(dict.fromkeys(isovalues.split(",")))
            share = generator.choice(("0.5", "0.2", "0.1", "0.05", "0.01"))
            arguments = [*grid, "--iso", isovalues, "--engine", "reference", "--quiet", *more]
            with self.subTest(dims=dims, values=values, more=more, isovalues=isovalues, share=share):
                self.expect(0, "extract", *arguments, "--drop-degenerate", "-o", self.path("w%.ply"))
                self.expect(0, "extract", *arguments, "--simplify", share, "-o", self.path("l%.ply"))
                for isovalue in isovalues.split(","):
                    before, after = self.judge(f"w{isovalue}.ply", f"l{isovalue}.ply")
                    reduced += len(after[1]) < len(before[1])
                    done += 1
        self.assertGreater(reduced, SURFACES // 4)

    def test_values_stay_with_their_vertices(self):
        self.needs_xml()
        points = [(x, y, z) for z, y, x in itertools.product(range(9), repeat=3)]
        values = [10 - math.dist(p, (4, 4, 4)) for p in points]
        grid = [self.write_hexahedra("h.vtu", (9, 9, 9), values), "--field", "bump", "--carry", "x"]
        self.extract(grid, "7", "--simplify", "0.2", "-o", self.path("c.ply"))
        _, _, rows, triangles, _ = ply_read(self.path("c.ply"))
        self.assertLess(len(triangles), 300)
        for row in rows:
            self.assertAlmostEqual(row[0], row[3], places=5)
        path = self.generate("sphere", "s.nrrd", "20,20,20", "f32")
        self.extract([path], "127.5", "--normals", "--simplify", "0.1", "-o", self.path("n.ply"))
        for row in ply_read(self.path("n.ply")).rows:
            length = math.sqrt(dot(row[:3], row[:3]))
            self.assertGreater(abs(dot(row[:3], row[3:6])) / length, 0.9)

    def test_blocks(self):
        """Each block is simplified by itself, whether they are written together or not."""
        points = grid_files.lattice((9, 8, 9))
        shifted = [(x + 8, y, z) for x, y, z in points]
        grid = self.write_plot3d("b", [((9, 8, 9), some, [math.dist(p, (4, 4, 4)) for p in points])
                                       for some in (points, shifted)])
        grid += ["--field", "density"]
        self.both(grid, "3", "0.3")
        joined = self.read("left.ply")
        self.extract(grid, "3", "--simplify", "0.3", "--blocks", "separate", "-o", self.path("p.ply"))
        parts = [self.read(f"p_b{n}.ply") for n in range(2)]
        self.assertEqual(parts[0][0] + parts[1][0], joined[0])
        first = len(parts[0][0])
        self.assertEqual(parts[0][1] + [tuple(v + first for v in t) for t in parts[1][1]], joined[1])

    def test_same_bytes(self):
        path = self.generate("gyroid", "g.nrrd", "40,39,38", "u8")
        made = set()
        for engine in self.engines() * 2:
            self.expect(0, "extract", path, "--iso", "127.5", "--engine", engine, "--simplify", "0.1", "--quiet", "-o",
                        self.path("g.ply"))
            with open(self.path("g.ply"), "rb") as file:
                made.add(file.read())
        self.assertEqual(len(made), 1)

    def test_distances(self):
        """Those that are reported are of no sample more than by brute force, and of no vertex less."""
        path = self.generate("sphere", "s.nrrd", "12,12,12", "f32")
        report, (before, after) = self.both([path], "127.5", "0.2")
        told = report["surfaces"][0]["simplified"]
        centroids = [tuple(sum(after[0][v][k] for v in t) / 3 for k in range(3)) for t in after[1]]
        self.assertGreater(told["distance_to"], 0)
        self.assertGreaterEqual(told["distance_to"] + 1e-9, farthest(before[0], after))
        self.assertGreaterEqual(told["distance_from"] + 1e-9, farthest(centroids, before))
        fine = [tuple((a * before[0][t[0]][k] + b * before[0][t[1]][k] + (4 - a - b) * before[0][t[2]][k]) / 4
                      for k in range(3)) for t in before[1][::20] for a in range(5) for b in range(5 - a)]
        self.assertLessEqual(farthest(fine, after), 1.5 * told["distance_to"])

    def test_bound_of_the_distance(self):
        path = self.generate("torus", "t.nrrd", "40,40,40", "f32")
        left = []
        for bound in ("0.1", "0.02", "0.004", "0.0000001"):
            report, (_, after) = self.both([path], "127.5", "0.01", simplifying=("--simplify-error", bound))
            told = report["surfaces"][0]["simplified"]
            self.assertLessEqual(max(told["distance_to"], told["distance_from"]), float(bound))
            left.append(len(after[1]))
        self.assertEqual(left, sorted(left))
        self.assertLess(left[0], left[-1])
        self.assertRegex(report["notices"][-1], r"triangles are left, not \d+: --simplify-error")

    def test_border_keeps_triangles(self):
        path = self.generate("gyroid", "g.nrrd", "12,12,12", "f32")
        report, _ = self.both([path], "127.5", "0.01")
        self.assertRegex(report["notices"][0], r"triangles are left, not \d+: the border.*; for fewer, smooth or thin")

    def test_shape_that_is_lost(self):
        """A few triangles of a ball are told to be none; those of a cube, which has no more, are not."""
        ball = self.generate("sphere", "s.nrrd", "40,40,40", "f32")
        for share, more, says in (("0.001", [], r"^isovalue 127.5: \d+ triangles are left, .* shape is lost; a larger RATIO"),
                                  ("0.001", ["--simplify-error", "9"], "shape is lost; a smaller --simplify-error"),
                                  ("0.01", [], None)):
            told = self.extract([ball], "127.5", "--simplify", share, *more)["notices"]
            self.assertEqual(len(told), says is not None, told)
            if says:
                self.assertRegex(told[0], says)
        values = [0 if 0 in (x, y, z) or 19 in (x, y, z) else 2 for z in range(20) for y in range(20) for x in range(20)]
        report = self.extract(self.raw("cube.raw", "u8", (20, 20, 20), values), "1", "--simplify", "0.02")
        self.assertNotIn("shape is lost", "".join(report["notices"]))

    def test_empty(self):
        path = self.generate("empty", "e.nrrd")
        report = self.extract([path], "127.5", "--simplify", "0.5", "-o", self.path("e.ply"))
        self.assertEqual(report["surfaces"][0]["triangles"], 0)
        self.assertEqual(report["surfaces"][0]["simplified"]["distance_to"], 0)

    def test_text(self):
        path = self.generate("sphere", "s.nrrd")
        text = self.expect(0, "extract", path, "--iso", "127.5", "--engine", "reference", "--simplify", "0.25", "--check").stdout
        self.assertRegex(text, r"simplified  from \d+ vertices, \d+ triangles.*topology and border are the same")
        self.assertRegex(text, r"distances, in units of coordinates, by samples: [\d.e-]+ of the surface before")
        self.assertRegex(text, r"check       manifold, closed: 0 boundary edges")

    def test_a_library_that_breaks_surfaces(self):
        """Whatever it makes, no surface is written that is another one."""
        if not FAULTS:
            self.skipTest("no library of faults given")
        path = self.generate("tangle", "t.nrrd", "24,24,24", "f32")
        noise = self.generate("noise", "n.nrrd", "10,10,10", "f32")
        for fault, grid in itertools.product(("hole", "double", "turn", "pinch", "split", "half", "all", "once"),
                                             (path, noise)):
            with self.subTest(fault=fault, grid=grid):
                how = {"env": {"LD_PRELOAD": FAULTS, "SIMPLIFY_FAULT": fault}}
                _, (before, after) = self.both([grid], "127.5", "0.2", **how)
                if fault == "once":  # what went wrong in the first trial is mended by the next ones
                    self.assertLess(len(after[1]), 0.8 * len(before[1]))

    def test_refusals(self):
        path = self.generate("sphere", "s.nrrd")
        start = ["extract", path, "--iso", "127.5", "--engine", "reference"]
        for share in ("0", "1", "-0.5", "1.5", "nan", "half", "0.5x", ""):
            self.refuses(2, *start, "--simplify", share, says="--simplify: give one number above 0 and below 1")
        for bound in ("0", "-1", "nan", "inf", "x"):
            self.refuses(2, *start, "--simplify", "0.5", "--simplify-error", bound, says="--simplify-error: give one number")
        self.refuses(2, *start, "--simplify-error", "1", says="--simplify-error bounds what --simplify does")
        self.refuses(2, *start, "--simplify", "0.5", "--count", says="--count makes no mesh: leave out --simplify")
        self.refuses(2, *start, "--simplify", "0.5", "--stream", "-o", self.path("o.ply"), says="--simplify needs the whole mesh")
        self.refuses(2, *start, "--simplify", "0.5", "--part", "0/2", "-o", self.path("o.tcpart"),
                     says="--simplify needs the whole mesh")
        self.refuses(2, "labels", path, "--simplify", "0.5", says="labels has no option --simplify")


class Absent(GridCase):
    def test_says_what_to_install(self):
        if "simplifies: meshoptimizer" in self.expect(0, "--version").stdout:
            self.skipTest("built with meshoptimizer")
        path = self.generate("sphere", "s.nrrd")
        self.refuses(2, "extract", path, "--iso", "127.5", "--simplify", "0.5", says="needs meshoptimizer.*libmeshoptimizer-dev")


if __name__ == "__main__":
    tool_case.main()
