#!/usr/bin/env python3
"""interval.py - interval volumes beside two passes of VTK's clip filters, on the same samples

    build-peers/bin/python3 bench/interval.py build-bench/host/tool/tetracubes build-bench/bench/tetracubes-bench

Both make the part of a volume between two values. Ours is `isovolume` of the tool: classify, emit and read-back, as it
reports them, kernels built before. Each turn is a process that makes the volume twice, in new memory each time: the first
one (first_ms) finds a grid that nobody has read, and a process that has touched no memory yet. VTK's, in one process, is a filter that
clips at the lower value, and another one that clips its output at the upper one: both Update(). Turns alternate, medians
count. VTK keeps voxels that lie within whole, where ours are five tetrahedra. The limit is that of the device: all
samples read once, vertices and tetrahedra written once, by the bandwidths that tetracubes-bench measures here.

Some cases are unstructured: the same samples on a grid cut into tetrahedra by `tetrahedralize`, smaller (--unstructured),
from one file. Both sides then begin and end with tetrahedra. The limit counts points and tetrahedra read once, too.

vtkClipDataSet, which takes twenty times as long as vtkTableBasedClipDataSet, is measured once, with --all.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

import numpy
from peer_filters import vtk_start
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersGeneral import vtkClipDataSet, vtkTableBasedClipDataSet
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

CASES = [("sphere", "60,100"), ("sphere", "40,"), ("gyroid", "100,150")]
UNSTRUCTURED = [("sphere", "60,100"), ("gyroid", "100,150")]


def told(command):
    return json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout)


class Image:
    """Samples of a field in a file, the tool's arguments for it, and VTK's grid of it."""

    def __init__(self, arguments, folder, field):
        self.dims = [arguments.dims] * 3
        path, dims = os.path.join(folder, f"{field}.raw"), ",".join(map(str, self.dims))
        self.input = [path, "--dims", dims, "--type", "f32"]
        self.bytes = 4 * arguments.dims ** 3
        if not os.path.exists(path):
            subprocess.run([arguments.tool, "generate", field, "--dims", dims, "--type", "f32", "-o", path, "--quiet"],
                           check=True)
        self.grid = vtkImageData()
        self.grid.SetDimensions(self.dims)
        self.name(numpy_to_vtk(numpy.fromfile(path, numpy.float32), deep=1))

    def name(self, scalars):
        """Without a name the filter's output would have no scalars."""
        scalars.SetName("samples")
        self.grid.GetPointData().SetScalars(scalars)


class Tetrahedra(Image):
    """The same cut into tetrahedra."""

    def __init__(self, arguments, folder, field):
        small = argparse.Namespace(**{**vars(arguments), "dims": arguments.unstructured})
        own = os.path.join(folder, "unstructured")
        os.makedirs(own, exist_ok=True)
        super().__init__(small, own, field)
        path = os.path.join(own, f"{field}.vtu")
        subprocess.run([arguments.tool, "tetrahedralize", *self.input, "-o", path, "--quiet"], check=True)
        self.input = [path]
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(path)
        reader.Update()
        self.grid = reader.GetOutput()
        self.name(self.grid.GetPointData().GetArray(0))
        self.bytes += 12 * self.grid.GetNumberOfPoints() + 16 * self.grid.GetNumberOfCells()


def clipped(kind, image, low, high):
    """Milliseconds of both passes, and the cells that come out."""
    begin = time.perf_counter()
    for value, inside_out in ((low, False), (high, True)):
        if value is None:
            continue
        one = kind()
        one.SetInputData(image)
        one.SetValue(value)
        one.SetInsideOut(inside_out)
        one.Update()
        image = one.GetOutput()
    return 1e3 * (time.perf_counter() - begin), image.GetNumberOfCells()


def middle(times):
    return {"median": round(statistics.median(times), 2), "min": round(min(times), 2), "max": round(max(times), 2)}


def case(arguments, source, field, bounds):
    command = [arguments.tool, "isovolume", *source.input, "--range", bounds, "--range", bounds, "--json"]
    low, high = (float(bound) if bound else None for bound in bounds.split(","))
    ours, first, theirs = [], [], []
    told(command)  # builds the kernels
    for _ in range(arguments.repeat):
        volumes = told(command)["volumes"]
        for volume, times in zip(volumes, (first, ours)):
            times.append(sum(volume["timings_ms"].values()))
        theirs.append(clipped(vtkTableBasedClipDataSet, source.grid, low, high))
    volume = volumes[0]
    limit = 1e-6 * source.bytes / arguments.read_gbps + 1e-6 * volume["bytes"] / arguments.write_gbps
    result = {"field": field, "dims": source.dims, "grid": type(source).__name__.lower(), "range": bounds, "tetrahedra": volume["tetrahedra"],
              "bytes": volume["bytes"], "ms": middle(ours), "first_ms": middle(first), "limit_ms": round(limit, 2),
              "limit_ratio": round(statistics.median(ours) / limit, 2),
              "vtk_table_ms": middle([ms for ms, _ in theirs]), "vtk_table_cells": theirs[0][1],
              "times_ours": round(statistics.median(ms for ms, _ in theirs) / statistics.median(ours), 2)}
    if arguments.all:
        ms, cells = clipped(vtkClipDataSet, source.grid, low, high)
        result.update(vtk_clip_ms=round(ms, 2), vtk_clip_cells=cells)
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool", help="the program tetracubes")
    parser.add_argument("bench", help="the program tetracubes-bench, which measures bandwidths")
    parser.add_argument("--dims", type=int, default=256, help="samples along each axis")
    parser.add_argument("--unstructured", type=int, default=81, help="the same of unstructured grids")
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--threads", type=int, default=0, help="of VTK; 0: all cores")
    parser.add_argument("--all", action="store_true", help="vtkClipDataSet too")
    parser.add_argument("--json", metavar="FILE", help="write the results here too")
    arguments = parser.parse_args()
    vtk = vtk_start(arguments.threads)
    device = told([arguments.bench, "--field", "sphere", "--dims", "64", "--repeat", "3", "--json"])
    arguments.read_gbps, arguments.write_gbps = device["read_gbps"], device["write_gbps"]
    with tempfile.TemporaryDirectory(prefix="tetracubes-interval-") as folder:
        cases = [case(arguments, kind(arguments, folder, field), field, bounds)
                 for kind, those in ((Image, CASES), (Tetrahedra, UNSTRUCTURED)) for field, bounds in those]
    print(f"{device['device']}: reads {device['read_gbps']:.1f} GB/s, writes {device['write_gbps']:.1f} GB/s; "
          f"VTK {vtk['version']}, {vtk['threads']} threads")
    for c in cases:
        print(f"{c['grid']}, {c['field']} {c['dims'][0]}^3 f32, {c['range']}: {c['ms']['median']:.1f} ms "
              f"({c['first_ms']['median']:.1f} at first), "
              f"{c['limit_ratio']:.1f} times the limit; two passes of vtkTableBasedClipDataSet "
              f"{c['vtk_table_ms']['median']:.0f} ms, {c['times_ours']:.1f} times ours")
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump({"date": time.strftime("%F", time.gmtime()), "device": device["device"], "read_gbps": device["read_gbps"],
                       "write_gbps": device["write_gbps"], "vtk": vtk, "cases": cases}, file, indent=1)
            file.write("\n")


if __name__ == "__main__":
    try:
        main()
    except (subprocess.CalledProcessError, OSError) as failure:
        sys.exit(f"interval.py: {failure}")
