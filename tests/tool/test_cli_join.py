#!/usr/bin/env python3
"""test_cli_join.py TOOL [reference] - parts of a surface, extract --part I/N, and the mesh that join makes of them

What is joined is compared with the file that one process writes, every byte: methods, formats, normals, carried fields,
missing data, more parts than layers. Then parts that do not belong together, and files that are cut short or changed.
"""
import os
import random
import resource
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from grid_files import lattice, vti_text, vts_text
from tool_case import GridCase

FORMATS = ("ply", "vtp", "stl")


def read(path):
    with open(path, "rb") as file:
        return file.read()


class JoinCase(GridCase):
    def parts(self, count, *arguments, name="p"):
        """The files of all parts."""
        paths = [self.path(f"{name}{number}.tcpart") for number in range(count)]
        for number, path in enumerate(paths):
            self.expect(0, "extract", *arguments, "--part", f"{number}/{count}", "-o", path, "--quiet")
        return paths

    def one(self, ending, *arguments):
        """The bytes that one process writes."""
        self.expect(0, "extract", *arguments, "-o", self.path("one." + ending), "--quiet")
        return read(self.path("one." + ending))

    def joined(self, ending, parts, *more):
        self.expect(0, "join", *parts, "-o", self.path("all." + ending), "--quiet", *more)
        return read(self.path("all." + ending))

    def compare(self, counts, *arguments, formats=FORMATS, seed=1, cut=()):
        chance = random.Random(seed)
        if formats == FORMATS and "VTKHDF" in self.expect(0, "--version").stdout:
            formats = (*FORMATS, "vtkhdf")
        wanted = {ending: self.one(ending, *arguments) for ending in formats}
        for count in counts:
            parts = self.parts(count, *arguments, *cut)
            chance.shuffle(parts)
            for ending in formats:
                self.assertTrue(self.joined(ending, parts) == wanted[ending], f"{arguments}: {count} parts, {ending}")
        return wanted


