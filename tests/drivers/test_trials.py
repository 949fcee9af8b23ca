#!/usr/bin/env python3
"""test_trials.py TOOL LAYER [long] - drivers that crash, hang, refuse or compute wrongly, found out in processes apart

The layer (tests/layer) gives PoCL the version of a driver that nobody knows, and makes it abort, hang, end the process,
fail or compute wrongly, when it opens the device, builds kernels, runs them, or when the process ends. Whatever it
does: extract ends with a sentence that names driver and reason, no file and no chatter; --engine auto makes the
reference's bytes; the verdict is kept, and later runs start no process: they are given no time for one. Standard
library only.
"""
import json
import os
import re
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from part import part_write

LAYER = None
FIGURES = {"planted": 0, "told": 0, "reference": 0}
COMMAND = "--trial-of-a-driver"
NO_TIME = {"TETRACUBES_TRIAL_SECONDS": "0.001"}
ALONE, GROUPS = "-DWORK_ITEMS=1", "-DWORK_ITEMS=32"
CRASHES = {"open abort": "before kernels were built", "open exit": "before kernels were built",
           "build abort": "before kernels were built", "build exit": "exit status 0 before kernels were built",
           "launch abort": "where kernels first ran", "read abort": "where kernels first ran",
           "end abort": "at its end"}
# When a hang is met, and after how many seconds: to build kernels before takes some.
HANGS = {"open hang": ("before kernels were built", 3), "launch hang": ("where kernels first ran", 20)}
REFUSALS = {"build refuse": "does not build the kernels", "launch refuse": "CL_INVALID_PROGRAM_EXECUTABLE"}


def trials_running():
    found = []
    for process in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{process}/cmdline", "rb") as file:
                arguments = file.read().split(b"\0")
            with open(f"/proc/{process}/environ", "rb") as file:
                ours = f"TRIALS_OF={os.getpid()}".encode() in file.read().split(b"\0")
        except OSError:
            continue
        if ours and COMMAND.encode() in arguments:
            found.append(int(process))
    return found


def wait_until_idle(process):
    """It has not used the processor for a second."""
    used, since = None, 0
    while since < 10:
        with open(f"/proc/{process}/stat", encoding="utf-8") as file:
            now = file.read().rsplit(")", 1)[1].split()[11:13]
        used, since = now, since + 1 if now == used else 0
        time.sleep(0.1)


class TrialCase(tool_case.Case):
    def setUp(self):
        super().setUp()
        self.volume = self.generate("sphere", "a.nrrd", "30,20,10", "f32")
        self.arguments = ["extract", self.volume, "--iso", "127.5", "--normals"]
        self.cache = self.path("cache")
        os.mkdir(self.cache)

    def layer(self, command, cache=None, **more):
        return {"OPENCL_LAYERS": LAYER, "TETRACUBES_LAYER": "lacks fame;" + command, "TRIALS_OF": str(os.getpid()),
                "TETRACUBES_CACHE_DIR": self.cache if cache is None else cache, **more}

    def verdicts(self):
        """{path: (verdict with its reason, inode)}"""
        found = {}
        for name in sorted(os.listdir(self.cache)):
            path = os.path.join(self.cache, name)
            if name.endswith(".verdict"):
                with open(path, encoding="utf-8") as file:
                    found[path] = (file.read().splitlines()[3], os.stat(path).st_ino)
        return found

    def mesh(self, *more, env=None):
        path = self.path("mesh.ply")
        self.expect(0, *self.arguments, "--quiet", "-o", path, *more, env=env)
        with open(path, "rb") as file:
            content = file.read()
        os.unlink(path)
        return content

    def fails(self, env, says):
        result = self.refuses(1, *self.arguments, "-o", self.path("a.ply"), env=env, says=says)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertNotIn("chatter", result.stderr)
        self.assertNotIn("Traceback", result.stderr)
        return result.stderr

    def falls_back(self, env):
        self.assertEqual(self.mesh("--engine", "auto", env=env), self.mesh("--engine", "reference"))
        report = json.loads(self.expect(0, *self.arguments, "--engine", "auto", "--json", env=env,
                                        says="the reference engine takes over").stdout)
        self.assertEqual(report["engine"], "reference")

    def found_out(self, command, says, **more):
        """First run, second run without time for a trial, --engine auto."""
        env = self.layer(command, **more)
        FIGURES["planted"] += 1
        self.fails(env, says)
        FIGURES["told"] += 1
        kept = self.verdicts()
        self.fails({**env, **NO_TIME}, says)
        self.falls_back({**env, **NO_TIME})
        FIGURES["reference"] += 1
        self.assertEqual(self.verdicts(), kept)
        self.assertEqual([name for name in os.listdir(self.cache) if name.endswith(".program")], [])
        for path in kept:
            os.unlink(path)


