#!/usr/bin/env python3
"""test_selftest.py TOOL LAYER SOURCE - the self-test as an acceptance test of drivers: vectors, faults, reports

What a fault of the device comes to, in text, JSON and JUnit: a wrong hash, a crash, a hang, time that is over, and that
trials behind it are run all the same. Vectors that are none are refused by file and line. vectors.txt of the tool is
what vectors.py makes of small volumes. Standard library only.
"""
import json
import os
import subprocess
import sys
import xml.etree.ElementTree

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case

LAYER = None
SOURCE = None
DEVICE_KEYS = {"device", "groups", "pass", "platform", "driver", "version", "tetracubes"}
GROUP_KEYS = {"name", "trials", "failed", "message", "crashed", "skipped", "seconds"}


class SelftestCase(tool_case.Case):
    def layer(self, command, **more):
        return {"OPENCL_LAYERS": LAYER, "TETRACUBES_LAYER": command, "TETRACUBES_CACHE_DIR": "", **more}

    def vectors(self, *lines, name="vectors.txt"):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write("# a comment\n\n" + "".join(line + "\n" for line in lines))
        return self.path(name)

    def right(self, *names):
        """Lines of vectors.txt that begin so."""
        with open(os.path.join(SOURCE, "host", "tool", "selftest", "vectors.txt"), encoding="utf-8") as file:
            lines = file.read().splitlines()
        return [next(line for line in lines if line.startswith(name)) for name in names]

    def run_vectors(self, status, *lines, env=None, more=()):
        """(report, JUnit's root)"""
        junit = self.path("junit.xml")
        says = None if not status else "do not trust"
        result = self.expect(status, "selftest", "--vectors", self.vectors(*lines), "--json", "--junit", junit, *more,
                             env=env, says=says)
        report = json.loads(result.stdout)
        self.assertEqual(set(report), DEVICE_KEYS)
        self.assertEqual(set(report["groups"][0]), GROUP_KEYS)
        root = xml.etree.ElementTree.parse(junit).getroot()
        self.assertEqual(root.tag, "testsuites")
        self.assertEqual(len(root.findall("testsuite/testcase")), int(root.get("tests")))
        return report["groups"][0], root


class Vectors(SelftestCase):
    def test_right(self):
        lines = self.right("noise 37 22 19 u8", "noise 2 2 2 u8", "empty 20 20 20 u8")
        group, root = self.run_vectors(0, *lines)
        self.assertEqual((group["name"], group["trials"], group["failed"]), ("vectors", 3, 0))
        self.assertEqual([root.get(key) for key in ("tests", "failures", "errors", "skipped")], ["3", "0", "0", "0"])
        names = {p.get("name"): p.get("value") for p in root.findall("testsuite/properties/property")}
        self.assertIn("driver", names)
        self.assertIn("127.5", root.find("testsuite/testcase").get("name"))

    def test_wrong(self):
        good, bad = self.right("noise 37 22 19 u8", "noise 2 2 2 u8")
        words = bad.split()
        spoiled = " ".join(words[:10] + [f"{int(words[10], 16) ^ 1:016x}"])
        counts = " ".join(words[:8] + [str(int(words[8]) + 1)] + words[9:])
        group, root = self.run_vectors(3, good, spoiled, counts, good)
        self.assertEqual((group["trials"], group["failed"], group["crashed"]), (4, 2, 0))
        self.assertIn("should be", group["message"])
        self.assertEqual([f.get("type") for f in root.iter("failure")], ["wrong", "wrong"])
        text = self.expect(3, "selftest", "--vectors", self.vectors(spoiled)).stdout.splitlines()
        self.assertEqual(text[-1], "FAIL")
        self.assertRegex(text[1], "vectors +1 trial +FAILED")
        text = self.expect(0, "selftest", "--vectors", self.vectors(good)).stdout.splitlines()
        self.assertEqual(text[-1], "PASS")

    def test_no_vectors(self):
        good = self.right("noise 2 2 2 u8")[0]
        for line in ("nofield" + good[5:], good.replace(" u8 ", " u9 "), good + " more", good[:-20],
                     good.replace("seed=1", "sed=1"), good.replace("2 2 2", "2 2 1"), good.replace("127.5", "nan"),
                     good.replace("tetra", "cubes"), good.replace("2 2 2", "2 2 100000")):
            self.assertNotEqual(line, good)
            self.refuses(4, "selftest", "--vectors", self.vectors(good, line), says="vectors.txt: line 4 is no vector")
        self.refuses(4, "selftest", "--vectors", self.vectors(), says="no vectors in it")
        self.refuses(4, "selftest", "--vectors", self.path("none.txt"), says="none.txt")
        self.refuses(2, "selftest", "--vectors", "a", "b", says="takes no 'b'")
        self.refuses(2, "selftest", "a", says="--vectors")

    def test_without_fp64(self):
        """What needs it is skipped."""
        lines = self.right("noise 67 13 11 u8 127.5 snap", "noise 67 13 11 f64 128.1 snap",
                           "gyroid 30 20 13 f64 127.5 tetra tetrahedra")
        group, root = self.run_vectors(0, *lines, env=self.layer("lacks fp64"))
        self.assertEqual((group["trials"], group["failed"], group["skipped"]), (1, 0, 2))
        self.assertEqual([c.get("message") for c in root.iter("skipped")], ["the device has no fp64"] * 2)

    def test_file_of_the_tool(self):
        script = os.path.join(SOURCE, "host", "tool", "selftest", "vectors.py")
        done = subprocess.run([sys.executable, script, tool_case.TOOL, "--check"], stdout=subprocess.PIPE, text=True,
                              check=False)
        self.assertEqual(done.returncode, 0, done.stdout)


