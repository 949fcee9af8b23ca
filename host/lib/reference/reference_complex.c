/*
 * The scalar reference of complexes: one loop over the tetrahedra, or the cells that they were cut from (method
 * hybrid), counts, another emits. A hash table holds the crossed
 * edges met so far with their vertices; vertices are numbered in the order in which edges are first met. Closed
 * surfaces go on with the border (complex_border.h): vertices at its inside points, in the order of these, and its
 * triangles.
 */
#include "tables/cell_cases.h"
#include "grid/complex.h"
#include "reference/reference_complex_run.h"

#include "failure.h"
#include "tables/tables.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define REAL    float
#define NAME(x) x##_f32
#include "reference/reference_crossing.inc"
#undef REAL
#undef NAME
#define REAL    double
#define NAME(x) x##_f64
#include "reference/reference_crossing.inc"

/* ----------------------------------------------------------------------------------------------------------- edges */

static bool table_allocate(reference *r, uint64_t size) {
    r->table = calloc((size_t)size, sizeof *r->table);
    r->table_size = r->table ? size : 0;
    return r->table != NULL;
}

/* The edge's entry, or the free entry for it. */
static edge_entry *edge_find(const reference *r, uint32_t low, uint32_t high) {
    uint64_t hash = ((uint64_t)high << 32 | low) * 0x9e3779b97f4a7c15u;
    uint64_t n = (hash ^ hash >> 29) & (r->table_size - 1);
    while (r->table[n].taken && (r->table[n].low != low || r->table[n].high != high)) n = (n + 1) & (r->table_size - 1);
    return &r->table[n];
}

static tc_status table_grow(reference *r) {
    edge_entry *old = r->table;
    uint64_t old_size = r->table_size;
    if (2 * (r->entry_count + 1) < old_size) return TC_OK;
    bool grown = table_allocate(r, old_size ? 2 * old_size : 1024);
    for (uint64_t n = 0; n < old_size && grown; n++)
        if (old[n].taken) *edge_find(r, old[n].low, old[n].high) = old[n];
    free(old);
    return grown ? TC_OK : (tc_status)fail(TC_ERROR_MEMORY, "no memory for the crossed edges");
}

static float edge_crossing(const reference *r, uint32_t low, uint32_t high) {
    const double a = grid_value_at(r->grid, low), b = grid_value_at(r->grid, high);
    return type_is_wide(r->grid->type) ? crossing_f64(a, b, r->isovalue) : crossing_f32(a, b, r->isovalue);
}

static void vertex_emit(reference *r, uint32_t low, uint32_t high, float t) {
    const float *p0 = r->grid->complex->points + 3 * (uint64_t)low, *p1 = r->grid->complex->points + 3 * (uint64_t)high;
    float *out = (float *)r->mesh->channels[CHANNEL_POSITIONS].memory + 3 * r->vertex_count;
    for (int axis = 0; axis < 3; axis++) out[axis] = t == 1 ? p1[axis] : p0[axis] + t * (p1[axis] - p0[axis]);
}

tc_status reference_complex_change_fail(void) {
    return (tc_status)fail(TC_ERROR_DATA, "samples or tetrahedra have changed while a surface was made of them");
}

/* The entry of the edge of two points, made where there is none. */
static tc_status edge_enter(reference *r, uint32_t low, uint32_t high, edge_entry **entry) {
    tc_status status = table_grow(r);
    if (status) return status;
    *entry = edge_find(r, low, high);
    if ((*entry)->taken) return TC_OK;
    **entry = (edge_entry){low, high, NO_NUMBER, 1};
    r->entry_count++;
    return TC_OK;
}

/* The number of the vertex on the edge of two points; makes the vertex when the edge is first met in a run. */
static tc_status edge_vertex_number(reference *r, uint32_t a, uint32_t b, uint32_t *number) {
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    edge_entry *e;
    tc_status status = edge_enter(r, low, high, &e);
    if (status) return status;
    if (e->number == NO_NUMBER) {
        if (r->mesh && r->vertex_count >= r->mesh->vertex_count) return reference_complex_change_fail();
        e->number = (uint32_t)r->vertex_count;
        if (r->mesh) vertex_emit(r, low, high, edge_crossing(r, low, high));
        if (r->carried) carry_vertex(r->carried, r->vertex_count, low, high, edge_crossing(r, low, high));
        r->vertex_count++;
    }
    *number = e->number;
    return TC_OK;
}

