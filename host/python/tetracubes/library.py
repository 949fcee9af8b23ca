"""The C library: its types and functions as tetracubes.h declares them, and errors as exceptions.

The only file that knows the C interface; tests/python compares every struct, enumerator and function here with what the
C compiler makes of the header. Arrays are plain addresses (c_void_p): arrays.py sees to their types and sizes.
"""
import ctypes
import enum
from ctypes import CFUNCTYPE, POINTER, Structure, c_char_p, c_double, c_int, c_int64, c_size_t, c_uint32, c_uint64, c_void_p
from pathlib import Path

__all__: list = []  # nothing here is for users

FOLDER = Path(__file__).absolute().parent  # not what a link leads to: in a build, the modules are links

# ------------------------------------------------------------------------------------------------------- enumerators


class tc_status(enum.IntEnum):
    TC_OK = 0
    TC_ERROR_ARGUMENT = 1
    TC_ERROR_DATA = 2
    TC_ERROR_DEVICE = 3
    TC_ERROR_MEMORY = 4
    TC_ERROR_LIMIT = 5
    TC_ERROR_CANCELLED = 6
    TC_ERROR_FILE = 7
    TC_ERROR_WRONG_RESULT = 8


class tc_engine(enum.IntEnum):
    TC_ENGINE_OPENCL = 0
    TC_ENGINE_REFERENCE = 1


class tc_type(enum.IntEnum):
    TC_U8 = 0
    TC_I8 = 1
    TC_U16 = 2
    TC_I16 = 3
    TC_U32 = 4
    TC_I32 = 5
    TC_F32 = 6
    TC_F64 = 7


class tc_method(enum.IntEnum):
    TC_METHOD_TETRA = 0
    TC_METHOD_HYBRID = 1
    TC_METHOD_SNAP = 2


class tc_division(enum.IntEnum):
    TC_DIVISION_DEFAULT = 0
    TC_DIVISION_BUILT_IN = 1
    TC_DIVISION_FP64 = 2
    TC_DIVISION_INTEGER = 3


class tc_verdict(enum.IntEnum):
    TC_VERDICT_NONE = 0
    TC_VERDICT_GOOD = 1
    TC_VERDICT_WRONG_RESULT = 2
    TC_VERDICT_REFUSED = 3
    TC_VERDICT_CRASHED = 4
    TC_VERDICT_HUNG = 5
    TC_VERDICT_STOPPED = 6
    TC_VERDICT_CANCELLED = 7


# ------------------------------------------------------------------------------------------------ callbacks, structs

tc_progress = CFUNCTYPE(c_int, c_void_p, c_char_p, c_double)
tc_child_trial = CFUNCTYPE(c_int, c_void_p, c_char_p, c_void_p, c_size_t)


class _Sized(Structure):
    """A struct whose first member is its own size."""

    def __init__(self, **members):
        super().__init__(struct_size=ctypes.sizeof(self), **members)


class tc_device_info(_Sized):
    _fields_ = [("struct_size", c_size_t), ("platform_index", c_int), ("device_index", c_int),
                ("platform", ctypes.c_char * 128), ("name", ctypes.c_char * 128), ("version", ctypes.c_char * 128),
                ("driver", ctypes.c_char * 128), ("type", ctypes.c_char * 16), ("compute_units", c_uint32),
                ("max_work_group_size", c_uint64), ("global_memory_bytes", c_uint64), ("max_buffer_bytes", c_uint64),
                ("local_memory_bytes", c_uint64), ("shares_host_memory", c_int), ("has_fp64", c_int),
                ("rounds_division", c_int)]


class tc_expert_options(_Sized):
    _fields_ = [("struct_size", c_size_t), ("work_items", c_uint32), ("work_groups", c_uint32),
                ("tile_bricks", c_uint32), ("spin_limit", c_uint32), ("division", c_int), ("always_copy", c_int),
                ("child_trial", tc_child_trial), ("child_trial_user", c_void_p)]


class tc_context_options(_Sized):
    _fields_ = [("struct_size", c_size_t), ("engine", c_int), ("device", c_char_p), ("cl_context", c_void_p),
                ("cl_queue", c_void_p), ("max_memory_bytes", c_uint64), ("progress", tc_progress),
                ("progress_user", c_void_p), ("check_device", c_int), ("expert", POINTER(tc_expert_options))]


class tc_grid_options(_Sized):
    pass


