/* volume.h - what the self-test extracts from: samples, coordinates, tetrahedra */
#ifndef VOLUME_H
#define VOLUME_H

#include "trials.h"

typedef struct selftest_volume {
    tc_grid_options grid;
    int is_complex;
    tc_tetrahedra complex; /* the grid, cut, where it is one */
    tc_cells cells;        /* its cubes, where these are kept whole */
    void *samples;
    float *points, *axes;
} selftest_volume;

/* The volume of a trial. Returns 0 or a status with its text; to be released in any case. */
int selftest_volume_make(const trial *t, selftest_volume *v);
void selftest_volume_release(selftest_volume *v);

/* Of a scaled trial: the power of two. */
int selftest_exponent(const trial *t);

tc_status selftest_grid_create(const selftest_volume *v, tc_context *context, tc_grid **grid);

#endif
