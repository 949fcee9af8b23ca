/*
 * selftest.h - the trials of 'tetracubes selftest'
 *
 * A trial is one small volume and isovalue, extracted by device and reference and compared byte by byte, with counts
 * where the answer is known. A group is a name, trials, and the launches under which every one of them runs. Or, of
 * vectors, a trial is a line of their file, and the device's mesh is compared with the hash in it.
 *
 * A group runs in a child of this process, as drivers crash and hang: that is then the failure of one trial, and
 * another child goes on behind it. The child numbers the trials that it comes to, from 0, and reports
 *
 *     trial NUMBER NAME      it begins
 *     ok | failed TEXT | skipped TEXT    how it ended
 *     end STATUS TEXT        no more of them; STATUS not 0: they could not be run
 */
#ifndef SELFTEST_H
#define SELFTEST_H

#include "tetracubes.h"

#include <stdint.h>
#include <stdio.h>

typedef enum trial_change {
    CHANGE_NONE,
    CHANGE_STEPS,     /* samples rounded down to multiples of 32: many of them equal the isovalue */
    CHANGE_MISSING,   /* f32, f64: scattered NaN and infinities */
    CHANGE_SUBNORMAL, /* f32, f64: times 2^-140 or 2^-1060, the isovalue too */
    CHANGE_HUGE,      /* f32, f64: less 128, times 2^120 or 2^1016: differences overflow; the isovalue as it is */
    CHANGE_MIDPOINTS, /* f32: pairs whose quotients are as near to the middle of two numbers as they can be */
} trial_change;

typedef enum trial_kind { KIND_UNIFORM, KIND_RECTILINEAR, KIND_CURVILINEAR, KIND_COMPLEX } trial_kind;

typedef struct trial {
    const char *field; /* unless the change makes the samples */
    int64_t dims[3];
    tc_type type;
    double isovalue;
    trial_change change;
    trial_kind kind;
    tc_method method;
    int normals, mirrored; /* mirrored: a left-handed matrix, with spacing and shear */
    int has_nodata;
    double nodata;
    int64_t first[3];
    int is_known; /* then the counts below are those from signs alone */
    uint64_t vertices, triangles;
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

/* What a trial extracts from. */
typedef struct selftest_volume {
    tc_grid_options grid;
    tc_tetrahedra complex; /* KIND_COMPLEX: the grid, cut */
    void *samples;
    float *points, *axes;
} selftest_volume;

/* Returns 0 or a status with its text; to be released in any case. */
int selftest_volume_make(const trial *t, selftest_volume *v);
void selftest_volume_release(selftest_volume *v);

/* Of a scaled trial: the power of two. */
int selftest_exponent(const trial *t);

tc_status selftest_grid_create(const selftest_volume *v, tc_context *context, tc_grid **grid);

/* Of what a child does: a group, or vectors where it is VECTORS. */
typedef struct selftest_job {
    int group;          /* index in trial_groups, or VECTORS */
    const char *device; /* NULL: the default */
    int quick;
    int first;           /* number of the first trial; those before are passed over */
    const char *vectors; /* file; NULL: those that come with the tool */
} selftest_job;

enum { VECTORS = -1 };

/* The command by which a child is started: not one that --help shows; arguments: group, device, quick, first, vectors.
 */
#define SELFTEST_COMMAND "--group-of-selftest"

/* The child's part; returns the process's exit status. */
int selftest_child(int argc, char **argv);

/* ---------------------------------------------------------------------------------------------------------- vectors */

/* A line of the file: FIELD NX NY NZ TYPE ISOVALUE METHOD OPTIONS VERTICES TRIANGLES HASH, see vectors.txt. */
typedef struct vector {
    char field[32], options[64];
    int64_t dims[3];
    tc_type type;
    double isovalue;
    tc_method method;
    int is_complex; /* cut into tetrahedra, and extracted as an unstructured grid */
    int has_nodata;
    double nodata;
    uint64_t seed, vertices, triangles, hash;
} vector;

typedef struct vector_list {
    vector *vectors; /* from malloc */
    int count;
} vector_list;

/* Reads a file, or those that come with the tool where path is NULL. Returns 0, or a status with its text that names
 * file and line. To be released in any case. */
int vectors_read(const char *path, vector_list *list);
void vectors_release(vector_list *list);

/* Extracts the mesh of a vector; text: what is wrong with it, "" for nothing. Returns 0 or a status. */
int vector_try(const vector *v, tc_context *device, char *text, size_t bytes);

/* ---------------------------------------------------------------------------------------------------------- results */

/* TRIAL_LATE: not finished, or not begun, when the time of --timeout was over. */
typedef enum trial_end { TRIAL_OK, TRIAL_FAILED, TRIAL_CRASHED, TRIAL_HUNG, TRIAL_LATE, TRIAL_SKIPPED } trial_end;

typedef struct trial_result {
    int group; /* as in selftest_job */
    char *name, *text;
    trial_end end;
    double ms;
} trial_result;

/* What all groups came to. */
typedef struct selftest_results {
    trial_result *results;
    size_t count, room;
    int out_of_memory;
} selftest_results;

/* text: why it did not end well. */
void results_add(selftest_results *all, int group, const char *name, trial_end end, const char *text, double ms);
void results_release(selftest_results *all);

const char *group_name(int group);

/* Writes a JUnit file: a suite per group, a case per trial. Returns 0 or a status with its text. */
int junit_write(const char *path, const selftest_results *all, const tc_device_info *device);

extern const trial_group trial_groups[];
extern const int trial_group_count;

#endif
