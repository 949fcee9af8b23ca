#!/usr/bin/env python3
"""simplify.py - surfaces with fewer triangles: what meshoptimizer alone makes of ours, what --simplify does, and others

    simplify.py run TOOL [--library libmeshoptimizer.so]... [--peers] [--only WORD] [--methods M...] [--json FILE]
    simplify.py table RESULTS.json...      the table in bench/README.md

Surfaces are those of sphere, gyroid, a bolt, a volume of neurons, an embryo and noise, by each method, closed where that
is said; of each the shares 0.5, 0.2, 0.1 and 0.05 of its triangles. Of every result is counted, by code of its own here:

  triangles       that are left
  edges           with three triangles or more; or one direction twice
  vertices        with several fans of triangles
  border          edges with one triangle that were not there, or are gone
  components      more or fewer than before
  Euler           characteristic, more or less than before
  folds           edges whose two triangles are folded onto each other, 150 degrees and more, more than before
  twice           triangles with the same three vertices as another one

With --peers also vtkQuadricDecimation, vtkDecimatePro (which keeps the topology where it is told to), zmesh and meshlib,
as far as bench/peers-setup has installed them. Libraries are given by their files: Debian's is libmeshoptimizer.so.2d.

Run it by a Python with numpy; published volumes are those of TETRACUBES_DATA.
"""
import argparse
import ctypes
import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np

SHARES = (0.5, 0.2, 0.1, 0.05)
METHODS = ("tetra", "hybrid", "snap")
FOLDED = -0.8660254037844386
FAULTS = ("edges", "vertices", "border", "components", "Euler", "folds", "twice")


def fields(tool, folder):
    """Name, input, isovalue and more options of each."""
    data = os.environ.get("TETRACUBES_DATA", "")
    for name, kind, size, more in (("sphere", "f32", 96, []), ("gyroid", "u8", 64, []), ("gyroid", "f32", 64, ["--closed"]),
                                   ("noise", "f32", 24, ["--closed"])):
        path = os.path.join(folder, f"{name}.nrrd")
        subprocess.run([tool, "generate", name, "--dims", f"{size},{size},{size}", "--type", kind, "-o", path, "--quiet"],
                       check=True)
        yield f"{name} {size}³ {kind}" + (", closed" if more else ""), [path], 127.5, more
    for name, path, iso, more in PUBLISHED:
        path = os.path.join(data, path)
        if data and os.path.exists(path):
            yield name, [path], iso, more
        else:
            print(f"simplify.py: without {name}: no {path}", file=sys.stderr)


PUBLISHED = (("bolt", "uniform/bolt.nrrd", 100.5, []), ("neghip", "uniform/neghip.nrrd", 98.5, []),
             ("embryo, every second sample", "uniform/embryo.nrrd", 87.5, ["--step", "2"]))


# ------------------------------------------------------------------------------------------------------------- meshes

def half_edges(faces):
    """(from, to), edge by edge of each triangle."""
    return np.concatenate([faces[:, [k, (k + 1) % 3]] for k in range(3)]).astype(np.int64)


def border_keys(points, faces):
    """Edges with one triangle, as the bytes of their ends."""
    edges = half_edges(faces)
    n = edges.max() + 1 if len(edges) else 1
    code, back = edges[:, 0] * n + edges[:, 1], edges[:, 1] * n + edges[:, 0]
    alone = edges[~np.isin(code, back)]
    ends = np.ascontiguousarray(np.concatenate([points[alone[:, 0]], points[alone[:, 1]]], axis=1, dtype=np.float32) + 0)
    return set(map(bytes, ends))


def roots(count, edges):
    """Of every vertex the lowest one of its component, by passing numbers along edges and along what they lead to."""
    root = np.arange(count)
    while True:
        before = root.copy()
        np.minimum.at(root, edges[:, 0], root[edges[:, 1]])
        np.minimum.at(root, edges[:, 1], root[edges[:, 0]])
        while not np.array_equal(root, root[root]):
            root = root[root]
        if np.array_equal(root, before):
            return root


