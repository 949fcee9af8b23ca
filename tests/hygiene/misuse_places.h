/*
 * misuse_places.h - the table of test_misuse.c: calls, places in what they take, and values that are not allowed there
 */
#ifndef MISUSE_PLACES_H
#define MISUSE_PLACES_H

#include "misuse_calls.h"

/* The bits of a value, and the statuses that a call with it may end in. */
typedef struct bad {
    uint64_t bits;
    unsigned may;
} bad;

enum {
    OK = 1 << TC_OK,
    ARGUMENT = 1 << TC_ERROR_ARGUMENT,
    DATA = 1 << TC_ERROR_DATA,
    DEVICE = 1 << TC_ERROR_DEVICE,
    MEMORY = 1 << TC_ERROR_MEMORY,
    LIMIT = 1 << TC_ERROR_LIMIT,
    NO_FILE = 1 << TC_ERROR_FILE,
    REFERENCE_HAS_NONE = ARGUMENT, /* the reference engine has no device to ask or to emit on */
    ENDS = 0                       /* of a list */
};

#define F64_NAN   UINT64_C(0x7ff8000000000000)
#define F64_INF   UINT64_C(0x7ff0000000000000)
#define F64_MOST  UINT64_C(0x7fefffffffffffff)
#define F64_LEAST UINT64_C(1)
#define F64_SIGN  (UINT64_C(1) << 63)
#define LISTED(...)                                                                                                    \
    (const bad[]) {                                                                                                    \
        __VA_ARGS__, { 0, ENDS }                                                                                       \
    }
#define I64(n) ((uint64_t)(int64_t)(n))

static const bad null[] = {{0, ARGUMENT}, {0, ENDS}};
static const bad absent[] = {{0, OK}, {0, ENDS}};
static const bad dims[] = {{0, ARGUMENT},
                           {I64(-1), ARGUMENT},
                           {I64(INT64_MIN), ARGUMENT},
                           {1, DATA},
                           {(1 << 24) + 1, DATA},
                           {UINT64_C(1) << 31, DATA},
                           {UINT64_C(1) << 32, DATA},
                           {INT64_MAX, DATA},
                           {0, ENDS}};
static const bad first[] = {{I64(INT32_MAX) - SIZE + 1, OK},
                            {I64(INT32_MAX) - SIZE + 2, DATA},
                            {I64(INT32_MIN), OK},
                            {I64(INT32_MIN) - 1, DATA},
                            {INT64_MAX, DATA},
                            {I64(INT64_MIN), DATA},
                            {0, ENDS}};
static const bad matrix[] = {{F64_NAN, ARGUMENT},
                             {F64_INF, ARGUMENT},
                             {F64_INF | F64_SIGN, ARGUMENT},
                             {F64_MOST, ARGUMENT},
                             {F64_LEAST, OK | ARGUMENT},
                             {0, OK | ARGUMENT},
                             {0, ENDS}};
static const bad any_f64[] = {{F64_NAN, OK}, {F64_INF, OK}, {F64_MOST, OK}, {F64_LEAST | F64_SIGN, OK}, {0, ENDS}};
static const bad isovalues[] = {{F64_NAN, ARGUMENT},
                                {F64_INF, ARGUMENT},
                                {F64_INF | F64_SIGN, ARGUMENT},
                                {F64_MOST, OK | ARGUMENT},
                                {F64_LEAST, OK | ARGUMENT},
                                {F64_SIGN, OK | ARGUMENT},
                                {0, ENDS}};
static const bad bounds[] = {{F64_NAN, ARGUMENT},       {F64_INF, OK | ARGUMENT},   {F64_INF | F64_SIGN, OK | ARGUMENT},
                             {F64_MOST, OK | ARGUMENT}, {F64_LEAST, OK | ARGUMENT}, {0, ENDS}};
static const bad any_i32[] = {{1, OK}, {I64(-1), OK}, {0x80000000, OK}, {0x7fffffff, OK}, {0, ENDS}};
static const bad any_u32[] = {{1, OK}, {1u << 31, OK}, {UINT32_MAX, OK}, {0, ENDS}};
static const bad no_enumerator[] = {
    {8, ARGUMENT}, {I64(-1), ARGUMENT}, {0x7fffffff, ARGUMENT}, {0x80000000, ARGUMENT}, {0, ENDS}};
