#!/usr/bin/env python3
"""test_tune.py - tetracubes-bench --tune from outside: what it prints is what it keeps, and it finds out early that it
cannot. Standard library only.
"""

import json
import os
import re
import subprocess
import sys
import tempfile

BENCH = sys.argv[1]
NAMES = ["work_items", "work_groups", "tile_bricks"]
CASE = ["--field", "gyroid", "--dims", "97", "--type", "u8", "--repeat", "1"]
checks = failures = 0


def expect(condition, text):
    global checks, failures
    checks += 1
    if not condition:
        failures += 1
        print(f"FAILED: {text}")


def bench(cache, *arguments):
    environment = dict(os.environ, TETRACUBES_CACHE_DIR=cache)
    return subprocess.run([BENCH, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=560,
                          env=environment, check=False)


def kept(cache):
    """Values and device of the only line of the tuning file."""
    with open(os.path.join(cache, "tuning"), encoding="utf-8") as file:
        match = re.fullmatch(r"work_items=(\d+) work_groups=(\d+) tile_bricks=(\d+) device=(.+)\n", file.read())
    return ([int(match[n]) for n in (1, 2, 3)], match[4]) if match else (None, "")


def test_tune(cache):
    done = bench(cache, "--tune", "--json", *CASE)
    expect(done.returncode == 0, f"--tune --json ends with {done.returncode}: {done.stderr}")
    report = json.loads(done.stdout)
    values, device = kept(cache)
    expect(list(report) == ["device", "driver", *NAMES, "tried", "times_as_fast"], f"keys {list(report)}")
    expect(values == [report[name] for name in NAMES], f"kept {values}, reported {report}")
    expect(report["device"] in device and report["driver"] in device, f"kept for {device}")
    # Each way through a list ends where times get far slower: four ways have values, however noisy the machine is. One,
    # groups of work-items, may end before the first: PoCL 6 can take longer for these than a trial may.
    expect(report["tried"] >= 3 and report["times_as_fast"] >= 1, f"{report}")

    done = bench(cache, "--tune", *CASE)
    rows = [line.split() for line in done.stdout.splitlines() if re.match(r" +\d", line)]
    expect(done.returncode == 0 and [int(word) for word in rows[0][:3]] == values, f"does not begin with {values}: {rows}")
    best = re.search(r"best: work_items (\d+), work_groups (\d+), tile_bricks (\d+):", done.stdout)
    expect(best and [int(best[n]) for n in (1, 2, 3)] == kept(cache)[0], f"kept {kept(cache)}: {done.stdout}")


def test_refused(folder):
    file = os.path.join(folder, "file")
    with open(file, "w", encoding="ascii"):
        pass
    for cache in ["", os.path.join(file, "cache")]:
        done = bench(cache, "--tune", *CASE)
        expect(done.returncode == 1 and "TETRACUBES_CACHE_DIR" in done.stderr and not done.stdout,
               f"cache {cache!r}: {done.returncode} {done.stderr!r} {done.stdout!r}")
    for other in [["--turns"], ["--dump", file]]:
        done = bench("", "--tune", *CASE, *other)
        expect(done.returncode == 2 and other[0] in done.stderr, f"{other}: {done.returncode} {done.stderr!r}")


def main():
    with tempfile.TemporaryDirectory(prefix="tetracubes-tune-test-") as folder:
        test_tune(os.path.join(folder, "cache"))
        test_refused(folder)
    print(f"{checks} checks, {failures} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
