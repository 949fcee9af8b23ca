/* samples.h - the samples of a case: made from an analytic field, or read from a file */
#ifndef SAMPLES_H
#define SAMPLES_H

#include "bench_options.h"
#include "dataset/dataset.h"

#include <stdbool.h>

typedef struct samples {
    const field *made_from; /* NULL: a file */
    const char *name;       /* of the field, or of the file without its folders */
    tc_grid_options grid;
    uint64_t bytes;
    void *made;   /* page-aligned, so that a device that shares the host's memory uses it in place; or NULL */
    dataset read; /* the file's, where there is one */
    bench_grid placed;
    float *coordinates; /* axes one after the other, or points; page-aligned, or NULL */
    uint64_t coordinate_bytes;
    tc_tetrahedra complex; /* unstructured: the tetrahedra between the points */
    tc_cells cells;        /* the hexahedra that these were cut from, or none; the arrays are its own */
    bool keeps_cells;      /* grids are given these: for method hybrid */
} samples;

/* Describes samples of an analytic field, for samples_make to take the memory for; the matrix is the one that
 * `tetracubes generate` writes, so that hashes agree. Returns 0 or an exit status with its message (failure.h); out is
 * to be released in any case. */
int samples_describe(const field *f, const int64_t dims[3], tc_type type, samples *out);

/* Sets the kind of the grid, described or read: samples_make then makes its coordinates, each a small smooth step off
 * its uniform position in [-1, 1]. Coordinates that the grid has already are kept. */
void samples_place(samples *s, bench_grid grid);

/* Makes the samples that were described, and the coordinates. Samples of a file exist already. */
int samples_make(samples *s);

/* Memory to be unmapped, in huge pages: so does the measurement of bandwidth, and so do the readers and numpy with
 * their arrays. */
int memory_make(uint64_t bytes, const char *what, void **out);

/* Samples of the file o->input, likewise. */
int samples_read(const bench_options *o, samples *out);

/* Writes them as they lie in memory. Returns 0 or STATUS_FAILED. */
int samples_dump(const samples *s, const char *path);

void samples_release(samples *s);

#endif
