"""oclgrind.py - every kernel under Oclgrind: memory, data races, uninitialised values, calls of OpenCL

Oclgrind simulates a device and writes what it finds to a log, wrong calls to standard error; its exit status is the
program's, so these are what is judged: they have to be empty, but for what EXCLUDED explains. Work on small grids of
every kind is test_bytes' (small), so the bytes are compared as well. Kernels with planted faults (faults.c) show that
each check reports. Triangle soups are the writers' work: no kernel makes them.

Usage: oclgrind.py quick|long TEST_BYTES FAULTS WRITE_LAYER
With TETRACUBES_RESULTS in the environment, a folder, the figures of a long run go to oclgrind.json in it.
"""
import glob
import os
import re
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
from part import part_write

# Kernels as they are written: optimised ones have instructions that the simulator does not know; so has prefetching.
BUILD_OPTIONS = "-cl-opt-disable -Dinline_always= -Dline_prefetch(x)="

RACES = {"OCLGRIND_DATA_RACES": "1", "OCLGRIND_CHECK_API": "1"}

# Oclgrind does not note what it reads through CL_MEM_USE_HOST_PTR, so that buffers are the device's own here; for
# threads that share its notes, and for writes to parts of buffers, see write_layer.c. Work-items alone, and complexes,
# are left out: vectors put together of shorter ones (shufflevector to more elements) end the simulator.
UNINITIALISED = {"OCLGRIND_UNINITIALIZED": "1", "OCLGRIND_NUM_THREADS": "1", "TEST_BYTES_ALWAYS_COPY": "1"}

EXCLUDED = [
    # Look-back and tickets need no exclusion: Oclgrind takes two atomics on one word for no race. The table of edges is
    # read without one, volatile, before atomic_cmpxchg or atomic_min: one aligned word that only goes from empty to an
    # edge's place and to earlier places of the same edge, so that any value leads to the same entry, and is checked.
    re.compile(r"^Read-write data race .*\n\tKernel: (?:complex_join|whole_cut)\n(?=(?:.*\n)*?.*load volatile i32)"
               r"(?=(?:.*\n)*?.*@_Z\d+atomic_(?:cmpxchg|min))"),
    # A pass of snap reads whole words of the bricks around while their groups store to them. What these add are samples
    # of the pass's own colour, and a reader takes only bits of other colours (kernels/snap/snap.cl).
    re.compile(r"^Read-write data race .*\n\tKernel: snap_even\n(?=(?:.*\n)*?.*(?:vload8| load i64))"
               r"(?=(?:.*\n)*?.*(?:vstore8| store i64))"),
    # Its own mistake: the upper half of a vector (shufflevector to fewer elements) counts as uninitialised.
    re.compile(r"^Controlflow depends on uninitialized value\n.*\n.*\n.* call spir_func <\d+ x i\d+> "
               r"@_Z3(?:min|max)Dv"),
    # Likewise a sum of vectors of which one lane is: kernel 2 makes the numbers of all vertices of a cube side by side,
    # also of those that are not there and begin nowhere, which no vertex and no triangle takes. So it says nothing here
    # of where kernel 2 writes; memcheck.py does, of what PoCL makes of it, and test_memory.
    re.compile(r"^Uninitialized (?:value written|address used to write) to global memory .*\n\tKernel: emit\n"),
    # Kernel 2 copies where the vertices of a row begin into its table, also of rows in bricks that emit nothing: kernel 1
    # writes no beginning there, and as no edge of such a row is crossed none is read from the table.
    re.compile(r"^Uninitialized value written to local memory .*\n\tKernel: emit\n(?:.*\n)*?.*emit_rows\.cl"),
]

FAULTS = [  # fault, checks, what the log has to say
    ("none", RACES, None),
    ("none", UNINITIALISED, None),
    ("bounds", RACES, "Invalid write of size 4"),
    ("race", RACES, "data race"),
    ("groups", RACES, "data race"),
    ("uninitialised", UNINITIALISED, "Uninitialized value written"),
    ("api", RACES, "CL_INVALID_ARG_INDEX"),
]

# One case, for kernel 1: of others Oclgrind reports what every vector with an unused lane would give.
UNINITIALISED_CASES = ["f32 uniform, normals"]

