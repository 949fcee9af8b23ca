/* statistics.h - range, histogram and isovalues worth trying, of the samples that are finite and not missing */
#ifndef STATISTICS_H
#define STATISTICS_H

#include "tetracubes.h"

#define STATISTICS_BINS 256

/* Samples of one block. */
typedef struct sample_array {
    tc_type type;
    const void *samples;
    uint64_t count;
    const uint8_t *blanked; /* one per sample, nonzero: missing; NULL: none */
    int has_nodata;         /* samples equal to nodata are missing */
    double nodata;
    const uint8_t *used; /* one per sample; zero: no cell uses it, it does not count; NULL: all are used */
} sample_array;

/*
 * Bins have one width: bin n holds low + n width <= v < low + (n + 1) width. Of integer samples the width is a whole
 * number and the edges lie half-way between integers, so that no sample equals an edge; of others bins divide the
 * range, and the last one holds the maximum too.
 */
typedef struct statistics {
    uint64_t finite_count, nonfinite_count;
    uint64_t missing_count;  /* blanked, or equal to nodata: not among the other two */
    double minimum, maximum; /* of the finite samples; zeros where there are none */
    int bin_count;           /* 0 where there are none */
    double low, width;
    uint64_t bins[STATISTICS_BINS];
} statistics;

typedef struct suggestion {
    double isovalue;
    const char *name;   /* "otsu", "otsu-upper", "otsu-lower", "middle" */
    const char *reason; /* one line */
} suggestion;

#define SUGGESTIONS_MAX 4

/* Of all arrays together. */
void statistics_of(const sample_array *arrays, int count, statistics *out);

/* Least and greatest of what is finite and present in all arrays; 0 where nothing is. */
int statistics_extent(const sample_array *arrays, int count, double range[2]);

/* Samples, present ones, that equal the value. */
uint64_t statistics_count_equal(const sample_array *arrays, int count, double value);

/* Least and greatest finite value of every stride-th sample from the first on; 0 where there is none. */
int statistics_range(const sample_array *array, int first, int stride, double range[2]);

/* Isovalues that some sample reaches and some does not, the most useful first. Returns how many. */
int statistics_suggest(const statistics *s, suggestion out[SUGGESTIONS_MAX]);

#endif
