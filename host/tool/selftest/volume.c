#include "volume.h"

#include "exit_status.h"
#include "failure.h"
#include "field.h"
#include "sample_types.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NOISE_SEED 5

/* Multiples of 32 (i8: of 16), from u8 samples. */
static void step_samples(const trial *t, size_t count, void *samples) {
    const unsigned char *bytes = samples; /* converted from the last to the first, in index */
    field_sample(field_find(t->field), t->dims, TC_U8, NOISE_SEED, 0, t->dims[2], samples);
    for (size_t n = count; n-- > 0;) {
        const unsigned value = bytes[n] & 0xe0u;
        switch (t->type) {
#define STEP_CASE(type, name, c_type, least, most, ...)                                                                \
    case type:                                                                                                         \
        ((c_type *)samples)[n] = (c_type)((double)(most) < UINT8_MAX ? value >> 1 : value);                            \
        break;
            SAMPLE_TYPES(STEP_CASE)
#undef STEP_CASE
        }
    }
}

static void scatter_missing(const trial *t, size_t count, void *samples) {
    static const double gaps[] = {NAN, INFINITY, -INFINITY};
    for (size_t n = 11; n < count; n += 37) {
        if (t->type == TC_F32) ((float *)samples)[n] = (float)gaps[n % 3];
        if (t->type == TC_F64) ((double *)samples)[n] = gaps[n % 3];
    }
}

/* Quotients half way between two numbers of float32, or as near as quotients come. Such is n / d for an odd d of 24
 * bits and the n for which n 2^25 is 1 or -1 modulo d. A sample -n beside a sample d - n makes that quotient at
 * isovalue 0; each pair stands in a row along x. */
static void midpoint_samples(size_t count, float *samples) {
    for (size_t pair = 0; pair < count / 2; pair++) {
        uint64_t d = 0x800001u + 2 * (pair * 2654435761u % 0x3ffff0u), inverse = 1;
        for (int n = 0; n < 25; n++) inverse = (inverse & 1 ? inverse + d : inverse) / 2;
        uint64_t n = pair & 1 ? inverse : d - inverse;
        samples[2 * pair] = -(float)n;
        samples[2 * pair + 1] = (float)(d - n);
    }
    if (count & 1) samples[count - 1] = 1;
}

/* Subnormal samples, or samples so large that their differences overflow. */
static void scale(const trial *t, size_t count, void *samples) {
    const int is_small = t->change == CHANGE_SUBNORMAL, exponent = selftest_exponent(t);
    for (size_t n = 0; n < count; n++) {
        if (t->type == TC_F32)
            ((float *)samples)[n] = ldexpf(((float *)samples)[n] - (is_small ? 0.0f : 128.0f), exponent);
        else
            ((double *)samples)[n] = ldexp(((double *)samples)[n] - (is_small ? 0.0 : 128.0), exponent);
    }
}

int selftest_exponent(const trial *t) {
    if (t->change == CHANGE_SUBNORMAL) return t->type == TC_F32 ? -140 : -1060;
    return t->type == TC_F32 ? 120 : 1016;
}

static int make_samples(const trial *t, selftest_volume *v) {
    size_t count = (size_t)(t->dims[0] * t->dims[1] * t->dims[2]);
    v->samples = malloc(count * tc_type_bytes(t->type));
    if (!v->samples) return fail(STATUS_FAILED, "out of memory for a volume of the self-test");
    if (t->change == CHANGE_STEPS)
        step_samples(t, count, v->samples);
    else if (t->change == CHANGE_MIDPOINTS)
        midpoint_samples(count, v->samples);
    else
        field_sample(field_find(t->field), t->dims, t->type, NOISE_SEED, 0, t->dims[2], v->samples);
    if (t->change == CHANGE_MISSING) scatter_missing(t, count, v->samples);
    if (t->change == CHANGE_SUBNORMAL || t->change == CHANGE_HUGE) scale(t, count, v->samples);
    return 0;
}

/* Between -0.2 and 0.2. */
static float jitter(uint64_t n) { return (float)(n * 2654435761u % 1000u) * 4e-4f - 0.2f; }

/* Every cell has its own shape; curvilinear grids are mirrored. */
static int make_coordinates(const trial *t, selftest_volume *v) {
    const uint64_t nx = (uint64_t)t->dims[0], ny = (uint64_t)t->dims[1], nz = (uint64_t)t->dims[2];
    v->points = malloc(3 * nx * ny * nz * sizeof *v->points);
    v->axes = malloc((nx + ny + nz) * sizeof *v->axes);
    if (!v->points || !v->axes) return fail(STATUS_FAILED, "out of memory for a volume of the self-test");
    for (uint64_t n = 0; n < nx + ny + nz; n++) v->axes[n] = (float)n + jitter(n);
    for (uint64_t n = 0; n < nx * ny * nz; n++) {
        const uint64_t z = n / nx / ny;
        const float index[3] = {-(float)(n % nx), (float)(n / nx % ny), (float)z};
        for (uint64_t axis = 0; axis < 3; axis++) v->points[3 * n + axis] = index[axis] + jitter(3 * n + axis);
    }
    return 0;
}

