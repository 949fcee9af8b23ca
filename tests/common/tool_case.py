"""tool_case.py - what tests of the tool share: a case that runs it in a folder of its own, and the options of a test

A test ends with main(), and is called with TOOL [reference] [fault=LIBRARY] [...]. With `reference`, what needs an
OpenCL device is left out; without it a device must be there. Standard library only.
"""
import json
import os
import signal
import struct
import subprocess
import sys
import tempfile
import unittest

import grid_files

TOOL = None
HAS_DEVICE = False
FAULT_LIBRARY = None

EXTRACT_KEYS = {"input", "device", "engine", "method", "dims", "roi", "step", "cells", "tetrahedra", "timings_ms",
                "surfaces", "notices"}
COUNT_KEYS = {"iso", "vertices", "triangles", "active_cells", "timings_ms"}
SURFACE_KEYS = COUNT_KEYS | {"degenerate_triangles", "bounds", "origin", "hash"}
CHECK_KEYS = {"boundary_edges", "nonmanifold_edges", "nonmanifold_vertices", "misoriented_edges", "coarse_vertices",
              "euler_characteristic", "components", "area", "volume", "smallest_angle_median", "angles_below_10",
              "angles_below_20"}
INFO_KEYS = {"input", "format", "dims", "first", "roi", "step", "type", "spacing", "matrix", "space", "units", "notice", "range",
             "nonfinite", "histogram", "isovalues", "field", "blocks", "missing", "notices", "choices"}


def chosen():
    """Arguments for unittest, as expect.h has it: TEST_ONLY in the environment chooses tests, TEST_STOP ends with the
    first failure."""
    only = os.environ.get("TEST_ONLY")
    return (["-k", only] if only else []) + (["-f"] if os.environ.get("TEST_STOP") else [])


def cancelled_by(number):
    """The status of a run that a signal has cancelled: it ends by it, unless that would leave a core file."""
    return 1 if number in (signal.SIGQUIT, signal.SIGXCPU) else -number


def signals_as_usual():
    """Shells and nohup have what goes on in the background ignore some: the tool would as well."""
    for number in (signal.SIGINT, signal.SIGQUIT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


def tool(*arguments, env=None, stdout=subprocess.PIPE, cwd=None):
    environment = dict(os.environ, **(env or {}))
    return subprocess.run([TOOL, *map(str, arguments)], stdout=stdout, stderr=subprocess.PIPE, text=True,
                          env=environment, cwd=cwd, timeout=1000)


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="tetracubes-cli-")
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def files(self):
        return sorted(os.listdir(self.folder.name))

    def expect(self, status, *arguments, says=None, **how):
        """Runs the tool; checks its exit status and, as a pattern, what it says on standard error."""
        result = tool(*arguments, **how)
        told = f"{arguments}: status {result.returncode}, {result.stdout!r}, {result.stderr!r}"
        self.assertEqual(result.returncode, status, told)
        if status and status != 3:
            self.assertTrue(result.stderr.startswith("tetracubes: "), told)
            self.assertEqual(result.stdout or "", "", told)
        if says:
            self.assertRegex(result.stderr, says, told)
        return result

    def refuses(self, status, *arguments, says=None, **how):
        """As expect, and no file appears, vanishes or changes its size."""
        before = [(name, os.path.getsize(self.path(name))) for name in self.files()]
        result = self.expect(status, *arguments, says=says, **how)
        self.assertEqual([(name, os.path.getsize(self.path(name))) for name in self.files()], before)
        return result

    def generate(self, field, name, dims="20,19,18", kind="u8", *more):
        self.expect(0, "generate", field, "--dims", dims, "--type", kind, "-o", self.path(name), *more)
        return self.path(name)

    def report(self, *arguments, status=0, **how):
        return json.loads(self.expect(status, *arguments, "--json", **how).stdout)

    def engines(self):
        return ["reference", "opencl"] if HAS_DEVICE else ["reference"]

    def needs_device(self):
        if not HAS_DEVICE:
            self.skipTest("no OpenCL device")

    def needs_xml(self):
        if "VTK XML" not in self.expect(0, "--version").stdout:
            self.skipTest("built without VTK XML")


class GridCase(Case):
    def write(self, name, data):
        """A file of this text, or of these bytes."""
        with open(self.path(name), "wb") as f:
            f.write(data if isinstance(data, bytes) else data.encode())
        return self.path(name)

    def raw(self, name, kind, dims, values):
        """A raw file of these values, and the arguments that read it."""
        codes = dict(zip(("u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64"), "BbHhIifd"))
        with open(self.path(name), "wb") as out:
            out.write(struct.pack(f"<{len(values)}{codes[kind]}", *values))
        return [self.path(name), "--dims", ",".join(map(str, dims)), "--type", kind]

    def write_plot3d(self, name, blocks):
        grid, solution = grid_files.plot3d_texts(blocks)
        return [self.write(name + ".xyz", grid), self.write(name + ".q", solution)]

    def write_hexahedra(self, name, dims=(9, 8, 9), values=None, **more):
        points = grid_files.lattice(dims)
        values = list(map(grid_files.bump, points)) if values is None else values
        cells = grid_files.hexahedra(dims)
        fields = [("bump", "f64", values), ("x", "f32", [float(p[0]) for p in points])]
        types = [grid_files.HEXAHEDRON] * len(cells)
        return self.write(name, grid_files.vtu_text(points, cells, types, fields, **more))

    def extract(self, arguments, iso, *more, status=0, **how):
        """The report of the reference engine."""
        return self.report("extract", *arguments, "--iso", iso, "--engine", "reference", *more, status=status, **how)

    def surface(self, *arguments, **how):
        """The report of extract --check and, on a device, --verify; and its one surface."""
        verify = ["--verify"] if HAS_DEVICE else ["--engine", "reference"]
        report = self.report("extract", *arguments, "--check", *verify, **how)
        self.assertEqual(set(report), EXTRACT_KEYS)
        [surface] = report["surfaces"]
        return report, surface

    def notices(self, arguments, iso, *more):
        """Those of the report; the same stand on standard error, but for --quiet."""
        words = ["extract", *arguments, "--iso", iso, "--engine", "reference", "--json", *more]
        loud = self.expect(0, *words)
        told = json.loads(loud.stdout)["notices"]
        self.assertEqual(loud.stderr.splitlines(), ["tetracubes: " + notice for notice in told])
        quiet = self.expect(0, *words, "--quiet")
        self.assertEqual((quiet.stderr, json.loads(quiet.stdout)["notices"]), ("", told))
        return told


def counts(surface):
    return [surface[key] for key in ("vertices", "triangles", "boundary_edges", "euler_characteristic")]


def main(device=True, **how):
    """The program of a test; without `device` nothing in it needs one. `how` goes to unittest.main."""
    global TOOL, HAS_DEVICE, FAULT_LIBRARY
    TOOL = os.path.abspath(sys.argv[1])
    HAS_DEVICE = device and "reference" not in sys.argv[2:]
    FAULT_LIBRARY = next((os.path.abspath(word[6:]) for word in sys.argv[2:] if word.startswith("fault=")), None)
    if device:
        print("all checks" if HAS_DEVICE else "checks that need an OpenCL device are left out", flush=True)
    return unittest.main(argv=[sys.argv[0], *chosen()], **how)
