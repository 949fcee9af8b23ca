/*
 * trials.c - the tables
 *
 * Known counts come from the signs of the samples alone (crossed edges, tetrahedra with differing corners), computed by
 * a program that shares nothing with this one and has no case tables.
 */
#include "trials.h"

#define COUNT_OF(array) (int)(sizeof(array) / sizeof *(array))

/* clang-format off */
static const trial known[] = {
    {.field = "sphere", .dims = {33, 33, 33}, .type = TC_U8, .isovalue = 127.5, .is_known = 1, .vertices = 5082, .triangles = 10160},
    {.field = "gyroid", .dims = {65, 64, 63}, .type = TC_F32, .isovalue = 127.5, .is_known = 1, .vertices = 136106, .triangles = 266944},
    {.field = "torus", .dims = {40, 41, 42}, .type = TC_I16, .isovalue = 100, .is_known = 1, .vertices = 11968, .triangles = 23936},
    {.field = "marschner-lobb", .dims = {48, 48, 48}, .type = TC_F64, .isovalue = 127.5, .is_known = 1, .vertices = 36816, .triangles = 73806},
    {.field = "tangle", .dims = {50, 37, 29}, .type = TC_U16, .isovalue = 127.5, .is_known = 1, .vertices = 20212, .triangles = 40440},
    {.field = "full", .dims = {20, 20, 20}, .type = TC_F32, .isovalue = 127.5, .is_known = 1},
    {.field = "empty", .dims = {20, 20, 20}, .type = TC_U8, .isovalue = 127.5, .is_known = 1},
};

static const trial types[] = {
    {.field = "noise", .dims = {37, 22, 19}, .type = TC_U8, .isovalue = 127.5},
    {.field = "noise", .dims = {37, 22, 19}, .type = TC_I8, .isovalue = 64},
    {.field = "noise", .dims = {37, 22, 19}, .type = TC_U16, .isovalue = 127.5},
    {.field = "noise", .dims = {37, 22, 19}, .type = TC_I16, .isovalue = 127.5},
    {.field = "noise", .dims = {37, 22, 19}, .type = TC_U32, .isovalue = 127.5},
    {.field = "noise", .dims = {37, 22, 19}, .type = TC_I32, .isovalue = 127.5},
    {.field = "noise", .dims = {37, 22, 19}, .type = TC_F32, .isovalue = 0.1},
    {.field = "noise", .dims = {37, 22, 19}, .type = TC_F64, .isovalue = 128.1},
    {.field = "noise", .dims = {37, 22, 19}, .type = TC_U8, .isovalue = -1e300},
    {.field = "noise", .dims = {37, 22, 19}, .type = TC_I32, .isovalue = 1e300},
};

static const trial sizes[] = {
    {.field = "noise", .dims = {2, 2, 2}, .type = TC_U8, .isovalue = 127.5},
    {.field = "noise", .dims = {2, 3, 130}, .type = TC_U8, .isovalue = 127.5},
    {.field = "noise", .dims = {3, 257, 2}, .type = TC_F32, .isovalue = 127.5},
    {.field = "noise", .dims = {63, 7, 3}, .type = TC_U8, .isovalue = 127.5},
    {.field = "noise", .dims = {64, 8, 4}, .type = TC_U8, .isovalue = 127.5},
    {.field = "noise", .dims = {65, 9, 5}, .type = TC_U8, .isovalue = 127.5},
    {.field = "noise", .dims = {66, 9, 5}, .type = TC_F32, .isovalue = 127.5},
    {.field = "noise", .dims = {127, 16, 9}, .type = TC_U16, .isovalue = 127.5},
    {.field = "noise", .dims = {128, 17, 8}, .type = TC_I16, .isovalue = 127.5},
    {.field = "noise", .dims = {129, 15, 12}, .type = TC_F32, .isovalue = 127.5},
    {.field = "noise", .dims = {1000, 3, 3}, .type = TC_U8, .isovalue = 127.5},
    {.field = "noise", .dims = {37, 22, 19}, .type = TC_U8, .isovalue = 127.5, .first = {1, -7, 100}},
};

static const trial ties[] = {
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_U8, .isovalue = 128},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_U8, .isovalue = 128, .change = CHANGE_STEPS},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_I16, .isovalue = 96, .change = CHANGE_STEPS},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_I32, .isovalue = 224, .change = CHANGE_STEPS},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F32, .isovalue = 128, .change = CHANGE_STEPS},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F64, .isovalue = 32, .change = CHANGE_STEPS},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F32, .isovalue = 0, .change = CHANGE_STEPS},
};