def fan_count(faces, count):
    """Vertices with several fans: corners are joined over the edges at their vertex."""
    corner_of = np.concatenate([faces[:, k] for k in range(3)])
    nxt = np.concatenate([faces[:, (k + 1) % 3] for k in range(3)]).astype(np.int64)
    prv = np.concatenate([faces[:, (k + 2) % 3] for k in range(3)]).astype(np.int64)
    base = np.int64(count)
    key = corner_of.astype(np.int64) * base
    order = np.argsort(key + nxt, kind="stable")
    at = np.searchsorted((key + nxt)[order], key + prv)
    at[at == len(order)] = 0
    found = (key + nxt)[order][at] == key + prv if len(order) else np.zeros(0, bool)
    edges = np.stack([np.nonzero(found)[0], order[at][found]], axis=1)
    root = roots(len(corner_of), edges) if len(corner_of) else np.zeros(0, int)
    fans = np.bincount(corner_of[root == np.arange(len(root))], minlength=count) if len(root) else np.zeros(count, int)
    return int((fans > 1).sum())


def normals(points, faces):
    a, b, c = (points[faces[:, k]].astype(np.float64) for k in range(3))
    return np.cross(b - a, c - a)


def fold_count(points, faces):
    edges = half_edges(faces)
    of = np.tile(np.arange(len(faces)), 3)
    n = np.int64(len(points))
    code, back = edges[:, 0] * n + edges[:, 1], edges[:, 1] * n + edges[:, 0]
    order = np.argsort(code, kind="stable")
    at = np.searchsorted(code[order], back)
    at[at == len(order)] = 0
    pair = (code[order][at] == back) & (edges[:, 0] < edges[:, 1]) if len(order) else np.zeros(0, bool)
    normal = normals(points, faces)
    one, other = normal[of[pair]], normal[of[order[at[pair]]]]
    lengths = np.sqrt((one * one).sum(1) * (other * other).sum(1))
    return int(((lengths > 0) & ((one * other).sum(1) < FOLDED * lengths)).sum())


def facts(points, faces):
    """What is counted of a mesh."""
    used, faces = np.unique(faces, return_inverse=True)
    faces = faces.reshape(-1, 3)
    points = points[used]
    edges = half_edges(faces)
    plain = np.sort(edges, axis=1)
    unique, uses = np.unique(plain, axis=0, return_counts=True)
    directed = np.unique(edges, axis=0)
    root = roots(len(points), unique) if len(points) else np.zeros(0, int)
    return {"triangles": len(faces), "vertices": fan_count(faces, len(points)),
            "edges": int((uses > 2).sum()) + len(edges) - len(directed),
            "border": border_keys(points, faces), "components": int((root == np.arange(len(root))).sum()),
            "Euler": len(points) - len(unique) + len(faces), "folds": fold_count(points, faces),
            "twice": len(faces) - len(np.unique(np.sort(faces, axis=1), axis=0))}


def compared(before, after):
    """What is wrong with the second one, each fault with its number."""
    return {"edges": max(0, after["edges"] - before["edges"]), "vertices": max(0, after["vertices"] - before["vertices"]),
            "border": len(before["border"] ^ after["border"]), "components": after["components"] - before["components"],
            "Euler": after["Euler"] - before["Euler"], "folds": max(0, after["folds"] - before["folds"]),
            "twice": max(0, after["twice"] - before["twice"])}


# -------------------------------------------------------------------------------------------------------------- sides

def run_tool(tool, inputs, iso, more, folder):
    path = os.path.join(folder, "mesh.npz")
    begin = time.perf_counter()
    done = subprocess.run([tool, "extract", *inputs, "--iso", str(iso), "--engine", "reference", "--json", *more, "-o", path],
                          stdout=subprocess.PIPE, check=True, text=True)
    seconds = time.perf_counter() - begin
    with np.load(path) as file:
        return file["vertices"].astype(np.float32), file["faces"], json.loads(done.stdout)["surfaces"][0], seconds


