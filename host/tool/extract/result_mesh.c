#include "result_mesh.h"

#include "exit_status.h"
#include "failure.h"
#include "terminal/notice.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

void result_mesh_begin(const engine *e, block_range blocks, const tc_mesh_data *mesh, result_mesh *out) {
    *out = (result_mesh){.mesh = *mesh, .parts = e->parts + blocks.first, .part_count = blocks.count};
}

/* The values of the vertices that are left, from malloc; NULL, with the failure's text set, without memory. */
static float *gather(const collapsed_mesh *to, const float *values, size_t components) {
    float *gathered = malloc(((size_t)to->vertex_count * components + 1) * sizeof *gathered);
    if (!gathered) fail(STATUS_FAILED, "out of memory for the surface without triangles of zero area");
    for (uint64_t v = 0; gathered && v < to->vertex_count; v++)
        memcpy(gathered + v * components, values + to->sources[v] * components, components * sizeof *gathered);
    return gathered;
}

/* Vertices and triangles of each block still follow each other. */
static int divide(result_mesh *result) {
    const collapsed_mesh *c = &result->collapsed;
    uint64_t end = 0, vertex = 0, triangle = 0;
    mesh_part *parts = calloc((size_t)result->part_count + 1, sizeof *parts);
    if (!parts) return fail(STATUS_FAILED, "out of memory for %d blocks", result->part_count);
    for (int n = 0; n < result->part_count; n++) {
        memcpy(parts[n].origin, result->parts[n].origin, sizeof parts[n].origin);
        end += result->parts[n].vertex_count;
        for (; vertex < c->vertex_count && c->sources[vertex] < end; vertex++) parts[n].vertex_count++;
        for (; triangle < c->triangle_count && c->triangles[3 * triangle] < vertex; triangle++)
            parts[n].triangle_count++;
    }
    result->parts = result->own_parts = parts;
    return 0;
}

int result_mesh_drop_degenerate(result_mesh *result, surface_report *s) {
    tc_mesh_data *m = &result->mesh;
    collapsed_mesh *c = &result->collapsed;
    int status = mesh_collapse(m->positions, m->vertex_count, m->triangles, m->triangle_count, c);
    s->has_dropped = 1;
    s->dropped_count += c->dropped_count;
    s->nonmanifold_edges += c->nonmanifold_edges;
    if (status || !c->dropped_count) return status;
    for (int channel = 0; channel < CHANNEL_COUNT; channel++) {
        const float *values = mesh_values(m, channel);
        if (!values) continue;
        result->values[channel] = gather(c, values, (size_t)mesh_channels[channel].components);
        if (!result->values[channel]) return STATUS_FAILED;
        mesh_values_set(m, channel, result->values[channel]);
    }
    m->triangles = c->triangles;
    m->vertex_count = c->vertex_count;
    m->triangle_count = c->triangle_count;
    return divide(result);
}

void result_mesh_tell_dropped(const surface_report *s) {
    if (s->nonmanifold_edges)
        notice("isovalue %s: without its triangles of zero area the surface has %" PRIu64 " edges of more than two "
               "triangles, as it had there before",
               s->iso->text, s->nonmanifold_edges);
    if (s->has_dropped && s->summary.degenerate_triangles)
        notice("isovalue %s: %" PRIu64 " triangles of zero area are left: their corners are apart, on a line",
               s->iso->text, s->summary.degenerate_triangles);
}

int result_mesh_carry(const result_mesh *result, carried_fields *fields) {
    for (int n = 0; n < fields->count && result->collapsed.dropped_count; n++) {
        float *values = gather(&result->collapsed, fields->values[n], (size_t)fields->from[n].components);
        if (!values) return STATUS_FAILED;
        free(fields->values[n]);
        fields->fields[n].values = fields->values[n] = values;
    }
    return 0;
}

void result_mesh_release(result_mesh *result) {
    collapsed_mesh_release(&result->collapsed);
    for (int channel = 0; channel < CHANNEL_COUNT; channel++) free(result->values[channel]);
    free(result->own_parts);
    *result = (result_mesh){0};
}
