#include "coarse.h"

#include "cell_sizes.h"
#include "exit_status.h"
#include "failure.h"
#include "notice.h"
#include "report.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

enum { STEPS_FINE = 128 }; /* across a cell: fewer show */

/* Where coordinates count from: a point, or NULL for each block's own origin; and how many binary digits they have. */
typedef struct numbers {
    const double *zero;
    int digits;
} numbers;

/* The distance from a number of so many digits to the next. */
static double step_at(double value, int digits) {
    int exponent;
    frexp(value, &exponent);
    return ldexp(1, exponent - digits);
}

/* How far coordinates of a block's cells are from where they count from, at most. */
static void find_reach(const cell_range *cells, const double *zero, double reach[3]) {
    for (int axis = 0; axis < 3; axis++)
        reach[axis] = fmax(fabs(cells->low[axis] - zero[axis]), fabs(cells->high[axis] - zero[axis]));
}

/* Whether some vertex may lie where a cell has few steps: looks at cells, at all of them or at some. */
static int may_be_coarse(const coarse_surface *s, numbers n, int all) {
    for (int k = 0; k < s->engine->block_count; k++) {
        cell_range cells;
        double reach[3];
        if (!s->engine->parts[k].vertex_count) continue;
        cell_range_find(&s->blocks->blocks[k], all, &cells);
        find_reach(&cells, n.zero ? n.zero : s->engine->parts[k].origin, reach);
        for (int axis = 0; axis < 3; axis++)
            if (cells.least[axis] < STEPS_FINE * step_at(reach[axis], n.digits)) return 1;
    }
    return 0;
}

/* The sizes of the cells at every vertex of the mesh, from malloc; *sizes NULL where it fails. */
static int carry_sizes(const coarse_surface *s, float **sizes) {
    const int count = s->engine->block_count;
    dataset_field *fields = calloc((size_t)count + 1, sizeof *fields);
    int status = fields ? 0 : fail(STATUS_FAILED, "out of memory for %d blocks", count);
    *sizes = NULL;
    for (int n = 0; n < count && !status; n++) {
        fields[n] = (dataset_field){.name = "cell sizes", .components = 3, .type = TC_F32};
        if (!s->engine->parts[n].vertex_count) continue;
        fields[n].values = cell_sizes(&s->blocks->blocks[n]);
        if (!fields[n].values) status = STATUS_FAILED;
    }
    if (!status && !(*sizes = malloc((size_t)(3 * s->mesh->vertex_count + 1) * sizeof **sizes)))
        status = fail(STATUS_FAILED, "out of memory for the sizes of cells at the surface");
    if (!status) status = engine_carry(s->engine, s->how, &(point_field){.components = 3, .blocks = fields}, *sizes);
    for (int n = 0; n < count && fields; n++) free((void *)fields[n].values);
    free(fields);
    if (!status) return 0;
    free(*sizes);
    *sizes = NULL;
    return status;
}

/* Vertices where cells have few steps; step and size are those where the steps are fewest. */
typedef struct coarse_count {
    uint64_t coarse, least; /* below STEPS_FINE, COARSE_STEPS_LEAST */
    double step, size;
} coarse_count;

static void add_vertex(coarse_count *c, const float *position, const double *offset, const float *sizes, int digits) {
    int is_coarse = 0, is_least = 0;
    for (int axis = 0; axis < 3; axis++) {
        const double size = (double)sizes[axis], step = step_at((double)position[axis] + offset[axis], digits);
        if (!(size > 0) || !(size < STEPS_FINE * step)) continue;
        is_coarse = 1;
        is_least = is_least || size < COARSE_STEPS_LEAST * step;
        if (c->size > 0 && size / step >= c->size / c->step) continue;
        c->size = size;
        c->step = step;
    }
    c->coarse += (uint64_t)is_coarse;
    c->least += (uint64_t)is_least;
}

static int count_coarse(const coarse_surface *s, numbers how, int all, coarse_count *out) {
    float *sizes;
    uint64_t v = 0;
    *out = (coarse_count){0};
    if (!may_be_coarse(s, how, all)) return 0;
    int status = carry_sizes(s, &sizes);
    for (int n = 0; n < s->engine->block_count && !status; n++) {
        const mesh_part *part = &s->engine->parts[n];
        double offset[3] = {0, 0, 0};
        for (int axis = 0; axis < 3 && how.zero; axis++) offset[axis] = part->origin[axis] - how.zero[axis];
        for (uint64_t end = v + part->vertex_count; v < end; v++)
            add_vertex(out, s->mesh->positions + 3 * v, offset, sizes + 3 * v, how.digits);
    }
    free(sizes);
    return status;
}

int coarse_tell_mesh(const coarse_surface *s, int check, uint64_t *coarse_vertices) {
    coarse_count found;
    *coarse_vertices = 0;
    if (!s->mesh->vertex_count || (!notice_wanted() && !check)) return 0;
    int status = count_coarse(s, (numbers){NULL, FLT_MANT_DIG}, check, &found);
    *coarse_vertices = found.least;
    if (!status && found.coarse)
        notice("isovalue %s: at %" PRIu64 " of %" PRIu64
               " vertices float32 is coarse: it has steps of %.2g where cells "
               "are %.2g wide; parts that lie far from each other are finer from files of their own",
               s->iso->text, found.coarse, s->mesh->vertex_count, found.step, found.size);
    return status;
}

int coarse_check_file(const coarse_surface *s, const double zero[3], int digits) {
    coarse_count found;
    for (int n = 0; n < s->engine->block_count && digits < DBL_MANT_DIG; n++) {
        cell_range cells;
        double reach[3];
        if (!s->engine->parts[n].vertex_count) continue;
        cell_range_find(&s->blocks->blocks[n], 0, &cells);
        find_reach(&cells, zero, reach);
        for (int axis = 0; axis < 3; axis++)
            if (reach[axis] > FLT_MAX)
                return fail(STATUS_USAGE,
                            "--origin-at: the surface is %.3g away from that point, beyond float32, which STL holds",
                            reach[axis]);
    }
    if (!notice_wanted()) return 0;
    int status = count_coarse(s, (numbers){zero, digits}, 0, &found);
    if (status || !found.coarse) return status;
    const double *origin = s->mesh->origin;
    if (engine_origins_differ(s->engine))
        notice(
            "isovalue %s: blocks lie so far from each other that the file's numbers have steps of %.2g where cells are "
            "%.2g wide: shapes are lost; --blocks separate keeps them, without --origin-at or with that of one block",
            s->iso->text, found.step, found.size);
    else
        notice("isovalue %s: --origin-at lies so far from the surface that the file's numbers have steps of %.2g where "
               "cells are %.2g wide: shapes are lost; choose a point near %s,%s,%s",
               s->iso->text, found.step, found.size, shortest_number(origin[0]).text, shortest_number(origin[1]).text,
               shortest_number(origin[2]).text);
    return 0;
}
