#!/usr/bin/env python3
"""test_cli_labels.py TOOL [reference] - labels: the surfaces of a segmentation, in one file or in one of each label

Files are read back by code of the tests' own: each label's triangles close it, and enclose the volume of its voxels.
"""
import collections
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from meshes import READERS, glb_parts, read_labels
from grid_files import data_array, structured_text, vti_text, vts_text
from tool_case import GridCase

DIMS = (14, 13, 12)
KEYS = {"input", "output", "device", "engine", "dims", "roi", "step", "smoothing", "closed", "vertices", "triangles",
        "active_cells", "degenerate_triangles", "bounds", "hash", "labels", "timings_ms", "notices"}
ROW_KEYS = {"label", "triangles"}
CHECK_KEYS = ROW_KEYS | {"boundary_edges", "nonmanifold_edges", "nonmanifold_vertices", "misoriented_edges",
                         "euler_characteristic", "components", "area", "volume"}


def blocks(dims=DIMS):
    """Three blocks that touch, of labels 3, 7 and 300, and background around them."""
    def label(x, y, z):
        if not (2 <= x < 12 and 2 <= y < 11 and 2 <= z < 10):
            return 0
        return 3 if x < 7 else 7 if y < 6 else 300
    return [label(x, y, z) for z in range(dims[2]) for y in range(dims[1]) for x in range(dims[0])]


VOXELS = {3: 5 * 9 * 8, 7: 5 * 4 * 8, 300: 5 * 5 * 8}


def volume(points, triangles):
    total = 0
    for a, b, c in triangles:
        (x0, y0, z0), (x1, y1, z1), (x2, y2, z2) = points[a], points[b], points[c]
        total += x0 * (y1 * z2 - z1 * y2) + y0 * (z1 * x2 - x1 * z2) + z0 * (x1 * y2 - y1 * x2)
    return total / 6


def open_edges(triangles):
    """Edges that are not passed as often in one direction as in the other."""
    sides = collections.Counter()
    for t in triangles:
        for n in range(3):
            a, b = t[n], t[(n + 1) % 3]
            sides[min(a, b), max(a, b)] += 1 if a < b else -1
    return sum(count != 0 for count in sides.values())


class LabelCase(GridCase):
    def labels(self, arguments, *more, status=0, **how):
        return self.report("labels", *arguments, "--engine", "reference", *more, status=status, **how)

    def raw_blocks(self):
        return self.raw("labels.raw", "u16", DIMS, blocks())

    def expect_volumes(self, points, triangles, labels, slack=0.06):
        """Half the voxels' edges and corners are cut off."""
        for label, voxels in VOXELS.items():
            own = [t if pair[0] == label else t[::-1] for t, pair in zip(triangles, labels) if label in pair]
            self.assertEqual(open_edges(own), 0)
            self.assertGreater(volume(points, own), (1 - slack) * voxels)
            self.assertLess(volume(points, own), voxels)