static const trial missing[] = {
    {.field = "gyroid", .dims = {67, 13, 11}, .type = TC_F32, .isovalue = 127.5, .change = CHANGE_MISSING},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F64, .isovalue = 127.5, .change = CHANGE_MISSING},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_U8, .isovalue = 128, .change = CHANGE_STEPS, .has_nodata = 1, .nodata = 64},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_I16, .isovalue = 127.5, .change = CHANGE_STEPS, .has_nodata = 1, .nodata = 224},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_U8, .isovalue = 127.5, .has_nodata = 1, .nodata = 1000},
    {.field = "full", .dims = {67, 13, 11}, .type = TC_U8, .isovalue = 127.5, .has_nodata = 1, .nodata = 255},
};

static const trial extremes[] = {
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F64, .isovalue = 127.5, .change = CHANGE_SUBNORMAL},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F64, .isovalue = 0, .change = CHANGE_HUGE},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F32, .isovalue = 127.5, .change = CHANGE_SUBNORMAL},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F32, .isovalue = 0, .change = CHANGE_HUGE},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F32, .isovalue = 1e37, .change = CHANGE_HUGE},
};

static const trial normals[] = {
    {.field = "sphere", .dims = {33, 33, 33}, .type = TC_U8, .isovalue = 127.5, .normals = 1},
    {.field = "gyroid", .dims = {65, 20, 11}, .type = TC_F32, .isovalue = 127.5, .normals = 1, .mirrored = 1},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F64, .isovalue = 127.5, .normals = 1, .change = CHANGE_MISSING},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_I32, .isovalue = 127.5, .normals = 1},
};

static const trial matrices[] = {
    {.field = "gyroid", .dims = {65, 20, 11}, .type = TC_U8, .isovalue = 127.5, .mirrored = 1},
    {.field = "noise", .dims = {65, 20, 11}, .type = TC_F64, .isovalue = 127.5, .mirrored = 1},
};

static const trial hybrids[] = {
    {.field = "gyroid", .dims = {67, 20, 13}, .type = TC_U8, .isovalue = 127.5, .method = TC_METHOD_HYBRID},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F32, .isovalue = 127.5, .method = TC_METHOD_HYBRID},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F64, .isovalue = 127.5, .method = TC_METHOD_HYBRID},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_U8, .isovalue = 128, .method = TC_METHOD_HYBRID, .change = CHANGE_STEPS, .has_nodata = 1, .nodata = 64},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F32, .isovalue = 127.5, .method = TC_METHOD_HYBRID, .change = CHANGE_MISSING, .normals = 1},
};

static const trial snapped[] = {
    {.field = "gyroid", .dims = {67, 20, 13}, .type = TC_U8, .isovalue = 127.5, .method = TC_METHOD_SNAP},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F32, .isovalue = 127.5, .method = TC_METHOD_SNAP, .change = CHANGE_MISSING, .normals = 1},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F64, .isovalue = 127.5, .method = TC_METHOD_SNAP},
    {.field = "noise", .dims = {130, 21, 18}, .type = TC_U8, .isovalue = 127.5, .method = TC_METHOD_SNAP, .first = {0, 1, -7}},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_U8, .isovalue = 128, .method = TC_METHOD_SNAP, .change = CHANGE_STEPS, .has_nodata = 1, .nodata = 64},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F32, .isovalue = 0, .method = TC_METHOD_SNAP, .change = CHANGE_HUGE},
};

static const trial closed[] = {
    {.field = "full", .dims = {20, 20, 20}, .type = TC_F32, .isovalue = 127.5, .closed = 1, .is_known = 1, .vertices = 2168, .triangles = 4332},
    {.field = "gyroid", .dims = {130, 21, 18}, .type = TC_F32, .isovalue = 127.5, .closed = 1},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F32, .isovalue = 127.5, .closed = 1, .change = CHANGE_MISSING, .normals = 1},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F64, .isovalue = 127.5, .closed = 1, .method = TC_METHOD_HYBRID},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_U8, .isovalue = 128, .closed = 1, .method = TC_METHOD_SNAP, .change = CHANGE_STEPS, .has_nodata = 1, .nodata = 64},
};

static const trial coordinates[] = {
    {.field = "gyroid", .dims = {67, 20, 13}, .type = TC_F32, .isovalue = 127.5, .kind = KIND_RECTILINEAR, .normals = 1},
    {.field = "gyroid", .dims = {67, 20, 13}, .type = TC_F32, .isovalue = 127.5, .kind = KIND_CURVILINEAR, .normals = 1},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_U8, .isovalue = 127.5, .kind = KIND_CURVILINEAR, .normals = 1},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F64, .isovalue = 127.5, .kind = KIND_CURVILINEAR, .normals = 1},
    {.field = "noise", .dims = {67, 13, 11}, .type = TC_F32, .isovalue = 127.5, .kind = KIND_CURVILINEAR, .normals = 1, .change = CHANGE_MISSING},
};

