#include "cases.h"

#include "random.h"
#include "samples.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const bytes_case cases[] = {
    {CASE_UNIFORM, TC_U8, TC_METHOD_TETRA, 0, 2, true},
    {CASE_UNIFORM, TC_I8, TC_METHOD_TETRA, 0, 0, false},
    {CASE_UNIFORM, TC_U16, TC_METHOD_TETRA, 0, 0, false},
    {CASE_UNIFORM, TC_I16, TC_METHOD_TETRA, 0, 0, false},
    {CASE_UNIFORM, TC_U32, TC_METHOD_TETRA, 0, 0, false},
    {CASE_UNIFORM, TC_I32, TC_METHOD_TETRA, 0, 0, false},
    {CASE_UNIFORM, TC_F32, TC_METHOD_TETRA, CASE_NORMALS, 9, true},
    {CASE_UNIFORM, TC_F64, TC_METHOD_TETRA, 0, 1, false},
    {CASE_UNIFORM, TC_U8, TC_METHOD_TETRA, CASE_MISSING | CASE_NORMALS, 0, false},
    {CASE_UNIFORM, TC_I8, TC_METHOD_TETRA, CASE_MISSING | CASE_NORMALS, 0, false},
    {CASE_UNIFORM, TC_U16, TC_METHOD_TETRA, CASE_MISSING | CASE_NORMALS, 1, false},
    {CASE_UNIFORM, TC_I16, TC_METHOD_TETRA, CASE_MISSING | CASE_NORMALS, 0, false},
    {CASE_UNIFORM, TC_U32, TC_METHOD_TETRA, CASE_MISSING | CASE_NORMALS, 0, false},
    {CASE_UNIFORM, TC_I32, TC_METHOD_TETRA, CASE_MISSING | CASE_NORMALS, 1, false},
    {CASE_UNIFORM, TC_F32, TC_METHOD_TETRA, CASE_MISSING | CASE_NORMALS, 9, true},
    {CASE_UNIFORM, TC_F64, TC_METHOD_TETRA, CASE_MISSING | CASE_NORMALS, 0, false},
    {CASE_UNIFORM, TC_F32, TC_METHOD_TETRA, CASE_NORMALS | CASE_EXTREMES, 1, true},
    {CASE_UNIFORM, TC_F64, TC_METHOD_TETRA, CASE_EXTREMES, 0, false},
    {CASE_UNIFORM, TC_U8, TC_METHOD_TETRA, CASE_DEEP, 2, true},
    {CASE_UNIFORM, TC_F32, TC_METHOD_TETRA, CASE_DEEP | CASE_MISSING | CASE_NORMALS, 1, true},
    {CASE_UNIFORM, TC_F32, TC_METHOD_TETRA, CASE_BLANKED | CASE_NORMALS, 1, false},
    {CASE_UNIFORM, TC_U8, TC_METHOD_HYBRID, 0, 0, true},
    {CASE_UNIFORM, TC_I8, TC_METHOD_HYBRID, 0, 0, false},
    {CASE_UNIFORM, TC_U16, TC_METHOD_HYBRID, 0, 0, false},
    {CASE_UNIFORM, TC_I16, TC_METHOD_HYBRID, 0, 0, false},
    {CASE_UNIFORM, TC_U32, TC_METHOD_HYBRID, 0, 0, false},
    {CASE_UNIFORM, TC_I32, TC_METHOD_HYBRID, 0, 0, false},
    {CASE_UNIFORM, TC_F32, TC_METHOD_HYBRID, CASE_MISSING | CASE_NORMALS, 1, false},
    {CASE_UNIFORM, TC_F64, TC_METHOD_HYBRID, 0, 0, false},
    {CASE_UNIFORM, TC_U8, TC_METHOD_SNAP, 0, 2, true},
    {CASE_UNIFORM, TC_I8, TC_METHOD_SNAP, 0, 0, false},
    {CASE_UNIFORM, TC_U16, TC_METHOD_SNAP, 0, 0, false},
    {CASE_UNIFORM, TC_I16, TC_METHOD_SNAP, 0, 0, false},
    {CASE_UNIFORM, TC_U32, TC_METHOD_SNAP, 0, 0, false},
    {CASE_UNIFORM, TC_I32, TC_METHOD_SNAP, 0, 0, false},
    {CASE_UNIFORM, TC_F64, TC_METHOD_SNAP, 0, 0, false},
    {CASE_UNIFORM, TC_F32, TC_METHOD_SNAP, CASE_MISSING | CASE_NORMALS, 1, true},
    {CASE_UNIFORM, TC_F32, TC_METHOD_SNAP, CASE_NORMALS | CASE_EXTREMES, 0, false},
    {CASE_UNIFORM, TC_U8, TC_METHOD_SNAP, CASE_DEEP, 0, false},
    {CASE_UNIFORM, TC_F32, TC_METHOD_SNAP, CASE_DEEP | CASE_MISSING | CASE_NORMALS, 1, false},
    {CASE_UNIFORM, TC_F32, TC_METHOD_SNAP, CASE_BLANKED | CASE_NORMALS, 0, false},
    {CASE_RECTILINEAR, TC_F32, TC_METHOD_TETRA, CASE_NORMALS, 0, true},
    {CASE_RECTILINEAR, TC_F32, TC_METHOD_TETRA, CASE_MISSING | CASE_NORMALS, 1, false},
    {CASE_RECTILINEAR, TC_U8, TC_METHOD_HYBRID, 0, 0, false},
    {CASE_RECTILINEAR, TC_U8, TC_METHOD_SNAP, 0, 0, false},
    {CASE_CURVILINEAR, TC_F32, TC_METHOD_TETRA, CASE_NORMALS, 1, true},
    {CASE_CURVILINEAR, TC_F32, TC_METHOD_TETRA, CASE_BLANKED | CASE_NORMALS, 1, false},
    {CASE_CURVILINEAR, TC_F64, TC_METHOD_TETRA, CASE_NORMALS, 0, false},
    {CASE_CURVILINEAR, TC_U8, TC_METHOD_HYBRID, 0, 0, false},
    {CASE_CURVILINEAR, TC_F32, TC_METHOD_SNAP, CASE_MISSING | CASE_NORMALS, 1, false},
    {CASE_UNIFORM, TC_U8, TC_METHOD_TETRA, CASE_CLOSED, 2, true},
    {CASE_UNIFORM, TC_F32, TC_METHOD_TETRA, CASE_CLOSED | CASE_DEEP | CASE_MISSING | CASE_NORMALS, 1, false},
    {CASE_UNIFORM, TC_I32, TC_METHOD_TETRA, CASE_CLOSED | CASE_BLANKED, 0, false},
    {CASE_UNIFORM, TC_F64, TC_METHOD_HYBRID, CASE_CLOSED, 0, false},
    {CASE_UNIFORM, TC_U16, TC_METHOD_HYBRID, CASE_CLOSED | CASE_MISSING, 1, false},
    {CASE_RECTILINEAR, TC_F32, TC_METHOD_SNAP, CASE_CLOSED | CASE_NORMALS, 0, false},
    {CASE_CURVILINEAR, TC_F32, TC_METHOD_SNAP, CASE_CLOSED | CASE_MISSING | CASE_NORMALS, 1, false},
    {CASE_UNIFORM, TC_U8, TC_METHOD_TETRA, CASE_LABELS, 3, true},
    {CASE_UNIFORM, TC_U16, TC_METHOD_TETRA, CASE_LABELS | CASE_CLOSED, 0, false},
    {CASE_UNIFORM, TC_I16, TC_METHOD_TETRA, CASE_LABELS | CASE_MISSING, 1, false},
    {CASE_UNIFORM, TC_U8, TC_METHOD_TETRA, CASE_LABELS | CASE_DEEP, 2, false},
    {CASE_RECTILINEAR, TC_U32, TC_METHOD_TETRA, CASE_LABELS, 0, false},
    {CASE_CURVILINEAR, TC_I32, TC_METHOD_TETRA, CASE_LABELS | CASE_BLANKED, 0, false},
    {CASE_UNIFORM, TC_U8, TC_METHOD_TETRA, CASE_INTERVAL, 1, true},
    {CASE_UNIFORM, TC_F32, TC_METHOD_TETRA, CASE_INTERVAL | CASE_MISSING, 0, false},
    {CASE_UNIFORM, TC_F64, TC_METHOD_TETRA, CASE_INTERVAL, 0, false},
    {CASE_UNIFORM, TC_U8, TC_METHOD_TETRA, CASE_INTERVAL | CASE_DEEP, 0, false},
    {CASE_RECTILINEAR, TC_I16, TC_METHOD_TETRA, CASE_INTERVAL, 0, false},
    {CASE_CURVILINEAR, TC_F32, TC_METHOD_TETRA, CASE_INTERVAL | CASE_BLANKED, 0, false},
    {CASE_COMPLEX, TC_U8, TC_METHOD_TETRA, 0, 3, false},
    {CASE_COMPLEX, TC_I8, TC_METHOD_TETRA, 0, 0, false},
    {CASE_COMPLEX, TC_U16, TC_METHOD_TETRA, 0, 0, false},
    {CASE_COMPLEX, TC_I16, TC_METHOD_TETRA, 0, 0, false},
    {CASE_COMPLEX, TC_U32, TC_METHOD_TETRA, 0, 0, false},
    {CASE_COMPLEX, TC_I32, TC_METHOD_TETRA, 0, 0, false},
    {CASE_COMPLEX, TC_F32, TC_METHOD_TETRA, CASE_MISSING, 3, true},
    {CASE_COMPLEX, TC_F64, TC_METHOD_TETRA, CASE_MISSING, 1, false},
    {CASE_COMPLEX, TC_U8, TC_METHOD_HYBRID, 0, 3, true},
    {CASE_COMPLEX, TC_I8, TC_METHOD_HYBRID, 0, 0, false},
    {CASE_COMPLEX, TC_U16, TC_METHOD_HYBRID, 0, 0, false},
    {CASE_COMPLEX, TC_I16, TC_METHOD_HYBRID, 0, 0, false},
    {CASE_COMPLEX, TC_U32, TC_METHOD_HYBRID, 0, 0, false},
    {CASE_COMPLEX, TC_I32, TC_METHOD_HYBRID, 0, 0, false},
    {CASE_COMPLEX, TC_F32, TC_METHOD_HYBRID, CASE_MISSING, 3, false},
    {CASE_COMPLEX, TC_F64, TC_METHOD_HYBRID, CASE_MISSING, 1, false},
    {CASE_COMPLEX, TC_U8, TC_METHOD_TETRA, CASE_CLOSED, 3, false},
    {CASE_COMPLEX, TC_F64, TC_METHOD_TETRA, CASE_CLOSED | CASE_MISSING, 1, false},
    {CASE_COMPLEX, TC_I16, TC_METHOD_HYBRID, CASE_CLOSED, 1, false},
    {CASE_COMPLEX, TC_F32, TC_METHOD_HYBRID, CASE_CLOSED | CASE_MISSING, 3, false},
};

