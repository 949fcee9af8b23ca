/*
 * volume.h - what the readers of images produce: the samples of a uniform grid in memory, native byte order, x fastest
 */
#ifndef VOLUME_H
#define VOLUME_H

#include "tetracubes.h"

typedef struct volume {
    int64_t dims[3];
    int64_t first[3]; /* extent index of the first sample; 0 in most formats */
    tc_type type;
    int components;      /* values per sample, one after another: 1 but where the request leaves them together */
    int64_t frames;      /* volumes to choose from, of which this is the first; 1 where one was chosen, or is alone */
    char meaning[32];    /* of the components, "red, green, blue"; "" where unknown */
    const void *samples; /* into mapping or allocation */
    double matrix[3][4]; /* index space to world, as tc_grid_options.matrix */
    char format[24];     /* "raw", "NRRD", "MetaImage", "NIfTI-1", "NIfTI-2" */
    char space[64];      /* the file's name of its world space, or "" */
    char notice[256];    /* something the user should know about how the file was read, or "" */

    void *mapping; /* a file mapped into memory, or NULL */
    size_t mapping_bytes;
    void *allocation; /* memory from malloc, or NULL */
} volume;

/* In place of the number of a component. */
enum { COMPONENT_OPEN = -1, COMPONENT_MAGNITUDE = -2 };

/* What the command line says about the input. */
typedef struct read_request {
    const char *path;
    const char
        *path2;      /* the second input of formats in two files (Plot3D: grid, then solution); NULL where not given */
    int64_t dims[3]; /* raw: required; all 0 where not given */
    int type;        /* raw: a tc_type; -1 where not given */
    int big_endian;  /* raw: 1 big, 0 little */
    uint64_t skip;   /* raw: bytes before the samples */
    double spacing[3]; /* raw, others where has_spacing; 1, 1, 1 by default */
    double origin[3];  /* raw, others where has_origin: position of the sample of index 0, 0, 0; 0, 0, 0 by default */
    int has_spacing;   /* stands for what the header says, if it does */
    int has_origin;    /* likewise */
    int component;     /* of data with several values per sample, or one of the above: of images, COMPONENT_OPEN is an
                          error where there is a choice, and COMPONENT_MAGNITUDE leaves all in the volume */
    int frame;         /* of data with a fourth axis; -1 where not given */
    int describe;      /* of images: choices that are left open are no error: all components, the first frame */
} read_request;

/* Defaults: as the comments above say. */
void read_request_init(read_request *request, const char *path);

/* Reads the file in the format that its content, else its ending, tells; raw where request->dims are given.
 * Returns 0 and a volume to be released, or an exit status (exit_status.h) with its text (failure.h), *out zeroed. */
int volume_read(const read_request *request, volume *out);

/* Adds to the notice: sentences are joined by "; ", what has no room is left out. */
void volume_notice(volume *v, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Frees or unmaps the samples and zeroes *v. */
void volume_release(volume *v);

/* The formats this program was built with, one line, e.g. "raw, NRRD (gzip, bzip2), MetaImage, NIfTI". */
const char *volume_formats(void);

#endif