static const trial complexes[] = {
    {.field = "gyroid", .dims = {30, 20, 13}, .type = TC_F32, .isovalue = 127.5, .kind = KIND_COMPLEX},
    {.field = "noise", .dims = {30, 20, 13}, .type = TC_U8, .isovalue = 127.5, .kind = KIND_COMPLEX},
    {.field = "noise", .dims = {30, 20, 13}, .type = TC_I16, .isovalue = 96, .kind = KIND_COMPLEX, .change = CHANGE_STEPS},
    {.field = "noise", .dims = {30, 20, 13}, .type = TC_F64, .isovalue = 127.5, .kind = KIND_COMPLEX},
    {.field = "noise", .dims = {30, 20, 13}, .type = TC_F32, .isovalue = 127.5, .kind = KIND_COMPLEX, .change = CHANGE_SUBNORMAL},
    {.field = "noise", .dims = {30, 20, 13}, .type = TC_F32, .isovalue = 127.5, .kind = KIND_COMPLEX, .change = CHANGE_MISSING},
    {.field = "noise", .dims = {30, 20, 13}, .type = TC_F32, .isovalue = 127.5, .kind = KIND_COMPLEX, .closed = 1, .change = CHANGE_MISSING},
};

static const trial whole[] = {
    {.field = "gyroid", .dims = {30, 20, 13}, .type = TC_F32, .isovalue = 127.5, .kind = KIND_COMPLEX, .method = TC_METHOD_HYBRID},
    {.field = "noise", .dims = {30, 20, 13}, .type = TC_U8, .isovalue = 128, .kind = KIND_COMPLEX, .method = TC_METHOD_HYBRID, .change = CHANGE_STEPS},
    {.field = "noise", .dims = {30, 20, 13}, .type = TC_F64, .isovalue = 127.5, .kind = KIND_COMPLEX, .method = TC_METHOD_HYBRID},
    {.field = "noise", .dims = {30, 20, 13}, .type = TC_F32, .isovalue = 127.5, .kind = KIND_COMPLEX, .method = TC_METHOD_HYBRID, .change = CHANGE_MISSING},
    {.field = "gyroid", .dims = {30, 20, 13}, .type = TC_F32, .isovalue = 127.5, .kind = KIND_COMPLEX, .method = TC_METHOD_HYBRID, .closed = 1},
};

static const trial labelled[] = {
    {.product = PRODUCT_LABELS, .field = "noise", .dims = {67, 13, 11}, .type = TC_U8, .change = CHANGE_STEPS},
    {.product = PRODUCT_LABELS, .field = "tangle", .dims = {130, 21, 18}, .type = TC_I16, .change = CHANGE_STEPS, .closed = 1},
    {.product = PRODUCT_LABELS, .field = "gyroid", .dims = {66, 20, 13}, .type = TC_U32, .change = CHANGE_STEPS, .has_nodata = 1, .nodata = 64},
    {.product = PRODUCT_LABELS, .field = "noise", .dims = {67, 13, 11}, .type = TC_I32, .change = CHANGE_STEPS, .first = {1, -7, 100}, .mirrored = 1},
};

static const trial intervals[] = {
    {.product = PRODUCT_INTERVAL, .field = "full", .dims = {20, 20, 20}, .type = TC_U8, .isovalue = 127.5, .high = 300, .is_known = 1, .vertices = 8000, .triangles = 34295},
    {.product = PRODUCT_INTERVAL, .field = "noise", .dims = {67, 13, 11}, .type = TC_F32, .isovalue = 100, .high = 150, .change = CHANGE_MISSING},
    {.product = PRODUCT_INTERVAL, .field = "gyroid", .dims = {130, 21, 18}, .type = TC_U8, .isovalue = 127.5, .high = 160},
    {.product = PRODUCT_INTERVAL, .field = "noise", .dims = {67, 13, 11}, .type = TC_U8, .isovalue = 64, .high = 128, .change = CHANGE_STEPS},
    {.product = PRODUCT_INTERVAL, .field = "noise", .dims = {67, 13, 11}, .type = TC_F64, .isovalue = 100, .high = 150},
    {.product = PRODUCT_INTERVAL, .field = "gyroid", .dims = {67, 20, 13}, .type = TC_F32, .isovalue = 127.5, .high = 160, .kind = KIND_CURVILINEAR},
};

static const trial scanned[] = {
    {.field = "gyroid", .dims = {130, 70, 66}, .type = TC_U8, .isovalue = 127.5, .is_known = 1, .vertices = 254936, .triangles = 502192},
    {.field = "gyroid", .dims = {30, 20, 13}, .type = TC_U8, .isovalue = 127.5, .kind = KIND_COMPLEX},
};

