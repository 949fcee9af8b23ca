"""Grids, and the surfaces extracted from them."""
from __future__ import annotations

import ctypes
import warnings
import weakref
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from . import arrays, context as contexts
from .library import (check, options, tc, tc_counts, tc_device_mesh, tc_engine, tc_extract_options, tc_field,
                      tc_grid_options, tc_interval_volume_data, tc_interval_volume_options, tc_labels_options, tc_mesh_data, tc_method)
from .mesh import Mesh
from .tetrahedra import Tetrahedra

Self = TypeVar("Self", bound="GridBase")
Progress = Callable[[str, float], object]
METHODS = {tc.tc_method_name(method).decode(): method for method in tc_method}


class Counts(NamedTuple):
    """The sizes of a surface."""

    vertices: int
    faces: int
    active_cells: int  #: that the surface passes through
    mesh_bytes: int


class DeviceMesh(NamedTuple):
    """A mesh in OpenCL buffers; a buffer of nothing is None."""

    positions: Any  #: pyopencl.Buffer: 3 float32 per vertex, x, y, z, relative to origin
    normals: Any  #: the same of normals; None where they were not asked for
    triangles: Any  #: pyopencl.Buffer: 3 uint32 per triangle
    vertex_count: int
    triangle_count: int
    origin: np.ndarray  #: float64 (3,), x, y, z
    event: Any  #: pyopencl.Event: complete when the mesh is there


def extract_options(level, method="tetra", snap=None, normals=False, closed=False):
    """What an extraction is asked for: the one place where its options are set."""
    if method not in METHODS:
        raise ValueError(f"method is {method!r}, not one of {', '.join(METHODS)}")
    how = options(tc_extract_options)
    how.isovalue = float(level)
    how.method = METHODS[method]
    how.normals = bool(normals)
    if snap is not None:
        if method != "snap":
            raise ValueError(f"snap is the threshold of method 'snap', and method is {method!r}: leave it out")
        how.snap = float(snap)
    how.closed = bool(closed)
    return how


def check_axes(axes):
    """The order of x, y and z in vectors."""
    if axes not in ("zyx", "xyz"):
        raise ValueError(f"axes is {axes!r}, not 'zyx' or 'xyz'")
    return axes


