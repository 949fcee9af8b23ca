#include "measure.h"

#include "complexes.h"
#include "exit_status.h"
#include "failure.h"
#include "library_status.h"
#include "mesh_check.h"
#include "mesh_compare.h"
#include "progress.h"

#include <CL/cl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define LEAST_REPEATS 3

/* ------------------------------------------------------------------------------------------------------ extraction */

void measure_begin(tc_context *context, const samples *s, tc_method method, double iso, double second_iso,
                   measurement *m, case_result *result) {
    const int64_t *dims = s->grid.dims;
    *m = (measurement){.context = context, .samples = s};
    tc_extract_options_init(&m->first);
    m->first.isovalue = iso;
    m->first.method = method;
    m->second = m->first;
    m->second.isovalue = second_iso;
    snprintf(m->label, sizeof m->label, "%.60s %" PRId64 "x%" PRId64 "x%" PRId64 " %s%s%s", s->name, dims[0], dims[1],
             dims[2], tc_type_name(s->grid.type), method == TC_METHOD_TETRA ? "" : " ",
             method == TC_METHOD_TETRA ? "" : tc_method_name(method));
    *result = (case_result){.field = s->name,
                            .type = s->grid.type,
                            .grid = bench_grid_names[s->placed],
                            .method = method,
                            .sample_bytes = s->bytes};
    memcpy(result->dims, dims, sizeof result->dims);
}

/* A grid that nothing was extracted from. Waits for the queue: an upload must not reach into the times that follow. */
static int grid_make(const measurement *m, tc_grid **grid) {
    int status = library_status(samples_open(m->samples, m->context, grid));
    if (!status && clFinish(tc_context_cl_queue(m->context))) status = fail(STATUS_FAILED, "the device's queue failed");
    return status;
}

/* One extraction into *mesh, which is made where it is NULL. */
static int extract(tc_grid *grid, const tc_extract_options *how, tc_mesh **mesh, tc_mesh_data *data) {
    *data = (tc_mesh_data){.struct_size = sizeof *data};
    int status = library_status(tc_extract(grid, how, mesh));
    return status ? status : library_status(tc_mesh_get(*mesh, data));
}

int measure_mesh_bytes(const measurement *m, uint64_t *bytes) {
    tc_counts first = {.struct_size = sizeof first}, second = {.struct_size = sizeof second};
    tc_grid *grid = NULL;
    int status = grid_make(m, &grid);
    if (!status) status = library_status(tc_count(grid, &m->first, &first));
    if (!status) status = library_status(tc_count(grid, &m->second, &second));
    *bytes = first.mesh_bytes > second.mesh_bytes ? first.mesh_bytes : second.mesh_bytes;
    tc_grid_destroy(grid);
    return status;
}

/* ---------------------------------------------------------------------------------------------------- verification */

static int show_label(void *user, const char *stage, double fraction) {
    (void)stage;
    return progress_update(NULL, user, fraction);
}

/* Compares the device's first surface with the reference's, of the same samples. */
static int reference_compare(const measurement *m, const tc_mesh_data *device, spread *reference_ms) {
    tc_context_options options;
    tc_context *context = NULL;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {0};
    char text[256], label[sizeof m->label + 16];
    snprintf(label, sizeof label, "%s: reference", m->label);
    tc_context_options_init(&options);
    options.engine = TC_ENGINE_REFERENCE;
    options.progress = show_label;
    options.progress_user = label;
    int status = library_status(tc_context_create(&options, &context));
    if (!status) status = library_status(samples_open(m->samples, context, &grid));
    if (!status) status = extract(grid, &m->first, &mesh, &data);
    if (!status && !meshes_are_same(device, &data, text, sizeof text))
        status = fail(STATUS_CHECK, "%s: verification failed: %s", m->label, text);
    double ms = data.timings.total_ms;
    *reference_ms = (spread){ms, ms, ms};
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
    return status;
}

static surface surface_of(const tc_extract_options *how, const tc_mesh_data *data) {
    return (surface){how->isovalue, data->vertex_count, data->triangle_count,
                     mesh_hash(data->positions, data->vertex_count, data->triangles, data->triangle_count)};
}

/* Both surfaces of one grid, the first compared with the reference's. */
static int surfaces_make(const measurement *m, case_result *result) {
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    int status = grid_make(m, &grid);
    if (!status) status = extract(grid, &m->first, &mesh, &data);
    if (!status) status = reference_compare(m, &data, &result->reference_ms);
    if (!status) {
        result->first = surface_of(&m->first, &data);
        result->mesh_bytes = 12 * (data.vertex_count + data.triangle_count);
        status = extract(grid, &m->second, &mesh, &data);
    }
    if (!status) result->second = surface_of(&m->second, &data);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    return status;
}

