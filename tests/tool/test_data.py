#!/usr/bin/env python3
"""test_data.py TOOL - published data against counts made without this program, on both engines

The folder named by TETRACUBES_DATA holds expected.json: vertices, triangles, boundary edges and Euler characteristic
per file, field and isovalue. Every entry is extracted with --check --verify, and by the reference engine. An entry
"grid + solution" is one of two inputs. Skips (status 77) where TETRACUBES_DATA is unset.
"""
import json
import os
import subprocess
import sys

COMPARED = ("vertices", "triangles", "boundary_edges", "euler_characteristic")
OPTIONAL_FORMATS = {"NIfTI": (".nii",), "VTK XML": (".vti", ".vtr", ".vts", ".vtu")}
SAME_IN_REPORT = ("dims", "tetrahedra")


def input_arguments(data, entry):
    """What names the entry's files and field on the tool's command line."""
    first, *others = entry["file"].split(" + ")
    folder = os.path.dirname(first)
    paths = [os.path.join(data, first)] + [os.path.join(data, folder, name) for name in others]
    return paths + (["--field", entry["field"]] if entry["field"] else [])


def report_of(tool, source, iso, *more):
    """The report, or a text that says why there is none."""
    command = [tool, "extract", *source, "--iso", repr(iso), "--check", "--json", *more]
    result = subprocess.run(command, capture_output=True, text=True, timeout=600)
    if result.returncode:
        return f"status {result.returncode}: {result.stderr.strip()}"
    return json.loads(result.stdout)


def faults_of(tool, entry, source):
    faults, hashes = [], set()
    for engine, more in (("opencl", ["--verify"]), ("reference", [])):
        report = report_of(tool, source, entry["iso"], "--engine", engine, *more)
        if isinstance(report, str):
            faults.append(f"{engine}: {report}")
            continue
        [surface] = report["surfaces"]
        faults += [f"{engine}: {key} {report[key]}, should be {entry.get(key)}" for key in SAME_IN_REPORT
                   if report[key] != entry.get(key)]
        hashes.add(surface["hash"])
        faults += [f"{engine}: {key} {surface[key]}, should be {entry[key]}" for key in COMPARED
                   if surface[key] != entry[key]]
        if more and surface["verified"] is not True:
            faults.append(f"{engine}: not verified")
    if len(hashes) > 1:
        faults.append("the engines' hashes differ")
    return faults


def main():
    data = os.environ.get("TETRACUBES_DATA")
    if not data:
        print("SKIP: TETRACUBES_DATA is unset; it names the folder of published data and their expected counts")
        return 77
    tool = os.path.abspath(sys.argv[1])
    formats = subprocess.run([tool, "--version"], capture_output=True, text=True).stdout
    with open(os.path.join(data, "expected.json")) as f:
        entries = json.load(f)
    failed = 0
    for entry in entries:
        name = f"{entry['file']} {entry['field']} at {entry['iso']}"
        missing = [form for form, endings in OPTIONAL_FORMATS.items() if form not in formats
                   and any(ending in entry["file"] for ending in endings)]
        if missing:
            print(f"SKIP  {name}: built without {missing[0]}")
            continue
        faults = faults_of(tool, entry, input_arguments(data, entry))
        failed += bool(faults)
        print(f"{'FAIL' if faults else 'ok'}  {name}", *faults, sep="\n      ", flush=True)
    print(f"{len(entries)} surfaces, {failed} failed")
    return 1 if failed or not entries else 0


if __name__ == "__main__":
    sys.exit(main())