class GridBase:
    """A grid of the library's, in a context: what structured and unstructured ones share."""

    def __init__(self, context, create, how, keep, axes, point_shape):
        self._context, self._keep, self._axes, self._point_shape = context, keep, axes, point_shape
        handle = ctypes.c_void_p()
        try:
            context.call(create, context.handle, ctypes.byref(how), ctypes.byref(handle))
        except BaseException:
            self._release(handle, context)
            raise
        self._handle = handle
        self._end = weakref.finalize(self, self._release, handle, context)

    @staticmethod
    def _release(handle, context):
        tc.tc_grid_destroy(handle)
        if hasattr(context, "key"):
            contexts.give_back(context)

    def close(self) -> None:
        """Frees what the grid holds on the device. Meshes stay."""
        self._end()
        self._keep = None

    def __enter__(self: Self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _call(self, function, *arguments):
        if not self._end.alive:
            raise ValueError("the grid is closed")
        self._context.call(function, self._handle, *arguments)

    def count(self, level: float, *, method: str = "tetra", snap: float | None = None, normals: bool = False,
              closed: bool = False) -> Counts:
        """The sizes of the surface that ``extract`` would make, as Counts; makes none."""
        counts = tc_counts()
        how = extract_options(level, method, snap, normals, closed)
        self._call(tc.tc_count, ctypes.byref(how), ctypes.byref(counts))
        return Counts(counts.vertex_count, counts.triangle_count, counts.active_cell_count, counts.mesh_bytes)

    def extract(self, level: float, *, method: str = "tetra", snap: float | None = None, normals: bool = False,
                closed: bool = False, carry: Mapping[str, Any] | None = None) -> Mesh:
        """The surface of a level, as a Mesh.

        level: a number; samples >= level are inside.
        method: "tetra"; of volumes also "hybrid" (fewer triangles) or "snap" (fewest, of good shape).
        snap: of method "snap", how far a sample may move, as a part of an edge: 0 to 0.5.
        normals: whether vertices have unit normals; of volumes only.
        closed: whether the surface is closed at the grid's border and beside missing samples.
        carry: {name: array}: other fields of the grid, interpolated at the vertices into ``mesh.values``; arrays have
        the volume's shape, or one axis more, of components.
        """
        how = extract_options(level, method, snap, normals, closed)
        return self._extract(tc.tc_extract, how, _fields_of(carry))

    def _extract(self, function, how, carry, *arguments):
        """The surface by tc_extract or tc_extract_piece, whose further arguments stand before the pointer to the mesh."""
        fields = {name: self._field(name, array) for name, array in carry.items()}
        labelled = isinstance(how, tc_labels_options)
        handle = ctypes.c_void_p()
        try:
            self._call(function, ctypes.byref(how), *arguments, ctypes.byref(handle))
        finally:
            memory = LibraryMemory(handle, tc.tc_mesh_destroy)
        data = tc_mesh_data()
        check(tc.tc_mesh_get(handle, ctypes.byref(data)))
        shape = data.vertex_count, 3
        return Mesh(arrays.owned(data.positions, shape, np.float32, memory),
                    arrays.owned(data.triangles, (data.triangle_count, 3), np.uint32, memory),
                    arrays.owned(data.normals, shape, np.float32, memory) if not labelled and how.normals else None,
                    {name: self._carried(tc.tc_interpolate_field, how, field, data.vertex_count) for name, field in fields.items()},
                    np.array(data.origin), self._axes, data.active_cell_count,
                    arrays.owned(data.boundary_labels, (data.triangle_count, 2), np.uint32, memory) if labelled else None)

    def labels(self, labels: npt.ArrayLike | None = None, *, smoothing: int | None = None, closed: bool = False) -> Mesh:
        """The surfaces between the labels of a volume of integers, as one Mesh with ``boundary_labels``.

        labels: those that are wanted; others, 0, negative and missing samples are background. None: all.
        smoothing: sweeps, 8 unless given; 0 leaves the stairs of the voxels.
        closed: whether surfaces are closed half a voxel beyond the volume's border.
        """
        how = options(tc_labels_options)
        wanted = None if labels is None else np.ascontiguousarray(np.atleast_1d(labels))
        if wanted is not None:
            are_whole = wanted.ndim == 1 and wanted.size and wanted.dtype.kind in "iu"
            if not are_whole or wanted.min() < 1 or wanted.max() > 0xffffffff:
                raise ValueError(f"labels is {labels!r}, not whole numbers above 0")
            wanted = wanted.astype(np.uint32)
            how.labels, how.label_count = wanted.ctypes.data, wanted.size
        if smoothing is not None:
            if int(smoothing) != smoothing or not 0 <= smoothing <= 1000:
                raise ValueError(f"smoothing is {smoothing!r}, not a number of sweeps from 0 to 1000")
            how.smoothing = int(smoothing)
        how.closed = bool(closed)
        return self._extract(tc.tc_extract_labels, how, {})

    def isovolume(self, low: float | None, high: float | None, *,
                  carry: Mapping[str, Any] | None = None) -> Tetrahedra:
        """The part with low <= samples < high, as Tetrahedra; None: there is no such bound.

        carry: as of ``extract``.
        """
        fields = {name: self._field(name, array) for name, array in _fields_of(carry).items()}
        how = options(tc_interval_volume_options)
        how.low = how.low if low is None else float(low)
        how.high = how.high if high is None else float(high)
        handle, data = ctypes.c_void_p(), tc_interval_volume_data()
        try:
            self._call(tc.tc_extract_interval_volume, ctypes.byref(how), ctypes.byref(handle))
        finally:
            memory = LibraryMemory(handle, tc.tc_interval_volume_destroy)
        check(tc.tc_interval_volume_get(handle, ctypes.byref(data)))
        return Tetrahedra(arrays.owned(data.positions, (data.vertex_count, 3), np.float32, memory),
                          arrays.owned(data.tetrahedra, (data.tetrahedron_count, 4), np.uint32, memory),
                          (data.sample_count, data.low_count, data.high_count),
                          {name: self._carried(tc.tc_interpolate_interval_volume, how, field, data.vertex_count)
                           for name, field in fields.items()}, np.array(data.origin), self._axes)

    def _field(self, name, array):
        what = f"carry[{name!r}]"
        array = arrays.values_of(array, what)
        if array.shape[:len(self._point_shape)] != self._point_shape or array.ndim > len(self._point_shape) + 1:
            raise ValueError(f"{what} has the shape {array.shape}, and the grid {self._point_shape}")
        return array

    def _carried(self, interpolate, how, array, vertex_count):
        components = array.shape[len(self._point_shape):]
        values = np.empty((vertex_count, *components), np.float32)
        if values.size:
            field = tc_field(type=arrays.TYPES[array.dtype], components=components[0] if components else 1,
                             values=array.ctypes.data)
            self._call(interpolate, ctypes.byref(how), ctypes.byref(field), values.ctypes.data, values.size)
        return values


class LibraryMemory:
    """A result of the library's, destroyed with the last array over it. Where the interpreter ends it stays."""

    def __init__(self, handle, destroy):
        weakref.finalize(self, destroy, handle).atexit = False


class Grid(GridBase):
    """A volume, ready for extraction: later levels cost what they touch.

        with tetracubes.Grid(volume) as grid:
            meshes = [grid.extract(level) for level in levels]

    volume: (z, y, x), at least 2 samples along each axis; anything that numpy takes, and what offers DLPack on the CPU.
    Integers of up to 32 bits, float32 and float64 are used where they lie if they are contiguous and of native byte
    order; all else is copied. It may not change while the grid lives. Masked, infinite and NaN samples are missing: a
    cell with a missing corner is left out.
    spacing, origin: of samples, in any unit of length; three numbers, or one for all.
    direction: (3, 3), its columns the directions of the axes.
    mask: booleans of the volume's shape; false, 0 or NaN: the sample is missing.
    nodata: samples of this value are missing.
    axes: "zyx" or "xyz": the order of components in spacing, origin, direction, vertices and normals. The volume's axes
    are z, y, x in both.
    device: a number of ``devices()``, "platform:device", "cpu", "gpu" or part of a name.
    engine: "opencl", "reference" (one core, no OpenCL, the same bytes), or "auto": the reference where there is no
    OpenCL, with a warning.
    max_memory: bound on device buffers, in bytes; less means slower, never another mesh.
    progress: progress(stage, fraction), told now and then how far the call under way is, from 0 to 1. Ctrl-C, and what
    it raises, end the call.
    part: of a volume that is a part of a larger one: the number of its first plane there, and how many planes that has.
    Surfaces of parts that share a plane then fit to the bit; see also isosurface_by_parts.
    owned: of a part with a halo, the first plane that it owns and the one behind the last: tc_grid_options of the
    library says what is allowed. The grid then gives what the part owns.
    """

    _opencl: Any = None  # the pyopencl.Context of from_opencl

    def __init__(self, volume: Any, *, spacing: npt.ArrayLike = 1, origin: npt.ArrayLike = 0,
                 direction: npt.ArrayLike | None = None, mask: Any = None, nodata: float | None = None,
                 axes: str = "zyx", device: int | str | None = None, engine: str = "auto",
                 max_memory: int | None = None, progress: Progress | None = None,
                 part: tuple[int, int | None] | None = None, owned: tuple[int, int] | None = None) -> None:
        samples, missing = arrays.volume_of(volume, mask)
        how = self._options(samples.shape, samples.dtype, spacing, origin, direction, nodata, axes)
        how.samples, how.blanked_samples = arrays.address(samples), arrays.address(missing)
        if part is not None:
            how.first_index[2], planes = part
            if planes is not None:
                whole = options(tc_grid_options)
                whole.dims[:] = *how.dims[:2], planes
                how.whole = ctypes.pointer(whole)
        if owned is not None:
            how.owned[:] = owned
        context = contexts.take(engine, device, max_memory)
        context.progress = progress
        super().__init__(context, tc.tc_grid_create, how, (samples, missing), axes, samples.shape)

    @staticmethod
    def _options(shape, dtype, spacing, origin, direction, nodata, axes):
        how = options(tc_grid_options)
        how.dims[:] = shape[::-1]
        how.type = arrays.type_of(dtype)
        for row, numbers in zip(how.matrix, arrays.matrix(spacing, origin, direction, check_axes(axes))):
            row[:] = numbers
        if nodata is not None:
            how.has_nodata, how.nodata = 1, float(nodata)
        return how

    @classmethod
    def from_opencl(cls, context: Any, queue: Any, buffer: Any, shape: Sequence[int], dtype: npt.DTypeLike, *,
                    offset: int = 0, spacing: npt.ArrayLike = 1, origin: npt.ArrayLike = 0,
                    direction: npt.ArrayLike | None = None, nodata: float | None = None, axes: str = "zyx",
                    max_memory: int | None = None, progress: Progress | None = None) -> Grid:
        """A grid of samples in a pyopencl.Buffer, which are not copied.

        context, queue: pyopencl.Context and an in-order pyopencl.CommandQueue of it. Commands that write the buffer come
        first in the queue, or are complete.
        shape: (z, y, x); dtype: of the samples; offset: of the first one, in samples. The rest as for a volume.
        """
        shape = tuple(int(size) for size in shape)
        if len(shape) != 3:
            raise ValueError(f"shape is {shape}, not three sizes: z, y, x")
        how = cls._options(shape, dtype, spacing, origin, direction, nodata, axes)
        how.cl_samples, how.cl_samples_offset = buffer.int_ptr, offset
        own = contexts.Context(tc_engine.TC_ENGINE_OPENCL, None, int(max_memory or 0), context.int_ptr, queue.int_ptr)
        own.progress = progress
        grid = cls.__new__(cls)
        GridBase.__init__(grid, own, tc.tc_grid_create, how, (context, queue, buffer), axes, shape)
        grid._opencl = context
        return grid

    def extract_on_device(self, level: float, *, method: str = "tetra", snap: float | None = None,
                          normals: bool = False) -> DeviceMesh:
        """The surface in OpenCL buffers of the context given to ``from_opencl``, as a DeviceMesh.

        The kernels are enqueued in its queue; nothing waits for them but ``event``.
        """
        import pyopencl  # pylint: disable=import-outside-toplevel
        if self._opencl is None:
            raise ValueError("the grid was not made by Grid.from_opencl: there is no OpenCL context to leave a mesh in")
        how = extract_options(level, method, snap, normals)
        counts, origin, event = tc_counts(), (ctypes.c_double * 3)(), ctypes.c_void_p()
        self._call(tc.tc_count, ctypes.byref(how), ctypes.byref(counts))

        def buffer(count):
            return pyopencl.Buffer(self._opencl, pyopencl.mem_flags.READ_WRITE, 12 * count) if count else None

        made = buffer(counts.vertex_count), buffer(normals and counts.vertex_count), buffer(counts.triangle_count)
        addresses = [None if one is None else one.int_ptr for one in made]
        mesh = tc_device_mesh(positions=addresses[0], normals=addresses[1], triangles=addresses[2])
        self._call(tc.tc_grid_origin, ctypes.byref(origin))
        self._call(tc.tc_emit, ctypes.byref(how), ctypes.byref(mesh), ctypes.byref(event))
        return DeviceMesh(*made, counts.vertex_count, counts.triangle_count, np.array(origin),
                          pyopencl.Event.from_int_ptr(event.value or 0, retain=False))


def isosurface(volume: Any, level: float, *, spacing: npt.ArrayLike = 1, origin: npt.ArrayLike = 0,
               direction: npt.ArrayLike | None = None, mask: Any = None, nodata: float | None = None,
               method: str = "tetra", snap: float | None = None, carry: Mapping[str, Any] | None = None,
               normals: bool = False, closed: bool = False, axes: str = "zyx", device: int | str | None = None,
               engine: str = "auto", max_memory: int | None = None, progress: Progress | None = None) -> Mesh:
    """The surface that separates samples >= level of a volume (z, y, x) from those below it, as a Mesh.

        mesh = tetracubes.isosurface(volume, 127.5, spacing=(2, 1, 1))
        mesh.vertices, mesh.faces

    Arguments are those of Grid, and of Grid.extract. Bad input is a ValueError that says what is wrong with it. Where
    there is no surface the mesh is empty, and a RuntimeWarning says so.
    """
    with Grid(volume, spacing=spacing, origin=origin, direction=direction, mask=mask, nodata=nodata, axes=axes,
              device=device, engine=engine, max_memory=max_memory, progress=progress) as grid:
        mesh = grid.extract(level, method=method, snap=snap, normals=normals, closed=closed, carry=carry)
    if len(mesh.faces) == 0:
        warnings.warn(f"the surface at {level} is empty: does the level lie within the values?", RuntimeWarning,
                      stacklevel=2)
    return mesh


def _fields_of(carry):
    if carry is not None and not isinstance(carry, Mapping):
        raise TypeError(f"carry is a {type(carry).__name__}, not a dict of names and arrays")
    for name in carry or {}:
        if not isinstance(name, str) or "\0" in name:
            raise ValueError(f"carry has the name {name!r}, which is no text")
    return carry or {}


def _labels_of(volume, nodata):
    """Labels that are float numbers or 64-bit integers as uint32, without nodata; other volumes as they are."""
    volume = volume if hasattr(volume, "dtype") else np.asarray(volume)
    if volume.dtype.kind != "f" and (volume.dtype.kind not in "iu" or volume.dtype.itemsize < 8):
        return volume, nodata
    values = np.ma.getdata(volume)
    above = np.isfinite(values) & (values > 0) & ~np.ma.getmaskarray(volume)
    if nodata is not None:
        above &= values != nodata
    wanted = values[above]
    if wanted.size and (np.any(wanted != np.floor(wanted)) or wanted.max() > 0xffffffff):
        raise ValueError("labels are whole numbers below 2**32: the samples are not")
    return np.where(above, values, 0).astype(np.uint32), None


def labels(volume: Any, labels: npt.ArrayLike | None = None, *,  # pylint: disable=redefined-outer-name
           smoothing: int | None = None, closed: bool = False, spacing: npt.ArrayLike = 1, origin: npt.ArrayLike = 0,
           direction: npt.ArrayLike | None = None, mask: Any = None, nodata: float | None = None, axes: str = "zyx",
           device: int | str | None = None, engine: str = "auto", max_memory: int | None = None,
           progress: Progress | None = None) -> Mesh:
    """The surfaces between the labels of a segmentation (z, y, x), shared by neighbours, as a Mesh.

        mesh = tetracubes.labels(segmentation, spacing=(2, 1, 1))
        mesh.boundary_labels, mesh.of_label(7)

    Arguments are those of Grid, and of Grid.labels. The surface of each label by itself is a manifold. Floating-point
    numbers are taken where all that are above 0 are whole.
    """
    volume, nodata = _labels_of(volume, nodata)
    with Grid(volume, spacing=spacing, origin=origin, direction=direction, mask=mask, nodata=nodata, axes=axes,
              device=device, engine=engine, max_memory=max_memory, progress=progress) as grid:
        return grid.labels(labels, smoothing=smoothing, closed=closed)


def isovolume(volume: Any, low: float | None, high: float | None, *, carry: Mapping[str, Any] | None = None,
              **how: Any) -> Tetrahedra:
    """The part of a volume (z, y, x) with low <= samples < high, as Tetrahedra; None: there is no such bound.

        part = tetracubes.isovolume(volume, 100, 200, carry={"dose": dose})
        part.volumes.sum(), part.mean("dose")

    The other arguments are those of Grid. A sample within whole makes up to five tetrahedra, 80 bytes.
    """
    with Grid(volume, **how) as grid:
        return grid.isovolume(low, high, carry=carry)
