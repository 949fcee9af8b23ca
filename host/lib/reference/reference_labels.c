/*
 * Stages, as in reference.c: vertices of a layer of bricks, numbered in canonical order, one layer ahead; triangles of
 * that layer. In a row vertices are ordered by type (label_tables.h), then x; triangles by x, tetrahedron, interface.
 * With two labels, all of this is what the isovalue between them gives.
 */
#include "reference/reference_labels.h"

#include "tables/label_tables.h"
#include "opencl/context.h"
#include "failure.h"

#include <stdlib.h>

enum { BRICK_X = 64, BRICK_Y = 8, BRICK_Z = 4 };

typedef struct labels_run {
    const label_volume *v;
    label_tables tables;
    uint32_t *ids[2]; /* of each vertex, for even and odd layers: [(sample in layer)][type] */
    tc_mesh *mesh;    /* NULL: count only */
    uint64_t vertex_count, triangle_count, active_cell_count;
} labels_run;

static uint32_t label_of(const labels_run *r, const int64_t p[3]) {
    const int64_t *dims = r->v->dims;
    return label_at(r->v, (p[2] * dims[1] + p[1]) * dims[0] + p[0]);
}

static void corner_of(const int64_t p[3], unsigned corner, int64_t out[3]) {
    for (unsigned axis = 0; axis < 3; axis++) out[axis] = p[axis] + (corner >> axis & 1);
}

static bool in_volume(const labels_run *r, const int64_t p[3]) {
    for (int axis = 0; axis < 3; axis++)
        if (p[axis] < 0 || p[axis] >= r->v->dims[axis]) return false;
    return true;
}

static unsigned cube_parity(const labels_run *r, const int64_t p[3]) {
    return (label_volume_parity(r->v) ^ (unsigned)(p[0] + p[1] + p[2])) & 1;
}

/* Whether a row of cubes and samples has one label, neighbours included: it then emits nothing. */
static bool row_uniform(const labels_run *r, int64_t x0, int64_t x1, int64_t y, int64_t z) {
    const int64_t *dims = r->v->dims, end = x1 < dims[0] ? x1 + 1 : x1;
    const uint32_t label = label_of(r, (int64_t[3]){x0, y, z});
    for (int64_t k = z; k <= z + 1 && k < dims[2]; k++)
        for (int64_t j = y; j <= y + 1 && j < dims[1]; j++)
            for (int64_t x = x0; x < end; x++)
                if (label_of(r, (int64_t[3]){x, j, k}) != label) return false;
    return true;
}

/* -------------------------------------------------------------------------------------------------------- vertices */

/* World coordinate `row` of a sample of a grid that is not uniform; around it, in the layer of background, points go on
 * as they end. */
static double coordinate_at(const labels_run *r, const int64_t p[3], int row) {
    const tc_grid *grid = r->v->grid;
    for (int axis = 0; axis < 3; axis++) {
        int64_t near[3] = {p[0], p[1], p[2]}, far[3] = {p[0], p[1], p[2]};
        const int64_t last = grid->dims[axis] - 1;
        if (p[axis] >= 0 && p[axis] <= last) continue;
        near[axis] = p[axis] < 0 ? 0 : last;
        far[axis] = p[axis] < 0 ? 1 : last - 1;
        return 2 * coordinate_at(r, near, row) - coordinate_at(r, far, row);
    }
    if (grid->kind == GRID_RECTILINEAR) return (double)grid->axes[row][p[row]];
    return (double)grid->points[3 * ((p[2] * grid->dims[1] + p[1]) * grid->dims[0] + p[0]) + row];
}

/* The middle of the samples that a vertex lies between. */
static void middle_make(const labels_run *r, const int64_t owner[3], const label_corners *c, float out[3]) {
    const int64_t before = r->v->before;
    for (int row = 0; row < 3; row++) {
        double sum = 0;
        for (unsigned n = 0; n < c->count; n++) {
            int64_t p[3];
            corner_of(owner, c->corners[n], p);
            sum += coordinate_at(r, (int64_t[3]){p[0] - before, p[1] - before, p[2] - before}, row);
        }
        out[row] = (float)(sum / (double)c->count);
    }
}

static void position_make(const labels_run *r, const int64_t owner[3], const float offset[3], float out[3]) {
    const tc_grid *grid = r->v->grid;
    const float *m = grid->matrix;
    float p[3];
    for (int axis = 0; axis < 3; axis++)
        p[axis] = (float)(grid->first[axis] - r->v->before + owner[axis]) + offset[axis];
    for (int row = 0; row < 3; row++, m += 4) out[row] = ((m[0] * p[0] + m[1] * p[1]) + m[2] * p[2]) + m[3];
}

