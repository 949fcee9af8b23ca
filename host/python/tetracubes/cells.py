"""Unstructured grids: cells as meshio and PyVista have them."""
from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from . import arrays, context as contexts
from .grid import GridBase
from .library import check, options, tc, tc_cells, tc_tetrahedra, tc_tetrahedra_grid_options
from .mesh import Mesh

# VTK's number of meshio's name of a type.
_MESHIO = {
    "vertex": 1, "line": 3, "triangle": 5, "polygon": 7, "quad": 9, "tetra": 10, "hexahedron": 12, "wedge": 13,
    "pyramid": 14, "penta_prism": 15, "hexa_prism": 16, "line3": 21, "triangle6": 22, "quad8": 23, "tetra10": 24,
    "hexahedron20": 25, "wedge15": 26, "pyramid13": 27, "quad9": 28, "hexahedron27": 29, "wedge12": 31, "wedge18": 32,
    "hexahedron24": 33, "triangle7": 34, "line4": 35,
}


def _integers(values, kind, what):
    """The values as an array of an integer type; what it cannot hold is refused."""
    given = np.asarray(values)
    if given.size == 0 or np.can_cast(given.dtype, kind):
        return np.ascontiguousarray(given, kind)
    if given.dtype.kind not in "iu":
        raise ValueError(f"{what} are of type {given.dtype}, not integers")
    converted = np.ascontiguousarray(given, kind)
    if (converted != given).any():
        raise ValueError(f"{what} go from {given.min()} to {given.max()}: they do not fit {np.dtype(kind)}")
    return converted


def _blocks(cells):
    """Types, offsets and connectivity of meshio's blocks: pairs of a type's name and points (cells, points of each)."""
    types, sizes, points = [], [], []
    for block in cells.items() if isinstance(cells, Mapping) else cells:
        name, data = (block.type, block.data) if hasattr(block, "data") else block
        if name not in _MESHIO:
            raise ValueError(f"cells of type {name!r} are not known: {', '.join(_MESHIO)} are")
        data = _integers(data, np.int64, f"points of cells of type {name!r}")
        if data.ndim != 2:
            raise ValueError(f"cells of type {name!r} have {data.ndim} dimensions, not 2: cells, points of each")
        types.append(np.full(len(data), _MESHIO[name], np.uint8))
        sizes.append(np.full(len(data), data.shape[1], np.int64))
        points.append(data.ravel())
    ends = np.concatenate([np.zeros(1, np.int64), *sizes]).cumsum()
    return np.concatenate([np.empty(0, np.uint8), *types]), ends, np.concatenate([np.empty(0, np.int64), *points])


def _vtk(cells):
    """Types, offsets and connectivity as VTK has them."""
    types = _integers(cells[0], np.uint8, "types of cells")
    offsets = _integers(cells[1], np.int64, "offsets of cells")
    connectivity = _integers(cells[2], np.int64, "connectivity of cells")
    if types.ndim != 1 or offsets.shape != (len(types) + 1,) or connectivity.ndim != 1:
        raise ValueError(f"cells have types, offsets and connectivity of the shapes {types.shape}, {offsets.shape} and "
                         f"{connectivity.shape}, not (n,), (n + 1,) and (m,)")
    if offsets[0] != 0 or offsets[-1] != len(connectivity) or (np.diff(offsets) < 0).any():
        raise ValueError("offsets of cells do not rise from 0 to the length of connectivity")
    return types, offsets, connectivity


def contour_cells(points: npt.ArrayLike, cells: Any, values: npt.ArrayLike, level: float, *,
                  method: str = "tetra", closed: bool = False, carry: Mapping[str, npt.ArrayLike] | None = None,
                  skip_unsupported: bool = False, device: int | str | None = None, engine: str = "auto",
                  max_memory: int | None = None,
                  progress: Callable[[str, float], object] | None = None) -> Mesh:
    """The surface that separates values >= level from those below, in an unstructured grid of any cells.

        m = meshio.read("can.ex2")
        mesh = tetracubes.contour_cells(m.points, m.cells, m.point_data["temperature"], 400)

        g = pyvista.read("can.vtu")  # versions before 0.49 call cell_offsets offset
        mesh = tetracubes.contour_cells(g.points, (g.celltypes, g.cell_offsets, g.cell_connectivity), g["temperature"], 400)

    points: (n, 3): x, y, z, in any unit of length.
    cells: meshio's blocks or dictionary (type's name, point numbers), or three arrays as VTK has them: types, offsets
    (one more than cells) and connectivity. Tetrahedra, hexahedra, voxels, wedges, pyramids and prisms, quadratic ones
    by their corners; cells of fewer dimensions are left out.
    values: (n,), one per point. Where one is not finite, the tetrahedra there are left out.
    method: "tetra"; or "hybrid", which makes fewer triangles of cells that are no tetrahedra.
    closed: whether the surface is closed at the grid's border: by the faces that one cell has.
    skip_unsupported: whether cells that cannot be cut are left out instead of refused.
    The rest as for ``isosurface``. Vertices are x, y, z.
    """
    positions, samples = arrays.values_of(points, "points"), arrays.values_of(values, "values")
    if positions.ndim != 2 or positions.shape[1] != 3:
        raise ValueError(f"points have the shape {positions.shape}, not (n, 3)")
    if positions.dtype != np.float32:
        positions = np.ascontiguousarray(positions, np.float64)
    if samples.shape != positions.shape[:1]:
        raise ValueError(f"values have the shape {samples.shape}, and there are {len(positions)} points: one value each")
    member = "points" if positions.dtype == np.float32 else "points_f64"
    is_vtk = isinstance(cells, tuple) and len(cells) == 3 and not any(isinstance(part, tuple) for part in cells)
    types, offsets, connectivity = _vtk(cells) if is_vtk else _blocks(cells)
    given = tc_cells(point_count=len(positions), cell_count=len(types), types=types.ctypes.data,
                     offsets=offsets.ctypes.data, connectivity=connectivity.ctypes.data,
                     skip_unsupported=skip_unsupported, **{member: positions.ctypes.data})
    cut = tc_tetrahedra()
    check(tc.tc_tetrahedralize(ctypes.byref(given), ctypes.byref(cut)))
    try:
        how = options(tc_tetrahedra_grid_options)
        how.point_count, how.type, how.samples = len(positions), arrays.TYPES[samples.dtype], samples.ctypes.data
        how.tetrahedron_count, how.tetrahedra = cut.tetrahedron_count, cut.tetrahedra
        setattr(how, member, positions.ctypes.data)
        if method == "hybrid":
            how.source, how.cells = ctypes.addressof(given), cut.cells
        context = contexts.take(engine, device, max_memory)
        context.progress = progress
        with GridBase(context, tc.tc_tetrahedra_grid_create, how, (positions, samples), "xyz", samples.shape) as grid:
            return grid.extract(level, method=method, closed=closed, carry=carry)
    finally:
        tc.tc_tetrahedra_release(ctypes.byref(cut))