const int case_count = sizeof cases / sizeof *cases;

const char *case_name(const bytes_case *c) {
    static const char *const kinds[] = {"uniform", "rectilinear", "curvilinear", "complex"};
    static char name[120];
    const bool named = c->method != TC_METHOD_TETRA;
    snprintf(name, sizeof name, "%s %s%s%s%s%s%s%s%s%s%s%s", tc_type_name(c->type), kinds[c->kind],
             c->flags & CASE_LABELS ? " labels" : "", c->flags & CASE_INTERVAL ? " interval" : "",
             c->flags & CASE_DEEP ? ", deep" : "", c->flags & CASE_MISSING ? ", missing" : "",
             c->flags & CASE_BLANKED ? ", blanked" : "", c->flags & CASE_EXTREMES ? ", extremes" : "",
             c->flags & CASE_NORMALS ? ", normals" : "", c->flags & CASE_CLOSED ? ", closed" : "", named ? ", " : "",
             named ? tc_method_name(c->method) : "");
    return name;
}

static void *memory_get(size_t bytes) {
    void *memory = calloc(bytes, 1);
    if (memory) return memory;
    printf("no memory\n");
    exit(EXIT_FAILURE);
}

/* --------------------------------------------------------------------------------------------------------- samples */

enum { ISOVALUE = 63, NODATA = 77, LABELS_MOST = 6 };

