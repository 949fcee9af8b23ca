#!/usr/bin/env python3
"""drivers.py TEST_BYTES [--out FILE] [--folder FOLDER] [--rusticl FOLDER] [--only NAME] [--cases quick]

The same bytes from every driver of OpenCL on this machine. Each that is installed runs test_bytes' cases (all types of
samples, all methods, all kinds of grids, small) in each variant of the kernels that it takes: for a work-item alone, with
and without AVX-512, and for groups. Every mesh is compared with the reference's there; here the hashes of all drivers
are compared, case by case. A driver that is not installed is told, and one that the library refuses for a known fault;
of the latter only quick cases count, which it gets right. Status 77 where there is none.

--out: what was found, as JSON. --only: of some drivers. --cases quick: some of the cases. --folder: for the runtime of
second_opencl.py, which is left out without it. --rusticl: where the script of that name unpacked Mesa's, else the
installed one.
"""
import argparse
import glob
import hashlib
import json
import os
import re
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
VENDORS = "/etc/OpenCL/vendors"

# Oclgrind: kernels as they are written; see tests/bytes/oclgrind.py.
OCLGRIND_OPTIONS = "-cl-opt-disable -Dinline_always= -Dline_prefetch(x)="


def icd_library(pattern):
    """Of an installed driver, as OCL_ICD_VENDORS takes it; None where there is none."""
    for path in sorted(glob.glob(f"{VENDORS}/*.icd")):
        with open(path, encoding="utf-8") as file:
            library = file.read().strip()
        if re.search(pattern, library, re.I):
            return path
    return None


def rusticl_find(folder):
    """Its library and environment: unpacked into the folder by the script rusticl, or installed."""
    found = glob.glob(os.path.join(folder or "-", "usr/lib/*/libRusticlOpenCL.so.1"))
    settings = {"RUSTICL_ENABLE": "llvmpipe"}
    if not found:
        return icd_library("rusticl"), settings
    return found[0], dict(settings, GALLIUM_PIPE_SEARCH_DIR=os.path.join(os.path.dirname(found[0]), "gallium-pipe"))


def second_library(folder):
    if not folder:
        return None
    done = subprocess.run([sys.executable, os.path.join(HERE, "..", "bytes", "second_opencl.py"), folder],
                          stdout=subprocess.PIPE, text=True, check=False)
    return done.stdout.strip().splitlines()[-1] if done.returncode == 0 else None


def oclgrind_library():
    return next(iter(glob.glob("/usr/lib/oclgrind/*rt-icd.so") + glob.glob("/usr/lib/*/oclgrind/*rt-icd.so")), None)


def processor_has_avx512():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        return "avx512bw" in file.read()


def drivers_list(folder, rusticl_folder):
    """Name, library, and of each text its name, work-items (0: what the device gets) and environment."""
    with_avx512 = [("one work-item, AVX-512", 0, {})] if processor_has_avx512() else []
    groups = ("groups of 32", 32)
    mesa, rusticl = rusticl_find(rusticl_folder)
    return [
        ("PoCL", icd_library("pocl"), with_avx512 + [
            ("one work-item, plain", 0, {"POCL_EXTRA_BUILD_FLAGS": "-DNO_AVX512"}),
            ("one work-item, no AVX2", 0, {"POCL_EXTRA_BUILD_FLAGS": "-DNO_AVX512 -DNO_AVX2"}),
            ("groups of 32", 32, {}), ("groups of 64", 64, {})]),
        ("rusticl, as a CPU", mesa, [(*groups, dict(rusticl, RUSTICL_DEVICE_TYPE="cpu", RUSTICL_FEATURES="fp64"))]),
        ("rusticl, as a GPU", mesa, [(*groups, dict(rusticl, RUSTICL_DEVICE_TYPE="gpu"))]),
        ("Intel's runtime for CPUs", second_library(folder), with_avx512 + [("groups of 32", 32, {})]),
        ("Oclgrind", oclgrind_library(), [(*groups, {"OCLGRIND_BUILD_OPTIONS": OCLGRIND_OPTIONS})]),
    ]


