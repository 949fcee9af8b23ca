#!/usr/bin/env python3
"""plot.py - time against size, from bench/results/*.json: one bench/pictures/<name>.svg for each

A panel per kind of samples, both axes logarithmic: medians of Tetracubes and of the peers, and the limit of the
device's memory. What a results file does not hold is not drawn.

Needs matplotlib: bench/peers-setup installs it.
"""

import argparse
import glob
import json
import os
import sys

try:
    import matplotlib
    matplotlib.use("svg")
    from matplotlib import pyplot
    from matplotlib.ticker import FuncFormatter, NullLocator
except ImportError as missing:
    sys.exit(f"plot.py: {missing}; run bench/peers-setup, then start this script by build-peers/bin/python3")

HERE = os.path.dirname(os.path.abspath(__file__))
PANELS = [("sphere", "u8"), ("gyroid", "u8"), ("sphere", "f32")]
OURS = [("extract_ms", "Tetracubes, new mesh", "#c1440e", "o-"), ("extract_warm_ms", "kept mesh", "#e58a45", "o-"),
        ("second_warm_ms", "second isovalue", "#e3b23c", "o-"), ("limit_ms", "memory limit", "#222222", "--")]
PEERS = [("vtk_ms", "vtkFlyingEdges3D", "#1f6fa8", "s-"), ("vtk_mc_ms", "vtkMarchingCubes", "#58a36c", "^-"),
         ("skimage_ms", "scikit-image", "#8a6bb1", "v-"), ("meshlib_ms", "MeshLib", "#b18a3a", "d-")]
STYLE = {"svg.hashsalt": "tetracubes", "svg.fonttype": "none", "font.size": 9, "font.family": "sans-serif"}


def median(value):
    return value["median"] if isinstance(value, dict) else value


def points(cases, key):
    """Sizes and medians of the cubes among cases, by size."""
    found = sorted((case["dims"][0], median(case[key])) for case in cases
                   if key in case and len(set(case["dims"])) == 1)
    return [size for size, _ in found], [ms for _, ms in found]


def draw_panel(axes, result, field, kind):
    ours = [case for case in result["cases"] if (case["field"], case["type"]) == (field, kind)]
    peers = [case for case in result.get("peers", []) if (case["case"].split()[0], case["type"]) == (field, kind)
             and case.get("grid", "uniform") == "uniform"]
    for cases, series in ((peers, PEERS), (ours, OURS)):
        for key, label, colour, form in series:
            sizes, times = points(cases, key)
            if sizes:
                axes.plot(sizes, times, form, label=label, color=colour, markersize=4, linewidth=1.4)
    axes.set_title(f"{field}, {kind}")
    axes.set_xscale("log", base=2)
    axes.set_yscale("log")
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda size, _: f"{size:.0f}³"))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda ms, _: f"{ms:g}"))
    axes.grid(True, color="#dddddd", linewidth=0.6)


def draw(result, path):
    figure, panels = pyplot.subplots(1, len(PANELS), figsize=(11, 4.4), sharey=True)
    for axes, (field, kind) in zip(panels, PANELS):
        draw_panel(axes, result, field, kind)
    panels[0].set_ylabel("milliseconds")
    labelled = dict(pair[::-1] for axes in panels for pair in zip(*axes.get_legend_handles_labels()))
    figure.legend(labelled.values(), labelled.keys(), loc="lower center", ncol=7, frameon=False, fontsize=8.5)
    figure.suptitle(f"{result['device']}, {result['date']}", fontsize=9)
    figure.tight_layout(rect=(0, 0.06, 1, 1))
    figure.savefig(path, metadata={"Date": None})
    pyplot.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", default=os.path.join(HERE, "results"), metavar="DIR", help="default bench/results")
    parser.add_argument("--pictures", default=os.path.join(HERE, "pictures"), metavar="DIR",
                        help="where they go, default bench/pictures")
    arguments = parser.parse_args()
    paths = sorted(glob.glob(os.path.join(arguments.results, "*.json")))
    if not paths:
        sys.exit(f"plot.py: no results in {arguments.results}; run bench/run first")
    matplotlib.rcParams.update(STYLE)
    for path in paths:
        with open(path, encoding="utf-8") as file:
            result = json.load(file)
        picture = os.path.join(arguments.pictures, result["name"] + ".svg")
        draw(result, picture)
        print(f"written: {os.path.relpath(picture)}")


if __name__ == "__main__":
    main()