/* Some broad regions, specks of other labels in them; in some layers one label alone. */
static double label_value(const bytes_case *c, double x, double y, double z) {
    if (c->flags & CASE_MISSING && random_below(90) == 0) return NODATA;
    if (c->flags & CASE_DEEP && x > 30) return 2;
    if (z > 15 && z < 24) return 1;
    if (random_below(40) == 0) return (double)random_below(LABELS_MOST);
    return floor(fmax(0, 2.5 + 2 * sin(0.31 * x) * cos(0.57 * y) + 1.5 * sin(0.45 * z)));
}

static double extreme(tc_type type) {
    for (;;) {
        uint64_t bits = random_u64();
        double wide;
        float narrow;
        memcpy(&wide, &bits, sizeof wide);
        memcpy(&narrow, &bits, sizeof narrow);
        if (type == TC_F64 ? isfinite(wide) : isfinite(narrow)) return type == TC_F64 ? wide : (double)narrow;
    }
}

/* Waves around the isovalue, in whole numbers, so that many samples equal it; calm in some layers, so that bricks
 * are skipped. Floating types have fractions as well. */
static double sample_value(const bytes_case *c, double x, double y, double z) {
    double wave = sin(0.31 * x) * cos(0.57 * y) + sin(0.45 * z + 0.1 * x), value;
    if (c->flags & CASE_LABELS) return label_value(c, x, y, z);
    if (c->flags & CASE_EXTREMES) return extreme(c->type);
    if (c->flags & CASE_MISSING && type_is_floating(c->type) && random_below(90) == 0) return (double)NAN;
    if (c->flags & CASE_DEEP) wave = 0.2 * (x - 30) + 0.5 * wave;
    value = floor(fmin(126, fmax(0, ISOVALUE + 30 * wave + random_between(-4, 4))));
    if (z > 15 && z < 24) value = ISOVALUE + 20;
    return type_is_floating(c->type) && random_below(4) ? value + 0.01 * random_between(-1, 1) : value;
}

