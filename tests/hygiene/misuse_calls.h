/*
 * misuse_calls.h - a good call of every public function that can fail, with all that it takes in one struct
 *
 * arguments_fill() sets good arguments; a test spoils one of them, and the call says how it ended and whether its
 * outputs are zero. What a call has made is released again.
 */
#ifndef MISUSE_CALLS_H
#define MISUSE_CALLS_H

#include "api.h"

#include <stddef.h>

enum { CELLS = 3, CORNERS = 12, FACES = 4, FACE_CORNERS = 12, POINTS = 12, TETRAHEDRA = 2, CARRIED_MOST = 1 << 14 };

typedef struct arguments {
    tc_context *context;
    tc_grid *grid;
    tc_mesh *mesh;
    tc_interval_volume *interval;
    tc_context_options context_options, *context_options_at;
    tc_expert_options expert_options, *expert_options_at;       /* which context_options point to */
    bool context_place, grid_place, mesh_place, interval_place; /* false: no place for what is made */
    tc_grid_options grid_options, *grid_options_at;
    tc_extract_options extract_options, *extract_options_at;
    tc_labels_options labels_options, *labels_options_at;
    tc_tetrahedra_grid_options tetrahedra_grid_options, *tetrahedra_grid_options_at;
    tc_cells cells, *cells_at;
    tc_field field, *field_at;
    tc_interval_volume_options interval_volume_options, *interval_volume_options_at;
    tc_interval_volume_counts interval_volume_counts, *interval_volume_counts_at;
    tc_interval_volume_data interval_volume_data, *interval_volume_data_at;
    tc_device_mesh device_mesh, *device_mesh_at;
    tc_counts counts, *counts_at;
    tc_mesh_data mesh_data, *mesh_data_at;
    tc_device_info info, *info_at;
    tc_tuning tuning, *tuning_at;
    tc_tetrahedra tetrahedra, *tetrahedra_at;
    float *values;
    uint64_t value_count, interval_value_count;
    int *count_at, index, count;
    double *origin_at, origin[3];
    uint32_t *seam, *next_seam; /* a grid that is no piece has none behind it */
    uint64_t seam_size, next_seam_size;
    tc_stream_options stream_options, *stream_options_at;
    const char *job;
} arguments;

typedef struct world {
    tc_engine engine;
    tc_context *context;
    tc_grid *grid, *complex_grid;
    tc_mesh *mesh, *kept;
    tc_mesh_data expected;
    tc_interval_volume *interval;
    uint64_t interval_vertices;
} world;

static float points[3 * POINTS], field_values[SAMPLES], values[CARRIED_MOST], axis[SIZE], lattice[3 * SAMPLES];
static uint32_t seam[SIZE];
static const double complex_samples[POINTS] = {0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1};
static const uint8_t types[CELLS] = {12, 10, 42}; /* a hexahedron, a tetrahedron, the same as a polyhedron */
static const int64_t offsets[CELLS + 1] = {0, 8, CORNERS, CORNERS};
static const int64_t cell_faces[CELLS + 1] = {0, 0, 0, FACES}, face_offsets[FACES + 1] = {0, 3, 6, 9, FACE_CORNERS};
static const int64_t face_connectivity[FACE_CORNERS] = {8, 9, 10, 8, 9, 11, 9, 10, 11, 8, 10, 11};
static const int64_t connectivity[CORNERS] = {0, 1, 3, 2, 4, 5, 7, 6, 8, 9, 10, 11};
enum { WANTED = 2 };
static const uint32_t wanted_labels[WANTED] = {100, 200};
static const uint32_t tetrahedra[4 * TETRAHEDRA] = {0, 1, 2, 4, 8, 9, 10, 11};

static void arrays_fill(void) {
    samples_fill();
    for (int n = 0; n < POINTS; n++) {
        points[3 * n] = (float)(n & 1) + (float)(n / 8 * 3);
        points[3 * n + 1] = (float)(n >> 1 & 1);
        points[3 * n + 2] = (float)(n >> 2 & 1) + (float)(n == 11);
    }
    for (int n = 0; n < SAMPLES; n++) {
        field_values[n] = (float)n;
        lattice[3 * n] = (float)(n % SIZE);
        lattice[3 * n + 1] = (float)(n / SIZE % SIZE);
        lattice[3 * n + 2] = (float)(n / SIZE / SIZE);
    }
    for (int n = 0; n < SIZE; n++) axis[n] = (float)n;
}

