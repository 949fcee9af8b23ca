/*
 * Closed surfaces of complexes in slabs, and fields carried to the border's vertices: by plain loops over the border,
 * whose faces are cut as the reference cuts them.
 */
#include "tetrahedra/complex_caps.h"

#include "failure.h"
#include "reference/complex_border.h"

#include <stdlib.h>
#include <string.h>

typedef struct caps_run {
    const tc_grid *grid;
    const border_list *border;
    const edge_numbers *edges;
    double isovalue;
    uint32_t *numbers; /* by point of the border: its vertex */
    tc_mesh *mesh;     /* NULL: count only */
    cap_sizes sizes, capacity;
} caps_run;

static tc_status change_fail(void) {
    return (tc_status)fail(TC_ERROR_DATA, "the samples or tetrahedra have changed while they were extracted");
}

static bool point_inside(const tc_grid *grid, const border_list *border, double isovalue, uint64_t index) {
    return grid_value_at(grid, border->points[index]) >= isovalue;
}

static void point_emit(const caps_run *c, uint64_t n) {
    const uint64_t vertex = c->mesh->vertex_count - c->capacity.vertices + c->sizes.vertices;
    float *out = (float *)c->mesh->channels[CHANNEL_POSITIONS].memory + 3 * vertex;
    memcpy(out, c->grid->complex->points + 3 * (uint64_t)c->border->points[n], 3 * sizeof *out);
}

/* Vertices at the inside points of the border, behind those on crossed edges. */
static tc_status points_run(caps_run *c) {
    const border_list *b = c->border;
    c->numbers = malloc((size_t)b->point_count * sizeof *c->numbers + 1);
    if (!c->numbers) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the border's vertices");
    for (uint64_t n = 0; n < b->point_count; n++) {
        c->numbers[n] = UINT32_MAX;
        if (!point_inside(c->grid, b, c->isovalue, n)) continue;
        if (c->mesh && c->sizes.vertices == c->capacity.vertices) return change_fail();
        if (c->mesh) point_emit(c, n);
        c->numbers[n] = (uint32_t)(c->edges->count + c->sizes.vertices++);
    }
    if (c->edges->count + c->sizes.vertices > UINT32_MAX)
        return (tc_status)fail(TC_ERROR_LIMIT,
                               "the closed surface has more than %lu vertices, which indices of 32 bits do not reach: "
                               "cut the tetrahedra into parts",
                               (unsigned long)UINT32_MAX);
    return TC_OK;
}

/* The vertex on an edge between two points of the border, or at one; UINT32_MAX where there is none. */
static uint32_t vertex_of(const caps_run *c, uint32_t a, uint32_t b) {
    const uint32_t p = c->border->points[a < b ? a : b], q = c->border->points[a < b ? b : a];
    return a == b ? c->numbers[a] : edge_numbers_get(c->edges, p, q);
}

/* False where the face's diagonal is crossed and has no vertex. */
static bool has_diagonal(const caps_run *c, const border_face *f) {
    const uint32_t *p = f->points, end = p[f->is_half ? 1 : 2];
    const bool crossed = (c->numbers[p[0]] == UINT32_MAX) != (c->numbers[end] == UINT32_MAX);
    return !crossed || (f->corner_count == 3 && !f->is_half) || vertex_of(c, p[0], end) != UINT32_MAX;
}

static tc_status face_run(caps_run *c, const cap_face *face) {
    border_vertex parts[BORDER_TRIANGLES_MAX][3];
    border_face f = {.corner_count = face->points[3] >= CAP_HALF ? 3 : 4, .is_half = face->points[3] == CAP_HALF};
    unsigned inside = 0;
    memcpy(f.points, face->points, sizeof f.points);
    for (int n = 0; n < f.corner_count; n++) inside |= (unsigned)(c->numbers[f.points[n]] != UINT32_MAX) << n;
    const bool has = has_diagonal(c, &f);
    const int count = f.is_half && !has ? 0 : border_face_cut(&f, inside, has, parts);
    if (c->mesh && c->sizes.triangles + (uint64_t)count > c->capacity.triangles) return change_fail();
    for (int n = 0; n < 3 * count && c->mesh; n++) {
        const border_vertex v = parts[n / 3][n % 3];
        const uint32_t number = vertex_of(c, v.a, v.b);
        const uint64_t triangle = c->mesh->triangle_count - c->capacity.triangles + c->sizes.triangles;
        if (number == UINT32_MAX) return change_fail();
        ((uint32_t *)c->mesh->triangles.memory)[3 * triangle + (uint64_t)n] = number;
    }
    c->sizes.triangles += (uint64_t)count;
    return TC_OK;
}

/* mesh: NULL, or where there is room for *sizes, which receives the sizes. */
static tc_status border_run(tc_grid *grid, const tc_extract_options *options, const edge_numbers *edges, tc_mesh *mesh,
                            cap_sizes *sizes) {
    border_list *border;
    tc_status status = caps_border_get(grid, options->method, &border);
    if (status || border->greatest < options->isovalue) return status;
    caps_run c = {.grid = grid, .border = border, .edges = edges, .isovalue = options->isovalue};
    c.mesh = mesh;
    c.capacity = *sizes;
    status = points_run(&c);
    for (uint64_t n = 0; n < border->face_count && !status; n++) status = face_run(&c, &border->faces[n]);
    free(c.numbers);
    *sizes = c.sizes;
    return status;
}

tc_status caps_host_count(tc_grid *grid, const tc_extract_options *options, const edge_numbers *edges,
                          cap_sizes *sizes) {
    *sizes = (cap_sizes){0, 0};
    return options->closed ? border_run(grid, options, edges, NULL, sizes) : TC_OK;
}

tc_status caps_host_emit(tc_grid *grid, const tc_extract_options *options, const edge_numbers *edges, cap_sizes sizes,
                         tc_mesh *mesh) {
    cap_sizes made = sizes;
    if (!sizes.triangles) return TC_OK;
    tc_status status = border_run(grid, options, edges, mesh, &made);
    const bool same = made.vertices == sizes.vertices && made.triangles == sizes.triangles;
    return status || same ? status : change_fail();
}

void caps_carry(const tc_grid *grid, const border_list *border, double isovalue, const carry *c, uint64_t first) {
    edge_batch batch = {.vertex = first, .has_at_samples = true};
    for (uint64_t n = 0; n < border->point_count; n++) {
        if (!point_inside(grid, border, isovalue, n)) continue;
        if (batch.count == BATCH_EDGES) carry_batch(c, grid, isovalue, &batch);
        batch.low[batch.count] = batch.high[batch.count] = border->points[n];
        batch.count++;
    }
    carry_batch(c, grid, isovalue, &batch);
}