static void how_fill(const bytes_case *c, case_data *data) {
    tc_extract_options *how = &data->how;
    tc_extract_options_init(how);
    how->isovalue = c->flags & CASE_EXTREMES ? 1e-3 : ISOVALUE;
    how->normals = c->flags & CASE_NORMALS ? 1 : 0;
    how->method = c->method;
    how->closed = c->flags & CASE_CLOSED ? 1 : 0;
    tc_labels_options_init(&data->labels);
    data->labels.closed = how->closed;
    if (c->kind != CASE_UNIFORM) data->labels.smoothing = 0;
    tc_interval_volume_options_init(&data->interval);
    data->interval.low = how->isovalue;
    data->interval.high = how->isovalue + 7.5;
}

/* ----------------------------------------------------------------------------------------------------------- grids */

static void axes_fill(case_data *data) {
    for (int axis = 0; axis < 3; axis++) {
        double at = random_between(-50, 50);
        data->axes[axis] = memory_get((size_t)data->grid.dims[axis] * sizeof(float));
        for (int64_t n = 0; n < data->grid.dims[axis]; n++)
            data->axes[axis][n] = (float)(at += (axis == 1 ? -1 : 1) * random_between(0.01, 2));
        data->grid.axes[axis] = data->axes[axis];
    }
}

static void point_fill(float *point, double x, double y, double z) {
    point[0] = (float)(1.5 * x + 0.4 * sin(0.5 * y) + 0.2 * z + random_between(-0.1, 0.1));
    point[1] = (float)(y + 0.3 * sin(0.4 * z + 0.2 * x));
    point[2] = (float)(0.7 * z + 0.02 * x * y - 20);
}

/* Label maps have samples that are blanked, not cells. */
static void blanks_fill(case_data *data, int64_t count, int64_t cell_count, bool has_cells) {
    data->blanked_samples = memory_get((size_t)count);
    data->blanked_cells = memory_get((size_t)cell_count);
    for (int64_t n = 0; n < count; n++) data->blanked_samples[n] = random_below(50) == 0;
    for (int64_t n = 0; n < cell_count; n++) data->blanked_cells[n] = random_below(50) == 0;
    data->grid.blanked_samples = data->blanked_samples;
    if (has_cells) data->grid.blanked_cells = data->blanked_cells;
}