static int planes_give(void *user, tc_planes *planes) {
    (void)user;
    planes->samples = samples + planes->first * SIZE * SIZE;
    return 0;
}

static void arguments_fill(const world *w, arguments *a) {
    memset(a, 0xee, sizeof *a);
    a->context = w->context, a->grid = w->grid, a->mesh = w->mesh, a->interval = w->interval;
    a->context_place = a->grid_place = a->mesh_place = a->interval_place = true;
    a->index = 0;
    a->job = "tetracubes-trial-1 0:0 1";
    tc_context_options_init(a->context_options_at = &a->context_options);
    a->context_options.engine = w->engine;
    tc_expert_options_init(a->expert_options_at = &a->expert_options);
    grid_describe(a->grid_options_at = &a->grid_options);
    tc_extract_options_init(a->extract_options_at = &a->extract_options);
    a->extract_options.isovalue = 127.5;
    tc_labels_options_init(a->labels_options_at = &a->labels_options);
    a->labels_options.labels = wanted_labels;
    a->labels_options.label_count = WANTED;
    tc_tetrahedra_grid_options_init(a->tetrahedra_grid_options_at = &a->tetrahedra_grid_options);
    a->tetrahedra_grid_options.point_count = POINTS;
    a->tetrahedra_grid_options.points = points;
    a->tetrahedra_grid_options.type = TC_F64;
    a->tetrahedra_grid_options.samples = complex_samples;
    a->tetrahedra_grid_options.tetrahedron_count = TETRAHEDRA;
    a->tetrahedra_grid_options.tetrahedra = tetrahedra;
    a->cells = (tc_cells){.struct_size = sizeof a->cells,
                          .point_count = POINTS,
                          .points = points,
                          .cell_count = CELLS,
                          .types = types,
                          .offsets = offsets,
                          .connectivity = connectivity,
                          .cell_faces = cell_faces,
                          .face_offsets = face_offsets,
                          .face_connectivity = face_connectivity};
    a->field = (tc_field){sizeof a->field, TC_F32, 1, field_values};
    tc_interval_volume_options_init(a->interval_volume_options_at = &a->interval_volume_options);
    a->interval_volume_options.low = 100, a->interval_volume_options.high = 127.5;
    a->interval_volume_counts.struct_size = sizeof a->interval_volume_counts,
    a->interval_volume_counts_at = &a->interval_volume_counts;
    a->interval_volume_data.struct_size = sizeof a->interval_volume_data,
    a->interval_volume_data_at = &a->interval_volume_data;
    a->device_mesh = (tc_device_mesh){.struct_size = sizeof a->device_mesh};
    a->counts.struct_size = sizeof a->counts;
    a->mesh_data.struct_size = sizeof a->mesh_data;
    a->info.struct_size = sizeof a->info;
    a->tuning.struct_size = sizeof a->tuning;
    a->tetrahedra.struct_size = sizeof a->tetrahedra;
    a->cells_at = &a->cells, a->field_at = &a->field, a->device_mesh_at = &a->device_mesh;
    a->counts_at = &a->counts, a->mesh_data_at = &a->mesh_data, a->info_at = &a->info;
    a->tuning_at = &a->tuning, a->tetrahedra_at = &a->tetrahedra, a->count_at = &a->count;
    a->origin_at = a->origin;
    a->seam = seam, a->seam_size = tc_seam_size(w->grid);
    a->next_seam = NULL, a->next_seam_size = 0;
    tc_stream_options_init(a->stream_options_at = &a->stream_options);
    a->stream_options.grid = &a->grid_options;
    a->stream_options.surfaces = &a->extract_options;
    a->stream_options.surface_count = 1;
    a->stream_options.read = planes_give;
    a->values = values;
    a->value_count = w->expected.vertex_count;
    a->interval_value_count = w->interval_vertices;
}

