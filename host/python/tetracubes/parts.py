"""Volumes larger than memory: contoured by parts, and joined into the mesh that one piece would give, byte for byte.

The mesh's order is that of bricks, and bricks follow each other by layers of four planes. So a part that owns whole
layers owns consecutive vertices and triangles of the whole mesh (tc_extract_piece). Its last triangles use vertices of
the next part, whose numbers that part's seam tells.
"""
from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from .grid import Grid, extract_options
from .library import tc, tc_counts
from .mesh import Mesh

_LAYER = 4  # planes of a brick
_HALO = {"snap": (8, 8)}  # planes before and behind those that a part owns
_PART_BYTES = 1 << 28  # of samples, about


def isosurface_by_parts(volume: Any, level: float, *, planes: int | None = None, spacing: npt.ArrayLike = 1,
                        origin: npt.ArrayLike = 0, direction: npt.ArrayLike | None = None, mask: Any = None,
                        nodata: float | None = None, method: str = "tetra", snap: float | None = None,
                        closed: bool = False, carry: Mapping[str, Any] | None = None,
                        normals: bool = False, axes: str = "zyx", device: int | str | None = None,
                        engine: str = "auto", max_memory: int | None = None,
                        progress: Callable[[str, float], object] | None = None) -> Mesh:
    """The mesh of ``isosurface``, byte for byte, of a volume that is read by parts: of dask, zarr, h5py, numpy.memmap.

        mesh = tetracubes.isosurface_by_parts(zarr.open("scan.zarr"), 127.5)

    volume: (z, y, x), with shape and dtype; volume[z0:z1] is read, one part at a time, each plane once and six more
    per part, with method "snap" sixteen. So chunks that are long in y and x suit it. Two parts are in memory at once.
    mask and fields to carry are read the same way.
    planes: samples along z in a part, rounded up to a multiple of 4; by default as many as have about 256 MB.
    The mesh itself has to fit into memory. The rest as for ``isosurface``.
    """
    if not hasattr(volume, "shape") or not hasattr(volume, "dtype"):
        raise ValueError(f"volume is a {type(volume).__name__}, which has no shape and dtype: numpy.asarray makes an array")
    if len(volume.shape) != 3:
        raise ValueError(f"volume has {len(volume.shape)} dimensions, not 3: z, y, x")
    count = volume.shape[0]
    if planes is None:
        planes = _PART_BYTES // max(1, int(np.prod(volume.shape[1:])) * np.dtype(volume.dtype).itemsize)
    elif planes < 1:
        raise ValueError(f"planes is {planes}, not a number of samples along z")
    planes = -(-max(planes, 1) // _LAYER) * _LAYER
    same: dict[str, Any] = {"spacing": spacing, "origin": origin, "direction": direction, "nodata": nodata,
                            "axes": axes, "device": device, "engine": engine, "max_memory": max_memory}
    how = extract_options(level, method, snap, normals, closed)
    starts = range(0, count, planes)
    made, vertices, waiting = [], 0, None
    for number, first in enumerate(starts):
        if progress:
            same["progress"] = _share(progress, number, len(starts))
        part = _Part(volume, how, _HALO.get(method, (_LAYER, 2)), mask, carry or {}, same, first,
                     min(first + planes, count))
        if waiting:
            made.append(_numbered(waiting.extract(part.seam()), vertices))
            vertices += len(made[-1].positions)
        waiting = part
    made.append(_numbered(waiting.extract(None), vertices))
    return _joined(made)


def _share(progress, number, count):
    """Tells progress of a part among so many."""
    return lambda stage, fraction: progress(stage, (number + fraction) / count)


class _Part:
    """The planes from first to before end, whose vertices and cells above them are the part's own."""

    def __init__(self, volume, how, halo, mask, carry, same, first, end):
        before, behind = halo
        self.how, planes = how, volume.shape[0]
        low, high = max(0, first - before), min(end + behind, planes)
        samples = volume[low:high]
        samples = samples if isinstance(samples, np.ndarray) else np.asanyarray(samples)
        self.fields = {name: np.asarray(array[low:high]) for name, array in carry.items()}
        self.grid = Grid(samples, mask=None if mask is None else np.asarray(mask[low:high]), part=(low, planes),
                         owned=(first - low, end - low), **same)

    def seam(self):
        """Of the part's first layer: how many of its vertices lie before each brick."""
        seam = np.empty(tc.tc_seam_size(self.grid._handle), np.uint32)
        counts = tc_counts()
        self.grid._call(tc.tc_count_piece, ctypes.byref(self.how), ctypes.byref(counts), seam.ctypes.data, seam.size)
        return seam

    def extract(self, seam):
        """The part's own vertices and triangles; seam: of the next part, None of the last."""
        address, size = (None, 0) if seam is None else (seam.ctypes.data, seam.size)
        with self.grid:
            return self.grid._extract(tc.tc_extract_piece, self.how, self.fields, address, size)


def _numbered(part, base):
    """The part's mesh; its vertices come behind those of the parts before it."""
    if base + int(part.triangles.max(initial=0)) >= 1 << 32:
        raise ValueError("the surface has more vertices than indices of 32 bits reach: extract parts of the volume")
    part.triangles = part.triangles + np.uint32(base)
    return part


def _joined(parts):
    normals = [part._normals for part in parts]
    return Mesh(np.concatenate([part.positions for part in parts]), np.concatenate([part.triangles for part in parts]),
                None if normals[0] is None else np.concatenate(normals),
                {name: np.concatenate([part.values[name] for part in parts]) for name in parts[0].values},
                parts[0].origin, parts[0].axes, sum(part.active_cells for part in parts))
