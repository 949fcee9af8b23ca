#!/usr/bin/env python3
"""test_cli_effects.py TOOL [reference] - options without effect, reports true of what is written, standard input

Every row of the table of host/tool/command_line/option_effects.c has a case here, which the test finds in the source.
Figures of reports are compared with files read back by code of the tests. Standard library only.
"""
import gzip
import json
import os
import re
import shutil
import signal
import struct
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from grid_files import HEXAHEDRON, hexahedra, lattice, vti_text, vtu_text
from meshes import ply_read
from tool_case import GridCase

SOURCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "host", "tool", "command_line",
                      "option_effects.c")
RAW = ["--dims", "8,8,8", "--type", "u8"]
VALUES = {"--output": ["a.ply"], "--format": ["ply"], "--blocks": ["joined"], "--carry": ["a"], "--origin-at": ["0,0,0"],
          "--device": ["cpu"], "--max-memory": ["1G"], "--type": ["u8"], "--endian": ["big"], "--skip": ["0"],
          "--method": ["snap"], "--nodata": ["3"], "--component": ["0"], "--seed": ["3"], "--timeout": ["0"],
          "--roi": [":,:,:"], "--roi-world": [":,:,:"], "--step": ["1"], "--mask": ["u8.nrrd"],
          "--snap": ["0.3"], "--part": ["0/2"], "--preview": ["a.png"], "--view": ["top"], "--preview-size": ["40,30"], "--iso": ["100"],
          "--simplify": ["0.5"], "--simplify-error": ["1"]}
REFERENCE = ["--engine", "reference"]

# Per case of the source: command, operand, more arguments. That of the option itself is added.
CASES = {
    "has_no_mesh": ("extract", "u8.nrrd", ["--iso", "100", "--count"]),
    "has_no_output": ("extract", "u8.nrrd", ["--iso", "100", *REFERENCE]),
    "has_no_file": ("extract", "u8.nrrd", ["--iso", "100", *REFERENCE]),
    "has_no_file_nor_reference": ("extract", "u8.nrrd", ["--iso", "100", *REFERENCE]),
    "makes_part": ("extract", "u8.nrrd", ["--iso", "100", *REFERENCE, "-o", "a.part", "--part", "0/2"]),
    "has_no_preview": ("info", "u8.nrrd", []),
    "has_only_cells": ("info", "cells.vtu", []),
    "file_has_no_normals": ("extract", "u8.nrrd", ["--iso", "100", *REFERENCE, "-o", "a.stl"]),
    "has_no_main_engine": ("extract", "u8.nrrd", ["--iso", "100", *REFERENCE]),
    "has_no_device": ("extract", "u8.nrrd", ["--iso", "100", *REFERENCE]),
    "has_no_device_nor_stream": ("extract", "u8.nrrd", ["--iso", "100", *REFERENCE]),
    "is_not_snap": ("extract", "u8.nrrd", ["--iso", "100", *REFERENCE]),
    "is_not_simplified": ("extract", "u8.nrrd", ["--iso", "100", *REFERENCE]),
    "is_not_raw": ("info", "u8.nrrd", []),
    "has_bytes": ("info", "u8.raw", RAW),
    "is_not_noise": ("generate", "sphere", [*RAW, "-o", "new.nrrd"]),
    "has_no_time": ("selftest", None, []),
    "has_cells": ("extract", "cells.vtu", ["--iso", "100", "--field", "f", *REFERENCE, "-o", "a.ply"]),
    "is_whole_of_cells": ("extract", "cells.vtu", ["--iso", "100", "--field", "f", *REFERENCE, "--method", "hybrid"]),
    "is_snap_of_cells": ("extract", "cells.vtu", ["--iso", "100", "--field", "f", *REFERENCE]),
    "has_world_range": ("extract", "u8.nrrd", ["--iso", "100", *REFERENCE, "--roi-world", ":,:,:"]),
    "is_everything": ("extract", "u8.nrrd", ["--iso", "100", *REFERENCE]),
    "has_no_cells": ("tetrahedralize", "u8.nrrd", ["-o", "new.vtu"]),
}
OPEN = {"COMMAND_TETRAHEDRALIZE": ("tetrahedralize", "two.vti", ["-o", "new.vtu"]), "COMMAND_INFO": ("info", "two.vti", [])}
ROW = re.compile(r'{([A-Z_| ]+), "(--[a-z-]+)", (BEFORE|AFTER)_READING, (\w+), (REFUSED|TOLD),\s')