def meshoptimizer(path, locks_border):
    library = ctypes.CDLL(path)
    call = library.meshopt_simplify
    pointers = ctypes.c_void_p
    call.restype = ctypes.c_size_t
    call.argtypes = [pointers, pointers, ctypes.c_size_t, pointers, ctypes.c_size_t, ctypes.c_size_t, ctypes.c_size_t,
                     ctypes.c_float, ctypes.c_uint, pointers]

    def side(points, faces, share):
        points, faces = np.ascontiguousarray(points, np.float32), np.ascontiguousarray(faces, np.uint32)
        out = np.empty_like(faces)
        count = call(out.ctypes.data, faces.ctypes.data, faces.size, points.ctypes.data, len(points), 12,
                     3 * int(np.ceil(share * len(faces))), 3e38, int(locks_border), None)
        return points, out.reshape(-1)[:count].reshape(-1, 3)
    return side


def as_vtk(points, faces):
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    mesh, vertices, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    vertices.SetData(numpy_to_vtk(points, deep=1))
    cells.SetData(3, numpy_to_vtkIdTypeArray(faces.astype(np.int64).ravel(), deep=1))
    mesh.SetPoints(vertices)
    mesh.SetPolys(cells)
    return mesh


def vtk_side(name, **switches):
    def side(points, faces, share):
        from vtkmodules import vtkFiltersCore
        from vtkmodules.util.numpy_support import vtk_to_numpy
        decimation = getattr(vtkFiltersCore, name)()
        decimation.SetInputData(as_vtk(points, faces))
        decimation.SetTargetReduction(1 - share)
        for switch, value in switches.items():
            getattr(decimation, "Set" + switch)(value)
        decimation.Update()
        made = decimation.GetOutput()
        return (vtk_to_numpy(made.GetPoints().GetData()).astype(np.float32),
                vtk_to_numpy(made.GetPolys().GetConnectivityArray()).reshape(-1, 3))
    return side


def zmesh_side(points, faces, share):
    import zmesh
    mesh = zmesh.Mesh(points.astype(np.float32), faces.astype(np.uint32), None)
    made = zmesh.simplify_fqmr(mesh, target_count=int(share * len(faces)), preserve_border=True)
    return made.vertices, made.faces


def meshlib_side(points, faces, share):
    from meshlib import mrmeshnumpy, mrmeshpy
    mesh = mrmeshnumpy.meshFromFacesVerts(faces.astype(np.int32), points)
    settings = mrmeshpy.DecimateSettings()
    settings.strategy = mrmeshpy.DecimateStrategy.MinimizeError
    settings.maxError = 1e30
    settings.maxDeletedFaces = int((1 - share) * len(faces))
    settings.packMesh = True
    mrmeshpy.decimateMesh(mesh, settings)
    return mrmeshnumpy.getNumpyVerts(mesh).astype(np.float32), mrmeshnumpy.getNumpyFaces(mesh.topology)


PEERS = {"vtkQuadricDecimation": vtk_side("vtkQuadricDecimation"),
         "vtkDecimatePro": vtk_side("vtkDecimatePro", PreserveTopology=1, Splitting=0, BoundaryVertexDeletion=0),
         "zmesh": zmesh_side, "meshlib": meshlib_side}


def sides_of(arguments):
    sides = {}
    for path in arguments.library:
        name = os.path.basename(os.path.realpath(path)).removeprefix("lib").replace(".so.", " ")
        sides[name] = meshoptimizer(path, True)
    return {**sides, **(PEERS if arguments.peers else {})}


def row_of(case, method, share, side, before, points, faces, seconds, **more):
    after = facts(points, faces)
    return {"case": case, "method": method, "share": share, "side": side, "before": before["triangles"],
            "triangles": after["triangles"], "faults": compared(before, after), "seconds": round(seconds, 3), **more}