/* ------------------------------------------------------------------------------------------------------- tetrahedra */

/* Which of these points are inside, a bit each; 0 where a sample is missing. */
static unsigned pattern_of(const reference *r, const uint32_t points[], int count) {
    unsigned pattern = 0;
    for (int v = 0; v < count; v++) {
        double value = grid_value_at(r->grid, points[v]);
        if (!isfinite(value)) return 0;
        pattern |= (unsigned)(value >= r->isovalue) << v;
    }
    return pattern;
}

static tc_status triangle_emit(reference *r, const uint32_t numbers[], const uint8_t edges[3]) {
    const uint64_t n = r->triangle_count++;
    if (!r->mesh) return TC_OK;
    if (n >= r->mesh->triangle_count) return reference_complex_change_fail();
    uint32_t *triangle = (uint32_t *)r->mesh->triangles.memory + 3 * n;
    for (int m = 0; m < 3; m++) triangle[m] = numbers[edges[m]];
    return TC_OK;
}

tc_status reference_complex_vertices(reference *r, const uint32_t points[4], unsigned pattern, uint32_t numbers[6]) {
    tc_status status = TC_OK;
    for (int e = 0; e < 6 && !status; e++) {
        const uint8_t *ends = tetrahedron_edges[e];
        if ((pattern >> ends[0] & 1) != (pattern >> ends[1] & 1))
            status = edge_vertex_number(r, points[ends[0]], points[ends[1]], &numbers[e]);
    }
    return status;
}

static tc_status tetrahedron_run(reference *r) {
    const uint32_t *tetrahedron = r->grid->complex->tetrahedra + 4 * (uint64_t)r->next++;
    const uint32_t points[4] = {tetrahedron[0], tetrahedron[1], tetrahedron[2], tetrahedron[3]};
    for (int v = 0; v < 4; v++)
        if (points[v] >= r->grid->complex->point_count) return complex_point_fail(r->grid->complex);
    const unsigned pattern = pattern_of(r, points, 4);
    const tetrahedron_case *c = &tetrahedron_cases[pattern];
    uint32_t numbers[6] = {0};
    if (pattern == 0 || pattern == 15) return TC_OK;
    r->active_count++;
    tc_status status = reference_complex_vertices(r, points, pattern, numbers);
    for (unsigned n = 0; n < c->triangle_count && !status; n++) status = triangle_emit(r, numbers, c->triangles[n]);
    return status;
}

/* ------------------------------------------------------------------------------------------------------------ cells */

/* Takes the next cell; pattern 0 where it is not active. */
static tc_status cell_take(reference *r, whole_cell *cell, unsigned *pattern) {
    tc_status status = complex_cell_get(r->grid->complex, r->next, cell);
    if (status) return status;
    r->next += cell->tetrahedron_count;
    *pattern = pattern_of(r, cell->corners, cell->corner_count);
    if (*pattern == (1u << cell->corner_count) - 1) *pattern = 0;
    return TC_OK;
}

static bool is_crossed(unsigned pattern, unsigned corner_a, unsigned corner_b) {
    return (pattern >> corner_a & 1) != (pattern >> corner_b & 1);
}

/* Enters the crossed edges of a cell into the table, before any vertex is made. */
static tc_status cell_enter(reference *r) {
    whole_cell cell;
    cell_frame frame;
    edge_entry *entry;
    unsigned pattern;
    tc_status status = cell_take(r, &cell, &pattern);
    if (status || !pattern) return status;
    cell_frame_begin(cell.shape, cell.corners, cell.mirrored, &frame);
    cell_frame_end(&frame);
    for (int e = 0; e < frame.edge_count && !status; e++) {
        const uint32_t a = cell.corners[frame.edges[e][0]], b = cell.corners[frame.edges[e][1]];
        if (is_crossed(pattern, frame.edges[e][0], frame.edges[e][1]))
            status = edge_enter(r, a < b ? a : b, a < b ? b : a, &entry);
    }
    return status;
}

