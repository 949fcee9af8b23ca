#!/usr/bin/env python3
"""test_bench.py - tetracubes-bench from outside: its JSON, second isovalue, sweep, turns, dump and statuses

Known counts come from the definition: the corner lattice of a 17^3 sphere is small enough to count crossed edges here.
Standard library only.
"""

import json
import os
import struct
import subprocess
import sys
import tempfile

BENCH = sys.argv[1]
SPREADS = ["classify_ms", "emit_ms", "extract_ms", "extract_warm_ms", "second_classify_ms", "second_emit_ms",
           "second_warm_ms", "reference_ms"]
CASE_KEYS = {"field", "dims", "type", "iso", "grid", "method", "vertices", "triangles", "hash", "repeats", "second_iso",
             "second_vertices", "second_triangles", "second_hash", "limit_ms", "limit_ratio", *SPREADS}
checks = failures = 0


def expect(condition, text):
    global checks, failures
    checks += 1
    if not condition:
        failures += 1
        print(f"FAILED: {text}")


def bench(*arguments, text=""):
    return subprocess.run([BENCH, *arguments], input=text, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          timeout=300, check=False)


def expect_case(case, label, method="tetra"):
    expect(set(case) == CASE_KEYS, f"{label}: keys {sorted(case)}")
    expect(case["method"] == method, f"{label}: method {case['method']}")
    expect(len(case["hash"]) == 16 and int(case["hash"], 16) >= 0, f"{label}: hash {case['hash']}")
    for key in SPREADS:
        times = case[key]
        expect(set(times) == {"median", "min", "max"}, f"{label}: {key} has {sorted(times)}")
        expect(0 <= times["min"] <= times["median"] <= times["max"], f"{label}: {key} {times}")
    expect(case["limit_ms"] > 0, f"{label}: limit_ms {case['limit_ms']}")
    ratio = case["extract_warm_ms"]["median"] / case["limit_ms"]
    expect(abs(case["limit_ratio"] / ratio - 1) < 0.05, f"{label}: limit_ratio {case['limit_ratio']}, not {ratio}")


def expect_limits(report):
    keys = ["device", "driver", "read_gbps", "write_gbps", "cases", "left_out"]
    expect(list(report) == keys, f"keys {list(report)}")
    expect(report["device"] and report["driver"], "device and driver are named")
    expect(report["read_gbps"] > 0.1 and report["write_gbps"] > 0.1, f"limits {report['read_gbps']}")


def crossed_edges(dims, values, iso):
    """Vertices of the surface: edges of the split, along axes and one diagonal per face, whose ends differ."""
    steps = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    planes = [(0, 1), (0, 2), (1, 2)]

    def inside(point):
        return values[point[0] + dims[0] * (point[1] + dims[1] * point[2])] >= iso

    def edges(point):
        for step in steps:
            yield point, tuple(map(sum, zip(point, step)))
        for a, b in planes:
            at_a, at_b = (tuple(c + (axis == e) for axis, c in enumerate(point)) for e in (a, b))
            both = tuple(c + (axis in (a, b)) for axis, c in enumerate(point))
            yield (point, both) if sum(point) % 2 == 0 else (at_a, at_b)

    points = [(x, y, z) for z in range(dims[2]) for y in range(dims[1]) for x in range(dims[0])]
    count = 0
    for point in points:
        for ends in edges(point):
            if all(c < n for end in ends for c, n in zip(end, dims)):
                count += inside(ends[0]) != inside(ends[1])
    return count


def test_json():
    done = bench("--field", "sphere", "--field", "gyroid", "--dims", "17", "--dims=20,9,33", "--type", "u8", "--type",
                 "f32", "--repeat", "3", "--json")
    expect(done.returncode == 0, f"a run ends with {done.returncode}: {done.stderr}")
    report = json.loads(done.stdout)
    expect_limits(report)
    names = [(case["field"], case["dims"], case["type"]) for case in report["cases"]]
    wanted = [(field, dims, kind) for field in ("sphere", "gyroid") for kind in ("u8", "f32")
              for dims in ([17, 17, 17], [20, 9, 33])]
    expect(names == wanted, f"cases {names}")
    for case in report["cases"]:
        expect_case(case, f"{case['field']} {case['dims']} {case['type']}")
        expect(case["repeats"] == 3, f"{case['repeats']} repeats of 3")
    expect(report["left_out"] == [], f"left out: {report['left_out']}")
    return report["cases"][0]