/* The structs that callers fill as their init functions leave them; those without one are zero. */
static void defaults_fill(arguments *a) {
    tc_context_options_init(&a->context_options);
    tc_expert_options_init(&a->expert_options);
    tc_grid_options_init(&a->grid_options);
    tc_extract_options_init(&a->extract_options);
    tc_labels_options_init(&a->labels_options);
    tc_tetrahedra_grid_options_init(&a->tetrahedra_grid_options);
    tc_stream_options_init(&a->stream_options);
    tc_interval_volume_options_init(&a->interval_volume_options);
    a->cells = (tc_cells){0};
    a->field = (tc_field){0};
    a->device_mesh = (tc_device_mesh){0};
}

/* ----------------------------------------------------------------------------------------------------------- calls */

/* A call with the arguments as they are; what it made is released again. */
typedef tc_status call_function(arguments *a, bool *zero);

static bool all_zero(const void *from, size_t bytes) {
    const unsigned char *at = from;
    for (size_t n = 0; n < bytes; n++)
        if (at[n]) return false;
    return true;
}

/* A result after a failure, where there was a place for one. */
#define RESULT_ZERO(result, at)                                                                                        \
    (!(at) || all_zero((const char *)&(result) + sizeof(size_t), sizeof(result) - sizeof(size_t)))

static void *const rubbish = (void *)(uintptr_t)8;

static tc_status call_tc_device_count(arguments *a, bool *zero) {
    tc_status status = tc_device_count(a->count_at);
    *zero = !a->count_at || a->count == 0;
    return status;
}

static tc_status call_tc_device_get(arguments *a, bool *zero) {
    tc_status status = tc_device_get(a->index, a->info_at);
    *zero = RESULT_ZERO(a->info, a->info_at);
    return status;
}

static tc_status call_tc_context_create(arguments *a, bool *zero) {
    tc_context *made = rubbish;
    tc_context **place = a->context_place ? &made : NULL;
    a->context_options.expert = a->expert_options_at;
    tc_status status = tc_context_create(a->context_options_at, place);
    *zero = !place || !made;
    if (place) tc_context_destroy(made);
    return status;
}

/* Not a job: one that a callback is given is done in test_trial.c. */
static tc_status call_tc_trial_run(arguments *a, bool *zero) {
    *zero = true;
    return tc_trial_run(a->job, NULL, NULL);
}

static tc_status call_tc_context_device(arguments *a, bool *zero) {
    tc_status status = tc_context_device(a->context, a->info_at);
    *zero = RESULT_ZERO(a->info, a->info_at);
    return status;
}

static tc_status call_tc_context_tuning(arguments *a, bool *zero) {
    tc_status status = tc_context_tuning(a->context, a->tuning_at);
    *zero = RESULT_ZERO(a->tuning, a->tuning_at);
    return status;
}

static tc_status call_tc_context_tuning_save(arguments *a, bool *zero) {
    *zero = true;
    return tc_context_tuning_save(a->context);
}

/* A grid that was made can be used: the reference engine extracts from it. */
static tc_status grid_end(const arguments *a, tc_status status, tc_grid *made, bool *zero) {
    tc_mesh *mesh = NULL;
    *zero = !made;
    if (made && a->context_options.engine == TC_ENGINE_REFERENCE) status = tc_extract(made, &a->extract_options, &mesh);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(made);
    return status;
}

static tc_status call_tc_grid_create(arguments *a, bool *zero) {
    tc_grid *made = rubbish;
    tc_grid **place = a->grid_place ? &made : NULL;
    tc_status status = tc_grid_create(a->context, a->grid_options_at, place);
    return grid_end(a, status, place ? made : NULL, zero);
}

static tc_status call_tc_grid_origin(arguments *a, bool *zero) {
    tc_status status = tc_grid_origin(a->grid, a->origin_at);
    *zero = !a->origin_at || all_zero(a->origin, sizeof a->origin);
    return status;
}

static tc_status call_tc_tetrahedra_grid_create(arguments *a, bool *zero) {
    tc_grid *made = rubbish;
    tc_grid **place = a->grid_place ? &made : NULL;
    tc_status status = tc_tetrahedra_grid_create(a->context, a->tetrahedra_grid_options_at, place);
    return grid_end(a, status, place ? made : NULL, zero);
}

static tc_status call_tc_count(arguments *a, bool *zero) {
    tc_status status = tc_count(a->grid, a->extract_options_at, a->counts_at);
    if (!status && a->counts.struct_size == sizeof a->counts) a->counts.classify_ms = 0; /* no two are the same */
    *zero = RESULT_ZERO(a->counts, a->counts_at);
    return status;
}

