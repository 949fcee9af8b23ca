#!/usr/bin/env python3
"""test_streams.py TOOL [reference] - meshes on standard output and in pipes, and users who have no home

A mesh on a stream is the same bytes as in a file, and whatever else is said goes to the other stream. Where the OpenCL
implementation cannot write its cache, the message names the folder.
"""
import gzip
import json
import os
import subprocess
import sys
import threading

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from tool_case import GridCase


class Streams(GridCase):
    def setUp(self):
        super().setUp()
        self.volume = self.generate("sphere", "s.nrrd", "12,11,10")
        self.words = [tool_case.TOOL, "extract", self.volume, "--iso", "127.5", "--engine", "reference"]

    def expected(self, ending):
        self.expect(0, *self.words[1:], "-o", self.path("good." + ending), "--quiet")
        with open(self.path("good." + ending), "rb") as file:
            return file.read()

    def run_split(self, *more, **how):
        return subprocess.run([*self.words, *more], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=400, **how)

    def test_mesh_on_standard_output(self):
        for ending in ("stl", "ply", "vtp", "obj", "off", "glb", "html", "npz"):
            good = self.expected(ending)
            for name in ("-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"):
                for more in ([], ["--json"], ["--quiet"]):
                    done = self.run_split("-o", name, "--format", ending, *more)
                    self.assertEqual((done.returncode, done.stdout), (0, good), (name, more))
                    self.assertEqual(b"bounds" in done.stderr, more != ["--quiet"])
        report = json.loads(self.run_split("-o", "-", "--format", "obj", "--json").stderr)
        self.assertEqual(report["surfaces"][0]["iso"], 127.5)
        self.assertNotIn("-", self.files())

    def test_packed_input(self):
        """Packed by gzip: a file, standard input, a mask; samples without a header by their ending alone."""
        if "gzip" not in self.expect(0, "--version").stdout:
            self.skipTest("built without zlib")
        good = self.expected("ply")
        with open(self.volume, "rb") as file:
            packed = gzip.compress(file.read())
        self.write("s.nrrd.gz", packed)
        self.write("mask.raw.gz", gzip.compress(bytes([1]) * 12 * 11 * 10))
        raw = self.write("s.raw.gz", gzip.compress(bytes(range(8))))
        done = self.run_split("-o", "-", "--format", "ply", "--mask", self.path("mask.raw.gz"))
        self.assertEqual((done.returncode, done.stdout), (0, good), done.stderr)
        for volume, data in ((self.path("s.nrrd.gz"), b""), ("-", packed), ("/dev/stdin", packed)):
            done = subprocess.run([*self.words[:2], volume, *self.words[3:], "-o", "-", "--format", "ply"], input=data,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=400)
            self.assertEqual((done.returncode, done.stdout), (0, good), done.stderr)
        facts = json.loads(self.expect(0, "info", raw, "--dims", "2,2,2", "--type", "u8", "--json").stdout)
        self.assertEqual(facts["format"], "raw")
        done = self.expect(4, "info", self.write("cut.vtk.gz", packed[:100]))
        self.assertIn("cut.vtk.gz: its compressed data is damaged (it is cut)", done.stderr)

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
            done = subprocess.run([tool_case.TOOL, *words, "-o", "-"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  timeout=400)
            self.assertEqual((done.returncode, done.stdout), (0, good))
            self.assertIn(b"standard output:", done.stderr)

    def test_usage(self):
        self.refuses(2, *self.words[1:], "-o", "-", says="--format")
        self.refuses(2, *self.words[1:], "-o", "-", "--format", "ply", "--blocks", "separate", says="one stream")
        self.refuses(2, *self.words[1:4], "100,120", "-o", "-", "--format", "ply", says="%")


class Homes(GridCase):
    """Users of containers have no home; PoCL then has no device, or builds nothing."""
    NOBODY = 65534

    def as_nobody(self, *words, **variables):
        environment = {name: value for name, value in os.environ.items()
                       if name not in ("POCL_CACHE_DIR", "XDG_CACHE_HOME", "HOME")}
        drop = None if os.getuid() else lambda: os.setuid(self.NOBODY)
        try:
            return subprocess.run([tool_case.TOOL, *words], env=dict(environment, **variables), stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, text=True, preexec_fn=drop, timeout=1000)
        except PermissionError:
            self.skipTest("nobody may not run the tool here")

    def test_cache_folder_that_nobody_can_make(self):
        if not tool_case.HAS_DEVICE or "Portable Computing" not in tool_platforms():
            self.skipTest("no PoCL")
        # /proc: whose permissions let root do what cannot be done
        for folder in ["/dev/null/kcache"] + ["/proc/kcache"] * os.path.exists("/proc/self"):
            self.refuses(1, "devices", says=f"cannot write its cache folder {folder}.*POCL_CACHE_DIR",
                         env={"POCL_CACHE_DIR": folder})
        self.expect(0, "devices", env={"POCL_CACHE_DIR": "", "XDG_CACHE_HOME": self.path("own")})

    def test_cache_folder_is_named(self):
        os.chmod(self.folder.name, 0o755)
        volume = self.generate("sphere", "s.nrrd", "12,11,10")
        os.chmod(volume, 0o644)
        os.mkdir(self.path("locked"), 0o555)  # for whoever runs this, unless that is root, who becomes nobody
        devices = self.as_nobody("devices", POCL_CACHE_DIR=self.path("locked/made"), HOME="/nonexistent")
        if not tool_case.HAS_DEVICE or "Portable Computing" not in tool_platforms():
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
    return tool_case.tool("devices").stdout


if __name__ == "__main__":
    tool_case.main()
