/*
 * measure.h - one case: a grid on the device, verified against the reference, then timed
 *
 * Times are the library's own, tc_timings. An extraction is *cold* when its mesh is new (its memory is allocated and
 * first touched within the timed part, and given back outside it) and *warm* when the mesh of the one before is reused;
 * the context keeps its working buffers in both.
 */
#ifndef MEASURE_H
#define MEASURE_H

#include "device_limits.h"
#include "samples.h"
#include "tetracubes.h"

typedef struct spread {
    double median, min, max;
} spread;

typedef struct case_result {
    const char *field;
    int64_t dims[3];
    tc_type type;
    double iso;
    uint64_t vertex_count, triangle_count, hash;
    uint64_t sample_bytes, mesh_bytes;
    spread classify_ms, emit_ms, extract_ms, extract_warm_ms; /* classify and emit: of warm extractions */
    spread reference_ms;                                      /* of one run */
    double limit_ms, limit_ratio;
} case_result;

/* A case in hand. */
typedef struct measurement {
    tc_grid *grid;
    tc_extract_options how;
    char label[128]; /* for progress and messages */
} measurement;

/* Makes the grid, extracts with both engines and compares every byte; fills all of result but the times of the device
 * and what follows from them. STATUS_CHECK where the engines differ. m is to be closed in any case. */
int measure_open(tc_context *context, const samples *s, double iso, measurement *m, case_result *result);

/* Milliseconds of one cold extraction. */
int measure_cold(measurement *m, double *ms);

/* repeat cold extractions to result->extract_ms. */
int measure_cold_times(measurement *m, int repeat, case_result *result);

/* repeat warm extractions to the other times of the device, and the ratio to the limits. */
int measure_warm_times(measurement *m, int repeat, const device_limits *limits, case_result *result);

void measure_close(measurement *m);

/* Sorts the values. */
spread spread_of(double *values, int count);

/* The exit status for a status of the library, its message taken over; 0 for TC_OK. */
int library_status(tc_status status);

#endif
