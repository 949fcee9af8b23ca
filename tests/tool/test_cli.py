#!/usr/bin/env python3
"""test_cli.py TOOL [reference] - the command line: options, files, reports, exit statuses

Runs every command through its contract: exit statuses 0 to 4, the keys of JSON reports, messages that name the culprit,
no partial file after any failure.
"""
import json
import os
import re
import stat
import struct
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from tool_case import Case

SIZES = {"u8": 1, "i8": 1, "u16": 2, "i16": 2, "u32": 4, "i32": 4, "f32": 4, "f64": 8}


class Usage(Case):
    def test_help_and_version(self):
        self.assertRegex(self.expect(0, "--version").stdout, r"^tetracubes \d+\.\d+\.\d+\n")
        overview = self.expect(0, "--help").stdout
        for command in ("extract", "info", "tetrahedralize", "devices", "generate", "selftest"):
            self.assertIn(command, overview)
            own = self.expect(0, command, "--help").stdout
            self.assertIn(f"tetracubes {command}", own)
            self.assertIn("--help", own)
            self.assertEqual(own, self.expect(0, "help", command).stdout)
        fields = self.expect(0, "generate", "--help").stdout
        for field in ("sphere", "torus", "gyroid", "marschner-lobb", "tangle", "noise", "empty", "full"):
            self.assertRegex(fields, rf"(?m)^ +{field} +\S")

    def test_help_fits_a_terminal(self):
        for command in ("extract", "info", "tetrahedralize", "devices", "selftest"):
            for line in self.expect(0, command, "--help").stdout.splitlines():
                self.assertLessEqual(len(line), 100, line)

    def test_commands(self):
        alone = tool_case.tool()
        self.assertEqual((alone.returncode, alone.stdout), (2, ""))
        self.assertIn("tetracubes extract", alone.stderr)
        self.refuses(2, "extrct", says="did you mean extract")
        self.refuses(2, "devcies", says="did you mean devices")
        self.refuses(2, "frobnicate", says="--help")
        self.refuses(2, "help", "gnerate", says="did you mean generate")

    def test_mistyped_options(self):
        self.refuses(2, "extract", "x.nrrd", "--isov", "1", says="did you mean --iso")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--nromals", says="did you mean --normals")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--max-memroy=1G", says="did you mean --max-memory")
        self.refuses(2, "generate", "sphere", "--dim", "2,2,2", says="did you mean --dims")
        self.refuses(2, "devices", "--jsn", says="did you mean --json")
        self.refuses(2, "extract", "x.nrrd", "--isovalue", "1", says="did you mean --iso[?]")
        self.refuses(2, "extract", "x.nrrd", "--ISO", "1", says="did you mean --iso[?]")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "-oa.ply", says="did you mean -o a.ply[?]")
        self.refuses(2, "extract", "x.nrrd", "--frobnicate", says="extract --help")

    def test_option_values(self):
        self.refuses(2, "extract", "x.nrrd", says="--iso")
        self.refuses(2, "extract", "x.nrrd", "--iso", says="needs a value")
        self.refuses(2, "extract", "--iso", "1", says="input")
        self.refuses(2, "extract", "a.nrrd", "b.nrrd", "--iso", "1", says="b.nrrd")
        for bad in ("abc", "nan", "inf", "-inf", "1e999", "1,,2", "1,", "", "1x", "1 2", " ", "1, ,2"):
            self.refuses(2, "extract", "x.nrrd", "--iso", bad, says="finite number")
        for bad in ("1,2", "1,2,3,4", "0,2,2", "-1,2,2", "2,2,x", "2;2;2", "2 2,2", "2,2 2",
                    "99999999999999999999,2,2", ""):
            self.refuses(2, "extract", "x.raw", "--iso", "1", "--type", "u8", "--dims", bad, says="--dims")
        for bad in ("1,2", "0,1,1", "1,-1,1", "1,1,nan", "1,1,1x"):
            self.refuses(2, "extract", "x.raw", "--iso", "1", "--spacing", bad, says="--spacing")
        self.refuses(2, "extract", "x.raw", "--iso", "1", "--dims", "2,2,2", "--type", "u9", says="u8, i8")
        self.refuses(2, "extract", "x.raw", "--iso", "1", "--dims", "2,2,2", says="--type")
        self.refuses(2, "extract", "x.raw", "--iso", "1", "--type", "u8", says="--dims")
        self.refuses(2, "extract", "x.raw", "--iso", "1", "--endian", "bigg", says="did you mean big")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--engine", "refrence", says="did you mean reference")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--method", "cubes", says="tetra")
        for bad in ("12Q", "K", "-1", "1.5.2", "99999999999999T", "", "0", "0K"):
            self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--max-memory", bad, says="--max-memory")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--nodata", "none", says="--nodata")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--component", "-1", says="--component")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--json=yes", says="no value")

    def test_blanks_in_lists(self):
        raw = self.generate("sphere", "a.raw", "8,9,10", "f32")
        words = ["extract", raw, "--type", "f32", "--engine", "reference"]
        wanted = self.report(*words, "--dims", "8,9,10", "--spacing", "1,2,3", "--iso", "100,150")
        spaced = self.report(*words, "--dims", "8, 9 ,10 ", "--spacing", " 1,\t2, 3", "--iso", " 100, 150 ")
        for report in (wanted, spaced):
            self.assertEqual([surface["iso"] for surface in report["surfaces"]], [100, 150])
        self.assertEqual(*([surface["hash"] for surface in report["surfaces"]] for report in (wanted, spaced)))
        self.expect(0, *words, "--dims", "8,9,10", "--iso", "100, 150", "-o", self.path("a%.ply"))
        self.assertEqual(self.files(), ["a.raw", "a100.ply", "a150.ply"])

    def test_combinations(self):
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--verify", "--engine", "reference", says="--verify")
        for option in (["-o", "a.ply"], ["--verify"], ["--check"], ["--normals"], ["--soup"]):
            self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--count", *option, says="--count")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1,2", "-o", self.path("a.ply"), says="%")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1,1", "-o", self.path("a%.ply"), says="twice")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "-o", self.path("a.xyz"), says="ply")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "-o", self.path("a.ply"), "--format", "vrml", says="ply")

    def test_generate(self):
        size = ["--dims", "4,4,4", "--type", "u8"]
        out = ["-o", self.path("a.nrrd")]
        self.refuses(2, "generate", *size, *out, says="field")
        self.refuses(2, "generate", "spehre", *size, *out, says="did you mean sphere")
        self.refuses(2, "generate", "qqqqqqqq", *size, *out, says="gyroid")
        self.refuses(2, "generate", "sphere", "torus", *size, *out, says="torus")
        self.refuses(2, "generate", "sphere", "--type", "u8", *out, says="--dims")
        self.refuses(2, "generate", "sphere", "--dims", "4,4,4", *out, says="--type")
        self.refuses(2, "generate", "sphere", *size, says="-o FILE")
        self.refuses(2, "generate", "sphere", *size, "-o", self.path("a.vti"), says="nrrd")
        self.refuses(2, "generate", "noise", *size, *out, "--seed", "x", says="--seed")
        self.refuses(2, "generate", "noise", "--dims", "99999999,2,2", "--type", "u8", *out, says="too large")
        self.refuses(2, "devices", "x")
        self.refuses(2, "selftest", "x")