static const bad too_many[] = {{UINT64_C(1) << 32, LIMIT}, {UINT64_C(1) << 63, LIMIT}, {UINT64_MAX, LIMIT}, {0, ENDS}};

typedef struct place {
    const char *call;
    call_function *run;
    const char *name;
    size_t at, bytes;
    const bad *values;
} place;

#define AT(call, where, ...)                                                                                           \
    { #call, call_##call, #where, offsetof(arguments, where), sizeof(((arguments *)0)->where), __VA_ARGS__ }

#define OPTIONS_OF_GRIDS(call)                                                                                         \
    AT(call, grid_options_at, null), AT(call, grid_options.dims[0], dims), AT(call, grid_options.dims[1], dims),       \
        AT(call, grid_options.dims[2], dims), AT(call, grid_options.first_index[0], first),                            \
        AT(call, grid_options.first_index[1], first), AT(call, grid_options.first_index[2], first),                    \
        AT(call, grid_options.type, no_enumerator), AT(call, grid_options.samples, null),                              \
        AT(call, grid_options.matrix[0][0], matrix), AT(call, grid_options.matrix[1][2], matrix),                      \
        AT(call, grid_options.matrix[2][3], matrix), AT(call, grid_options.has_nodata, any_i32),                       \
        AT(call, grid_options.nodata, any_f64), AT(call, grid_options.cl_samples, LISTED({8, ARGUMENT})),              \
        AT(call, grid_options.cl_samples_offset, LISTED({UINT64_MAX, OK})), AT(call, grid_options.axes[0], absent),    \
        AT(call, grid_options.points, absent), AT(call, grid_options.blanked_samples, absent),                         \
        AT(call, grid_options.blanked_cells, absent), AT(call, grid_options.axes_f64[1], LISTED({8, ARGUMENT})),       \
        AT(call, grid_options.points_f64, absent), AT(call, grid_options.has_origin, LISTED({1, OK | ARGUMENT})),      \
        AT(call, grid_options.origin[0], any_f64), AT(call, grid_options.whole, absent),                               \
        AT(call, grid_options.owned[1], LISTED({4, ARGUMENT}, {I64(-1), ARGUMENT}))

#define OPTIONS_OF_EXTRACTION(call)                                                                                    \
    AT(call, grid, null), AT(call, extract_options_at, null), AT(call, extract_options.isovalue, isovalues),           \
        AT(call, extract_options.method, no_enumerator), AT(call, extract_options.snap, any_f64),                      \
        AT(call, extract_options.closed, LISTED({1, OK | ARGUMENT | DEVICE})),                                         \
        AT(call, extract_options.reserved, LISTED({1, ARGUMENT}, {I64(-1), ARGUMENT}))

#define OPTIONS_OF_INTERVALS(call)                                                                                     \
    AT(call, grid, null), AT(call, interval_volume_options_at, null), AT(call, interval_volume_options.low, bounds),   \
        AT(call, interval_volume_options.high, bounds)

static const place places[] = {
    AT(tc_device_count, count_at, null),
    AT(tc_device_get, index, LISTED({I64(-1), ARGUMENT}, {0x7fffffff, ARGUMENT}, {0x80000000, ARGUMENT})),
    AT(tc_device_get, info_at, null),
    AT(tc_context_create, context_place, null),
    AT(tc_context_create, context_options_at, null),
    AT(tc_context_create, context_options.engine, no_enumerator),
    AT(tc_context_create, context_options.device, absent),
    AT(tc_context_create, context_options.cl_context, absent),
    AT(tc_context_create, context_options.cl_queue, LISTED({8, OK})), /* not looked at without a cl_context */
    AT(tc_context_create, context_options.max_memory_bytes, LISTED({1, OK}, {UINT64_MAX, OK})),
    AT(tc_context_create, expert_options_at, absent), /* context_options.expert */
    AT(tc_context_create, expert_options.work_items, LISTED({2, OK | ARGUMENT}, {1u << 31, OK | ARGUMENT})),
    AT(tc_context_create, expert_options.work_groups, any_u32),
    AT(tc_context_create, expert_options.tile_bricks, any_u32),
    AT(tc_context_create, expert_options.spin_limit, any_u32),
    AT(tc_context_create, expert_options.division, LISTED({I64(-1), OK | ARGUMENT}, {4, OK | ARGUMENT})),
    AT(tc_context_create, context_options.progress, absent),
    AT(tc_context_create, context_options.progress_user, LISTED({8, OK})),
    AT(tc_context_create, expert_options.always_copy, any_i32),
    AT(tc_context_create, context_options.check_device, any_i32),
    AT(tc_context_create, expert_options.child_trial, absent),
    AT(tc_context_create, expert_options.child_trial_user, LISTED({8, OK})),
    AT(tc_trial_run, job, null),
    AT(tc_context_device, context, null),
    AT(tc_context_device, info_at, null),
    AT(tc_context_tuning, context, null),
    AT(tc_context_tuning, tuning_at, null),
    AT(tc_context_tuning_save, context, null),
    AT(tc_grid_create, context, null),
    AT(tc_grid_create, grid_place, null),
    OPTIONS_OF_GRIDS(tc_grid_create),
    AT(tc_tetrahedra_grid_create, context, null),
    AT(tc_tetrahedra_grid_create, grid_place, null),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options_at, null),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options.point_count, LISTED({0, DATA})),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options.point_count, too_many),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options.points, null),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options.points, NULL),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options.type, no_enumerator),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options.samples, null),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options.samples, NULL),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options.tetrahedron_count, LISTED({0, OK})),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options.tetrahedron_count, too_many),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options.tetrahedra, null),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options.tetrahedra, NULL),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options.points_f64, LISTED({8, ARGUMENT})),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options.source, LISTED({8, ARGUMENT})),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options.cells, LISTED({8, ARGUMENT})),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options.has_origin, LISTED({1, OK | ARGUMENT})),
    AT(tc_tetrahedra_grid_create, tetrahedra_grid_options.origin[2], any_f64),
    AT(tc_grid_origin, grid, null),
    AT(tc_grid_origin, origin_at, null),
    OPTIONS_OF_EXTRACTION(tc_count),
    AT(tc_count, extract_options.normals, any_i32),
    AT(tc_count, counts_at, null),
    OPTIONS_OF_EXTRACTION(tc_extract),
    AT(tc_extract, mesh_place, null),
    AT(tc_extract_labels, grid, null),
    AT(tc_extract_labels, mesh_place, null),
    AT(tc_extract_labels, labels_options_at, null),
    AT(tc_extract_labels, labels_options.labels, null),
    AT(tc_extract_labels, labels_options.labels, NULL),
    AT(tc_extract_labels, labels_options.label_count, LISTED({0, ARGUMENT})),
    AT(tc_extract_labels, labels_options.smoothing, LISTED({1001, ARGUMENT}, {UINT32_MAX, ARGUMENT}, {0, OK})),
    AT(tc_extract_labels, labels_options.closed, any_i32),
    OPTIONS_OF_EXTRACTION(tc_count_piece),
    AT(tc_count_piece, counts_at, null),
    AT(tc_count_piece, seam, null),
    AT(tc_count_piece, seam, NULL),
    AT(tc_count_piece, seam_size, LISTED({0, ARGUMENT}, {UINT64_MAX, ARGUMENT})),
    OPTIONS_OF_EXTRACTION(tc_extract_piece),
    AT(tc_extract_piece, mesh_place, null),
    AT(tc_extract_piece, next_seam, LISTED({8, ARGUMENT})),
    AT(tc_extract_piece, next_seam_size, LISTED({1, ARGUMENT}, {UINT64_MAX, ARGUMENT})),
    OPTIONS_OF_EXTRACTION(tc_emit),
    AT(tc_emit, device_mesh_at, null),
    AT(tc_emit, device_mesh.positions, null),
    AT(tc_emit, device_mesh.normals, null),
    AT(tc_emit, device_mesh.triangles, null),
    AT(tc_stream, context, null),
    AT(tc_stream, stream_options_at, null),
    AT(tc_stream, stream_options.grid, null),
    AT(tc_stream, stream_options.surfaces, null),
    AT(tc_stream, stream_options.surface_count, LISTED({0, ARGUMENT})),
    AT(tc_stream, stream_options.max_memory_bytes, LISTED({1, OK}, {UINT64_MAX, OK})),
    AT(tc_stream, stream_options.read, null),
    AT(tc_stream, stream_options.counted, absent),
    AT(tc_stream, stream_options.take, absent),
    AT(tc_stream, stream_options.user, LISTED({8, OK})),
    AT(tc_stream, stream_options.owned[0], LISTED({1, ARGUMENT}, {I64(-4), ARGUMENT}, {INT64_MAX, ARGUMENT})),
    AT(tc_stream, stream_options.owned[1], LISTED({1, ARGUMENT}, {I64(-4), ARGUMENT}, {INT64_MAX, ARGUMENT})),
    AT(tc_mesh_get, mesh, null),
    AT(tc_mesh_get, mesh_data_at, null),
    OPTIONS_OF_EXTRACTION(tc_interpolate_field),
    AT(tc_interpolate_field, field_at, null),
    AT(tc_interpolate_field, field.type, no_enumerator),
    AT(tc_interpolate_field, field.components, LISTED({0, ARGUMENT}, {I64(-1), ARGUMENT}, {0x80000000, ARGUMENT})),
    AT(tc_interpolate_field, field.components, LISTED({0x7fffffff, ARGUMENT})),
    AT(tc_interpolate_field, field.values, null),
    AT(tc_interpolate_field, field.values, NULL),
    AT(tc_interpolate_field, values, null),
    AT(tc_interpolate_field, values, NULL),
    AT(tc_interpolate_field, value_count, LISTED({0, ARGUMENT}, {1, ARGUMENT}, {UINT64_MAX, ARGUMENT})),
    OPTIONS_OF_INTERVALS(tc_count_interval_volume),
    AT(tc_count_interval_volume, interval_volume_counts_at, null),
    OPTIONS_OF_INTERVALS(tc_extract_interval_volume),
    AT(tc_extract_interval_volume, interval_place, null),
    AT(tc_interval_volume_get, interval, null),
    AT(tc_interval_volume_get, interval_volume_data_at, null),
    OPTIONS_OF_INTERVALS(tc_interpolate_interval_volume),
    AT(tc_interpolate_interval_volume, field_at, null),
    AT(tc_interpolate_interval_volume, field.type, no_enumerator),
    AT(tc_interpolate_interval_volume, field.components,
       LISTED({0, ARGUMENT}, {I64(-1), ARGUMENT}, {0x7fffffff, ARGUMENT})),
    AT(tc_interpolate_interval_volume, field.values, null),
    AT(tc_interpolate_interval_volume, values, null),
    AT(tc_interpolate_interval_volume, interval_value_count,
       LISTED({0, ARGUMENT}, {1, ARGUMENT}, {UINT64_MAX, ARGUMENT})),
    AT(tc_tetrahedralize, tetrahedra_at, null),
    AT(tc_tetrahedralize, cells_at, null),
    AT(tc_tetrahedralize, cells.point_count, LISTED({0, DATA}, {POINTS - 1, DATA})),
    AT(tc_tetrahedralize, cells.point_count, too_many),
    AT(tc_tetrahedralize, cells.points, null),
    AT(tc_tetrahedralize, cells.points, NULL),
    AT(tc_tetrahedralize, cells.cell_count, LISTED({0, OK})),
    AT(tc_tetrahedralize, cells.cell_count, too_many),
    AT(tc_tetrahedralize, cells.types, null),
    AT(tc_tetrahedralize, cells.offsets, null),
    AT(tc_tetrahedralize, cells.offsets, NULL),
    AT(tc_tetrahedralize, cells.connectivity, null),
    AT(tc_tetrahedralize, cells.connectivity, NULL),
    AT(tc_tetrahedralize, cells.blanked_points, absent),
    AT(tc_tetrahedralize, cells.blanked_cells, absent),
    AT(tc_tetrahedralize, cells.points_f64, LISTED({8, ARGUMENT})),
    AT(tc_tetrahedralize, cells.cell_faces, LISTED({0, DATA})),
    AT(tc_tetrahedralize, cells.face_offsets, null),
    AT(tc_tetrahedralize, cells.face_connectivity, null),
    AT(tc_tetrahedralize, cells.skip_unsupported, any_i32),
    AT(tc_tetrahedralize_grid, tetrahedra_at, null),
    OPTIONS_OF_GRIDS(tc_tetrahedralize_grid),
};

#endif
