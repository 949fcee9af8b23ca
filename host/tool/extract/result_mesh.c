#include "result_mesh.h"

#include "counted.h"
#include "exit_status.h"
#include "failure.h"
#include "terminal/notice.h"

#include <stdlib.h>
#include <string.h>

void result_mesh_begin(const engine *e, block_range blocks, const tc_mesh_data *mesh, result_mesh *out) {
    *out = (result_mesh){
        .mesh = *mesh, .parts = e->parts + blocks.first, .part_count = blocks.count, .suits_world = e->suits_world};
}

/* The values of the vertices that are left, from malloc; NULL, with the failure's text set, without memory. */
static float *gather(const uint32_t *sources, uint64_t vertex_count, const float *values, size_t components) {
    float *gathered = malloc(((size_t)vertex_count * components + 1) * sizeof *gathered);
    if (!gathered) fail(STATUS_FAILED, "out of memory for the vertices that are left of the surface");
    for (uint64_t v = 0; gathered && v < vertex_count; v++)
        memcpy(gathered + v * components, values + sources[v] * components, components * sizeof *gathered);
    return gathered;
}

/* What each block gives to a mesh with these vertices and triangles. */
static int divide(result_mesh *result, uint64_t vertex_count, const uint32_t *sources, uint64_t triangle_count,
                  const uint32_t *triangles) {
    uint64_t end = 0, vertex = 0, triangle = 0;
    mesh_part *parts = calloc((size_t)result->part_count + 1, sizeof *parts);
    if (!parts) return fail(STATUS_FAILED, "out of memory for %d blocks", result->part_count);
    for (int n = 0; n < result->part_count; n++) {
        memcpy(parts[n].origin, result->parts[n].origin, sizeof parts[n].origin);
        end += result->parts[n].vertex_count;
        for (; vertex < vertex_count && sources[vertex] < end; vertex++) parts[n].vertex_count++;
        for (; triangle < triangle_count && triangles[3 * triangle] < vertex; triangle++) parts[n].triangle_count++;
    }
    free(result->own_parts);
    result->parts = result->own_parts = parts;
    return 0;
}

/* Takes the channels' values along. */
static int gather_channels(result_mesh *result, uint64_t vertex_count, const uint32_t *sources) {
    for (int channel = 0; channel < CHANNEL_COUNT; channel++) {
        const float *values = mesh_values(&result->mesh, channel);
        if (!values) continue;
        float *gathered = gather(sources, vertex_count, values, (size_t)mesh_channels[channel].components);
        if (!gathered) return STATUS_FAILED;
        free(result->values[channel]);
        result->values[channel] = gathered;
        mesh_values_set(&result->mesh, channel, gathered);
    }
    return 0;
}

int result_mesh_keep(result_mesh *result, uint64_t vertex_count, uint32_t *sources, uint64_t triangle_count,
                     uint32_t *triangles) {
    tc_mesh_data *m = &result->mesh;
    int status = divide(result, vertex_count, sources, triangle_count, triangles);
    if (!status) status = gather_channels(result, vertex_count, sources);
    for (uint64_t v = 0; v < vertex_count && result->sources && !status; v++) sources[v] = result->sources[sources[v]];
    free(result->sources);
    free(result->triangles);
    result->sources = sources;
    result->triangles = triangles;
    m->triangles = triangles;
    m->vertex_count = vertex_count;
    m->triangle_count = triangle_count;
    return status;
}

int result_mesh_drop_degenerate(result_mesh *result, surface_report *s) {
    const tc_mesh_data *m = &result->mesh;
    collapsed_mesh c;
    const int status = mesh_collapse(m->positions, m->vertex_count, m->triangles, m->triangle_count, &c);
    s->has_dropped = 1;
    s->dropped_count += c.dropped_count;
    s->nonmanifold_edges += c.nonmanifold_edges;
    if (status || !c.dropped_count) return status;
    return result_mesh_keep(result, c.vertex_count, c.sources, c.triangle_count, c.triangles);
}

void result_mesh_tell_dropped(const surface_report *s) {
    if (s->nonmanifold_edges)
        notice("isovalue %s: without its triangles of zero area the surface has %s of more than two triangles, as it "
               "had there before",
               s->iso->text, counted(s->nonmanifold_edges, "edge", "edges").text);
    if (s->has_dropped && s->summary.degenerate_triangles)
        notice("isovalue %s: %s of zero area left: corners are apart, on a line", s->iso->text,
               counted(s->summary.degenerate_triangles, "triangle is", "triangles are").text);
}

int result_mesh_carry(const result_mesh *result, carried_fields *fields) {
    for (int n = 0; n < fields->count && result->sources; n++) {
        float *values =
            gather(result->sources, result->mesh.vertex_count, fields->values[n], (size_t)fields->from[n].components);
        if (!values) return STATUS_FAILED;
        free(fields->values[n]);
        fields->fields[n].values = fields->values[n] = values;
    }
    return 0;
}

void result_mesh_release(result_mesh *result) {
    free(result->sources);
    free(result->triangles);
    for (int channel = 0; channel < CHANNEL_COUNT; channel++) free(result->values[channel]);
    free(result->own_parts);
    *result = (result_mesh){0};
}
