/*
 * selftest.h - the trials of 'tetracubes selftest'
 *
 * A trial is one small volume and isovalue, extracted by device and reference and compared byte by byte, with counts
 * where the answer is known. A group is a name, trials, and the launches under which every one of them runs.
 */
#ifndef SELFTEST_H
#define SELFTEST_H

#include "tetracubes.h"

typedef enum trial_change {
    CHANGE_NONE,
    CHANGE_STEPS,     /* samples rounded down to multiples of 32: many of them equal the isovalue */
    CHANGE_MISSING,   /* f32, f64: scattered NaN and infinities */
    CHANGE_SUBNORMAL, /* f32: times 2^-140, the isovalue too */
    CHANGE_HUGE,      /* f32: less 128, times 2^120: differences overflow; the isovalue is given as it is */
} trial_change;

typedef struct trial {
    const char *field;
    int64_t dims[3];
    tc_type type;
    double isovalue;
    trial_change change;
    int normals, mirrored; /* mirrored: a left-handed matrix, with spacing and shear */
    int has_nodata;
    double nodata;
    int64_t first[3];
    int is_known; /* then the counts below are those from signs alone */
    uint64_t vertices, triangles;
} trial;

/* Fields of tc_context_options; zeros: the defaults. Launches that the device does not offer are passed over. */
typedef struct launch {
    uint32_t work_items, work_groups, tile_bricks, spin_limit;
    int division;
    uint64_t max_memory_bytes;
} launch;

typedef struct trial_group {
    const char *name, *title;
    const trial *trials;
    int trial_count;
    const launch *launches;
    int launch_count;
    int wants_slabs; /* a launch that never makes more than one slab tests nothing: it fails */
} trial_group;

extern const trial_group trial_groups[];
extern const int trial_group_count;

#endif
