/* volume_report.c - each fact is formatted as JSON and as text; the same fact has the same place in both */
#include "volume_report.h"

#include "counted.h"
#include "input/region_report.h"
#include "output.h"
#include "shortest.h"
#include "terminal/json_report.h"
#include "terminal/notice.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

static uint64_t vertex_count(const volume_report *v) { return v->sample_count + v->low_count + v->high_count; }

/* The mean of a field is its integral by the volume. */
static double mean_of(const volume_report *v, double integral) {
    return v->volume > 0 ? integral / v->volume : (double)NAN;
}

/* ------------------------------------------------------------------------------------------------------------ JSON */

static json_t *fields_json(const isovolume_report *r, const volume_report *v) {
    json_t *fields = json_array();
    const double *integral = v->integrals;
    for (int n = 0; n < r->carried->count; n++) {
        json_t *integrals = json_array(), *means = json_array();
        for (int c = 0; c < r->carried->from[n].components; c++, integral++) {
            json_array_append_new(integrals, real_json(*integral));
            json_array_append_new(means, real_json(mean_of(v, *integral)));
        }
        json_array_append_new(fields, json_pack("{s:o, s:o, s:o}", "name", string_json(r->carried->from[n].name),
                                                "mean", means, "integral", integrals));
    }
    return fields;
}

static void add_shapes(json_t *object, const volume_report *v) {
    const tetrahedra_shapes *s = &v->shapes;
    json_object_set_new(object, "flat_tetrahedra", count_json(s->flat));
    json_object_set_new(object, "inverted_tetrahedra", count_json(s->inverted));
    json_object_set_new(object, "smallest_dihedral_angle", s->count ? real_json(s->least) : json_null());
    json_object_set_new(object, "smallest_dihedral_angle_median",
                        s->count ? real_json(tetrahedra_shapes_median(s)) : json_null());
    json_object_set_new(object, "dihedral_angles_below_5",
                        s->count ? real_json((double)s->below_5 / (double)s->count) : json_null());
    json_object_set_new(object, "dihedral_angles_below_10",
                        s->count ? real_json((double)s->below_10 / (double)s->count) : json_null());
    json_object_set_new(object, "nonmanifold_faces", count_json(v->faces.nonmanifold_faces));
    json_object_set_new(object, "folded_faces", count_json(v->faces.folded_faces));
}

static json_t *volume_json(const isovolume_report *r, const volume_report *v) {
    json_t *object = json_object(), *timings = json_object();
    json_object_set_new(object, "range", json_pack("[o, o]", real_json(v->range->low), real_json(v->range->high)));
    json_object_set_new(object, "vertices", count_json(vertex_count(v)));
    json_object_set_new(object, "samples_within", count_json(v->sample_count));
    json_object_set_new(object, "low_vertices", count_json(v->low_count));
    json_object_set_new(object, "high_vertices", count_json(v->high_count));
    json_object_set_new(object, "tetrahedra", count_json(v->tetrahedron_count));
    json_object_set_new(object, "bytes", count_json(v->bytes));
    if (v->has_volume) json_object_set_new(object, "volume", real_json(v->volume));
    if (v->has_volume) json_object_set_new(object, "fields", fields_json(r, v));
    json_object_set_new(timings, "classify", ms_json(v->classify_ms));
    if (v->has_volume) json_object_set_new(timings, "emit", ms_json(v->emit_ms));
    if (v->has_volume) json_object_set_new(timings, "readback", ms_json(v->readback_ms));
    json_object_set_new(object, "timings_ms", timings);
    if (v->has_shapes) add_shapes(object, v);
    if (v->path) json_object_set_new(object, "output", string_json(v->path));
    if (v->has_verdict) json_object_set_new(object, "verified", json_boolean(v->verified));
    return object;
}

