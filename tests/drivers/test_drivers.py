#!/usr/bin/env python3
"""test_drivers.py TOOL LAYER [long] - devices that compute wrongly, or go away, while they report success or not

The layer (tests/layer) stands between the tool and the device. It drops launches, flips bits of what kernels make or of
what is read back, and builds kernels from other text than they were given, as a compiler with an error would. extract
has to refuse such a device with a sentence and no file, --engine auto has to make the reference's bytes, and selftest
has to fail. A device that goes away is an error like others. With `long`, every mistake of compilers is made for every
kind of kernels that has its place; else two. Standard library only.
"""
import json
import os
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from part import part_write

LAYER = None
IS_LONG = False
FIGURES = {"planted": 0, "caught": 0, "selftests": 0, "lost": 0}

# Arguments of kernels by number, as in classify.cl, emit.cl and complex_*.cl; bytes that a small volume uses.
RESULTS = [
    "drop classify", "drop classify 2", "drop emit",
    "flip classify 4 2050 1",   # sign words
    "flip classify 5 256 0",    # vertex offsets
    "flip classify 7 16 0",     # bricks
    "flip classify 9 20 0",     # total of vertices
    "flip classify 9 24 1",     # total of triangles
    "flip classify 9 12 0",     # active cells
    "flip emit 10 4000 0",      # positions: the last bit of one
    "flip emit 12 4000 0",      # triangles
    "read 20 0", "read 24 0",   # totals, read back
]
COMPLEX_RESULTS = ["drop complex_classify", "drop complex_list", "drop complex_join", "drop complex_number",
                   "drop complex_emit"]
# Mistakes of compilers, and types of samples whose kernels have their place.
MISTAKES = {"popcount": ["u8", "f32"], "division": ["u8", "f32"], "subnormals": ["f32"], "overflow": ["f32"],
            "contraction": ["u8", "f64"], "look-back": ["u8", "f64"], "fallback": ["u8", "i16"], "comparison": ["u8"]}
QUICK_MISTAKES = [("division", "u8"), ("fallback", "u8")]
NOT_AVAILABLE = -2


class DriverCase(tool_case.Case):
    def layer(self, command):
        return {"OPENCL_LAYERS": LAYER, "TETRACUBES_LAYER": command, "TETRACUBES_CACHE_DIR": ""}

    def mesh(self, *arguments, **how):
        path = self.path("mesh.ply")
        self.expect(0, "extract", *arguments, "--quiet", "-o", path, **how)
        with open(path, "rb") as file:
            content = file.read()
        os.unlink(path)
        return content

    def refused(self, command, volume, *more, says="gives wrong results.*--engine reference"):
        FIGURES["planted"] += 1
        self.refuses(1, "extract", volume, "--iso", "127.5", "-o", self.path("a.ply"), *more, env=self.layer(command),
                     says=says)
        FIGURES["caught"] += 1

    def falls_back(self, command, volume, *more, says="the reference engine takes over"):
        """--engine auto makes the reference's bytes, and says which engine has."""
        arguments = [volume, "--iso", "127.5", *more]
        expected = self.mesh(*arguments, "--engine", "reference")
        self.assertEqual(self.mesh(*arguments, "--engine", "auto", env=self.layer(command)), expected)
        result = self.expect(0, "extract", *arguments, "--engine", "auto", "--json", env=self.layer(command), says=says)
        report = json.loads(result.stdout)
        self.assertEqual((report["engine"], report["device"]), ("reference", None))


class Wrong(DriverCase):
    def test_sound_device_passes(self):
        for kind in ("u8", "f32"):
            volume = self.generate("sphere", "a.nrrd", "30,20,10", kind)
            for engine in ("opencl", "auto"):
                report = self.report("extract", volume, "--iso", "127.5", "--engine", engine, env=self.layer("count"))
                self.assertEqual(report["engine"], "opencl")

    def test_results(self):
        volume = self.generate("sphere", "a.nrrd", "30,20,10", "u8")
        for fault in RESULTS:
            with self.subTest(fault=fault):
                self.refused("corrupt " + fault, volume)
        for fault in ("drop classify", "flip classify 9 20 0", "read 24 0"):
            self.refuses(1, "extract", volume, "--iso", "127.5", "--count", env=self.layer("corrupt " + fault),
                         says="gives wrong results")
        for fault in ("drop emit", "flip classify 7 16 0"):
            self.falls_back("corrupt " + fault, volume)

    def test_kinds_of_kernels(self):
        """Each kind is tried on its own."""
        volume = self.generate("sphere", "a.nrrd", "30,20,10", "u8")
        for more in (["--method", "hybrid"], ["--normals"], ["--nodata", "3"]):
            self.refused("corrupt flip emit 10 4000 0", volume, *more)
        self.refused("corrupt flip emit 11 4000 0", volume, "--normals")
        self.refused("corrupt drop cells_mark", volume, "--nodata", "3")

    def test_missing_samples_met_on_the_way(self):
        """Other kernels take over when a NaN is found: they are tried then."""
        volume = self.generate("sphere", "a.nrrd", "30,20,10", "f32")
        with open(volume, "r+b") as file:
            file.seek(-400, os.SEEK_END)
            file.write(b"\0\0\xc0\x7f")
        self.refused("corrupt drop cells_mark", volume)
        self.refuses(1, "extract", volume, "--iso", "127.5", "--count", env=self.layer("corrupt drop cells_mark"),
                     says="gives wrong results")
        self.falls_back("corrupt drop cells_mark", volume)

    def test_snap_without_fp64(self):
        """Method snap of samples that need double precision."""
        for kind in ("f64", "i32", "u32"):
            volume = self.generate("sphere", f"{kind}.nrrd", "30,20,10", kind)
            self.refuses(1, "extract", volume, "--iso", "127.5", "--method", "snap", "-o", self.path("a.ply"),
                         env=self.layer("lacks fp64"), says=f"no fp64.*{kind}.*reference")
            self.falls_back("lacks fp64", volume, "--method", "snap", says="no fp64")

    def test_complexes(self):
        image = self.generate("sphere", "a.nrrd", "12,11,10", "f32")
        volume = self.path("a.vtu")
        self.expect(0, "tetrahedralize", image, "-o", volume, "--quiet")
        for fault in COMPLEX_RESULTS:
            self.refused("corrupt " + fault, volume)
        self.falls_back("corrupt drop complex_join", volume)

    def test_selftest_fails(self):
        for fault in ("drop emit", "flip emit 10 400 0", "read 24 0") if IS_LONG else ("flip emit 10 400 0",):
            FIGURES["selftests"] += 1
            result = self.expect(3, "selftest", "--quick", env=self.layer("corrupt " + fault), says="do not trust")
            self.assertTrue(result.stdout.endswith("FAIL\n"))

    def test_compilers(self):
        cases = [(name, kind) for name, kinds in MISTAKES.items() for kind in kinds] if IS_LONG else QUICK_MISTAKES
        for name, kind in cases:
            with self.subTest(mistake=name, type=kind):
                volume = self.generate("sphere", f"{kind}.nrrd", "30,20,10", kind)
                self.refused("corrupt build " + name, volume)
                os.unlink(volume)


