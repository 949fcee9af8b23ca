#include "precision.h"

#include "exit_status.h"
#include "failure.h"
#include "input/cell_sizes.h"
#include "shortest.h"
#include "terminal/notice.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

enum { STEPS_FINE = 128 }; /* across a cell: fewer show */

/* The point that the coordinates of a block count from: the one given, or NULL for its own origin. */
static coordinate_numbers numbers_of(const surface_source *s, int block, const double *zero, int digits) {
    const double *from = zero ? zero : s->engine->parts[block].origin;
    return (coordinate_numbers){.zero = {from[0], from[1], from[2]}, .digits = digits};
}

/* The largest coordinate of a block's cells along an axis. */
static double reach_of(const cell_range *cells, const coordinate_numbers *numbers, int axis) {
    return fmax(fabs(cells->low[axis] - numbers->zero[axis]), fabs(cells->high[axis] - numbers->zero[axis]));
}

/* Whether some vertex may lie in a cell of few steps. Looks at all cells, or at some thousands. */
static int may_be_coarse(const surface_source *s, const double *zero, int digits, int all) {
    for (int n = s->range.first; n < s->range.first + s->range.count; n++) {
        const coordinate_numbers numbers = numbers_of(s, n, zero, digits);
        cell_range cells;
        double step = 0;
        if (!s->engine->parts[n].vertex_count) continue;
        cell_range_find(&s->blocks->blocks[n], all, &cells);
        for (int axis = 0; axis < 3; axis++) step += step_at(reach_of(&cells, &numbers, axis), digits);
        if (cells.thickness < STEPS_FINE * step) return 1;
    }
    return 0;
}

/* How many steps cells are thick at every vertex of the mesh, from malloc; *steps NULL where it fails. */
static int carry_steps(const surface_source *s, const double *zero, int digits, float **steps) {
    const int count = s->engine->block_count;
    dataset_field *fields = calloc((size_t)count + 1, sizeof *fields);
    int status = fields ? 0 : fail(STATUS_FAILED, "out of memory for %d blocks", count);
    *steps = NULL;
    for (int n = s->range.first; n < s->range.first + s->range.count && !status; n++) {
        const coordinate_numbers numbers = numbers_of(s, n, zero, digits);
        fields[n] = (dataset_field){.name = "steps", .components = 1, .type = TC_F32};
        if (!s->engine->parts[n].vertex_count) continue;
        fields[n].values = cell_steps(&s->blocks->blocks[n], &numbers);
        if (!fields[n].values) status = STATUS_FAILED;
    }
    if (!status && !(*steps = malloc((size_t)(s->mesh->vertex_count + 1) * sizeof **steps)))
        status = fail(STATUS_FAILED, "out of memory for the sizes of cells at the surface");
    if (!status)
        status = engine_carry(s->engine, s->range, s->how, &(point_field){.components = 1, .blocks = fields}, *steps);
    for (int n = 0; n < count && fields; n++) free((void *)fields[n].values);
    free(fields);
    if (!status) return 0;
    free(*steps);
    *steps = NULL;
    return status;
}

static int count_coarse(const surface_source *s, const double *zero, int digits, int all, coarse_count *sum) {
    float *steps;
    sum->vertices += s->mesh->vertex_count;
    if (!s->mesh->vertex_count || !may_be_coarse(s, zero, digits, all)) return 0;
    int status = carry_steps(s, zero, digits, &steps);
    for (uint64_t v = 0; v < s->mesh->vertex_count && !status; v++) {
        if (!(steps[v] > 0) || steps[v] >= STEPS_FINE) continue;
        sum->fewest = sum->coarse ? fmin(sum->fewest, (double)steps[v]) : (double)steps[v];
        sum->coarse++;
        sum->lost += steps[v] < COARSE_STEPS_LEAST;
    }
    free(steps);
    return status;
}

int precision_count_mesh(const surface_source *s, int check, coarse_count *sum) {
    return notice_wanted() || check ? count_coarse(s, NULL, FLT_MANT_DIG, check, sum) : 0;
}

/* Fails where coordinates are beyond float32. */
static int check_reach(const surface_source *s, const double *zero) {
    for (int n = s->range.first; n < s->range.first + s->range.count; n++) {
        const coordinate_numbers numbers = numbers_of(s, n, zero, FLT_MANT_DIG);
        cell_range cells;
        if (!s->engine->parts[n].vertex_count) continue;
        cell_range_find(&s->blocks->blocks[n], 0, &cells);
        for (int axis = 0; axis < 3; axis++)
            if (reach_of(&cells, &numbers, axis) > (double)FLT_MAX)
                return fail(
                    STATUS_USAGE,
                    "--origin-at: the surface is %.3g away from that point, beyond float32, which the file holds",
                    reach_of(&cells, &numbers, axis));
    }
    return 0;
}

int precision_count_file(const surface_source *s, const double zero[3], int digits, int check, coarse_count *sum) {
    int status = digits == FLT_MANT_DIG ? check_reach(s, zero) : 0;
    if (status || (!notice_wanted() && !check)) return status;
    return count_coarse(s, zero, digits, check, sum);
}

void precision_tell_mesh(const surface_report *s) {
    const coarse_count *found = &s->coarse_in_mesh;
    if (found->coarse)
        notice("isovalue %s: float32 is coarse at %" PRIu64 " of %" PRIu64
               " vertices: cells are as thin as %.2g of its "
               "steps there; parts of the input that lie far from its middle are finer in files of their own",
               s->iso->text, found->coarse, found->vertices, found->fewest);
}

void precision_tell_file(const surface_report *s, int is_chosen) {
    const coarse_count *found = &s->coarse_in_file;
    if (!found->coarse) return;
    if (!s->has_origin)
        notice("isovalue %s: blocks lie so far from each other that cells are as thin as %.2g steps of the file's "
               "numbers: shapes are lost; --blocks separate keeps them, without --origin-at or with that of one block",
               s->iso->text, found->fewest);
    else
        notice(is_chosen ? "isovalue %s: --origin-at lies so far from the surface that cells are as thin as %.2g steps "
                           "of the file's numbers: shapes are lost; choose a point near %s,%s,%s"
                         : "isovalue %s: the surface lies so far from zero that cells are as thin as %.2g steps of the "
                           "file's numbers: shapes are lost; --origin-at %s,%s,%s keeps them",
               s->iso->text, found->fewest, shortest_number(s->origin[0]).text, shortest_number(s->origin[1]).text,
               shortest_number(s->origin[2]).text);
}
