/* volume_report.h - what isovolume found out, as the JSON object of README.md or as text for people */
#ifndef VOLUME_REPORT_H
#define VOLUME_REPORT_H

#include "command_line/options.h"
#include "complex_check.h"
#include "extract/carried_fields.h"
#include "input/input_summary.h"
#include "terminal/run_times.h"
#include "tetrahedra_measure.h"

/* One range's results: sums over the blocks. */
typedef struct volume_report {
    const typed_range *range;
    uint64_t sample_count, low_count, high_count, tetrahedron_count, bytes;
    double classify_ms, emit_ms, readback_ms;
    uint32_t slab_count;
    int has_volume; /* 0: counted only; then the rest is not filled */
    double volume;
    double *integrals; /* of carried fields, component by component; from malloc */
    int has_shapes;
    tetrahedra_shapes shapes;
    complex_faces faces;
    int has_verdict, verified;
    char *path; /* of the file written, or NULL; from malloc */
} volume_report;

typedef struct isovolume_report {
    const options *o;
    tc_engine engine;
    char device[160]; /* "" for the reference engine */
    input_summary input;
    const carried_fields *carried;
    run_times times;
    volume_report *volumes;
    size_t volume_count;
} isovolume_report;

/* Prints the whole report on standard output. Returns 0 or STATUS_FAILED where memory runs out. */
int isovolume_report_json(const isovolume_report *report);
void isovolume_report_text(const isovolume_report *report);

#endif
