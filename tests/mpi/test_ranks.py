#!/usr/bin/env python3
"""test_ranks.py TOOL mpi=PROGRAM mpirun=MPIRUN strike=LIBRARY [reference] [long] - tetracubes-mpi beside the tool

The file that ranks write together is that of one process, every byte: numbers of ranks, methods, formats, odd sizes,
missing data, carried fields, more ranks than layers. What ranks send to each other does not grow with the volume. Then
ranks that are killed, a full disk, an interrupt, in each phase: no file is left, nor a process, and a sentence is told.
With `long` there are more of all.
"""
import itertools
import json
import os
import re
import shutil
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from grid_files import lattice, vti_text
from tool_case import GridCase

GIVEN = dict(word.split("=", 1) for word in sys.argv[2:] if "=" in word)
IS_LONG = "long" in sys.argv[2:]
ROOT = {f"{name}_ALLOW_RUN_AS_ROOT{end}": "1" for name in ("OMPI", "PRTE") for end in ("", "_CONFIRM")}
TIMEOUT = 200


def read(path):
    with open(path, "rb") as file:
        return file.read()


class RankCase(GridCase):
    def ranks(self, count, *arguments, strike=None):
        command = [GIVEN["mpirun"], "--oversubscribe", "-np", str(count)]
        if strike:
            command += ["-x", f"LD_PRELOAD={GIVEN['strike']}", "-x", f"RANK_STRIKE={strike}"]
        job = subprocess.Popen([*command, GIVEN["mpi"], *map(str, arguments)], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True, env=dict(os.environ, **ROOT))
        try:
            out, err = job.communicate(timeout=TIMEOUT)
        except subprocess.TimeoutExpired:
            job.kill()
            self.fail(f"{count} ranks, {arguments}, {strike}: they hang: {job.communicate()}")
        return subprocess.CompletedProcess(command, job.returncode, out, err)

    def extract_by(self, count, *arguments, strike=None):
        done = self.ranks(count, "extract", *arguments, strike=strike)
        self.assertEqual(done.returncode, 0, f"{count} ranks, {arguments}: {done.stdout} {done.stderr}")
        return done

    def compare(self, counts, *arguments, formats=None, ranks=()):
        """ranks: options that ranks have, and one process has not."""
        if not formats:
            has_hdf = "VTKHDF" in self.expect(0, "--version").stdout
            formats = ("ply", "vtp", "stl", "vtkhdf") if has_hdf else ("ply", "vtp", "stl")
        for ending in formats:
            self.expect(0, "extract", *arguments, "-o", self.path("one." + ending), "--quiet")
            for count in counts:
                self.extract_by(count, *arguments, *ranks, "-o", self.path("all." + ending), "--quiet")
                self.assertTrue(read(self.path("all." + ending)) == read(self.path("one." + ending)),
                                f"{arguments}: {count} ranks, {ranks}, {ending}")


