"""memcheck.py - every kernel as PoCL compiles it, under valgrind: memory, and uninitialised values

Valgrind's memcheck follows every bit of the processor's own instructions: a branch, an address or a system call that
depends on memory that nobody wrote, and any byte beside a buffer, is a finding. Work on small grids of every kind is
test_bytes' (small), with buffers of the device's own, so the bytes are compared as well: there, too, a byte that nobody
wrote would be a finding. Two kernels with planted faults (faults.c) show that it reports.
Valgrind knows no AVX-512: PoCL compiles for a processor without it (plain_processor.c), beforehand and by itself, since
a compiler takes minutes under valgrind.

Usage: memcheck.py quick|long TEST_BYTES FAULTS PLAIN_PROCESSOR
With TETRACUBES_RESULTS in the environment, a folder, the figures of a long run go to memcheck.json in it.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
from part import part_write

HERE = os.path.dirname(os.path.abspath(__file__))
FOUND = 99  # exit status of valgrind where it has findings
CHECKER = ["valgrind", "--quiet", f"--error-exitcode={FOUND}",
           "--suppressions=" + os.path.join(HERE, "memcheck.supp")]

FAULTS = [  # fault, what the log has to say
    ("none", None),
    ("bounds", "Invalid write"),
    ("unset", "depends on uninitialised value"),
]

# Of quick: one kind of each engine; oclgrind.py has the other kinds there.
QUICK = ["f32 uniform, normals", "f32 complex"]


def run(command, environment):
    """Exit status and what is printed; no test takes an hour."""
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, timeout=3600)
    return done.returncode, done.stdout


class Runs:
    """Programs whose kernels are compiled first, natively, then run again under valgrind, from one cache."""

    def __init__(self, plain_processor, folder):
        self.log = os.path.join(folder, "log")
        self.checked = dict(os.environ, POCL_CACHE_DIR=os.path.join(folder, "kernels"), TETRACUBES_CACHE_DIR="",
                            POCL_MAX_PTHREAD_COUNT="1", POCL_CPU_MAX_CU_COUNT="1", TEST_BYTES_ALWAYS_COPY="1")
        self.compiling = dict(self.checked, LD_PRELOAD=plain_processor)
        os.mkdir(self.checked["POCL_CACHE_DIR"])

    def check(self, command):
        """What the program prints, its exit status under valgrind, and valgrind's log."""
        status, printed = run(command, self.compiling)
        if status:
            print(printed)
            sys.exit(status)  # 77: no device
        with open(self.log, "w", encoding="utf-8"):
            pass
        status, checked = run([*CHECKER, f"--log-file={self.log}", *command], self.checked)
        if status in (0, FOUND) and checked != printed:
            sys.exit(f"{' '.join(command)} does not print under valgrind what it prints without:\n{printed}\n{checked}")
        with open(self.log, encoding="utf-8", errors="replace") as log:
            return checked, status, log.read()


def faults_check(runs, program):
    for fault, wanted in FAULTS:
        _, status, log = runs.check([program, fault])
        if status != (FOUND if wanted else 0) or (wanted or "") not in log:
            sys.exit(f"faults {fault}: status {status}, and the log does not say {wanted!r} but\n{log}")
    print(f"{len(FAULTS)} kernels with planted faults, or none, judged right")


def cases_check(runs, program, text):
    """Cases and meshes, all without a finding, and the device."""
    printed, status, log = runs.check([program, "small", text])
    if status:
        sys.exit(f"test_bytes small {text!r}: status {status}\n{printed}\n{log[:20000]}")
    cases, meshes = re.search(r"^figures (\d+) cases, \d+ variants, (\d+) meshes", printed, re.M).groups()
    return int(cases), int(meshes), re.search(r"^device .*?, (.*), driver (.*)$", printed, re.M).groups()


def results_write(cases, meshes, device, seconds):
    valgrind = run(["valgrind", "--version"], None)[1].split("-")[-1].strip()
    figures = [("cases on PoCL under valgrind, memory and uninitialised values", cases), ("meshes of these", meshes),
               ("findings", 0), ("planted faults reported", sum(1 for _, wanted in FAULTS if wanted))]
    part_write("memcheck", {"valgrind": valgrind, "device": device[0], "driver": device[1]}, figures, seconds)


def main():
    tier, program, faults, plain_processor = sys.argv[1:]
    start, cases, meshes, device = time.time(), 0, 0, None
    if not shutil.which("valgrind"):
        print("skipped: no valgrind (Debian: apt install valgrind)")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="tetracubes-memcheck-") as folder:
        runs = Runs(plain_processor, folder)
        faults_check(runs, faults)
        for text in QUICK if tier == "quick" else [""]:
            more_cases, more_meshes, device = cases_check(runs, program, text)
            cases, meshes = cases + more_cases, meshes + more_meshes
    print(f"{cases} cases, {meshes} meshes, without findings, on {device[0]}")
    if tier == "long":
        results_write(cases, meshes, device, time.time() - start)


main()
