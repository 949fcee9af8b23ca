#!/usr/bin/env python3
"""long.py PART PROGRAM - the long tier of test_topology or test_geometry

PART is `topology` or `geometry`. As many processes at once as there are processors; those that follow each other share
a kernel cache, others have their own, as processes have raced in one. Prints what they print; where
TETRACUBES_RESULTS names a folder, PART.json there receives date, versions, seconds and figures. Exits with 1 where one
of them fails.
"""
import concurrent.futures
import os
import re
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
from part import part_write

KINDS = "uniform rectilinear curvilinear missing hybrid tetrahedra hexahedra mixed".split()
SHAPES = "sphere torus gyroid".split()
SEED, GRIDS = 1, 20000  # per kind and sample type
EVERY = 10              # of them one is extracted by the device too


def commands(part):
    if part == "geometry":
        return [["long", shape] for shape in SHAPES]
    random = [["random", kind, "all", str(SEED), str(GRIDS), str(EVERY), "any"] for kind in KINDS]
    return [["patterns", "large"], *random, ["faults"]]


def run(program, arguments, caches):
    cache = os.path.join(caches, str(threading.get_ident()))
    os.makedirs(cache, exist_ok=True)
    environment = {**os.environ, "POCL_CACHE_DIR": cache, "TETRACUBES_CACHE_DIR": ""}
    done = subprocess.run([program, *arguments], capture_output=True, text=True, env=environment)
    print("\n".join(["$ " + " ".join(["test", *arguments]), done.stdout + done.stderr]), flush=True)
    return done


def numbers(pattern, text):
    return [tuple(map(int, found.groups())) for found in re.finditer(pattern, text, re.M)]


def topology_figures(text):
    grids = numbers(r"^random .*?: (\d+) grids, (\d+) with a surface, (\d+) with parts missing, (\d+) on", text)
    return {
        "random grids checked against the signs of their samples": sum(row[0] for row in grids),
        "of them at least per kind of grid and sample type": min(row[0] for row in grids),
        "of them with parts missing": sum(row[2] for row in grids),
        "of them extracted by the OpenCL device too, bit for bit": sum(row[3] for row in grids),
        "all patterns of small grids, both parities, both methods": sum(
            n for n, in numbers(r"^patterns of .*?: (\d+) grids", text)),
        "all patterns of single cells": sum(n for n, in numbers(r"^patterns of .*?: (\d+) complexes", text)),
        "planted faults found": sum(n for n, in numbers(r"^found, .*?: (\d+) times", text)),
    }


def geometry_figures(text):
    figures = {"surfaces whose errors converge": len(re.findall(r"^order ", text, re.M))}
    for name in "vertex", "area", "volume":
        orders = [float(order) for found in re.findall(rf" {name}((?: \d+\.\d+)+) \(", text) for order in found.split()]
        figures[f"observed order of the {name} error, least"] = min(orders)
        figures[f"observed order of the {name} error, greatest"] = max(orders)
    figures["planted faults found"] = sum(n for n, in numbers(r"^planted faults, .*?: (\d+) found", text))
    return figures


def main():
    part, program = sys.argv[1:]
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as caches, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        runs = list(pool.map(lambda arguments: run(program, arguments, caches), commands(part)))
    if any(done.returncode for done in runs):
        return 77 if all(done.returncode in (0, 77) for done in runs) else 1
    text = "".join(done.stdout for done in runs)
    figures = {"topology": topology_figures, "geometry": geometry_figures}[part](text)
    device = re.search(r"^device: (.*)", text, re.M)
    for what, value in figures.items():
        print(f"{what}: {value}")
    lines = [line for line in text.splitlines() if re.match("random|patterns|found|order|planes|values", line)]
    part_write(part, {"device": device[1]} if device else {}, figures.items(), time.monotonic() - start, lines=lines)
    return 0


if __name__ == "__main__":
    sys.exit(main())