class SameBytes(RankCase):
    engine = ["--engine", "reference"]

    def test_methods(self):
        volume = self.generate("noise", "n.nrrd", "70,19,33", "f32")
        for method in ("tetra", "hybrid", "snap"):
            arguments = [volume, "--iso", "127.5", "--method", method, *self.engine]
            if IS_LONG:
                self.compare((1, 2, 3, 5, 8), *arguments)
                self.compare((3, 12), *arguments, "--normals", "--nodata", "3", formats=("ply", "vtp"))
            else:
                formats = ("vtkhdf",) if "VTKHDF" in self.expect(0, "--version").stdout and method == "tetra" else ()
                self.compare((3,), *arguments, formats=("ply", "stl", *formats))

    def test_missing_data_and_more_ranks_than_layers(self):
        volume = self.generate("gyroid", "g.nrrd", "21,17,10")
        counts = (1, 2, 3, 5, 8) if IS_LONG else (5,)
        self.compare(counts, volume, "--iso", "127.5", "--nodata", "140", *self.engine, formats=("vtp", "stl"))

    def test_cuts(self):
        """Planes shared out evenly, by cost and as the user says: odd sizes, missing data, ranks that have nothing."""
        volume = self.generate("noise", "n.nrrd", "21,17,30", "f32")
        given = {1: "even", 2: "24", 3: "4,4", 5: "0,4,20,30", 8: "4,8,12,16,20,24,28"}
        counts, methods = ((1, 2, 3, 5, 8), ("tetra", "hybrid", "snap")) if IS_LONG else ((3,), ("snap",))
        for count, method in itertools.product(counts, methods):
            for cut in ("even", "cost", given[count])[0 if IS_LONG else 1:]:
                self.compare((count,), volume, "--iso", "127.5", "--method", method, "--nodata", "3", *self.engine,
                             ranks=["--cut", cut], formats=None if IS_LONG else ("stl",))

    def test_cut_by_cost(self):
        """Of a surface in the lowest quarter alone, each rank gets as much as it may."""
        dims, ranks = (30, 31, 128), 4
        lattice_values = [(7919 * n) % 251 if z < 32 else 0 for n, (x, y, z) in enumerate(lattice(dims))]
        volume, *more = self.raw("q.raw", "u8", dims, lattice_values)
        how = [volume, *more, "--iso", "127.5", *self.engine]
        done = self.extract_by(ranks, *how, "--cut", "cost", "--json", "-o", self.path("all.ply"))
        cut = json.loads(done.stdout)["cut"]
        self.expect(0, "extract", *how, "-o", self.path("one.ply"), "--quiet")
        self.assertEqual(read(self.path("all.ply")), read(self.path("one.ply")))
        shares = []
        for rank in range(ranks):
            part = self.report("extract", *how, "--cut", ",".join(map(str, cut)), "--part", f"{rank}/{ranks}", "-o",
                               self.path("p"))
            shares.append(part["surfaces"][0]["triangles"])
        self.assertLess(max(shares), 1.5 * sum(shares) / ranks, (cut, shares))
        even = json.loads(self.extract_by(ranks, *how, "--json").stdout)["cut"]
        self.assertEqual(even, [32, 64, 96])

    def test_carried_fields(self):
        self.needs_xml()
        dims = (9, 8, 13)
        points = lattice(dims)
        fields = [("f", "f32", [(x - 4) ** 2 + (y - 4) ** 2 + (z - 6) ** 2 + 0.3 for x, y, z in points]),
                  ("v", "i16", [n for x, y, z in points for n in (x, y, z)], 3)]
        volume = self.write("v.vti", vti_text(dims, fields))
        self.compare((3,), volume, "--field", "f", "--iso", "9", "--carry", "v", *self.engine, formats=("ply",))

    def test_isovalues_and_surfaces_apart(self):
        """Surfaces that one rank alone has, the first or the last, and one that nobody has; far from zero."""
        dims = (9, 8, 29)
        volume, *more = self.raw("z.raw", "u8", dims, [4 * z for x, y, z in lattice(dims)])
        more += ["--origin", "7e6,-3e6,1e7"]
        isovalues = ["110", "2", "250"]
        for ending in ("ply", "stl"):
            self.extract_by(4, volume, "--iso", ",".join(isovalues), *more, *self.engine, "-o",
                            self.path("all-%." + ending), "--quiet")
            for iso in isovalues:
                self.expect(0, "extract", volume, "--iso", iso, *more, *self.engine, "-o", self.path("one." + ending),
                            "--quiet")
                self.assertTrue(read(self.path(f"all-{iso}.{ending}")) == read(self.path("one." + ending)), iso)

    def test_device(self):
        self.needs_device()
        volume = self.generate("noise", "n.nrrd", "70,19,17", "f32")
        self.expect(0, "extract", volume, "--iso", "127.5", "-o", self.path("one.ply"), "--quiet")
        done = self.extract_by(2, volume, "--iso", "127.5", "--device", "cpu:%r", "-o", self.path("all.ply"))
        self.assertEqual(read(self.path("all.ply")), read(self.path("one.ply")))
        self.assertEqual("more ranks than devices" in done.stderr, self.cpu_count() == 1, done.stderr)

    def cpu_count(self):
        devices = json.loads(self.expect(0, "devices", "--json").stdout)["devices"]
        return sum(device["type"] == "cpu" for device in devices)


class Reports(RankCase):
    def test_report(self):
        """Of one process, but for times, the hash and what is told of ranks."""
        volume = self.generate("sphere", "s.nrrd", "15,14,29")
        how = [volume, "--iso", "100", "--engine", "reference", "--json"]
        whole = self.report("extract", *how[:-1], "--stream")
        ranks = json.loads(self.extract_by(3, *how).stdout)
        self.assertEqual(ranks["ranks"], 3)
        for key in ("iso", "vertices", "triangles", "active_cells", "bounds", "origin"):
            self.assertEqual(ranks["surfaces"][0][key], whole["surfaces"][0][key], key)
        counted = json.loads(self.extract_by(2, *how, "--count").stdout)["surfaces"][0]
        self.assertEqual(counted["triangles"], whole["surfaces"][0]["triangles"])
        self.assertNotIn("bounds", counted)

    def test_bytes_sent(self):
        """Those do not grow with the volume, in any direction."""
        sent = []
        for dims in ("16,16,16", "16,16,96", "64,64,64"):
            volume = self.generate("gyroid", "g.nrrd", dims)
            done = self.extract_by(3, volume, "--iso", "100", "--engine", "reference", "--json", "-o",
                                   self.path("x.ply"))
            sent.append(json.loads(done.stdout)["sent_bytes"])
        self.assertEqual(len(set(sent)), 1, sent)
        self.assertLess(sent[0], 1000)


