"""The mesh that extractions return: arrays, its hash, files, and objects of other packages."""
from __future__ import annotations

import ctypes
import os
import warnings
from typing import Any

import numpy as np

from .library import files, tc_mesh_data

_USAGE = 2  # of exit_status.h


class Mesh:
    """A triangle mesh: a surface that separates samples >= level from those below.

    Vertices are shared; triangles wind counter-clockwise seen from outside, which is the side of the lower values. The
    same input gives the same bytes on every device.
    """

    def __init__(self, positions: np.ndarray, triangles: np.ndarray, normals: np.ndarray | None,
                 values: dict[str, np.ndarray], origin: np.ndarray, axes: str, active_cells: int) -> None:
        #: float32 (n, 3), **x, y, z**, relative to ``origin``: what ``hash`` is of
        self.positions = positions
        #: uint32 (m, 3), counter-clockwise seen from outside in x, y, z
        self.triangles = triangles
        #: carried fields by name: float32 (n,), or (n, components)
        self.values = values
        #: float64 (3,), x, y, z: 0 unless the grid lies far from 0
        self.origin = origin
        #: cells that the surface passes through
        self.active_cells = active_cells
        self.axes = axes
        self._normals = normals

    def _turned(self, array):
        """Tuples in the order of the mesh's axes."""
        return array if self.axes == "xyz" else array[:, ::-1]

    @property
    def vertices(self) -> np.ndarray:
        """(n, 3), world space, in the units of spacing; components in the order of the volume's axes (z, y, x), or
        x, y, z with ``axes="xyz"``. float32, a view of ``positions``; float64 where the grid lies far from 0."""
        return self._turned(self._world())

    @property
    def faces(self) -> np.ndarray:
        """uint32 (m, 3): vertex numbers, counter-clockwise seen from outside in the space that ``vertices`` has."""
        return self._turned(self.triangles)

    @property
    def normals(self) -> np.ndarray | None:
        """float32 (n, 3): unit normals, the negated gradient, components as in ``vertices``; zero where that vanishes.
        None where they were not asked for."""
        return None if self._normals is None else self._turned(self._normals)

    @property
    def hash(self) -> str:
        """XXH64 of positions, then triangles: 16 hexadecimal digits, as the tool prints them."""
        return f"{files.mesh_files_hash(ctypes.byref(self._data()[0])):016x}"

    def __repr__(self) -> str:
        return f"<tetracubes.Mesh: {len(self.positions)} vertices, {len(self.triangles)} faces>"

    def _data(self):
        """The mesh as the C interface has it, and the arrays that it points into."""
        arrays = [np.ascontiguousarray(self.positions, np.float32), np.ascontiguousarray(self.triangles, np.uint32),
                  None if self._normals is None else np.ascontiguousarray(self._normals, np.float32)]
        places = [None if array is None else array.ctypes.data for array in arrays]
        data = tc_mesh_data(vertex_count=len(arrays[0]), triangle_count=len(arrays[1]), positions=places[0],
                            triangles=places[1], normals=places[2], origin=tuple(self.origin))
        return data, arrays

    def save(self, path: str | os.PathLike, format: str | None = None) -> None:  # pylint: disable=redefined-builtin
        """Writes the mesh: .ply, .vtp, .stl or .obj, with normals and values where the format has them.

        The bytes are the tool's: coordinates are x, y, z in world space. An older file stays whole until the new one is
        complete. format: "ply", ..., whatever path ends in.
        """
        data, _arrays = self._data()
        count = len(self.values)
        values = [np.ascontiguousarray(array, np.float32) for array in self.values.values()]
        names = (ctypes.c_char_p * count)(*[name.encode() for name in self.values])
        components = (ctypes.c_int * count)(*[array[:1].size if array.ndim > 1 else 1 for array in values])
        places = (ctypes.c_void_p * count)(*[array.ctypes.data for array in values])
        is_relative = ctypes.c_int()
        status = files.mesh_files_save(os.fsencode(path), None if format is None else format.encode(),
                                       ctypes.byref(data), count, names, components, places, ctypes.byref(is_relative))
        if status:
            text = files.mesh_files_message().decode(errors="replace")
            raise ValueError(text) if status == _USAGE else OSError(text)
        if is_relative.value:
            warnings.warn(f"{os.fspath(path)} has float32 coordinates, relative to {', '.join(map(str, self.origin))}",
                          RuntimeWarning, stacklevel=2)

    # Other packages name coordinates x, y, z, and so do files: there the order is always that.

    def _world(self):
        return self.positions + self.origin if self.origin.any() else self.positions

    def to_trimesh(self) -> Any:
        """A trimesh.Trimesh, coordinates x, y, z; one-component values as vertex attributes."""
        import trimesh  # pylint: disable=import-outside-toplevel
        return trimesh.Trimesh(self._world(), self.triangles, vertex_normals=self._normals,
                               vertex_attributes=dict(self.values), process=False)

    def to_pyvista(self) -> Any:
        """A pyvista.PolyData, coordinates x, y, z; values, and normals as "Normals", as point data."""
        import pyvista  # pylint: disable=import-outside-toplevel
        threes = np.full((len(self.triangles), 1), 3, np.int64)
        made = pyvista.PolyData(self._world(), np.hstack([threes, self.triangles]).ravel())
        for name, array in self.values.items():
            made.point_data[name] = array
        if self._normals is not None:
            made.point_data.active_normals = self._normals
        return made

    def to_meshio(self) -> Any:
        """A meshio.Mesh, coordinates x, y, z; values, and normals as "Normals", as point data."""
        import meshio  # pylint: disable=import-outside-toplevel
        normals = {} if self._normals is None else {"Normals": self._normals}
        return meshio.Mesh(self._world(), [("triangle", self.triangles.astype(np.int64))],
                           point_data={**self.values, **normals})
