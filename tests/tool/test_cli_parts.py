#!/usr/bin/env python3
"""test_cli_parts.py TOOL [reference] - parts of grids: --roi, --roi-world, --step, --mask

A part is compared with the same samples written as a file of their own, and with the whole: surfaces of regions that
share a plane of samples have together the triangles of the whole, to the bit. Files that are far larger than memory, of
which only a region is there, show that nothing else is read.
"""
import collections
import gzip
import itertools
import os
import random
import resource
import struct
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from grid_files import HEXAHEDRON, bump, data_array, hexahedra, lattice, structured_text, vti_text, vts_text, vtu_text
from meshes import ply_read
from tool_case import GridCase

DIMS = (11, 9, 10)
POINTS = lattice(DIMS)


def noise(seed, points=POINTS):
    source = random.Random(seed)
    return [round(source.uniform(-1, 1), 3) + 0.0004 for _ in points]


def part_of(values, dims, ranges, step=(1, 1, 1)):
    """What numpy's values[k0:k1:s, j0:j1:s, i0:i1:s] has, and its size."""
    x, y, z = (range(*ranges[axis], step[axis]) for axis in range(3))
    return [values[i + dims[0] * (j + dims[1] * k)] for k in z for j in y for i in x], (len(x), len(y), len(z))


def roi(ranges):
    return ",".join(f"{begin}:{end}" for begin, end in ranges)


class PartCase(GridCase):
    def triangles(self, arguments, iso, *more):
        """Those of the mesh that is written: each as the positions, and all else, of its corners, from the least on."""
        self.extract(arguments, iso, "-o", self.path("t.ply"), "--quiet", *more)
        ply = ply_read(self.path("t.ply"))
        found = collections.Counter()
        for corners in ply.triangles:
            p = [ply.rows[n] for n in corners]
            first = p.index(min(p))
            found[tuple(p[first:] + p[:first])] += 1
        return found

    def expect_fit(self, arguments, iso, dims, *more, cuts=(4, 5, 3), first=(0, 0, 0)):
        """Eight regions that share planes have the whole's triangles together."""
        whole = self.triangles(arguments, iso, *more)
        self.assertGreater(sum(whole.values()), 50)
        sides = [((first[axis], first[axis] + cuts[axis] + 1), (first[axis] + cuts[axis], first[axis] + dims[axis]))
                 for axis in range(3)]
        parts = collections.Counter()
        for ranges in itertools.product(*sides):
            parts.update(self.triangles(arguments, iso, *more, "--roi", roi(ranges)))
        self.assertEqual(parts, whole)

    def hash_of(self, arguments, iso, *more):
        [surface] = self.extract(arguments, iso, *more)["surfaces"]
        return surface["hash"], surface["triangles"]

    def vtr(self, name, dims, axes, fields, cell_fields=()):
        arrays = "".join(data_array("xyz"[axis], "f64", axes[axis]) for axis in range(3))
        return self.write(name, structured_text("RectilinearGrid", dims, (0, 0, 0),
                                                f"<Coordinates>{arrays}</Coordinates>", fields, cell_fields))