def cases_of(*arguments):
    done = bench(*arguments, "--repeat", "1", "--json")
    expect(done.returncode == 0, f"{arguments}: {done.returncode} {done.stderr!r}")
    return json.loads(done.stdout)


def test_grids(made):
    """The same surface in other places."""
    case = ["--field", "sphere", "--dims", "17", "--type", "u8"]
    grids = {grid: cases_of(*case, "--grid", grid)["cases"][0] for grid in ("uniform", "rectilinear", "curvilinear")}
    for grid, result in grids.items():
        expect(result["grid"] == grid and result["triangles"] == made["triangles"], f"--grid {grid}: {result}")
    expect(grids["uniform"]["hash"] == made["hash"], "--grid uniform is not the default")
    expect(len({result["hash"] for result in grids.values()}) == 3, "grids do not differ in their vertices")
    tetrahedra, hexahedra = (cases_of(*case, "--grid", grid)["cases"][0] for grid in ("tetrahedra", "hexahedra"))
    for key in ("vertices", "triangles"):
        expect(tetrahedra[key] == made[key], f"--grid tetrahedra: {key} {tetrahedra[key]}, not {made[key]}")
    expect(hexahedra["triangles"] > made["triangles"], "--grid hexahedra: not six tetrahedra to a cube")
    whole = cases_of(*case, "--grid", "hexahedra", "--method", "hybrid")["cases"][0]
    expect(whole["triangles"] < 0.5 * hexahedra["triangles"], "--grid hexahedra --method hybrid: many triangles")


def test_second(made):
    """It is the surface that this isovalue alone has, and another one than the first."""
    expect(made["second_iso"] == 127.5 * 1.05, f"second isovalue {made['second_iso']}")
    expect(made["second_hash"] != made["hash"], "two isovalues, one mesh")
    case = ["--field", "sphere", "--dims", "17", "--type", "u8"]
    alone = cases_of(*case, "--iso", repr(made["second_iso"]), "--second", "127.5")["cases"][0]
    for key in "iso", "vertices", "triangles", "hash":
        expect(alone[key] == made[f"second_{key}"], f"second {key}: {made[f'second_{key}']}, alone {alone[key]}")
        expect(alone[f"second_{key}"] == made[key], f"{key}: {made[key]}, as second {alone[f'second_{key}']}")
    expect(cases_of(*case, "--iso", "0")["cases"][0]["second_iso"] == 1, "the second isovalue after 0")


def test_sweep():
    """All fields and types of a sweep; what its rules or memory do not allow is left out, the latter with a notice."""
    report = cases_of("--sweep", "--dims", "9")
    names = [(case["field"], case["type"]) for case in report["cases"]]
    wanted = [(field, kind) for field in ("sphere", "gyroid", "marschner-lobb", "noise", "empty", "full")
              for kind in ("u8", "u16", "f32")]
    expect(names == wanted, f"--sweep: {names}")
    for case in report["cases"]:
        expect_case(case, f"--sweep: {case['field']} {case['type']}")
        expect((case["triangles"] == 0) == (case["field"] in ("empty", "full")), f"--sweep: {case}")
    report = cases_of("--sweep", "--field", "noise", "--dims", "9", "--dims", "9,9,257", "--type", "u8")
    expect([case["dims"] for case in report["cases"]] == [[9, 9, 9]], f"--sweep: noise {report['cases']}")
    expect(report["left_out"] == [], f"--sweep: {report['left_out']}")

    done = bench("--sweep", "--field", "torus", "--dims", "100000", "--dims", "9", "--type", "u8", "--json",
                 "--repeat", "1")
    report = json.loads(done.stdout)
    expect(done.returncode == 0 and len(report["cases"]) == 1, f"too large: {done.returncode} {report['cases']}")
    left_out = report["left_out"]
    expect(len(left_out) == 1 and left_out[0]["dims"] == [100000] * 3 and "memory" in left_out[0]["reason"],
           f"too large: {left_out}")
    expect("left out" in done.stderr, f"too large: says {done.stderr!r}")


def test_hybrid():
    arguments = ["--field", "gyroid", "--dims", "40", "--type", "u8"]
    tetra, hybrid = (cases_of(*arguments, *method)["cases"][0] for method in ([], ["--method", "hybrid"]))
    expect_case(hybrid, "--method hybrid", "hybrid")
    ratio = tetra["triangles"] / hybrid["triangles"]
    expect(2.2 < ratio < 2.6, f"the tetrahedra have {ratio} times the triangles")