def show(row):
    wrong = ", ".join(f"{number:+d} {name}" for name, number in row["faults"].items() if number)
    distances = f", distances {row['distance_to']:.3g} {row['distance_from']:.3g}" if "distance_to" in row else ""
    print(f"{row['case']}, {row['method']}, {row['share']}: {row['side']}: {row['triangles']} of {row['before']} in "
          f"{row['seconds']:.2f} s{distances}: {wrong or 'as it was'}", flush=True)


def run_case(arguments, case, inputs, iso, more, folder):
    rows = []
    for method in arguments.methods:
        how = [*more, "--method", method]
        points, faces, _, _ = run_tool(arguments.tool, inputs, iso, [*how, "--drop-degenerate"], folder)
        before = facts(points, faces)
        for share in SHARES:
            made_points, made_faces, told, _ = run_tool(arguments.tool, inputs, iso, [*how, "--simplify", str(share)], folder)
            rows.append(row_of(case, method, share, "tetracubes", before, made_points, made_faces,
                               told["timings_ms"]["simplify"] / 1e3, distance_to=told["simplified"]["distance_to"],
                               distance_from=told["simplified"]["distance_from"]))
            show(rows[-1])
            for side, simplify in sides_of(arguments).items():
                try:
                    begin = time.perf_counter()
                    made = simplify(points, faces, share)
                except Exception as missing:  # a package that is not there, or refuses
                    print(f"simplify.py: without {side}: {missing}", file=sys.stderr)
                    continue
                rows.append(row_of(case, method, share, side, before, *made, time.perf_counter() - begin))
                show(rows[-1])
    return rows


# -------------------------------------------------------------------------------------------------------------- table

TABLE_SHARES = (0.2, 0.05)


def cell(row):
    """The share that is left, where it is another one, and what is wrong."""
    if row is None:
        return ""
    left = row["triangles"] / row["before"]
    reached = "" if left <= 1.05 * row["share"] + 8 / row["before"] else f"{left:.2g}: "
    return reached + (", ".join(f"{abs(number):,} {name}" for name, number in row["faults"].items() if number) or "–")


def table(rows):
    sides = list(dict.fromkeys(row["side"] for row in rows if row["side"] != "tetracubes"))
    found = {(row["case"], row["method"], row["share"], row["side"]): row for row in rows}
    lines = ["| surface | triangles | share | --simplify | distances | " + " | ".join(sides) + " |",
             "| --- | --: | --: | --- | --- |" + " --- |" * len(sides)]
    for case, method, share, side in found:
        if side != "tetracubes" or share not in TABLE_SHARES:
            continue
        ours = found[case, method, share, side]
        distances = f"{ours['distance_to']:.2g}, {ours['distance_from']:.2g}"
        others = " | ".join(cell(found.get((case, method, share, other))) for other in sides)
        lines.append(f"| {case}, {method} | {ours['before']:,} | {share} | {cell(ours)} | {distances} | {others} |")
    return "\n".join(lines)


def run(arguments):
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for case, inputs, iso, more in fields(arguments.tool, folder):
            if arguments.only in case:
                rows += run_case(arguments, case, inputs, iso, more, folder)
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            file.write("[\n" + ",\n".join(map(json.dumps, rows)) + "\n]\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(required=True)
    parts = commands.add_parser("run")
    parts.set_defaults(command=run)
    parts.add_argument("tool")
    parts.add_argument("--library", action="append", default=[], help="meshoptimizer, to be called as it is")
    parts.add_argument("--peers", action="store_true")
    parts.add_argument("--methods", nargs="+", default=METHODS, choices=METHODS)
    parts.add_argument("--only", default="", help="cases whose name has this in it")
    parts.add_argument("--json", help="file for the rows")
    parts = commands.add_parser("table")
    parts.set_defaults(command=lambda given: print(table([row for path in given.results for row in json.load(open(path))])))
    parts.add_argument("results", nargs="+")
    arguments = parser.parse_args()
    arguments.command(arguments)


if __name__ == "__main__":
    main()
