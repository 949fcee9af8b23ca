/* bench_options.h - the command line of tetracubes-bench */
#ifndef BENCH_OPTIONS_H
#define BENCH_OPTIONS_H

#include "field.h"

#include <stdio.h>

#define LIST_MAX 16

/* How the samples lie in space. */
typedef enum bench_grid {
    BENCH_UNIFORM,
    BENCH_RECTILINEAR,
    BENCH_CURVILINEAR,
    BENCH_TETRAHEDRA, /* unstructured, from here on */
    BENCH_HEXAHEDRA,
    BENCH_GRIDS
} bench_grid;

extern const char *const bench_grid_names[BENCH_GRIDS];

/* Options that may be given several times are lists; every combination is a case. */
typedef struct bench_options {
    const field *fields[LIST_MAX];
    int64_t dims[LIST_MAX][3];
    tc_type types[LIST_MAX];
    int field_count, dims_count, type_count; /* never 0, but with an input, where dims and type are for raw data */
    int has_iso, has_second, has_repeat;
    tc_method method;
    double iso, second; /* isovalues; the second one follows on the same grid */
    bench_grid grid;
    const char *device; /* NULL: the library's default */
    const char *input;  /* a volume file instead of fields, or NULL */
    const char *dump;   /* where to write the samples instead of measuring, or NULL */
    int repeat;
    int sweep; /* sweep.h: not all of the combinations */
    int json, tune, turns, help;
} bench_options;

/* Returns 0, or STATUS_USAGE with its message (failure.h). */
int bench_options_parse(int argc, char **argv, bench_options *o);

void bench_options_help(FILE *out);

#endif