def nifti(sizes=(1, 1, 1)):
    """8 x 8 x 8 bytes, a ramp along x, with these voxel sizes."""
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, 8, 8, 8, 1, 1, 1, 1)
    struct.pack_into("<2h", header, 70, 2, 8)
    struct.pack_into("<8f", header, 76, 1, *sizes, 1, 1, 1, 1)
    struct.pack_into("<f", header, 108, 352)
    header[344:348] = b"n+1\0"
    return bytes(header) + bytes(n % 8 for n in range(512))


class Effects(GridCase):
    def setUp(self):
        super().setUp()
        self.generate("sphere", "u8.nrrd", "8,8,8")
        self.generate("sphere", "u8.raw", "8,8,8")
        values = [float(n) for n in range(64)]
        self.write("two.vti", vti_text((4, 4, 4), [("f", "f32", values), ("g", "f32", values)]))
        self.write("cells.vtu", vtu_text(lattice((4, 4, 4)), hexahedra((4, 4, 4)), [HEXAHEDRON] * 27,
                                         [("f", "f32", [8 * value for value in values])]))

    def test_every_row(self):
        with open(SOURCE, encoding="ascii") as file:
            rows = ROW.findall(file.read())
        self.assertGreater(len(rows), 30)
        before = set(self.files())
        for commands, option, _, case, verdict in rows:
            command, operand, more = OPEN[commands] if case == "has_no_field" else CASES[case]
            if command == "info" and commands == "COMMAND_EXTRACT":
                command, more = "extract", ["--iso", "100", *REFERENCE]
            words = [command, *([operand] if operand else []), *more, option, *VALUES.get(option, [])]
            with self.subTest(words=words):
                if verdict == "REFUSED":
                    result = self.expect(2, *words, cwd=self.folder.name, says=f"{option}\\b")
                    self.assertEqual(set(self.files()), before)
                    continue
                told = self.expect(0, *words, cwd=self.folder.name, says=f"^tetracubes: .*{option}\\b").stderr
                self.assertEqual(len(told.splitlines()), 1, told)
                quiet = self.expect(0, *words, "--quiet", cwd=self.folder.name)
                self.assertEqual(quiet.stderr, "")
                if command != "generate":
                    report = self.report(*words, cwd=self.folder.name)
                    self.assertEqual(["tetracubes: " + text for text in report["notices"]], told.splitlines())
                for name in set(self.files()) - before:
                    os.unlink(self.path(name))

    def test_no_word_where_there_is_an_effect(self):
        out = self.path("o.ply")
        volume, cells, two = map(self.path, ("u8.nrrd", "cells.vtu", "two.vti"))
        for words in (["extract", volume, "--iso", "100", *REFERENCE, "--normals", "--soup", "--origin-at", "1,2,3",
                       "--format", "obj", "--blocks", "joined", "-o", out],
                      ["extract", volume, "--iso", "100", *REFERENCE, "--soup", "-o", self.path("o.stl")],
                      ["extract", cells, "--iso", "100", *REFERENCE, "--skip-unsupported", "--method", "tetra"],
                      ["tetrahedralize", two, "--field", "f", "--nodata", "3", "-o", self.path("o.vtu")],
                      ["info", two, "--field", "f", "--nodata", "3"],
                      ["info", self.path("u8.raw"), "--dims", "4,8,8", "--type", "u16", "--endian", "big"],
                      ["generate", "noise", "--seed", "3", *RAW, "-o", self.path("o.nrrd")]):
            self.assertNotIn("--", self.expect(0, *words).stderr, words)