tc_grid_options._fields_ = [
    ("struct_size", c_size_t), ("dims", c_int64 * 3), ("first_index", c_int64 * 3), ("type", c_int),
    ("samples", c_void_p), ("matrix", c_double * 4 * 3), ("has_nodata", c_int), ("nodata", c_double),
    ("cl_samples", c_void_p), ("cl_samples_offset", c_uint64), ("axes", c_void_p * 3), ("points", c_void_p),
    ("blanked_samples", c_void_p), ("blanked_cells", c_void_p), ("axes_f64", c_void_p * 3), ("points_f64", c_void_p),
    ("has_origin", c_int), ("origin", c_double * 3), ("whole", POINTER(tc_grid_options)), ("owned", c_int64 * 2)]


class tc_extract_options(_Sized):
    _fields_ = [("struct_size", c_size_t), ("isovalue", c_double), ("normals", c_int), ("method", c_int),
                ("snap", c_double), ("closed", c_int), ("reserved", c_int)]


class tc_labels_options(_Sized):
    _fields_ = [("struct_size", c_size_t), ("labels", c_void_p), ("label_count", c_uint64), ("smoothing", c_uint32),
                ("closed", c_int)]


class tc_counts(_Sized):
    _fields_ = [("struct_size", c_size_t), ("vertex_count", c_uint64), ("triangle_count", c_uint64),
                ("active_cell_count", c_uint64), ("mesh_bytes", c_uint64), ("classify_ms", c_double)]


class tc_timings(Structure):
    _fields_ = [("classify_ms", c_double), ("emit_ms", c_double), ("readback_ms", c_double), ("total_ms", c_double)]


class tc_mesh_data(_Sized):
    _fields_ = [("struct_size", c_size_t), ("vertex_count", c_uint64), ("triangle_count", c_uint64),
                ("active_cell_count", c_uint64), ("positions", c_void_p), ("normals", c_void_p),
                ("triangles", c_void_p), ("slab_count", c_uint32), ("reserved", c_uint32), ("timings", tc_timings),
                ("origin", c_double * 3), ("boundary_labels", c_void_p)]


class tc_planes(_Sized):
    _fields_ = [("struct_size", c_size_t), ("first", c_int64), ("count", c_int64), ("samples", c_void_p),
                ("blanked_samples", c_void_p), ("blanked_cells", c_void_p)]


class tc_mesh_piece(_Sized):
    _fields_ = [("struct_size", c_size_t), ("surface", c_size_t), ("first_vertex", c_uint64),
                ("first_triangle", c_uint64), ("mesh", POINTER(tc_mesh_data)), ("grid", c_void_p),
                ("first_plane", c_int64), ("plane_count", c_int64)]


tc_read_planes = CFUNCTYPE(c_int, c_void_p, POINTER(tc_planes))
tc_take_counts = CFUNCTYPE(c_int, c_void_p, c_size_t, POINTER(tc_counts))
tc_take_piece = CFUNCTYPE(c_int, c_void_p, POINTER(tc_mesh_piece))


class tc_stream_options(_Sized):
    _fields_ = [("struct_size", c_size_t), ("grid", POINTER(tc_grid_options)),
                ("surfaces", POINTER(tc_extract_options)), ("surface_count", c_size_t),
                ("max_memory_bytes", c_uint64), ("read", tc_read_planes), ("counted", tc_take_counts),
                ("take", tc_take_piece), ("user", c_void_p), ("owned", c_int64 * 2)]


class tc_field(_Sized):
    _fields_ = [("struct_size", c_size_t), ("type", c_int), ("components", c_int), ("values", c_void_p)]


class tc_interval_volume_options(_Sized):
    _fields_ = [("struct_size", c_size_t), ("low", c_double), ("high", c_double)]


class tc_interval_volume_counts(_Sized):
    _fields_ = [("struct_size", c_size_t), ("sample_count", c_uint64), ("low_count", c_uint64),
                ("high_count", c_uint64), ("tetrahedron_count", c_uint64), ("interval_bytes", c_uint64),
                ("classify_ms", c_double)]


class tc_interval_volume_data(_Sized):
    _fields_ = [("struct_size", c_size_t), ("vertex_count", c_uint64), ("sample_count", c_uint64),
                ("low_count", c_uint64), ("high_count", c_uint64), ("tetrahedron_count", c_uint64),
                ("positions", c_void_p), ("tetrahedra", c_void_p), ("slab_count", c_uint32), ("reserved", c_uint32),
                ("timings", tc_timings), ("origin", c_double * 3)]


class tc_cells(_Sized):
    _fields_ = [("struct_size", c_size_t), ("point_count", c_uint64), ("points", c_void_p), ("cell_count", c_uint64),
                ("types", c_void_p), ("offsets", c_void_p), ("connectivity", c_void_p), ("blanked_points", c_void_p),
                ("blanked_cells", c_void_p), ("points_f64", c_void_p), ("cell_faces", c_void_p),
                ("face_offsets", c_void_p), ("face_connectivity", c_void_p), ("skip_unsupported", c_int)]


