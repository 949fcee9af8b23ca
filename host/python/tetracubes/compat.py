"""scikit-image's function, so that one import line is changed:

    from tetracubes.compat import marching_cubes  # was: from skimage.measure import marching_cubes
"""
from __future__ import annotations

import numpy as np
import numpy.typing as npt

from . import arrays
from .grid import isosurface


def marching_cubes(volume: npt.ArrayLike, level: float | None = None, *,
                   spacing: tuple[float, float, float] = (1.0, 1.0, 1.0), gradient_direction: str = "descent",
                   step_size: int = 1, allow_degenerate: bool = True, method: str = "lewiner",
                   mask: npt.ArrayLike | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """skimage.measure.marching_cubes: (verts, faces, normals, values), arguments and errors as there.

    verts: (n, 3), in the order of the volume's axes, times spacing: float32, float64 where spacing is not 1.
    faces: int32 (m, 3). normals: float32 (n, 3).
    values: float32 (n,): the greater sample of the edge that a vertex lies on; there, the greatest of the cubes around it.

    Made by the method "hybrid": vertices lie on the same edges of cubes as there; where a cube is ambiguous, the
    tetrahedra decide which of them are joined. ``method`` is checked, and has no other effect.
    """
    samples = arrays.values_of(np.ma.getdata(volume) if isinstance(volume, np.ma.MaskedArray) else volume, "volume")
    if samples.ndim != 3 or min(samples.shape) < 2:
        raise ValueError("Input array must be a 3D array of at least 2 x 2 x 2 samples.")
    if level is None:
        level = 0.5 * (float(samples.min()) + float(samples.max()))
    elif not samples.min() <= level <= samples.max():
        raise ValueError("Surface level must be within volume data range.")
    if method not in ("lewiner", "lorensen"):
        raise ValueError("method should be either 'lewiner' or 'lorensen'")
    if gradient_direction not in ("descent", "ascent"):
        raise ValueError(f"Incorrect input {gradient_direction} in `gradient_direction`, see docstring.")
    if len(spacing) != 3:
        raise ValueError("`spacing` must consist of three floats.")
    if int(step_size) < 1:
        raise ValueError("step_size must be at least one.")
    if mask is not None and np.shape(mask) != samples.shape:
        raise ValueError("volume and mask must have the same shape.")
    every = (slice(None, None, int(step_size)),) * 3
    samples = np.ascontiguousarray(samples[every])
    mesh = isosurface(samples, level, mask=None if mask is None else np.asarray(mask)[every], method="hybrid",
                      normals=True)
    if not len(mesh.triangles):
        raise RuntimeError("No surface found at the given iso value.")
    verts, faces = mesh.vertices, mesh.faces.view(np.int32)
    values = _greater_ends(samples, verts).astype(np.float32)
    if step_size != 1:
        verts = verts * np.float32(step_size)
    if not np.array_equal(spacing, (1, 1, 1)):
        verts = verts * np.asarray(spacing, np.float64)
    if gradient_direction == "descent":
        faces = faces[:, ::-1]  # clockwise seen from the lower values, in the order of the volume's axes
    if not allow_degenerate:
        a, b, c = (verts[faces[:, corner]] for corner in range(3))
        faces = faces[np.cross(b - a, c - a).any(axis=1)]
    return verts, faces, np.asarray(mesh.normals), values


def _greater_ends(samples, verts):
    """The greater sample of the edge that each vertex lies on; verts in index space."""
    def at(ends):
        z, y, x = ends.astype(np.intp).T
        return samples.ravel().take((z * samples.shape[1] + y) * samples.shape[2] + x)

    return np.maximum(at(np.floor(verts)), at(np.ceil(verts)))