class Reports(GridCase):
    def test_vertices_of_a_soup(self):
        volume = [self.generate("sphere", "a.nrrd")]
        shared = self.extract(volume, "100")["surfaces"][0]
        soup = self.extract(volume, "100", "--soup", "--check", "-o", self.path("o.ply"))["surfaces"][0]
        _, _, rows, triangles, _ = ply_read(self.path("o.ply"))
        self.assertEqual((soup["vertices"], soup["triangles"]), (len(rows), len(triangles)))
        self.assertEqual(soup["vertices"], 3 * shared["triangles"])
        self.assertEqual((soup["shared_vertices"], soup["hash"]), (shared["vertices"], shared["hash"]))
        self.assertEqual(soup["euler_characteristic"], 2)
        self.assertNotIn("shared_vertices", shared)
        text = self.expect(0, "extract", *volume, "--iso", "100", *REFERENCE, "--soup", "-o", self.path("o.ply")).stdout
        self.assertRegex(text, rf"mesh +{len(rows)} vertices, {len(triangles)} triangles")
        self.assertRegex(text, rf"soup .* {shared['vertices']} shared")
        alone = self.extract(volume, "100", "--soup")["surfaces"][0]
        self.assertEqual(alone["vertices"], shared["vertices"])

    def test_open_surfaces_have_no_volume(self):
        volume = [self.generate("sphere", "a.nrrd")]
        for iso, is_closed in (("100", True), ("40", False)):
            surface = self.extract(volume, iso, "--check")["surfaces"][0]
            self.assertEqual(surface["boundary_edges"] == 0, is_closed)
            self.assertEqual(surface["volume"] is not None, is_closed)
            text = self.expect(0, "extract", *volume, "--iso", iso, *REFERENCE, "--check").stdout
            self.assertRegex(text, r", volume [0-9.]+\n" if is_closed else r", open: no volume\n")

    def test_surfaces_without_an_outside_have_no_volume(self):
        """Two cubes that share four points but wind against each other: a surface through both is not oriented."""
        points = [(x, y, z) for z in range(4) for y in range(3) for x in range(3)]
        cells = hexahedra((3, 3, 4))
        folded = [(cell[4:] + cell[:4]) for cell in cells[:4]] + cells[4:]
        values = [10.0 if p == (1, 1, 1) or p == (1, 1, 2) else 0.0 for p in points]
        volume = [self.write("f.vtu", vtu_text(points, [*folded, cells[0]], [HEXAHEDRON] * 13, [("f", "f32", values)]))]
        result = tool_case.tool("extract", *volume, "--iso", "5", *REFERENCE, "--check", "--json")
        surface = json.loads(result.stdout)["surfaces"][0]
        self.assertGreater(surface["boundary_edges"] + surface["misoriented_edges"] + surface["nonmanifold_edges"], 0)
        self.assertIsNone(surface["volume"])

    def test_info_is_as_quiet_as_extract(self):
        volume = self.raw("c.raw", "u8", (4, 4, 4), [7] * 64)
        loud = self.expect(0, "info", *volume, says="^tetracubes: .*constant")
        self.assertNotIn("constant", loud.stdout)
        quiet = self.expect(0, "info", *volume, "--quiet")
        self.assertEqual((quiet.stdout, quiet.stderr), ("", ""))
        both = self.expect(0, "info", *volume, "--quiet", "--json")
        self.assertEqual(both.stderr, "")
        self.assertRegex(json.loads(both.stdout)["notices"][0], "constant")

    def test_notices_of_readers_are_no_results(self):
        with open(self.path("a.nrrd"), "wb") as file:
            file.write(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nspacings: 1 nan 1\nencoding: raw\n\n"
                       + bytes(range(8)))
        result = self.expect(0, "info", self.path("a.nrrd"), says="^tetracubes: .*spacing along axis 2 is not known")
        self.assertNotIn("not known", result.stdout)
        self.assertIn("format        NRRD", result.stdout)