static tc_status call_tc_extract(arguments *a, bool *zero) {
    tc_mesh *mesh = NULL;
    tc_status status = tc_extract(a->grid, a->extract_options_at, a->mesh_place ? &mesh : NULL);
    *zero = !mesh;
    tc_mesh_destroy(mesh);
    return status;
}

static tc_status call_tc_extract_labels(arguments *a, bool *zero) {
    tc_mesh *mesh = NULL;
    tc_status status = tc_extract_labels(a->grid, a->labels_options_at, a->mesh_place ? &mesh : NULL);
    *zero = !mesh;
    tc_mesh_destroy(mesh);
    return status;
}

static tc_status call_tc_count_piece(arguments *a, bool *zero) {
    tc_status status = tc_count_piece(a->grid, a->extract_options_at, a->counts_at, a->seam, a->seam_size);
    *zero = RESULT_ZERO(a->counts, a->counts_at);
    return status;
}

static tc_status call_tc_extract_piece(arguments *a, bool *zero) {
    tc_mesh *mesh = NULL;
    tc_status status =
        tc_extract_piece(a->grid, a->extract_options_at, a->next_seam, a->next_seam_size, a->mesh_place ? &mesh : NULL);
    *zero = !mesh;
    tc_mesh_destroy(mesh);
    return status;
}

static tc_status call_tc_stream(arguments *a, bool *zero) {
    *zero = true;
    return tc_stream(a->context, a->stream_options_at);
}

static tc_status call_tc_mesh_get(arguments *a, bool *zero) {
    tc_status status = tc_mesh_get(a->mesh, a->mesh_data_at);
    *zero = RESULT_ZERO(a->mesh_data, a->mesh_data_at);
    return status;
}

static tc_status call_tc_interpolate_field(arguments *a, bool *zero) {
    *zero = true;
    return tc_interpolate_field(a->grid, a->extract_options_at, a->field_at, a->values, a->value_count);
}

static tc_status call_tc_count_interval_volume(arguments *a, bool *zero) {
    tc_status status = tc_count_interval_volume(a->grid, a->interval_volume_options_at, a->interval_volume_counts_at);
    if (!status && a->interval_volume_counts.struct_size == sizeof a->interval_volume_counts)
        a->interval_volume_counts.classify_ms = 0;
    *zero = RESULT_ZERO(a->interval_volume_counts, a->interval_volume_counts_at);
    return status;
}

static tc_status call_tc_extract_interval_volume(arguments *a, bool *zero) {
    tc_interval_volume *interval = NULL;
    tc_status status =
        tc_extract_interval_volume(a->grid, a->interval_volume_options_at, a->interval_place ? &interval : NULL);
    *zero = !interval;
    tc_interval_volume_destroy(interval);
    return status;
}

static tc_status call_tc_interval_volume_get(arguments *a, bool *zero) {
    tc_status status = tc_interval_volume_get(a->interval, a->interval_volume_data_at);
    *zero = RESULT_ZERO(a->interval_volume_data, a->interval_volume_data_at);
    return status;
}

static tc_status call_tc_interpolate_interval_volume(arguments *a, bool *zero) {
    *zero = true;
    return tc_interpolate_interval_volume(a->grid, a->interval_volume_options_at, a->field_at, a->values,
                                          a->interval_value_count);
}

static tc_status call_tc_tetrahedralize(arguments *a, bool *zero) {
    tc_status status = tc_tetrahedralize(a->cells_at, a->tetrahedra_at);
    *zero = RESULT_ZERO(a->tetrahedra, a->tetrahedra_at);
    tc_tetrahedra_release(a->tetrahedra_at);
    return status;
}

static tc_status call_tc_tetrahedralize_grid(arguments *a, bool *zero) {
    tc_status status = tc_tetrahedralize_grid(a->grid_options_at, a->tetrahedra_at);
    *zero = RESULT_ZERO(a->tetrahedra, a->tetrahedra_at);
    tc_tetrahedra_release(a->tetrahedra_at);
    return status;
}

static tc_status call_tc_emit(arguments *a, bool *zero) {
    struct _cl_event *done = rubbish;
    tc_status status = tc_emit(a->grid, a->extract_options_at, a->device_mesh_at, &done);
    *zero = !done;
    return status;
}

#endif
