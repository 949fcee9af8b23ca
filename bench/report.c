#include "report.h"

#include "exit_status.h"
#include "failure.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ------------------------------------------------------------------------------------------------------------ JSON */

static json_t *rounded(double value, double unit) { return json_real(round(value / unit) * unit); }

static json_t *spread_json(spread s) {
    return json_pack("{s:o, s:o, s:o}", "median", rounded(s.median, 1e-4), "min", rounded(s.min, 1e-4), "max",
                     rounded(s.max, 1e-4));
}

static json_t *dims_json(const int64_t dims[3]) {
    return json_pack("[I, I, I]", (json_int_t)dims[0], (json_int_t)dims[1], (json_int_t)dims[2]);
}

static json_t *case_json(const case_result *c) {
    char hash[24];
    snprintf(hash, sizeof hash, "%016" PRIx64, c->hash);
    json_t *object = json_object();
    json_object_set_new(object, "field", json_string(c->field));
    json_object_set_new(object, "dims", dims_json(c->dims));
    json_object_set_new(object, "type", json_string(tc_type_name(c->type)));
    json_object_set_new(object, "iso", json_real(c->iso));
    json_object_set_new(object, "method", json_string("tetra"));
    json_object_set_new(object, "vertices", json_integer((json_int_t)c->vertex_count));
    json_object_set_new(object, "triangles", json_integer((json_int_t)c->triangle_count));
    json_object_set_new(object, "hash", json_string(hash));
    json_object_set_new(object, "classify_ms", spread_json(c->classify_ms));
    json_object_set_new(object, "emit_ms", spread_json(c->emit_ms));
    json_object_set_new(object, "extract_ms", spread_json(c->extract_ms));
    json_object_set_new(object, "extract_warm_ms", spread_json(c->extract_warm_ms));
    json_object_set_new(object, "reference_ms", spread_json(c->reference_ms));
    json_object_set_new(object, "limit_ms", rounded(c->limit_ms, 1e-6));
    json_object_set_new(object, "limit_ratio", rounded(c->limit_ratio, 1e-3));
    return object;
}

static int print(json_t *object) {
    int failed = !object || json_dumpf(object, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(12));
    json_decref(object);
    if (failed) return fail(STATUS_FAILED, "could not print the report: out of memory, or standard output is full");
    putchar('\n');
    return 0;
}

int report_json(const bench_report *report) {
    json_t *cases = json_array();
    for (int n = 0; n < report->case_count; n++) json_array_append_new(cases, case_json(&report->cases[n]));
    return print(json_pack("{s:s, s:s, s:o, s:o, s:o}", "device", report->device.name, "driver", report->device.driver,
                           "read_gbps", rounded(report->limits.read_gbps, 1e-2), "write_gbps",
                           rounded(report->limits.write_gbps, 1e-2), "cases", cases));
}

int report_dump_json(const samples *s) {
    return print(json_pack("{s:o, s:s}", "dims", dims_json(s->grid.dims), "type", tc_type_name(s->grid.type)));
}

/* ----------------------------------------------------------------------------------------------------------- table */

void report_head(const bench_report *report) {
    printf("%s (%s, %s %s): reads %.1f GB/s, writes %.1f GB/s\n\n", report->device.name, report->device.type,
           report->device.platform, report->device.driver, report->limits.read_gbps, report->limits.write_gbps);
    printf("%-25s %10s %22s %10s = %8s + %8s %7s %8s %9s %6s %10s\n", "", "", "new mesh", "kept mesh", "classify",
           "emit", "", "", "limit", "", "reference");
    printf("%-25s %10s %22s %10s   %8s   %8s %7s %8s %9s %6s %10s\n", "case", "triangles", "ms (min - max)", "ms", "ms",
           "ms", "GB/s", "Mtri/s", "ms", "ratio", "ms");
    fflush(stdout);
}

void report_row(const case_result *c) {
    char name[128], size[80], times[64];
    const int64_t *d = c->dims;
    if (d[0] == d[1] && d[1] == d[2])
        snprintf(size, sizeof size, "%" PRId64 "^3", d[0]);
    else
        snprintf(size, sizeof size, "%" PRId64 "x%" PRId64 "x%" PRId64, d[0], d[1], d[2]);
    snprintf(name, sizeof name, "%.24s %s %s", c->field, size, tc_type_name(c->type));
    snprintf(times, sizeof times, "%.2f (%.2f - %.2f)", c->extract_ms.median, c->extract_ms.min, c->extract_ms.max);
    double warm_ms = c->extract_warm_ms.median;
    printf("%-25s %10" PRIu64 " %22s %10.2f   %8.2f   %8.2f %7.2f %8.2f %9.3f %6.2f %10.1f\n", name, c->triangle_count,
           times, warm_ms, c->classify_ms.median, c->emit_ms.median,
           (double)(c->sample_bytes + c->mesh_bytes) / warm_ms * 1e-6, (double)c->triangle_count / warm_ms * 1e-3,
           c->limit_ms, c->limit_ratio, c->reference_ms.median);
    fflush(stdout);
}
