#!/usr/bin/env python3
"""python_table.py - bench/results/python/*.json as a table in host/python/README.md

    python_table.py [--results FOLDER] [--page FILE]

The results are those of python_peers.py. The table stands between the page's bench:begin and bench:end comments. Standard
library only.
"""
import argparse
import json
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BEGIN, END = "<!-- bench:begin -->", "<!-- bench:end -->"
COLUMNS = {"tetracubes": "`isosurface`", "hybrid": '`method="hybrid"`', "snap": '`method="snap"`', "compat": "`compat`",
           "skimage": "scikit-image", "mcubes": "PyMCubes", "pyvista": "PyVista (VTK)", "meshlib": "MeshLib",
           "zmesh": "zmesh"}
OURS = ("tetracubes", "hybrid", "snap", "compat")
BUSY = 0.25  # load per core, from which on the text tells of it


def number(value):
    """As many digits as it deserves."""
    return f"{value:.{0 if value >= 100 else 1 if value >= 10 else 2}f}"


def cell(packages, name):
    """Milliseconds; of others how many times ours, too."""
    if name not in packages:
        return ""
    median = packages[name]["ms"]["median"]
    times = "" if name in OURS else f" (**{median / packages['tetracubes']['ms']['median']:.1f}**)"
    return number(median) + times


def section(result):
    """The text of one machine."""
    present = [name for name in COLUMNS if any(name in case["packages"] for case in result["cases"])]
    versions = result["versions"]
    load = result["load_before_and_after"][0]
    busy = f" The machine had other work meanwhile (load {load}), which all of them shared." \
        if load > BUSY * result["cores"] else ""
    packages = ", ".join(f"{name} {versions[name]}" for name in ("scikit-image", "PyMCubes", "pyvista", "vtk", "meshlib",
                                                                 "zmesh") if name in versions)
    lines = [f"On {result['cpu']}, {result['cores']} cores, {result['date']}: milliseconds from a float32 volume to arrays "
             f"of vertices and faces, and how many times `isosurface` that is. Python {versions['python']}, {packages}."
             + busy, "",
             "| volume | " + " | ".join(COLUMNS[name] for name in present) + " |",
             "| --- |" + " --: |" * len(present)]
    for case in result["cases"]:
        lines.append(f"| {case['field']} {case['size']}³ | "
                     + " | ".join(cell(case["packages"], name) for name in present) + " |")
        lines.append("| its faces | " + " | ".join(f"{case['packages'][name]['faces']:,}" if name in case["packages"] else ""
                                                   for name in present) + " |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=Path, default=ROOT / "bench" / "results" / "python")
    parser.add_argument("--page", type=Path, default=ROOT / "host" / "python" / "README.md")
    arguments = parser.parse_args()
    results = [json.loads(path.read_text(encoding="utf-8")) for path in sorted(arguments.results.glob("*.json"))]
    before, rest = arguments.page.read_text(encoding="utf-8").split(BEGIN)
    made = "\n\n".join(map(section, results))
    arguments.page.write_text(f"{before}{BEGIN}\n{made}\n{END}{rest.split(END)[1]}", encoding="utf-8")


if __name__ == "__main__":
    main()
