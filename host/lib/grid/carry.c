/*
 * A batch takes three steps: load the samples at the ends of all edges, find where the isovalue lies between them,
 * interpolate the field there. Each is a loop over arrays of one type, which compilers vectorise.
 *
 * The arithmetic is that of kernels/base/crossing.cl and of the reference (reference_crossing.inc, carry_vertex.c): the
 * same operations in the same order.
 */
#include "grid/carry.h"

#include "opencl/context.h"

/* Component n, of `stride`, of the values at samples. */
#define GATHER(TYPE)                                                                                                   \
    for (uint32_t m = 0; m < count; m++) out[m] = (REAL)((const TYPE *)values)[samples[m] * stride + n]

#define GATHER_CASE(type, name, c_type, ...)                                                                           \
    case type:                                                                                                         \
        GATHER(c_type);                                                                                                \
        break;
#define GATHER_ANY                                                                                                     \
    switch (type) { SAMPLE_TYPES(GATHER_CASE) }

#define REAL float
static void gather_f32(tc_type type, const void *values, int stride, int n, const int64_t *samples, uint32_t count,
                       float *out) {
    GATHER_ANY
}
#undef REAL
#define REAL double
static void gather_f64(tc_type type, const void *values, int stride, int n, const int64_t *samples, uint32_t count,
                       double *out) {
    GATHER_ANY
}
#undef REAL

void carry_samples(const tc_grid *grid, const int64_t *samples, uint32_t count, double *values) {
    gather_f64(grid->type, grid->samples, 1, 0, samples, count, values);
}

/* Where the difference of two samples overflows, all numbers are halved first. */
static void crossings_f32(const float *a, const float *b, float iso, uint32_t count, float *t) {
    for (uint32_t n = 0; n < count; n++) {
        const float scale = isinf(b[n] - a[n]) ? 0.5f : 1, low = scale * a[n], high = scale * b[n];
        t[n] = (scale * iso - low) / (high - low);
    }
}

static void crossings_f64(const double *a, const double *b, double iso, uint32_t count, float *t) {
    for (uint32_t n = 0; n < count; n++) {
        const double scale = isinf(b[n] - a[n]) ? 0.5 : 1, low = scale * a[n], high = scale * b[n];
        t[n] = (float)((scale * iso - low) / (high - low));
    }
}

/* Where t is 0 or 1, exactly the value of that end, whatever the other is. */
static void interpolate(const double *from, const double *to, const float *t, uint32_t count, float *values) {
    for (uint32_t n = 0; n < count; n++) {
        const double between = from[n] + (double)t[n] * (to[n] - from[n]);
        values[n] = (float)(t[n] == 0 ? from[n] : t[n] == 1 ? to[n] : between);
    }
}

/* Of the first `count` edges. */
static void edges_cross(const tc_grid *grid, double isovalue, const edge_batch *batch, uint32_t count, float *t) {
    float a32[BATCH_EDGES], b32[BATCH_EDGES];
    double a[BATCH_EDGES], b[BATCH_EDGES];
    if (type_is_wide(grid->type)) {
        gather_f64(grid->type, grid->samples, 1, 0, batch->low, count, a);
        gather_f64(grid->type, grid->samples, 1, 0, batch->high, count, b);
        crossings_f64(a, b, isovalue, count, t);
    } else {
        gather_f32(grid->type, grid->samples, 1, 0, batch->low, count, a32);
        gather_f32(grid->type, grid->samples, 1, 0, batch->high, count, b32);
        crossings_f32(a32, b32, (float)isovalue, count, t);
    }
    for (uint32_t n = 0; n < count && batch->has_at_samples; n++) t[n] = batch->low[n] == batch->high[n] ? 0 : t[n];
}

void carry_crossings(const tc_grid *grid, double isovalue, const edge_batch *batch, float t[BATCH_EDGES]) {
    edges_cross(grid, isovalue, batch, batch->count, t);
}

void carry_batch(const carry *c, const tc_grid *grid, double isovalue, edge_batch *batch) {
    const tc_field *f = c->field;
    if (!batch->count) return;
    const int components = f->components;
    const uint64_t capacity = batch->vertex < c->capacity ? c->capacity - batch->vertex : 0;
    const uint32_t count = batch->count < capacity ? batch->count : (uint32_t)capacity;
    float *out = c->out + batch->vertex * (uint64_t)components, t[BATCH_EDGES], a32[BATCH_EDGES];
    double a[BATCH_EDGES], b[BATCH_EDGES];
    edges_cross(grid, isovalue, batch, count, t);
    for (int n = 0; n < components; n++) {
        gather_f64(f->type, f->values, components, n, batch->low, count, a);
        gather_f64(f->type, f->values, components, n, batch->high, count, b);
        if (components == 1) {
            interpolate(a, b, t, count, out);
            continue;
        }
        interpolate(a, b, t, count, a32);
        for (uint32_t m = 0; m < count; m++) out[m * (uint64_t)components + (uint64_t)n] = a32[m];
    }
    batch->vertex += batch->count;
    batch->count = 0;
}
