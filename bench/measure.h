/*
 * measure.h - one case: verified against the reference, then timed
 *
 * Times are the library's own, tc_timings; what tc_grid_create takes is not counted. There are three kinds:
 *   cold     the first extraction on a new grid into a new mesh; the one before was destroyed, outside the timed part,
 *            and the context kept its memory
 *   warm     the first extraction on a new grid into the mesh of the extraction before
 *   second   another isovalue on the same grid, after a warm one
 * On a new grid nothing is known of the samples. The context keeps its working buffers in all three.
 */
#ifndef MEASURE_H
#define MEASURE_H

#include "device_limits.h"
#include "samples.h"
#include "spread.h"
#include "tetracubes.h"

/* Warm extractions. */
typedef struct stage_times {
    spread classify_ms, emit_ms, total_ms;
} stage_times;

typedef struct surface {
    double iso;
    uint64_t vertex_count, triangle_count, hash;
} surface;

typedef struct case_result {
    const char *field;
    int64_t dims[3];
    tc_type type;
    const char *grid;
    tc_method method;
    uint64_t sample_bytes, mesh_bytes; /* of the first surface */
    uint64_t cell_bytes;               /* of tetrahedra */
    surface first, second;
    int repeat; /* timed extractions of each kind */
    spread extract_ms;
    stage_times first_times, second_times;
    spread reference_ms; /* of one run */
    double limit_ms, limit_ratio;
    char left_out[160]; /* why a sweep did not measure this case: all but its name is 0; else "" */
} case_result;

/* A case in hand; owns nothing. */
typedef struct measurement {
    tc_context *context;
    const samples *samples;
    tc_extract_options first, second;
    char label[128]; /* for progress and messages */
} measurement;

/* Names the case in *m and *result. */
void measure_begin(tc_context *context, const samples *s, tc_method method, double iso, double second_iso,
                   measurement *m, case_result *result);

/* *bytes: what the larger of the two meshes takes. */
int measure_mesh_bytes(const measurement *m, uint64_t *bytes);

/* Compares every byte of the first surface with the reference's, and the hash of the second with its hash on a new
 * grid; fills the surfaces and reference_ms. STATUS_CHECK where they differ. */
int measure_verify(const measurement *m, case_result *result);

/* Milliseconds of one cold extraction. */
int measure_cold(const measurement *m, double *ms);

/* Milliseconds of one of the second surface into a new mesh, after the first on the same grid. */
int measure_second(const measurement *m, double *ms);

/* `repeat` cold extractions to result->extract_ms; fewer, but three at least, once patience_ms have passed.
 * result->repeat says how many. */
int measure_cold_times(const measurement *m, int repeat, double patience_ms, case_result *result);

/* result->repeat warm extractions of each kind to the other times of the device, and the ratio to the limits. */
int measure_warm_times(const measurement *m, const device_limits *limits, case_result *result);

#endif