class Reports(LabelCase):
    def test_keys(self):
        report = self.labels(self.raw_blocks())
        self.assertEqual(set(report), KEYS)
        self.assertEqual([set(row) for row in report["labels"]], [ROW_KEYS] * 3)
        self.assertEqual([row["label"] for row in report["labels"]], [3, 7, 300])
        self.assertEqual((report["smoothing"], report["closed"], report["dims"]), (8, False, list(DIMS)))

    def test_check(self):
        report = self.labels(self.raw_blocks(), "--check", "--smooth", "0")
        for row in report["labels"]:
            self.assertEqual(set(row), CHECK_KEYS)
            self.assertEqual((row["euler_characteristic"], row["components"], row["boundary_edges"]), (2, 1, 0))
            self.assertAlmostEqual(row["volume"] / VOXELS[row["label"]], 0.97, delta=0.03)

    def test_text(self):
        text = self.expect(0, "labels", *self.raw_blocks(), "--engine", "reference", "--check").stdout
        self.assertRegex(text, r"surfaces of 3 labels\n")
        self.assertRegex(text, r"label 300 +\d+ triangles, manifold, closed, Euler characteristic 2, 1 component,")

    def test_smoothing(self):
        areas = []
        for sweeps in ("0", "4", "16"):
            report = self.labels(self.raw_blocks(), "--check", "--smooth", sweeps)
            areas.append(sum(row["area"] for row in report["labels"]))
        self.assertGreater(areas[0], 1.05 * areas[1])
        self.assertGreater(areas[1], areas[2])

    def test_closed(self):
        whole = self.raw("whole.raw", "u8", (4, 5, 6), [9] * 120)
        self.assertEqual(self.labels(whole)["labels"], [])
        self.expect(0, "labels", *whole, "--engine", "reference", says="all samples have one label, or none; --closed")
        row = self.labels(whole, "--closed", "--check", "--smooth", "0")["labels"][0]
        self.assertEqual((row["label"], row["euler_characteristic"], row["boundary_edges"]), (9, 2, 0))
        self.assertAlmostEqual(row["volume"] / 120, 0.97, delta=0.03)

    def test_engines(self):
        self.needs_device()
        for more in ([], ["--closed"], ["--labels", "3,7", "--smooth", "0"]):
            report = self.report("labels", *self.raw_blocks(), "--verify", *more)
            self.assertEqual((report["verified"], report["engine"]), (True, "opencl"))
            self.assertEqual(report["hash"], self.labels(self.raw_blocks(), *more)["hash"])


class Choices(LabelCase):
    def test_wanted(self):
        report = self.labels(self.raw_blocks(), "--labels", "300, 7,5", "--check", "--smooth", "0")
        self.assertEqual([row["label"] for row in report["labels"]], [7, 300])
        self.assertRegex("".join(report["notices"]), "label 5 has no surface")
        everything = self.labels(self.raw_blocks(), "--check", "--smooth", "0")["labels"]
        for row, among_all in zip(report["labels"], everything[1:]):
            self.assertAlmostEqual(row["volume"] / among_all["volume"], 1, delta=0.01)

    def test_missing(self):
        hidden = [0 if v == 7 else v for v in blocks()]
        bare = self.labels(self.raw("bare.raw", "u16", DIMS, hidden))["hash"]
        self.assertEqual(self.labels(self.raw_blocks(), "--nodata", "7")["hash"], bare)
        mask = self.raw("mask.raw", "u8", DIMS, [v != 7 for v in blocks()])[0]
        self.assertEqual(self.labels(self.raw_blocks(), "--mask", mask)["hash"], bare)

    def test_types(self):
        expected = self.labels(self.raw_blocks())["hash"]
        for kind in ("i16", "u32", "i32", "f32", "f64"):
            self.assertEqual(self.labels(self.raw(f"{kind}.raw", kind, DIMS, blocks()))["hash"], expected, kind)
        halves = self.raw("half.raw", "f32", DIMS, [v / 2 for v in blocks()])
        self.refuses(4, "labels", *halves, says=r"1\.5 is no label")

    def test_cells(self):
        """Labels of cells belong to their centres; they are not averaged."""
        self.needs_xml()
        whole = self.labels(self.raw_blocks(), "--origin", "0.5,0.5,0.5", "--smooth", "0")
        points = [n + 1 for n in DIMS]
        cells = [("organ", "i16", blocks())]
        at = [(x, y, z) for z in range(points[2]) for y in range(points[1]) for x in range(points[0])]
        axes = "".join(data_array(name, "f32", range(count)) for name, count in zip("xyz", points))
        other = [("f", "f32", [0] * len(at))]
        for name, text in (("cells.vti", vti_text(points, [], cells)), ("cells.vts", vts_text(points, at, [], cells)),
                           ("cells.vtr", structured_text("RectilinearGrid", points, (0, 0, 0),
                                                         f"<Coordinates>{axes}</Coordinates>", [], cells))):
            path = self.write(name, text)
            how = ["--smooth", "0"] if name == "cells.vti" else []
            report = self.labels([path], *how, says="labels belong to cells")
            for key in ("dims", "triangles", "vertices", "bounds", "labels", *(["hash"] if how else [])):
                self.assertEqual(report[key], whole[key], f"{name}: {key}")
        both = self.write("both.vti", vti_text(points, other, cells))
        self.assertEqual(self.labels([both, "--field", "organ", "--smooth", "0"])["hash"], whole["hash"])
        self.refuses(2, "labels", path, "--roi", "0:5,:,:", says="belong to cells, of which no part is read")
        ghosts = ("vtkGhostType", "u8", [32 * (v == 7) for v in blocks()])
        hidden = self.write("hidden.vti", vti_text(points, [], [*cells, ghosts]))
        bare = [0 if v == 7 else v for v in blocks()]
        without = self.write("bare.vti", vti_text(points, [], [("organ", "i16", bare)]))
        self.assertEqual(self.labels([hidden, "--field", "organ"])["hash"], self.labels([without])["hash"])
        flat = self.write("flat.vti", vti_text((4, 4, 1), [], [("organ", "i16", [1] * 9)]))
        self.refuses(4, "labels", flat, says="cells are flat")

    def test_part(self):
        report = self.labels(self.raw_blocks(), "--roi", "0:7,:,:", "--closed")
        self.assertEqual([row["label"] for row in report["labels"]], [3])
        self.assertEqual(report["roi"], [[0, 7], [0, 13], [0, 12]])