static const trial quotients[] = {
    {.dims = {130, 21, 18}, .type = TC_F32, .isovalue = 0, .change = CHANGE_MIDPOINTS},
    {.field = "gyroid", .dims = {200, 41, 38}, .type = TC_U8, .isovalue = 127.5},
    {.field = "noise", .dims = {130, 21, 18}, .type = TC_F32, .isovalue = 127.5},
};

static const trial launched[] = {
    {.field = "gyroid", .dims = {200, 41, 38}, .type = TC_U8, .isovalue = 127.5},
    {.field = "noise", .dims = {130, 21, 18}, .type = TC_F32, .isovalue = 127.5},
};

static const trial slabbed[] = {
    {.field = "gyroid", .dims = {192, 96, 64}, .type = TC_F32, .isovalue = 127.5},
    {.field = "gyroid", .dims = {192, 96, 64}, .type = TC_U8, .isovalue = 127.5, .normals = 1},
    {.field = "gyroid", .dims = {80, 50, 40}, .type = TC_F32, .isovalue = 127.5, .kind = KIND_COMPLEX},
    {.field = "gyroid", .dims = {80, 50, 40}, .type = TC_F32, .isovalue = 127.5, .kind = KIND_COMPLEX, .method = TC_METHOD_HYBRID},
};
/* clang-format on */

static const launch standard[] = {{0}};

static const launch varied[] = {
    {.work_items = 1},
    {.work_items = 32},
    {.work_items = 64, .work_groups = 3},
    {.work_items = 256},
    {.work_groups = 1},
    {.tile_bricks = 1},
    {.tile_bricks = 7, .spin_limit = 1},
    {.tile_bricks = 1000},
    {.work_items = 32, .work_groups = 2, .tile_bricks = 3},
};

/* By look-back; by the fallback wherever it can be; by either as it comes, with groups that wait for each other. */
static const launch chained[] = {
    {.tile_bricks = 1},
    {.tile_bricks = 1, .spin_limit = 1},
    {.tile_bricks = 1, .spin_limit = 2, .work_groups = 16},
};

static const launch divided[] = {
    {.division = TC_DIVISION_BUILT_IN}, {.division = TC_DIVISION_FP64}, {.division = TC_DIVISION_INTEGER}};

static const launch tight[] = {
    {.max_memory_bytes = 4u << 20},
    {.max_memory_bytes = 8u << 20},
};

#define GROUP(name, title, trials, launches, wants_slabs, quick_trials, quick_launches)                                \
    { name, title, trials, COUNT_OF(trials), launches, COUNT_OF(launches), wants_slabs, quick_trials, quick_launches }

const trial_group trial_groups[] = {
    GROUP("known", "known answers", known, standard, 0, 2, 1),
    GROUP("types", "sample types", types, standard, 0, 2, 1),
    GROUP("sizes", "odd sizes", sizes, standard, 0, 12, 1),
    GROUP("ties", "samples equal to the isovalue", ties, standard, 0, 2, 1),
    GROUP("missing", "missing data", missing, standard, 0, 1, 1),
    GROUP("extremes", "subnormal and huge samples", extremes, standard, 0, 5, 1),
    GROUP("normals", "normals", normals, standard, 0, 1, 1),
    GROUP("matrices", "mirrored and sheared grids", matrices, standard, 0, 1, 1),
    GROUP("hybrid", "the hybrid method", hybrids, standard, 0, 1, 1),
    GROUP("snap", "the method snap", snapped, standard, 0, 3, 1),
    GROUP("closed", "closed surfaces", closed, standard, 0, 2, 1),
    GROUP("coordinates", "rectilinear, curvilinear grids", coordinates, standard, 0, 2, 1),
    GROUP("complexes", "unstructured grids", complexes, standard, 0, 1, 1),
    GROUP("cells", "unstructured cells kept whole", whole, standard, 0, 1, 1),
    GROUP("labels", "surfaces of label maps", labelled, standard, 0, 1, 1),
    GROUP("intervals", "interval volumes", intervals, standard, 0, 2, 1),
    GROUP("scan", "the scan and its fallback", scanned, chained, 0, 1, 3),
    GROUP("launches", "work-group and tile sizes", launched, varied, 0, 1, 2),
    GROUP("divisions", "ways to divide", quotients, divided, 0, 1, 1),
    GROUP("slabs", "little memory", slabbed, tight, 1, 1, 1),
};

const int trial_group_count = COUNT_OF(trial_groups);

const char *group_name(int group) { return group == VECTORS ? "vectors" : trial_groups[group].name; }
