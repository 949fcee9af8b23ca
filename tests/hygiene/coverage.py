#!/usr/bin/env python3
"""Lines and branches of host/ that the tests run.

    coverage.py SOURCE BUILD [CTEST-ARGUMENT...]

Builds with gcc's --coverage into BUILD/coverage, runs the tests there with the kernels that BUILD has compiled, and
prints what gcovr counts, per folder, and the lines that nothing ran. Lines that only a failing device, allocation or file
system reaches do not count: they are those of a branch that returns such a failure, listed as FAILURES below, and
tests that inject failures run them. Fails below 90 % of the lines that count. Writes coverage.json where
TETRACUBES_RESULTS names a folder. Exit status 77: gcovr is not installed.
"""
import argparse
import json
import os
import re
import shutil
import sys
from collections import defaultdict
from pathlib import Path

from results import Part, run, tool_version

# test_abi: the library exports what the compiler counts with, too.
LEFT_OUT = ("^(test_install|test_readme|test_sanitized|test_static|test_data|test_abi|.*_always_copy|"
            "test_device_one_thread)$")
FAILURES = re.compile(r"TC_ERROR_MEMORY|TC_ERROR_DEVICE|(?:opencl|context)_fail|no_memory\(|"
                      r"STATUS_FAILED, .*(?:memory|written|write)|\berrno\b|strerror")
LEAST_PERCENT = 90.0


def build(source, folder, jobs):
    run(["cmake", "-S", source, "-B", folder, "-G", "Ninja", "-DCMAKE_C_COMPILER=gcc", "-DCMAKE_BUILD_TYPE=Debug",
         "-DCMAKE_C_FLAGS=--coverage -O1 -fprofile-update=atomic", "-DTETRACUBES_BENCH=OFF"])
    run(["cmake", "--build", folder, "--parallel", jobs])
    for counts in folder.glob("**/*.gcda"):
        counts.unlink()


def test(build_folder, folder, jobs, more):
    for part in (build_folder / "tests" / "kernel_pool").glob("*"):
        shutil.copytree(part, folder / "tests" / "kernel_pool" / part.name, dirs_exist_ok=True)
    plain = {name: value for name, value in os.environ.items() if name != "TETRACUBES_RESULTS"}
    done = run(["ctest", "--test-dir", folder, "-j", jobs, "--timeout", "1800", "-E", LEFT_OUT, *more], check=False,
               env=plain)  # samples of what the long tier runs whole are no results of it
    print("\n".join(done.stdout.splitlines()[-12:]), flush=True)
    return done.returncode


def measure(source, folder):
    """{file: gcovr's record} of the sources in host/"""
    done = run(["gcovr", "--root", source, "--filter", re.escape(f"{source}/host/"), "--object-directory", folder, "--json",
                "--exclude-unreachable-branches", "--exclude-throw-branches", folder])
    text = done.stdout[done.stdout.index("{"):]
    return {record["file"]: record for record in json.JSONDecoder().raw_decode(text)[0]["files"]}


def tally(source, record):
    """(lines, run, lines of failures that nothing ran, branches, taken, lines that nothing ran) of one file"""
    text = (source / record["file"]).read_text(encoding="utf-8").splitlines()
    lines = {line["line_number"]: line["count"] for line in record["lines"] if not line.get("gcovr/noncode")}
    missed = [number for number, count in lines.items() if not count]
    injected = [number for number in missed if FAILURES.search(text[number - 1])]
    branches = [branch["count"] for line in record["lines"] for branch in line.get("branches", [])]
    rest = [number for number in missed if number not in injected]
    return len(lines), len(lines) - len(missed), len(injected), len(branches), sum(map(bool, branches)), rest


def report(source, records, part):
    """Prints the table; the percentage of lines that count."""
    folders = defaultdict(lambda: [0] * 5)
    for name, record in sorted(records.items()):
        *numbers, rest = tally(source, record)
        if rest:
            print(f"never run: {name}: {' '.join(map(str, rest))}")
        for key in (str(Path(name).parent), "host"):
            folders[key] = [a + b for a, b in zip(folders[key], numbers)]
    print(f"\n{'folder':14}{'lines':>8}{'run':>8}{'%':>7}{'failures':>10}{'% of the rest':>15}{'branches':>10}{'%':>7}")
    details = {}
    for name, (lines, ran, injected, branches, taken) in sorted(folders.items()):
        details[name] = {"lines_percent": round(100 * ran / lines, 1),
                         "lines_percent_without_failures": round(100 * ran / (lines - injected), 1),
                         "branches_percent": round(100 * taken / max(branches, 1), 1)}
        print(f"{name:14}{lines:8}{ran:8}{100 * ran / lines:7.1f}{injected:10}{100 * ran / (lines - injected):15.1f}"
              f"{branches:10}{100 * taken / max(branches, 1):7.1f}")
    whole = details["host"]
    part.figure("lines of host/ that tests run, %", whole["lines_percent"])
    part.figure("the same without lines of injected failures, %", whole["lines_percent_without_failures"])
    part.figure("branches of host/ that tests take, %", whole["branches_percent"])
    part.write(folders=details)
    return whole["lines_percent_without_failures"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", type=Path)
    parser.add_argument("build", type=Path)
    arguments, more = parser.parse_known_args()
    source, build_folder = arguments.source.resolve(), arguments.build.resolve()
    if not shutil.which("gcovr"):
        print("skipped: gcovr is not installed")
        return 77
    part = Part("coverage", [tool_version("gcc"), tool_version("gcovr")])
    folder, jobs = build_folder / "coverage", str(len(os.sched_getaffinity(0)))
    build(source, folder, jobs)
    failed = test(build_folder, folder, jobs, more)
    percent = report(source, measure(source, folder), part)
    if percent < LEAST_PERCENT:
        print(f"{percent} % of lines, and {LEAST_PERCENT} are wanted")
    return 1 if failed or percent < LEAST_PERCENT else 0


if __name__ == "__main__":
    sys.exit(main())
