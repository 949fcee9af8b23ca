#include "parse_value.h"

#include "dataset/request.h"
#include "exit_status.h"
#include "failure.h"
#include "picture.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *skip_blanks(const char *at) { return at + strspn(at, " \t"); }

/* A finite number at *at, *at then behind it; 0 where there is none. Blanks are no part of a number. */
static int take_real(const char **at, double *value) {
    if (!**at || isspace((unsigned char)**at)) return 0;
    char *end;
    *value = strtod(*at, &end);
    if (end == *at || !isfinite(*value)) return 0;
    *at = end;
    return 1;
}

static int take_whole(const char **at, uint64_t *value) {
    if (!isdigit((unsigned char)**at)) return 0;
    char *end;
    errno = 0;
    *value = strtoull(*at, &end, 10);
    *at = end;
    return errno == 0;
}

/* Blanks around the number are left out. */
static int append_isovalue(const char *text, size_t length, options *o) {
    typed_isovalue fresh = {0};
    for (; length && strchr(" \t", *text); length--) text++;
    while (length && strchr(" \t", text[length - 1])) length--;
    if (length >= sizeof fresh.text)
        return fail(STATUS_USAGE, "--iso: '%.20s...' is longer than a number needs to be", text);
    memcpy(fresh.text, text, length);
    const char *at = fresh.text;
    if (!take_real(&at, &fresh.value) || *at)
        return fail(STATUS_USAGE, "--iso: '%s' is no finite number; give one, or several with commas, as in 30,127.5",
                    fresh.text);
    typed_isovalue *grown = realloc(o->isovalues, (o->isovalue_count + 1) * sizeof *grown);
    if (!grown) return fail(STATUS_FAILED, "out of memory for the isovalues");
    o->isovalues = grown;
    grown[o->isovalue_count++] = fresh;
    return 0;
}

/* An end of a range, of `length` characters; where there are none, `open`. */
static int take_end(const char *text, size_t length, double open, double *value) {
    char number[48];
    for (; length && strchr(" \t", *text); length--) text++;
    while (length && strchr(" \t", text[length - 1])) length--;
    *value = open;
    if (!length) return 1;
    if (length >= sizeof number) return 0;
    memcpy(number, text, length);
    number[length] = '\0';
    const char *at = number;
    return take_real(&at, value) && !*at;
}

static int append_range(const char *text, options *o) {
    typed_range fresh = {0};
    const char *comma = strchr(text, ',');
    const int is_range = comma && strlen(text) < sizeof fresh.text &&
                         take_end(text, (size_t)(comma - text), -(double)INFINITY, &fresh.low) &&
                         take_end(comma + 1, strlen(comma + 1), (double)INFINITY, &fresh.high);
    if (!is_range || (isinf(fresh.low) && isinf(fresh.high)))
        return fail(STATUS_USAGE,
                    "--range: '%.40s' is not two numbers with a comma between, as in 10,20; one may be left "
                    "out, as in 10, or ,20",
                    text);
    if (!(fresh.low < fresh.high))
        return fail(STATUS_USAGE, "--range: '%s': the first number has to be less than the second", text);
    snprintf(fresh.text, sizeof fresh.text, "%s", text);
    typed_range *grown = realloc(o->ranges, (o->range_count + 1) * sizeof *grown);
    if (!grown) return fail(STATUS_FAILED, "out of memory for the ranges");
    o->ranges = grown;
    grown[o->range_count++] = fresh;
    return 0;
}

static int parse_isovalues(const char *text, options *o) {
    for (;;) {
        size_t length = strcspn(text, ",");
        int status = append_isovalue(text, length, o);
        if (status || !text[length]) return status;
        text += length + 1;
    }
}

static int parse_reals(const option *spec, const char *text, double out[3]) {
    const char *at = text;
    for (int axis = 0; axis < 3; axis++) {
        at = skip_blanks(at);
        int good = take_real(&at, &out[axis]) && (spec->kind != VALUE_SPACING || out[axis] > 0.0);
        at = skip_blanks(at);
        if (!good || *at != (axis < 2 ? ',' : '\0'))
            return fail(STATUS_USAGE, "%s: '%s' is not three finite numbers%s, as in 1,1,2.5", spec->name, text,
                        spec->kind == VALUE_SPACING ? " above 0" : "");
        at++;
    }
    return 0;
}