/* The second surface from a grid of its own. */
static int second_compare(const measurement *m, const case_result *result) {
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    int status = grid_make(m, &grid);
    if (!status) status = extract(grid, &m->second, &mesh, &data);
    if (!status && surface_of(&m->second, &data).hash != result->second.hash)
        status = fail(STATUS_CHECK, "%s: verification failed: isovalue %g gives another mesh after %g than alone",
                      m->label, m->second.isovalue, m->first.isovalue);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    return status;
}

int measure_verify(const measurement *m, case_result *result) {
    const samples *s = m->samples;
    result->cell_bytes = s->keeps_cells ? 64 * s->cells.cell_count : 16 * s->complex.tetrahedron_count;
    int status = surfaces_make(m, result);
    return status ? status : second_compare(m, result);
}

/* ---------------------------------------------------------------------------------------------------------- timing */

int measure_cold(const measurement *m, double *ms) {
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    int status = grid_make(m, &grid);
    if (!status) status = extract(grid, &m->first, &mesh, &data);
    if (!status) *ms = data.timings.total_ms;
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    return status;
}

int measure_second(const measurement *m, double *ms) {
    tc_grid *grid = NULL;
    tc_mesh *first = NULL, *second = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    int status = grid_make(m, &grid);
    if (!status) status = extract(grid, &m->first, &first, &data);
    if (!status) status = extract(grid, &m->second, &second, &data);
    if (!status) *ms = data.timings.total_ms;
    tc_mesh_destroy(first);
    tc_mesh_destroy(second);
    tc_grid_destroy(grid);
    return status;
}

static int show_repeats(const measurement *m, int done, int repeat) {
    char label[sizeof m->label + 16];
    snprintf(label, sizeof label, "%s: timing", m->label);
    return progress_update(NULL, label, (double)done / repeat) ? progress_status() : 0;
}

static int no_memory(void) { return fail(STATUS_FAILED, "no memory for the times; give fewer --repeat"); }

int measure_cold_times(const measurement *m, int repeat, double patience_ms, case_result *result) {
    double *times = calloc((size_t)repeat, sizeof *times), begin = now_ms();
    int status = times ? 0 : no_memory(), count = 0;
    while (!status && count < repeat && (count < LEAST_REPEATS || now_ms() - begin < patience_ms)) {
        status = measure_cold(m, &times[count++]);
        if (!status) status = show_repeats(m, count, 2 * repeat);
    }
    if (!status) result->extract_ms = spread_of(times, count);
    result->repeat = count;
    free(times);
    return status;
}

/* A first and a second warm extraction. */
static int warm_pair(const measurement *m, tc_mesh **mesh, tc_timings *first, tc_timings *second) {
    tc_grid *grid = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    int status = grid_make(m, &grid);
    if (!status) status = extract(grid, &m->first, mesh, &data);
    if (!status) *first = data.timings;
    if (!status) status = extract(grid, &m->second, mesh, &data);
    if (!status) *second = data.timings;
    tc_grid_destroy(grid);
    return status;
}

/* scratch: count numbers. */
static stage_times stage_times_of(const tc_timings *timings, int count, double *scratch) {
    stage_times times;
    for (int n = 0; n < count; n++) scratch[n] = timings[n].classify_ms;
    times.classify_ms = spread_of(scratch, count);
    for (int n = 0; n < count; n++) scratch[n] = timings[n].emit_ms;
    times.emit_ms = spread_of(scratch, count);
    for (int n = 0; n < count; n++) scratch[n] = timings[n].total_ms;
    times.total_ms = spread_of(scratch, count);
    return times;
}

static void limits_apply(const device_limits *limits, case_result *result) {
    result->limit_ms = ((double)(result->sample_bytes + result->cell_bytes) / limits->read_gbps +
                        (double)result->mesh_bytes / limits->write_gbps) *
                       1e-6;
    result->limit_ratio = result->first_times.total_ms.median / result->limit_ms;
}

int measure_warm_times(const measurement *m, const device_limits *limits, case_result *result) {
    const int repeat = result->repeat;
    tc_mesh *mesh = NULL;
    tc_timings *first = calloc((size_t)repeat, sizeof *first), *second = calloc((size_t)repeat, sizeof *second);
    double *scratch = calloc((size_t)repeat, sizeof *scratch);
    int status = first && second && scratch ? 0 : no_memory();
    if (!status) status = warm_pair(m, &mesh, first, second); /* makes the mesh that is kept */
    for (int n = 0; n < repeat && !status; n++) {
        status = warm_pair(m, &mesh, &first[n], &second[n]);
        if (!status) status = show_repeats(m, repeat + n, 2 * repeat);
    }
    if (!status) {
        result->first_times = stage_times_of(first, repeat, scratch);
        result->second_times = stage_times_of(second, repeat, scratch);
        limits_apply(limits, result);
    }
    tc_mesh_destroy(mesh);
    free(first);
    free(second);
    free(scratch);
    return status;
}
