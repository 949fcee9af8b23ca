#include "parse_value.h"

#include "dataset/request.h"
#include "exit_status.h"
#include "failure.h"

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
        return fail(STATUS_USAGE, "%s: '%s' is no whole number from 0 to %llu", spec->name, text,
                    (unsigned long long)most);
    return 0;
}

int parse_value(const option *spec, const char *text, options *o) {
    void *place = (char *)o + spec->place;
    uint64_t number = 0;
    int status;
    switch (spec->kind) {
    case VALUE_NONE:
        *(int *)place = 1;
        return 0;
    case VALUE_TEXT:
        if (!*text) return fail(STATUS_USAGE, "%s: the value is empty", spec->name);
        *(const char **)place = text;
        if (!spec->choices) return 0;
        int unused;
        return choice_find(spec->name, text, spec->choices, &unused);
    case VALUE_CHOICE:
        return choice_find(spec->name, text, spec->choices, place);
    case VALUE_ISOVALUES:
        return parse_isovalues(text, o);
    case VALUE_NODATA:
        o->has_nodata = 1;
        if (take_real(&text, &o->nodata) && !*text) return 0;
        return fail(STATUS_USAGE, "--nodata: give one finite number (NaN and infinities are missing in any case)");
    case VALUE_INDEX:
        status = parse_number(spec, text, INT_MAX, &number);
        *(int *)place = (int)number;
        return status;
    case VALUE_COMPONENT:
        *(int *)place = COMPONENT_MAGNITUDE;
        if (strcmp(text, "magnitude") == 0) return 0;
        status = parse_number(spec, text, INT_MAX, &number);
        *(int *)place = (int)number;
        return status ? fail(status, "%s: '%s' is neither a whole number from 0 on nor magnitude", spec->name, text)
                      : 0;
    case VALUE_NUMBER:
        return parse_number(spec, text, UINT64_MAX, place);
    case VALUE_SIZE:
    case VALUE_BOUND:
        return parse_size(spec, text, place);
    case VALUE_DIMS:
        return parse_dims(spec, text, place);
    case VALUE_SPACING:
    case VALUE_POINT:
        return parse_reals(spec, text, place);
    }
    return fail(STATUS_USAGE, "%s: not understood", spec->name);
}
