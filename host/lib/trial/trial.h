/*
 * trial.h - kernels tried on a small volume before a context's results rest on them
 *
 * A driver may build or run kernels wrongly and report success. So, where the context's options say check_device, the
 * kernels that an extraction needs are run once per context on a volume that has everything in small: several words,
 * bricks and tiles, both parities, ties, subnormal and huge samples, missing ones where the kernels know of them.
 *
 * Counts first: wrong ones could make kernel 2 write where nothing is. Then every byte of the mesh is compared with the
 * scalar reference's; then both once more for another isovalue, by the fallback of the scan and from the ranges that
 * the visit before has left. That takes milliseconds; so the verdict is kept in the context alone, where it cannot
 * outlive a change of driver or device.
 */
#ifndef TRIAL_H
#define TRIAL_H

#include "grid/grid.h"
#include "opencl/kernel_kind.h"

/* Tries the kernels of a kind, whether they have passed or not; progress is told "run" when they are built. */
tc_status trial_of_kind(tc_context *context, kernel_kind kind);

/* The same of the kernels of label maps, which trial_of_kind hands over (trial_labels.c). */
tc_status trial_of_labels(tc_context *context, kernel_kind kind);

/* TC_OK where the kernels of a kind have passed, or need not be tried: they are where the context's options say so. */
tc_status trial_once(tc_context *context, kernel_kind kind);

/* TC_OK where the kernels for the grid and the options have passed, or need not be tried; TC_ERROR_WRONG_RESULT, saying
 * what differs, where the device computes wrongly. Uses the workspace; emits: kernel 2 is tried too. */
tc_status trial_run(const tc_grid *grid, const tc_extract_options *options, bool emits);

/* True where trial_run would run kernels. That may be so after an extraction too: when it meets the grid's first
 * missing sample, it switches to other kernels. */
bool trial_pending(const tc_grid *grid, const tc_extract_options *options, bool emits);

/* What one trial extracts from. */
typedef struct trial_volume {
    tc_type type;
    grid_kind kind;
    bool whole;                        /* unstructured, and cells are kept whole */
    bool unstructured, missing, plain; /* plain: samples of one magnitude, for normals: squares would overflow */
    tc_grid_options options;
    tc_tetrahedra complex; /* unstructured: the volume, cut */
    tc_cells cells;        /* whole: what was cut */
    double isovalue;
    void *samples;
    float *points, *axes;
} trial_volume;

/* Makes samples and coordinates; to be released in any case. */
tc_status trial_volume_make(trial_volume *v);
void trial_volume_release(trial_volume *v);

/* Of a volume of whole cells: these, and their tetrahedra (trial_cells.c). noise: a pseudo-random number for
 * each index. */
tc_status trial_cells_make(trial_volume *v, uint64_t noise(uint64_t));
void trial_cells_release(trial_volume *v);

/* A grid over it, in a context of either engine. */
tc_status trial_grid_create(const trial_volume *v, tc_context *context, scan_parameters scan, tc_grid **grid);

#endif