class Faults(SelftestCase):
    def test_crash(self):
        """The trial at hand fails, the next are run: each by a child of its own, as each crashes."""
        lines = self.right("noise 37 22 19 u8", "noise 2 2 2 u8", "empty 20 20 20 u8")
        group, root = self.run_vectors(3, *lines, env=self.layer("crash launch abort"))
        self.assertEqual((group["trials"], group["failed"], group["crashed"]), (3, 3, 3))
        self.assertIn("crashes: signal 6 (Aborted), last words \"driver: assertion failed in launch\"",
                      group["message"])
        self.assertEqual([e.get("type") for e in root.iter("error")], ["crashed"] * 3)

    def test_crash_of_one(self):
        good, hybrid = self.right("noise 37 22 19 u8", "noise 67 13 11 u8 127.5 hybrid")
        group, _ = self.run_vectors(3, good, hybrid, good, env=self.layer("crash build abort -DMETHOD=hybrid"))
        self.assertEqual((group["trials"], group["failed"], group["crashed"]), (3, 1, 1))

    def test_crash_at_the_end(self):
        cache = {"TETRACUBES_CACHE_DIR": self.path("cache")}
        os.mkdir(self.path("cache"), 0o700)
        lines = self.right("noise 37 22 19 u8")
        self.run_vectors(0, *lines, env=cache)  # a driver that nobody knows is good from here on
        group, _ = self.run_vectors(3, *lines, env=self.layer("crash end abort", **cache))
        self.assertEqual((group["trials"], group["failed"], group["crashed"]), (2, 1, 1))

    def test_hang(self):
        env = self.layer("crash launch hang", TETRACUBES_TRIAL_SECONDS="2")
        group, root = self.run_vectors(3, *self.right("noise 37 22 19 u8"), env=env)
        self.assertIn("hangs: time ran out", group["message"])
        self.assertEqual([e.get("type") for e in root.iter("error")], ["hung"])

    def test_time_bound(self):
        lines = self.right("noise 37 22 19 u8", "noise 2 2 2 u8")
        group, root = self.run_vectors(3, *lines, env=self.layer("crash launch hang"), more=["--timeout", "3"])
        self.assertIn("not finished when the time", group["message"])
        self.assertEqual([e.get("type") for e in root.iter("error")], ["late", "late"])

    def test_wrong_device(self):
        group, _ = self.run_vectors(3, *self.right("noise 37 22 19 u8"), env=self.layer("corrupt flip emit 10 400 0"))
        self.assertEqual((group["failed"], group["crashed"]), (1, 0))
        self.assertIn("hash", group["message"])

    def test_junit_that_cannot_be_written(self):
        vectors = self.vectors(*self.right("noise 2 2 2 u8"))
        result = tool_case.tool("selftest", "--vectors", vectors, "--junit", self.path("none/junit.xml"))
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("none", result.stderr)


if __name__ == "__main__":
    LAYER, SOURCE = (os.path.abspath(path) for path in sys.argv[2:4])
    tool_case.main()
