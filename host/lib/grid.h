/*
 * grid.h - a uniform grid as both engines see it: checked sizes, parity, float32 map to world space
 */
#ifndef GRID_H
#define GRID_H

#include "tetracubes.h"

#include <stdbool.h>

struct device_grid;

struct tc_grid {
    tc_context *context;
    int64_t dims[3];
    int64_t first[3];
    tc_type type;
    const void *samples;        /* NULL where they are in cl_samples */
    struct _cl_mem *cl_samples; /* the caller's, retained by the device path */
    uint64_t cl_samples_offset;
    bool has_nodata;
    double nodata;
    float matrix[12];       /* rows of the index-to-world map: m0 m1 m2 o */
    float normal_matrix[9]; /* inverse transposed, scaled by a positive number: index gradients to world directions */
    bool mirrored;          /* negative determinant */
    struct device_grid *device; /* NULL under the reference engine */
};

/* Checks the options and fills *grid but for context and device. */
tc_status grid_describe(const tc_grid_options *options, tc_grid *grid);

int64_t grid_sample_count(const tc_grid *grid);

/* 0 where the first sample's cube is even. */
unsigned grid_parity(const tc_grid *grid);

#endif