class Planted(TrialCase):
    def test_crashes(self):
        for command, where in CRASHES.items():
            with self.subTest(command=command):
                self.found_out("crash " + command, rf"driver 9\.\d.* crashes: .*{where}.*update the driver.*remove /")

    def test_hangs(self):
        for command, (where, seconds) in HANGS.items():
            with self.subTest(command=command):
                begin = time.monotonic()
                self.found_out("crash " + command, rf"driver 9\.\d.* hangs: time ran out {where}.*update the driver",
                               TETRACUBES_TRIAL_SECONDS=str(seconds))
                if command == "open hang":  # nothing is built: it takes the time that is set, not ten times as much
                    self.assertLess(time.monotonic() - begin, 100)

    def test_refusals(self):
        for command, told in REFUSALS.items():
            with self.subTest(command=command):
                self.found_out("crash " + command, told + ".*remove /")

    def test_wrong(self):
        self.found_out("corrupt flip emit 10 4000 0", "gives wrong results.*remove /.*--engine reference")

    def test_fallback_on_the_first_run(self):
        self.falls_back(self.layer("crash build abort"))

    def test_stopped_from_outside(self):
        self.fails(self.layer("crash build kill"), "stopped.*signal 9.*try again")
        self.assertEqual([verdict for verdict, _ in self.verdicts().values()], ["good: "])  # of the device

    def test_no_linker(self):
        pocl = self.path("pocl")
        os.mkdir(pocl)
        environment = {"PATH": self.path("nothing"), "POCL_CACHE_DIR": pocl, "TETRACUBES_CACHE_DIR": self.cache}
        self.fails(environment, 'crashes: signal 6.*last words ".*link.*set PATH')
        self.assertNotIn("crashed", str(self.verdicts()))


class Texts(TrialCase):
    def test_other_variant(self):
        """A driver that fails with the kernels for one work-item gets those for groups."""
        expected = self.mesh("--engine", "reference")
        for fault in (f"crash build abort {ALONE}", f"crash launch exit {ALONE}", f"crash build refuse {ALONE}"):
            with self.subTest(fault=fault):
                env = self.layer(fault)
                self.assertEqual(self.mesh(env=env), expected)
                kept = self.verdicts()
                self.assertEqual(len(kept), 3)
                self.assertEqual(self.mesh(env={**env, **NO_TIME}), expected)
                self.assertEqual(self.verdicts(), kept)
                for path in kept:
                    os.unlink(path)

    def test_missing_samples_met_on_the_way(self):
        """The kernels for these are tried when the first is met, and may be the first that fail."""
        volume = self.generate("sphere", "b.nrrd", "30,20,10", "f32")
        with open(volume, "r+b") as file:
            file.seek(-400, os.SEEK_END)
            file.write(b"\0\0\xc0\x7f")
        self.arguments[1] = volume
        expected = self.mesh("--engine", "reference")
        env = self.layer("crash build abort -DMISSING=1")
        self.fails(env, r"driver 9\.\d.* crashes")
        self.falls_back(env)
        self.assertEqual(self.mesh(env=self.layer("lacks fame", cache="")), expected)