# Of quick: what goes other ways through the kernels than the one before. "deep" is of tetra and of snap.
QUICK_RACES = ["i32 uniform, missing", "u8 uniform, hybrid", "u8 uniform, deep", "f32 curvilinear, blanked",
               "f32 complex"]


def library_find():
    places = ("/usr/lib/oclgrind", "/usr/lib/*/oclgrind")
    found = [path for place in places for path in glob.glob(place + "/liboclgrind-rt-icd.so")]
    if not found:
        print("skipped: no Oclgrind (Debian: apt install oclgrind)")
        sys.exit(77)
    return found[0]


def simulate(command, checks, layer=None):
    """Runs the command on the simulator; its output and the log."""
    with tempfile.NamedTemporaryFile() as log:
        environment = dict(os.environ, OCL_ICD_VENDORS=library_find(), OCLGRIND_BUILD_OPTIONS=BUILD_OPTIONS,
                           OCLGRIND_LOG=log.name, OCLGRIND_MAX_ERRORS="1000000", TETRACUBES_CACHE_DIR="", **checks)
        if layer:
            environment["OPENCL_LAYERS"] = layer
        done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        text = open(log.name).read()
    if done.returncode:
        sys.exit(f"{' '.join(command)}: status {done.returncode}\n{done.stdout}{text[:2000]}")
    misused = re.findall(r"^Oclgrind - OpenCL runtime error detected\n(?:\t.*\n)+", done.stdout, re.M)
    return done.stdout, "\n\n".join([text] + misused)


def findings(log):
    """Messages of a log that nothing excludes."""
    messages = [message.strip() for message in log.split("\n\n") if message.strip()]
    return [message for message in messages if not any(pattern.search(message) for pattern in EXCLUDED)]


def faults_check(program, layer):
    for fault, checks, wanted in FAULTS:
        _, log = simulate([program, fault], checks, layer if checks is UNINITIALISED else None)
        found = findings(log)
        if bool(wanted) != bool(found) or (wanted and wanted not in log):
            sys.exit(f"faults {fault}: the log does not say {wanted!r} but\n{log}")
    print(f"{len(FAULTS)} kernels with planted faults, or none, judged right")


def cases_check(program, tier, text, checks, layer, figures):
    output, log = simulate([program, tier, text], checks, layer)
    found = findings(log)
    if found:
        sys.exit(f"test_bytes {tier} {text!r}, {sorted(checks)}: {len(found)} findings\n\n" +
                 "\n\n".join(found[:10]))
    device = re.search(r"^device .*driver (.*)$", output, re.M)
    numbers = re.search(r"^figures (\d+) cases, \d+ variants, (\d+) meshes", output, re.M)
    if not device or not numbers or "Oclgrind" not in device[1]:
        sys.exit(f"test_bytes did not run on Oclgrind:\n{output}")
    figures["version"] = device[1].split()[-1]
    for key, n in (("cases", 1), ("meshes", 2)):
        figures[key] = figures.get(key, 0) + int(numbers[n])


def results_write(races, uninitialised, seconds):
    figures = [("cases under Oclgrind, memory, races and calls", races["cases"]),
               ("meshes of these", races["meshes"]),
               ("cases under Oclgrind, uninitialised values", uninitialised["cases"]),
               ("meshes of these", uninitialised["meshes"]),
               ("planted faults reported", sum(1 for fault in FAULTS if fault[2]))]
    part_write("oclgrind", {"Oclgrind": races["version"]}, figures, seconds)


def main():
    tier, program, faults, layer = sys.argv[1:]
    start, races, uninitialised = time.time(), {}, {}
    library_find()
    faults_check(faults, layer)
    for text in QUICK_RACES if tier == "quick" else [""]:
        cases_check(program, "small", text, RACES, None, races)
    for text in UNINITIALISED_CASES:
        cases_check(program, "groups", text, UNINITIALISED, layer, uninitialised)
    print(f"{races['meshes']} meshes without races or faults of memory, {uninitialised['meshes']} without "
          "uninitialised values")
    if tier == "long":
        results_write(races, uninitialised, time.time() - start)


main()
