#!/usr/bin/env python3
"""test_cli_stream.py TOOL [reference] - surfaces made window by window: the files of --stream are those made in memory

Asked for, and where memory is short; of data in all forms in which they can come; what ends a stream leaves nothing.
"""
import gzip
import json
import os
import pty
import resource
import signal
import struct
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import grid_files
import tool_case
from tool_case import GridCase

ENDINGS = ("ply", "vtp", "stl")


def limited(kind, bytes_most):
    """For subprocess: the limit of the process."""
    return lambda: resource.setrlimit(kind, (bytes_most, resource.RLIM_INFINITY))


class Stream(GridCase):
    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def expect_same(self, arguments, iso, *more, endings=ENDINGS, engines=("reference",), **how):
        """In memory and as a stream, with little memory: the same files. (test_grid_pieces has streams on devices.)"""
        for engine in engines:
            for ending in endings:
                words = ["extract", *arguments, "--iso", iso, "--engine", engine, "--quiet", *more, "-o"]
                self.expect(0, *words, self.path("whole." + ending))
                report = self.report(*words, self.path("pieces." + ending), "--stream",
                                     *(["--max-memory", "4M"] if engine == "opencl" else []), **how)
                self.assertEqual(self.read("whole." + ending), self.read("pieces." + ending), (words, ending))
        return report["surfaces"][0]

    def test_methods(self):
        volume = self.generate("gyroid", "g.nrrd", "70,60,150")
        for method in ("tetra", "hybrid", "snap"):
            engines = self.engines() if method == "tetra" else ("reference",)
            surface = self.expect_same([volume], "127.5", "--method", method, endings=("ply", "stl"), engines=engines)
            self.assertIsNone(surface["hash"])
            self.assertIsNone(surface["degenerate_triangles"])
        surface = self.expect_same([volume], "127.5", "--normals", endings=("ply", "vtp"))
        self.assertEqual(surface["bounds"], [[-1, -1, -1], [1, 1, 1]])
        self.assertGreater(surface["pieces"], 0)

    def test_counts(self):
        """All that is told of a stream but hash and triangles of zero area is told of the mesh in memory."""
        volume = self.generate("torus", "t.nrrd", "60,60,90", "i16")
        words = ["extract", volume, "--iso", "0", "--engine", "reference"]
        whole, pieces = (self.report(*words, *more) for more in ([], ["--stream"]))
        for key in ("vertices", "triangles", "active_cells", "bounds", "origin"):
            self.assertEqual(whole["surfaces"][0][key], pieces["surfaces"][0][key], key)
        self.assertRegex(self.expect(0, *words, "--stream").stdout, r"streamed +in \d+ pieces")

    def test_several_isovalues(self):
        volume = self.generate("sphere", "s.nrrd", "50,50,90")
        for stream in ([], ["--stream"]):
            self.expect(0, "extract", volume, "--iso", "100,127.5,255,300", "--engine", "reference", "-o",
                        self.path(f"{len(stream)}-%.ply"), *stream)
        for iso in ("100", "127.5", "255", "300"):
            self.assertEqual(self.read(f"0-{iso}.ply"), self.read(f"1-{iso}.ply"), iso)

    def test_inputs(self):
        """Far from zero, missing samples, a mask, the other byte order, packed."""
        values = [(x - 6) ** 2 + (y - 7) ** 2 + (z - 20) ** 2 for z in range(40) for y in range(15) for x in range(13)]
        dims = (13, 15, 40)
        raw = self.raw("a.raw", "f32", dims, values)
        self.expect_same([*raw, "--origin", "1e7,0,-4e6"], "30.5")
        self.expect_same([*raw, "--nodata", values[500]], "30.5", "--normals", endings=("ply",))
        mask = self.write("mask.raw", bytes(int(n % 7 != 3) for n in range(len(values))))
        self.expect_same([*raw, "--mask", mask], "30.5", endings=("stl",))
        self.write("b.raw", struct.pack(f">{len(values)}f", *values))
        self.expect_same([self.path("b.raw"), *raw[1:], "--endian", "big"], "30.5", endings=("ply",))
        if "gzip" in self.expect(0, "--version").stdout:
            self.write("a.raw.gz", gzip.compress(self.read("a.raw")))
            self.expect_same([self.path("a.raw.gz"), *raw[1:]], "30.5", endings=("ply",))

    def test_carried_fields(self):
        self.needs_xml()
        dims = (9, 8, 40)
        points = grid_files.lattice(dims)
        fields = [("bump", "f64", list(map(grid_files.bump, points))), ("x", "f32", [float(p[0]) for p in points])]
        volume = self.write("v.vti", grid_files.vti_text(dims, fields))
        self.expect_same([volume, "--field", "bump"], "0.3", "--carry", "x", endings=("ply", "vtp"))

    def test_curvilinear(self):
        """Mirrored, and far from zero."""
        self.needs_xml()
        dims = (9, 8, 40)
        lattice = grid_files.lattice(dims)
        fields = [("bump", "f64", list(map(grid_files.bump, lattice)))]
        for shift in (0, 1e7):
            points = [(shift - x, y + 0.1 * z, z + 0.2 * x) for x, y, z in lattice]
            volume = self.write("c.vts", grid_files.vts_text(dims, points, fields))
            self.expect_same([volume], "0.3", "--normals", endings=("ply",))
            self.expect_same([volume], "0.3", endings=("stl",))

    def test_empty(self):
        volume = self.generate("sphere", "s.nrrd", "20,20,20")
        self.expect_same([volume], "300", "--normals", endings=("ply", "vtp"))
        self.expect_same([volume], "300", endings=("stl",))

    def test_little_memory(self):
        """Where the mesh would not fit the surface is streamed unasked."""
        dims = "128,128,128"
        self.expect(0, "generate", "noise", "--dims", dims, "--type", "u8", "-o", self.path("n.raw"), "--quiet")
        words = ["extract", self.path("n.raw"), "--dims", dims, "--type", "u8", "--iso", "127.5", "--engine", "reference",
                 "--json", "-o"]
        self.expect(0, *words, self.path("whole.ply"))
        done = subprocess.run([tool_case.TOOL, *words, self.path("pieces.ply")], stdout=subprocess.PIPE, text=True,
                              timeout=400, preexec_fn=limited(resource.RLIMIT_DATA, 160 << 20))
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stdout, r'"pieces": \d\d')
        self.assertEqual(self.read("whole.ply"), self.read("pieces.ply"))

    def count_of(self, name, *more, folder, bytes_most=resource.RLIM_INFINITY):
        """Counts in 512 x 512 x 200 samples of 16 bits, 100 MB, with no more memory than that."""
        words = [tool_case.TOOL, "extract", self.path(name), "--dims", "512,512,200", "--type", "i16", *more, "--iso", "1",
                 "--engine", "reference", "--count", "--json"]
        done = subprocess.run(words, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, timeout=400,
                              env=dict(os.environ, TMPDIR=folder),
                              preexec_fn=limited(resource.RLIMIT_DATA, bytes_most))
        return done.returncode, json.loads(done.stdout)["surfaces"][0]["vertices"] if done.stdout else done.stderr

    def test_samples_in_a_file(self):
        """What is to be swapped or unpacked, and does not fit into memory, lies in a file without a name."""
        folder = self.path("temporary")
        os.mkdir(folder)
        with open(self.path("be.raw"), "wb") as out:
            out.write(struct.pack(">i", 7) * 1000)
            out.seek(50 << 20)
            out.write(struct.pack(">h", 300) * 70000)
            out.truncate(100 << 20)
        inputs = [("be.raw", "--endian", "big")]
        if "gzip" in self.expect(0, "--version").stdout:
            self.write("be.raw.gz", gzip.compress(self.read("be.raw"), 1))
            inputs.append(("be.raw.gz", "--endian", "big"))
        for name, *more in inputs:
            status, vertices = self.count_of(name, *more, folder=folder)
            self.assertEqual(status, 0, vertices)
            self.assertGreater(vertices, 100000)
            limits = {"folder": folder, "bytes_most": 100 << 20}
            self.assertEqual(self.count_of(name, *more, **limits), (0, vertices))
            self.assertEqual(os.listdir(folder), [])
            status, text = self.count_of(name, *more, folder=self.path("none"), bytes_most=100 << 20)
            self.assertEqual(status, 1)
            self.assertRegex(text, "TMPDIR")

    def test_progress(self):
        """On a terminal: how far, how fast, how long still."""
        volume = self.generate("noise", "n.nrrd", "160,160,160")
        leader, follower = pty.openpty()
        running = subprocess.Popen([tool_case.TOOL, "extract", volume, "--iso", "127.5", "--engine", "reference", "--stream",
                                    "-o", self.path("n.ply")], stdout=subprocess.DEVNULL, stderr=follower)
        os.close(follower)
        text = b""
        try:
            while some := os.read(leader, 4096):
                text += some
        except OSError:  # the other end is closed
            pass
        os.close(leader)
        self.assertEqual(running.wait(timeout=400), 0)
        self.assertRegex(text.decode(), r"(classify|emit) +\d+%, [\d.e-]+ GB/s, \d+:\d\d left")

    def test_nothing_is_left(self):
        volume = self.generate("noise", "n.nrrd", "100,100,120")
        words = [tool_case.TOOL, "extract", volume, "--iso", "127.5", "--engine", "reference", "--stream", "-o",
                 self.path("n.ply")]
        done = subprocess.run(words, stderr=subprocess.PIPE, text=True, timeout=400,
                              preexec_fn=limited(resource.RLIMIT_FSIZE, 1 << 20))
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"n\.ply: cannot be written")
        self.assertEqual(self.files(), ["n.nrrd"])
        for delay in (0.05, 0.3):
            running = subprocess.Popen(words, stderr=subprocess.PIPE, preexec_fn=tool_case.signals_as_usual)
            time.sleep(delay)
            running.send_signal(signal.SIGINT)
            text = running.communicate(timeout=400)[1].decode()
            self.assertEqual(running.returncode, -signal.SIGINT, text)
            self.assertEqual(self.files(), ["n.nrrd"])

    def test_separate_blocks(self):
        """Of one block, too, the file has the block's number."""
        volume = self.generate("sphere", "s.nrrd", "20,20,20")
        said = self.expect(0, "extract", volume, "--iso", "127.5", "--engine", "reference", "--stream", "--blocks", "separate",
                           "-o", self.path("a.ply")).stdout
        self.assertRegex(said, r"written +\S+a_b0\.ply\n")
        self.assertEqual(self.files(), ["a_b0.ply", "s.nrrd"])

    def test_refused(self):
        volume = self.generate("sphere", "s.nrrd", "20,20,20")
        words = ["extract", volume, "--iso", "127.5", "--engine", "reference", "--stream"]
        for more, says in ((["--check"], "--check needs the whole mesh"),
                           (["--drop-degenerate"], "--drop-degenerate needs"),
                           (["--simplify", "0.5"], "--simplify needs (the whole mesh|meshoptimizer)"),
                           (["--preview", self.path("a.png")], "--preview (draws the whole mesh|needs libpng)"),
                           (["--roi", ":,:,2:9"], "take a part"),
                           (["-o", self.path("a.obj")], "write ply, vtp(, stl or vtkhdf| or stl)"),
                           (["-o", self.path("a.ply"), "--soup"], "--soup"),
                           (["-o", "-", "--format", "ply"], "name a file"),
                           (["--count"], "--count makes no mesh")):
            self.refuses(2, *words, *more, says=says)
        self.needs_xml()
        cells = self.write_hexahedra("h.vtu")
        self.refuses(2, "extract", cells, "--iso", "2.5", "--field", "x", "--engine", "reference", "--stream",
                     says="unstructured")


if __name__ == "__main__":
    tool_case.main()
