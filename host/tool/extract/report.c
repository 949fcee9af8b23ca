/* report.c - each fact is formatted as JSON and as text; the same fact has the same place in both */
#include "report.h"

#include "counted.h"
#include "input/region_report.h"
#include "output.h"
#include "planes_cut.h"
#include "shortest.h"
#include "terminal/json_report.h"
#include "terminal/notice.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

/* ------------------------------------------------------------------------------------------------------------ JSON */

/* Whether the surface encloses one: it has no border, and one side of it is the outer one everywhere. */
static int has_volume(const surface_report *s) {
    return !s->topology.unbalanced_edges && !s->topology.invalid_triangles && !s->summary.nonfinite_vertices;
}

static void add_topology(json_t *object, const surface_report *s) {
    const mesh_topology *t = &s->topology;
    json_object_set_new(object, "boundary_edges", count_json(t->boundary_edges));
    json_object_set_new(object, "nonmanifold_edges", count_json(t->nonmanifold_edges));
    json_object_set_new(object, "nonmanifold_vertices", count_json(t->nonmanifold_vertices));
    json_object_set_new(object, "misoriented_edges", count_json(t->misoriented_edges));
    json_object_set_new(object, "coarse_vertices", count_json(s->coarse_vertices));
    json_object_set_new(object, "euler_characteristic", json_integer((json_int_t)t->euler_characteristic));
    json_object_set_new(object, "components", count_json(t->components));
    json_object_set_new(object, "area", real_json(t->area));
    json_object_set_new(object, "volume", has_volume(s) ? real_json(t->volume) : json_null());
}

/* The part of the surface's triangles; null of an empty surface. */
static json_t *share_json(const surface_report *s, uint64_t triangles) {
    return s->shapes.triangles ? real_json((double)triangles / (double)s->shapes.triangles) : json_null();
}

static void add_shapes(json_t *object, const surface_report *s) {
    json_object_set_new(object, "smallest_angle_median",
                        s->shapes.triangles ? real_json(mesh_shapes_median(&s->shapes)) : json_null());
    json_object_set_new(object, "angles_below_10", share_json(s, s->shapes.below_10));
    json_object_set_new(object, "angles_below_20", share_json(s, s->shapes.below_20));
}

/* An empty surface has none. */
static int has_bounds(const surface_report *s) { return s->vertex_count > s->summary.nonfinite_vertices; }

static void add_mesh(json_t *object, const surface_report *s) {
    char hash[24];
    snprintf(hash, sizeof hash, "%016" PRIx64, s->hash);
    json_object_set_new(object, "degenerate_triangles",
                        s->is_streamed ? json_null() : count_json(s->summary.degenerate_triangles));
    json_object_set_new(
        object, "bounds",
        has_bounds(s) ? json_pack("[o, o]", reals_json(s->summary.bounds[0], 3), reals_json(s->summary.bounds[1], 3))
                      : json_null());
    json_object_set_new(object, "origin", s->has_origin ? reals_json(s->origin, 3) : json_null());
    json_object_set_new(object, "hash", s->is_streamed ? json_null() : json_string(hash));
    if (s->is_streamed) json_object_set_new(object, "pieces", count_json(s->piece_count));
}

static void add_simplified(json_t *object, const surface_report *s, const options *o) {
    const simplified_report *r = &s->simplified;
    json_object_set_new(object, "simplified",
                        json_pack("{s:o, s:o, s:o, s:o, s:o}", "share", real_json(o->simplify), "vertices_before",
                                  count_json(r->vertices_before), "triangles_before", count_json(r->triangles_before),
                                  "distance_to", real_json(r->distance_to), "distance_from",
                                  real_json(r->distance_from)));
}

static json_t *names_json(const file_names *f) {
    json_t *names = json_array();
    for (int n = 0; n < f->count; n++) json_array_append_new(names, string_json(f->names[n]));
    return names;
}

static void add_files(json_t *object, const surface_report *s, int is_separate) {
    const file_names *meshes = &s->outputs, *pictures = &s->previews;
    if (is_separate && meshes->count) json_object_set_new(object, "outputs", names_json(meshes));
    if (is_separate && pictures->count) json_object_set_new(object, "previews", names_json(pictures));
    if (is_separate) return;
    if (meshes->count) json_object_set_new(object, "output", string_json(meshes->names[0]));
    if (pictures->count) json_object_set_new(object, "preview", string_json(pictures->names[0]));
}

