#include "label_report.h"

#include "counted.h"
#include "input/region_report.h"
#include "output.h"
#include "progress.h"
#include "shortest.h"
#include "terminal/json_report.h"
#include "terminal/notice.h"

#include <inttypes.h>
#include <stdio.h>

static json_t *row_json(const label_report *r, const label_row *row) {
    const mesh_topology *t = &row->topology;
    json_t *object =
        json_pack("{s:o, s:o}", "label", count_json(row->label), "triangles", count_json(row->triangle_count));
    if (row->path) json_object_set_new(object, "output", string_json(row->path));
    if (!r->o->check) return object;
    json_object_set_new(object, "boundary_edges", count_json(t->boundary_edges));
    json_object_set_new(object, "nonmanifold_edges", count_json(t->nonmanifold_edges));
    json_object_set_new(object, "nonmanifold_vertices", count_json(t->nonmanifold_vertices));
    json_object_set_new(object, "misoriented_edges", count_json(t->misoriented_edges));
    json_object_set_new(object, "euler_characteristic", json_integer((json_int_t)t->euler_characteristic));
    json_object_set_new(object, "components", count_json(t->components));
    json_object_set_new(object, "area", real_json(t->area));
    json_object_set_new(object, "volume", t->unbalanced_edges ? json_null() : real_json(t->volume));
    return object;
}

static json_t *timings_json(const label_report *r) {
    json_t *object = run_times_json(&r->times);
    json_object_set_new(object, "classify", ms_json(r->timings.classify_ms));
    json_object_set_new(object, "emit", ms_json(r->timings.emit_ms));
    json_object_set_new(object, "readback", ms_json(r->timings.readback_ms));
    json_object_set_new(object, "extract", ms_json(r->timings.total_ms));
    return object;
}

static int print_json(const label_report *r) {
    char hash[24];
    json_t *rows = json_array(), *object = json_object();
    const char *named = r->o->separate_labels ? r->o->output : r->path;
    snprintf(hash, sizeof hash, "%016" PRIx64, r->hash);
    for (size_t n = 0; n < r->row_count; n++) json_array_append_new(rows, row_json(r, &r->rows[n]));
    json_object_set_new(object, "input", string_json(r->o->operands[0]));
    json_object_set_new(object, "output", named ? string_json(named) : json_null());
    if (r->preview) json_object_set_new(object, "preview", string_json(r->preview));
    json_object_set_new(object, "device", r->device[0] ? string_json(r->device) : json_null());
    json_object_set_new(object, "engine", json_string(r->device[0] ? "opencl" : "reference"));
    json_object_set_new(object, "dims", integers_json(r->grid->dims));
    region_report_json(object, r->grid);
    json_object_set_new(object, "smoothing", count_json(r->smoothing));
    json_object_set_new(object, "closed", json_boolean(r->o->closed));
    json_object_set_new(object, "vertices", count_json(r->vertex_count));
    json_object_set_new(object, "triangles", count_json(r->triangle_count));
    json_object_set_new(object, "active_cells", count_json(r->active_cell_count));
    json_object_set_new(object, "degenerate_triangles", count_json(r->degenerate_triangles));
    json_object_set_new(object, "bounds",
                        r->vertex_count ? json_pack("[o, o]", reals_json(r->bounds[0], 3), reals_json(r->bounds[1], 3))
                                        : json_null());
    json_object_set_new(object, "hash", json_string(hash));
    json_object_set_new(object, "labels", rows);
    if (r->has_verdict) json_object_set_new(object, "verified", json_boolean(r->verified));
    json_object_set_new(object, "timings_ms", timings_json(r));
    json_object_set_new(object, "notices", notices_json());
    return json_report_print(object);
}

static void print_row(const label_report *r, const label_row *row) {
    const mesh_topology *t = &row->topology;
    printf("  label %-5" PRIu32 " %s", row->label, counted(row->triangle_count, "triangle", "triangles").text);
    if (r->o->check) {
        printf(", %s, %s, Euler characteristic %" PRId64 ", %s, area %.7g",
               t->nonmanifold_edges || t->nonmanifold_vertices || t->misoriented_edges ? "not a manifold" : "manifold",
               t->boundary_edges ? "open" : "closed", t->euler_characteristic,
               counted(t->components, "component", "components").text, t->area);
        if (!t->unbalanced_edges) printf(", volume %.7g", t->volume);
    }
    if (row->path) printf(", %s", row->path);
    printf("\n");
}

static void print_text(const label_report *r) {
    const int64_t *dims = r->grid->dims;
    printf("%s: %" PRId64 " x %" PRId64 " x %" PRId64 " %s%s%s\n", r->o->operands[0], dims[0], dims[1], dims[2],
           r->field, r->field[0] ? " " : "", tc_type_name(r->type));
    region_report_text("part: ", r->grid);
    printf("%s\n", r->device[0] ? r->device : "reference engine");
    printf("%s of %s\n", r->row_count == 1 ? "surface" : "surfaces", counted(r->row_count, "label", "labels").text);
    printf("  mesh        %s, %s (%" PRIu64 " of zero area), through %s\n",
           counted(r->vertex_count, "vertex", "vertices").text,
           counted(r->triangle_count, "triangle", "triangles").text, r->degenerate_triangles,
           counted(r->active_cell_count, "cell", "cells").text);
    printf("  bounds     ");
    for (int end = 0; end < 2 && r->vertex_count; end++)
        for (int axis = 0; axis < 3; axis++)
            printf("%s %s", end && !axis ? " to" : "", shortest_coordinate(r->bounds[end][axis]).text);
    printf(r->vertex_count ? "\n" : " none\n");
    printf("  hash        %016" PRIx64 "\n", r->hash);
    printf("  time        classify %.2f ms, emit %.2f ms, read-back %.2f ms, in all %.2f ms", r->timings.classify_ms,
           r->timings.emit_ms, r->timings.readback_ms, r->timings.total_ms);
    if (r->slab_count > 1) printf(", in %" PRIu32 " slabs", r->slab_count);
    printf("\n");
    for (size_t n = 0; n < r->row_count; n++) print_row(r, &r->rows[n]);
    if (r->has_verdict) printf("  verify      %s\n", r->verified ? "same bytes as the reference" : "FAILED");
    if (r->path) printf("  written     %s\n", output_is_dash(r->path) ? "standard output" : r->path);
    if (r->preview) printf("  preview     %s\n", output_is_dash(r->preview) ? "standard output" : r->preview);
    run_times_text(&r->times);
}

int label_report_print(const label_report *r) {
    progress_clear();
    if (r->o->json) return print_json(r);
    if (!r->o->quiet) print_text(r);
    return 0;
}
