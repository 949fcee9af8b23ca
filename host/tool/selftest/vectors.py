#!/usr/bin/env python3
"""Writes vectors.txt: meshes of analytic fields, with counts and hash, made by the reference engine alone.

    vectors.py TOOL [--check]    --check: compares the file that is there instead, of cases up to 128 x 128 x 128

Each line comes from `tetracubes generate FIELD -o a.raw` and `tetracubes extract a.raw --engine reference --json`; for
unstructured grids `tetracubes tetrahedralize` stands between. Standard library only.
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

FILE = Path(__file__).resolve().parent / "vectors.txt"
HEAD = """\
# Vectors: what an isosurface is, to be compared with what a driver, a device or another program makes of it.
# Written by vectors.py with the scalar reference engine; `tetracubes selftest --vectors` compares a device with them.
#
# FIELD NX NY NZ TYPE ISOVALUE METHOD OPTIONS VERTICES TRIANGLES HASH
#
# FIELD: of `tetracubes generate --help`. Sample i of n along an axis lies at 2 i / (n - 1) - 1, computed in double; f32
# rounds to nearest, integers truncate toward zero and saturate. METHOD: tetra (five tetrahedra per cube), hybrid or snap
# (threshold 0.5). OPTIONS: - or, with commas between: nodata=V: samples equal to V are missing; seed=S of noise, else 0;
# tetrahedra: the grid cut into tetrahedra and extracted as an unstructured one; closed: closed at the border. Positions
# are in index space: sample (i, j, k) lies at i, j, k. HASH: XXH64, seed 0, of the float32 positions of all vertices,
# then the uint32 indices of all triangles, both little-endian, in the order that kernels/README.md describes; 16
# hexadecimal digits.
"""
TYPES = ["u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64"]


def cases():
    """(field, dims, type, isovalue, method, options)"""
    for name in TYPES:
        iso = {"i8": "64", "f32": "0.1", "f64": "128.1"}.get(name, "127.5")
        yield "noise", (37, 22, 19), name, iso, "tetra", "-"
        yield "noise", (67, 13, 11), name, iso, "hybrid", "seed=7"
        yield "noise", (67, 13, 11), name, iso, "snap", "seed=11"
    for dims in [(2, 2, 2), (2, 3, 130), (3, 257, 2), (63, 7, 3), (64, 8, 4), (65, 9, 5), (129, 17, 9), (1000, 3, 3)]:
        yield "noise", dims, "u8", "127.5", "tetra", "seed=1"
        yield "noise", dims, "f32", "127.5", "tetra", "seed=2"
        yield "noise", dims, "i16", "127.5", "hybrid", "seed=3"
        yield "noise", dims, "u8", "127.5", "snap", "seed=4"
    yield "full", (20, 20, 20), "f32", "127.5", "tetra", "-"
    yield "empty", (20, 20, 20), "u8", "127.5", "tetra", "-"
    for iso in ("64", "128", "255"):  # equal to samples
        yield "noise", (67, 13, 11), "u8", iso, "tetra", "seed=5"
        yield "tangle", (50, 37, 29), "u16", iso, "hybrid", "-"
        yield "noise", (67, 13, 11), "u8", iso, "snap", "seed=5"
    yield "noise", (67, 13, 11), "u8", "127.5", "tetra", "nodata=64"
    yield "gyroid", (67, 33, 20), "i16", "127.5", "tetra", "nodata=100"
    yield "gyroid", (67, 33, 20), "u8", "127.5", "hybrid", "nodata=100"
    yield "gyroid", (67, 33, 20), "u8", "127.5", "snap", "nodata=100"
    for method in ("tetra", "hybrid", "snap"):
        yield "gyroid", (130, 33, 20), "u8", "127.5", method, "closed"
        yield "noise", (67, 13, 11), "f32", "127.5", method, "seed=13,closed"
        yield "gyroid", (67, 33, 20), "u8", "127.5", method, "nodata=100,closed"
    yield "full", (20, 20, 20), "f32", "127.5", "tetra", "closed"
    for name in ("u8", "i16", "f32", "f64"):
        yield "gyroid", (30, 20, 13), name, "127.5", "tetra", "tetrahedra"
    for field in ("sphere", "torus", "gyroid", "marschner-lobb", "tangle"):
        for size in (64, 128):
            yield field, (size, size, size), "u8", "127.5", "tetra", "-"
            yield field, (size, size, size), "f32", "127.5", "hybrid", "-"
            yield field, (size, size - 1, size - 2), "f64", "100", "tetra", "-"
            yield field, (size - 1, size, size - 2), "f32", "127.5", "snap", "-"
    yield "gyroid", (256, 256, 256), "u8", "127.5", "tetra", "-"
    yield "sphere", (256, 256, 256), "f32", "127.5", "hybrid", "-"
    yield "marschner-lobb", (256, 255, 254), "u16", "127.5", "tetra", "-"
    yield "gyroid", (256, 256, 256), "u8", "127.5", "snap", "-"
    yield "sphere", (512, 512, 512), "u8", "127.5", "tetra", "-"
    yield "sphere", (512, 512, 512), "f32", "127.5", "hybrid", "-"
    yield "gyroid", (512, 512, 512), "u8", "127.5", "hybrid", "-"
    yield "gyroid", (512, 512, 512), "u8", "127.5", "tetra", "-"


def run(*arguments):
    return subprocess.run([str(a) for a in arguments], stdout=subprocess.PIPE, check=True).stdout


def line(tool, folder, case):
    field, dims, kind, iso, method, options = case
    size, raw, cut = ",".join(map(str, dims)), folder / "a.raw", folder / "a.vtu"
    given = dict(part.partition("=")[::2] for part in options.split(",") if part != "-")
    run(tool, "generate", field, "--dims", size, "--type", kind, "--seed", given.get("seed", "0"), "-o", raw, "--quiet")
    how = ["--dims", size, "--type", kind]
    source = raw
    if "tetrahedra" in given:
        run(tool, "tetrahedralize", raw, *how, "-o", cut, "--quiet")
        source, how = cut, []
    if "nodata" in given:
        how += ["--nodata", given["nodata"]]
    if "closed" in given:
        how += ["--closed"]
    surface = json.loads(run(tool, "extract", source, *how, "--iso", iso, "--method", method, "--engine", "reference",
                             "--json", "--quiet"))["surfaces"][0]
    words = [field, *dims, kind, iso, method, options, surface["vertices"], surface["triangles"], surface["hash"]]
    return " ".join(map(str, words)) + "\n"


def main():
    tool, check = Path(sys.argv[1]).resolve(), "--check" in sys.argv[2:]
    kept = FILE.read_text(encoding="utf-8").splitlines(keepends=True) if check else []
    wrong = 0
    with tempfile.TemporaryDirectory(prefix="vectors-") as folder:
        lines = []
        for case in cases():
            small = case[1][0] * case[1][1] * case[1][2] <= 128 ** 3
            if check and not small:
                start = " ".join(map(str, [case[0], *case[1], *case[2:]])) + " "
                wrong += not any(text.startswith(start) for text in kept)
                continue
            made = line(tool, Path(folder), case)
            if check and made not in kept:
                print(f"not in {FILE.name}: {made}", end="")
                wrong += 1
            lines.append(made)
    if check:
        listed = [text for text in kept if not text.startswith("#")]
        wrong += len(listed) != len(list(cases()))
        print(f"{len(lines)} vectors compared, {wrong} wrong")
        return wrong > 0
    FILE.write_text(HEAD + "".join(lines), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