static json_t *surface_json(const surface_report *s, const options *o) {
    json_t *object = json_object(), *timings = json_object();
    json_object_set_new(object, "iso", real_json(s->iso->value));
    json_object_set_new(object, "vertices", count_json(s->soup_vertex_count ? s->soup_vertex_count : s->vertex_count));
    if (s->soup_vertex_count) json_object_set_new(object, "shared_vertices", count_json(s->vertex_count));
    json_object_set_new(object, "triangles", count_json(s->triangle_count));
    json_object_set_new(object, "active_cells", count_json(s->active_cell_count));
    if (s->has_mesh) add_mesh(object, s);
    if (s->has_dropped) json_object_set_new(object, "dropped_triangles", count_json(s->dropped_count));
    if (s->has_simplified) add_simplified(object, s, o);
    json_object_set_new(timings, "classify", ms_json(s->classify_ms));
    if (s->has_mesh) {
        json_object_set_new(timings, "emit", ms_json(s->emit_ms));
        json_object_set_new(timings, "readback", ms_json(s->readback_ms));
    }
    if (s->has_simplified) json_object_set_new(timings, "simplify", ms_json(s->simplified.ms));
    json_object_set_new(object, "timings_ms", timings);
    add_files(object, s, o->separate_blocks);
    if (s->has_topology) add_topology(object, s);
    if (s->has_topology) add_shapes(object, s);
    if (s->has_verdict) json_object_set_new(object, "verified", json_boolean(s->verified));
    return object;
}

/* Of --part: which, of how many, and the planes that it owns. */
static void piece_json(json_t *object, const extract_report *r) {
    const int64_t *piece = r->o->part;
    int64_t planes[2];
    if (!piece[1] || !r->input.grid) return;
    planes_cut_of(r->o, NULL, r->input.grid->dims[2], piece[0], piece[1], planes);
    json_object_set_new(object, "part", json_pack("[I, I]", (json_int_t)piece[0], (json_int_t)piece[1]));
    json_object_set_new(object, "planes", json_pack("[I, I]", (json_int_t)planes[0], (json_int_t)planes[1]));
}

/* Where ranks begin, all but the first. */
static json_t *cut_json(const extract_report *r) {
    json_t *begins = json_array();
    int64_t planes[2];
    for (int rank = 1; rank < r->rank_count; rank++) {
        planes_cut_of(r->o, r->begins, r->input.grid->dims[2], rank, r->rank_count, planes);
        json_array_append_new(begins, json_integer((json_int_t)planes[0]));
    }
    return begins;
}

int extract_report_json(const extract_report *r) {
    json_t *surfaces = json_array(), *object = json_object();
    for (size_t n = 0; n < r->surface_count; n++) json_array_append_new(surfaces, surface_json(&r->surfaces[n], r->o));
    json_object_set_new(object, "input", string_json(r->o->operands[0]));
    json_object_set_new(object, "device", r->device[0] ? string_json(r->device) : json_null());
    json_object_set_new(object, "engine", json_string(r->engine == TC_ENGINE_REFERENCE ? "reference" : "opencl"));
    json_object_set_new(object, "method", json_string(tc_method_name((tc_method)r->o->method)));
    json_object_set_new(object, "dims", r->input.grid ? integers_json(r->input.grid->dims) : json_null());
    region_report_json(object, r->input.grid);
    piece_json(object, r);
    if (r->rank_count) json_object_set_new(object, "ranks", json_integer(r->rank_count));
    if (r->rank_count && r->input.grid) json_object_set_new(object, "cut", cut_json(r));
    if (r->rank_count) json_object_set_new(object, "sent_bytes", count_json(r->sent_bytes));
    json_object_set_new(object, "cells", count_json(r->input.cell_count));
    json_object_set_new(object, "tetrahedra", count_json(r->input.tetrahedron_count));
    json_object_set_new(object, "timings_ms", run_times_json(&r->times));
    json_object_set_new(object, "surfaces", surfaces);
    json_object_set_new(object, "notices", notices_json());
    return json_report_print(object);
}

/* ------------------------------------------------------------------------------------------------------------ text */

static void topology_text(const surface_report *s) {
    const mesh_topology *t = &s->topology;
    printf("  check       %s, %s: %s, %s, %s, %s\n",
           t->nonmanifold_edges || t->nonmanifold_vertices || t->misoriented_edges ? "not a manifold" : "manifold",
           t->boundary_edges ? "open" : "closed", counted(t->boundary_edges, "boundary edge", "boundary edges").text,
           counted(t->nonmanifold_edges, "non-manifold edge", "non-manifold edges").text,
           counted(t->nonmanifold_vertices, "non-manifold vertex", "non-manifold vertices").text,
           counted(t->misoriented_edges, "misoriented edge", "misoriented edges").text);
    printf("              Euler characteristic %" PRId64 ", %s, area %.7g", t->euler_characteristic,
           counted(t->components, "component", "components").text, t->area);
    if (has_volume(s))
        printf(", volume %.7g\n", t->volume);
    else
        printf(", %s: no volume\n", t->boundary_edges ? "open" : "not oriented");
}

