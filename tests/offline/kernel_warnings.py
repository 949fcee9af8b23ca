#!/usr/bin/env python3
"""kernel_warnings.py quick|long TEXTS - no compiler has anything to say of the kernels, whatever the processor

What a driver's compiler thinks of kernels it may print where users see it. So every program of both variants (TEXTS is
kernel_texts, which writes them) is compiled by every clang there is, with -Wall, for processors with and without
AVX-512. And the variant for groups has to be plain OpenCL C: nothing stands in it that only some compilers know. quick:
some of the programs.

Each file says what it needs: it compiles by itself too, as editors see it, with the variant that it belongs to. Exit status
77 where there is no clang.
"""
import concurrent.futures
import glob
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

PROCESSORS = ["x86-64", "haswell", "skylake-avx512"]
SAMPLE = ["classify-u8-tetra", "classify-f32-tetra-missing", "classify-f64-hybrid", "classify-u8-snap",
          "emit-u8-tetra-uniform", "emit-f32-snap-curvilinear-missing-normals", "snap-u8", "snap-f64-missing",
          "emit-f32-hybrid-rectilinear-missing-normals", "emit-f64-tetra-curvilinear-missing-normals", "complex-f32",
          "classify-u8-tetra-closed", "classify-f32-snap-missing-closed", "emit-f32-tetra-uniform-closed",
          "emit-f32-snap-curvilinear-missing-normals-closed",
          "emit-f32-hybrid-rectilinear-missing-normals-closed",
          "whole-f32", "complex-f32-closed", "whole-f32-closed", "labels-u16",
          "interval-u8-uniform", "interval-f32-curvilinear-missing", "complex-f32-interval"]

ALL_DEFINED = "emit-f32-hybrid-rectilinear-missing-normals-closed"  # its options define what any file looks at
KERNELS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "kernels")
FILES = {os.path.basename(path): path for path in glob.glob(os.path.join(KERNELS, "*", "*"))}

# Work-items of a group, of which one has the other variant; quick: all processors for it, where most can differ.
ALONE, GROUPS = "1", "32"

# What is no OpenCL C 1.2. Attributes are hints here, which others pass over.
FOREIGN = [(re.compile(r"__builtin_\w+"), "a compiler's function"),
           (re.compile(r"ext_vector_type|vector_size"), "vectors of a compiler's own"),
           (re.compile(r"\b_Pragma\b|#pragma clang loop"), "a hint"),
           (re.compile(r"\b(?:__)?asm(?:__)?\b"), "assembly"),
           (re.compile(r"\b(?:u?char|u?short|u?int|u?long|float|double)(?!(?:2|3|4|8|16)\b)\d+\b"), "a vector")]

PLANTED = [("static int twice(int n) { int unused; return 2 * n; }", "unused", None),
           ("static uint16 same(uint16 a) { return a; } kernel void k(global uint16 *x) { *x = same(*x); }", "ABI",
            None),
           ("typedef float floats __attribute__((ext_vector_type(32)));", None, "vectors of a compiler's own"),
           ("float32 x;", None, "a vector"), ("ulong n = __builtin_clz(5);", None, "a compiler's function")]


def clangs():
    """One of every version."""
    found = {}
    for path in [shutil.which("clang")] + sorted(glob.glob("/usr/bin/clang-[0-9][0-9]")):
        if path:
            version = subprocess.run([path, "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout
            found.setdefault(re.search(r"version (\d+)", version)[1], path)
    return found


def compiled(clang, processor, options, text):
    """What the compiler says, which is nothing."""
    command = [clang, "-x", "cl", "-D__OPENCL_VERSION__=120", "-Xclang", "-finclude-default-header", "-fno-builtin",
               "-target", "x86_64-linux-gnu", f"-march={processor}", "-Wall", "-O0", "-S", "-emit-llvm", "-o",
               "/dev/null", *options, text]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    said = done.stdout.strip()
    return f"status {done.returncode}: {said[-2000:]}" if said or done.returncode else ""


def foreign(text):
    return [what for pattern, what in FOREIGN if pattern.search(re.sub(r"/\*.*?\*/", "", text, flags=re.S))]


def programs(texts, work_items, folder):
    """Name, text and options of each of them."""
    subprocess.run([texts, "pocl", work_items, folder], stdout=subprocess.DEVNULL, check=True)
    for path in sorted(glob.glob(os.path.join(folder, "*.cl"))):
        with open(path[:-3] + ".options", encoding="utf-8") as file:
            yield os.path.basename(path)[:-3], path, shlex.split(file.read())


def planted_check(clang, folder):
    for n, (text, warning, finding) in enumerate(PLANTED):
        path = os.path.join(folder, f"planted{n}.cl")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        if warning and warning not in compiled(clang, "haswell", ["-cl-std=CL1.2"], path):
            sys.exit(f"no warning of {text!r}")
        if finding and finding not in foreign(text):
            sys.exit(f"{finding} is not found in {text!r}")


def jobs_list(tier, texts, folder, versions):
    for work_items in (ALONE, GROUPS):
        place = os.path.join(folder, work_items)
        os.mkdir(place)
        for name, path, options in programs(texts, work_items, place):
            if tier == "quick" and name not in SAMPLE:
                continue
            for version, clang in versions.items():
                for processor in PROCESSORS if work_items == ALONE or tier == "long" else PROCESSORS[:1]:
                    yield (f"{name}, {work_items} work-items, clang {version}, {processor}",
                           (clang, processor, options, path), work_items)


def files_check(jobs, clang):
    """What is wrong with files compiled by themselves; every file belongs to some program."""
    options, seen, wrong = {}, {}, []
    for _, (_, _, given, path), work_items in jobs:
        if work_items == ALONE and os.path.basename(path).startswith("interval-"):
            continue  # the text for groups, in both variants
        if os.path.basename(path).startswith(ALL_DEFINED):
            options[work_items] = given
        with open(path, encoding="utf-8") as file:
            seen.setdefault(work_items, set()).update(re.findall(r'#line 1 "(\w+\.cl)"', file.read()))
    for work_items, names in seen.items():
        for name in sorted(names):
            whole = ["-DWHOLE=1"] if name.startswith("whole_") else []
            said = compiled(clang, "skylake-avx512", ["-Wno-unused-function", *options[work_items], *whole],
                            FILES[name])
            if said:
                wrong.append(f"{name} by itself, {work_items} work-items: {said}")
    left = {name for name in FILES if name.endswith(".cl")} - set().union(*seen.values())
    return wrong + [f"{name}: in no program" for name in sorted(left)]


def main():
    tier, texts = sys.argv[1:]
    versions = clangs()
    if not versions:
        print("skipped: no clang (Debian: apt install clang)")
        sys.exit(77)
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        for clang in versions.values():
            planted_check(clang, folder)
        jobs = list(jobs_list(tier, texts, folder, versions))
        for path in {job[1][3] for job in jobs if job[2] == GROUPS}:
            with open(path, encoding="utf-8") as file:
                wrong += [f"{os.path.basename(path)}: {what}" for what in foreign(file.read())]
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            said = list(pool.map(lambda job: compiled(*job[1]), jobs))
        wrong += [f"{job[0]}: {text}" for job, text in zip(jobs, said) if text]
        wrong += files_check(jobs, next(iter(versions.values())))
    if not jobs:
        sys.exit("no programs")
    print("\n".join(wrong[:10]))
    print(f"{len(jobs)} programs compiled by clang {', '.join(versions)}, for {', '.join(PROCESSORS)}; "
          f"{len(wrong)} wrong")
    sys.exit(1 if wrong else 0)


main()