class Lost(DriverCase):
    def test_device_goes_away(self):
        """From call N on a command fails: the trial needs some calls, the volume the next."""
        volume = self.generate("sphere", "a.nrrd", "30,20,10", "u8")
        for entry, first in (("clCreateContext", 1), ("clEnqueueNDRangeKernel", 1), ("clEnqueueNDRangeKernel", 7),
                             ("clEnqueueReadBuffer", 1), ("clEnqueueReadBuffer", 4), ("clCreateBuffer", 1)):
            command = f"fail {entry} {first} {NOT_AVAILABLE} 0"
            FIGURES["lost"] += 1
            self.refuses(1, "extract", volume, "--iso", "127.5", "-o", self.path("a.ply"), env=self.layer(command),
                         says="CL_DEVICE_NOT_AVAILABLE")
            self.falls_back(command, volume)

    def meshes(self):
        contents = []
        for name in ("100", "127.5"):
            with open(self.path(name + ".ply"), "rb") as file:
                contents.append(file.read())
        return contents

    def test_between_surfaces(self):
        """The reference goes on with the second isovalue where the first was the device's."""
        volume = self.generate("sphere", "a.nrrd", "30,20,10", "u8")
        arguments = ["extract", volume, "--iso", "100,127.5", "-o", self.path("%.ply"), "--quiet"]
        self.expect(0, *arguments, "--engine", "reference")
        expected = self.meshes()
        for name in ("100", "127.5"):
            os.unlink(self.path(name + ".ply"))
        command = f"fail clEnqueueNDRangeKernel 9 {NOT_AVAILABLE} 0"
        self.expect(1, *arguments, env=self.layer(command), says="CL_DEVICE_NOT_AVAILABLE")
        self.assertEqual(self.files(), ["100.ply", "a.nrrd"])
        self.expect(0, *arguments, "--engine", "auto", env=self.layer(command))
        self.assertEqual(self.meshes(), expected)

    def test_no_device(self):
        volume = self.generate("sphere", "a.nrrd", "30,20,10", "u8")
        expected = self.mesh(volume, "--iso", "127.5", "--engine", "reference")
        none = {"OCL_ICD_VENDORS": self.path("none"), "OPENCL_LAYERS": ""}
        self.assertEqual(self.mesh(volume, "--iso", "127.5", "--engine", "auto", env=none), expected)
        self.refuses(1, "extract", volume, "--iso", "127.5", env=none, says="no OpenCL platform")

    def test_usage(self):
        volume = self.generate("sphere", "a.nrrd", "30,20,10", "u8")
        self.refuses(2, "extract", volume, "--iso", "1", "--engine", "auto", "--verify", says="leave out --verify")
        self.assertRegex(self.expect(0, "extract", "--help").stdout, "auto:\n *the reference where")


def write_figures(seconds):
    if not IS_LONG:
        return
    version = tool_case.tool("devices", "--json", env={"OPENCL_LAYERS": ""})
    devices = json.loads(version.stdout)["devices"] if not version.returncode else []
    names = {"planted": "corrupting devices planted", "caught": "corrupting devices refused by extract",
             "selftests": "corrupting devices that failed the self-test", "lost": "devices that went away"}
    part_write("drivers", {device["platform"]: device["driver"] for device in devices},
               [(what, FIGURES[key]) for key, what in names.items()], seconds)


if __name__ == "__main__":
    LAYER = os.path.abspath(sys.argv[2])
    IS_LONG = "long" in sys.argv[3:]
    begin = time.monotonic()
    result = tool_case.main(exit=False).result
    if result.wasSuccessful():
        write_figures(time.monotonic() - begin)
    sys.exit(not result.wasSuccessful())