class tc_tetrahedra(_Sized):
    _fields_ = [("struct_size", c_size_t), ("tetrahedron_count", c_uint64), ("tetrahedra", c_void_p),
                ("cells", c_void_p), ("flat_cell_count", c_uint64), ("curved_cell_count", c_uint64),
                ("blanked_cell_count", c_uint64), ("inverted_cell_count", c_uint64), ("folded_cell_count", c_uint64),
                ("unsupported_cell_count", c_uint64), ("surplus_cell_count", c_uint64)]


class tc_tetrahedra_grid_options(_Sized):
    _fields_ = [("struct_size", c_size_t), ("point_count", c_uint64), ("points", c_void_p), ("type", c_int),
                ("samples", c_void_p), ("tetrahedron_count", c_uint64), ("tetrahedra", c_void_p),
                ("points_f64", c_void_p), ("has_origin", c_int), ("origin", c_double * 3), ("source", c_void_p),
                ("cells", c_void_p)]


class tc_device_mesh(_Sized):
    _fields_ = [("struct_size", c_size_t), ("positions", c_void_p), ("normals", c_void_p), ("triangles", c_void_p)]


class tc_tuning(_Sized):
    _fields_ = [("struct_size", c_size_t), ("work_items", c_uint32), ("work_groups", c_uint32),
                ("tile_bricks", c_uint32)]


# --------------------------------------------------------------------------------------------------------- functions

_STATUS = c_int
_OUT = POINTER(c_void_p)  # where a handle is put

# Name: what it returns, then its arguments. Handles are addresses.
FUNCTIONS = {
    "tc_version": (c_char_p,),
    "tc_message": (c_char_p,),
    "tc_device_count": (_STATUS, POINTER(c_int)),
    "tc_device_get": (_STATUS, c_int, POINTER(tc_device_info)),
    "tc_context_options_init": (None, POINTER(tc_context_options)),
    "tc_context_create": (_STATUS, POINTER(tc_context_options), _OUT),
    "tc_context_destroy": (None, c_void_p),
    "tc_context_device": (_STATUS, c_void_p, POINTER(tc_device_info)),
    "tc_context_cl_context": (c_void_p, c_void_p),
    "tc_context_cl_queue": (c_void_p, c_void_p),
    "tc_context_build_ms": (c_double, c_void_p),
    "tc_context_device_bytes": (c_uint64, c_void_p, POINTER(c_uint64)),
    "tc_type_bytes": (c_size_t, c_int),
    "tc_type_name": (c_char_p, c_int),
    "tc_grid_options_init": (None, POINTER(tc_grid_options)),
    "tc_grid_create": (_STATUS, c_void_p, POINTER(tc_grid_options), _OUT),
    "tc_grid_destroy": (None, c_void_p),
    "tc_grid_origin": (_STATUS, c_void_p, POINTER(c_double * 3)),
    "tc_method_name": (c_char_p, c_int),
    "tc_extract_options_init": (None, POINTER(tc_extract_options)),
    "tc_count": (_STATUS, c_void_p, POINTER(tc_extract_options), POINTER(tc_counts)),
    "tc_extract": (_STATUS, c_void_p, POINTER(tc_extract_options), _OUT),
    "tc_labels_options_init": (None, POINTER(tc_labels_options)),
    "tc_extract_labels": (_STATUS, c_void_p, POINTER(tc_labels_options), _OUT),
    "tc_seam_size": (c_uint64, c_void_p),
    "tc_count_piece": (_STATUS, c_void_p, POINTER(tc_extract_options), POINTER(tc_counts), c_void_p, c_uint64),
    "tc_extract_piece": (_STATUS, c_void_p, POINTER(tc_extract_options), c_void_p, c_uint64, _OUT),
    "tc_stream_options_init": (None, POINTER(tc_stream_options)),
    "tc_stream": (_STATUS, c_void_p, POINTER(tc_stream_options)),
    "tc_mesh_get": (_STATUS, c_void_p, POINTER(tc_mesh_data)),
    "tc_mesh_destroy": (None, c_void_p),
    "tc_interpolate_field": (_STATUS, c_void_p, POINTER(tc_extract_options), POINTER(tc_field), c_void_p, c_uint64),
    "tc_interval_volume_options_init": (None, POINTER(tc_interval_volume_options)),
    "tc_count_interval_volume": (_STATUS, c_void_p, POINTER(tc_interval_volume_options), POINTER(tc_interval_volume_counts)),
    "tc_extract_interval_volume": (_STATUS, c_void_p, POINTER(tc_interval_volume_options), _OUT),
    "tc_interval_volume_get": (_STATUS, c_void_p, POINTER(tc_interval_volume_data)),
    "tc_interval_volume_destroy": (None, c_void_p),
    "tc_interpolate_interval_volume": (_STATUS, c_void_p, POINTER(tc_interval_volume_options), POINTER(tc_field), c_void_p,
                                c_uint64),
    "tc_tetrahedralize": (_STATUS, POINTER(tc_cells), POINTER(tc_tetrahedra)),
    "tc_tetrahedralize_grid": (_STATUS, POINTER(tc_grid_options), POINTER(tc_tetrahedra)),
    "tc_tetrahedra_release": (None, POINTER(tc_tetrahedra)),
    "tc_tetrahedra_grid_options_init": (None, POINTER(tc_tetrahedra_grid_options)),
    "tc_tetrahedra_grid_create": (_STATUS, c_void_p, POINTER(tc_tetrahedra_grid_options), _OUT),
    "tc_emit": (_STATUS, c_void_p, POINTER(tc_extract_options), POINTER(tc_device_mesh), _OUT),
    "tc_expert_options_init": (None, POINTER(tc_expert_options)),
    "tc_trial_run": (_STATUS, c_char_p, tc_progress, c_void_p),
    "tc_context_tuning": (_STATUS, c_void_p, POINTER(tc_tuning)),
    "tc_context_tuning_save": (_STATUS, c_void_p),
}