static void describe_grid(const trial *t, selftest_volume *v) {
    static const double mirrored[3][4] = {{-0.5, 0.25, 0.0, 10.0}, {0.0, 1.5, 0.125, -3.0}, {0.0, 0.0, 0.7, 0.1}};
    tc_grid_options *grid = &v->grid;
    tc_grid_options_init(grid);
    memcpy(grid->dims, t->dims, sizeof grid->dims);
    memcpy(grid->first_index, t->first, sizeof grid->first_index);
    if (t->mirrored) memcpy(grid->matrix, mirrored, sizeof mirrored);
    grid->type = t->type;
    grid->samples = v->samples;
    grid->has_nodata = t->has_nodata;
    grid->nodata = t->nodata;
    const float *at = v->axes;
    for (int axis = 0; axis < 3 && t->kind == KIND_RECTILINEAR; at += t->dims[axis++]) grid->axes[axis] = at;
    if (t->kind == KIND_CURVILINEAR || t->kind == KIND_COMPLEX) grid->points = v->points;
}

/* The cubes as hexahedra, every fifth as two wedges, some turned over. */
static int make_cells(selftest_volume *v) {
    static const int hexahedra[2][8] = {{0, 1, 3, 2, 4, 5, 7, 6}, {4, 5, 7, 6, 0, 1, 3, 2}};
    static const int wedges[2][6] = {{0, 3, 1, 4, 7, 5}, {0, 2, 3, 4, 6, 7}};
    const int64_t *d = v->grid.dims, cubes = (d[0] - 1) * (d[1] - 1) * (d[2] - 1);
    uint8_t *types = malloc(2 * (size_t)cubes);
    int64_t *offsets = calloc(2 * (size_t)cubes + 1, sizeof *offsets), *at = malloc(12 * (size_t)cubes * sizeof *at);
    v->cells = (tc_cells){.struct_size = sizeof v->cells, .point_count = (uint64_t)(d[0] * d[1] * d[2])};
    v->cells.points = v->points, v->cells.types = types, v->cells.offsets = offsets, v->cells.connectivity = at;
    if (!types || !offsets || !at) return fail(STATUS_FAILED, "out of memory for a volume of the self-test");
    uint64_t count = 0;
    for (int64_t n = 0; n < cubes; n++) {
        const int64_t x = n % (d[0] - 1), y = n / (d[0] - 1) % (d[1] - 1), z = n / (d[0] - 1) / (d[1] - 1);
        const int cut = n % 5 == 3, corners = cut ? 6 : 8;
        for (int part = 0; part <= cut; part++) {
            const int *order = cut ? wedges[part] : hexahedra[n % 7 == 2];
            types[count] = cut ? 13 : 12;
            offsets[count + 1] = offsets[count] + corners;
            for (int c = 0; c < corners; c++)
                at[offsets[count] + c] =
                    ((z + (order[c] >> 2)) * d[1] + y + (order[c] >> 1 & 1)) * d[0] + x + (order[c] & 1);
            count++;
        }
    }
    v->cells.cell_count = count;
    return tc_tetrahedralize(&v->cells, &v->complex) ? fail(STATUS_FAILED, "%s", tc_message()) : 0;
}

int selftest_volume_make(const trial *t, selftest_volume *v) {
    *v = (selftest_volume){.is_complex = t->kind == KIND_COMPLEX, .complex.struct_size = sizeof v->complex};
    int status = make_samples(t, v);
    if (!status && t->kind != KIND_UNIFORM) status = make_coordinates(t, v);
    if (status) return status;
    describe_grid(t, v);
    if (v->is_complex && t->method == TC_METHOD_HYBRID) return make_cells(v);
    if (v->is_complex && tc_tetrahedralize_grid(&v->grid, &v->complex)) return fail(STATUS_FAILED, "%s", tc_message());
    return 0;
}

void selftest_volume_release(selftest_volume *v) {
    tc_tetrahedra_release(&v->complex);
    free((void *)(uintptr_t)v->cells.types);
    free((void *)(uintptr_t)v->cells.offsets);
    free((void *)(uintptr_t)v->cells.connectivity);
    free(v->samples);
    free(v->points);
    free(v->axes);
}

tc_status selftest_grid_create(const selftest_volume *v, tc_context *context, tc_grid **grid) {
    tc_tetrahedra_grid_options complex;
    if (!v->is_complex) return tc_grid_create(context, &v->grid, grid);
    tc_tetrahedra_grid_options_init(&complex);
    complex.point_count = (uint64_t)(v->grid.dims[0] * v->grid.dims[1] * v->grid.dims[2]);
    complex.points = v->points;
    complex.type = v->grid.type;
    complex.samples = v->samples;
    complex.tetrahedron_count = v->complex.tetrahedron_count;
    complex.tetrahedra = v->complex.tetrahedra;
    if (v->cells.types) complex.source = &v->cells, complex.cells = v->complex.cells;
    return tc_tetrahedra_grid_create(context, &complex, grid);
}
