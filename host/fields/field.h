/*
 * field.h - analytic scalar fields, sampled on [-1, 1]^3: shared by generate, selftest, tests and bench
 *
 * Sample i of n along an axis lies at 2 i / (n - 1) - 1, computed in double. f32 rounds to nearest; integer types
 * truncate toward zero and saturate.
 */
#ifndef FIELD_H
#define FIELD_H

#include "tetracubes.h"

typedef struct field {
    const char *name;       /* "sphere", "torus", "gyroid", "marschner-lobb", "tangle", "noise", ... */
    const char *definition; /* formula and range, one or two lines, for --help */
    double isovalue;        /* a sensible one */
} field;

/* All fields, ended by one whose name is NULL. */
extern const field fields[];

/* NULL where there is none of that name. */
const field *field_find(const char *name);

/* Fills samples (dims[0] * dims[1] * dims[2] of the type, x fastest) for the planes z0 <= k < z1 of the grid, so that
 * big volumes can be made piecewise; samples points at plane z0. seed is used by noise alone. */
void field_sample(const field *f, const int64_t dims[3], tc_type type, uint64_t seed, int64_t z0, int64_t z1,
                  void *samples);

#endif