def test_table():
    done = bench("--field", "sphere", "--dims", "9", "--dims", "9,10,11", "--type", "u8", "--repeat", "1")
    rows = [line for line in done.stdout.splitlines() if line.startswith("sphere ")]
    expect(done.returncode == 0 and [row.split()[1] for row in rows] == ["9^3", "9x10x11"], f"table: {done.stdout}")


def test_dump_and_turns(made, folder):
    path = os.path.join(folder, "sphere.raw")
    done = bench("--field", "sphere", "--dims", "17", "--type", "u8", "--dump", path)
    expect(done.returncode == 0 and json.loads(done.stdout) == {"dims": [17, 17, 17], "type": "u8"},
           f"--dump: {done.returncode} {done.stdout}")
    with open(path, "rb") as file:
        values = struct.unpack(f"{17 ** 3}B", file.read())
    count = crossed_edges([17, 17, 17], values, 127.5)
    expect(made["vertices"] == count, f"{made['vertices']} vertices, {count} crossed edges")

    done = bench("--input", path, "--dims", "17", "--type", "u8", "--iso", "127.5", "--turns", text="\n\n\n")
    lines = done.stdout.split("\n", 4)
    expect(done.returncode == 0 and lines[0] == "ready", f"--turns: {done.returncode} {lines[:1]}")
    times = sorted(float(line) for line in lines[1:4])
    report = json.loads(lines[4])
    expect_limits(report)
    case = report["cases"][0]
    expect_case(case, "--turns")
    expect(case["field"] == "sphere.raw" and case["triangles"] == made["triangles"], f"--turns: {case['field']}")
    told = [case["extract_ms"][key] for key in ("min", "median", "max")]
    expect(all(abs(a - b) < 1e-3 for a, b in zip(told, times)), f"--turns: {told} of {times}")


def test_statuses(folder):
    missing = os.path.join(folder, "none.nrrd")
    for status, words, arguments in [
            (2, "--field", ["--feild", "sphere"]), (2, "sphere", ["--field", "spher"]), (2, "--dims", ["--dims", "1"]),
            (2, "--dims", ["--dims", "5,5"]), (2, "--dims", ["--dims", "64,"]), (2, "--type", ["--type", "u9"]),
            (2, "--iso", ["--iso", "nan"]), (2, "--repeat", ["--repeat", "0"]), (2, "--method", ["--method", "cubes"]),
            (2, "--json", ["--json=1"]), (2, "needs a value", ["--dims"]), (2, "--turns", ["--turns"]),
            (2, "--second", ["--second", "x"]), (2, "--second", ["--second", "127.5"]), (2, "--sweep", ["--swep"]),
            (2, "--sweep", ["--sweep", "--turns", "--field", "empty", "--dims", "9", "--type", "u8"]),
            (2, "--sweep", ["--sweep", "--input", missing, "--iso", "1"]),
            (2, "isovalue", ["--input", missing]), (2, "--input", ["--input", missing, "--field", "sphere"]),
            (4, "none.nrrd", ["--input", missing, "--iso", "1"]), (1, "nonesuch", ["--device", "nonesuch"]),
            (1, "--dump", ["--field", "sphere", "--dims", "9", "--type", "u8", "--dump", os.path.join(missing, "x")])]:
        done = bench(*arguments)
        expect(done.returncode == status, f"{arguments}: status {done.returncode}, not {status}")
        expect(words in done.stderr and not done.stdout, f"{arguments}: says {done.stderr!r}, prints {done.stdout!r}")
    if os.path.exists("/dev/full") and not os.path.isfile("/dev/full"):
        with open("/dev/full", "w", encoding="ascii") as full:
            done = subprocess.run([BENCH, "--help"], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60, check=False)
        expect(done.returncode == 1 and "standard output" in done.stderr, f"full disk: {done.returncode} {done.stderr!r}")
    done = bench("--help")
    expect(done.returncode == 0 and "--repeat" in done.stdout, "--help")


def test_page():
    """bench/README.md has the keys of a case."""
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "README.md"), encoding="utf-8") as file:
        page = file.read()
    expect(not [key for key in CASE_KEYS if f"`{key}`" not in page], "bench/README.md leaves out keys of a case")


def main():
    with tempfile.TemporaryDirectory(prefix="tetracubes-bench-test-") as folder:
        made = test_json()
        test_grids(made)
        test_second(made)
        test_sweep()
        test_hybrid()
        test_table()
        test_dump_and_turns(made, folder)
        test_statuses(folder)
        test_page()
    print(f"{checks} checks, {failures} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
