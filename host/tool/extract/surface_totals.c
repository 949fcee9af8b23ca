#include "surface_totals.h"

#include <math.h>
#include <string.h>

static void add_counts(const options *o, const tc_mesh_data *m, surface_report *s) {
    s->vertex_count += m->vertex_count;
    s->triangle_count += m->triangle_count;
    s->active_cell_count += m->active_cell_count;
    s->soup_vertex_count += o->soup && o->output ? 3 * m->triangle_count : 0;
    s->classify_ms += m->timings.classify_ms;
    s->emit_ms += m->timings.emit_ms;
    s->readback_ms += m->timings.readback_ms;
    if (m->slab_count > s->slab_count) s->slab_count = m->slab_count;
}

/* The surface's origin, as far as all its vertices have one. */
static void add_origin(const surface_source *made, const tc_mesh_data *m, surface_report *s) {
    if (!s->vertex_count) {
        memcpy(s->origin, m->origin, sizeof s->origin);
        s->has_origin = 1;
    } else if (m->vertex_count && memcmp(s->origin, m->origin, sizeof s->origin) != 0) {
        s->has_origin = 0;
    }
    if (engine_origins_differ(made->engine, made->range)) s->has_origin = 0;
}

/* Extends the box, in world space, by that of vertices whose positions are relative to the origin. */
static void add_box(const mesh_summary *own, uint64_t vertex_count, const double origin[3], double bounds[2][3]) {
    if (vertex_count <= own->nonfinite_vertices) return;
    for (int axis = 0; axis < 3; axis++) {
        bounds[0][axis] = fmin(bounds[0][axis], own->bounds[0][axis] + origin[axis]);
        bounds[1][axis] = fmax(bounds[1][axis], own->bounds[1][axis] + origin[axis]);
    }
}

/* Each part has an origin of its own. */
static void add_boxes_of_parts(const result_mesh *mesh, double bounds[2][3]) {
    const float *positions = mesh->mesh.positions;
    for (int n = 0; n < mesh->part_count; n++) {
        const mesh_part *part = &mesh->parts[n];
        mesh_summary own;
        mesh_summarize(positions, part->vertex_count, NULL, 0, &own);
        positions += 3 * part->vertex_count;
        add_box(&own, part->vertex_count, part->origin, bounds);
    }
}

static void clear_bounds(double bounds[2][3]) {
    for (int axis = 0; axis < 3; axis++) {
        bounds[0][axis] = INFINITY;
        bounds[1][axis] = -INFINITY;
    }
}

void surface_totals_add(const options *o, const surface_source *made, const result_mesh *mesh, surface_report *s) {
    const tc_mesh_data *m = &mesh->mesh;
    if (!s->has_mesh) clear_bounds(s->summary.bounds);
    if (!o->quiet || o->json) {
        mesh_summary own;
        mesh_summarize(m->positions, m->vertex_count, m->triangles, m->triangle_count, &own);
        s->summary.degenerate_triangles += own.degenerate_triangles;
        s->summary.nonfinite_vertices += own.nonfinite_vertices;
        s->hash = mesh_hash_add(s->hash, m->positions, m->vertex_count, m->triangles, m->triangle_count);
        add_origin(made, m, s);
        if (engine_origins_differ(made->engine, made->range))
            add_boxes_of_parts(mesh, s->summary.bounds);
        else
            add_box(&own, m->vertex_count, m->origin, s->summary.bounds);
    }
    add_counts(o, m, s);
    s->has_mesh = 1;
}