static int parse_dims(const option *spec, const char *text, int64_t out[3]) {
    const char *at = text;
    for (int axis = 0; axis < 3; axis++) {
        uint64_t count = 0;
        at = skip_blanks(at);
        int good = take_whole(&at, &count) && count > 0 && count <= INT64_MAX;
        at = skip_blanks(at);
        if (!good || *at != (axis < 2 ? ',' : '\0'))
            return fail(STATUS_USAGE, "%s: '%s' is not three whole numbers above 0, as in 256,256,128", spec->name,
                        text);
        out[axis] = (int64_t)count;
        at++;
    }
    return 0;
}

static int take_index(const char **at, int64_t *value) {
    char *end;
    const char *digits = *at + (**at == '-');
    if (!isdigit((unsigned char)*digits)) return 0;
    errno = 0;
    *value = strtoll(*at, &end, 10);
    *at = end;
    return errno == 0;
}

/* Numbers of one range, or its open ends, of which *low and *high then stay as they are. */
static int take_indices(const char **at, int64_t *low, int64_t *high) {
    *at = skip_blanks(*at);
    if (**at != ':' && !take_index(at, low)) return 0;
    if (*(*at)++ != ':') return 0;
    return !**at || strchr(", \t", **at) || take_index(at, high);
}

static int take_reals(const char **at, double *low, double *high) {
    *at = skip_blanks(*at);
    if (**at != ':' && !take_real(at, low)) return 0;
    if (*(*at)++ != ':') return 0;
    if (**at && !strchr(", \t", **at) && !take_real(at, high)) return 0;
    return *low < *high;
}

static int parse_indices(const option *spec, const char *text, index_ranges *out) {
    const char *at = text;
    for (int axis = 0; axis < 3; axis++) {
        out->begin[axis] = INT64_MIN;
        out->end[axis] = INT64_MAX;
        int good = take_indices(&at, &out->begin[axis], &out->end[axis]);
        at = good ? skip_blanks(at) : at;
        if (!good || *at != (axis < 2 ? ',' : '\0'))
            return fail(STATUS_USAGE,
                        "%s: '%s' is not three ranges of indices with commas between, as in 10:60,0:64,:32", spec->name,
                        text);
        at++;
    }
    return 0;
}

static int parse_ranges(const option *spec, const char *text, world_ranges *out) {
    const char *at = text;
    for (int axis = 0; axis < 3; axis++) {
        out->low[axis] = -INFINITY;
        out->high[axis] = INFINITY;
        int good = take_reals(&at, &out->low[axis], &out->high[axis]);
        at = good ? skip_blanks(at) : at;
        if (!good || *at != (axis < 2 ? ',' : '\0'))
            return fail(STATUS_USAGE,
                        "%s: '%s' is not three ranges of coordinates, each from a lower number to a higher one, as in "
                        "-1.5:2,0:10,:3",
                        spec->name, text);
        at++;
    }
    return 0;
}

/* One number, or three. */
static int parse_step(const option *spec, const char *text, int64_t out[3]) {
    uint64_t step[3] = {0};
    const char *at = text;
    int count = 0, good = 1;
    do {
        at = skip_blanks(at + (count > 0));
        good = take_whole(&at, &step[count]) && step[count] > 0 && step[count] <= INT32_MAX;
        at = good ? skip_blanks(at) : at;
        count++;
    } while (good && *at == ',' && count < 3);
    if (!good || *at || count == 2)
        return fail(STATUS_USAGE, "%s: '%s' is not one whole number above 0, nor three, as in 2 or 2,2,1", spec->name,
                    text);
    for (int axis = 0; axis < 3; axis++) out[axis] = (int64_t)step[count == 1 ? 0 : axis];
    return 0;
}

static int parse_piece(const option *spec, const char *text, int64_t out[2]) {
    const char *at = text;
    uint64_t number, count;
    const int good = take_whole(&at, &number) && *at++ == '/' && take_whole(&at, &count) && !*at;
    if (!good || count > INT32_MAX || number >= count)
        return fail(STATUS_USAGE, "%s: '%s' is no part I of N, from 0 to N - 1, as in 0/8 or 7/8", spec->name, text);
    out[0] = (int64_t)number;
    out[1] = (int64_t)count;
    return 0;
}

