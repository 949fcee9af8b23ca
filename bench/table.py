#!/usr/bin/env python3
"""table.py - bench/results/*.json as Markdown, into the README between its bench:begin and bench:end comments

Prints it instead with --print. Standard library only.
"""

import argparse
import glob
import json
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
README = os.path.join(os.path.dirname(HERE), "README.md")
BEGIN, END = "<!-- bench:begin -->", "<!-- bench:end -->"
SAMPLE_BYTES = {"u8": 1, "i8": 1, "u16": 2, "i16": 2, "u32": 4, "i32": 4, "f32": 4, "f64": 8}


def ms(times):
    """The median, as many digits as it deserves, with its spread."""
    digits = 1 if times["median"] >= 10 else 2
    return f"{times['median']:.{digits}f} ({times['min']:.{digits}f}-{times['max']:.{digits}f})"


def size(dims):
    return f"{dims[0]}³" if len(set(dims)) == 1 else "×".join(map(str, dims))


def table(head, rows):
    """The first column is text, the others are numbers."""
    lines = [head, ["---"] + ["--:"] * (len(head) - 1), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def peers_table(result):
    rows = [[f"{peer['case'].split()[0]} {size(peer['dims'])} {peer['type']}", ms(peer["extract_ms"]),
             ms(peer["vtk_ms"]), f"**{peer['ratio']:.2f}**", f"{peer['triangles']:,}", f"{peer['vtk_triangles']:,}",
             f"{peer['limit_ratio']:.1f}"] for peer in result["peers"]]
    return table(["samples", "Tetracubes, ms", "VTK, ms", "times as fast", "triangles", "VTK's triangles",
                  "× memory limit"], rows)


def case_row(case):
    warm = case["extract_warm_ms"]["median"]
    samples = case["dims"][0] * case["dims"][1] * case["dims"][2] * SAMPLE_BYTES[case["type"]]
    moved = samples + 12 * (case["vertices"] + case["triangles"])
    return [f"{case['field']} {size(case['dims'])} {case['type']}", f"{case['triangles']:,}", ms(case["extract_ms"]),
            ms(case["extract_warm_ms"]), f"{moved / warm * 1e-6:.1f}", f"{case['triangles'] / warm * 1e-3:.0f}",
            f"{case['limit_ms']:.2f}", f"{case['limit_ratio']:.1f}", f"{case['reference_ms']['median']:.0f}"]


def cases_table(result):
    head = ["samples", "triangles", "new mesh, ms", "kept mesh, ms", "GB/s", "M triangles/s", "limit, ms", "× limit",
            "scalar C, ms"]
    return table(head, map(case_row, result["cases"]))


def section(result):
    vtk = result["vtk"]
    return "\n\n".join([
        f"**{result['cpu']}, {result['cores']} cores**, OpenCL device {result['device']} (driver {result['driver']}), "
        f"{result['date']}. The device reads {result['read_gbps']:.1f} GB/s and writes "
        f"{result['write_gbps']:.1f} GB/s. A whole process on a 64³ file takes "
        f"{result['startup_ms']['median']:.0f} ms; on a 512³ u8 file its memory peaks at "
        f"{result['peak_extra_mb']:.0f} MB beyond file and mesh.",
        f"Against vtkFlyingEdges3D of VTK {vtk['version']} ({vtk['threads']} threads, no normals), a new mesh on every "
        "repeat on both sides, in turns; medians (min-max):",
        peers_table(result),
        "Alone. The limit is reading every sample and writing the mesh once, at the bandwidths above; its ratio, GB/s "
        "and triangles are those of the kept mesh:",
        cases_table(result),
    ])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--print", action="store_true", help="to standard output, README.md untouched")
    parser.add_argument("--results", default=os.path.join(HERE, "results"), metavar="DIR", help="default bench/results")
    parser.add_argument("--readme", default=README, metavar="FILE", help="default README.md")
    arguments = parser.parse_args()
    results = []
    for path in sorted(glob.glob(os.path.join(arguments.results, "*.json"))):
        with open(path, encoding="utf-8") as file:
            results.append(json.load(file))
    if not results:
        sys.exit(f"table.py: no results in {arguments.results}; run bench/run first")
    text = "\n\n".join(map(section, results))
    if arguments.print:
        print(text)
        return
    with open(arguments.readme, encoding="utf-8") as file:
        readme = file.read()
    if readme.count(BEGIN) != 1 or readme.count(END) != 1 or readme.index(BEGIN) > readme.index(END):
        sys.exit(f"table.py: {arguments.readme} has to hold {BEGIN} and, after it, {END}, once each")
    before, after = readme.split(BEGIN)[0], readme.split(END)[1]
    with open(arguments.readme, "w", encoding="utf-8") as file:
        file.write(f"{before}{BEGIN}\n{text}\n{END}{after}")


if __name__ == "__main__":
    main()
