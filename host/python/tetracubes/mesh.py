"""The mesh that extractions return: arrays, its hash, files, and objects of other packages."""
from __future__ import annotations

import ctypes
import os
import tempfile
import warnings
from typing import Any

import numpy as np
import numpy.typing as npt

from .library import files, tc_mesh_data, view_angles

_USAGE, _NO_MEMORY_FOR = 2, "out of memory"  # of exit_status.h; how the tool's sentences on memory begin
_SIDES = 16, 8192  # pixels, of picture.h


def check_written(status):
    """Raises what a status of the writers means."""
    if status:
        text = files.mesh_files_message().decode(errors="replace").replace("--format", "format=")
        error = ValueError if status == _USAGE else MemoryError if text.startswith(_NO_MEMORY_FOR) else OSError
        raise error(text)


def fields_of(values):
    """Count, names, components and addresses of carried fields, as the writers take them; and the arrays themselves."""
    count = len(values)
    arrays = [np.ascontiguousarray(array, np.float32) for array in values.values()]
    names = (ctypes.c_char_p * count)(*[name.encode() for name in values])
    components = (ctypes.c_int * count)(*[array[:1].size if array.ndim > 1 else 1 for array in arrays])
    addresses = (ctypes.c_void_p * count)(*[array.ctypes.data for array in arrays])
    return (count, names, components, addresses), arrays


def _views():
    """Angles of views by their names; None: where none is chosen."""
    found, angles = {}, view_angles()
    while (name := files.mesh_files_view(len(found), ctypes.byref(angles))) is not None:
        found[name.decode()] = view_angles(angles.azimuth, angles.elevation)
    return {**found, None: angles}


_VIEWS = _views()


def _angles(view):
    if view is None or isinstance(view, str):
        if view not in _VIEWS:
            raise ValueError(f"view is {view!r}, not one of {', '.join(filter(None, _VIEWS))}")
        return _VIEWS[view]
    try:
        azimuth, elevation = map(float, view)
    except (TypeError, ValueError) as error:
        raise ValueError(f"view is {view!r}, neither a name nor azimuth and elevation in degrees") from error
    if not (abs(azimuth) <= 360 and abs(elevation) <= 90):
        raise ValueError(f"view is {view!r}: azimuth goes to 360 degrees, elevation to 90")
    return view_angles(azimuth, elevation)


def _point(origin_at):
    """Three doubles, as the writers take them."""
    if origin_at is None:
        return None
    point = np.asarray(origin_at, np.float64)
    if point.shape != (3,) or not np.isfinite(point).all():
        raise ValueError(f"origin_at is {origin_at!r}, not three finite numbers")
    return (ctypes.c_double * 3)(*point)


