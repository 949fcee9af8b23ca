#!/usr/bin/env python3
"""label_peers.py - surfaces of label maps by the Python package, VTK and zmesh, in turns

    label_peers.py [--json FILE] [--repeat R]

From a numpy segmentation (z, y, x) to arrays of vertices, triangles and labels. Everyone has a first call that does not
count, then turns, in the reverse order on every other repeat; one that takes over a second has three. Medians are printed.

  tetracubes, smoothed    labels(), without smoothing, and as it is by default
  vtk, vtk_smoothed       vtkSurfaceNets3D as triangles, all threads: without smoothing, and as it is by default
  zmesh                   zmesh.Mesher, and the mesh of every label
  binary                  isosurface() of the labels that are odd, against the others: what a surface costs alone; and its
                          labels(), which is the same surface: binary_labels

Segmentations: 256^3 samples, each the number of the nearest of 200 random points; where TETRACUBES_DATA is set, its frog.
bench/peers-setup installs the others; the package is that of a build: PYTHONPATH=build/host/python
build-peers/bin/python3 bench/label_peers.py
"""
import argparse
import importlib.metadata
import json
import os
import statistics
import sys
import time
import zlib

import numpy as np
import tetracubes

SLOW_SECONDS, SLOW_TURNS = 1.0, 3
POINTS, SIZE = 200, 256


def nearest_points(size=SIZE, count=POINTS, seed=1):
    """The number of the nearest of random points, from 1, by planes: no package is needed for that."""
    points = (np.random.default_rng(seed).random((count, 3)) * size).astype("f4")
    made = np.empty((size, size, size), np.uint8)
    y, x = np.mgrid[:size, :size].astype("f4")
    for z in range(size):
        least = np.full((size, size), np.inf, "f4")
        for n, (pz, py, px) in enumerate(points):
            distance = (pz - z) ** 2 + (py - y) ** 2 + (px - x) ** 2
            nearer = distance < least
            least[nearer], made[z][nearer] = distance[nearer], n + 1
    return made


def frog(folder):
    """The frog of VTK's data: MetaImage, 136 x 470 x 500, compressed; its header tells too few compressed bytes."""
    with open(os.path.join(folder, "uniform", "frogtissue.zraw"), "rb") as file:
        return np.frombuffer(zlib.decompressobj().decompress(file.read()), "u1").reshape(136, 470, 500)


def ours(**options):
    def turn(volume):
        mesh = tetracubes.labels(volume, **options)
        return len(mesh.vertices), len(mesh.faces)
    return turn


def binary(volume):
    mesh = tetracubes.isosurface(volume, 0.5)
    return len(mesh.vertices), len(mesh.faces)


def start_vtk():
    """All cores: wheels of VTK have one thread unless they are told."""
    from vtkmodules.vtkCommonCore import vtkSMPTools
    if vtkSMPTools.GetBackend() == "Sequential":
        vtkSMPTools.SetBackend("STDThread")
    vtkSMPTools.Initialize(0)


def surface_nets(smooth):
    def turn(volume):
        from vtkmodules.util.numpy_support import numpy_to_vtk
        from vtkmodules.vtkCommonDataModel import vtkImageData
        from vtkmodules.vtkFiltersCore import vtkSurfaceNets3D
        image = vtkImageData()
        image.SetDimensions(*volume.shape[::-1])
        image.GetPointData().SetScalars(numpy_to_vtk(volume.ravel()))
        nets = vtkSurfaceNets3D()
        nets.SetInputData(image)
        nets.SetOutputMeshTypeToTriangles()
        nets.SetSmoothing(smooth)
        for n, label in enumerate(LABELS[id(volume)]):
            nets.SetLabel(n, label)
        nets.Update()
        made = nets.GetOutput()
        return made.GetNumberOfPoints(), made.GetNumberOfCells()
    return turn


def zmesh(volume):
    import zmesh as package
    mesher = package.Mesher((1, 1, 1))
    mesher.mesh(volume)
    vertices = faces = 0
    for label in mesher.ids():
        mesh = mesher.get(label, reduction_factor=0)
        vertices, faces = vertices + len(mesh.vertices), faces + len(mesh.faces)
    return vertices, faces


LABELS = {}  # of each volume: those that it has
SIDES = {"tetracubes": ours(smoothing=0), "smoothed": ours(), "vtk": surface_nets(False), "vtk_smoothed": surface_nets(True),
         "zmesh": zmesh}
BINARY = {"binary": binary, "binary_labels": ours(smoothing=0)}


def there(sides):
    """Those whose package is there."""
    found = dict(sides)
    for name, module in (("vtk", "vtkmodules"), ("vtk_smoothed", "vtkmodules"), ("zmesh", "zmesh")):
        try:
            __import__(module)
        except ImportError as missing:
            print(f"label_peers.py: without {name}: {missing}", file=sys.stderr)
            found.pop(name, None)
    if "vtk" in found:
        start_vtk()
    return found


def seconds(turn, volume):
    begin = time.perf_counter()
    counts = turn(volume)
    return time.perf_counter() - begin, counts


def run_case(name, volume, sides, repeat):
    LABELS[id(volume)] = [int(label) for label in np.unique(volume) if label]
    result = {"name": name, "dims": list(volume.shape[::-1]), "labels": len(LABELS[id(volume)]), "sides": {}}
    turns, times = {}, {side: [] for side in sides}
    for side, turn in sides.items():
        took, (vertices, triangles) = seconds(turn, volume)
        turns[side] = min(SLOW_TURNS, repeat) if took > SLOW_SECONDS else repeat
        result["sides"][side] = {"vertices": vertices, "triangles": triangles}
    for number in range(repeat):
        for side in list(sides)[::-1 if number % 2 else 1]:
            if number < turns[side]:
                times[side].append(1e3 * seconds(sides[side], volume)[0])
    for side, measured in times.items():
        result["sides"][side]["ms"] = {"median": round(statistics.median(measured), 3), "min": round(min(measured), 3),
                                       "max": round(max(measured), 3), "turns": len(measured)}
    return result


def show(case):
    first = next(iter(case["sides"].values()))["ms"]["median"]
    print(f"{case['name']} {' x '.join(map(str, case['dims']))}, {case['labels']} labels")
    for side, one in case["sides"].items():
        median = one["ms"]["median"]
        print(f"  {side:<14} {median:10.1f} ms  {median / first:8.2f} times the first  {one['triangles']:10} triangles",
              flush=True)


def version(package):
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", metavar="FILE", help="write the results here too")
    parser.add_argument("--repeat", type=int, default=7, metavar="R", help="turns of each, default 7")
    arguments = parser.parse_args()
    data = os.environ.get("TETRACUBES_DATA")
    load = [round(os.getloadavg()[0], 2)]
    points = nearest_points()
    cases = [run_case("nearest of 200 points", points, there(SIDES), arguments.repeat),
             run_case("odd ones of these", np.ascontiguousarray(points % 2), BINARY, arguments.repeat)]
    if data:
        cases.append(run_case("frog", frog(data), there(SIDES), arguments.repeat))
    for case in cases:
        show(case)
    load.append(round(os.getloadavg()[0], 2))
    if arguments.json:
        devices = tetracubes.devices()
        result = {"date": time.strftime("%F", time.gmtime()), "cores": len(os.sched_getaffinity(0)), "device": devices[0].name if devices else None,
                  "load_before_and_after": load, "versions": {name: version(name) for name in ("numpy", "vtk", "zmesh")},
                  "cases": cases}
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump(result, file, indent=1)
            file.write("\n")


if __name__ == "__main__":
    main()