static void shapes_text(const mesh_shapes *shapes) {
    if (!shapes->triangles) return;
    printf("  shapes      smallest angles: median %.1f degrees, %.3g%% below 10, %.3g%% below 20\n",
           mesh_shapes_median(shapes), 100 * (double)shapes->below_10 / (double)shapes->triangles,
           100 * (double)shapes->below_20 / (double)shapes->triangles);
}

static void bounds_text(const surface_report *s) {
    printf("  bounds     ");
    for (int end = 0; end < 2 && has_bounds(s); end++)
        for (int axis = 0; axis < 3; axis++)
            printf("%s %s", end && !axis ? " to" : "", shortest_coordinate(s->summary.bounds[end][axis]).text);
    printf(has_bounds(s) ? "\n" : " none\n");
}

static void simplified_text(const surface_report *s) {
    const simplified_report *r = &s->simplified;
    printf("  simplified  from %s, %s, in %.2f ms; topology and border are the same\n",
           counted(r->vertices_before, "vertex", "vertices").text,
           counted(r->triangles_before, "triangle", "triangles").text, r->ms);
    printf(
        "              distances, in units of coordinates, by samples: %.4g of the surface before, %.4g of this one\n",
        r->distance_to, r->distance_from);
}

static void files_text(const char *what, const file_names *f) {
    if (!f->count) return;
    printf("%s%s", what, output_is_dash(f->names[0]) ? "standard output" : f->names[0]);
    if (f->count > 1) printf(" to %s", f->names[f->count - 1]);
    printf("\n");
}

static void surface_text(const surface_report *s, int has_tetrahedra) {
    const char *cell = has_tetrahedra ? "tetrahedron" : "cell", *cells = has_tetrahedra ? "tetrahedra" : "cells";
    const mesh_summary *m = &s->summary;
    printf("isovalue %s\n", s->iso->text);
    printf("  mesh        %s, %s",
           counted(s->soup_vertex_count ? s->soup_vertex_count : s->vertex_count, "vertex", "vertices").text,
           counted(s->triangle_count, "triangle", "triangles").text);
    if (s->has_mesh && !s->is_streamed) printf(" (%" PRIu64 " of zero area)", m->degenerate_triangles);
    printf(", through %s\n", counted(s->active_cell_count, cell, cells).text);
    if (s->soup_vertex_count)
        printf("  soup        three vertices of its own for every triangle; hash and check are of %" PRIu64
               " shared ones\n",
               s->vertex_count);
    if (s->has_dropped)
        printf("  dropped     %s of zero area\n", counted(s->dropped_count, "triangle", "triangles").text);
    if (s->has_simplified) simplified_text(s);
    if (s->has_mesh) {
        bounds_text(s);
        if (!s->has_origin) printf("  origin      of each block its own\n");
        if (s->has_origin && (s->origin[0] != 0 || s->origin[1] != 0 || s->origin[2] != 0))
            printf("  origin      %s %s %s\n", shortest_number(s->origin[0]).text, shortest_number(s->origin[1]).text,
                   shortest_number(s->origin[2]).text);
        if (s->is_streamed)
            printf("  streamed    in %s: no hash\n", counted(s->piece_count, "piece", "pieces").text);
        else
            printf("  hash        %016" PRIx64 "\n", s->hash);
        printf("  time        classify %.2f ms, emit %.2f ms, read-back %.2f ms", s->classify_ms, s->emit_ms,
               s->readback_ms);
    } else {
        printf("  time        classify %.2f ms", s->classify_ms);
    }
    if (s->slab_count > 1) printf(", in %" PRIu32 " slabs", s->slab_count);
    printf("\n");
    if (s->has_topology) topology_text(s);
    if (s->has_topology) shapes_text(&s->shapes);
    if (s->has_verdict) printf("  verify      %s\n", s->verified ? "same bytes as the reference" : "FAILED");
    files_text("  written     ", &s->outputs);
    files_text("  preview     ", &s->previews);
}

static void piece_text(const extract_report *r) {
    const int64_t *piece = r->o->part;
    int64_t planes[2];
    if (!piece[1] || !r->input.grid) return;
    planes_cut_of(r->o, NULL, r->input.grid->dims[2], piece[0], piece[1], planes);
    printf("part %" PRId64 " of %" PRId64 ": ", piece[0], piece[1]);
    if (planes[0] == planes[1])
        printf("no planes: there are fewer layers of four than parts\n");
    else
        printf("planes %" PRId64 " to %" PRId64 "\n", planes[0], planes[1] - 1);
}

void extract_report_text(const extract_report *r) {
    input_summary_text(&r->input);
    piece_text(r);
    printf("%s\n", r->device[0] ? r->device : "reference engine");
    if (r->rank_count)
        printf("ranks: %d, each of which sent at most %" PRIu64 " bytes to the others\n", r->rank_count, r->sent_bytes);
    for (size_t n = 0; n < r->surface_count; n++) surface_text(&r->surfaces[n], r->has_tetrahedra);
    run_times_text(&r->times);
}
