/*
 * kinds.h - a small grid of every kind that the library extracts from, for tests of what surrounds extraction
 *
 * kinds_fill() first, once; then kind_open() makes grid `kind` in a context, and kind_how() says how it is extracted,
 * at one of two isovalues. Arrays are shared and never written again, so that threads may use them at once.
 */
#ifndef KINDS_H
#define KINDS_H

#include "engines.h"

#include <math.h>

enum kind { KIND_U8, KIND_HYBRID, KIND_MISSING, KIND_F64, KIND_RECTILINEAR, KIND_CURVILINEAR, KIND_COMPLEX, KINDS };
enum { KIND_X = 70, KIND_Y = 13, KIND_Z = 18, KIND_SAMPLES = KIND_X * KIND_Y * KIND_Z };

static const char *const kind_names[KINDS] = {"u8",          "hybrid",      "missing samples", "f64",
                                              "rectilinear", "curvilinear", "complex"};

static uint8_t kind_u8[KIND_SAMPLES];
static float kind_f32[KIND_SAMPLES], kind_points[3 * KIND_SAMPLES], kind_axes[3][KIND_X];
static double kind_f64[KIND_SAMPLES];
static tc_tetrahedra kind_complex = {.struct_size = sizeof(tc_tetrahedra)};

static inline void kind_describe(enum kind kind, tc_grid_options *o) {
    static const int dims[3] = {KIND_X, KIND_Y, KIND_Z};
    tc_grid_options_init(o);
    for (int axis = 0; axis < 3; axis++) o->dims[axis] = dims[axis];
    o->type = kind == KIND_RECTILINEAR || kind == KIND_COMPLEX ? TC_F32 : TC_U8;
    o->samples = o->type == TC_F32 ? (const void *)kind_f32 : kind_u8;
    if (kind == KIND_F64 || kind == KIND_HYBRID || kind == KIND_MISSING) o->type = TC_F64, o->samples = kind_f64;
    if (kind == KIND_MISSING) o->has_nodata = 1, o->nodata = kind_f64[KIND_SAMPLES / 2];
    for (int axis = 0; axis < 3 && kind == KIND_RECTILINEAR; axis++) o->axes[axis] = kind_axes[axis];
    if (kind == KIND_CURVILINEAR || kind == KIND_COMPLEX) o->points = kind_points;
}

static inline void kind_how(enum kind kind, int isovalue, tc_extract_options *how) {
    tc_extract_options_init(how);
    how->isovalue = isovalue ? 90.25 : 127.5;
    how->method = kind == KIND_HYBRID ? TC_METHOD_HYBRID : TC_METHOD_TETRA;
    how->normals = kind == KIND_RECTILINEAR || kind == KIND_CURVILINEAR;
}

static inline tc_status kind_open(tc_context *context, enum kind kind, tc_grid **grid) {
    tc_grid_options o;
    tc_tetrahedra_grid_options complex;
    kind_describe(kind, &o);
    if (kind != KIND_COMPLEX) return tc_grid_create(context, &o, grid);
    tc_tetrahedra_grid_options_init(&complex);
    complex.point_count = KIND_SAMPLES;
    complex.points = kind_points;
    complex.type = TC_F32;
    complex.samples = kind_f32;
    complex.tetrahedron_count = kind_complex.tetrahedron_count;
    complex.tetrahedra = kind_complex.tetrahedra;
    return tc_tetrahedra_grid_create(context, &complex, grid);
}

static inline void kinds_fill(void) {
    tc_grid_options o;
    for (int n = 0; n < KIND_SAMPLES; n++) {
        const int x = n % KIND_X, y = n / KIND_X % KIND_Y, z = n / KIND_X / KIND_Y;
        const double value = 127.5 + 50 * sin(0.4 * x + 0.1 * z) + 50 * cos(0.5 * y + 0.3 * z);
        kind_u8[n] = (uint8_t)value;
        kind_f32[n] = (float)value;
        kind_f64[n] = value;
        kind_points[3 * n] = (float)(x + 0.2 * sin(y));
        kind_points[3 * n + 1] = (float)(y + 0.1 * x);
        kind_points[3 * n + 2] = (float)(z + 0.2 * cos(x));
    }
    for (int n = 0; n < KIND_X; n++)
        kind_axes[0][n] = kind_axes[1][n] = kind_axes[2][n] = 0.01f * (float)(n * n) + (float)n;
    kind_describe(KIND_COMPLEX, &o);
    EXPECT(tc_tetrahedralize_grid(&o, &kind_complex) == TC_OK, "%s", tc_message());
}

static inline void kinds_release(void) { tc_tetrahedra_release(&kind_complex); }

/* A mesh of the reference's: what every context has to make. */
static inline tc_mesh *kind_expected(tc_context *reference, enum kind kind, int isovalue, tc_mesh_data *data) {
    tc_extract_options how;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    *data = (tc_mesh_data){.struct_size = sizeof *data};
    kind_how(kind, isovalue, &how);
    const bool done = kind_open(reference, kind, &grid) == TC_OK && tc_extract(grid, &how, &mesh) == TC_OK &&
                      tc_mesh_get(mesh, data) == TC_OK;
    EXPECT(done && data->triangle_count > 100, "%s: %s", kind_names[kind], tc_message());
    tc_grid_destroy(grid);
    return mesh;
}

#endif