class Numbers(GridCase):
    """What people may type back reads back as the same number."""

    def test_voxel_sizes_of_notices(self):
        if "NIfTI" not in self.expect(0, "--version").stdout:
            self.skipTest("no NIfTI")
        with open(self.path("a.nii"), "wb") as file:
            file.write(nifti((0.123456789, float("nan"), 1234567.875)))
        told = self.expect(0, "info", self.path("a.nii"), says="voxel sizes").stderr
        given, taken = re.search("voxel sizes (.*) \\(pixdim\\) are taken for (.*)\n", told).groups()
        expected = [struct.unpack("<f", struct.pack("<f", size))[0] for size in (0.123456789, 1.0, 1234567.875)]
        read = [struct.unpack("<f", struct.pack("<f", float(word)))[0] for word in taken.split()]
        self.assertEqual((given.split()[1], read), ("nan", expected))

    def test_isovalues_of_trials(self):
        self.needs_device()
        with open(self.path("v.txt"), "w") as file:
            file.write("sphere 16 16 16 f32 100.0000001 tetra - 1 1 0123456789abcdef\n")
        result = tool_case.tool("selftest", "--vectors", self.path("v.txt"))
        self.assertEqual(result.returncode, 3, result)
        self.assertIn("isovalue 100.0000001,", result.stdout)


class Carried(GridCase):
    def told(self, kind, values, components=1):
        count = 125
        ramp = [float(n % 5) for n in range(count)]
        grid = self.write("c.vti", vti_text((5, 5, 5), [("f", "f32", ramp), ("g", kind, values, components)]))
        return self.notices([grid], "1.5", "--field", "f", "--carry", "g", "-o", self.path("o.vtp"))

    def test_constant_fields(self):
        for kind, value in (("f64", 0.1), ("f32", 0.5), ("u8", 7), ("i32", -3), ("f64", float("-1e-300"))):
            self.assertEqual(self.told(kind, [value] * 125), [f"field 'g' is constant: every value is {value!r}"])
        [told] = self.told("f32", [0.0, 0.0, 1.0] * 125, 3)
        self.assertRegex(told, "every point has the same 3 values")
        self.assertEqual(self.told("f32", [x for n in range(125) for x in (0.0, 0.0, float(n))], 3), [])

    def test_fields_that_float32_makes_constant(self):
        for values in ([1e9 + n / 100 for n in range(125)], [(1 + n) * 1e-50 for n in range(125)],
                       [-5.0 - n * 1e-15 for n in range(125)]):
            [told] = self.told("f64", values)
            self.assertRegex(told, "field 'g' is carried as float32, which has steps of")
            low, high = (float(word) for word in re.search(r"values, (\S+) to (\S+), differ", told).groups())
            self.assertEqual((low, high), (min(values), max(values)))

    def test_fields_that_vary(self):
        self.assertEqual(self.told("f64", [n / 7 for n in range(125)]), [])
        self.assertEqual(self.told("f32", [n / 7 for n in range(125)]), [])
        self.assertEqual(self.told("u8", [n for n in range(125)]), [])