/* Cuts quadrilaterals whose crossed diagonal is an edge of another cell: two triangles are beside them. */
static void faces_cut(const reference *r, const whole_cell *cell, unsigned pattern, cell_frame *frame) {
    for (int n = 0; n < frame->face_count; n++) {
        const cell_face *f = &frame->faces[n];
        const uint32_t low = cell->corners[f->corners[0]], high = cell->corners[f->corners[2]]; /* in this order */
        if (f->corner_count == 4 && is_crossed(pattern, f->corners[0], f->corners[2]))
            frame->is_cut[n] = edge_find(r, low, high)->taken;
    }
}

static tc_status cell_run(reference *r) {
    whole_cell cell;
    cell_frame frame;
    cell_case derived;
    unsigned pattern;
    uint32_t numbers[CELL_EDGES_MAX] = {0};
    tc_status status = cell_take(r, &cell, &pattern);
    if (status || !pattern) return status;
    r->active_count++;
    cell_frame_begin(cell.shape, cell.corners, cell.mirrored, &frame);
    faces_cut(r, &cell, pattern, &frame);
    cell_frame_end(&frame);
    cell_case_derive(&frame, pattern, &derived);
    for (int e = 0; e < frame.edge_count && !status; e++) {
        const uint8_t *ends = frame.edges[e];
        if (is_crossed(pattern, ends[0], ends[1]))
            status = edge_vertex_number(r, cell.corners[ends[0]], cell.corners[ends[1]], &numbers[e]);
    }
    for (int n = 0; n < derived.triangle_count && !status; n++)
        status = triangle_emit(r, numbers, derived.triangles[n]);
    return status;
}

/* ----------------------------------------------------------------------------------------------------------- border */

/* Which points of a face are inside, a bit each. */
static unsigned face_pattern(const reference *r, const border_face *face) {
    unsigned pattern = 0;
    for (int n = 0; n < face->corner_count; n++)
        pattern |= (unsigned)(grid_value_at(r->grid, face->points[n]) >= r->isovalue) << n;
    return pattern;
}

/* Vertices at the inside points of the border. */
static tc_status border_vertices(reference *r) {
    const uint64_t point_count = r->grid->complex->point_count;
    memset(r->point_numbers, 0xff, (size_t)point_count * sizeof *r->point_numbers);
    for (const border_face *f = r->border.faces; f < r->border.faces + r->border.face_count; f++)
        for (int n = 0; n < f->corner_count; n++)
            if (face_pattern(r, f) >> n & 1) r->point_numbers[f->points[n]] = 0;
    for (uint64_t n = 0; n < point_count; n++) {
        if (r->point_numbers[n] == NO_NUMBER) continue;
        if (r->mesh && r->vertex_count >= r->mesh->vertex_count) return reference_complex_change_fail();
        if (r->mesh) vertex_emit(r, (uint32_t)n, (uint32_t)n, 0);
        if (r->carried) carry_vertex(r->carried, r->vertex_count, (int64_t)n, (int64_t)n, 0);
        r->point_numbers[n] = (uint32_t)r->vertex_count++;
    }
    return TC_OK;
}

static tc_status border_vertex_number(const reference *r, border_vertex v, uint32_t *number) {
    const uint32_t low = v.a < v.b ? v.a : v.b, high = v.a < v.b ? v.b : v.a;
    const edge_entry *e = edge_find(r, low, high);
    *number = v.a == v.b ? r->point_numbers[v.a] : e->taken ? e->number : NO_NUMBER;
    return *number == NO_NUMBER ? reference_complex_change_fail() : TC_OK;
}

/* Whether the diagonal of a quadrilateral, or the one that a half begins with, has a vertex where it is crossed. */
static bool has_diagonal(const reference *r, const border_face *f, unsigned pattern) {
    const unsigned end = f->is_half ? 1 : 2;
    const uint32_t a = f->points[0], b = f->points[end];
    if (!is_crossed(pattern, 0, end) || (f->corner_count == 3 && !f->is_half)) return true;
    return edge_find(r, a < b ? a : b, a < b ? b : a)->taken;
}

