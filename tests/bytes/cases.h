/*
 * cases.h - grids of every kind, each with a way to extract it: what all devices must make the same bytes of
 *
 * Sizes go past the ends of words, bricks and layers of bricks; small ones, for devices that are slow, just so.
 */
#ifndef CASES_H
#define CASES_H

#include "complex.h"
#include "tetracubes.h"

#include <stdbool.h>

enum {
    CASE_MISSING = 1,  /* NaN, or the value of has_nodata */
    CASE_NORMALS = 2,  /* not of complexes */
    CASE_BLANKED = 4,  /* samples and cells */
    CASE_EXTREMES = 8, /* floats of all exponents */
    CASE_DEEP = 16,    /* many layers of bricks, for slabs */
    CASE_CLOSED = 32,
    CASE_LABELS = 64,    /* samples are labels, with three and four of them in a cube */
    CASE_INTERVAL = 128, /* an interval volume, from the isovalue on */
};

typedef enum case_kind { CASE_UNIFORM, CASE_RECTILINEAR, CASE_CURVILINEAR, CASE_COMPLEX } case_kind;

typedef struct bytes_case {
    case_kind kind;
    tc_type type;
    tc_method method; /* tetra or hybrid, of complexes */
    unsigned flags;
    unsigned groups; /* bit n: is extracted by groups of 32 << n work-items, too */
    bool sampled;    /* is one of the few that are tried where time is short */
} bytes_case;

extern const bytes_case cases[];
extern const int case_count;

/* "u8 uniform, missing, normals". Valid until the next call. */
const char *case_name(const bytes_case *c);

/* A case filled with samples; ties with the isovalue are among them. */
typedef struct case_data {
    tc_grid_options grid;
    tc_tetrahedra_grid_options complex;
    tc_extract_options how; /* of surfaces */
    tc_labels_options labels;
    tc_interval_volume_options interval;
    tc_tetrahedra split; /* what complex borrows from, as from the next two */
    cell_list list;
    tc_cells cells;
    float *points;
    void *samples;
    float *axes[3];
    unsigned char *blanked_samples, *blanked_cells;
} case_data;

void case_fill(const bytes_case *c, bool small, case_data *data);
void case_free(case_data *data);

#endif