class Joined(JoinCase):
    def engine(self):
        return ["--engine", "reference"]

    def test_methods(self):
        volume = self.generate("noise", "n.nrrd", "70,19,33", "f32")
        for number, method in enumerate(("tetra", "hybrid", "snap")):
            wanted = self.compare((2, 4), volume, "--iso", "127.5", "--method", method, *self.engine(), seed=number)
            self.assertGreater(len(wanted["ply"]), 50000)

    def test_normals_and_missing_data(self):
        volume = self.generate("gyroid", "g.nrrd", "40,21,29")
        self.compare((3,), volume, "--iso", "127.5", "--nodata", "140", "--normals", *self.engine(),
                     "--max-memory", "20K", formats=("ply", "vtp"))  # parts of several pieces
        self.compare((2,), volume, "--iso", "99", "--closed", *self.engine(), formats=("stl",))

    def test_more_parts_than_layers(self):
        """Parts without planes, and parts that the surface does not reach."""
        volume = self.generate("sphere", "s.nrrd", "15,14,18")
        self.compare((1, 5, 9), volume, "--iso", "200.25", *self.engine())
        self.compare((9,), volume, "--iso", "300", *self.engine())

    def test_far_from_zero(self):
        volume = self.generate("sphere", "s.nrrd", "15,14,18")
        place = [volume, "--iso", "127.5", "--origin", "7e6,-3e6,1e7", *self.engine()]
        self.compare((3,), *place)
        told = self.expect(0, "join", *self.parts(2, *place), "-o", self.path("x.stl"))
        self.assertIn("relative to 7000000,-3000000,10000000", told.stderr)
        at = ["--origin-at", "7000000,-3000000,9999999"]
        self.assertEqual(self.joined("ply", self.parts(2, *place), *at), self.one("ply", *place, *at))

    def test_carried_fields(self):
        self.needs_xml()
        dims = (9, 8, 13)
        points = lattice(dims)
        fields = [("f", "f32", [(x - 4) ** 2 + (y - 4) ** 2 + (z - 6) ** 2 + 0.3 for x, y, z in points]),
                  ("two words", "f64", [x * 0.1 + z for x, y, z in points]),
                  ("v", "i16", [n for x, y, z in points for n in (x, y, z)], 3)]
        volume = self.write("v.vti", vti_text(dims, fields))
        self.compare((1, 3), volume, "--field", "f", "--iso", "9", "--carry", "two words,v", *self.engine(),
                     formats=("ply", "vtp"))
        parts = self.parts(2, volume, "--field", "f", "--iso", "9", "--carry", "v", *self.engine())
        self.refuses(2, "join", *parts, "-o", self.path("x.stl"), says="holds no fields")

    def test_curvilinear(self):
        self.needs_xml()
        dims = (7, 6, 15)
        points = lattice(dims)
        for number, bend in enumerate((0.02, 0.03)):
            places = [(x + bend * y * z, y - bend * x * x, z + bend * x * y) for x, y, z in points]
            values = [(x - 3) ** 2 + (y - 3) ** 2 + (z - 7) ** 2 + 0.3 for x, y, z in points]
            volume = self.write(f"c{number}.vts", vts_text(dims, places, [("f", "f32", values)]))
            self.compare((3,), volume, "--iso", "9", *self.engine(), formats=("vtp",))
            parts = self.parts(2, volume, "--iso", "9", *self.engine(), name=f"c{number}-")
        self.refuses(4, "join", self.path("c0-0.tcpart"), parts[1], "-o", self.path("x.ply"), says="another volume")

    def test_space_and_units(self):
        """What a file says of its space stands in the files made."""
        head = b"NRRD0005\ntype: uint8\ndimension: 3\nsizes: 5 5 9\nspace: left-posterior-superior\n" \
               b"space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n" \
               b'space units: "mm" "mm" "mm"\nencoding: raw\n\n'
        volume = self.write("w.nrrd", head + bytes(x * y + 8 * z for x, y, z in lattice((5, 5, 9))))
        wanted = self.compare((2,), volume, "--iso", "33.5", *self.engine(), formats=("vtp",))
        self.assertIn(b'Name="SPACE"', wanted["vtp"])

    def test_isovalues(self):
        volume = self.generate("sphere", "s.nrrd", "15,14,18")
        isovalues = ("100", "0x1.8p7")
        for number in range(2):
            self.expect(0, "extract", volume, "--iso", ",".join(isovalues), *self.engine(), "--part", f"{number}/2",
                        "-o", self.path(f"p{number}-%.part"), "--quiet")
        for iso in isovalues:
            parts = [self.path(f"p{number}-{iso}.part") for number in (1, 0)]
            self.assertEqual(self.joined("ply", parts), self.one("ply", volume, "--iso", iso, *self.engine()))

    def test_cut(self):
        """Parts of planes that are named, one of them empty."""
        volume = self.generate("noise", "n.nrrd", "20,19,18", "f32")
        how = [volume, "--iso", "127.5", *self.engine()]
        for cut in ("12", "4,4,16", "0,8,18"):
            self.compare((cut.count(",") + 2,), *how, "--method", "snap", cut=["--cut", cut], formats=("ply", "stl"))
        part = self.report("extract", *how, "--cut", "4,4,16", "--part", "2/4", "-o", self.path("x"))
        self.assertEqual((part["part"], part["planes"]), ([2, 4], [4, 16]))

    def test_report(self):
        volume = self.generate("sphere", "s.nrrd", "15,14,18")
        parts = self.parts(3, volume, "--iso", "100", *self.engine())
        whole = self.report("extract", volume, "--iso", "100", *self.engine())["surfaces"][0]
        report = self.report("join", *parts, "-o", self.path("x.ply"))
        self.assertEqual((report["parts"], report["vertices"], report["triangles"]),
                         (3, whole["vertices"], whole["triangles"]))
        self.assertRegex(self.expect(0, "join", *parts, "-o", self.path("x.ply")).stdout, "triangles of 3 parts")
        part = self.report("extract", volume, "--iso", "100", *self.engine(), "--part", "1/3", "-o", parts[1])
        self.assertEqual((part["part"], part["planes"]), ([1, 3], [4, 12]))
        told = self.expect(0, "extract", volume, "--iso", "100", *self.engine(), "--part", "2/3", "-o", parts[2])
        self.assertIn("part 2 of 3: planes 12 to 17", told.stdout)


class OnDevice(Joined):
    """The same parts by the device; one of each kind is enough."""

    def engine(self):
        self.needs_device()
        return ["--max-memory", "1M"]

    def test_methods(self):
        volume = self.generate("noise", "n.nrrd", "70,19,17", "f32")
        reference = self.parts(2, volume, "--iso", "127.5", "--engine", "reference", name="r")
        device = self.parts(2, volume, "--iso", "127.5", *self.engine(), name="d")
        self.assertEqual(list(map(read, device)), list(map(read, reference)))
        self.assertEqual(self.joined("ply", [reference[0], device[1]]), self.one("ply", volume, "--iso", "127.5"))

    test_normals_and_missing_data = test_more_parts_than_layers = test_far_from_zero = None
    test_carried_fields = test_curvilinear = test_space_and_units = test_isovalues = test_cut = test_report = None


