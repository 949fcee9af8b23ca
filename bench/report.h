/* report.h - what the benchmark found out, as JSON or as a table for people */
#ifndef REPORT_H
#define REPORT_H

#include "measure.h"

typedef struct bench_report {
    tc_device_info device;
    device_limits limits;
    case_result *cases; /* those left out, too */
    int case_count;
    int printed; /* by report_table */
} bench_report;

/* One object on standard output. Returns 0, or STATUS_FAILED with its message (failure.h). */
int report_json(const bench_report *report);

/* The object that --dump prints: dims and type. */
int report_dump_json(const samples *s);

/* Prints the rows of cases that are new, the head before the first one. */
void report_table(bench_report *report);

#endif
