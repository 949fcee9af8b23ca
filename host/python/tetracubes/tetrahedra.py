"""Interval volumes: what lies between two levels, as tetrahedra."""
from __future__ import annotations

import ctypes
import os
from typing import Any

import numpy as np

from .library import complex_file, files
from .mesh import check_written, fields_of


class Tetrahedra:
    """The part of a grid with low <= f < high, as tetrahedra that fit together.

    Its border is the surfaces of both levels, with their vertices, and the part of the grid's own border in between.
    """

    def __init__(self, positions: np.ndarray, tetrahedra: np.ndarray, counts: tuple[int, int, int],
                 values: dict[str, np.ndarray], origin: np.ndarray, axes: str) -> None:
        #: float32 (n, 3), **x, y, z**, relative to ``origin``
        self.positions = positions
        #: uint32 (m, 4): vertex numbers, of positive volume in x, y, z
        self.tetrahedra = tetrahedra
        #: vertices at samples within, on the surface of low, on that of high: they follow each other so
        self.counts = counts
        #: carried fields by name: float32 (n,), or (n, components)
        self.values = values
        #: float64 (3,), x, y, z: 0 unless the grid lies far from 0
        self.origin = origin
        self.axes = axes

    def _world(self) -> np.ndarray:
        return self.origin + self.positions if self.origin.any() else self.positions

    @property
    def vertices(self) -> np.ndarray:
        """(n, 3), world space, components in the order of the volume's axes, as ``Mesh.vertices``."""
        return self._world() if self.axes == "xyz" else self._world()[:, ::-1]

    @property
    def volumes(self) -> np.ndarray:
        """float64 (m,): of each tetrahedron; their sum is the volume between the levels."""
        corners = self.positions.astype(np.float64)[self.tetrahedra]
        first, second, third = (corners[:, n] - corners[:, 0] for n in (1, 2, 3))
        return np.einsum("ij,ij->i", np.cross(first, second), third) / 6

    def mean(self, name: str) -> Any:
        """The mean of a carried field over the volume, of each component; NaN of nothing."""
        volumes = self.volumes
        inner = self.values[name].astype(np.float64)[self.tetrahedra].mean(axis=1)
        with np.errstate(invalid="ignore"):
            return np.tensordot(volumes, inner, 1) / volumes.sum()

    def __repr__(self) -> str:
        return f"<tetracubes.Tetrahedra: {len(self.positions)} vertices, {len(self.tetrahedra)} tetrahedra>"

    def save(self, path: str | os.PathLike, format: str | None = None) -> None:  # pylint: disable=redefined-builtin
        """Writes the tetrahedra with their values: .vtu, which ParaView, PyVista and meshio read.

        The bytes are the tool's: coordinates are x, y, z in world space. An older file stays whole until the new one is
        complete. format: "vtu", whatever path ends in. ``to_meshio`` has other formats.
        """
        points, corners = (np.ascontiguousarray(array) for array in (self._world(), self.tetrahedra))
        if corners.size and corners.max() >= len(points):
            raise ValueError(f"a tetrahedron has vertex {corners.max()}, and there are {len(points)} vertices")
        file = complex_file(point_count=len(points), tetrahedron_count=len(corners), tetrahedra=corners.ctypes.data)
        setattr(file, "points" if points.dtype == np.float32 else "points_f64", points.ctypes.data)
        fields, _values = fields_of(self.values)
        check_written(files.mesh_files_save_complex(os.fsencode(path), None if format is None else format.encode(),
                                                    ctypes.byref(file), *fields))

    def to_meshio(self) -> Any:
        """A meshio.Mesh, coordinates x, y, z; values as point data."""
        import meshio  # pylint: disable=import-outside-toplevel
        return meshio.Mesh(self._world(), [("tetra", self.tetrahedra.astype(np.int64))], point_data=dict(self.values))

    def to_pyvista(self) -> Any:
        """A pyvista.UnstructuredGrid, coordinates x, y, z; values as point data."""
        import pyvista  # pylint: disable=import-outside-toplevel
        made = pyvista.UnstructuredGrid({10: self.tetrahedra.astype(np.int64)}, self._world())
        for name, array in self.values.items():
            made.point_data[name] = array
        return made