class Refused(JoinCase):
    def setUp(self):
        super().setUp()
        self.volume = self.generate("sphere", "s.nrrd", "15,14,18")
        self.how = [self.volume, "--iso", "100", "--engine", "reference"]
        self.good = self.parts(3, *self.how)

    def refused(self, parts, says, status=4):
        for ending in ("ply", "stl"):
            self.refuses(status, "join", *parts, "-o", self.path("x." + ending), says=says)

    def test_not_all_of_one_surface(self):
        good, how = self.good, self.how
        self.refused(good[:2], "number 2 is missing")
        self.refused([good[2]], "number 0 to 1 is missing")
        self.refused([*good, good[1]], "part 1 of 3 is given twice")
        [other] = self.parts(1, *how, name="n")
        self.refused([good[0], other, good[2]], "one of 1 parts, .* one of 3")
        others = {"isovalue": [self.volume, "--iso", "100.00000000000001", *how[3:]],
                  "method": [*how, "--method", "hybrid"], "channels": [*how, "--normals"],
                  "nodata": [*how, "--nodata", "7"]}
        for key, arguments in others.items():
            other = self.parts(3, *arguments, name="o")
            self.refused([good[0], other[1], good[2]], f'"{key}" is ')
            self.refused([other[0], *good[1:]], f'"{key}" is ')
        volume = self.generate("torus", "t.nrrd", "15,14,18")
        self.refused([self.parts(3, volume, *how[1:], name="v")[0], *good[1:]], "another volume")
        cut = self.parts(3, *how, "--cut", "8,12", name="c")
        self.refused([good[0], *cut[1:]], "begins at plane 8, but .* ends at 4: parts of one surface need one --cut")
        moved = self.parts(3, *how, "--spacing", "1,1,2", name="m")
        self.refused([moved[0], *good[1:]], "another volume")

    def changed(self, number, change):
        data = bytearray(read(self.good[number]))
        new = change(data)
        data = data if new is None else new
        with open(self.path("changed"), "wb") as file:
            file.write(data)
        return [self.path("changed") if n == number else path for n, path in enumerate(self.good)]

    def test_other_versions(self):
        version = self.expect(0, "--version").stdout.split()[1].encode()
        other = version[:-1] + (b"9" if version[-1:] != b"9" else b"8")
        self.refused(self.changed(1, lambda d: d.replace(b'"version": "' + version, b'"version": "' + other)),
                     '"version" is')
        self.refused(self.changed(1, lambda d: d.replace(b'_part": 1', b'_part": 2')), "version 2; .* joins version 1")

    def test_damage(self):
        size = len(read(self.good[1]))
        chance = random.Random(3)
        for length in (0, 1, 30, 200, size // 2, size - 1):
            self.refused(self.changed(1, lambda d: d[:length]), "cut short|no part of a surface|empty")
        self.refused(self.changed(1, lambda d: d + b"x"), "too long")
        self.refused([self.good[0], self.volume, self.good[2]], "no part of a surface")
        line = read(self.good[1]).index(b"\n")
        places = [3, 60, line - 1, line, line + 1, size - 70, size - 1]
        for place in [*places, *(chance.randrange(size) for _ in range(12))]:
            def flip(data):
                data[place] ^= 1 << chance.randrange(8)
            self.refused(self.changed(1, flip), "damaged|no part of a surface|cut short|too long|no parts of one|"
                                                "another volume|number|twice|version")

    def test_hostile_headers(self):
        """Numbers that no part has, with a file of any length."""
        for old, new in ((b'"vertices": ', b'"vertices": 9'), (b'"vertices": ', b'"vertices": -'),
                         (b'"triangles": ', b'"triangles": 99999999'), (b'"part": [1', b'"part": [9'),
                         (b'"planes": [4', b'"planes": [0'), (b'"dims": [15', b'"dims": [15, 1'),
                         (b'["positions"]', b'["normals"]'), (b'["positions"]', b'[]'), (b'["positions"]', b'3'),
                         (b'"carried": []', b'"carried": [["a", 0]]'), (b'"carried": []', b'"carried": [["a", 1e9]]'),
                         (b'"surface"', b'"surfac"'), (b'"origin": [', b'"origin": [1, '), (b"{", b"{{"),
                         (b'"carried": []', b'"carried": [[3, 1]]')):
            self.assertIn(old, read(self.good[1]))

            def change(data):
                head, rest = data.split(b"\n", 1)
                head = head.replace(old, new, 1).rstrip()
                return head + b" " * (63 - len(head) % 64) + b"\n" + rest
            self.refused(self.changed(1, change), "damaged|need one --cut|cut short|too long|no parts of one|no part of a surface")

    def test_usage(self):
        out, how = self.path("x.part"), self.how
        for part in ("3/3", "-1/3", "1", "a/b", "1/0", "0/1/2", "0/99999999999"):
            self.refuses(2, "extract", *how, "--part", part, "-o", out, says="no part I of N")
        for more, says in ((["--count"], "makes no mesh"), (["--part", "0/2"], "give -o FILE"),
                           (["-o", out, "--format", "ply"], "give it to 'tetracubes join'"),
                           (["-o", out, "--origin-at", "0,0,0"], "give it to 'tetracubes join'"),
                           (["-o", "-"], "name a file"), (["-o", out, "--check"], "made in parts.*whole mesh"),
                           (["-o", out, "--soup"], "made in parts"), (["-o", out, "--verify"], "made in parts|--verify"),
                           (["-o", self.volume], "input itself")):
            self.refuses(2, "extract", *how, *(["--part", "1/2"] if "--part" not in more else []), *more, says=says)
        for cut, says in (("x", "neither even nor cost, nor planes"), ("4,", "neither even"), ("-4", "neither even"),
                          ("", "neither even"), ("4,8", "names 2 planes, where all but the first of 3 parts begin"),
                          ("6", "6 is no multiple of 4, as layers are: give 4"), ("20", "20 is not from 0 to 18"),
                          ("cost", "for ranks, which count together")):
            self.refuses(2, "extract", *how, "--part", "1/2", "--cut", cut, "-o", out, says=says)
        self.refuses(2, "extract", *how, "--part", "1/3", "--cut", "8,4", "-o", out, says="plane 4 is not from 8 to 18")
        for cut in ("even", "cost", "4"):
            self.refuses(2, "extract", *how, "--cut", cut, "-o", self.path("x.ply"), says="--cut says where ranks or parts begin")
        self.refuses(2, "join", *self.good, says="needs -o")
        self.refuses(2, "join", "-o", self.path("x.ply"), says="needs the files of all parts")
        self.refuses(2, "join", *self.good, "-o", self.path("x.obj"), says="cannot be written piece by piece")
        self.refuses(2, "join", *self.good, "-o", self.good[0], "--format", "ply", says="input itself")
        for more in ([], ["--format", "ply"]):
            self.refuses(2, "join", *self.good, "-o", "-", *more, says=r"is no file: .* many places .* \.ply, \.vtp, \.stl")
        for more in (["x.obj"], ["x", "--format", "off"]):
            self.refuses(2, "join", *self.good, "-o", *more, says="piece by piece, .* write ply, vtp, stl( or vtkhdf)?$")
        for more, says in ((["x.vrml"], "end in .ply, .vtp, .stl( or .vtkhdf)?, or name"),
                           (["x", "--format", "vrml"], "written as ply, vtp, stl( or vtkhdf)?$")):
            self.refuses(2, "join", *self.good, "-o", *more, says=says)
        self.refuses(4, "join", self.path("none"), "-o", self.path("x.ply"), says="none")

    def test_other_grids(self):
        self.needs_xml()
        cells = self.write_hexahedra("c.vtu")
        self.refuses(2, "extract", cells, "--field", "bump", "--iso", "2.5", "--part", "0/2", "-o", self.path("x.part"),
                     "--engine", "reference", says="made in parts .* unstructured")

    def test_full_disk(self):
        """No file appears, and none is left under another name."""
        before = self.files()
        for words in (["join", *self.good, "-o", self.path("x.ply")],
                      ["extract", *self.how, "--part", "1/3", "-o", self.path("x.part")]):
            done = subprocess.run([tool_case.TOOL, *words], stderr=subprocess.PIPE, text=True, check=False,
                                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000)))
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertRegex(done.stderr, "cannot be written: File too large")
            self.assertEqual(self.files(), before)


if __name__ == "__main__":
    tool_case.main()
