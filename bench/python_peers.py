#!/usr/bin/env python3
"""python_peers.py - the Python package and others that make isosurfaces of numpy volumes, in turns

    python_peers.py [--json FILE] [--sizes N...] [--repeat R]

From a C-contiguous float32 volume (z, y, x) to numpy arrays of vertices and faces, all that lies between included: what a
caller waits for. Every package has a first call that does not count, then turns, in the reverse order on every other
repeat; one that takes over a second has three. Medians are printed.

  tetracubes, hybrid, snap, closed  isosurface() by each method, and closed
  compat    tetracubes.compat.marching_cubes, with normals and values as scikit-image returns them
  skimage   skimage.measure.marching_cubes
  mcubes    mcubes.marching_cubes (PyMCubes); its vertices are float64
  pyvista   ImageData.contour(method="flying_edges"), without normals: VTK, with all cores
  meshlib   mrmeshpy.marchingCubes of simpleVolumeFrom3Darray, with all cores
  zmesh     zmesh.Mesher of volume >= level: it meshes labels, half-way between voxels, and does not interpolate

Run it by a Python that has all of them: pip install tetracubes-*.whl scikit-image PyMCubes pyvista meshlib zmesh. What
is not there is left out. bench/python_table.py makes the table in host/python/README.md of the committed results.
"""
import argparse
import datetime
import importlib
import importlib.metadata
import json
import os
import platform
import statistics
import sys
import time

import numpy as np
import tetracubes
from tetracubes import compat

SIZES = (128, 256)
SLOW_SECONDS, SLOW_TURNS = 1.0, 3
PACKAGES = {"skimage": "scikit-image", "mcubes": "PyMCubes", "pyvista": "pyvista", "meshlib": "meshlib", "zmesh": "zmesh"}


def fields(size):
    """Volumes with a small and a large surface, and their levels."""
    z, y, x = np.meshgrid(*3 * [np.linspace(-1, 1, size)], indexing="ij")
    k = 3 * np.pi
    gyroid = np.sin(k * x) * np.cos(k * y) + np.sin(k * y) * np.cos(k * z) + np.sin(k * z) * np.cos(k * x)
    return {"sphere": ((1 - 0.75 * np.sqrt(x * x + y * y + z * z)).astype(np.float32), 0.5),
            "gyroid": (gyroid.astype(np.float32), 0.0)}


def ours(**options):
    def turn(volume, level):
        mesh = tetracubes.isosurface(volume, level, **options)
        return mesh.vertices, mesh.faces
    return turn


def skimage(volume, level):
    from skimage.measure import marching_cubes
    return marching_cubes(volume, level)[:2]


def mcubes(volume, level):
    import mcubes as package
    return package.marching_cubes(volume, level)


def pyvista(volume, level):
    import pyvista as package
    grid = package.ImageData(dimensions=volume.shape[::-1])
    grid.point_data["values"] = volume.ravel()
    surface = grid.contour([level], scalars="values", method="flying_edges", compute_normals=False,
                           compute_scalars=False)
    return surface.points, surface.regular_faces


def meshlib(volume, level):
    from meshlib import mrmeshnumpy, mrmeshpy
    parameters = mrmeshpy.MarchingCubesParams()
    parameters.iso = level
    mesh = mrmeshpy.marchingCubes(mrmeshnumpy.simpleVolumeFrom3Darray(volume), parameters)
    return mrmeshnumpy.getNumpyVerts(mesh), mrmeshnumpy.getNumpyFaces(mesh.topology)


def zmesh(volume, level):
    import zmesh as package
    mesher = package.Mesher((1, 1, 1))
    mesher.mesh((volume >= level).astype(np.uint8))
    mesh = mesher.get(1, reduction_factor=0)
    return mesh.vertices, mesh.faces


OURS = {"tetracubes": ours(), "hybrid": ours(method="hybrid"), "snap": ours(method="snap"), "closed": ours(closed=True),
        "compat": lambda volume, level: compat.marching_cubes(volume, level)[:2]}
PEERS = {"skimage": skimage, "mcubes": mcubes, "pyvista": pyvista, "meshlib": meshlib, "zmesh": zmesh}


def start_vtk():
    """All cores: wheels of VTK have one thread unless they are told."""
    from vtkmodules.vtkCommonCore import vtkSMPTools
    if vtkSMPTools.GetBackend() == "Sequential":
        vtkSMPTools.SetBackend("STDThread")
    vtkSMPTools.Initialize(0)


def sides():
    """Those that are there."""
    found = dict(OURS)
    for name, turn in PEERS.items():
        try:
            importlib.import_module(name)
        except ImportError as missing:
            print(f"python_peers.py: without {name}: {missing}", file=sys.stderr)
            continue
        found[name] = turn
        if name == "pyvista":
            start_vtk()
    return found


def seconds(turn, volume, level):
    begin = time.perf_counter()
    mesh = turn(volume, level)
    took = time.perf_counter() - begin
    return took, len(mesh[0]), len(mesh[1])


def run_case(name, size, volume, level, repeat):
    """Times, and sizes of meshes."""
    turns, result = {}, {"field": name, "size": size, "level": level, "packages": {}}
    times = {}
    for side, turn in sides().items():
        took, vertices, faces = seconds(turn, volume, level)
        turns[side] = turn, min(SLOW_TURNS, repeat) if took > SLOW_SECONDS else repeat
        result["packages"][side] = {"vertices": vertices, "faces": faces}
        times[side] = []
    for number in range(repeat):
        for side in list(turns)[::-1 if number % 2 else 1]:
            turn, count = turns[side]
            if number < count:
                times[side].append(1e3 * seconds(turn, volume, level)[0])
    for side, measured in times.items():
        result["packages"][side]["ms"] = {"median": round(statistics.median(measured), 3),
                                          "min": round(min(measured), 3), "max": round(max(measured), 3),
                                          "turns": len(measured)}
    return result


def cpu_name():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        return next((line.split(":", 1)[1].strip() for line in file if line.startswith("model name")), platform.machine())


def versions():
    """Of Python and the packages."""
    known = {"python": platform.python_version(), "numpy": np.__version__,
             "tetracubes": importlib.metadata.version("tetracubes")}
    for package in (*PACKAGES.values(), "vtk"):
        try:
            known[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            pass
    return known


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", metavar="FILE", help="write the results here too")
    parser.add_argument("--sizes", nargs="+", type=int, default=SIZES, metavar="N", help="samples along an axis")
    parser.add_argument("--repeat", type=int, default=7, metavar="R", help="turns of each, default 7")
    arguments = parser.parse_args()
    devices = tetracubes.devices()
    load = [round(os.getloadavg()[0], 2)]
    cases = []
    for size in arguments.sizes:
        for name, (volume, level) in fields(size).items():
            cases.append(run_case(name, size, volume, level, arguments.repeat))
            own = cases[-1]["packages"]["tetracubes"]["ms"]["median"]
            print(f"{name} {size}^3 f32")
            for side, one in cases[-1]["packages"].items():
                median = one["ms"]["median"]
                print(f"  {side:<12} {median:10.1f} ms  {median / own:8.2f} times ours  {one['faces']:10} faces",
                      flush=True)
    load.append(round(os.getloadavg()[0], 2))
    if arguments.json:
        result = {"date": datetime.date.today().isoformat(), "cpu": cpu_name(), "cores": len(os.sched_getaffinity(0)),
                  "device": devices[0].name if devices else None, "load_before_and_after": load,
                  "versions": versions(), "cases": cases}
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump(result, file, indent=1)
            file.write("\n")


if __name__ == "__main__":
    main()
