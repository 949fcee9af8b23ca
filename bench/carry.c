/*
 * carry.c - tetracubes-bench-carry [N [REPEATS]]: what carrying one field costs beside the emission of the surface
 *
 * Sphere and gyroid of N^3 samples (256), f32 and u8; a field of one float32. Extraction into a kept mesh and carrying
 * take turns; printed are medians, least times, their ratios, and what the scalar reference takes. Its values are
 * compared, bit for bit. On a machine that others use the least times tell more than the medians.
 */
#include "field.h"
#include "tetracubes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct times {
    double *emit, *carry;
    int count;
} times;

static double now_ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

static int by_value(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Extracts and carries in turn; *values is made where it is NULL. Nonzero, with the library's message, on failure. */
static int surface_run(tc_engine engine, const tc_grid_options *volume, double isovalue, const tc_field *carried,
                       times *t, float **values, uint64_t *vertices) {
    tc_context_options device;
    tc_extract_options how;
    tc_context *context = NULL;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_context_options_init(&device);
    tc_extract_options_init(&how);
    device.engine = engine;
    how.isovalue = isovalue;
    int failed = tc_context_create(&device, &context) || tc_grid_create(context, volume, &grid);
    for (int n = -1; n < t->count && !failed; n++) { /* the first is not timed: it makes what is kept */
        tc_mesh_data data = {.struct_size = sizeof data};
        failed = tc_extract(grid, &how, &mesh) || tc_mesh_get(mesh, &data);
        *vertices = data.vertex_count;
        if (!failed && !*values) *values = calloc((size_t)data.vertex_count + 1, sizeof **values);
        const double start = now_ms();
        if (!failed) failed = !*values || tc_interpolate_field(grid, &how, carried, *values, data.vertex_count);
        if (n < 0) continue;
        t->emit[n] = data.timings.emit_ms;
        t->carry[n] = now_ms() - start;
    }
    if (failed) fprintf(stderr, "%s\n", tc_message());
    qsort(t->emit, (size_t)t->count, sizeof *t->emit, by_value);
    qsort(t->carry, (size_t)t->count, sizeof *t->carry, by_value);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
    return failed;
}

static int case_run(const field *f, tc_type type, int size, int repeats) {
    const size_t count = (size_t)size * (size_t)size * (size_t)size;
    const size_t most = (size_t)repeats > 0 ? (size_t)repeats : 1;
    void *samples = malloc(count * tc_type_bytes(type));
    float *other = malloc(count * sizeof *other), *values = NULL, *expected = NULL;
    double one[2];
    times t = {calloc(most, sizeof *t.emit), calloc(most, sizeof *t.carry), (int)most}, slow = {one, one + 1, 1};
    uint64_t vertices = 0;
    tc_grid_options volume;
    tc_grid_options_init(&volume);
    volume.dims[0] = volume.dims[1] = volume.dims[2] = size;
    volume.type = type;
    volume.samples = samples;
    int failed = !samples || !other || !t.emit || !t.carry;
    if (!failed) {
        const tc_field carried = {sizeof carried, TC_F32, 1, other};
        field_sample(f, volume.dims, type, 0, 0, size, samples);
        for (size_t n = 0; n < count; n++) other[n] = (float)(n % 1000003);
        failed = surface_run(TC_ENGINE_OPENCL, &volume, f->isovalue, &carried, &t, &values, &vertices) ||
                 surface_run(TC_ENGINE_REFERENCE, &volume, f->isovalue, &carried, &slow, &expected, &vertices);
    }
    if (!failed && memcmp(values, expected, vertices * sizeof *values) != 0) {
        fprintf(stderr, "the values are not the reference's\n");
        failed = 1;
    }
    if (!failed)
        printf("%-8s %d^3 %s: emit %.2f ms (least %.2f), carry %.2f ms (%.2f), ratio %.2f (%.2f); reference %.0f ms\n",
               f->name, size, tc_type_name(type), t.emit[most / 2], t.emit[0], t.carry[most / 2], t.carry[0],
               t.carry[most / 2] / t.emit[most / 2], t.carry[0] / t.emit[0], slow.carry[0]);
    free(samples);
    free(other);
    free(values);
    free(expected);
    free(t.emit);
    free(t.carry);
    return failed;
}

int main(int argc, char **argv) {
    static const char *const names[] = {"sphere", "gyroid"};
    static const tc_type types[] = {TC_F32, TC_U8};
    const int size = argc > 1 ? atoi(argv[1]) : 256, repeats = argc > 2 ? atoi(argv[2]) : 31;
    int failed = size < 2 || size > 2048;
    for (int n = 0; n < 4 && !failed; n++) failed = case_run(field_find(names[n / 2]), types[n % 2], size, repeats);
    return failed;
}
