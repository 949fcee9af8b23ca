#!/usr/bin/env python3
"""test_cli_isovolume.py TOOL [reference] - interval volumes by the command line: files, reports, refusals

The file is parsed here, and its volume, fields and faces are computed from what it holds.
"""
import array
import collections
import itertools
import json
import os
import re
import struct
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from grid_files import hexahedra, HEXAHEDRON, lattice, vtu_text
from tool_case import GridCase

VOLUME_KEYS = {"range", "vertices", "samples_within", "low_vertices", "high_vertices", "tetrahedra", "bytes",
               "timings_ms"}
MADE_KEYS = VOLUME_KEYS | {"volume", "fields"}
CHECK_KEYS = {"flat_tetrahedra", "inverted_tetrahedra", "smallest_dihedral_angle", "smallest_dihedral_angle_median",
              "dihedral_angles_below_5", "dihedral_angles_below_10", "nonmanifold_faces", "folded_faces"}
CODES = {"Float32": "f", "Float64": "d", "Int32": "i", "Int64": "q", "UInt8": "B"}


def read_vtu(path):
    """The arrays of the file by their names."""
    with open(path, "rb") as file:
        data = file.read()
    head, _, rest = data.partition(b'<AppendedData encoding="raw">')
    start = len(data) - len(rest) + rest.index(b"_") + 1
    arrays, end = {}, 0
    for tag in re.findall(r"<DataArray [^>]*>", head.decode()):
        name, kind, offset = (re.search(rf'{key}="([^"]*)"', tag)[1] for key in ("Name", "type", "offset"))
        at = start + int(offset)
        size = struct.unpack_from("<Q", data, at)[0]
        assert int(offset) == end, f"{name} does not follow the array before it, as readers like meshio's expect"
        end += 8 + size
        arrays[name] = array.array(CODES[kind])
        arrays[name].frombytes(data[at + 8:at + 8 + size])
    return arrays


def volume_of(points, corners):
    u, v, w = ([points[3 * corners[n] + axis] - points[3 * corners[0] + axis] for axis in range(3)] for n in (1, 2, 3))
    return ((u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1]
            + (u[0] * v[1] - u[1] * v[0]) * w[2]) / 6


def measure(file, field=None):
    """Volume, integral of the field, and how often faces occur."""
    points, connectivity = file["Points"], file["connectivity"]
    volume = integral = 0
    faces = collections.Counter()
    for first in range(0, len(connectivity), 4):
        corners = connectivity[first:first + 4]
        one = volume_of(points, corners)
        volume += one
        if field:
            integral += one * sum(file[field][c] for c in corners) / 4
        faces.update(tuple(sorted(face)) for face in itertools.combinations(corners, 3))
    return volume, integral, collections.Counter(faces.values())


