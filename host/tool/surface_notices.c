#include "surface_notices.h"

#include "exit_status.h"
#include "failure.h"
#include "input.h"
#include "notice.h"
#include "statistics.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* -------------------------------------------------------------------------------------------------------- isovalue */

void surface_tell_isovalue(const typed_isovalue *iso) {
    char taken[400]; /* the digits of any double */
    const char *text = iso->text + (*iso->text == '-' || *iso->text == '+');
    if (text[strspn(text, "0123456789")]) return;
    text += strspn(text, "0");
    snprintf(taken, sizeof taken, "%.0f", fabs(iso->value));
    if (strcmp(*text ? text : "0", taken) != 0)
        notice("isovalue %s is taken as %s%s, the nearest double", iso->text, iso->value < 0 ? "-" : "", taken);
}

/* ----------------------------------------------------------------------------------------------------------- empty */

static void tell_empty(const surface_report *s, int has_range, const double range[2]) {
    const char *iso = s->iso->text;
    const number_text least = shortest_number(range[0]), most = shortest_number(range[1]);
    if (!has_range)
        notice("isovalue %s: the surface is empty: every sample is missing", iso);
    else if (range[0] == range[1])
        notice("isovalue %s: the surface is empty: the field is constant, every sample is %s", iso, least.text);
    else if (s->iso->value > range[1] || s->iso->value < range[0])
        notice("isovalue %s is outside the range of the samples, %s to %s: the surface is empty", iso, least.text,
               most.text);
    else if (s->iso->value == range[0])
        notice("isovalue %s is the least sample, none lies below it: the surface is empty; the range is %s to %s", iso,
               least.text, most.text);
    else
        notice("isovalue %s: the surface is empty: no cell has samples on both sides and none missing; the range is "
               "%s to %s",
               iso, least.text, most.text);
}

int surface_tell_empty(const dataset *d, const scalar *field, const surface_report *s) {
    if (s->triangle_count || !notice_wanted()) return 0;
    double range[2];
    sample_array *arrays = input_samples(d, field);
    if (!arrays) return STATUS_FAILED;
    tell_empty(s, statistics_extent(arrays, d->block_count, range), range);
    free(arrays);
    return 0;
}

/* --------------------------------------------------------------------------------------------------------- zero area
 */

static int is_integer(tc_type type) { return type != TC_F32 && type != TC_F64; }

/* Samples that equal the isovalue as it is interpolated with: in float for types that a float holds. */
static int count_ties(const dataset *d, const scalar *field, double isovalue, uint64_t *ties) {
    sample_array *arrays = input_samples(d, field);
    if (!arrays) return STATUS_FAILED;
    *ties = statistics_count_equal(arrays, d->block_count, isovalue);
    if (field->blocks->type == TC_F32 && (double)(float)isovalue != isovalue)
        *ties += statistics_count_equal(arrays, d->block_count, (double)(float)isovalue);
    free(arrays);
    return 0;
}

static void tell_zero_area(const scalar *field, const surface_report *s, uint64_t ties) {
    const int has_half = is_integer(field->blocks->type) && s->iso->value == floor(s->iso->value);
    const uint64_t degenerate = s->summary.degenerate_triangles;
    if (ties)
        notice("isovalue %s: %" PRIu64 " of %" PRIu64 " triangles have no area, as samples equal the isovalue: choose "
               "a value between those of the samples%s%s, or remove them by --drop-degenerate",
               s->iso->text, degenerate, s->triangle_count, has_half ? ", as " : "",
               has_half ? shortest_number(s->iso->value - 0.5).text : "");
    else
        notice("isovalue %s: %" PRIu64 " of %" PRIu64 " triangles have no area, though no sample equals the isovalue: "
               "cells may be flat; --drop-degenerate removes such triangles",
               s->iso->text, degenerate, s->triangle_count);
}

/* ---------------------------------------------------------------------------------------------------------- collapse
 */

static int compare_places(const void *a, const void *b) { return memcmp(a, b, 3 * sizeof(float)); }