class Files(Case):
    def test_missing_and_short(self):
        self.refuses(4, "extract", self.path("none.nrrd"), "--iso", "1", says="none.nrrd")
        self.refuses(4, "info", self.path("none.nrrd"), says="none.nrrd")
        whole = self.generate("sphere", "a.nrrd")
        with open(whole, "rb") as source, open(self.path("short.nrrd"), "wb") as target:
            target.write(source.read()[:-1])
        mesh = self.path("a.ply")
        self.refuses(4, "extract", self.path("short.nrrd"), "--iso", "1", "-o", mesh, says="short.nrrd")
        raw = self.generate("sphere", "a.raw", "4,4,4")
        for dims in ("4,4,5", "16777216,16777216,16777216"):
            self.refuses(4, "extract", raw, "--dims", dims, "--type", "u8", "--iso", "1", "-o", mesh, says="a.raw")
        self.refuses(4, "extract", raw, "--dims", "4,4,4", "--type", "u8", "--skip", "1", "--iso", "1", says="a.raw")

    def test_one_sample_along_an_axis(self):
        for n, dims in enumerate(("1,8,8", "8,1,8", "8,8,1", "1,1,1")):
            raw = self.generate("sphere", f"{n}.raw", dims)
            for engine in self.engines():
                self.refuses(4, "extract", raw, "--dims", dims, "--type", "u8", "--iso", "1", "--engine", engine, "-o",
                             self.path("a.ply"))
            self.expect(0, "info", raw, "--dims", dims, "--type", "u8")

    def test_far_corner_beyond_float32(self):
        raw = self.generate("sphere", "far.raw", "8,8,8")
        self.refuses(2, "extract", raw, "--dims", "8,8,8", "--type", "u8", "--iso", "100", "--spacing", "3e38,1,1",
                     "--engine", "reference", "-o", self.path("a.ply"), says="beyond float32")

    def test_output_is_the_input(self):
        volume = self.generate("sphere", "a.nrrd")
        os.link(volume, self.path("same.ply"))
        for output in (volume, self.path("same.ply")):
            self.refuses(2, "extract", volume, "--iso", "127.5", "--format", "ply", "-o", output, says="input itself")

    def test_json_of_a_name_that_is_no_utf8(self):
        volume = self.generate("sphere", "a.nrrd")
        strange = os.fsencode(self.path("a")) + b"\xff.nrrd"
        os.rename(volume, strange)
        for arguments in (["info"], ["extract", "--iso", "127.5", "--engine", "reference"]):
            report = json.loads(self.expect(0, *arguments, os.fsdecode(strange), "--json").stdout)
            self.assertTrue(report["input"].endswith("a?.nrrd"), report["input"])

    def test_unwritable_output(self):
        volume = self.generate("sphere", "a.nrrd")
        extract = ["extract", volume, "--iso", "127.5", "--engine", "reference"]
        generate = ["generate", "sphere", "--dims", "64,64,64", "--type", "u8"]
        self.refuses(1, *extract, "-o", self.path("no/such/folder/a.ply"), says="folder/a.ply")
        self.refuses(1, *generate, "-o", self.path("no/such/folder/a.nrrd"), says="folder/a.nrrd")
        os.mkdir(self.path("folder.ply"))
        os.mkdir(self.path("folder.nrrd"))
        self.refuses(1, *extract, "-o", self.path("folder.ply"), says="folder.ply")
        self.refuses(1, *generate, "-o", self.path("folder.nrrd"), says="folder.nrrd")

    def test_full_disk(self):
        if not (os.path.exists("/dev/full") and stat.S_ISCHR(os.stat("/dev/full").st_mode)):
            self.skipTest("/dev/full is no device here")
        volume = self.generate("sphere", "a.nrrd")
        extract = ["extract", volume, "--iso", "127.5", "--engine", "reference"]
        self.refuses(1, *extract, "-o", "/dev/full", "--format", "ply", says="/dev/full")
        for name in ("full.ply", "full.nrrd"):
            os.symlink("/dev/full", self.path(name))
        self.refuses(1, *extract, "-o", self.path("full.ply"), says="full.ply")
        self.refuses(1, "generate", "sphere", "--dims", "64,64,64", "--type", "u8", "-o", self.path("full.nrrd"),
                     says="full.nrrd")
        for arguments in (["--help"], extract + ["--json"], ["info", volume], ["info", volume, "--json"]):
            with open("/dev/full", "w") as full:
                told = self.refuses(1, *arguments, stdout=full, says="standard output: No space").stderr
                self.assertEqual(told.count("tetracubes: "), 1, told)

    def test_generated_samples(self):
        for kind, size in SIZES.items():
            for dims in ("5,4,3", "2,2,2", "33,2,7"):
                nrrd = self.generate("noise", f"{kind}.nrrd", dims, kind, "--seed", "9")
                raw = self.generate("noise", f"{kind}.raw", dims, kind, "--seed", "9")
                with open(nrrd, "rb") as f:
                    header, _, samples = f.read().partition(b"\n\n")
                with open(raw, "rb") as f:
                    self.assertEqual(f.read(), samples)
                count = 1
                for n in dims.split(","):
                    count *= int(n)
                self.assertEqual(len(samples), count * size)
                self.assertEqual((len(header) + 2) % 128, 0)
                self.assertEqual(header.split(b"\n")[0], b"NRRD0004")
                one, other = (self.report("info", nrrd), self.report("info", raw, "--dims", dims, "--type", kind))
                for key in ("dims", "type", "range", "histogram", "isovalues"):
                    self.assertEqual(one[key], other[key], key)
        different = self.generate("noise", "other.raw", "33,2,7", "u8", "--seed", "10")
        with open(self.path("u8.raw"), "rb") as a, open(different, "rb") as b:
            self.assertNotEqual(a.read(), b.read())

    def test_generated_geometry(self):
        info = self.report("info", self.generate("sphere", "a.nrrd", "5,9,3", "f32"))
        self.assertEqual(info["spacing"], [0.5, 0.25, 1.0])
        self.assertEqual([row[3] for row in info["matrix"]], [-1, -1, -1])
        self.assertEqual(info["type"], "f32")