class Isovolume(GridCase):
    def setUp(self):
        super().setUp()
        self.engine = [] if tool_case.HAS_DEVICE else ["--engine", "reference"]
        self.volume = self.path("s.nrrd")
        self.expect(0, "generate", "sphere", "--dims", "12,11,10", "--type", "f32", "-o", self.volume)

    def report(self, *arguments, status=0):
        return json.loads(self.expect(status, "isovolume", *arguments, *self.engine, "--json").stdout)

    def test_file_and_report(self):
        out = self.path("v.vtu")
        how = ["--verify"] if tool_case.HAS_DEVICE else []
        report = self.report(self.volume, "--range", "60,130", "-o", out, "--check", *how)
        found = report["volumes"][0]
        self.assertEqual(set(report["timings_ms"]), {"read", "device_start", "build", "upload", "write", "total"})
        keys = MADE_KEYS | CHECK_KEYS | {"output"} | ({"verified"} if how else set())
        self.assertEqual(set(found), keys)
        self.assertEqual(found["range"], [60, 130])
        self.assertTrue(found.get("verified", True))
        file = read_vtu(out)
        volume, _, counts = measure(file)
        self.assertAlmostEqual(found["volume"], volume, places=6)
        self.assertEqual(set(counts), {1, 2})
        self.assertEqual((len(file["Points"]) // 3, len(file["connectivity"]) // 4),
                         (found["vertices"], found["tetrahedra"]))
        self.assertEqual(found["vertices"], found["samples_within"] + found["low_vertices"] + found["high_vertices"])
        self.assertEqual(found["bytes"], 12 * found["vertices"] + 16 * found["tetrahedra"])
        self.assertEqual((found["nonmanifold_faces"], found["folded_faces"], found["inverted_tetrahedra"]), (0, 0, 0))
        low = json.loads(self.expect(0, "extract", self.volume, "--iso", "60,130", *self.engine, "--json").stdout)
        self.assertEqual([s["vertices"] for s in low["surfaces"]], [found["low_vertices"], found["high_vertices"]])
        text = self.expect(0, "isovolume", self.volume, "--range", "60,130", *self.engine).stdout
        self.assertRegex(text, rf"range 60,130\n  tetrahedra  {found['tetrahedra']}, ")

    def test_ranges_are_a_histogram(self):
        out = self.path("v_%.vtu")
        report = self.report(self.volume, "--range", ",60", "--range", "60,130", "--range", "130,", "-o", out)
        self.assertAlmostEqual(sum(v["volume"] for v in report["volumes"]), 8, places=5)
        self.assertEqual([v["range"] for v in report["volumes"]], [[None, 60], [60, 130], [130, None]])
        self.assertEqual([f for f in self.files() if f.endswith(".vtu")],
                         ["v_,60.vtu", "v_130,.vtu", "v_60,130.vtu"])
        named = self.report(self.volume, "--range", "60,130", "-o", self.path("%-100%%-%"), "--format", "vtu")
        self.assertEqual(named["volumes"][0]["output"], self.path("60,130-100%-60,130"))
        self.assertIn("60,130-100%-60,130", self.files())
        with open(self.path("60,130-100%-60,130"), "rb") as named, open(self.path("v_60,130.vtu"), "rb") as file:
            wanted = file.read()
            self.assertEqual(named.read(), wanted)
        piped = tool_case.subprocess.run([tool_case.TOOL, "isovolume", self.volume, "--range", "60,130", *self.engine, "-o", "-",
                                          "--format", "vtu"], capture_output=True, check=True)
        self.assertEqual(piped.stdout, wanted)
        counted = self.report(self.volume, "--range", "60,130", "--count")["volumes"][0]
        self.assertEqual(set(counted), VOLUME_KEYS)
        self.assertEqual(counted["tetrahedra"], report["volumes"][1]["tetrahedra"])

    def test_fields(self):
        points = lattice((4, 4, 4))
        cells = hexahedra((4, 4, 4))
        fields = [("x", "f32", [float(p[0]) for p in points]), ("y", "f64", [2.0 * p[1] for p in points])]
        grid = self.write("h.vtu", vtu_text(points, cells, [HEXAHEDRON] * len(cells), fields))
        self.engine = ["--engine", "reference"]
        out = self.path("v.vtu")
        found = self.report(grid, "--field", "x", "--range", "0.5,2", "--carry", "y,x", "-o", out)["volumes"][0]
        self.assertAlmostEqual(found["volume"], 1.5 * 9, places=4)
        self.assertEqual([f["name"] for f in found["fields"]], ["y", "x"])
        self.assertAlmostEqual(found["fields"][0]["mean"][0], 3, places=4)
        self.assertAlmostEqual(found["fields"][1]["mean"][0], 1.25, places=4)
        whole = self.report(self.volume, "--range", "60,130", "--carry", "samples", "-o", self.path("w.vtu"))["volumes"][0]
        self.assertEqual(whole["fields"][0]["name"], "samples")
        self.assertTrue(60 < whole["fields"][0]["mean"][0] < 130)
        self.assertIn("samples", read_vtu(self.path("w.vtu")))
        self.refuses(2, "isovolume", self.volume, "--range", "60,130", "--carry", "x", says="no name: leave out --carry, or call it samples")
        volume, integral, _ = measure(read_vtu(out), "x")
        self.assertAlmostEqual(integral, found["fields"][1]["integral"][0], places=4)
        self.assertAlmostEqual(volume, found["volume"], places=4)

    def test_refusals(self):
        out = self.path("v.vtu")
        for how, says in ((["--range", "2,1"], "less than"), (["--range", "5"], "two numbers"),
                          (["--range", ","], "two numbers"), (["--range", "a,1"], "two numbers"), ([], "needs --range"),
                          (["--range", "1,2", "-o", self.path("v.vtp")], r"end in \.vtu"),
                          (["--range", "1,2", "--count", "-o", out], "--count makes no volume"),
                          (["--range", "1,2", "--count", "--format", "vtu"], "--count makes no volume"),
                          (["--range", "1,2", "--format", "vtu"], "give -o FILE"),
                          (["--range", "1,2", "-o", out, "--format", "ply"], "they are written as vtu"),
                          (["--range", "1,2", "--range", "2,3", "-o", out], "needs a %"),
                          (["--range", "1,2", "-o", self.volume], "end in")):
            self.refuses(2, "isovolume", self.volume, *how, says=says)
        self.refuses(4, "isovolume", self.path("absent.nrrd"), "--range", "1,2", "-o", out)
        empty = self.expect(0, "isovolume", self.volume, "--range", "1000,2000", "-o", out, *self.engine)
        self.assertRegex(empty.stderr, r"no part of the grid lies within: samples are [\d.]+ to [\d.]+$")
        counted = self.report(self.volume, "--range", "1000,2000", "--count")
        self.assertRegex(counted["notices"][0], "lies within: samples are")
        self.assertEqual(len(read_vtu(out)["Points"]), 0)

    def test_unstructured(self):
        grid = self.write("h.vtu", vtu_text(lattice((3, 3, 3)), hexahedra((3, 3, 3)), [HEXAHEDRON] * 8,
                                            [("x", "f32", [float(p[0]) for p in lattice((3, 3, 3))])]))
        result = self.expect(0, "isovolume", grid, "--range", "0.5,1", "--carry", "x", "--check", *self.engine,
                             *(["--verify"] if tool_case.HAS_DEVICE else []))
        self.assertIn("volume      2\n", result.stdout)
        self.assertRegex(result.stdout, r"carried +x: mean 0\.75, ")


if __name__ == "__main__":
    tool_case.main()
