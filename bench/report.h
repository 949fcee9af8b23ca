/* report.h - what the benchmark found out, as JSON or as a table for people */
#ifndef REPORT_H
#define REPORT_H

#include "measure.h"

typedef struct bench_report {
    tc_device_info device;
    device_limits limits;
    const case_result *cases;
    int case_count;
} bench_report;

/* One object on standard output. Returns 0, or STATUS_FAILED with its text (failure.h). */
int report_json(const bench_report *report);

/* The object that --dump prints: dims and type. */
int report_dump_json(const samples *s);

/* The table comes line by line, as cases are done. */
void report_head(const bench_report *report);
void report_row(const case_result *result);

#endif
