#include "measure.h"

#include "exit_status.h"
#include "failure.h"
#include "mesh_check.h"
#include "progress.h"
#include "verify.h"

#include <inttypes.h>
#include <stdlib.h>

int library_status(tc_status status) {
    switch (status) {
    case TC_OK:
        return 0;
    case TC_ERROR_ARGUMENT:
        return fail(STATUS_USAGE, "%s", tc_message());
    case TC_ERROR_DATA:
        return fail(STATUS_INPUT, "%s", tc_message());
    case TC_ERROR_CANCELLED:
        return progress_status();
    default:
        return fail(STATUS_FAILED, "%s", tc_message());
    }
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

spread spread_of(double *values, int count) {
    if (count == 0) return (spread){0};
    qsort(values, (size_t)count, sizeof *values, by_value);
    double median = (values[(count - 1) / 2] + values[count / 2]) / 2.0;
    return (spread){median, values[0], values[count - 1]};
}

/* ---------------------------------------------------------------------------------------------------- verification */

static int show_label(void *user, const char *stage, double fraction) {
    (void)stage;
    return progress_update(NULL, user, fraction);
}

/* Compares the device's mesh with the reference's, of the same samples. */
static int verify(const measurement *m, const samples *s, const tc_mesh_data *device, spread *reference_ms) {
    tc_context_options options;
    tc_context *context = NULL;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    char text[256], label[sizeof m->label + 16];
    snprintf(label, sizeof label, "%s: reference", m->label);
    tc_context_options_init(&options);
    options.engine = TC_ENGINE_REFERENCE;
    options.progress = show_label;
    options.progress_user = label;
    int status = library_status(tc_context_create(&options, &context));
    if (!status) status = library_status(tc_grid_create(context, &s->grid, &grid));
    if (!status) status = library_status(tc_extract(grid, &m->how, &mesh));
    if (!status) status = library_status(tc_mesh_get(mesh, &data));
    if (!status && !verify_same(device, &data, text, sizeof text))
        status = fail(STATUS_CHECK, "%s: verification failed: %s", m->label, text);
    double ms = data.timings.total_ms;
    *reference_ms = (spread){ms, ms, ms};
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
    return status;
}

int measure_open(tc_context *context, const samples *s, double iso, measurement *m, case_result *result) {
    const int64_t *dims = s->grid.dims;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    *m = (measurement){0};
    *result = (case_result){.field = s->name,
                            .dims = {dims[0], dims[1], dims[2]},
                            .type = s->grid.type,
                            .iso = iso,
                            .sample_bytes = s->bytes};
    snprintf(m->label, sizeof m->label, "%.60s %" PRId64 "x%" PRId64 "x%" PRId64 " %s", s->name, dims[0], dims[1],
             dims[2], tc_type_name(s->grid.type));
    tc_extract_options_init(&m->how);
    m->how.isovalue = iso;
    int status = library_status(tc_grid_create(context, &s->grid, &m->grid));
    if (!status) status = library_status(tc_extract(m->grid, &m->how, &mesh));
    if (!status) status = library_status(tc_mesh_get(mesh, &data));
    if (!status) status = verify(m, s, &data, &result->reference_ms);
    if (!status) {
        result->vertex_count = data.vertex_count;
        result->triangle_count = data.triangle_count;
        result->mesh_bytes = 12 * (data.vertex_count + data.triangle_count);
        result->hash = mesh_hash(data.positions, data.vertex_count, data.triangles, data.triangle_count);
    }
    tc_mesh_destroy(mesh);
    return status;
}

void measure_close(measurement *m) {
    tc_grid_destroy(m->grid);
    *m = (measurement){0};
}

/* ---------------------------------------------------------------------------------------------------------- timing */

/* One extraction into *mesh, which is made where it is NULL. */
static int extract(measurement *m, tc_mesh **mesh, tc_timings *timings) {
    tc_mesh_data data = {.struct_size = sizeof data};
    int status = library_status(tc_extract(m->grid, &m->how, mesh));
    if (!status) status = library_status(tc_mesh_get(*mesh, &data));
    *timings = data.timings;
    return status;
}

int measure_cold(measurement *m, double *ms) {
    tc_mesh *mesh = NULL;
    tc_timings timings;
    int status = extract(m, &mesh, &timings);
    *ms = timings.total_ms;
    tc_mesh_destroy(mesh);
    return status;
}

static int show_repeats(const measurement *m, int done, int repeat) {
    char label[sizeof m->label + 16];
    snprintf(label, sizeof label, "%s: timing", m->label);
    return progress_update(NULL, label, (double)done / repeat) ? progress_status() : 0;
}

static int no_memory(void) { return fail(STATUS_FAILED, "no memory for the times; give fewer --repeat"); }

int measure_cold_times(measurement *m, int repeat, case_result *result) {
    double *times = calloc((size_t)repeat, sizeof *times);
    int status = times ? 0 : no_memory();
    for (int n = 0; n < repeat && !status; n++) {
        status = measure_cold(m, &times[n]);
        if (!status) status = show_repeats(m, n, 2 * repeat);
    }
    if (!status) result->extract_ms = spread_of(times, repeat);
    free(times);
    return status;
}

static void limits_apply(const device_limits *limits, case_result *result) {
    result->limit_ms =
        ((double)result->sample_bytes / limits->read_gbps + (double)result->mesh_bytes / limits->write_gbps) * 1e-6;
    result->limit_ratio = result->extract_warm_ms.median / result->limit_ms;
}

int measure_warm_times(measurement *m, int repeat, const device_limits *limits, case_result *result) {
    tc_mesh *mesh = NULL;
    tc_timings timings;
    double *times = calloc((size_t)repeat * 3, sizeof *times);
    double *classify = times, *emit = times + repeat, *total = times + 2 * repeat;
    int status = times ? extract(m, &mesh, &timings) : no_memory();
    for (int n = 0; n < repeat && !status; n++) {
        status = extract(m, &mesh, &timings);
        classify[n] = timings.classify_ms;
        emit[n] = timings.emit_ms;
        total[n] = timings.total_ms;
        if (!status) status = show_repeats(m, repeat + n, 2 * repeat);
    }
    if (!status) {
        result->classify_ms = spread_of(classify, repeat);
        result->emit_ms = spread_of(emit, repeat);
        result->extract_warm_ms = spread_of(total, repeat);
        limits_apply(limits, result);
    }
    tc_mesh_destroy(mesh);
    free(times);
    return status;
}
