/*
 * api.h - a small volume for the tests of the public functions
 */
#ifndef API_H
#define API_H

#include "engines.h"

#include <math.h>

enum { SIZE = 12, SAMPLES = SIZE * SIZE * SIZE };

static uint8_t samples[SAMPLES];

static inline void grid_describe(tc_grid_options *grid) {
    tc_grid_options_init(grid);
    for (int axis = 0; axis < 3; axis++) grid->dims[axis] = SIZE;
    grid->samples = samples;
}

static inline void samples_fill(void) {
    for (int n = 0; n < SAMPLES; n++)
        samples[n] =
            (uint8_t)(127.5 + 50 * sin(0.7 * (n % SIZE)) + 50 * cos(0.6 * (n / SIZE % SIZE) + 0.3 * (n / SIZE / SIZE)));
}

#endif