/* even, cost, or planes with commas between. */
static int parse_cut(const option *spec, const char *text, cut_request *out) {
    const char *at = text;
    size_t count = 1;
    if (strcmp(text, "even") == 0) return 0;
    out->kind = strcmp(text, "cost") == 0 ? CUT_COST : CUT_PLANES;
    if (out->kind == CUT_COST) return 0;
    for (const char *comma = text; (comma = strchr(comma, ',')); comma++) count++;
    if (!(out->planes = calloc(count, sizeof *out->planes))) return fail(STATUS_FAILED, "out of memory for --cut");
    for (out->count = 0; out->count < count; out->count++, at++) {
        uint64_t plane = 0;
        at = skip_blanks(at);
        const int good = take_whole(&at, &plane) && plane <= INT64_MAX;
        at = skip_blanks(at);
        if (!good || *at != (out->count + 1 < count ? ',' : '\0'))
            return fail(STATUS_USAGE, "%s: '%s' is neither even nor cost, nor planes with commas between, as in 40,96",
                        spec->name, text);
        out->planes[out->count] = (int64_t)plane;
    }
    return 0;
}

/* A name, or azimuth and elevation. */
static int parse_view(const option *spec, const char *text, view_angles *out) {
    const char *at = text;
    for (int n = 0; view_name(n); n++) {
        if (strcmp(text, view_name(n)) != 0) continue;
        *out = view_named(n);
        return 0;
    }
    at = skip_blanks(at);
    int good = take_real(&at, &out->azimuth);
    at = skip_blanks(at);
    good = good && *at == ',';
    at = skip_blanks(at + good);
    good = good && take_real(&at, &out->elevation) && !*skip_blanks(at);
    if (good && fabs(out->azimuth) <= 360 && fabs(out->elevation) <= 90) return 0;
    return fail(
        STATUS_USAGE,
        "%s: '%s' is neither iso, front, back, left, right, top or bottom, nor azimuth,elevation in degrees, as "
        "in 30,20, up to 360 and 90",
        spec->name, text);
}

static int parse_pixels(const option *spec, const char *text, int64_t out[2]) {
    const char *at = text;
    for (int n = 0; n < 2; n++) {
        uint64_t count = 0;
        at = skip_blanks(at);
        int good = take_whole(&at, &count) && count >= PICTURE_SIDE_LEAST && count <= PICTURE_SIDE_MOST;
        at = skip_blanks(at);
        if (!good || *at != (n ? '\0' : ','))
            return fail(STATUS_USAGE, "%s: '%s' is not a width and a height of %d to %d pixels, as in 1024,768",
                        spec->name, text, PICTURE_SIDE_LEAST, PICTURE_SIDE_MOST);
        out[n] = (int64_t)count;
        at++;
    }
    return 0;
}

/* Bytes: a whole number, then K, M, G or T, with iB or B after it if one likes. */
static int parse_size(const option *spec, const char *text, uint64_t *out) {
    static const char units[] = "KMGT";
    const char *at = text;
    uint64_t bytes;
    int good = take_whole(&at, &bytes), shift = 0;
    const char *unit = *at ? strchr(units, toupper((unsigned char)*at)) : NULL;
    if (unit) {
        shift = 10 * (int)(unit - units + 1);
        at++;
        if (strcmp(at, "B") == 0 || strcmp(at, "iB") == 0) at = "";
    }
    if (!good || *at || bytes > UINT64_MAX >> shift)
        return fail(STATUS_USAGE, "%s: '%s' is no size; give bytes, or K, M, G, T behind a whole number, as in 512M",
                    spec->name, text);
    if (!bytes && spec->kind == VALUE_BOUND)
        return fail(STATUS_USAGE, "%s: '%s' leaves nothing; leave the option out for no bound", spec->name, text);
    *out = bytes << shift;
    return 0;
}

static int parse_number(const option *spec, const char *text, uint64_t most, uint64_t *out) {
    const char *at = text;
    if (!take_whole(&at, out) || *at || *out > most)
        return most == UINT64_MAX ? fail(STATUS_USAGE, "%s: '%s' is no whole number from 0 on", spec->name, text)
                                  : fail(STATUS_USAGE, "%s: '%s' is no whole number from 0 to %llu", spec->name, text,
                                         (unsigned long long)most);
    return 0;
}