int isovolume_report_json(const isovolume_report *r) {
    json_t *volumes = json_array(), *object = json_object();
    for (size_t n = 0; n < r->volume_count; n++) json_array_append_new(volumes, volume_json(r, &r->volumes[n]));
    json_object_set_new(object, "input", string_json(r->o->operands[0]));
    json_object_set_new(object, "device", r->device[0] ? string_json(r->device) : json_null());
    json_object_set_new(object, "engine", json_string(r->engine == TC_ENGINE_REFERENCE ? "reference" : "opencl"));
    json_object_set_new(object, "dims", r->input.grid ? integers_json(r->input.grid->dims) : json_null());
    region_report_json(object, r->input.grid);
    json_object_set_new(object, "cells", count_json(r->input.cell_count));
    json_object_set_new(object, "tetrahedra", count_json(r->input.tetrahedron_count));
    json_object_set_new(object, "timings_ms", run_times_json(&r->times));
    json_object_set_new(object, "volumes", volumes);
    json_object_set_new(object, "notices", notices_json());
    return json_report_print(object);
}

/* ------------------------------------------------------------------------------------------------------------ text */

static void shapes_text(const volume_report *v) {
    const tetrahedra_shapes *s = &v->shapes;
    printf("  check       %s: %s of more than two tetrahedra, %" PRIu64 " passed twice the same way\n",
           v->faces.nonmanifold_faces || v->faces.folded_faces ? "tetrahedra do not fit" : "tetrahedra fit",
           counted(v->faces.nonmanifold_faces, "face", "faces").text, v->faces.folded_faces);
    printf("  shapes      %" PRIu64 " flat, %" PRIu64 " inverted", s->flat, s->inverted);
    if (s->count)
        printf("; smallest dihedral angles: least %.3g degrees, median %.1f, %.3g%% below 5, %.3g%% below 10", s->least,
               tetrahedra_shapes_median(s), 100 * (double)s->below_5 / (double)s->count,
               100 * (double)s->below_10 / (double)s->count);
    printf("\n");
}

static void fields_text(const isovolume_report *r, const volume_report *v) {
    const double *integral = v->integrals;
    for (int n = 0; n < r->carried->count; n++)
        for (int c = 0; c < r->carried->from[n].components; c++, integral++) {
            printf("  %-11s ", n || c ? "" : "carried");
            printf("%s", r->carried->from[n].name);
            if (r->carried->from[n].components > 1) printf("[%d]", c);
            printf(": mean %.7g, integral %.7g\n", mean_of(v, *integral), *integral);
        }
}

static void volume_text(const isovolume_report *r, const volume_report *v) {
    printf("range %s\n", v->range->text);
    printf("  tetrahedra  %" PRIu64 ", with %s: %s, %" PRIu64 " on the low bound, %" PRIu64 " on the high one\n",
           v->tetrahedron_count, counted(vertex_count(v), "vertex", "vertices").text,
           counted(v->sample_count, "sample", "samples").text, v->low_count, v->high_count);
    printf("  memory      %" PRIu64 " bytes\n", v->bytes);
    if (v->has_volume) printf("  volume      %.9g\n", v->volume);
    if (v->has_volume) fields_text(r, v);
    printf("  time        classify %.2f ms", v->classify_ms);
    if (v->has_volume) printf(", emit %.2f ms, read-back %.2f ms", v->emit_ms, v->readback_ms);
    if (v->slab_count > 1) printf(", in %" PRIu32 " slabs", v->slab_count);
    printf("\n");
    if (v->has_shapes) shapes_text(v);
    if (v->has_verdict) printf("  verify      %s\n", v->verified ? "same bytes as the reference" : "FAILED");
    if (v->path) printf("  written     %s\n", output_is_dash(v->path) ? "standard output" : v->path);
}

void isovolume_report_text(const isovolume_report *r) {
    input_summary_text(&r->input);
    printf("%s\n", r->device[0] ? r->device : "reference engine");
    for (size_t n = 0; n < r->volume_count; n++) volume_text(r, &r->volumes[n]);
    run_times_text(&r->times);
}