static uint32_t *vertex_id(const labels_run *r, const int64_t owner[3], int type) {
    const int64_t z = owner[2] % BRICK_Z, layer = owner[2] / BRICK_Z;
    const int64_t sample = (z * r->v->dims[1] + owner[1]) * r->v->dims[0] + owner[0];
    return r->ids[layer & 1] + sample * LABEL_TYPES + type;
}

/* A vertex exists where all samples that it lies between have labels of their own. */
static bool vertex_exists(const labels_run *r, const int64_t owner[3], const label_corners *c) {
    uint32_t labels[4];
    for (unsigned n = 0; n < c->count; n++) {
        int64_t p[3];
        corner_of(owner, c->corners[n], p);
        if (!in_volume(r, p)) return false;
        labels[n] = label_of(r, p);
        for (unsigned m = 0; m < n; m++)
            if (labels[m] == labels[n]) return false;
    }
    return true;
}

static void vertex_emit(labels_run *r, const int64_t owner[3], unsigned parity, int type) {
    if (r->vertex_count >= r->mesh->vertex_count) return;
    float *to = (float *)r->mesh->channels[CHANNEL_POSITIONS].memory + 3 * r->vertex_count;
    if (r->v->grid->kind == GRID_UNIFORM)
        position_make(r, owner, r->tables.offsets[parity][type], to);
    else
        middle_make(r, owner, &r->tables.corners[parity][type], to);
    *vertex_id(r, owner, type) = (uint32_t)r->vertex_count;
}

static void row_vertices(labels_run *r, int64_t x0, int64_t x1, int64_t y, int64_t z) {
    if (row_uniform(r, x0, x1, y, z)) return;
    for (int type = 0; type < LABEL_TYPES; type++)
        for (int64_t x = x0; x < x1; x++) {
            const int64_t owner[3] = {x, y, z};
            const unsigned parity = cube_parity(r, owner);
            if (!vertex_exists(r, owner, &r->tables.corners[parity][type])) continue;
            if (r->mesh) vertex_emit(r, owner, parity, type);
            r->vertex_count++;
        }
}

/* ------------------------------------------------------------------------------------------------------- triangles */

static uint32_t vertex_number(const labels_run *r, const int64_t cube[3], owned_vertex v) {
    return *vertex_id(r, (int64_t[3]){cube[0] + v.dx, cube[1] + v.dy, cube[2] + v.dz}, v.type);
}

/* The label that comes first is on the inner side; the interface is turned over where that is the outer corner's. */
static void interface_emit(labels_run *r, const int64_t cube[3], const owned_vertex *owners, const label_interface *i,
                           const uint32_t labels[4]) {
    const bool turned = label_precedes(labels[i->outer], labels[i->inner]);
    for (unsigned n = 1; n + 1 < i->vertex_count; n++, r->triangle_count++) {
        if (!r->mesh || r->triangle_count >= r->mesh->triangle_count) continue;
        uint32_t *triangle = (uint32_t *)r->mesh->triangles.memory + 3 * r->triangle_count;
        uint32_t *sides = (uint32_t *)r->mesh->boundary_labels.memory + 2 * r->triangle_count;
        const unsigned second = turned ? i->vertex_count - n : n, third = turned ? second - 1 : n + 1;
        const bool mirrored = r->v->grid->mirrored;
        triangle[0] = vertex_number(r, cube, owners[i->vertices[0]]);
        triangle[1] = vertex_number(r, cube, owners[i->vertices[mirrored ? third : second]]);
        triangle[2] = vertex_number(r, cube, owners[i->vertices[mirrored ? second : third]]);
        sides[0] = labels[turned ? i->outer : i->inner];
        sides[1] = labels[turned ? i->inner : i->outer];
    }
}

static void tetrahedron_emit(labels_run *r, const int64_t cube[3], unsigned parity, unsigned t,
                             const uint32_t cube_labels[8]) {
    uint32_t labels[4];
    unsigned pattern = 0;
    for (unsigned n = 0; n < 4; n++) labels[n] = cube_labels[tetrahedron_corners[parity][t][n]];
    for (unsigned e = 0; e < 6; e++)
        pattern |= (unsigned)(labels[tetrahedron_edges[e][0]] != labels[tetrahedron_edges[e][1]]) << e;
    const label_case *c = &r->tables.cases[pattern];
    for (unsigned n = 0; n < c->interface_count; n++)
        interface_emit(r, cube, r->tables.owners[parity][t], &c->interfaces[n], labels);
}