class view_angles(Structure):
    """Where a picture is looked at from, in degrees (view.h)."""

    _fields_ = [("azimuth", c_double), ("elevation", c_double)]


class complex_file(Structure):
    """Tetrahedra as they are written (mesh_write.h)."""

    _fields_ = [("point_count", c_uint64), ("points", c_void_p), ("points_f64", c_void_p),
                ("tetrahedron_count", c_uint64), ("tetrahedra", c_void_p), ("fields", c_void_p), ("field_count", c_int),
                ("world", c_char_p), ("units", c_char_p)]


# The tool's writers, its hash and its pictures: mesh_files.c beside this package.
FILE_FUNCTIONS = {
    "mesh_files_hash": (c_uint64, POINTER(tc_mesh_data)),
    "mesh_files_save": (_STATUS, c_char_p, c_char_p, POINTER(tc_mesh_data), c_int, POINTER(c_char_p), POINTER(c_int),
                        POINTER(c_void_p), POINTER(c_double), POINTER(c_int)),
    "mesh_files_save_complex": (_STATUS, c_char_p, c_char_p, POINTER(complex_file), c_int, POINTER(c_char_p),
                                POINTER(c_int), POINTER(c_void_p)),
    "mesh_files_view": (c_char_p, c_int, POINTER(view_angles)),
    "mesh_files_draw": (_STATUS, POINTER(tc_mesh_data), view_angles, c_int, c_int, c_void_p),
    "mesh_files_save_picture": (_STATUS, c_char_p, c_int, c_int, c_void_p),
    "mesh_files_message": (c_char_p,),
}


def _load(name, functions):
    """Opens the library of that name beside this file, its functions declared."""
    library = ctypes.CDLL(str(FOLDER / name))
    for function, (result, *arguments) in functions.items():
        getattr(library, function).restype = result
        getattr(library, function).argtypes = arguments
    return library


tc = _load("libtetracubes.so", FUNCTIONS)
files = _load("libtetracubes_files.so", FILE_FUNCTIONS)

# ------------------------------------------------------------------------------------------------------------ errors


class DeviceError(RuntimeError):
    """No OpenCL, no such device, or the device failed or computes wrongly: the text says what to do."""


_EXCEPTIONS = {
    tc_status.TC_ERROR_ARGUMENT: ValueError,
    tc_status.TC_ERROR_DATA: ValueError,
    tc_status.TC_ERROR_LIMIT: ValueError,
    tc_status.TC_ERROR_DEVICE: DeviceError,
    tc_status.TC_ERROR_WRONG_RESULT: DeviceError,
    tc_status.TC_ERROR_MEMORY: MemoryError,
    tc_status.TC_ERROR_CANCELLED: KeyboardInterrupt,
    tc_status.TC_ERROR_FILE: OSError,
}


def message():
    """What the last failed call of this thread found wrong."""
    return tc.tc_message().decode(errors="replace")


def check(status):
    """Raises what a status of the library means, with the library's sentence."""
    if status:
        raise _EXCEPTIONS.get(status, RuntimeError)(message())


def options(kind):
    """A struct of options with the library's defaults."""
    made = kind()
    getattr(tc, f"{kind.__name__}_init")(ctypes.byref(made))
    return made
