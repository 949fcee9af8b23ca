#include "json_report.h"

#include "exit_status.h"
#include "failure.h"
#include "standard_streams.h"

#include <errno.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

enum { DIGITS_LEAST = 15, DIGITS_MOST = 17 }; /* significant ones: the most read back any double */

static atomic_int lacks_memory;

static void *watched_malloc(size_t bytes) {
    void *memory = malloc(bytes);
    if (!memory) lacks_memory = 1;
    return memory;
}

void json_report_begin(void) { json_set_alloc_funcs(watched_malloc, free); }

void json_report_spoil(void) { lacks_memory = 1; }

/* ---------------------------------------------------------------------------------------------------------- values */

json_t *string_json(const char *text) {
    char readable[4096];
    json_t *string = json_string(text);
    if (string) return string;
    snprintf(readable, sizeof readable, "%s", text);
    for (char *c = readable; *c; c++)
        if (*c & 0x80) *c = '?';
    return json_string(readable);
}

json_t *real_json(double value) { return isfinite(value) ? json_real(value) : json_null(); }

json_t *ms_json(double ms) { return real_json(round(ms * 1e3) / 1e3); }

json_t *reals_json(const double *values, int count) {
    json_t *array = json_array();
    for (int n = 0; array && n < count; n++) json_array_append_new(array, real_json(values[n]));
    return array;
}

json_t *count_json(uint64_t count) { return json_integer((json_int_t)count); }

json_t *integers_json(const int64_t values[3]) {
    return json_pack("[I, I, I]", (json_int_t)values[0], (json_int_t)values[1], (json_int_t)values[2]);
}

/* -------------------------------------------------------------------------------------------------------- printing */

/* Significant digits that read back the same double. */
static int digits_of_number(double value) {
    char text[40];
    for (int digits = DIGITS_LEAST; digits < DIGITS_MOST; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value) return digits;
    }
    return DIGITS_MOST;
}

/* Digits, not fewer than the least, for all numbers of the value and what it holds. */
static int digits_of(json_t *value, int least) {
    const char *key;
    json_t *part;
    size_t n;
    if (json_is_real(value)) {
        int digits = digits_of_number(json_real_value(value));
        return digits > least ? digits : least;
    }
    json_array_foreach(value, n, part) least = digits_of(part, least);
    json_object_foreach(value, key, part) least = digits_of(part, least);
    return least;
}

int json_report_print(json_t *object) {
    const size_t digits = (size_t)digits_of(object, DIGITS_LEAST);
    int failed = !object || lacks_memory || json_dumpf(object, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(digits));
    const int error = errno;
    json_decref(object);
    if (failed && ferror(stdout)) return streams_fail(error);
    if (failed) return fail(STATUS_FAILED, "could not print the report: out of memory");
    putchar('\n');
    return 0;
}