class Reports(Case):
    def test_info(self):
        info = self.report("info", self.generate("sphere", "a.nrrd", "21,21,21"))
        self.assertEqual(set(info), tool_case.INFO_KEYS)
        self.assertEqual((info["dims"], info["type"], info["nonfinite"]), ([21, 21, 21], "u8", 0))
        self.assertEqual(info["range"], [0, 255])
        self.assertEqual(set(info["histogram"]), {"low", "width", "counts"})
        self.assertEqual(sum(info["histogram"]["counts"]), 21 ** 3)
        self.assertEqual((info["histogram"]["low"], info["histogram"]["width"]), (-0.5, 1))
        self.assertEqual(info["histogram"]["counts"][255], 1)
        self.assertIn("otsu", [good["name"] for good in info["isovalues"]])
        for good in info["isovalues"]:
            self.assertEqual(set(good), {"iso", "name", "reason"})
            self.assertTrue(0 < good["iso"] <= 255)
        self.assertIn("histogram", self.expect(0, "info", self.path("a.nrrd")).stdout)

    def test_info_otsu_between_two_materials(self):
        with open(self.path("two.raw"), "wb") as f:
            f.write(bytes([10] * 300 + [11] * 20 + [200] * 192))
        info = self.report("info", self.path("two.raw"), "--dims", "8,8,8", "--type", "u8")
        iso = {good["name"]: good["iso"] for good in info["isovalues"]}
        self.assertAlmostEqual(iso["otsu"], 105.5, delta=0.51)
        self.assertEqual(iso["otsu-lower"], 10.5)
        self.assertEqual(iso["middle"], 105)

    def test_info_of_what_is_not_finite(self):
        with open(self.path("a.raw"), "wb") as f:
            f.write(struct.pack("<8f", float("nan"), float("inf"), -float("inf"), 1, 2, 3, 4, 5))
        info = self.report("info", self.path("a.raw"), "--dims", "2,2,2", "--type", "f32")
        self.assertEqual((info["nonfinite"], info["range"], sum(info["histogram"]["counts"])), (3, [1, 5], 5))
        with open(self.path("b.raw"), "wb") as f:
            f.write(struct.pack("<8f", *[float("nan")] * 8))
        info = self.report("info", self.path("b.raw"), "--dims", "2,2,2", "--type", "f32")
        self.assertEqual((info["nonfinite"], info["range"], info["isovalues"]), (8, None, []))
        with open(self.path("c.raw"), "wb") as f:
            f.write(struct.pack("<8d", -1.7e308, 1.7e308, 0, 1, 2, 3, 4, 5))
        info = self.report("info", self.path("c.raw"), "--dims", "2,2,2", "--type", "f64")
        self.assertEqual((info["range"], sum(info["histogram"]["counts"])), ([-1.7e308, 1.7e308], 8))

    def test_extract(self):
        volume = self.generate("sphere", "a.nrrd", "33,33,33")
        for engine in self.engines():
            extract = ["extract", volume, "--iso", "127.5", "--engine", engine]
            report = self.report(*extract)
            self.assertEqual(set(report), tool_case.EXTRACT_KEYS)
            self.assertEqual((report["dims"], report["cells"], report["tetrahedra"]), ([33, 33, 33], 32768, 163840))
            self.assertEqual((report["input"], report["engine"], report["method"]), (volume, engine, "tetra"))
            self.assertEqual(report["device"] is None, engine == "reference")
            self.assertEqual(set(report["timings_ms"]), {"read", "device_start", "build", "upload", "write", "total"})
            [surface] = report["surfaces"]
            self.assertEqual(set(surface), tool_case.SURFACE_KEYS)
            self.assertEqual((surface["iso"], surface["vertices"], surface["triangles"]), (127.5, 5082, 10160))
            self.assertEqual(set(surface["timings_ms"]), {"classify", "emit", "readback"})
            self.assertRegex(surface["hash"], r"^[0-9a-f]{16}$")
            for low, high in zip(*surface["bounds"]):
                self.assertAlmostEqual(low, -2 / 3, delta=0.01)
                self.assertAlmostEqual(high, 2 / 3, delta=0.01)
            [surface] = self.report(*extract, "--check")["surfaces"]
            self.assertEqual(set(surface), tool_case.SURFACE_KEYS | tool_case.CHECK_KEYS)
            self.assertEqual((surface["boundary_edges"], surface["euler_characteristic"], surface["components"]),
                             (0, 2, 1))
            self.assertAlmostEqual(surface["volume"], 1.24, delta=0.03)
            self.assertAlmostEqual(surface["smallest_angle_median"], 33.8, delta=1)
            self.assertLess(0.05, surface["angles_below_10"])
            self.assertLess(surface["angles_below_10"], surface["angles_below_20"])
            self.assertLess(surface["angles_below_20"], 0.5)
            [surface] = self.report(*extract, "--count")["surfaces"]
            self.assertEqual(set(surface), tool_case.COUNT_KEYS)
            self.assertEqual((surface["vertices"], surface["triangles"]), (5082, 10160))
            text = self.expect(0, *extract, "--check").stdout
            for fact in ("5082 vertices", "10160 triangles", "Euler characteristic 2", "closed", "smallest angles: median"):
                self.assertIn(fact, text)
            self.assertEqual(self.expect(0, *extract, "--quiet").stdout, "")
            self.assertEqual(self.expect(0, *extract, "--quiet").stderr, "")

    def test_several_isovalues(self):
        volume = self.generate("torus", "a.nrrd", "30,30,30")
        report = self.report("extract", volume, "--iso", "1e2,127.50", "--iso=+150", "-o", self.path("s-%.ply"),
                             "--engine", "reference")
        self.assertEqual([surface["iso"] for surface in report["surfaces"]], [100, 127.5, 150])
        self.assertEqual(self.files(), ["a.nrrd", "s-+150.ply", "s-127.50.ply", "s-1e2.ply"])
        for surface in report["surfaces"]:
            alone = self.report("extract", volume, "--iso", repr(surface["iso"]), "--engine", "reference")
            self.assertEqual(alone["surfaces"][0]["hash"], surface["hash"])

    def test_names_of_values(self):
        """Every % stands for the value, also for a single one, and in folders; %% is a percent sign."""
        volume = self.generate("torus", "a.nrrd", "30,30,30")
        os.mkdir(self.path("9.5"))
        for iso, pattern, names in (("9.5", "s-%.ply", ["s-9.5.ply"]), ("9.5", "%/s_%%%%_%.ply", ["9.5/s_%%_9.5.ply"]),
                                    ("9.5", "90%%.ply", ["90%.ply"]), ("9.5,1e1", "%%%.ply", ["%9.5.ply", "%1e1.ply"]),
                                    ("9.5", "%%-%.a%b.ply", ["%-9.5.a9.5b.ply"])):
            text = self.expect(0, "extract", volume, "--iso", iso, "-o", self.path(pattern), "--engine", "reference").stdout
            self.assertEqual([line.split("written ")[1].strip() for line in text.splitlines() if "written" in line],
                             [self.path(name) for name in names])
            for name in names:
                os.remove(self.path(name))
        self.assertEqual(self.files(), ["9.5", "a.nrrd"])
        report = self.report("extract", volume, "--iso", "9.5", "-o", self.path("%.ply"), "--engine", "reference")
        self.assertEqual(report["surfaces"][0]["output"], self.path("9.5.ply"))
        os.remove(self.path("9.5.ply"))
        self.refuses(2, "extract", volume, "--iso", "1,2", "-o", self.path("90%%.ply"), says="name needs a %, which stands for the isovalue")
        self.refuses(2, "isovolume", volume, "--range", "1,2", "--range", "2,3", "-o", self.path("%%.vtu"),
                     says="name needs a %, which stands for the range")

    def test_isovalues_read_back_exactly(self):
        volume = self.generate("gyroid", "a.nrrd", "8,8,8", "f64")
        for iso in ("0.1", "0.30000000000000004", "-5", "1e300"):
            report = self.report("extract", volume, "--iso", iso, "--engine", "reference", "--count")
            self.assertEqual(report["surfaces"][0]["iso"], float(iso))

    def test_formats(self):
        volume = self.generate("sphere", "a.nrrd", "9,9,9")
        extract = ["extract", volume, "--iso", "127.5", "--engine", "reference", "--json"]
        for name, start in (("a.ply", b"ply\n"), ("a.obj", None), ("a.stl", None)):
            for more in ([], ["--soup"], ["--normals"]):
                surface = json.loads(self.expect(0, *extract, "-o", self.path(name), *more).stdout)["surfaces"][0]
                with open(self.path(name), "rb") as f:
                    content = f.read()
                self.assertTrue(content.startswith(start or b""))
                if name == "a.stl":
                    self.assertEqual(struct.unpack("<I", content[80:84])[0], surface["triangles"])
                    self.assertEqual(len(content), 84 + 50 * surface["triangles"])
                if name == "a.obj":
                    vertices = surface["vertices"]
                    self.assertEqual(len(re.findall(rb"(?m)^v ", content)), vertices)
        self.expect(0, *extract, "-o", self.path("named.anything"), "--format", "stl")
        self.assertEqual(os.path.getsize(self.path("named.anything")), os.path.getsize(self.path("a.stl")))

    def test_empty_surfaces(self):
        for field in ("empty", "full"):
            volume = self.generate(field, f"{field}.nrrd", "9,8,7")
            for engine in self.engines():
                report = self.report("extract", volume, "--iso", "127.5", "--check", "--engine", engine, "-o",
                                     self.path("a.ply"))
                self.assertEqual((report["surfaces"][0]["vertices"], report["surfaces"][0]["triangles"]), (0, 0))
                self.assertEqual(report["surfaces"][0]["bounds"], None)

    def test_missing_data(self):
        samples = [100.0 if (n * 7919) % 5 < 2 else 0.0 for n in range(6 * 6 * 6)]
        samples[111] = float("nan")
        with open(self.path("nan.raw"), "wb") as f:
            f.write(struct.pack("<216f", *samples))
        samples[111] = -9.0
        with open(self.path("nodata.raw"), "wb") as f:
            f.write(struct.pack("<216f", *samples))
        raw = ["--dims", "6,6,6", "--type", "f32", "--iso", "50", "--check"]
        for engine in self.engines():
            one = self.report("extract", self.path("nan.raw"), *raw, "--engine", engine)["surfaces"][0]
            other = self.report("extract", self.path("nodata.raw"), *raw, "--engine", engine, "--nodata",
                                "-9")["surfaces"][0]
            whole = self.report("extract", self.path("nodata.raw"), *raw, "--engine", engine)["surfaces"][0]
            self.assertEqual(one["hash"], other["hash"])
            self.assertLess(one["triangles"], whole["triangles"])

    def test_closed_beside_missing_cells(self):
        """Two boxes of cells that meet along an edge only: the closed surface has four triangles there."""
        samples = [100.0] * 50
        samples[3 + 5 * 1] = samples[1 + 5 * 3] = float("nan")
        with open(self.path("boxes.raw"), "wb") as f:
            f.write(struct.pack("<50f", *samples))
        extract = ["extract", self.path("boxes.raw"), "--dims", "5,5,2", "--type", "f32", "--iso", "50", "--closed",
                   "-o", self.path("boxes.stl")]
        for engine in self.engines():
            self.assertIn("--check counts such edges", self.expect(0, *extract, "--engine", engine).stderr)
            self.refuses(3, *extract, "--engine", engine, "--check", says="meet only along an edge")
        samples[1 + 5 * 3] = 100.0
        with open(self.path("boxes.raw"), "wb") as f:
            f.write(struct.pack("<50f", *samples))
        self.assertNotIn("meet", self.expect(0, *extract, "--check").stderr)

    def test_raw_byte_order_skip_and_placement(self):
        values = [(n * 37) % 251 * 100 for n in range(5 * 4 * 3)]
        with open(self.path("little.raw"), "wb") as f:
            f.write(struct.pack("<60h", *values))
        with open(self.path("big.raw"), "wb") as f:
            f.write(b"header" + struct.pack(">60h", *values))
        raw = ["--dims", "5,4,3", "--type", "i16", "--iso", "12000", "--engine", "reference"]
        little = self.report("extract", self.path("little.raw"), *raw)["surfaces"][0]
        big = self.report("extract", self.path("big.raw"), *raw, "--endian", "big", "--skip", "6")["surfaces"][0]
        self.assertGreater(little["triangles"], 0)
        self.assertEqual(little["hash"], big["hash"])
        placed = self.report("extract", self.path("little.raw"), *raw, "--spacing", "2,4,8", "--origin",
                             "-1,0,1")["surfaces"][0]
        for axis, (spacing, origin) in enumerate(((2, -1), (4, 0), (8, 1))):
            for end in range(2):
                self.assertAlmostEqual(placed["bounds"][end][axis], little["bounds"][end][axis] * spacing + origin,
                                       places=4)


if __name__ == "__main__":
    tool_case.main()
