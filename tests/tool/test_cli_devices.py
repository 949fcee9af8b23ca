#!/usr/bin/env python3
"""test_cli_devices.py TOOL [reference] [fault=LIBRARY] - the choice of a device, damaged meshes, interrupted runs

Devices as they are told and chosen; meshes that mesh_fault.c, preloaded from LIBRARY, has damaged: --verify, --check
and selftest find the fault; signals and limits, which leave no partial file.
"""
import json
import os
import pty
import resource
import select
import signal
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from tool_case import Case

DEVICE_KEYS = {"index", "spec", "name", "platform", "version", "driver", "type", "compute_units",
               "max_work_group_size", "global_memory_bytes", "max_buffer_bytes", "local_memory_bytes",
               "shares_host_memory", "has_fp64", "rounds_division"}


class Devices(Case):
    def test_no_platform(self):
        none = {"OCL_ICD_VENDORS": self.path("vendors")}
        os.mkdir(self.path("vendors"))
        volume = self.generate("sphere", "a.nrrd")
        self.refuses(1, "extract", volume, "--iso", "127.5", "-o", self.path("a.ply"), env=none, says="(?i)install")
        self.refuses(1, "devices", env=none, says="no OpenCL platform was found: none is installed, or .*does not load")
        self.refuses(1, "devices", "--json", env=none, says="(?i)install")
        self.refuses(1, "selftest", env=none, says="(?i)install")
        self.expect(0, "extract", volume, "--iso", "127.5", "--engine", "reference", env=none)

    def test_unknown_device(self):
        self.needs_device()
        volume = self.generate("sphere", "a.nrrd")
        for spec in ("no such device", "99", "99:0", "-1", "cpu:99", "gpu:-1", "cpu:", "cpu:0x"):
            self.refuses(1, "extract", volume, "--iso", "127.5", "--device", spec, "-o", self.path("a.ply"))
            self.refuses(1, "selftest", "--device", spec)
        self.refuses(1, "extract", volume, "--iso", "127.5", env={"TETRACUBES_DEVICE": "no such device"},
                     says="TETRACUBES_DEVICE")

    def test_devices(self):
        self.needs_device()
        report = self.report("devices")
        self.assertEqual(set(report), {"devices"})
        self.assertTrue(report["devices"])
        text = self.expect(0, "devices").stdout
        for index, device in enumerate(report["devices"]):
            self.assertEqual(set(device), DEVICE_KEYS)
            self.assertEqual(device["index"], index)
            self.assertIn(device["name"], text)
        device = report["devices"][0]
        volume = self.generate("sphere", "a.nrrd")
        for spec in ("0", device["spec"], device["type"], device["type"].upper() + ":0", device["name"]):
            got = self.report("extract", volume, "--iso", "127.5", "--device", spec)
            self.assertEqual(got["device"], device["name"])

    def test_engines_agree(self):
        self.needs_device()
        for field, dims, kind, iso in (("gyroid", "65,33,17", "u8", "127.5"), ("noise", "40,41,42", "f32", "127.5"),
                                       ("tangle", "30,31,32", "f64", "127.5"), ("noise", "67,9,5", "i16", "128")):
            volume = self.generate(field, "a.nrrd", dims, kind)
            reference = self.report("extract", volume, "--iso", iso, "--engine", "reference")["surfaces"][0]
            for more in ([], ["--max-memory", "16M"], ["--normals"]):
                device = self.report("extract", volume, "--iso", iso, "--verify", "--check", *more)["surfaces"][0]
                self.assertEqual(set(device), tool_case.SURFACE_KEYS | tool_case.CHECK_KEYS | {"verified"})
                self.assertIs(device["verified"], True)
                self.assertEqual(device["hash"], reference["hash"])

    def test_selftest(self):
        self.needs_device()
        # The whole has kernels for groups of many sizes, which PoCL takes long to build: long_selftest runs it.
        if "TEST_PLAIN_KERNELS" not in os.environ:
            result = self.expect(0, "selftest")
            self.assertEqual(result.stdout.splitlines()[-1], "PASS", result.stdout)
        report = self.report("selftest", "--quick")
        self.assertEqual(set(report), {"device", "groups", "pass", "platform", "driver", "version", "tetracubes"})
        self.assertIs(report["pass"], True)
        for group in report["groups"]:
            self.assertEqual((group["failed"], group["message"]), (0, ""))
            self.assertGreater(group["trials"], 0)


