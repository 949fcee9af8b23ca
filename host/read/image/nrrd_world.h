/* nrrd_world.h - what an NRRD header says, as its parser (nrrd.c) leaves it; and its axes and world space */
#ifndef NRRD_WORLD_H
#define NRRD_WORLD_H

#include "image/source.h"

enum nrrd_center { CENTER_UNKNOWN, CENTER_CELL, CENTER_NODE };
enum nrrd_kind { KIND_UNKNOWN, KIND_SPACE, KIND_COMPONENT, KIND_TIME };

typedef struct nrrd_header {
    const char *path;
    const read_request *request;
    int dimension; /* 0: not given yet */
    int element;   /* -1: not given yet */
    int endian;    /* 0: not given, else __ORDER_LITTLE_ENDIAN__ or __ORDER_BIG_ENDIAN__ */
    int has_encoding;
    int is_detached;
    source from;

    int64_t sizes[MAX_AXES];
    double spacings[MAX_AXES];
    double mins[MAX_AXES];
    double maxs[MAX_AXES];
    enum nrrd_center centers[MAX_AXES];
    enum nrrd_kind kinds[MAX_AXES];
    double directions[MAX_AXES][3]; /* NaN: none */
    double origin[3];               /* NaN: not known */
    int has_sizes, has_spacings, has_mins, has_maxs, has_kinds, has_directions, has_origin;
    char space[64], units[16];
    uint32_t seen;     /* a bit per field that was met */
    char repeated[32]; /* the name of a field that was met twice, or "" */
} nrrd_header;

/* Parses "space directions" or "space origin": count vectors "(x,y,z)", or "none" or "(nan,nan,nan)" (NaN). In a space
 * with time the fourth number is dropped, and a direction along time alone is as "none". */
int nrrd_vectors(const nrrd_header *h, const char *text, const char *field, double (*vectors)[3], int count);

/* Where no direction is known, the header counts as one without directions; a notice says so. */
void nrrd_settle_directions(nrrd_header *h, dataset *out);

/* Takes the units that all axes of "space units" or "units" have that have one. */
void nrrd_units(nrrd_header *h, const char *text);

/* Names the world space, and where its axes point, if the header says so. */
void nrrd_name_world(const nrrd_header *h, dataset *out);

/* Which axes are of space, components and frames. */
void nrrd_axes(const nrrd_header *h, axes *out);

/* Fills the matrix, index space to world, in the space that the header names; what is not known is taken for 1 or 0,
 * with a notice. */
int nrrd_matrix(const nrrd_header *h, const axes *a, dataset *out);

#endif