class WideIntegers(GridCase):
    """64-bit integers become doubles: a notice tells where that changes a field that is used, or the isovalue."""

    def both(self, last):
        """An image as VTK XML and as VTK legacy, with a plain field and one of 64-bit integers."""
        plain, wide = [n % 3 for n in range(27)], [n % 3 for n in range(26)] + [last]
        arrays = "".join(f'<DataArray type="{kind}" Name="{name}">{" ".join(map(str, values))}</DataArray>'
                         for name, kind, values in (("f", "UInt8", plain), ("ids", "Int64", wide)))
        xml = self.write("a.vti", '<VTKFile type="ImageData"><ImageData WholeExtent="0 2 0 2 0 2"><Piece '
                                  f'Extent="0 2 0 2 0 2"><PointData>{arrays}</PointData></Piece></ImageData></VTKFile>')
        legacy = self.write("a.vtk", "# vtk DataFile Version 4.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 3 3"
                                     "\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA 27\nSCALARS f unsigned_char 1\n"
                                     f"LOOKUP_TABLE default\n{' '.join(map(str, plain))}\nSCALARS ids vtktypeint64 1\n"
                                     f"LOOKUP_TABLE default\n{' '.join(map(str, wide))}\n")
        return [legacy, xml] if "VTK XML" in self.expect(0, "--version").stdout else [legacy]

    def test_fields(self):
        rounds = ["field 'ids' has 64-bit integers that no double holds: each is taken as the nearest double"]
        for last, expected in ((2 ** 53 + 1, rounds), (2 ** 60, []), (2 ** 63 - 1, rounds), (5, [])):
            for path in self.both(last):
                self.assertEqual(self.notices([path], "1.5", "--field", "f"), [])
                self.assertEqual(self.notices([path], "1.5", "--field", "ids"), expected)
                self.assertEqual(self.report("info", path)["notices"], expected)
                self.assertEqual(self.report("info", path, "--field", "ids")["notices"], expected)
                cut = self.report("tetrahedralize", path, "--field", "ids", "-o", self.path("o.vtu"))
                self.assertEqual(cut["notices"], expected)
                cut = self.report("tetrahedralize", path, "-o", self.path("o.vtu"))
                self.assertEqual(cut["notices"], expected)

    def test_isovalues(self):
        [path] = self.both(2 ** 60)[:1]
        for typed, taken in (("9007199254740993", "9007199254740992"), ("+009007199254740993", "9007199254740992"),
                             ("-9007199254740993", "-9007199254740992"), ("9007199254740992", None), ("1", None),
                             ("-0", None), ("00", None), ("1152921504606846976", None), ("0.1", None), ("1e23", None)):
            told = [text for text in self.notices([path], typed, "--field", "ids") if "taken as" in text]
            self.assertEqual(told, [f"isovalue {typed} is taken as {taken}, the nearest double"] if taken else [])