class Files(LabelCase):
    def test_together(self):
        for ending in ("ply", "vtp", "npz"):
            path = self.path(f"all.{ending}")
            report = self.labels(self.raw_blocks(), "--smooth", "0", "-o", path)
            points, triangles, _ = READERS[ending](path)
            self.assertEqual((len(points), len(triangles)), (report["vertices"], report["triangles"]))
            labels = read_labels(path)
            for inner, outer in labels:
                self.assertTrue(inner and (not outer or inner < outer), (inner, outer))
            self.expect_volumes(points, triangles, labels)

    def test_shown(self):
        """The triangles of a page and of GLB are those of PLY, pair by pair of labels; no pair comes twice. GLB has a
        material for each label, that of the inner side."""
        triangles = {}
        for ending in ("html", "glb", "ply"):
            self.labels(self.raw_blocks(), "-o", self.path(f"all.{ending}"))
            triangles[ending] = READERS[ending](self.path(f"all.{ending}"))[1]
        ordered = sorted(zip(read_labels(self.path("all.ply")), triangles["ply"]), key=lambda triangle: triangle[0])
        self.assertEqual(list(zip(read_labels(self.path("all.html")), triangles["html"])), ordered)
        self.assertEqual(triangles["glb"], [triangle for _, triangle in ordered])
        self.assertGreater(len({labels for labels, _ in ordered}), 4)
        description = glb_parts(self.path("all.glb"))[0]
        inner = collections.Counter(labels[0] for labels, _ in ordered)
        materials = [description["materials"][p["material"]] for p in description["meshes"][0]["primitives"]]
        self.assertEqual([material["name"] for material in materials], [f"label {label}" for label in sorted(inner)])
        self.assertEqual(len({str(material["pbrMetallicRoughness"]) for material in materials}), len(inner))
        counts = [description["accessors"][p["indices"]]["count"] for p in description["meshes"][0]["primitives"]]
        self.assertEqual(counts, [3 * inner[label] for label in sorted(inner)])

    def test_separate(self):
        report = self.labels(self.raw_blocks(), "--smooth", "0", "--separate", "-o", self.path("part-%.stl"))
        self.assertEqual([os.path.basename(row["output"]) for row in report["labels"]],
                         ["part-3.stl", "part-7.stl", "part-300.stl"])
        for row in report["labels"]:
            points, triangles, _ = READERS["stl"](row["output"])
            self.assertEqual(len(triangles), row["triangles"])
            self.assertAlmostEqual(volume(points, triangles) / VOXELS[row["label"]], 0.97, delta=0.03)
        self.labels(self.raw_blocks(), "--separate", "--labels", "7", "-o", self.path("organ.ply"))
        self.assertIn("organ_7.ply", self.files())

    def test_names(self):
        """% as in extract; one file of all labels has no label that it could stand for."""
        os.mkdir(self.path("7"))
        self.labels(self.raw_blocks(), "--separate", "--labels", "7", "-o", self.path("%/%%-%.ply"))
        self.assertEqual(os.listdir(self.path("7")), ["%-7.ply"])
        self.refuses(2, "labels", *self.raw_blocks(), "-o", self.path("organ-%.ply"), says="--separate .* typed %%")
        report = self.labels(self.raw_blocks(), "-o", self.path("100%%.ply"))
        self.assertEqual(report["output"], self.path("100%.ply"))
        self.assertIn("100%.ply", self.files())
        self.labels(self.raw_blocks(), "--separate", "--labels", "7", "-o", self.path("100%%.ply"))
        self.assertIn("100%_7.ply", self.files())

    def test_regions(self):
        """Smoothed surfaces of regions do not fit, which a notice says; whole volumes have no regions."""
        for more, is_told in ((["--roi", "0:7,:,:"], True), (["--roi-world", "0:7,:,:", "--smooth", "3"], True),
                              (["--roi", "0:7,:,:", "--smooth", "0"], False), (["--roi", ":,:,:"], False),
                              (["--step", "2"], False), ([], False)):
            told = "".join(self.labels(self.raw_blocks(), *more)["notices"])
            self.assertEqual("fit by --smooth 0 alone" in told, is_told, more)

    def test_times(self):
        """Kernels take part of the device's start, and of nothing else."""
        for engine in self.engines():
            times = self.report("labels", *self.raw_blocks(), "--engine", engine)["timings_ms"]
            self.assertEqual(set(times), {"read", "device_start", "build", "upload", "classify", "emit", "readback",
                                          "extract", "write", "total"})
            self.assertLessEqual(times["build"], times["device_start"])
            self.assertLessEqual(times["device_start"] + times["extract"], times["total"])
            self.assertEqual(times["build"] > 0, engine == "opencl")

    def test_one_label(self):
        text = self.expect(0, "labels", *self.raw_blocks(), "--labels", "7", "--check", "--engine", "reference").stdout
        self.assertRegex(text, r"(?m)^surface of 1 label$")
        self.assertRegex(text, r"\b1 component,")

    def test_formats(self):
        told = self.labels(self.raw_blocks(), "-o", self.path("all.stl"))["notices"]
        self.assertRegex("".join(told), "does not say which labels")
        self.refuses(2, "labels", *self.raw_blocks(), "-o", self.path("all.xyz"), says="known format")

    def test_streams(self):
        result = tool_case.subprocess.run([tool_case.TOOL, "labels", *self.raw_blocks(), "--engine", "reference", "-o", "-",
                                           "--format", "ply"], capture_output=True, check=True)
        self.labels(self.raw_blocks(), "-o", self.path("file.ply"))
        with open(self.path("file.ply"), "rb") as f:
            self.assertEqual(result.stdout, f.read())