class Mesh:
    """A triangle mesh: a surface that separates samples >= level from those below.

    Vertices are shared; triangles wind counter-clockwise seen from outside, which is the side of the lower values. The
    same input gives the same bytes on every device.
    """

    def __init__(self, positions: np.ndarray, triangles: np.ndarray, normals: np.ndarray | None,
                 values: dict[str, np.ndarray], origin: np.ndarray, axes: str, active_cells: int,
                 boundary_labels: np.ndarray | None = None) -> None:
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
        #: of a label map: uint32 (m, 2), labels of each triangle's inner and outer side: the lower one, then the other; 0,
        #: the background, is always the other. None: no label map
        self.boundary_labels = boundary_labels
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
                  None if self._normals is None else np.ascontiguousarray(self._normals, np.float32),
                  None if self.boundary_labels is None else np.ascontiguousarray(self.boundary_labels, np.uint32)]
        if arrays[1].size and arrays[1].max() >= len(arrays[0]):
            raise ValueError(f"a face has vertex {arrays[1].max()}, and the mesh {len(arrays[0])} vertices")
        addresses = [None if array is None else array.ctypes.data for array in arrays]
        data = tc_mesh_data(vertex_count=len(arrays[0]), triangle_count=len(arrays[1]), positions=addresses[0],
                            triangles=addresses[1], normals=addresses[2], origin=tuple(self.origin),
                            boundary_labels=addresses[3])
        return data, arrays

    def save(self, path: str | os.PathLike, format: str | None = None,  # pylint: disable=redefined-builtin
             origin_at: npt.ArrayLike | None = None) -> None:
        """Writes the mesh: .ply, .vtp, .stl, .obj, .off, .glb, .npz or .html, with normals and values where it has them;
        or a picture of it: .png, as of ``preview``.

        The bytes are the tool's: coordinates are x, y, z in world space. An older file stays whole until the new one is
        complete. format: "ply", ..., whatever path ends in. The tool's VTKHDF needs libhdf5, which the package has not:
        .vtp holds the same.
        origin_at: the point x, y, z that becomes 0, 0, 0 in the file. Without it .stl, .glb and .html, which hold float32
        alone, count from ``origin`` where that is not 0, with a warning.
        """
        if format is None and os.fsdecode(path).lower().endswith(".png"):
            self.preview(path)
            return
        data, _arrays = self._data()
        fields, _values = fields_of(self.values)
        is_relative = ctypes.c_int()
        check_written(files.mesh_files_save(os.fsencode(path), None if format is None else format.encode(),
                                            ctypes.byref(data), *fields, _point(origin_at), ctypes.byref(is_relative)))
        if is_relative.value:
            warnings.warn(f"{os.fspath(path)} has float32 coordinates, relative to {', '.join(map(str, self.origin))}",
                          RuntimeWarning, stacklevel=2)

    def picture(self, view: str | tuple[float, float] | None = None,
                size: tuple[int, int] = (1024, 768)) -> np.ndarray:
        """The mesh as an image, uint8 (height, width, 3), sRGB: sides towards the lower values blue, others ochre;
        of a label map each label in a colour of its own.

        view: "iso", "front", "back", "left", "right", "top", "bottom", or azimuth and elevation in degrees. From the
        front, which is along +y, x runs to the right and z up.
        size: width and height, 16 to 8192 pixels each.
        """
        angles = _angles(view)
        width, height = (int(side) for side in size)
        if not _SIDES[0] <= min(width, height) <= max(width, height) <= _SIDES[1]:
            raise ValueError(f"size is {size!r}: width and height are from {_SIDES[0]} to {_SIDES[1]} pixels")
        pixels = np.full((height, width, 3), 255, np.uint8)
        data, _arrays = self._data()
        check_written(files.mesh_files_draw(ctypes.byref(data), angles, width, height, pixels.ctypes.data))
        return pixels

    def preview(self, path: str | os.PathLike, view: str | tuple[float, float] | None = None,
                size: tuple[int, int] = (1024, 768)) -> None:
        """Writes ``picture`` as PNG; the pixels are those of the tool's --preview."""
        pixels = self.picture(view, size)
        check_written(files.mesh_files_save_picture(os.fsencode(path), pixels.shape[1], pixels.shape[0], pixels.ctypes.data))

    def _repr_png_(self):
        """The picture that a notebook shows; None where the package was built without PNG."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "mesh.png")
            try:
                self.preview(path, size=(640, 480))
            except ValueError:
                return None
            with open(path, "rb") as file:
                return file.read()

    def of_label(self, label: int) -> Mesh:
        """The surface of one label of a label map, as a mesh of its own: triangles are counter-clockwise seen from
        outside the label, which is the first of their two."""
        if self.boundary_labels is None:
            raise ValueError("the mesh has no labels: it is that of an isosurface")
        own = (self.boundary_labels == label).any(axis=1)
        sides, triangles = self.boundary_labels[own], self.triangles[own]
        turned = sides[:, 0] != label
        triangles[turned], sides[turned] = triangles[turned][:, ::-1], sides[turned][:, ::-1]
        used, numbers = np.unique(triangles, return_inverse=True)
        return Mesh(self.positions[used], numbers.reshape(triangles.shape).astype(np.uint32), None, {}, self.origin,
                    self.axes, self.active_cells, sides)

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
        if self.boundary_labels is not None:
            made.cell_data["BoundaryLabels"] = self.boundary_labels
        return made

    def to_meshio(self) -> Any:
        """A meshio.Mesh, coordinates x, y, z; values, and normals as "Normals", as point data."""
        import meshio  # pylint: disable=import-outside-toplevel
        normals = {} if self._normals is None else {"Normals": self._normals}
        return meshio.Mesh(self._world(), [("triangle", self.triangles.astype(np.int64))],
                           point_data={**self.values, **normals})
