/*
 * subject.h - a random grid of a kind and a sample type, which its seed repeats
 *
 * Most are tiny, so that many can be tried; some reach over the ends of words of 64 samples and of bricks. Samples are
 * noise, waves, integers 0 to 3, integers within one of the isovalue, or the extremes of their type. Matrices, axes and
 * points may mirror; points are moved at random, at times so far that cells fold.
 */
#ifndef SUBJECT_H
#define SUBJECT_H

#include "complex.h"
#include "tetracubes.h"

#include <stdbool.h>

typedef enum kind {
    UNIFORM,
    RECTILINEAR,
    CURVILINEAR,
    MISSING, /* any of the above with missing samples, blanked samples or blanked cells */
    HYBRID,  /* any of the above by the hybrid method */
    TETRAHEDRA,
    HEXAHEDRA,
    MIXED, /* hexahedra, voxels, wedges, pyramids and tetrahedra */
    KINDS
} kind;

enum { SUBJECT_SAMPLES = 4096 };

typedef struct subject {
    kind kind;
    tc_extract_options how;
    bool complete; /* nothing is missing */
    bool mirrored; /* structured grids: the map to the world turns them over */
    bool folded;   /* cells may have volumes of either sign */

    tc_grid_options grid; /* structured grids */
    float points[3 * SUBJECT_SAMPLES], axes[3][SUBJECT_SAMPLES];
    uint8_t blanked_samples[SUBJECT_SAMPLES], blanked_cells[SUBJECT_SAMPLES];

    tc_tetrahedra_grid_options cells; /* the others */
    cell_list list;
    tc_tetrahedra complex;
    uint64_t boundary_faces;       /* triangles that the complex, where it is complete, ends in */
    double volume;                 /* six times its volume */
    const uint8_t *blanked_points; /* or NULL */
    uint64_t left_out_count;       /* cells that are blanked, or have a blanked point */

    tc_type type;
    int64_t sample_count;
    double samples[SUBJECT_SAMPLES]; /* aligned for every type */
} subject;

const char *kind_name(kind k);
static inline bool kind_is_structured(kind k) { return k <= HYBRID; }

void subject_make(subject *s, kind k, tc_type type, uint64_t seed);

/* So many samples, of type u8 and all outside the isovalue 1: of structured kinds a uniform grid, of others no cells.
 */
void subject_make_plain(subject *s, kind k, const int64_t dims[3]);

/* Cuts the cells of the list, of which all take part, into the complex. */
void subject_cut(subject *s);
void subject_free(subject *s);

/* Whether a sample takes part. */
bool subject_has(const subject *s, int64_t sample);

/* Where a sample lies in the world. */
void subject_place(const subject *s, int64_t sample, double out[3]);

/* By the context's engine; its message where it fails. */
tc_status subject_extract(const subject *s, tc_context *context, tc_mesh **mesh, tc_mesh_data *data);

#endif
