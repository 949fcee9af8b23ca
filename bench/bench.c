/*
 * bench.c - tetracubes-bench: cases, each verified and then timed, beside the limits of the device's memory
 *
 * Everything measured is reached through the public API. With --turns the process is one of two peers that take turns
 * (peers.py): what happens between two turns, the release of the mesh included, is outside the timed part of both.
 */
#include "bench_options.h"
#include "device_limits.h"
#include "exit_status.h"
#include "failure.h"
#include "library_status.h"
#include "measure.h"
#include "progress.h"
#include "report.h"
#include "sweep.h"
#include "tune.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PATIENCE_MS   4000.0
#define WORKING_BYTES 2 /* per sample: an upper bound for device and reference together */

/* Makes a cold extraction for every line of standard input, until its end. A line "second" asks for one of the second
 * surface, which is no part of the report. */
static int take_turns(const measurement *m, case_result *result) {
    char line[256];
    double *times = NULL;
    int count = 0, status = 0;
    printf("ready\n");
    fflush(stdout);
    while (!status && fgets(line, sizeof line, stdin)) {
        double *grown = realloc(times, ((size_t)count + 1) * sizeof *times);
        if (!grown) {
            status = fail(STATUS_FAILED, "no memory for the times of %d turns", count);
            break;
        }
        times = grown;
        int second = strcmp(line, "second\n") == 0;
        status = second ? measure_second(m, &times[count]) : measure_cold(m, &times[count]);
        if (status) break;
        printf("%.6f\n", times[count]);
        count += !second;
        fflush(stdout);
        if (progress_cancelled()) status = progress_status();
    }
    if (!status) result->extract_ms = spread_of(times, count);
    free(times);
    return status;
}

/* Whether so many more bytes of memory may be taken in a sweep; if not, marks the case as left out, with a notice. */
static int case_fits(const bench_options *o, uint64_t bytes, const measurement *m, case_result *result) {
    uint64_t available = o->sweep ? sweep_memory() : UINT64_MAX;
    if (bytes <= available) return 1;
    snprintf(result->left_out, sizeof result->left_out, "it needs %" PRIu64 " MB of memory, %" PRIu64 " MB may be had",
             bytes >> 20, available >> 20);
    progress_clear();
    fprintf(stderr, "tetracubes-bench: %s is left out: %s\n", m->label, result->left_out);
    return 0;
}

static int case_measure(const bench_options *o, const measurement *m, const device_limits *limits,
                        case_result *result) {
    int status = measure_verify(m, result);
    if (!status && !o->turns) status = measure_cold_times(m, o->repeat, o->has_repeat ? INFINITY : PATIENCE_MS, result);
    if (o->turns) result->repeat = o->repeat;
    if (!status) status = measure_warm_times(m, limits, result);
    return status || !o->turns ? status : take_turns(m, result);
}

/* Describes the samples of case n of the command line, fields varying slowest, sizes fastest. */
static int case_samples(const bench_options *o, int n, samples *out) {
    int size = n % o->dims_count, type = n / o->dims_count % o->type_count, f = n / o->dims_count / o->type_count;
    int status = o->input ? samples_read(o, out) : samples_describe(o->fields[f], o->dims[size], o->types[type], out);
    if (!status) samples_place(out, o->grid);
    out->keeps_cells = o->grid == BENCH_HEXAHEDRA && o->method == TC_METHOD_HYBRID;
    return status;
}

/* Makes the samples, where they and then both engines' meshes fit, and measures. */
static int samples_measure(tc_context *context, const bench_options *o, samples *s, const device_limits *limits,
                           case_result *result) {
    measurement m;
    uint64_t working = s->bytes / tc_type_bytes(s->grid.type) * WORKING_BYTES, mesh = 0;
    measure_begin(context, s, o->method, o->iso, o->second, &m, result);
    if (!case_fits(o, s->bytes + s->coordinate_bytes + working, &m, result)) return 0;
    int status = samples_make(s);
    if (!status && o->sweep) status = measure_mesh_bytes(&m, &mesh);
    if (!status && case_fits(o, 2 * mesh + working, &m, result)) status = case_measure(o, &m, limits, result);
    progress_clear();
    return status;
}

/* Adds case n to the report, unless a sweep has no such case. */
static int case_run(tc_context *context, const bench_options *o, int n, bench_report *report) {
    samples s = {0};
    int status = case_samples(o, n, &s);
    if (!status && (!o->sweep || sweep_takes(s.made_from, s.grid.dims, s.grid.type)))
        status = samples_measure(context, o, &s, &report->limits, &report->cases[report->case_count++]);
    samples_release(&s);
    return status;
}

static int cases_run(tc_context *context, const bench_options *o) {
    bench_report report = {.device = {.struct_size = sizeof report.device}};
    int case_count = o->input ? 1 : o->field_count * o->dims_count * o->type_count;
    int has_table = !o->json && !o->turns;
    report.cases = calloc((size_t)case_count, sizeof *report.cases);
    int status = report.cases ? 0 : fail(STATUS_FAILED, "no memory for %d results", case_count);
    if (!status) status = library_status(tc_context_device(context, &report.device));
    if (!status) status = device_limits_measure(context, &report.limits);
    for (int n = 0; n < case_count && !status; n++) {
        status = case_run(context, o, n, &report);
        if (!status && has_table) report_table(&report);
    }
    if (!status && !has_table) status = report_json(&report);
    free(report.cases);
    return status;
}

static int dump_run(const bench_options *o) {
    samples s;
    int status = case_samples(o, 0, &s);
    if (!status) status = samples_make(&s);
    if (!status) status = samples_dump(&s, o->dump);
    progress_clear();
    if (!status) status = report_dump_json(&s);
    samples_release(&s);
    return status;
}

static int measure_run(const bench_options *o) {
    tc_context_options options;
    tc_context *context = NULL;
    tc_context_options_init(&options);
    options.device = o->device;
    int status = library_status(tc_context_create(&options, &context));
    if (!status) status = cases_run(context, o);
    tc_context_destroy(context);
    return status;
}

int main(int argc, char **argv) {
    bench_options o;
    int status = bench_options_parse(argc, argv, &o);
    if (!status && o.help) {
        bench_options_help(stdout);
    } else if (!status) {
        progress_begin(0);
        status = o.dump ? dump_run(&o) : o.tune ? tune_run(&o) : measure_run(&o);
        progress_clear();
    }
    if (!status && (fflush(stdout) || ferror(stdout)))
        status = fail(STATUS_FAILED, "standard output cannot be written: %s", strerror(errno));
    if (status) fprintf(stderr, "tetracubes-bench: %s\n", failure_text());
    return status;
}