class Endings(RankCase):
    def setUp(self):
        super().setUp()
        self.volume = self.generate("noise", "n.nrrd", "40,41,33", "f32")
        self.how = [self.volume, "--iso", "127.5", "--engine", "reference", "-o", self.path("x.ply")]

    def processes(self):
        """Of the job: those that have this test's folder in their command."""
        found = []
        for process in filter(str.isdigit, os.listdir("/proc")):
            try:
                words = read(f"/proc/{process}/cmdline")
            except OSError:
                continue
            if self.folder.name.encode() in words:
                found.append(words)
        return found

    def expect_nothing_left(self, before, what):
        end = time.monotonic() + 20
        while self.processes() and time.monotonic() < end:
            time.sleep(0.05)
        self.assertEqual(self.processes(), [], what)
        self.assertEqual(self.files(), before, what)

    def fails(self, strike, says, count=3):
        before = self.files()
        done = self.ranks(count, "extract", *self.how, strike=strike)
        self.assertNotEqual(done.returncode, 0, f"{strike}: {done.stdout} {done.stderr}")
        self.assertRegex(done.stderr, says, strike)
        self.expect_nothing_left(before, strike)
        return done

    def strikes(self, what):
        """Moments: while reading, at the end of counting, files opened, the first and a later piece, the end."""
        places = [("MPI_Iallreduce", 5), ("MPI_Iexscan", 1), ("MPI_File_open", 1), ("MPI_File_write_at", 1),
                  ("MPI_File_write_at", 2), ("MPI_File_close", 1)]
        if not IS_LONG:
            return [f"{rank} {call} {number} {what}" for rank, (call, number) in ((1, places[1]), (2, places[3]))]
        return [f"{rank} {call} {number} {what}" for rank, (call, number) in itertools.product(range(3), places)]

    def test_killed(self):
        for strike in self.strikes("kill"):
            self.fails(strike, "signal 9|Killed")

    def test_interrupted(self):
        for strike in self.strikes("interrupt"):
            self.fails(strike, "ended by a signal|killed|Killed|exited|aborted|MPI_ABORT was invoked")

    def test_full_disk(self):
        for strike in ["1 MPI_File_write_at 1 full"] + (["0 MPI_File_write_at 2 full", "2 MPI_File_write_at 2 full"]
                                                        if IS_LONG else []):
            done = self.fails(strike, "No space left on device; free space")
            self.assertIn(f"rank {strike[0]}: ", done.stderr)

    def test_second_file_cannot_be_opened(self):
        """The first goes as well."""
        self.how[2:] = ["100,127.5", *self.how[3:-1], self.path("x-%.ply")]
        self.fails("1 MPI_File_open 2 full", "rank 1: .*x-127.5.ply.*cannot be written by this rank: No space left")

    def test_told_once(self):
        """What all ranks fail with is told by one."""
        before = self.files()
        for status, arguments, says in (
                (4, [self.path("none.nrrd"), "--iso", "1"], "none.nrrd: cannot be opened"),
                (2, [self.volume, "--iso", "1", "-o", self.path("x.obj")], "cannot be written piece by piece"),
                (2, [self.volume, "--iso", "1", "--cut", "4"], "names 1 plane, where .* 2 ranks begin; there are 3"),
                (2, [self.volume, "--iso", "1", "--part", "0/2", "-o", self.path("x.ply")], "--part"),
                (2, [self.volume, "--iso", "1", "--check"], "made by several ranks: --check"),
                (1, [self.volume, "--iso", "1", "-o", self.path("none/x.ply")], "none/x.ply: cannot be written"),
                (2, [self.volume, "--iso"], "--iso needs a value"))[:None if IS_LONG else 4]:
            engine = ["--engine", "reference"] if arguments[-1] != "--iso" else []
            done = self.ranks(3, "extract", *engine, *arguments)
            self.assertEqual(done.returncode, status, done.stderr)
            self.assertEqual(len(re.findall(r"^tetracubes: ", done.stderr, re.MULTILINE)), 1, done.stderr)
            self.assertRegex(done.stderr, says)
        self.expect_nothing_left(before, "usage")

    def test_help(self):
        done = self.ranks(2, "extract", "--help")
        self.assertEqual((done.returncode, done.stdout.count("--max-memory")), (0, 1))
        self.assertIn("%r stands for", done.stdout)


if __name__ == "__main__":
    if not shutil.which(GIVEN["mpirun"]):
        print("no mpirun: ranks were not tried")
        sys.exit(77)
    tool_case.main()