class Refusals(LabelCase):
    def test_usage(self):
        raw = self.raw_blocks()
        for more, says in ((["--labels", "0"], "above 0"), (["--labels", "1,,2"], "above 0"), (["--labels", ""], "above 0"),
                           (["--labels", "4294967296"], "above 0"), (["--smooth", "1001"], "at most 1000"),
                           (["--separate"], "give -o FILE"), (["--separate", "-o", "-", "--format", "ply"], "stream"),
                           (["--iso", "3"], "no option --iso"), (["-o", raw[0] + ".ply", "--smooth", "-1"], "whole number")):
            self.refuses(2, "labels", *raw, *more, says=says)
        self.refuses(2, "labels", says="needs an input")

    def test_inputs_stay(self):
        path = self.raw_blocks()[0]
        os.rename(path, self.path("labels_7.ply"))
        raw = [self.path("labels_7.ply"), "--dims", "14,13,12", "--type", "u16"]
        self.refuses(2, "labels", *raw, "--engine", "reference", "--separate", "-o", self.path("labels.ply"), says="labels_7")
        self.assertEqual(self.files(), ["labels_7.ply"])

    def test_other_grids(self):
        self.needs_xml()
        self.write_hexahedra("cells.vtu")
        self.refuses(4, "labels", self.path("cells.vtu"), says="unstructured")


if __name__ == "__main__":
    tool_case.main()
