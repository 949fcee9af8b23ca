"""Volumes larger than memory: contoured by parts, and joined into the mesh that one piece would give, byte for byte.

The mesh's order is that of bricks, and bricks follow each other by layers of four planes. So a part that owns whole
layers owns consecutive vertices and triangles of the whole mesh. It is extracted with one more layer on each side: what
its vertices depend on is then there, and so is the first layer of the next part, whose vertices its last triangles use.
What remains is to count what lies before a layer.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from .grid import Grid
from .mesh import Mesh

_LAYER = 4  # planes of a brick
_PART_BYTES = 1 << 28  # of samples, about


def isosurface_by_parts(volume: Any, level: float, *, planes: int | None = None, spacing: npt.ArrayLike = 1,
                        origin: npt.ArrayLike = 0, direction: npt.ArrayLike | None = None, mask: Any = None,
                        nodata: float | None = None, method: str = "tetra", carry: Mapping[str, Any] | None = None,
                        normals: bool = False, axes: str = "zyx", device: int | str | None = None,
                        engine: str = "auto", max_memory: int | None = None,
                        progress: Callable[[str, float], object] | None = None) -> Mesh:
    """The mesh of ``isosurface``, byte for byte, of a volume that is read by parts: of dask, zarr, h5py, numpy.memmap.

        mesh = tetracubes.isosurface_by_parts(zarr.open("scan.zarr"), 127.5)

    volume: (z, y, x), with shape and dtype; volume[z0:z1] is read, one part at a time, each plane once and eight more
    per part. So chunks that are long in y and x suit it. mask and fields to carry are read the same way.
    planes: samples along z in a part, rounded up to a multiple of 4; by default as many as have about 256 MB.
    method: "tetra" or "hybrid". The mesh itself has to fit into memory. The rest as for ``isosurface``.
    """
    if len(volume.shape) != 3:
        raise ValueError(f"volume has {len(volume.shape)} dimensions, not 3: z, y, x")
    if method == "snap":
        raise ValueError("method 'snap' moves samples near the borders of parts: use 'tetra' or 'hybrid', or isosurface")
    count = volume.shape[0]
    if planes is None:
        planes = _PART_BYTES // max(1, int(np.prod(volume.shape[1:])) * np.dtype(volume.dtype).itemsize)
    elif planes < 1:
        raise ValueError(f"planes is {planes}, not a number of samples along z")
    planes = -(-max(planes, 1) // _LAYER) * _LAYER
    same: dict[str, Any] = {"spacing": spacing, "origin": origin, "direction": direction, "nodata": nodata,
                            "axes": axes, "device": device, "engine": engine, "max_memory": max_memory}
    parts = [_Part(volume, level, mask, method, same, first, min(first + planes, count))
             for first in range(0, max(count - 1, 1), planes)]
    made, vertices = [], 0
    for number, part in enumerate(parts):
        if progress:
            same["progress"] = _share(progress, number, len(parts))
        made.append(part.extract(vertices, normals, carry or {}))
        vertices += len(made[-1].positions)
    return _joined(made)


def _share(progress, number, count):
    """Tells progress of a part among so many."""
    return lambda stage, fraction: progress(stage, (number + fraction) / count)


class _Part:
    """The planes from first to before end, whose vertices and cells above them are the part's own."""

    def __init__(self, volume, level, mask, method, same, first, end):
        self.whole, self.level, self.mask, self.method, self.same = volume, level, mask, method, same
        self.first, self.end = first, end if end < volume.shape[0] - 1 else volume.shape[0]
        self.low, self.high = max(0, first - _LAYER), min(self.end + _LAYER + 1, volume.shape[0])

    def extract(self, base, normals, carry):
        """The part's own vertices and triangles; base: vertices of the parts before it."""
        self.samples = self.whole[self.low:self.high]
        self.samples = self.samples if isinstance(self.samples, np.ndarray) else np.asanyarray(self.samples)
        self.present = None if self.mask is None else np.asarray(self.mask[self.low:self.high])
        fields = {name: np.asarray(array[self.low:self.high]) for name, array in carry.items()}
        with self._grid(slice(None), (self.low, self.whole.shape[0])) as grid:
            mesh = grid.extract(self.level, method=self.method, normals=normals, carry=fields)
        start, triangle_start, cell_start = self._before(self.first)
        end, triangle_end, cell_end = self._before(self.end)
        if self.end == self.whole.shape[0]:
            end, triangle_end, cell_end = len(mesh.positions), len(mesh.triangles), mesh.active_cells
        del self.samples, self.present
        if base + len(mesh.positions) - start >= 1 << 32:
            raise ValueError("the surface has more vertices than indices of 32 bits reach: extract parts of the volume")
        return Mesh(mesh.positions[start:end], mesh.triangles[triangle_start:triangle_end] + np.uint32(base)
                    - np.uint32(start), mesh._normals if mesh._normals is None else mesh._normals[start:end],
                    {name: array[start:end] for name, array in mesh.values.items()}, mesh.origin, mesh.axes,
                    cell_end - cell_start)

    def _grid(self, which, part):
        return Grid(self.samples[which], mask=None if self.present is None else self.present[which], part=part,
                    **self.same)

    def _count(self, which, first):
        with self._grid(which, (first, None)) as grid:
            return grid.count(self.level, method=self.method)

    def _before(self, plane):
        """Vertices, triangles and active cells of the part as extracted that come before those of a plane."""
        at = plane - self.low
        if not 0 < at < len(self.samples):
            return 0, 0, 0
        counts = self._count(slice(at + 1), self.low)
        # Of these, vertices in the plane itself come later. A layer of cells and its mirror image share them.
        one = self._count(slice(at - 1, at + 1), plane - 1).vertices
        two = self._count([at - 1, at, at - 1], plane - 1).vertices
        return counts.vertices - (2 * one - two), counts.faces, counts.active_cells


def _joined(parts):
    normals = [part._normals for part in parts]
    return Mesh(np.concatenate([part.positions for part in parts]), np.concatenate([part.triangles for part in parts]),
                None if normals[0] is None else np.concatenate(normals),
                {name: np.concatenate([part.values[name] for part in parts]) for name in parts[0].values},
                parts[0].origin, parts[0].axes, sum(part.active_cells for part in parts))