# Cases that go different ways through the kernels: parts of names, or, after "=", whole ones. rusticl 22.3 ends loops
# that are long, so the deep label map is left out, and Mesa gets one thread: groups of work-items run in order there,
# and none has to poll the sum of another.
ONE_THREAD = {"LP_NUM_THREADS": "1"}
QUICK = ["=u8 uniform", "=u8 uniform, missing, normals", "=u8 uniform, deep", "=u8 uniform, deep, snap",
         "=u8 uniform, hybrid", "=u8 uniform, snap", "=u8 uniform, closed", "=u8 uniform labels", "=u8 uniform interval",
         "f32 uniform, normals", "f32 uniform, missing, normals", "f64 uniform, hybrid", "f32 curvilinear, blanked",
         "u8 complex"]


def cases_run(program, library, texts, work_items, environment, cache):
    """What test_bytes says, and its status."""
    settings = dict(os.environ, OCL_ICD_VENDORS=library, TETRACUBES_CACHE_DIR=cache, POCL_CACHE_DIR=cache,
                    TETRACUBES_DEVICE="0", **environment)
    said = ""
    for text in texts:
        done = subprocess.run([program, "driver", text, str(work_items)], env=settings, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace", check=False, timeout=7200)
        said += done.stdout
        if done.returncode:
            return done.returncode, said
    return 0, said


def digest(hashes):
    return hashlib.sha256("\n".join(f"{case} {hashes[case]}" for case in sorted(hashes)).encode()).hexdigest()[:16]


def text_try(program, name, library, text, cases):
    """One line of the table; None where a known fault spoils it. Caches are its own: they know nothing of the
    environment."""
    what, work_items, environment = text
    if cases is QUICK:
        environment = dict(environment, **ONE_THREAD)
    start = time.time()
    with tempfile.TemporaryDirectory() as cache:
        status, said = cases_run(program, library, cases, work_items, environment, cache)
    fault = re.search(r"^known fault: (.*)$", said, re.M)
    if fault and cases is not QUICK:
        print(f"{name}, {what}: left out: {fault[1]}")
        return None
    hashes = dict(re.findall(r"^case (.*): ([0-9a-f]{16})$", said, re.M))
    refused = len(re.findall(r"^refused .*: no fp64$", said, re.M))
    device = re.search(r"^device (.*), driver (.*)$", said, re.M)
    launch = re.search(r"^launched with (\d+) work-items as (\w+)", said, re.M)
    line = {"driver": name, "device": device[1] if device else "", "version": device[2] if device else "", "text": what,
            "work_items": int(launch[1]) if launch else 0, "cases": len(hashes) - refused, "hash": digest(hashes),
            "outcome": "same bytes" if status == 0 and hashes else f"status {status}: {said[-400:]}",
            "seconds": round(time.time() - start), "hashes": hashes}
    print(f"{name} {line['version']}, {what}: {line['cases']} cases, {line['hash']}, {line['outcome']}, "
          f"{line['seconds']} s", flush=True)
    return line


def differences(lines):
    """Cases whose hashes are not the same everywhere."""
    known = {}
    for line in lines:
        for case, value in line["hashes"].items():
            first = known.setdefault(case, (value, line))
            if value != first[0]:
                yield (f"{case}: {value} by {line['driver']}, {line['text']}; {first[0]} by {first[1]['driver']}, "
                       f"{first[1]['text']}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("--out")
    parser.add_argument("--folder")
    parser.add_argument("--rusticl")
    parser.add_argument("--only", default="")
    parser.add_argument("--cases", choices=["all", "quick"], default="all")
    options = parser.parse_args()
    cases = QUICK if options.cases == "quick" else [""]
    lines = []
    for name, library, texts in drivers_list(options.folder, options.rusticl):
        if not re.search(options.only, name):
            continue
        if not library:
            print(f"{name}: not installed")
            continue
        lines += filter(None, [text_try(options.program, name, library, text, cases) for text in texts])
    wrong = list(differences(lines)) + [f"{line['driver']}, {line['text']}: {line['outcome']}" for line in lines
                                        if line["outcome"] != "same bytes"]
    if options.out:
        with open(options.out, "w", encoding="utf-8") as file:
            json.dump(lines, file, indent=1)
    print("\n".join(wrong))
    if not lines:
        print("skipped: no driver of OpenCL")
        sys.exit(77)
    print(f"{len(lines)} times all cases, {len({line['hash'] for line in lines})} hash(es)")
    sys.exit(1 if wrong else 0)


main()
