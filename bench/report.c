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

/* Field, dims and type: what names a case. */
static json_t *name_json(const case_result *c) {
    return json_pack("{s:s, s:o, s:s}", "field", c->field, "dims", dims_json(c->dims), "type", tc_type_name(c->type));
}

static void set_hash(json_t *object, const char *key, uint64_t hash) {
    char text[24];
    snprintf(text, sizeof text, "%016" PRIx64, hash);
    json_object_set_new(object, key, json_string(text));
}

static json_t *case_json(const case_result *c) {
    json_t *object = name_json(c);
    json_object_set_new(object, "iso", json_real(c->first.iso));
    json_object_set_new(object, "grid", json_string(c->grid));
    json_object_set_new(object, "method", json_string(tc_method_name(c->method)));
    json_object_set_new(object, "vertices", json_integer((json_int_t)c->first.vertex_count));
    json_object_set_new(object, "triangles", json_integer((json_int_t)c->first.triangle_count));
    set_hash(object, "hash", c->first.hash);
    json_object_set_new(object, "repeats", json_integer(c->repeat));
    json_object_set_new(object, "classify_ms", spread_json(c->first_times.classify_ms));
    json_object_set_new(object, "emit_ms", spread_json(c->first_times.emit_ms));
    json_object_set_new(object, "extract_ms", spread_json(c->extract_ms));
    json_object_set_new(object, "extract_warm_ms", spread_json(c->first_times.total_ms));
    json_object_set_new(object, "second_iso", json_real(c->second.iso));
    json_object_set_new(object, "second_vertices", json_integer((json_int_t)c->second.vertex_count));
    json_object_set_new(object, "second_triangles", json_integer((json_int_t)c->second.triangle_count));
    set_hash(object, "second_hash", c->second.hash);
    json_object_set_new(object, "second_classify_ms", spread_json(c->second_times.classify_ms));
    json_object_set_new(object, "second_emit_ms", spread_json(c->second_times.emit_ms));
    json_object_set_new(object, "second_warm_ms", spread_json(c->second_times.total_ms));
    json_object_set_new(object, "reference_ms", spread_json(c->reference_ms));
    json_object_set_new(object, "limit_ms", rounded(c->limit_ms, 1e-6));
    json_object_set_new(object, "limit_ratio", rounded(c->limit_ratio, 1e-3));
    return object;
}

static json_t *left_out_json(const case_result *c) {
    json_t *object = name_json(c);
    json_object_set_new(object, "reason", json_string(c->left_out));
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
    json_t *cases = json_array(), *left_out = json_array();
    for (const case_result *c = report->cases; c < report->cases + report->case_count; c++)
        if (c->left_out[0])
            json_array_append_new(left_out, left_out_json(c));
        else
            json_array_append_new(cases, case_json(c));
    return print(json_pack("{s:s, s:s, s:o, s:o, s:o, s:o}", "device", report->device.name, "driver",
                           report->device.driver, "read_gbps", rounded(report->limits.read_gbps, 1e-2), "write_gbps",
                           rounded(report->limits.write_gbps, 1e-2), "cases", cases, "left_out", left_out));
}

int report_dump_json(const samples *s) {
    return print(json_pack("{s:o, s:s}", "dims", dims_json(s->grid.dims), "type", tc_type_name(s->grid.type)));
}

/* ----------------------------------------------------------------------------------------------------------- table */

static void print_head(const bench_report *report) {
    printf("%s (%s, %s %s): reads %.1f GB/s, writes %.1f GB/s\n\n", report->device.name, report->device.type,
           report->device.platform, report->device.driver, report->limits.read_gbps, report->limits.write_gbps);
    printf("%-25s %11s %22s %9s = %8s + %8s %7s %9s %6s %9s, %8s %9s\n", "", "", "new mesh", "kept mesh", "classify",
           "emit", "", "limit", "", "second", "classify", "reference");
    printf("%-25s %11s %22s %9s   %8s   %8s %7s %9s %6s %9s  %8s %9s\n", "case", "triangles", "ms (min - max)", "ms",
           "ms", "ms", "GB/s", "ms", "ratio", "ms", "ms", "ms");
}

static void print_row(const case_result *c) {
    char name[128], size[80], times[64];
    const int64_t *d = c->dims;
    if (d[0] == d[1] && d[1] == d[2])
        snprintf(size, sizeof size, "%" PRId64 "^3", d[0]);
    else
        snprintf(size, sizeof size, "%" PRId64 "x%" PRId64 "x%" PRId64, d[0], d[1], d[2]);
    snprintf(name, sizeof name, "%.24s %s %s%s%s", c->field, size, tc_type_name(c->type), c->method ? " " : "",
             c->method ? tc_method_name(c->method) : "");
    snprintf(times, sizeof times, "%.2f (%.2f - %.2f)", c->extract_ms.median, c->extract_ms.min, c->extract_ms.max);
    double warm_ms = c->first_times.total_ms.median;
    printf("%-25s %11" PRIu64 " %22s %9.2f   %8.2f   %8.2f %7.2f %9.3f %6.2f %9.2f  %8.2f %9.1f\n", name,
           c->first.triangle_count, times, warm_ms, c->first_times.classify_ms.median, c->first_times.emit_ms.median,
           (double)(c->sample_bytes + c->mesh_bytes) / warm_ms * 1e-6, c->limit_ms, c->limit_ratio,
           c->second_times.total_ms.median, c->second_times.classify_ms.median, c->reference_ms.median);
}

void report_table(bench_report *report) {
    for (; report->printed < report->case_count; report->printed++) {
        if (report->printed == 0) print_head(report);
        const case_result *c = &report->cases[report->printed];
        if (!c->left_out[0]) print_row(c);
    }
    fflush(stdout);
}
