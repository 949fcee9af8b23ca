/* request.h - what the command line says about the input, to readers and to the choice of a field (select.h) */
#ifndef REQUEST_H
#define REQUEST_H

#include <stdint.h>

/* Values of read_request.component that are no component. */
enum { COMPONENT_OPEN = -1, COMPONENT_MAGNITUDE = -2 };

/* A region of every structured grid (region.h): a box of samples, of which every step-th one is taken along each axis.
 */
typedef struct index_ranges {
    int64_t begin[3], end[3]; /* end: behind the last; INT64_MIN and INT64_MAX: all there is */
} index_ranges;

typedef struct world_ranges {
    double low[3], high[3]; /* infinite: all there is */
} world_ranges;

typedef struct region_request {
    int has_indices, has_world; /* one of them, or none */
    index_ranges indices;
    world_ranges world;
    int64_t step[3]; /* 0 counts as 1 */
} region_request;

typedef struct read_request {
    const char *path;
    const char *path2;  /* the second input of formats in two files (Plot3D: grid, then solution); NULL: not given */
    const char *inside; /* HDF5: the name of a dataset in the file; NULL: the only one */
    int64_t dims[3];    /* raw: required; all 0 where not given */
    int type;           /* raw: a tc_type; -1 where not given */
    int big_endian;     /* raw: 1 big, 0 little */
    uint64_t skip;      /* raw: bytes before the samples */
    double spacing[3];  /* raw, others where has_spacing; 1, 1, 1 by default */
    double origin[3];   /* raw, others where has_origin: position of the sample of index 0, 0, 0; 0, 0, 0 by default */
    int has_spacing;    /* spacing replaces what the header says */
    int has_origin;     /* likewise */
    int component;      /* of data with several values per sample, or one of the above. Of images, COMPONENT_OPEN is an
                           error where there is a choice, and COMPONENT_MAGNITUDE keeps all components in the field */
    int frame;          /* of data with a fourth axis; -1 where not given */
    int describe;       /* of images: choices that are left open are no error; all components and frame 0 are read */
    const char *field;  /* the one that is contoured; NULL: the only one there is */
    int has_nodata;     /* its values equal to nodata (nodata.h) are missing, as are those that are not finite */
    double nodata;
    region_request region;
    const char *mask; /* a volume of the same size, whose zeros say which samples are missing (mask.h); NULL: none */

    /* Of a mask that is read: */
    const struct dataset *like; /* its blocks have to have the sizes of these, and the same regions are taken of them */
    int raw_else;               /* dims and type are those of a file whose format is not known */
} read_request;

/* Defaults: as the comments above say. */
static inline void read_request_init(read_request *request, const char *path) {
    *request = (read_request){.path = path, .type = -1, .spacing = {1, 1, 1}, .component = COMPONENT_OPEN, .frame = -1};
}

#endif
