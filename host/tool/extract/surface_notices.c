#include "surface_notices.h"

#include "exit_status.h"
#include "failure.h"
#include "input/input.h"
#include "input/statistics.h"
#include "sample_types.h"
#include "shortest.h"
#include "terminal/notice.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
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

/* -------------------------------------------------------------------------------------------------------- zero area */

/* Samples that equal the isovalue, or of f32 samples the float that it is rounded to when vertices are interpolated. */
static int count_ties(const dataset *d, const scalar *field, double isovalue, uint64_t *ties) {
    sample_array *arrays = input_samples(d, field);
    if (!arrays) return STATUS_FAILED;
    *ties = statistics_count_equal(arrays, d->block_count, isovalue);
    if (field->blocks->type == TC_F32 && (double)(float)isovalue != isovalue)
        *ties += statistics_count_equal(arrays, d->block_count, (double)(float)isovalue);
    free(arrays);
    return 0;
}

/* Whether some sample is so far from the isovalue that the vertices beside it fall onto other samples. */
static int has_far_sample(const double range[2], double isovalue) {
    const double near = fmax(fabs(isovalue), fmin(range[1] - isovalue, isovalue - range[0]));
    return range[1] - range[0] > 0x1p20 * near;
}

static int tell_zero_area(const dataset *d, const scalar *field, const surface_report *s, uint64_t ties) {
    const int has_half = !type_is_real(field->blocks->type) && s->iso->value == floor(s->iso->value);
    const uint64_t degenerate = s->summary.degenerate_triangles;
    double range[2];
    sample_array *arrays = input_samples(d, field);
    if (!arrays) return STATUS_FAILED;
    const int has_range = statistics_extent(arrays, d->block_count, range);
    free(arrays);
    if (ties)
        notice("isovalue %s: %" PRIu64 " of %" PRIu64 " triangles have no area, as samples equal the isovalue: choose "
               "a value between those of the samples%s%s, or remove them by --drop-degenerate",
               s->iso->text, degenerate, s->triangle_count, has_half ? ", as " : "",
               has_half ? shortest_number(s->iso->value - 0.5).text : "");
    else if (has_range && has_far_sample(range, s->iso->value))
        notice("isovalue %s: %" PRIu64 " of %" PRIu64
               " triangles have no area: samples lie so far from the isovalue, up "
               "to %s, that the surface falls onto others; --nodata leaves out a value that stands for none",
               s->iso->text, degenerate, s->triangle_count,
               shortest_number(range[1] - s->iso->value > s->iso->value - range[0] ? range[1] : range[0]).text);
    else
        notice("isovalue %s: %" PRIu64 " of %" PRIu64 " triangles have no area, though no sample equals the isovalue: "
               "cells may be flat; --drop-degenerate removes such triangles",
               s->iso->text, degenerate, s->triangle_count);
    return 0;
}

int surface_tell_degenerate(const dataset *d, const scalar *field, const surface_report *s) {
    enum { MANY = 5 }; /* a fifth of the triangles */
    uint64_t ties = 0;
    if (!notice_wanted() || s->coarse_in_mesh.coarse || s->summary.degenerate_triangles <= s->triangle_count / MANY)
        return 0;
    int status = count_ties(d, field, s->iso->value, &ties);
    return status ? status : tell_zero_area(d, field, s, ties);
}

/* --------------------------------------------------------------------------------------------------------- closed */

void surface_tell_closed(const block_list *blocks, const surface_report *s, size_t count) {
    size_t n = 0;
    while (n < count && (!s[n].triangle_count || !s[n].has_mesh)) n++;
    if (n == count || !notice_wanted() || !blocks_have_missing(blocks, !s[n].is_streamed)) return;
    notice(
        "where two present cells meet only along an edge, beside missing ones, a closed surface has four triangles at "
        "that edge: --check counts such edges");
}