class Sound(TrialCase):
    def test_unknown_driver_passes(self):
        expected = self.mesh("--engine", "reference")
        env = self.layer("lacks fame")
        self.assertEqual(self.mesh(env=env), expected)
        kept = self.verdicts()
        self.assertEqual([verdict for verdict, _ in kept.values()], ["good: ", "good: "])
        programs = {name: os.stat(os.path.join(self.cache, name)).st_ino for name in os.listdir(self.cache)}
        self.assertEqual(self.mesh(env={**env, **NO_TIME}), expected)
        self.assertEqual({name: os.stat(os.path.join(self.cache, name)).st_ino for name in os.listdir(self.cache)},
                         programs)

    def test_known_driver_has_no_trial(self):
        [driver, *_] = [device["driver"] for device in self.report("devices")["devices"]]
        if not driver.startswith("3.1"):
            self.skipTest(f"{driver} is not known: of PoCL, 3.1 is")
        env = {"TETRACUBES_CACHE_DIR": self.cache, **NO_TIME}
        self.assertEqual(self.mesh(env=env), self.mesh("--engine", "reference"))
        self.assertEqual(self.verdicts(), {})

    def test_without_a_cache(self):
        expected = self.mesh("--engine", "reference")
        for cache in ("", "/proc/none"):
            self.assertEqual(self.mesh(env=self.layer("lacks fame", cache=cache)), expected)
            self.fails(self.layer("crash build abort", cache=cache), "crashes: .*reference engine$")

    def test_damaged_verdicts(self):
        env = self.layer("lacks fame")
        expected = self.mesh(env=env)
        for damage in (lambda text: text[:-1], lambda text: text + "x", lambda text: text.replace("good", "fine"),
                       lambda text: re.sub(r"driver 9\.\d", "driver 8.1", text), lambda text: ""):
            before = self.texts()
            for path, text in before.items():
                with open(path, "w", encoding="utf-8") as file:
                    file.write(damage(text))
            self.assertEqual(self.mesh(env=env), expected)
            self.assertEqual(self.texts(), before)

    def texts(self):
        found = {}
        for path in self.verdicts():
            with open(path, encoding="utf-8") as file:
                found[path] = file.read()
        return found

    def test_children_ignored(self):
        """A shell may have set SIGCHLD to be ignored: then nobody learns how a child ends."""
        result = subprocess.run([tool_case.TOOL, *self.arguments, "-o", self.path("a.ply")],
                                env={**os.environ, **self.layer("lacks fame")},
                                preexec_fn=lambda: signal.signal(signal.SIGCHLD, signal.SIG_IGN), timeout=1000,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
        self.assertEqual((result.returncode, result.stderr), (0, b""))


class Interrupted(TrialCase):
    def start(self, command="crash launch hang", kept=1):
        """The tool, once it has kept so many verdicts and waits for the next."""
        process = subprocess.Popen([tool_case.TOOL, *self.arguments, "-o", self.path("a.ply")], stderr=subprocess.PIPE,
                                   env={**os.environ, **self.layer(command)}, text=True)
        self.addCleanup(process.stderr.close)
        self.addCleanup(lambda: [os.kill(number, signal.SIGKILL) for number in trials_running()])
        for _ in range(3000):
            if trials_running() and len(self.verdicts()) == kept:
                return process
            time.sleep(0.01)
        process.kill()
        self.fail("no trial was started")

    def gone(self):
        for _ in range(500):
            if not trials_running():
                return True
            time.sleep(0.01)
        return False

    def test_cancelled(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            process = self.start()
            process.send_signal(number)
            self.assertIn("cancelled", process.communicate(timeout=240)[1])
            self.assertEqual(process.returncode, tool_case.cancelled_by(number))
            self.assertTrue(self.gone(), "the trial goes on")
            self.assertFalse(os.path.exists(self.path("a.ply")))

    def test_killed(self):
        """A trial that has something to say would end by itself, at the closed pipe; one that hangs does not."""
        for how in (), ("crash open hang", 0):
            process = self.start(*how)
            if how:
                wait_until_idle(*trials_running())
            process.kill()
            process.wait(60)
            self.assertTrue(self.gone(), "the trial outlives what started it")
            for path in self.verdicts():
                os.unlink(path)


def write_figures(seconds):
    if "long" not in sys.argv[3:]:
        return
    devices = json.loads(tool_case.tool("devices", "--json", env={"OPENCL_LAYERS": ""}).stdout)["devices"]
    names = {"planted": "drivers planted that crash, hang, refuse or compute wrongly",
             "told": "of these ended in a sentence", "reference": "of these done by the reference, --engine auto"}
    part_write("trials", {device["platform"]: device["driver"] for device in devices},
               [(what, FIGURES[key]) for key, what in names.items()], seconds)


if __name__ == "__main__":
    LAYER = os.path.abspath(sys.argv[2])
    tool_case.signals_as_usual()
    begin = time.monotonic()
    result = tool_case.main(exit=False).result
    if result.wasSuccessful():
        write_figures(time.monotonic() - begin)
    sys.exit(not result.wasSuccessful())