static void grid_fill(const bytes_case *c, bool small, case_data *data) {
    static const double matrix[3][4] = {{0.5, 0.1, 0, 7}, {0, -1.25, 0.3, -3}, {0.2, 0, 4, 100}};
    /* usual, deep, deep for windows of more layers; each large and small */
    const int64_t dims[3][2][3] = {
        {{70, 19, 26}, {66, 9, 5}}, {{67, 46, 97}, {64, 32, 145}}, {{67, 92, 297}, {64, 32, 145}}};
    const int depth = !(c->flags & CASE_DEEP) ? 0 : c->method != TC_METHOD_SNAP ? 1 : 2;
    tc_grid_options *g = &data->grid;
    tc_grid_options_init(g);
    memcpy(g->dims, dims[depth][small], sizeof g->dims);
    const int64_t *d = g->dims, count = d[0] * d[1] * d[2];
    memcpy(g->matrix, matrix, sizeof matrix);
    for (int axis = 0; axis < 3; axis++) g->first_index[axis] = 4 * axis - 5;
    g->type = c->type;
    g->samples = data->samples = memory_get((size_t)count * tc_type_bytes(c->type));
    g->has_nodata = c->flags & CASE_MISSING ? 1 : 0;
    g->nodata = NODATA;
    if (c->kind == CASE_CURVILINEAR) g->points = data->points = memory_get(3 * (size_t)count * sizeof(float));
    if (c->kind == CASE_RECTILINEAR) axes_fill(data);
    for (int64_t n = 0; n < count; n++) {
        double x = (double)(n % d[0]), y = (double)(n / d[0] % d[1]), z = (double)(n / d[0] / d[1]);
        sample_set(data->samples, c->type, n, sample_value(c, x, y, z));
        if (data->points) point_fill(data->points + 3 * n, x, y, z);
    }
    if (c->flags & CASE_BLANKED)
        blanks_fill(data, count, (d[0] - 1) * (d[1] - 1) * (d[2] - 1), !(c->flags & CASE_LABELS));
}

/* ------------------------------------------------------------------------------------------------------- complexes */

static void complex_fill(const bytes_case *c, bool small, case_data *data) {
    data->list = mixed_block_make(small ? 3 : 9, random_u64());
    data->cells = cell_list_view(&data->list);
    const cell_list list = data->list;
    tc_tetrahedra_grid_options *o = &data->complex;
    data->split.struct_size = sizeof data->split;
    if (tc_tetrahedralize(&data->cells, &data->split)) {
        printf("cells are not cut: %s\n", tc_message());
        exit(EXIT_FAILURE);
    }
    tc_tetrahedra_grid_options_init(o);
    o->point_count = list.point_count;
    o->points = list.points;
    o->type = c->type;
    o->samples = data->samples = memory_get((size_t)list.point_count * tc_type_bytes(c->type));
    o->tetrahedron_count = data->split.tetrahedron_count;
    o->tetrahedra = data->split.tetrahedra;
    if (c->method == TC_METHOD_HYBRID) o->source = &data->cells, o->cells = data->split.cells;
    for (uint64_t n = 0; n < list.point_count; n++) {
        const float *p = list.points + 3 * n;
        sample_set(data->samples, c->type, (int64_t)n,
                   sample_value(c, 5 * (double)p[0], 3 * (double)p[1], (double)p[2]));
    }
}

void case_fill(const bytes_case *c, bool small, case_data *data) {
    *data = (case_data){0};
    random_state = 1996 + 16 * (uint64_t)c->type + (uint64_t)c->kind;
    how_fill(c, data);
    if (c->kind == CASE_COMPLEX)
        complex_fill(c, small, data);
    else
        grid_fill(c, small, data);
}

void case_free(case_data *data) {
    tc_tetrahedra_release(&data->split);
    cell_list_free(&data->list);
    free(data->points);
    free(data->samples);
    for (int axis = 0; axis < 3; axis++) free(data->axes[axis]);
    free(data->blanked_samples);
    free(data->blanked_cells);
}
