#!/usr/bin/env python3
"""test_table1.py - bench/table1: its rows, its files of samples, its exit status; `test_table1.py TETRACUBES`

With TETRACUBES_DATA set the blunt fin is the real one, and its density is scaled too. Standard library only.
"""

import array
import importlib.machinery
import importlib.util
import json
import math
import os
import stat
import subprocess
import sys
import tempfile

TOOL = sys.argv[1]
DATA = os.environ.get("TETRACUBES_DATA")
TABLE1 = os.path.join(os.path.dirname(os.path.abspath(__file__)), "table1")
PAPER = [1642545, 32400, 87120, 2744280, 187395]
checks = failures = 0


def expect(condition, text):
    global checks, failures
    checks += 1
    if not condition:
        failures += 1
        print(f"FAILED: {text}")


def run(*arguments, tool=TOOL, data=DATA):
    environment = {key: value for key, value in os.environ.items() if key != "TETRACUBES_DATA"}
    if data:
        environment["TETRACUBES_DATA"] = data
    return subprocess.run([sys.executable, TABLE1, "--tool", tool, "--repeat", "1", *arguments], env=environment,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=600, check=False)


def load():
    """The script as a module."""
    loader = importlib.machinery.SourceFileLoader("table1", TABLE1)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("table1", loader))
    sys.dont_write_bytecode = True
    loader.exec_module(module)
    return module


def test_rows(table1):
    for row, tetrahedra in zip(table1.ROWS, PAPER, strict=True):
        expect(row.tetrahedra == tetrahedra, f"{row.name}: the paper has {tetrahedra}, not {row.tetrahedra}")
        expect(5 * math.prod(n - 1 for n in row.dims) == tetrahedra, f"{row.name}: dims {row.dims}")


def test_files(table1, folder):
    """Big-endian in, big-endian out; i reversed row by row."""
    values = array.array("f", range(80))
    path, copy = os.path.join(folder, "values"), os.path.join(folder, "copy")
    swapped = array.array("f", values)
    swapped.byteswap()
    with open(path, "wb") as file:
        file.write(b"head" + swapped.tobytes())
    head, got = table1.read_values(path, 4, 80)
    expect(head == b"head" and got == values, "values are read")
    for is_reversed, first, last in ((False, 0, 79), (True, 39, 40)):
        table1.write_values(copy, head, got, is_reversed)
        again = table1.read_values(copy, 4, 80)[1]
        expect((again[0], again[-1]) == (first, last), f"reversed {is_reversed}: {again[0]}, {again[-1]}")
    try:
        table1.read_values(path, 4, 81)
        expect(False, "a file that is cut short is refused")
    except table1.Failure:
        expect(True, "")


def test_run(folder):
    path = os.path.join(folder, "table1.json")
    done = run("--json", path, *(["--scalings"] if DATA else []))
    expect(done.returncode == 0, f"status {done.returncode}: {done.stderr}")
    if done.returncode:
        return
    with open(path, encoding="utf-8") as file:
        result = json.load(file)
    rows = result["rows"]
    expect([row["tetrahedra"] for row in rows] == PAPER, f"tetrahedra {[row['tetrahedra'] for row in rows]}")
    expect([row["stand_in"] for row in rows] == [False, True, True, True, not DATA], "stand-ins are marked")
    expect([row["paper_polygons"] for row in rows] == [73580, None, None, None, 5297 if DATA else None], "of the paper")
    expect(rows[0]["polygons"] == 73544, f"sphere: {rows[0]['polygons']} polygons")
    expect(all(0 < row["extract_ms"] < row["process_ms"] for row in rows), "times")
    for number in ("1,642,545", "73,544", "187,395"):
        expect(number in done.stdout, f"{number} is printed")
    if not DATA:
        expect("TETRACUBES_DATA is unset" in done.stdout and "scalings" not in result, "says what is missing")
        return
    expect(rows[4]["polygons"] == 5361, f"blunt fin: {rows[4]['polygons']} polygons")
    scalings = {(s["scaling"], s["reversed"]): s for s in result["scalings"]}
    expect(len(scalings) == 10, f"{len(scalings)} scalings")
    expect(scalings["255 (d - min) / (max - min), rounded", False]["triangles"] == 5361, "as the density itself")
    closest = scalings["255 d / max, rounded", True]
    expect(closest["triangles"] - closest["degenerate_triangles"] == 5293, f"closest: {closest}")


def test_failures(folder):
    done = run("--scalings", data=None)
    expect(done.returncode == 1 and "set TETRACUBES_DATA" in done.stderr, f"--scalings without data: {done.stderr}")
    done = run(tool=os.path.join(folder, "none"))
    expect(done.returncode == 1 and "none" in done.stderr, f"no tool: {done.stderr}")
    done = run(tool="/bin/false", data=None)
    expect(done.returncode == 1 and "status 1" in done.stderr, f"a tool that fails: {done.stderr}")
    report = {"tetrahedra": 5, "device": "none", "surfaces": [{"iso": 0, "triangles": 1, "timings_ms": {"classify": 1}}]}
    liar = os.path.join(folder, "liar")
    with open(liar, "w", encoding="utf-8") as file:
        file.write(f"#!/bin/sh\necho '{json.dumps(report)}'\n")
    os.chmod(liar, stat.S_IRWXU)
    done = run(tool=liar, data=None)
    expect(done.returncode == 1 and "other tetrahedra than the paper's: sphere" in done.stderr,
           f"wrong tetrahedra: {done.returncode}, {done.stderr}")


def main():
    table1 = load()
    with tempfile.TemporaryDirectory(prefix="tetracubes-test-") as folder:
        test_rows(table1)
        test_files(table1, folder)
        test_failures(folder)
        test_run(folder)
    print(f"{checks} checks, {failures} failed")
    sys.exit(failures != 0)


if __name__ == "__main__":
    main()