class StandardInput(GridCase):
    def pipe(self, status, data, *words, says="^"):
        run = subprocess.run([tool_case.TOOL, *words], input=data, capture_output=True, timeout=600, cwd=self.folder.name)
        self.assertEqual(run.returncode, status, run)
        self.assertRegex(run.stderr.decode(), says)
        return run.stdout

    def same(self, name, iso, *more):
        with open(self.path(name), "rb") as file:
            data = file.read()
        expected = self.extract([self.path(name)], iso, *more)["surfaces"][0]
        words = ["extract", "-", "--iso", iso, *REFERENCE, "--json", *more, "-o", "o.ply"]
        surface = json.loads(self.pipe(0, data, *words))["surfaces"][0]
        self.assertEqual(surface["hash"], expected["hash"])
        self.assertEqual(len(ply_read(self.path("o.ply")).rows), expected["vertices"])
        with open(self.path(name), "rb") as file:  # a file that the shell has opened
            run = subprocess.run([tool_case.TOOL, *words], stdin=file, capture_output=True, cwd=self.folder.name)
        self.assertEqual(json.loads(run.stdout)["surfaces"][0]["hash"], expected["hash"], run)

    def test_formats(self):
        values = [float(n % 16) for n in range(4096)]
        self.generate("sphere", "a.nrrd")
        self.same("a.nrrd", "100")
        self.generate("sphere", "a.raw", "20,19,18", "u16")
        self.same("a.raw", "100", "--dims", "20,19,18", "--type", "u16", "--spacing", "1,2,3")
        self.write("a.vti", vti_text((16, 16, 16), [("f", "f32", values)]))
        self.same("a.vti", "3.5")
        cells = hexahedra((4, 4, 4))
        self.write("a.vtu", vtu_text(lattice((4, 4, 4)), cells, [HEXAHEDRON] * len(cells), [("f", "f32", values[:64])]))
        self.same("a.vtu", "3.5")
        head = "# vtk DataFile Version 3.0\nx\n{}\nDATASET STRUCTURED_POINTS\nDIMENSIONS 64 64 64\nORIGIN 0 0 0\n" \
               "SPACING 1 1 1\nPOINT_DATA 262144\nSCALARS f unsigned_char 1\nLOOKUP_TABLE default\n"
        with open(self.path("a.vtk"), "wb") as file:  # large enough to be used where it lies
            file.write(head.format("BINARY").encode() + bytes(n % 64 for n in range(64 ** 3)))
        self.same("a.vtk", "3.5")
        with open(self.path("a.mha"), "wb") as file:
            file.write(b"NDims = 3\nDimSize = 8 8 8\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
                       + bytes(n % 8 for n in range(512)))
        self.same("a.mha", "3.5")
        if "NIfTI" in self.expect(0, "--version").stdout:
            for name, data in (("a.nii", nifti()), ("a.nii.gz", gzip.compress(nifti()))):
                with open(self.path(name), "wb") as file:
                    file.write(data)
                self.same(name, "3.5")

    def test_other_commands(self):
        self.generate("sphere", "a.nrrd")
        with open(self.path("a.nrrd"), "rb") as file:
            data = file.read()
        facts = json.loads(self.pipe(0, data, "info", "-", "--json"))
        self.assertEqual((facts["input"], facts["dims"]), ("-", [20, 19, 18]))
        self.pipe(0, data, "tetrahedralize", "-", "-o", "o.vtu", "--quiet")
        expected = self.path("e.vtu")
        self.expect(0, "tetrahedralize", self.path("a.nrrd"), "-o", expected, "--quiet")
        with open(expected, "rb") as one, open(self.path("o.vtu"), "rb") as other:
            self.assertEqual(one.read(), other.read())

    def test_refusals(self):
        self.pipe(4, b"", "info", "-", says="standard input is empty")
        self.pipe(4, b"what", "info", "-", says="format is not known")
        self.pipe(2, b"", "info", "-", "-", says="Plot3D grid and its solution: give the names")
        self.pipe(2, b"", "info", "a.xyz", "-", says="Plot3D grid and its solution: give the names")
        head = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: x.raw\n\n"
        self.pipe(4, head, "info", "-", says="names a data file, 'x.raw', and nothing lies beside standard input")
        mhd = b"NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = x.raw\n"
        self.pipe(4, mhd, "info", "-", says="names a data file, 'x.raw', and nothing lies beside standard input")
        self.pipe(4, bytes(7), "info", "-", "--dims", "2,2,2", "--type", "u8", says="7 bytes")
        volume = self.generate("sphere", "a.nrrd")
        with open(volume, "rb") as file:
            run = subprocess.run([tool_case.TOOL, "extract", "-", "--iso", "1", *REFERENCE, "-o", volume, "--format",
                                  "ply"], stdin=file, capture_output=True, text=True)
        self.assertEqual(run.returncode, 2, run)
        self.assertRegex(run.stderr, "name another file")
        self.assertEqual(self.files(), ["a.nrrd"])

    def test_terminal(self):
        master, slave = os.openpty()
        run = subprocess.run([tool_case.TOOL, "info", "-"], stdin=slave, capture_output=True, text=True)
        os.close(master)
        os.close(slave)
        self.assertEqual(run.returncode, 2, run)
        self.assertRegex(run.stderr, "standard input is a terminal")

    def by_name(self, status, data, name, *words, says="^"):
        """The words with a FIFO of that name, into which data is written."""
        os.mkfifo(self.path(name))
        with subprocess.Popen(["sh", "-c", f"cat > {name}"], cwd=self.folder.name, stdin=subprocess.PIPE) as writer, \
                subprocess.Popen([tool_case.TOOL, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                 cwd=self.folder.name) as run:
            writer.stdin.write(data)
            writer.stdin.close()
            out, err = run.communicate(timeout=600)
        os.remove(self.path(name))
        self.assertEqual(run.returncode, status, err)
        self.assertRegex(err.decode(), says)
        return out

    def test_pipes_by_name(self):
        volume = self.generate("noise", "a.nrrd", "64,40,30", "f32")  # more than a pipe holds
        with open(volume, "rb") as file:
            data = file.read()
        expected = self.extract([volume], "100")["surfaces"][0]["hash"]
        words = ["--iso", "100", *REFERENCE, "--json"]
        runs = [self.by_name(0, data, "pipe", "extract", "pipe", *words)]
        for name in ("/dev/stdin", "/dev/fd/0"):
            runs.append(self.pipe(0, data, "extract", name, *words))
            with open(volume, "rb") as file:
                run = subprocess.run([tool_case.TOOL, "extract", name, *words], stdin=file, capture_output=True)
            runs.append(run.stdout)
        for text in runs:
            self.assertEqual(json.loads(text)["surfaces"][0]["hash"], expected)

    def test_process_substitution(self):
        if not os.path.exists("/dev/fd/0") or not shutil.which("bash"):
            self.skipTest("no bash with /dev/fd")
        inputs = self.write_plot3d("p", [((4, 4, 4), lattice((4, 4, 4)), [float(n) for n in range(64)])])
        self.generate("sphere", "a.nrrd", "8,8,8")
        for text in ("<(cat a.nrrd)", "<(sleep 0.3; cat a.nrrd)", "<(cat a.nrrd) --iso 100 < /dev/null",
                     "<(cat p.xyz) <(cat p.q) --field density"):
            arguments = text if "--iso" in text else f"{text} --iso {30 if 'density' in text else 100}"
            run = subprocess.run(["bash", "-c", f'"$0" extract {arguments} --engine reference --json', tool_case.TOOL],
                                 capture_output=True, cwd=self.folder.name, timeout=600)
            self.assertEqual(run.returncode, 0, run)
            self.assertGreater(json.loads(run.stdout)["surfaces"][0]["triangles"], 0, inputs)
        run = subprocess.run(["bash", "-c", '"$0" info <(true)', tool_case.TOOL], capture_output=True, timeout=600)
        self.assertEqual(run.returncode, 4, run)
        self.assertIn(b"the pipe is empty", run.stderr)

    def test_refused_pipes(self):
        head = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: x.raw\n\n"
        self.by_name(4, head, "a.nhdr", "info", "a.nhdr", says="'x.raw', and nothing lies beside a pipe")
        self.pipe(4, head, "info", "/dev/stdin", says="/dev/stdin: names .* nothing lies beside standard input")
        self.by_name(4, b"", "b", "info", "b", says="b: the pipe is empty")
        if "NIfTI" in self.expect(0, "--version").stdout:
            facts = json.loads(self.by_name(0, gzip.compress(nifti()), "c", "info", "c", "--json"))
            self.assertEqual(facts["dims"], [8, 8, 8])
            pair = nifti()[:344] + b"ni1\0"
            self.by_name(4, pair, "d", "info", "d", says="d: is the header of a pair .*beside a pipe")
        self.refuses(4, "info", "/dev/null", says="not a regular file")

    def test_pipe_interrupted(self):
        os.mkfifo(self.path("pipe"))
        with subprocess.Popen([tool_case.TOOL, "info", self.path("pipe")], stderr=subprocess.PIPE) as run:
            with self.assertRaises(subprocess.TimeoutExpired):
                run.wait(timeout=1)
            run.terminate()
            self.assertEqual(run.wait(timeout=60), -signal.SIGTERM)
            self.assertRegex(run.stderr.read().decode(), "cancelled|interrupted")

    def test_interrupted(self):
        with subprocess.Popen([tool_case.TOOL, "info", "-"], stdin=subprocess.PIPE, stderr=subprocess.PIPE) as run:
            run.stdin.write(b"NRRD")
            run.stdin.flush()
            with self.assertRaises(subprocess.TimeoutExpired):
                run.wait(timeout=1)
            run.terminate()
            self.assertEqual(run.wait(timeout=60), -signal.SIGTERM)
            self.assertRegex(run.stderr.read().decode(), "cancelled")


if __name__ == "__main__":
    tool_case.main()