static tc_status border_run(reference *r) {
    static const uint8_t in_order[3] = {0, 1, 2};
    tc_status status = border_vertices(r);
    for (const border_face *f = r->border.faces; f < r->border.faces + r->border.face_count && !status; f++) {
        border_vertex triangles[BORDER_TRIANGLES_MAX][3];
        const unsigned pattern = face_pattern(r, f);
        const bool has = has_diagonal(r, f, pattern);
        const int count = f->is_half && !has ? 0 : border_face_cut(f, pattern, has, triangles);
        for (int n = 0; n < count && !status; n++) {
            uint32_t numbers[3] = {0};
            for (int m = 0; m < 3 && !status; m++) status = border_vertex_number(r, triangles[n][m], &numbers[m]);
            if (!status) status = triangle_emit(r, numbers, in_order);
        }
    }
    return status;
}

void reference_complex_restart(reference *r) {
    r->vertex_count = r->triangle_count = r->active_count = 0;
    for (uint64_t n = 0; n < r->table_size; n++) r->table[n].number = NO_NUMBER;
}

/* before, share: where this stage begins in the whole call and its share of it, for progress. */
static tc_status grid_run(reference *r, const char *stage, double before, double share) {
    const uint64_t count = r->grid->complex->tetrahedron_count, steps = 64;
    tc_status status = TC_OK;
    reference_complex_restart(r);
    for (r->next = 0; r->keeps_cells && r->next < count && !status;) status = cell_enter(r);
    r->next = 0;
    for (uint64_t step = 0; step < steps && !status; step++) {
        while (r->next < count * (step + 1) / steps && !status)
            status = r->keeps_cells ? cell_run(r) : tetrahedron_run(r);
        if (!status)
            status = context_progress(r->grid->context, stage, before + share * (double)(step + 1) / (double)steps);
    }
    return !status && r->closed ? border_run(r) : status;
}

void reference_complex_end(reference *r) {
    free(r->table);
    free(r->point_numbers);
    complex_border_release(&r->border);
}

tc_status reference_complex_begin(reference *r, const tc_grid *grid, const tc_extract_options *options) {
    *r = (reference){.grid = grid, .isovalue = options->isovalue};
    r->keeps_cells = options->method == TC_METHOD_HYBRID;
    r->closed = options->closed;
    if (!table_allocate(r, 1024)) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the crossed edges");
    if (!r->closed) return TC_OK;
    r->point_numbers = malloc((size_t)grid->complex->point_count * sizeof *r->point_numbers);
    if (!r->point_numbers) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the border's vertices");
    return complex_border_find(grid, options->isovalue, r->keeps_cells, &r->border);
}

tc_status reference_complex_count(const tc_grid *grid, const tc_extract_options *options, tc_counts *counts) {
    reference r;
    double start = clock_ms();
    tc_status status = reference_complex_begin(&r, grid, options);
    if (!status) status = grid_run(&r, "classify", 0, 1);
    counts->vertex_count = r.vertex_count;
    counts->triangle_count = r.triangle_count;
    counts->active_cell_count = r.active_count;
    counts->classify_ms = clock_ms() - start;
    reference_complex_end(&r);
    return status;
}

tc_status reference_complex_carry(const tc_grid *grid, const tc_extract_options *options, const carry *c,
                                  uint64_t *vertex_count) {
    reference r;
    tc_status status = reference_complex_begin(&r, grid, options);
    r.carried = c;
    if (!status) status = grid_run(&r, "carry", 0, 1);
    *vertex_count = r.vertex_count;
    reference_complex_end(&r);
    return status;
}

tc_status reference_complex_extract(const tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh) {
    reference r;
    const double start = clock_ms();
    tc_status status = reference_complex_begin(&r, grid, options);
    if (!status) status = grid_run(&r, "classify", 0, 0.5);
    const double classified = clock_ms();
    if (!status) status = mesh_allocate(mesh, r.vertex_count, r.triangle_count, POSITIONS_ALONE);
    r.mesh = mesh;
    if (!status) status = grid_run(&r, "emit", 0.5, 0.5);
    if (!status && (r.vertex_count != mesh->vertex_count || r.triangle_count != mesh->triangle_count))
        status = reference_complex_change_fail();
    mesh->active_cell_count = r.active_count;
    mesh->timings.classify_ms = classified - start;
    mesh->timings.emit_ms = clock_ms() - classified;
    mesh->timings.total_ms = clock_ms() - start;
    reference_complex_end(&r);
    return status;
}
