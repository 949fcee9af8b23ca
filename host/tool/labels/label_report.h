/*
 * label_report.h - what labels tells of the surfaces that it made, as text or JSON
 */
#ifndef LABEL_REPORT_H
#define LABEL_REPORT_H

#include "command_line/options.h"
#include "dataset/dataset.h"
#include "mesh_check.h"
#include "terminal/run_times.h"

typedef struct label_row {
    uint32_t label;
    uint64_t triangle_count;
    mesh_topology topology; /* with --check */
    char *path;             /* of its own file, or NULL; from malloc */
} label_row;

typedef struct label_report {
    const options *o;
    const dataset_block *grid;
    const char *field;
    tc_type type;
    char device[128]; /* "" for the reference engine */
    uint32_t smoothing;
    uint64_t vertex_count, triangle_count, active_cell_count, degenerate_triangles;
    double bounds[2][3];
    uint64_t hash;
    tc_timings timings;
    uint32_t slab_count;
    label_row *rows;
    size_t row_count;
    char *path;    /* of the file of all labels, once it is written, or NULL; from malloc */
    char *preview; /* of the picture, as above */
    int has_verdict, verified;
    run_times times;
} label_report;

/* Returns 0 or STATUS_FAILED. */
int label_report_print(const label_report *r);

#endif
