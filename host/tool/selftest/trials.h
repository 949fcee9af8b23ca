/*
 * trials.h - the trials of 'tetracubes selftest', as tables
 *
 * A trial is one small volume and isovalue, extracted by device and reference and compared byte by byte, with counts
 * where the answer is known. A group is a name, trials, and the launches under which every one of them runs.
 */
#ifndef TRIALS_H
#define TRIALS_H

#include "tetracubes.h"

typedef enum trial_change {
    CHANGE_NONE,
    CHANGE_STEPS,     /* samples rounded down to multiples of 32: many of them equal the isovalue */
    CHANGE_MISSING,   /* f32, f64: scattered NaN and infinities */
    CHANGE_SUBNORMAL, /* f32, f64: times 2^-140 or 2^-1060, the isovalue too */
    CHANGE_HUGE,      /* f32, f64: less 128, times 2^120 or 2^1016: differences overflow; the isovalue as it is */
    CHANGE_MIDPOINTS, /* f32: pairs whose quotients are as near to the middle of two numbers as they can be */
} trial_change;

typedef enum trial_kind { KIND_UNIFORM, KIND_RECTILINEAR, KIND_CURVILINEAR, KIND_COMPLEX } trial_kind;

typedef enum trial_product {
    PRODUCT_SURFACE,
    PRODUCT_LABELS,   /* the samples are labels */
    PRODUCT_INTERVAL, /* the interval volume from the isovalue on to `high` */
} trial_product;

typedef struct trial {
    trial_product product;
    double high;
    const char *field; /* unless the change makes the samples */
    int64_t dims[3];
    tc_type type;
    double isovalue;
    trial_change change;
    trial_kind kind;
    tc_method method;
    int normals, closed, mirrored; /* mirrored: a left-handed matrix, with spacing and shear */
    int has_nodata;
    double nodata;
    int64_t first[3];
    int is_known;                 /* then the counts below are those from signs alone */
    uint64_t vertices, triangles; /* or tetrahedra */
} trial;

/* Fields of tc_expert_options, and the bound on memory; zeros: the defaults. Launches that the device does not offer
 * are passed over. */
typedef struct launch {
    uint32_t work_items, work_groups, tile_bricks, spin_limit;
    tc_division division;
    uint64_t max_memory_bytes;
} launch;

typedef struct trial_group {
    const char *name, *title;
    const trial *trials;
    int trial_count;
    const launch *launches;
    int launch_count;
    int wants_slabs;                  /* a launch that never makes more than one slab tests nothing: it fails */
    int quick_trials, quick_launches; /* of --quick: so many, the first */
} trial_group;

extern const trial_group trial_groups[];
extern const int trial_group_count;

/* In place of the index of a group: the vectors (vectors.h). */
enum { VECTORS = -1 };

/* The name of a group, or of the vectors. */
const char *group_name(int group);

#endif