class Regions(PartCase):
    def test_regions_of_uniform_grids_fit(self):
        volume = self.raw("a.raw", "f32", DIMS, noise(1)) + ["--spacing", "0.3,0.7,1.1", "--origin", "5,-3,100"]
        self.expect_fit(volume, "0.1", DIMS)
        self.expect_fit(volume, "0.1", DIMS, "--method", "hybrid")
        self.expect_fit(self.raw("b.raw", "u8", DIMS, [round(127 + 120 * v) for v in noise(2)]), "127", DIMS)

    def test_regions_of_long_grids_fit(self):
        """A region far from 0 by its own size is placed as it is in the whole."""
        dims = (1400, 5, 4)
        points = lattice(dims)
        values = [bump((p[0] % 9, 2 * p[1], 2 * p[2])) for p in points]
        whole = self.raw("a.raw", "f32", dims, values) + ["--spacing", "0.7,0.3,0.9", "--origin", "3e6,4e6,0"]
        axes = [[0.7 * n for n in range(1400)], [0.3 * n for n in range(5)], [1.1 * n for n in range(4)]]
        grids = [(whole, 0)]
        if "VTK XML" in self.expect(0, "--version").stdout:
            grids.append(([self.vtr("a.vtr", dims, axes, [("f", "f64", values)])], 0))
            bent = [(0.7 * x + 0.1 * y, 0.3 * y, z + 0.01 * (x % 5)) for x, y, z in points]
            grids.append(([self.write("a.vts", vts_text(dims, bent, [("f", "f64", values)]))], 0))
            grids.append(([self.write("a.vti", vti_text(dims, [("f", "f64", values)], first=(80001, 0, 0)))] +
                          ["--spacing", "0.7,1,1"], 80001))
        for arguments, first in grids:
            parts = collections.Counter()
            for begin, end in ((0, 1301), (1300, 1321), (1320, 1400)):
                parts.update(self.triangles(arguments, "0.2", "--roi", f"{first + begin}:{first + end},:,:"))
            self.assertEqual(parts, self.triangles(arguments, "0.2"))

    def test_regions_of_other_grids_fit(self):
        self.needs_xml()
        values = noise(3)
        bent = [(x + 0.2 * y, y - 0.1 * z, 1.5 * z + 0.05 * x * y) for x, y, z in POINTS]
        axes = [[0.5 * n * (n + 3) for n in range(DIMS[0])], [float(-n) for n in range(DIMS[1])],
                [n / 3 for n in range(DIMS[2])]]
        carried = [("f", "f32", values), ("g", "f32", noise(4)), ("v", "f64", noise(5, 3 * POINTS), 3)]
        more = ["--field", "f", "--carry", "g,v"]
        self.expect_fit([self.write("a.vts", vts_text(DIMS, bent, carried))], "0.1", DIMS, *more)
        self.expect_fit([self.vtr("a.vtr", DIMS, axes, carried)], "0.1", DIMS, *more)
        self.expect_fit([self.write("a.vti", vti_text(DIMS, carried, first=(-3, 4, 1)))], "0.1", DIMS, *more,
                        first=(-3, 4, 1))

    def test_values_of_cells(self):
        """They are averaged as in the whole, also beside a region's border."""
        self.needs_xml()
        cells = lattice([n - 1 for n in DIMS])
        values = noise(6, cells)
        values[100:103] = [-99.0, float("nan"), -99.0]
        ghosts = [32 * (n % 61 == 7) for n in range(len(cells))], [2 * (n % 97 == 5) for n in range(len(POINTS))]
        fields = [("f", "f64", values), ("g", "f32", noise(7, cells)), ("vtkGhostType", "u8", ghosts[0])]
        volume = self.write("a.vti", vti_text(DIMS, [("vtkGhostType", "u8", ghosts[1])], fields))
        more = ["--field", "f", "--carry", "g", "--nodata", "-99"]
        self.expect_fit([volume], "0.05", DIMS, *more)
        report = self.report("info", volume, "--field", "f", "--roi", "2:5,3:6,1:9", "--quiet")
        kept = part_of(values, [n - 1 for n in DIMS], ((2, 4), (3, 5), (1, 8)))[0]
        [block] = report["blocks"]
        self.assertEqual(block["fields"][0]["ranges"], [[min(kept), max(kept)]])
        self.assertEqual((block["points"], block["cells"]), (3 * 3 * 8, 2 * 2 * 7))

    def test_missing_samples(self):
        self.needs_xml()
        values = noise(8)
        for n in range(3, len(values), 41):
            values[n] = -9.5
        volume = self.raw("a.raw", "f32", DIMS, values)
        self.expect_fit(volume, "0.1", DIMS, "--nodata", "-9.5")
        ghosts = [2 * (n % 41 == 3) for n in range(len(values))]
        blanked = self.write("a.vti", vti_text(DIMS, [("f", "f32", values), ("vtkGhostType", "u8", ghosts)]))
        self.assertEqual(self.triangles([blanked], "0.1"), self.triangles(volume, "0.1", "--nodata", "-9.5"))
        self.expect_fit([blanked], "0.1", DIMS)

    def test_as_a_file_of_its_own(self):
        """A region has the bytes of its samples alone, moved by its first index. Normals too: on its border they are
        those of a border."""
        values = noise(9)
        ranges = ((2, 9), (4, 8), (0, 7))
        kept, dims = part_of(values, DIMS, ranges)
        whole = self.raw("a.raw", "f64", DIMS, values)
        alone = self.raw("b.raw", "f64", dims, kept)
        for more in ([], ["--normals"]):
            moved = collections.Counter()
            for p, count in self.triangles(alone, "0.1", *more).items():
                moved[tuple((q[0] + 2, q[1] + 4, *q[2:]) for q in p)] += count
            found = self.triangles(whole, "0.1", "--roi", roi(ranges), *more)
            self.assertEqual(sorted(len(found) for found in (moved, found)), [len(found)] * 2)
            for one, other in zip(sorted(moved), sorted(found)):
                for p, q in zip(one, other):
                    for a, b in zip(p, q):
                        self.assertAlmostEqual(a, b, places=4)

    def test_report(self):
        volume = self.raw("a.raw", "u8", DIMS, [n % 7 * 30 for n in range(len(POINTS))])
        for command in (["extract", "--iso", "50", "--engine", "reference"],
                        ["extract", "--iso", "50", "--engine", "reference", "--count"], ["info"]):
            report = self.report(*command, *volume, "--roi", "2:,:,-0:8", "--step", "2,1,3", "--spacing", "2,1,1")
            self.assertEqual((report["roi"], report["step"], report["dims"]),
                             ([[2, 11], [0, 9], [0, 7]], [2, 1, 3], [5, 9, 3]))
            report = self.report(*command, *volume)
            self.assertEqual((report["roi"], report["step"], report["dims"]), (None, None, list(DIMS)))
        report = self.report("info", *volume, "--roi", "4:,:,:", "--step", "2,1,3", "--spacing", "2,1,1")
        self.assertEqual((report["first"], report["spacing"]), ([2, 0, 0], [4, 1, 3]))
        self.assertEqual([corner[0] for corner in report["blocks"][0]["bounds"]], [8, 20])
        for command in (["extract", "--iso", "50", "--engine", "reference"], ["info"]):
            told = self.expect(0, *command, *volume, "--roi", ":5,:,:", "--step", "2,1,1").stdout
            self.assertRegex(told, r"part: *0:5, 0:9, 0:10 of 11 x 9 x 10 samples, in steps of 2, 1, 1\n"
                             if command != ["info"] else r"part +0:5, 0:9")

    def test_verify(self):
        self.needs_device()
        volume = self.raw("a.raw", "u8", DIMS, [round(127 + 120 * v) for v in noise(2)])
        report, surface = self.surface(*volume, "--iso", "127", "--roi", "1:9,:,2:8", "--step", "1,2,1", "--mask",
                                       volume[0])
        self.assertTrue(surface["verified"])
        self.assertEqual(report["dims"], [8, 5, 6])