/* A position that two corners of the triangle share; NULL where its corners are apart. */
static const float *shared_place(const tc_mesh_data *m, const uint32_t *corners) {
    const float *p[3];
    for (int c = 0; c < 3; c++) p[c] = m->positions + 3 * (uint64_t)corners[c];
    for (int c = 0; c < 3; c++) {
        const float *a = p[c], *b = p[(c + 1) % 3];
        if (a[0] == b[0] && a[1] == b[1] && a[2] == b[2]) return a;
    }
    return NULL;
}

/* Different positions at which triangles have two corners or three. */
static int count_places(const tc_mesh_data *m, uint64_t degenerate, uint64_t *places) {
    float(*found)[3] = malloc((size_t)(degenerate + 1) * sizeof *found);
    uint64_t count = 0;
    if (!found) return fail(STATUS_FAILED, "out of memory for %" PRIu64 " triangles of zero area", degenerate);
    for (uint64_t t = 0; t < m->triangle_count && count < degenerate; t++) {
        const float *place = shared_place(m, m->triangles + 3 * t);
        if (place) memcpy(found[count++], place, sizeof *found);
    }
    qsort(found, (size_t)count, sizeof *found, compare_places);
    *places = count > 0;
    for (uint64_t n = 1; n < count; n++) *places += memcmp(found[n - 1], found[n], sizeof *found) != 0;
    free(found);
    return 0;
}

/* Whether steps of float32 are so large beside the cells that positions on an edge may be few. Of grids with points the
 * size of cells is not known here. */
static int is_coarse(const dataset_block *b, const surface_report *s) {
    enum { STEPS = 1024 }; /* along an edge: fewer are coarse */
    double step = 0, least = INFINITY;
    if (b->kind == GRID_CURVILINEAR || b->kind == GRID_UNSTRUCTURED) return 1;
    for (int axis = 0; axis < 3; axis++) {
        for (int end = 0; end < 2; end++)
            step = fmax(step, fabs(s->summary.bounds[end][axis] - s->origin[axis]) * 0x1p-23);
        if ((double)b->dims[axis] * 0x1p-23 * STEPS > 1) return 1;
        for (int64_t n = 1; b->kind == GRID_RECTILINEAR && n < b->dims[axis]; n++)
            least = fmin(least, fabs(coordinate_at(b->axes[axis], n) - coordinate_at(b->axes[axis], n - 1)));
        if (b->kind == GRID_UNIFORM)
            least = fmin(least, hypot(hypot(b->matrix[0][axis], b->matrix[1][axis]), b->matrix[2][axis]));
    }
    return step * STEPS > least;
}

static int may_collapse(const dataset *d, const surface_report *s) {
    for (int n = 0; n < d->block_count; n++)
        if (is_coarse(&d->blocks[n], s)) return 1;
    return 0;
}

int surface_tell_degenerate(const dataset *d, const scalar *field, const tc_mesh_data *m, const surface_report *s) {
    enum {
        SOME = 100,
        MANY = 5,
        NEAR_TIES = 1000
    }; /* a hundredth and a fifth of the triangles; of vertices: as many
          come from samples next to the isovalue */
    const uint64_t degenerate = s->summary.degenerate_triangles;
    const int is_many = degenerate > s->triangle_count / MANY;
    uint64_t ties = 0, places = 0;
    if (!notice_wanted() || degenerate <= s->triangle_count / SOME) return 0;
    const int look = may_collapse(d, s);
    if (!look && !is_many) return 0;
    int status = count_ties(d, field, s->iso->value, &ties);
    if (!status && (look || !ties)) status = count_places(m, degenerate, &places);
    if (status) return status;
    if (places > ties + s->vertex_count / NEAR_TIES)
        notice("isovalue %s: vertices coincide at %" PRIu64 " points where no sample equals the isovalue: float32 does "
               "not tell such coordinates apart; give coordinates nearer to zero, or larger cells",
               s->iso->text, places - ties);
    else if (is_many)
        tell_zero_area(field, s, ties);
    return 0;
}
