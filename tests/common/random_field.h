/*
 * random_field.h - fields for random grids: noise, waves, and few values, of which many equal the isovalue
 */
#ifndef RANDOM_FIELD_H
#define RANDOM_FIELD_H

#include "random.h"

#include <math.h>

enum { NOISE, SMOOTH, TIES, RANDOM_FIELDS };

static inline void wave_choose(double wave[4]) {
    for (int n = 0; n < 4; n++) wave[n] = random_between(0.05, 1.5);
}

/* Around 60, as all types hold it. */
static inline double field_value(int kind, const double wave[4], double x, double y, double z) {
    if (kind == NOISE) return 60 + random_between(-50, 50);
    if (kind == SMOOTH) return 60 + 50 * sin(wave[0] * x + wave[3]) * cos(wave[1] * y) + 10 * sin(wave[2] * z);
    return 58 + random_below(4);
}

#endif