static void row_triangles(labels_run *r, int64_t x0, int64_t x1, int64_t y, int64_t z) {
    const int64_t *dims = r->v->dims;
    if (y + 1 >= dims[1] || z + 1 >= dims[2] || row_uniform(r, x0, x1, y, z)) return;
    for (int64_t x = x0; x < x1 && x + 1 < dims[0]; x++) {
        const int64_t cube[3] = {x, y, z};
        uint32_t labels[8];
        for (unsigned c = 0; c < 8; c++) {
            int64_t p[3];
            corner_of(cube, c, p);
            labels[c] = label_of(r, p);
        }
        const uint64_t before = r->triangle_count;
        for (unsigned t = 0; t < TETRAHEDRA_PER_CUBE; t++) tetrahedron_emit(r, cube, cube_parity(r, cube), t, labels);
        r->active_cell_count += r->triangle_count > before;
    }
}

/* ---------------------------------------------------------------------------------------------------------- layers */

typedef void row_stage(labels_run *r, int64_t x0, int64_t x1, int64_t y, int64_t z);

static void brick_run(labels_run *r, const int64_t at[3], row_stage *stage) {
    const int64_t *dims = r->v->dims, x1 = at[0] + BRICK_X < dims[0] ? at[0] + BRICK_X : dims[0];
    for (int64_t z = at[2]; z < at[2] + BRICK_Z && z < dims[2]; z++)
        for (int64_t y = at[1]; y < at[1] + BRICK_Y && y < dims[1]; y++) stage(r, at[0], x1, y, z);
}

static void layer_run(labels_run *r, int64_t layer, row_stage *stage) {
    for (int64_t y = 0; y < r->v->dims[1]; y += BRICK_Y)
        for (int64_t x = 0; x < r->v->dims[0]; x += BRICK_X) brick_run(r, (int64_t[3]){x, y, layer * BRICK_Z}, stage);
}

static tc_status layers_run(labels_run *r, const char *stage, double before) {
    const int64_t layer_count = (r->v->dims[2] + BRICK_Z - 1) / BRICK_Z;
    r->vertex_count = r->triangle_count = r->active_cell_count = 0;
    layer_run(r, 0, row_vertices);
    for (int64_t layer = 0; layer < layer_count; layer++) {
        if (layer + 1 < layer_count) layer_run(r, layer + 1, row_vertices);
        layer_run(r, layer, row_triangles);
        const double done = before + 0.5 * (double)(layer + 1) / (double)layer_count;
        const tc_status status = context_progress(r->v->grid->context, stage, done);
        if (status) return status;
    }
    return TC_OK;
}

/* Zeroed: numbers without a vertex are read only where the caller changes samples meanwhile. */
static tc_status ids_allocate(labels_run *r) {
    const size_t count = (size_t)(r->v->dims[0] * r->v->dims[1]) * BRICK_Z * LABEL_TYPES;
    for (int n = 0; n < 2; n++)
        if (!(r->ids[n] = calloc(count, sizeof *r->ids[n])))
            return (tc_status)fail(TC_ERROR_MEMORY, "no memory for vertex numbers");
    return TC_OK;
}

static tc_status emit(labels_run *r, tc_mesh *mesh) {
    tc_status status = mesh_allocate_labelled(mesh, r->vertex_count, r->triangle_count);
    if (!status) status = ids_allocate(r);
    if (status) return status;
    r->mesh = mesh;
    status = layers_run(r, "emit", 0.5);
    if (!status && (r->vertex_count != mesh->vertex_count || r->triangle_count != mesh->triangle_count))
        status = (tc_status)fail(TC_ERROR_DATA, "samples have changed while a surface was made of them");
    return status;
}

tc_status reference_labels(const label_volume *volume, tc_mesh *mesh) {
    labels_run *r = calloc(1, sizeof *r);
    const double start = clock_ms();
    if (!r) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the tables of labels");
    r->v = volume;
    label_tables_derive(&r->tables);
    tc_status status = layers_run(r, "classify", 0);
    const double classified = clock_ms();
    if (!status) status = emit(r, mesh);
    mesh->active_cell_count = r->active_cell_count;
    mesh->timings.classify_ms = classified - start;
    mesh->timings.emit_ms = clock_ms() - classified;
    mesh->timings.total_ms = clock_ms() - start;
    free(r->ids[0]);
    free(r->ids[1]);
    free(r);
    return status;
}