static int parse_labels(const option *spec, const char *text, options *o) {
    const char *at = text;
    if (strcmp(text, "all") == 0) return 0;
    for (;;) {
        uint64_t label = 0;
        at = skip_blanks(at);
        const int good = take_whole(&at, &label) && label > 0 && label <= UINT32_MAX;
        at = skip_blanks(at);
        if (!good || (*at && *at != ','))
            return fail(STATUS_USAGE,
                        "%s: '%s' is neither all nor whole numbers above 0 with commas between, as in 1,4,7",
                        spec->name, text);
        uint32_t *grown = realloc(o->labels, (o->label_count + 1) * sizeof *grown);
        if (!grown) return fail(STATUS_FAILED, "out of memory for the labels");
        o->labels = grown;
        grown[o->label_count++] = (uint32_t)label;
        if (!*at++) return 0;
    }
}

int parse_value(const option *spec, const char *text, options *o) {
    void *value = (char *)o + spec->offset;
    uint64_t number = 0;
    int status;
    switch (spec->kind) {
    case VALUE_NONE:
        *(int *)value = 1;
        return 0;
    case VALUE_TEXT:
    case VALUE_FORMAT:
        if (!*text) return fail(STATUS_USAGE, "%s: the value is empty", spec->name);
        *(const char **)value = text;
        return 0;
    case VALUE_CHOICE:
        return choice_find(spec->name, text, spec->choices, value);
    case VALUE_ISOVALUES:
        return parse_isovalues(text, o);
    case VALUE_INTERVALS:
        return append_range(text, o);
    case VALUE_NODATA:
        o->has_nodata = 1;
        if (take_real(&text, &o->nodata) && !*text) return 0;
        return fail(STATUS_USAGE, "--nodata: give one finite number (NaN and infinities are missing in any case)");
    case VALUE_THRESHOLD:
        if (take_real(&text, value) && !*text && *(double *)value >= 0 && *(double *)value <= 0.5) return 0;
        return fail(STATUS_USAGE, "%s: give one number from 0 to 0.5", spec->name);
    case VALUE_SHARE:
        if (take_real(&text, value) && !*text && *(double *)value > 0 && *(double *)value < 1) return 0;
        return fail(STATUS_USAGE, "%s: give one number above 0 and below 1: the share of the triangles that remains",
                    spec->name);
    case VALUE_DISTANCE:
        if (take_real(&text, value) && !*text && *(double *)value > 0) return 0;
        return fail(STATUS_USAGE, "%s: give one number above 0: a distance in units of the coordinates", spec->name);
    case VALUE_INDEX:
        status = parse_number(spec, text, INT_MAX, &number);
        *(int *)value = (int)number;
        return status;
    case VALUE_COMPONENT:
        *(int *)value = COMPONENT_MAGNITUDE;
        if (strcmp(text, "magnitude") == 0) return 0;
        status = parse_number(spec, text, INT_MAX, &number);
        *(int *)value = (int)number;
        return status ? fail(status, "%s: '%s' is neither a whole number from 0 on nor magnitude", spec->name, text)
                      : 0;
    case VALUE_NUMBER:
        return parse_number(spec, text, UINT64_MAX, value);
    case VALUE_SIZE:
    case VALUE_BOUND:
        return parse_size(spec, text, value);
    case VALUE_DIMS:
        return parse_dims(spec, text, value);
    case VALUE_SPACING:
    case VALUE_POINT:
        return parse_reals(spec, text, value);
    case VALUE_INDICES:
        return parse_indices(spec, text, value);
    case VALUE_RANGES:
        return parse_ranges(spec, text, value);
    case VALUE_STEP:
        return parse_step(spec, text, value);
    case VALUE_PIECE:
        return parse_piece(spec, text, value);
    case VALUE_CUT:
        return parse_cut(spec, text, value);
    case VALUE_VIEW:
        return parse_view(spec, text, value);
    case VALUE_PIXELS:
        return parse_pixels(spec, text, value);
    case VALUE_LABELS:
        return parse_labels(spec, text, o);
    }
    return fail(STATUS_USAGE, "%s: not understood", spec->name);
}
