#!/usr/bin/env python3
"""test_carry.py - tetracubes-bench-carry from outside: its JSON, its lines, and what it refuses"""

import json
import subprocess
import sys

CARRY = sys.argv[1]
KEYS = {"field", "dims", "type", "vertices", "repeats", "emit_ms", "carry_ms", "reference_ms"}
failures = 0


def expect(condition, text):
    global failures
    if not condition:
        failures += 1
        print(f"FAILED: {text}")


def carry(*arguments):
    return subprocess.run([CARRY, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=300,
                          check=False)


def test_json():
    done = carry("--json", "17", "3")
    expect(done.returncode == 0, f"--json: {done.returncode} {done.stderr}")
    cases = json.loads(done.stdout)["cases"]
    names = [(case["field"], case["dims"], case["type"]) for case in cases]
    wanted = [(field, [17] * 3, kind) for field in ("sphere", "gyroid") for kind in ("f32", "u8")]
    expect(names == wanted, f"cases {names}")
    for case in cases:
        expect(set(case) == KEYS, f"keys {sorted(case)}")
        expect(case["vertices"] > 100 and case["repeats"] == 3 and case["reference_ms"] > 0, f"case {case}")
        for key in "emit_ms", "carry_ms":
            expect(0 <= case[key]["min"] <= case[key]["median"] <= case[key]["max"], f"{key} {case[key]}")


def test_lines():
    done = carry("9", "1")
    lines = done.stdout.splitlines()
    expect(done.returncode == 0 and len(lines) == 4, f"lines: {done.returncode} {done.stdout} {done.stderr}")
    expect(all(" 9^3 " in line and "carry " in line for line in lines), f"lines: {lines}")
    expect(carry("--help").stdout.startswith("tetracubes-bench-carry"), "--help")


def test_refused():
    for arguments in ["1"], ["2049"], ["x"], ["9", "0"], ["9", "1", "1"], ["--csv"]:
        done = carry(*arguments)
        expect(done.returncode == 2 and arguments[-1] in done.stderr and not done.stdout, f"{arguments}: {done.stderr}")


def main():
    test_json()
    test_lines()
    test_refused()
    print(f"{failures} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