class Steps(PartCase):
    def test_as_sliced(self):
        """Every Nth sample is what a slice has, at the same place."""
        values = noise(10)
        whole = self.raw("a.raw", "f32", DIMS, values) + ["--spacing", "1,2,0.5", "--origin", "4,0,-8"]
        for begins, step in (((0, 0, 0), (2, 2, 2)), ((1, 0, 2), (3, 1, 4)), ((0, 1, 0), (1, 2, 3))):
            ranges = [(begins[axis], DIMS[axis]) for axis in range(3)]
            kept, dims = part_of(values, DIMS, ranges, step)
            place = [[4, 0, -8][axis] + [1, 2, 0.5][axis] * begins[axis] for axis in range(3)]
            spacing = [[1, 2, 0.5][axis] * step[axis] for axis in range(3)]
            sliced = self.raw("b.raw", "f32", dims, kept) + ["--spacing", ",".join(map(str, spacing)), "--origin",
                                                             ",".join(map(str, place))]
            thinned = ["--step", ",".join(map(str, step)), "--roi", ",".join(f"{begin}:" for begin in begins)]
            self.assertEqual(self.hash_of(whole, "0.1", *thinned), self.hash_of(sliced, "0.1"))
            self.assertGreater(self.hash_of(whole, "0.1", *thinned)[1], 50)
        self.assertEqual(self.hash_of(whole, "0.1", "--step", "2"), self.hash_of(whole, "0.1", "--step", "2,2,2"))

    def test_vectors_text_and_compressed(self):
        """Of images that are not used where they lie."""
        vectors, ranges, step = noise(17, 3 * POINTS), ((1, 10), (0, 9), (2, 10)), (2, 1, 3)
        more = ["--roi", roi(ranges), "--step", "2,1,3"]
        triples = list(zip(*[iter(vectors)] * 3))
        kept, dims = part_of(triples, DIMS, ranges, step)

        def nrrd(name, sizes, values, encoding="raw"):
            data = struct.pack(f">{len(values)}d", *values)
            data = {"raw": data, "gzip": gzip.compress(data), "ascii": " ".join(map(repr, values)).encode()}[encoding]
            with open(self.path(name), "wb") as out:
                out.write(f"NRRD0004\ntype: double\ndimension: {len(sizes)}\nsizes: {' '.join(map(str, sizes))}\n"
                          f"endian: big\nencoding: {encoding}\nkinds:{' vector' * (len(sizes) > 3)}{' domain' * 3}\n\n"
                          .encode() + data)
            return [self.path(name)]
        place = ["--spacing", "2,1,3", "--origin", "1,0,2"]
        whole = nrrd("v.nrrd", (3, *DIMS), vectors) + ["--spacing", "1,1,1"]
        sliced = nrrd("w.nrrd", (3, *dims), list(itertools.chain.from_iterable(kept)))
        for component in ("0", "2", "magnitude"):
            self.assertEqual(self.hash_of(whole, "0.6", "--component", component, *more),
                             self.hash_of(sliced, "0.6", "--component", component, *place))
        sliced = nrrd("s.nrrd", dims, [triple[1] for triple in kept])
        encodings = ["raw", "ascii"] + ["gzip"] * ("gzip" in self.expect(0, "--version").stdout)
        for encoding in encodings:
            whole = nrrd("t.nrrd", DIMS, vectors[1::3], encoding) + ["--spacing", "1,1,1"]
            self.assertEqual(self.hash_of(whole, "0.1", *more), self.hash_of(sliced, "0.1", *place))

    def test_parity(self):
        """Thinned regions that share a plane fit, wherever they begin."""
        volume = self.raw("a.raw", "f32", DIMS, noise(11))
        for begin, cut, step in ((0, 4, 2), (0, 6, 2), (1, 7, 3), (2, 6, 2), (1, 5, 4)):
            steps = ["--step", f"{step},1,1"]
            whole = self.triangles(volume, "0.1", *steps, "--roi", f"{begin}:,:,:")
            parts = self.triangles(volume, "0.1", *steps, "--roi", f"{begin}:{cut + 1},:,:")
            parts.update(self.triangles(volume, "0.1", *steps, "--roi", f"{cut}:,:,:"))
            self.assertEqual(parts, whole, (begin, cut, step))

    def test_other_grids(self):
        self.needs_xml()
        values, other = noise(12), noise(13)
        bent = [(x + 0.25 * y, y - 0.5 * z, 1.5 * z + 0.125 * x) for x, y, z in POINTS]
        axes = [[0.5 * n * (n + 3) for n in range(DIMS[0])], [float(-n) for n in range(DIMS[1])],
                [n / 4 for n in range(DIMS[2])]]
        ranges, step = ((1, 10), (0, 9), (2, 10)), (2, 3, 2)
        more = ["--roi", roi(ranges), "--step", "2,3,2"]
        ghosts = [2 * (n % 29 == 3) for n in range(len(values))]

        def fields(take):
            return [("f", "f32", take(values)), ("g", "f64", take(other)), ("vtkGhostType", "u8", take(ghosts))]

        def sliced(all_of):
            return part_of(all_of, DIMS, ranges, step)[0]
        dims = part_of(values, DIMS, ranges, step)[1]
        first = [ranges[axis][0] // step[axis] for axis in range(3)]
        carry = ["--field", "f", "--carry", "g"]
        whole = self.write("a.vts", vts_text(DIMS, bent, fields(list)))
        thinned = self.write("b.vts", vts_text(dims, sliced(bent), fields(sliced), first=first))
        self.assertEqual(self.triangles([whole], "0.1", *carry, *more), self.triangles([thinned], "0.1", *carry))
        self.assertGreater(len(self.triangles([thinned], "0.1", *carry)), 20)
        whole = self.vtr("a.vtr", DIMS, axes, fields(list))
        thin_axes = [axes[axis][ranges[axis][0]:ranges[axis][1]:step[axis]] for axis in range(3)]
        arrays = "".join(data_array("xyz"[axis], "f64", thin_axes[axis]) for axis in range(3))
        thinned = self.write("b.vtr", structured_text("RectilinearGrid", dims, first,
                                                      f"<Coordinates>{arrays}</Coordinates>", fields(sliced)))
        self.assertEqual(self.triangles([whole], "0.1", *carry, *more), self.triangles([thinned], "0.1", *carry))

    def test_cells(self):
        """A cell is left out where one is blanked that it consists of; averages are those of the whole."""
        self.needs_xml()
        cell_dims = [n - 1 for n in DIMS]
        cells = lattice(cell_dims)
        blanked = {(3, 2, 5), (8, 7, 1)}
        ghosts = [32 * (cell in blanked) for cell in cells]
        values = [bump(cell) for cell in cells]
        volume = self.write("a.vti", vti_text(DIMS, (), [("f", "f64", values), ("vtkGhostType", "u8", ghosts)]))
        means = []
        for x, y, z in POINTS:
            around = [values[a + cell_dims[0] * (b + cell_dims[1] * c)] for a, b, c in cells
                      if x - 1 <= a <= x and y - 1 <= b <= y and z - 1 <= c <= z and (a, b, c) not in blanked]
            means.append(sum(around) / len(around))
        kept, dims = part_of(means, DIMS, [(0, n) for n in DIMS], (2, 2, 2))
        coarse = {tuple(n // 2 for n in cell) for cell in blanked}
        thin_ghosts = [32 * (cell in coarse) for cell in lattice([n - 1 for n in dims])]
        text = vti_text(dims, [("f", "f64", kept)], [("vtkGhostType", "u8", thin_ghosts)])
        thinned = self.write("b.vti", text.replace('Spacing="1 1 1"', 'Spacing="2 2 2"'))
        self.assertEqual(self.hash_of([volume], "2.1", "--step", "2"), self.hash_of([thinned], "2.1"))
        self.assertGreater(self.hash_of([thinned], "2.1")[1], 20)


class World(PartCase):
    def ranges(self, arguments, world, *more):
        return self.report("info", *arguments, "--roi-world=" + world, *more)["roi"]

    def test_uniform(self):
        volume = self.raw("a.raw", "f32", DIMS, noise(14)) + ["--spacing", "0.5,2,0.1", "--origin", "-1,10,0"]
        self.assertEqual(self.ranges(volume, "0:1,11:14.5,0.25:"), [[2, 5], [0, 4], [2, 10]])
        self.assertEqual(self.ranges(volume, "-50:50,:14,0.3:0.5"), [[0, 11], [0, 3], [3, 6]])
        self.assertEqual(self.ranges(volume, "0.1:0.2,:,:"), [[2, 4], [0, 9], [0, 10]])
        self.assertEqual(self.ranges(volume, "0:2,:,:", "--step", "2"), [[2, 7], [0, 9], [0, 9]])
        self.assertEqual(self.hash_of(volume, "0.1", "--roi-world", "0:1,11:14.5,0.25:"),
                         self.hash_of(volume, "0.1", "--roi", "2:5,0:4,2:10"))

    def test_mirrored_and_turned(self):
        with open(self.path("a.nhdr"), "w") as header:
            header.write("NRRD0004\ntype: float\ndimension: 3\nsizes: 11 9 10\nencoding: raw\nendian: little\n"
                         "space dimension: 3\nspace directions: (0,-1,0) (2,0,0) (0,0,-0.5)\nspace origin: (7,0,3)\n"
                         "data file: a.raw\n")
        self.raw("a.raw", "f32", DIMS, noise(15))
        self.assertEqual(self.ranges([self.path("a.nhdr")], "9.5:13,-6:-2.5,0:1"), [[2, 7], [1, 4], [4, 7]])

    def test_other_grids(self):
        self.needs_xml()
        fields = [("f", "f32", noise(16))]
        axes = [[0, 1, 3, 7, 8, 9, 10, 11, 12, 13, 20], [8 - n for n in range(9)], [n / 4 for n in range(10)]]
        grid = [self.vtr("a.vtr", DIMS, axes, fields)]
        self.assertEqual(self.ranges(grid, "4:5,2.5:4,0.5:1"), [[2, 4], [4, 7], [2, 5]])
        self.assertEqual(self.ranges(grid, "-4:0.5,:,2.2:99"), [[0, 2], [0, 9], [8, 10]])
        self.refuses(2, "info", *grid, "--roi-world", "21:22,:,:", says="the grid does not lie there.*11 x 9 x 10")
        bent = [(x + 100, 2 * y, z) for x, y, z in POINTS]
        grid = [self.write("a.vts", vts_text(DIMS, bent, fields))]
        self.assertEqual(self.ranges(grid, "103:105.5,3:9,-5:2"), [[2, 7], [1, 6], [0, 4]])
        self.refuses(2, "info", *grid, "--roi-world", "103.1:103.2,:,:", says="no sample lies there.*11 x 9 x 10")

    def test_nothing_there(self):
        volume = self.raw("a.raw", "f32", DIMS, noise(14))
        for world in ("11:12,:,:", ":,:,-5:-1", ":,8.5:9,20:"):
            self.refuses(2, "extract", *volume, "--iso", "0", "--engine", "reference", "--roi-world=" + world,
                         says="the grid does not lie there: the grid has 11 x 9 x 10 samples")
        self.refuses(2, "info", *volume, "--roi-world=:0,:,:", says="leaves 1 sample along x")


class Masks(PartCase):
    def setUp(self):
        super().setUp()
        self.values = noise(20)
        self.labels = [3 * (n % 23 != 5 and n % 101 != 7) for n in range(len(self.values))]
        self.volume = self.raw("a.raw", "f32", DIMS, self.values)
        self.raw("m.raw", "u8", DIMS, self.labels)
        marked = [value if label else -7.0 for value, label in zip(self.values, self.labels)]
        self.marked = self.raw("marked.raw", "f32", DIMS, marked) + ["--nodata", "-7"]
        self.expected = self.triangles(self.marked, "0.1")
        self.assertGreater(len(self.expected), 50)

    def nrrd(self, name, dims=DIMS, kind="uchar", code="B", labels=None, more=b""):
        labels = self.labels if labels is None else labels
        with open(self.path(name), "wb") as out:
            out.write(b"NRRD0004\ntype: %s\ndimension: %d\nsizes: %s\nencoding: raw\nendian: little\n%s\n"
                      % (kind.encode(), len(dims), " ".join(map(str, dims)).encode(), more))
            out.write(struct.pack(f"<{len(labels)}{code}", *labels))
        return self.path(name)

    def test_as_marked(self):
        """A mask is what marking its samples as missing is, of any type and in any format."""
        masks = [self.path("m.raw"), self.nrrd("m.nrrd"), self.nrrd("s.nrrd", kind="short", code="h"),
                 self.nrrd("f.nrrd", kind="float", code="f",
                           labels=[n * 0.1 if n else float("nan") for n in self.labels])]
        os.rename(self.path("m.raw"), self.path("labels"))
        masks[0] = self.path("labels")
        if "VTK XML" in self.expect(0, "--version").stdout:
            masks.append(self.write("m.vti", vti_text(DIMS, [("labels", "u8", self.labels)], first=(5, 0, 0))))
        for mask in masks:
            self.assertEqual(self.triangles(self.volume, "0.1", "--mask", mask), self.expected)
            self.assertEqual(self.triangles(self.volume, "0.1", "--mask", mask, "--roi", "1:8,:,3:", "--step", "1,2,1"),
                             self.triangles(self.marked, "0.1", "--roi", "1:8,:,3:", "--step", "1,2,1"))
        self.expect_fit(self.volume, "0.1", DIMS, "--mask", masks[0])
        told = self.notices(self.volume, "0.1", "--mask", masks[0])
        self.assertIn(f"--mask: {self.labels.count(0)} of {len(self.labels)} samples are missing", told)
        report = self.report("info", *self.volume, "--mask", masks[0])
        self.assertEqual(report["missing"], self.labels.count(0))
        kept = [value for value, label in zip(self.values, self.labels) if label]
        self.assertEqual(report["range"], list(struct.unpack("<2f", struct.pack("<2f", min(kept), max(kept)))))

    def test_with_other_missing_samples(self):
        holes = [-7.0 if n % 50 == 1 else value for n, value in enumerate(self.values)]
        both = [value if label else -7.0 for value, label in zip(holes, self.labels)]
        volume = self.raw("h.raw", "f32", DIMS, holes) + ["--nodata", "-7"]
        marked = self.raw("both.raw", "f32", DIMS, both) + ["--nodata", "-7"]
        self.assertEqual(self.triangles(volume, "0.1", "--mask", self.path("m.raw")), self.triangles(marked, "0.1"))

    def test_other_grids(self):
        self.needs_xml()
        bent = [(x + 0.2 * y, y - 0.1 * z, 1.5 * z) for x, y, z in POINTS]
        ghosts = [2 * (n == 0) for n in self.labels]
        grid = self.write("a.vts", vts_text(DIMS, bent, [("f", "f32", self.values)]))
        blanked = self.write("b.vts", vts_text(DIMS, bent, [("f", "f32", self.values), ("vtkGhostType", "u8", ghosts)]))
        for mask in (self.path("m.raw"), self.nrrd("m.nrrd")):
            self.assertEqual(self.triangles([grid], "0.1", "--mask", mask), self.triangles([blanked], "0.1"))
        more = self.nrrd("more.nrrd", labels=[n % 31 for n in range(len(self.labels))])
        both = [2 * (n == 0 or at % 31 == 0) for at, n in enumerate(self.labels)]
        grid = self.write("c.vts", vts_text(DIMS, bent, [("f", "f32", self.values), ("vtkGhostType", "u8", both)]))
        self.assertEqual(self.triangles([blanked], "0.1", "--mask", more), self.triangles([grid], "0.1"))

    def test_everything_and_nothing(self):
        ones = self.nrrd("1.nrrd", labels=[1] * len(self.labels))
        self.assertEqual(self.triangles(self.volume, "0.1", "--mask", ones), self.triangles(self.volume, "0.1"))
        self.assertIn("nothing is left out", " ".join(self.notices(self.volume, "0.1", "--mask", ones)))
        zeros = self.nrrd("0.nrrd", labels=[0] * len(self.labels))
        [surface] = self.extract(self.volume, "0.1", "--mask", zeros)["surfaces"]
        self.assertEqual(surface["triangles"], 0)

    def test_refusals(self):
        words = ["extract", *self.volume, "--iso", "0.1", "--engine", "reference", "--mask"]
        self.refuses(2, *words, self.nrrd("a.nrrd", (11, 9, 9), labels=self.labels[:11 * 9 * 9]),
                     says="--mask .*a.nrrd: has 11 x 9 x 9 samples, and the input 11 x 9 x 10")
        self.refuses(2, *words, self.path("a.nrrd"), "--roi", "0:5,0:5,0:5", says="has 11 x 9 x 9 samples")
        self.refuses(2, *words, self.nrrd("v.nrrd", (3, *DIMS), labels=3 * self.labels,
                                        more=b"kinds: vector domain domain domain\n"), says="3 values per sample")
        self.refuses(4, *words, self.path("none.nrrd"), says="none.nrrd")
        with open(self.path("short.raw"), "wb") as out:
            out.write(bytes(self.labels[:-1]))
        self.refuses(4, *words, self.path("short.raw"),
                     says="its format is not known, and it is no raw volume of 11 x 9 x 10 samples of one byte")
        self.refuses(2, *words, self.path("m.raw"), "-o", self.path("m.raw"), "--format", "ply", says="is the mask")
        if "VTK XML" not in self.expect(0, "--version").stdout:
            return
        two = self.write("two.vti", vti_text(DIMS, [("a", "u8", self.labels), ("b", "u8", self.labels)]))
        self.refuses(2, *words, two, says="two.vti: holds 2 fields")
        cells = self.write("c.vti", vti_text([n + 1 for n in DIMS], (), [("c", "u8", self.labels)]))
        self.refuses(2, *words, cells, says="has 12 x 10 x 11 samples")
        self.refuses(2, *words, self.write_hexahedra("m.vtu"), says="m.vtu")


class Blocks(PartCase):
    def test_several_blocks(self):
        """Ranges go for every block; blocks that have nothing there are left out."""
        small, points = (5, 4, 6), lattice((5, 4, 6))
        far = [(x + 20, y, z) for x, y, z in POINTS]
        inputs = self.write_plot3d("a", [(small, points, [bump(p) for p in points]),
                                         (DIMS, far, [bump(p) for p in POINTS])])
        density = ["--field", "density"]
        report = self.report("info", *inputs, *density, "--roi", "2:10,1:,:")
        self.assertEqual([block["dims"] for block in report["blocks"]], [[3, 3, 6], [8, 8, 10]])
        report = self.report("info", *inputs, *density, "--roi", "4:10,1:,:")
        self.assertEqual([block["dims"] for block in report["blocks"]], [[6, 8, 10]])
        report = self.report("info", *inputs, *density, "--roi-world", "15:23,:,:", "--step", "1,2,1")
        self.assertEqual([block["dims"] for block in report["blocks"]], [[5, 5, 10]])
        self.refuses(2, "info", *inputs, *density, "--roi", "2:12,:,:", says="2 blocks, with indices from 0, 0, 0 to")
        self.refuses(2, "info", *inputs, *density, "--roi-world", "90:91,:,:", says="none of its blocks")
        self.expect(0, "extract", *inputs, *density, "--iso", "2", "--engine", "reference", "--roi", "4:10,:,:",
                    "--blocks", "separate", "-o", self.path("b.ply"))
        self.assertIn("may not meet", " ".join(self.notices([*inputs, *density], "2", "--step", "2")))
        self.refuses(2, "info", *inputs, *density, "--mask", inputs[0], says="a mask has one")

    def test_pieces(self):
        """Pieces of one extent, as VTK writes them in parallel: indices are those of the extent."""
        self.needs_xml()
        values = [bump(p) for p in POINTS]
        pieces = ""
        for begin, end in ((0, 5), (5, 10)):
            kept, _ = part_of(values, DIMS, ((begin, end + 1), (0, 9), (0, 10)))
            pieces += (f'<Piece Extent="{begin} {end} 0 8 0 9"><PointData>{data_array("f", "f64", kept)}</PointData>'
                       "</Piece>")
        text = vti_text(DIMS, [("f", "f64", values)])
        whole = self.write("whole.vti", text)
        begin, end = text.index("<Piece"), text.index("</Piece>") + len("</Piece>")
        pieces = self.write("pieces.vti", text[:begin] + pieces + text[end:])
        for region in ("2:9,:,1:8", "5:9,:,:", "0:6,:,:", "4:6,:,:"):
            more = ["--roi", region]
            self.assertEqual(self.triangles([pieces], "2", *more), self.triangles([whole], "2", *more))
        more = ["--roi", "1:,:,:", "--step", "4,1,1"]
        self.assertEqual(self.triangles([pieces], "2", *more), self.triangles([whole], "2", *more))
        blocks = self.report("info", pieces, "--step", "3,1,1")["blocks"]
        self.assertEqual([[corner[0] for corner in block["bounds"]] for block in blocks], [[0, 3], [6, 9]])


class Usage(PartCase):
    def test_ranges(self):
        volume = self.raw("a.raw", "u8", DIMS, [n % 200 for n in range(len(POINTS))])
        for command in (["extract", "--iso", "50", "--engine", "reference", "-o", self.path("a.ply")], ["info"]):
            for options, says in (
                    (["--roi", "5:3,:,:"], "--roi 5:3 along x holds nothing.*the grid has 11 x 9 x 10 samples"),
                    (["--roi", ":,4:4,:"], "--roi 4:4 along y holds nothing.*11 x 9 x 10"),
                    (["--roi", ":,:,2:11"], "--roi 2:11 along z reaches outside 0:10: the grid has 11 x 9 x 10"),
                    (["--roi", "-1:4,:,:"], "--roi -1:4 along x reaches outside 0:11"),
                    (["--roi", ":,9:,:"], "along y reaches outside 0:9"),
                    (["--roi", ":,3:4,:"], "--roi leaves 1 sample along y.*two or more.*11 x 9 x 10"),
                    (["--step", "11,1,1"], "--step leaves 1 sample along x.*11 x 9 x 10"),
                    (["--step", "3", "--roi", ":,2:5,:"], "--roi and --step leave 1 sample along y"),
                    (["--roi", "1:2"], "not three ranges"), (["--roi", "1:2,3:4,5:6,7:8"], "not three ranges"),
                    (["--roi", "1-2,:,:"], "not three ranges"), (["--roi", "1.5:3,:,:"], "not three ranges"),
                    (["--roi", "1:99999999999999999999,:,:"], "not three ranges"),
                    (["--roi-world", "3:2,:,:"], "from a lower number to a higher"),
                    (["--roi-world", "a:,:,:"], "not three ranges"), (["--roi-world", "1:nan,:,:"], "not three ranges"),
                    (["--step", "0"], "whole number above 0"), (["--step", "2,3"], "whole number above 0"),
                    (["--step", "1,2,3,4"], "whole number above 0"), (["--step", "-2"], "whole number above 0"),
                    (["--roi", ":,:,:", "--roi-world", ":,:,:"], "leave one out"),
                    (["--mask", ""], "empty")):
                self.refuses(2, *command, *volume, *options, says=says)
        self.assertEqual(self.report("info", *volume, "--roi", " 0:5 , : , 1:9 ")["roi"], [[0, 5], [0, 9], [1, 9]])
        self.assertIn("--step 1 takes every sample", " ".join(self.notices(volume, "50", "--step", "1,1,1")))

    def test_extents(self):
        self.needs_xml()
        volume = self.write("a.vti", vti_text(DIMS, [("f", "f32", noise(30))], first=(5, -2, 0)))
        self.assertEqual(self.report("info", volume, "--roi", "6:9,-1:,:")["roi"], [[6, 9], [-1, 7], [0, 10]])
        self.refuses(2, "info", volume, "--roi", "0:9,:,:", says="outside 5:16: .*from 5, -2, 0 to 15, 6, 9")

    def test_unstructured(self):
        self.needs_xml()
        grid = self.write_hexahedra("a.vtu")
        for option, value in (("--roi", "0:2,:,:"), ("--roi-world", "0:2,:,:"), ("--step", "2"), ("--mask", grid)):
            for command in (["extract", "--iso", "1", "--field", "bump", "--engine", "reference"], ["info"]):
                self.refuses(2, *command, grid, option, value, says=f"is unstructured: {option} is for structured")
            self.refuses(2, "tetrahedralize", grid, "-o", self.path("b.vtu"), option, value, says="no option")


class Reading(PartCase):
    """Of a file of 4 GiB that has holes, the region that is there is extracted within 300 MB."""
    SIZES = (2048, 1024, 512)
    BYTES = 4

    def sparse(self, name, head, order="<", kind="f", tail=b""):
        """Samples of a bump around the middle of a region; all else is a hole."""
        dims = (20, 18, 16)
        with open(self.path(name), "wb") as out:
            out.write(head)
            out.truncate(len(head) + self.BYTES * self.SIZES[0] * self.SIZES[1] * self.SIZES[2])
            for z in range(dims[2]):
                for y in range(dims[1]):
                    row = [10 - (x - 10) ** 2 - (y - 9) ** 2 - (z - 8) ** 2 for x in range(dims[0])]
                    out.seek(len(head) + self.BYTES * (100 + self.SIZES[0] * (200 + y + self.SIZES[1] * (400 + z))))
                    out.write(struct.pack(f"{order}{dims[0]}{kind}", *row))
            out.seek(0, 2)
            out.write(tail)
        return self.path(name)

    def expect_read(self, *arguments, iso="0.5"):
        for region in (["--roi", "100:120,200:218,400:416"], ["--roi", "100:120,200:218,400:416", "--step", "2"]):
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
            [surface] = self.extract(arguments, iso, "--check", *region)["surfaces"]
            most = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
            self.assertGreater(surface["triangles"], 30)
            self.assertEqual((surface["boundary_edges"], surface["components"]), (0, 1))
            self.assertLess(most, 300 << 10, f"{before} before")

    def test_raw(self):
        dims = ",".join(map(str, self.SIZES))
        path = self.sparse("a.raw", b"")
        self.expect_read(path, "--dims", dims, "--type", "f32")
        os.remove(path)
        path = self.sparse("b.raw", b"skip!", ">", "i")
        self.expect_read(path, "--dims", dims, "--type", "i32", "--endian", "big", "--skip", "5")

    def test_nrrd_and_metaimage(self):
        sizes = " ".join(map(str, self.SIZES))
        path = self.sparse("a.nrrd", (f"NRRD0004\ntype: float\ndimension: 3\nsizes: {sizes}\nencoding: raw\n"
                                      "endian: big\n# x\n\n").encode(), ">")
        self.expect_read(path)
        os.remove(path)
        self.expect_read(self.sparse("a.mha", (f"ObjectType = Image\nNDims = 3\nDimSize = {sizes}\n"
                                               "ElementType = MET_FLOAT\nElementDataFile = LOCAL\n").encode()))

    def test_nifti(self):
        if "NIfTI" not in self.expect(0, "--version").stdout:
            self.skipTest("no NIfTI")
        head = bytearray(352)
        struct.pack_into("<i", head, 0, 348)
        struct.pack_into("<8h", head, 40, 3, *self.SIZES, 1, 1, 1, 1)
        struct.pack_into("<hh", head, 70, 8, 32)
        struct.pack_into("<8f", head, 76, 1, 1, 1, 1, 1, 1, 1, 1)
        struct.pack_into("<fff", head, 108, 352, 0.5, 1)
        head[344:348] = b"n+1\0"
        self.expect_read(self.sparse("a.nii", bytes(head), kind="i"), iso="1.25")

    def test_vti(self):
        self.needs_xml()
        extent = " ".join(f"0 {n - 1}" for n in self.SIZES)
        count = self.BYTES * self.SIZES[0] * self.SIZES[1] * self.SIZES[2]
        for order, name in (("<", "LittleEndian"), (">", "BigEndian")):
            for blanks in range(2):  # aligned or not
                head = (f'<VTKFile type="ImageData" version="1.0" byte_order="{name}" header_type="UInt64">\n'
                        f'<ImageData WholeExtent="{extent}" Origin="0 0 0" Spacing="1 1 1">\n'
                        f'<Piece Extent="{extent}"><PointData>'
                        '<DataArray type="Float32" Name="f" format="appended" offset="0"/></PointData></Piece>\n'
                        f'</ImageData>{" " * blanks}<AppendedData encoding="raw">_').encode()
                head += struct.pack(f"{order}Q", count)
                path = self.sparse("a.vti", head, order, tail=b"</AppendedData></VTKFile>")
                self.expect_read(path)
                os.remove(path)

    def test_cut_files_are_refused(self):
        dims = ",".join(map(str, self.SIZES))
        path = self.sparse("a.raw", b"")
        os.truncate(path, os.path.getsize(path) - 1)
        self.refuses(4, "info", path, "--dims", dims, "--type", "f32", "--roi", "0:9,0:9,0:9", says="bytes long")


if __name__ == "__main__":
    tool_case.main()
