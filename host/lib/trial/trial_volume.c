/*
 * The volume of a trial: noise of full mantissas around the isovalue, some samples equal to it.
 */
#include "trial/trial.h"

#include "failure.h"
#include "surface/grids.h"
#include "sample_types.h"

#include <math.h>
#include <stdlib.h>

/* Two words, two bricks along y and two layers, the second of each but begun. */
enum { NX = 67, NY = 10, NZ = 6, SAMPLES = NX * NY * NZ };

static uint64_t noise(uint64_t n) { /* splitmix64 */
    uint64_t z = (n + 1) * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

enum { TIE_IN = 16, GAP_IN = 61 }; /* one sample in so many equals the isovalue, is missing */

/* -1 < x < 1, in steps of 2^-52. */
static double real_noise(uint64_t n) { return ((double)(noise(n) >> 11) - 0x1p52) * 0x1p-52; }

/* Rows change from moderate to subnormal to huge samples, whose differences overflow. */
static double real_sample(const trial_volume *v, uint64_t n) {
    static const double narrow[] = {1.0, 0x1p-130, 0x1.ep127}, wide[] = {1.0, 0x1p-1030, 0x1.ep1023};
    if (noise(n + SAMPLES) % TIE_IN == 0) return v->isovalue;
    uint64_t magnitude = v->plain ? 0 : n / NX / 3 % 3;
    return real_noise(n) * (v->type == TC_F32 ? narrow : wide)[magnitude];
}

static double gap(uint64_t n) {
    const double gaps[] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    return gaps[n % 3];
}

/* Mostly near the isovalue, some anywhere in the type's range. */
static uint64_t integer_sample(const trial_volume *v, uint64_t n) {
    uint64_t bits = noise(n), near = (uint64_t)(int64_t)v->isovalue + bits / 16 % 15 - 7;
    return noise(n + SAMPLES) % TIE_IN == 0 ? (uint64_t)(int64_t)v->isovalue : bits % 4 ? near : bits >> 32;
}

static void sample_put(trial_volume *v, uint64_t n) {
    bool is_gap = v->missing && n % GAP_IN == 0;
    switch (v->type) {
#define PUT_CASE(type, name, c_type, ...)                                                                              \
    case type:                                                                                                         \
        ((c_type *)v->samples)[n] = (c_type)integer_sample(v, n);                                                      \
        break;
        INTEGER_TYPES(PUT_CASE)
#undef PUT_CASE
    case TC_F32:
        ((float *)v->samples)[n] = (float)(is_gap ? gap(n) : real_sample(v, n));
        break;
    case TC_F64:
        ((double *)v->samples)[n] = is_gap ? gap(n) : real_sample(v, n);
        break;
    }
}

/* The middle of an integer's range, where its sign changes; of floating point a subnormal number. */
static double isovalue_of(tc_type type) {
    switch (type) {
#define MIDDLE_CASE(type, name, c_type, least, most, ...)                                                              \
    case type:                                                                                                         \
        return floor((double)(least) / 2 + (double)(most) / 2) + 1;
        INTEGER_TYPES(MIDDLE_CASE)
#undef MIDDLE_CASE
    case TC_F32:
        return 0x1p-140;
    case TC_F64:
        return 0x1p-1040;
    }
    return 0;
}

/* Cells of about unit size, none alike; the grid is mirrored where left-handed is. */
static void coordinates_make(trial_volume *v) {
    const float *at = v->axes;
    const int64_t dims[3] = {NX, NY, NZ};
    for (uint64_t n = 0; n < NX + NY + NZ; n++) v->axes[n] = (float)n + 0.4f * (float)real_noise(n);
    for (int axis = 0; axis < 3 && v->kind == GRID_RECTILINEAR; at += dims[axis++]) v->options.axes[axis] = at;
    for (uint64_t n = 0; n < SAMPLES; n++) {
        const uint64_t z = n / NX / NY;
        const float index[3] = {-(float)(n % NX), (float)(n / NX % NY), (float)z};
        for (uint64_t axis = 0; axis < 3; axis++)
            v->points[3 * n + axis] = index[axis] + 0.2f * (float)real_noise(3 * n + axis);
    }
    if (v->kind == GRID_CURVILINEAR || v->unstructured) v->options.points = v->points;
}

tc_status trial_volume_make(trial_volume *v) {
    static const double sheared[3][4] = {{0.75, 0.125, 0.0, 1.0}, {0.0, 1.5, 0.25, -3.0}, {0.0, 0.0, -0.7, 0.1}};
    v->samples = malloc(SAMPLES * tc_type_bytes(v->type));
    v->points = malloc(3 * SAMPLES * sizeof *v->points);
    v->axes = malloc((NX + NY + NZ) * sizeof *v->axes);
    if (!v->samples || !v->points || !v->axes)
        return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the trial of a device");
    v->isovalue = isovalue_of(v->type);
    tc_grid_options_init(&v->options);
    v->options.type = v->type;
    v->options.samples = v->samples;
    v->options.dims[0] = NX, v->options.dims[1] = NY, v->options.dims[2] = NZ;
    v->options.has_nodata = v->missing;
    v->options.nodata = type_is_real(v->type) ? 0.0 : v->isovalue + 3;
    for (int n = 0; n < 12; n++) v->options.matrix[n / 4][n % 4] = sheared[n / 4][n % 4];
    for (uint64_t n = 0; n < SAMPLES; n++) sample_put(v, n);
    coordinates_make(v);
    v->complex.struct_size = sizeof v->complex;
    if (v->whole) return trial_cells_make(v, noise);
    return v->unstructured ? tc_tetrahedralize_grid(&v->options, &v->complex) : TC_OK;
}

void trial_volume_release(trial_volume *v) {
    tc_tetrahedra_release(&v->complex);
    trial_cells_release(v);
    free(v->samples);
    free(v->points);
    free(v->axes);
}

tc_status trial_grid_create(const trial_volume *v, tc_context *context, scan_parameters scan, tc_grid **grid) {
    tc_tetrahedra_grid_options complex;
    if (!v->unstructured) return grid_create(context, &v->options, scan, grid);
    complex = (tc_tetrahedra_grid_options){.struct_size = sizeof complex, .point_count = SAMPLES};
    complex.points = v->points;
    complex.type = v->type;
    complex.samples = v->samples;
    complex.tetrahedron_count = v->complex.tetrahedron_count;
    complex.tetrahedra = v->complex.tetrahedra;
    if (v->whole) complex.source = &v->cells, complex.cells = v->complex.cells;
    return complex_create(context, &complex, scan, grid);
}
