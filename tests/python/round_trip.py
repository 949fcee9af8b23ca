"""What the package costs: the time of isosurface on a numpy array by that of the same calls of the C library, as JSON.

A new grid and a new mesh each time, in a context that is kept, on 256^3 float32; medians of calls that take turns.
"""
import ctypes
import json
import statistics
import time

import numpy as np
import tetracubes
from tetracubes import library
from tetracubes.library import options, tc

TURNS = 60


def fields():
    """Two volumes with their level: one with a small surface, one with a large one."""
    z, y, x = np.mgrid[-1:1:256j, -1:1:256j, -1:1:256j]
    k = 3 * np.pi
    gyroid = np.sin(k * x) * np.cos(k * y) + np.sin(k * y) * np.cos(k * z) + np.sin(k * z) * np.cos(k * x)
    return {"sphere": np.sqrt(x * x + y * y + z * z).astype(np.float32), "gyroid": gyroid.astype(np.float32)}


def c_calls(context, volume, level):
    grid, mesh, data = ctypes.c_void_p(), ctypes.c_void_p(), library.tc_mesh_data()
    given, how = options(library.tc_grid_options), options(library.tc_extract_options)
    given.dims[:] = volume.shape[::-1]
    given.type, given.samples, how.isovalue = library.tc_type.TC_F32, volume.ctypes.data, level
    status = (tc.tc_grid_create(context, ctypes.byref(given), ctypes.byref(grid))
              or tc.tc_extract(grid, ctypes.byref(how), ctypes.byref(mesh)) or tc.tc_mesh_get(mesh, ctypes.byref(data)))
    library.check(status)
    tc.tc_mesh_destroy(mesh)
    tc.tc_grid_destroy(grid)


def package(volume, level):
    mesh = tetracubes.isosurface(volume, level)
    return len(mesh.vertices), len(mesh.faces)


def seconds(function, *arguments):
    begin = time.perf_counter()
    function(*arguments)
    return time.perf_counter() - begin


def main():
    context, kept = ctypes.c_void_p(), options(library.tc_context_options)
    library.check(tc.tc_context_create(ctypes.byref(kept), ctypes.byref(context)))
    ratios = {}
    for name, volume in fields().items():
        level = 0.5 if name == "sphere" else 0.0
        times = [(seconds(c_calls, context, volume, level), seconds(package, volume, level)) for _ in range(TURNS)]
        theirs, ours = (statistics.median(column) for column in zip(*times[5:]))
        ratios[name] = round(ours / theirs, 3)
    tc.tc_context_destroy(context)
    print(json.dumps(ratios))


if __name__ == "__main__":
    main()