class Faults(Case):
    def setUp(self):
        super().setUp()
        if not tool_case.FAULT_LIBRARY:
            self.skipTest("no library of faults given")
        self.volume = self.generate("sphere", "a.nrrd", "21,22,23", "f32")

    def damaged(self, fault, *more):
        """Extracts with the fault in the mesh: status 3, and no file is written. Returns the report and the message."""
        environment = {"LD_PRELOAD": tool_case.FAULT_LIBRARY, "MESH_FAULT": fault}
        result = self.refuses(3, "extract", self.volume, "--iso", "127.5", "--json", "-o", self.path("a.ply"), *more,
                              env=environment)
        return json.loads(result.stdout)["surfaces"][0], result.stderr

    def test_verification_finds_one_bit(self):
        self.needs_device()
        for fault, named in (("position", "vertex"), ("normal", "normal"), ("triangle", "triangle")):
            surface, told = self.damaged(fault, "--verify", "--normals")
            self.assertIs(surface["verified"], False)
            self.assertRegex(told, rf"isovalue 127.5: verification failed: {named} \d+ is ")
            self.assertIn("not written", told)

    def test_check_finds_a_turned_triangle(self):
        for engine in self.engines():
            surface, told = self.damaged("winding", "--check", "--engine", engine)
            self.assertEqual(surface["misoriented_edges"], 3)
            self.assertRegex(told, "check failed: .* 3 misoriented edges")
        if tool_case.HAS_DEVICE:
            self.assertIs(self.damaged("winding", "--check", "--verify")[0]["verified"], True)

    def test_selftest_fails(self):
        self.needs_device()
        environment = {"LD_PRELOAD": tool_case.FAULT_LIBRARY, "MESH_FAULT": "position"}
        lines = self.expect(3, "selftest", "--quick", env=environment, says="do not trust").stdout.splitlines()
        self.assertEqual(lines[-1], "FAIL")
        self.assertTrue(any(line.endswith("FAILED") for line in lines))


class Interrupts(Case):
    def interrupt(self, ready, *arguments, number=signal.SIGINT, before=signal.SIG_DFL, status=None, says="cancelled"):
        """Starts the tool with a terminal for its messages, sends a signal once ready(text so far)."""
        if status is None:
            status = tool_case.cancelled_by(number)
        ours, theirs = pty.openpty()
        process = subprocess.Popen([tool_case.TOOL, *map(str, arguments)], stderr=theirs, stdout=subprocess.DEVNULL,
                                   preexec_fn=lambda: signal.signal(number, before))
        os.close(theirs)
        text, sent = "", False
        while True:
            if select.select([ours], [], [], 0.01)[0]:
                try:
                    text += os.read(ours, 4096).decode()
                except OSError:  # the tool has closed its side
                    break
            if not sent and ready(text):
                process.send_signal(number)
                sent = True
        os.close(ours)
        self.assertEqual(process.wait(60), status, text)
        self.assertIn(says, text)
        return text

    def started(self, _):
        return any(name.endswith(".tmp") for name in self.files())

    def test_generate_leaves_nothing(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGXCPU):
            self.interrupt(self.started, "generate", "noise", "--dims", "1024,1024,512", "--type", "u16", "-o",
                           self.path("a.nrrd"), number=number)
            self.assertEqual(self.files(), [], number)

    def test_ignored_signals_stay_ignored(self):
        self.interrupt(self.started, "generate", "noise", "--dims", "256,256,512", "--type", "u16", "-o",
                       self.path("a.nrrd"), number=signal.SIGHUP, before=signal.SIG_IGN, status=0, says="")
        self.assertEqual(self.files(), ["a.nrrd"])

    def test_limit_on_file_sizes(self):
        volume = self.generate("sphere", "a.nrrd", "40,40,40")
        for command in (["extract", volume, "--iso", "127.5", "--engine", "reference", "-o", "big.stl"],
                        ["tetrahedralize", volume, "-o", "big.vtu"],
                        ["generate", "noise", "--dims", "64,64,64", "--type", "u8", "-o", "big.nrrd"]):
            def limit():
                resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
            result = subprocess.run([tool_case.TOOL, *command], cwd=self.folder.name, stderr=subprocess.PIPE, text=True,
                                    stdout=subprocess.DEVNULL, preexec_fn=limit, timeout=1000)
            self.assertEqual(result.returncode, 1, result)
            self.assertRegex(result.stderr, "^tetracubes: big.*too large.*ulimit -f")
            self.assertEqual(self.files(), ["a.nrrd"])

    def test_extract_leaves_nothing(self):
        volume = self.generate("gyroid", "a.nrrd", "400,400,400")
        text = self.interrupt(lambda text: "%" in text, "extract", volume, "--iso", "127.5", "--engine", "reference",
                              "-o", self.path("a.ply"))
        self.assertRegex(text, r"[a-z]+ +\d+%")
        self.assertEqual(self.files(), ["a.nrrd"])


if __name__ == "__main__":
    tool_case.main()
