/*
 * Stages, as in the kernels: signs of the samples; vertices of a layer of bricks, numbered in canonical order;
 * triangles of that layer, which need the numbers of the next one too, so numbering runs one layer ahead.
 *
 * Canonical order: bricks of 64 x 8 x 4 samples in x, y, z order; in a brick, rows of 64 samples in y, z order; in a
 * row, vertices by type, then x; triangles by x, then tetrahedron, then table order. In the hybrid method edges
 * are those of cubes, and triangles come from the table of a cube. The last type of vertices is at samples: those that
 * the surface goes through, and of closed surfaces those of the border. These also have, behind the triangles of a row,
 * those in the border by x, then face.
 */
#include "reference/reference.h"

#include "opencl/context.h"
#include "failure.h"
#include "reference/reference_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void signs_make(reference *r) {
    const tc_grid *grid = r->grid;
    int64_t count = grid_sample_count(grid);
    r->complete = !grid->blanked_cells;
    for (int64_t n = 0; n < count; n++) {
        double value = grid_value_at(grid, n);
        bool present = isfinite(value) && !(grid->has_nodata && value == grid->nodata);
        present = present && !(grid->blanked_samples && grid->blanked_samples[n]);
        r->signs[n] = (uint8_t)((value >= r->isovalue ? INSIDE : 0) | (present ? PRESENT : 0));
        r->complete = r->complete && present;
    }
}

/* ----------------------------------------------------------------------------------------------------------- edges */

static const uint8_t edge_axes[EDGES_PER_SAMPLE] = {1, 2, 4, 3, 5, 6}; /* bit n: the edge spans axis n */

/* The ends of an edge, the lower linear sample index first. */
static void edge_ends(const reference *r, const int64_t owner[3], int type, int64_t a[3], int64_t b[3]) {
    unsigned axes = edge_axes[type];
    for (int axis = 0; axis < 3; axis++) {
        a[axis] = owner[axis];
        b[axis] = owner[axis] + (axes >> axis & 1);
    }
    if (type >= EDGE_XY && cube_parity(r, owner)) {
        int axis = type == EDGE_YZ ? 1 : 0;
        a[axis]++, b[axis]--;
    }
}

/* A vertex exists where a present cube contains its edge. */
static bool edge_exists(const reference *r, const int64_t owner[3], int type) {
    unsigned axes = edge_axes[type];
    for (int axis = 0; axis < 3; axis++)
        if ((axes >> axis & 1) && owner[axis] + 1 >= r->dims[axis]) return false;
    if (r->complete) return true;
    for (unsigned back = 0; back < 8; back++) {
        int64_t cube[3] = {owner[0] - (back & 1), owner[1] - (back >> 1 & 1), owner[2] - (back >> 2)};
        if (!(back & axes) && cube_present(r, cube)) return true;
    }
    return false;
}

/* Whether a row of cubes and samples has no sign change, neighbours included: it then emits nothing. */
static bool row_uniform(const reference *r, int64_t x0, int64_t x1, int64_t y, int64_t z) {
    int64_t count = (x1 < r->dims[0] ? x1 + 1 : x1) - x0;
    uint8_t any = 0, all = INSIDE;
    for (int64_t k = z; k <= z + 1 && k < r->dims[2]; k++)
        for (int64_t j = y; j <= y + 1 && j < r->dims[1]; j++) {
            const uint8_t *signs = r->signs + sample_index(r, (int64_t[3]){x0, j, k});
            /* Classified before. NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign) */
            for (int64_t n = 0; n < count; n++) any |= signs[n], all &= signs[n];
        }
    return !(any & SNAPPED) && (!(any & INSIDE) || (all & INSIDE));
}

/* -------------------------------------------------------------------------------------------------------- vertices */

/* The two samples whose difference along an axis is taken: central; one-sided at borders and beside missing samples;
 * the same sample twice, so 0, where both sides are a border or missing. */
typedef struct neighbours {
    int64_t before[3], after[3];
    float weight; /* 1/32 or 1/16 in place of 1/2 or 1, so that products of differences do not overflow */
} neighbours;

static neighbours neighbours_of(const reference *r, const int64_t p[3], int axis) {
    neighbours n = {{p[0], p[1], p[2]}, {p[0], p[1], p[2]}, 0.0625f};
    n.before[axis]--, n.after[axis]++;
    bool has_before = n.before[axis] >= 0 && sample_is(r, n.before, PRESENT);
    bool has_after = n.after[axis] < r->dims[axis] && sample_is(r, n.after, PRESENT);
    if (!has_before) n.before[axis]++;
    if (!has_after) n.after[axis]--;
    if (has_before && has_after) n.weight = 0.03125f;
    return n;
}

/* World coordinate `row` of a sample of a grid that is not uniform. */
static float coordinate_at(const reference *r, const int64_t p[3], int row) {
    if (r->grid->kind == GRID_RECTILINEAR) return r->grid->axes[row][p[row]];
    return r->grid->points[3 * sample_index(r, p) + row];
}

#define REAL    float
#define NAME(x) x##_f32
#define SQRT    sqrtf
#include "reference/reference_crossing.inc"
#include "reference/reference_vertex.inc"
#undef REAL
#undef NAME
#undef SQRT
#define REAL    double
#define NAME(x) x##_f64
#define SQRT    sqrt
#include "reference/reference_crossing.inc"
#include "reference/reference_vertex.inc"

static void position_between(const reference *r, const int64_t a[3], const int64_t b[3], float t, float out[3]) {
    for (int row = 0; row < 3; row++) {
        float p0 = coordinate_at(r, a, row), p1 = coordinate_at(r, b, row);
        out[row] = t == 1 ? p1 : p0 + t * (p1 - p0);
    }
}

static void position_make(const reference *r, const int64_t a[3], const int64_t b[3], float t, float out[3]) {
    const float *m = r->grid->matrix;
    float p[3];
    for (int axis = 0; axis < 3; axis++) {
        float start = (float)(r->grid->first[axis] + a[axis]);
        p[axis] = b[axis] > a[axis] ? start + t : b[axis] < a[axis] ? start - t : start;
    }
    for (int row = 0; row < 3; row++, m += 4) out[row] = ((m[0] * p[0] + m[1] * p[1]) + m[2] * p[2]) + m[3];
}

/* 0 at a sample of the border. */
static float edge_crossing(const reference *r, const int64_t a[3], const int64_t b[3]) {
    if (sample_index(r, a) == sample_index(r, b)) return 0;
    double value_a = sample_value(r, a), value_b = sample_value(r, b);
    return type_is_wide(r->grid->type) ? crossing_f64(value_a, value_b, r->isovalue)
                                       : crossing_f32(value_a, value_b, r->isovalue);
}

/* What each channel has at t on an edge. */
typedef void channel_make(const reference *r, const int64_t a[3], const int64_t b[3], float t, float out[3]);

void reference_position(const reference *r, const int64_t a[3], const int64_t b[3], float t, float out[3]) {
    if (r->grid->kind == GRID_UNIFORM)
        position_make(r, a, b, t, out);
    else
        position_between(r, a, b, t, out);
}

static void normal_at(const reference *r, const int64_t a[3], const int64_t b[3], float t, float out[3]) {
    if (type_is_wide(r->grid->type))
        normal_f64(r, a, b, t, out);
    else
        normal_f32(r, a, b, t, out);
}

static channel_make *const makes[CHANNEL_COUNT] = {
    [CHANNEL_POSITIONS] = reference_position, [CHANNEL_NORMALS] = normal_at};

/* Not inlined, as few edges have a vertex: the loop over all edges keeps its registers. */
__attribute__((noinline)) static void vertex_emit(reference *r, const int64_t a[3], const int64_t b[3]) {
    const float t = edge_crossing(r, a, b);
    for (int channel = 0; channel < CHANNEL_COUNT; channel++)
        if (channel_in(r->made, channel))
            makes[channel](r, a, b, t, (float *)r->mesh->channels[channel].memory + 3 * r->vertex_count);
}

/* Whether a sample is a corner of a face that one present cube has. */
static bool at_border_of_cubes(const reference *r, const int64_t p[3]) {
    const int present = cubes_present_around(r, p);
    return present > 0 && present < 8;
}

/* Whether a sample owns a vertex at itself, as the surface goes through it, or ends at the border inside it. The
 * latter is both ends of the edge that the vertex lies on. */
static bool sample_vertex_find(const reference *r, const int64_t owner[3], int64_t a[3], int64_t b[3]) {
    if (sample_is(r, owner, SNAPPED)) {
        snapped_edge(r, owner, a, b);
        return true;
    }
    memcpy(a, owner, 3 * sizeof *a);
    memcpy(b, owner, 3 * sizeof *b);
    return r->closed && sample_is(r, owner, INSIDE) && at_border_of_cubes(r, owner);
}

/* Whether a sample owns a vertex of a type, and the ends of the edge that it lies on. */
static bool vertex_find(const reference *r, const int64_t owner[3], int type, int64_t a[3], int64_t b[3]) {
    if (type == VERTEX_SAMPLE) return sample_vertex_find(r, owner, a, b);
    if (!edge_exists(r, owner, type)) return false;
    edge_ends(r, owner, type, a, b);
    return sample_is(r, a, INSIDE) != sample_is(r, b, INSIDE) && !sample_is(r, a, SNAPPED) && !sample_is(r, b, SNAPPED);
}

static void row_vertices_of(reference *r, int type, int64_t x0, int64_t x1, int64_t y, int64_t z) {
    for (int64_t x = x0; x < x1; x++) {
        int64_t owner[3] = {x, y, z}, a[3], b[3];
        if (!vertex_find(r, owner, type, a, b)) continue;
        const bool is_own = z / BRICK_Z != r->halo_layer;
        if (r->mesh && (!is_own || r->vertex_count < r->mesh->vertex_count))
            *vertex_id(r, owner, type) = (uint32_t)r->vertex_count;
        if (r->mesh && is_own && r->vertex_count < r->mesh->vertex_count) vertex_emit(r, a, b);
        if (r->carried)
            carry_vertex(r->carried, r->vertex_count, sample_index(r, a), sample_index(r, b), edge_crossing(r, a, b));
        r->vertex_count++;
    }
}

static void row_vertices(reference *r, int64_t x0, int64_t x1, int64_t y, int64_t z) {
    const int types = row_uniform(r, x0, x1, y, z) ? 0 : methods[r->method].vertex_types;
    for (int type = 0; type < types && type < VERTEX_SAMPLE; type++) row_vertices_of(r, type, x0, x1, y, z);
    if (types > VERTEX_SAMPLE || r->closed) row_vertices_of(r, VERTEX_SAMPLE, x0, x1, y, z);
}

/* ------------------------------------------------------------------------------------------------------- triangles */

/* The next triangle; NULL where none is made, or the mesh has no room for it (reference_complete). */
static uint32_t *triangle_next(const reference *r) {
    if (!r->mesh || r->triangle_count >= r->mesh->triangle_count) return NULL;
    return (uint32_t *)r->mesh->triangles.memory + 3 * r->triangle_count;
}

static void triangle_emit(reference *r, const int64_t cube[3], const owned_vertex vertices[3]) {
    uint32_t *triangle = triangle_next(r);
    for (unsigned m = 0; m < 3 && triangle; m++) {
        const owned_vertex v = vertices[m];
        triangle[m] = *vertex_id(r, (int64_t[3]){cube[0] + v.dx, cube[1] + v.dy, cube[2] + v.dz}, v.type);
    }
    r->triangle_count++;
}

/* The signs of a cube's corners, as bits. */
typedef struct cube_signs {
    unsigned inside, snapped;
} cube_signs;

/* On an edge of a tetrahedron whose ends differ: a snapped sample counts as outside, and is the vertex. */
static owned_vertex vertex_between(cube_signs signs, unsigned a, unsigned b) {
    if (signs.snapped >> a & 1) return cube_vertex(CUBE_EDGES + a);
    if (signs.snapped >> b & 1) return cube_vertex(CUBE_EDGES + b);
    return edge_between(a, b);
}

static bool same_vertex(owned_vertex a, owned_vertex b) { return memcmp(&a, &b, sizeof a) == 0; }

/* Triangles by the 16 cases of a tetrahedron; those of which two vertices fall together are left out. The kernels have
 * them from the table of cubes that is derived of these, so that each checks the other. */
static void tetrahedron_emit(reference *r, const int64_t cube[3], const uint8_t corners[4], cube_signs signs) {
    unsigned index = 0;
    for (unsigned v = 0; v < 4; v++) index |= (signs.inside >> corners[v] & 1) << v;
    const tetrahedron_case *c = &tetrahedron_cases[index];
    for (unsigned n = 0; n < c->triangle_count; n++) {
        owned_vertex vertices[3];
        for (unsigned m = 0; m < 3; m++) {
            const uint8_t *ends = tetrahedron_edges[c->triangles[n][r->grid->mirrored ? (3 - m) % 3 : m]];
            vertices[m] = vertex_between(signs, corners[ends[0]], corners[ends[1]]);
        }
        if (!same_vertex(vertices[0], vertices[1]) && !same_vertex(vertices[1], vertices[2]) &&
            !same_vertex(vertices[2], vertices[0]))
            triangle_emit(r, cube, vertices);
    }
}

static void tetrahedra_emit(reference *r, const int64_t cube[3], cube_signs signs) {
    for (unsigned t = 0; t < TETRAHEDRA_PER_CUBE; t++)
        tetrahedron_emit(r, cube, tetrahedron_corners[cube_parity(r, cube)][t], signs);
}

static void case_emit(reference *r, const int64_t cube[3], cube_signs signs) {
    const cube_case *c = &r->cases[cube_parity(r, cube)][signs.inside];
    for (unsigned n = 0; n < c->triangle_count; n++) {
        owned_vertex vertices[3];
        for (unsigned m = 0; m < 3; m++) vertices[m] = cube_vertex(c->vertices[n][m]);
        triangle_emit(r, cube, vertices);
    }
}

static cube_signs signs_of(const reference *r, const int64_t cube[3]) {
    cube_signs signs = {0, 0};
    for (unsigned c = 0; c < 8; c++) {
        const int64_t corner[3] = {cube[0] + (c & 1), cube[1] + (c >> 1 & 1), cube[2] + (c >> 2)};
        if (sample_is(r, corner, SNAPPED))
            signs.snapped |= 1u << c;
        else if (sample_is(r, corner, INSIDE))
            signs.inside |= 1u << c;
    }
    return signs;
}

static void row_surface(reference *r, int64_t x0, int64_t x1, int64_t y, int64_t z) {
    if (row_uniform(r, x0, x1, y, z)) return;
    for (int64_t x = x0; x < x1; x++) {
        int64_t cube[3] = {x, y, z};
        if (!cube_present(r, cube)) continue;
        const uint64_t before = r->triangle_count;
        const cube_signs signs = signs_of(r, cube);
        if (signs.inside == 0 || signs.inside == 255) continue;
        if (method_has_diagonals(r->method))
            tetrahedra_emit(r, cube, signs);
        else
            case_emit(r, cube, signs);
        r->active_cell_count += r->triangle_count > before;
    }
}

/* The inside part of a face on the border. */
static void cap_emit(reference *r, const int64_t cube[3], unsigned face, cube_signs signs) {
    unsigned digits = 0;
    for (unsigned n = 4; n-- > 0;) {
        const unsigned corner = face_corner(face, n);
        digits = 3 * digits + (signs.inside >> corner & 1) * 2 + (signs.snapped >> corner & 1);
    }
    const cap_case *c = &r->caps[cube_parity(r, cube)][face][digits];
    for (unsigned n = 0; n < c->triangle_count; n++) {
        owned_vertex vertices[3];
        for (unsigned m = 0; m < 3; m++) vertices[m] = cube_vertex(c->vertices[n][m]);
        triangle_emit(r, cube, vertices);
    }
}

/* Closes the surface by faces that one present cube has. */
static void row_caps(reference *r, int64_t x0, int64_t x1, int64_t y, int64_t z) {
    for (int64_t x = x0; x < x1; x++) {
        int64_t cube[3] = {x, y, z};
        if (!cube_present(r, cube)) continue;
        const cube_signs signs = signs_of(r, cube);
        for (unsigned face = 0; face < CUBE_FACES && signs.inside; face++) {
            int64_t beside[3] = {x, y, z};
            beside[face / 2] += face & 1 ? 1 : -1;
            if (!cube_present(r, beside)) cap_emit(r, cube, face, signs);
        }
    }
}

static void row_triangles(reference *r, int64_t x0, int64_t x1, int64_t y, int64_t z) {
    row_surface(r, x0, x1, y, z);
    if (r->closed) row_caps(r, x0, x1, y, z);
}

/* ---------------------------------------------------------------------------------------------------------- layers */

typedef void row_stage(reference *r, int64_t x0, int64_t x1, int64_t y, int64_t z);

static void brick_run(reference *r, const int64_t at[3], row_stage *stage) {
    const int64_t x1 = at[0] + BRICK_X < r->dims[0] ? at[0] + BRICK_X : r->dims[0];
    for (int64_t z = at[2]; z < at[2] + BRICK_Z && z < r->dims[2]; z++)
        for (int64_t y = at[1]; y < at[1] + BRICK_Y && y < r->dims[1]; y++) stage(r, at[0], x1, y, z);
}

static void layer_run(reference *r, int64_t layer, row_stage *stage) {
    for (int64_t y = 0; y < r->dims[1]; y += BRICK_Y)
        for (int64_t x = 0; x < r->dims[0]; x += BRICK_X) brick_run(r, (int64_t[3]){x, y, layer * BRICK_Z}, stage);
}

void reference_layer_vertices(reference *r, int64_t layer) {
    const piece_seams *seams = &r->grid->seams;
    const uint64_t own_end = r->vertex_count;
    const bool is_first = layer * BRICK_Z == r->grid->own[0];
    size_t brick = 0;
    if (layer == r->halo_layer && !seams->next) return;
    for (int64_t y = 0; y < r->dims[1]; y += BRICK_Y)
        for (int64_t x = 0; x < r->dims[0]; x += BRICK_X, brick++) {
            if (layer == r->halo_layer) r->vertex_count = own_end + seams->next[brick];
            if (is_first && seams->own) seams->own[brick] = (uint32_t)r->vertex_count;
            brick_run(r, (int64_t[3]){x, y, layer * BRICK_Z}, row_vertices);
        }
    if (layer == r->halo_layer) r->vertex_count = own_end;
}

/* The first layer of the grid's own, and the one behind them. */
static int64_t own_layer(const reference *r, int end) { return (r->grid->own[end] + BRICK_Z - 1) / BRICK_Z; }

/* before, share: where this stage begins in the whole call and its share of it, for progress. */
static tc_status layers_run(reference *r, const char *stage, double before, double share) {
    const int64_t first = own_layer(r, 0), end = own_layer(r, 1), layer_count = (r->dims[2] + BRICK_Z - 1) / BRICK_Z;
    r->vertex_count = r->triangle_count = r->active_cell_count = 0;
    reference_layer_vertices(r, first);
    for (int64_t layer = first; layer < end; layer++) {
        if (layer + 1 < layer_count) reference_layer_vertices(r, layer + 1);
        layer_run(r, layer, row_triangles);
        tc_status status = context_progress(r->grid->context, stage,
                                            before + share * (double)(layer + 1 - first) / (double)(end - first));
        if (status) return status;
    }
    return TC_OK;
}

tc_status reference_begin(reference *r, const tc_grid *grid, const tc_extract_options *options) {
    *r = (reference){.grid = grid, .isovalue = options->isovalue, .made = channels_asked(options)};
    for (int axis = 0; axis < 3; axis++) r->dims[axis] = grid->dims[axis];
    r->method = options->method;
    r->threshold = (float)options->snap;
    r->closed = options->closed;
    r->halo_layer = grid_has_seam(grid) ? own_layer(r, 1) : -1;
    r->id_types = r->closed ? VERTEX_TYPES_MOST : methods[r->method].vertex_types;
    if (!method_has_diagonals(r->method)) methods[r->method].derive(r->cases[0], grid->mirrored);
    if (r->closed) methods[r->method].derive_caps(r->caps[0][0], grid->mirrored);
    r->signs = malloc((size_t)grid_sample_count(grid));
    if (!r->signs) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the signs of the samples");
    signs_make(r);
    if (method_has_zeros(r->method)) samples_snap(r);
    return TC_OK;
}

/* Zeroed: edges without a vertex are read only where the caller changes samples meanwhile. */
tc_status reference_ids_allocate(reference *r) {
    size_t count = (size_t)(r->dims[0] * r->dims[1]) * BRICK_Z * (size_t)r->id_types;
    for (int n = 0; n < 2; n++)
        if (!(r->ids[n] = calloc(count, sizeof *r->ids[n])))
            return (tc_status)fail(TC_ERROR_MEMORY, "no memory for vertex numbers");
    return TC_OK;
}

tc_status reference_complete(const reference *r, bool triangles) {
    if (r->vertex_count == r->mesh->vertex_count && (!triangles || r->triangle_count == r->mesh->triangle_count))
        return TC_OK;
    return (tc_status)fail(TC_ERROR_DATA, "samples, or what is blanked, have changed while a surface was made of them");
}

void reference_end(reference *r) {
    free(r->signs);
    free(r->ids[0]);
    free(r->ids[1]);
}

tc_status reference_count(const tc_grid *grid, const tc_extract_options *options, tc_counts *counts) {
    reference r;
    double start = clock_ms();
    tc_status status = reference_begin(&r, grid, options);
    if (!status) status = layers_run(&r, "classify", 0, 1);
    counts->vertex_count = r.vertex_count;
    counts->triangle_count = r.triangle_count;
    counts->active_cell_count = r.active_cell_count;
    counts->classify_ms = clock_ms() - start;
    reference_end(&r);
    return status;
}

tc_status reference_extract(const tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh) {
    reference r;
    const double start = clock_ms();
    tc_status status = reference_begin(&r, grid, options);
    if (!status) status = layers_run(&r, "classify", 0, 0.5);
    if (status) goto cleanup;
    const double classified = clock_ms();
    status = seam_numbers_check(grid, r.vertex_count);
    if (!status) status = mesh_allocate(mesh, r.vertex_count, r.triangle_count, r.made);
    if (!status) status = reference_ids_allocate(&r);
    if (status) goto cleanup;
    r.mesh = mesh;
    status = layers_run(&r, "emit", 0.5, 0.5);
    if (!status) status = reference_complete(&r, true);
    mesh->active_cell_count = r.active_cell_count;
    mesh->timings.classify_ms = classified - start;
    mesh->timings.emit_ms = clock_ms() - classified;
    mesh->timings.total_ms = clock_ms() - start;
cleanup:
    reference_end(&r);
    return status;
}

tc_status reference_vertices(const tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh) {
    reference r;
    tc_status status = reference_begin(&r, grid, options);
    if (!status) status = reference_ids_allocate(&r);
    if (!status) {
        r.mesh = mesh;
        for (int64_t layer = own_layer(&r, 0); layer < own_layer(&r, 1); layer++) layer_run(&r, layer, row_vertices);
        status = reference_complete(&r, false);
    }
    reference_end(&r);
    return status;
}

tc_status reference_carry(const tc_grid *grid, const tc_extract_options *options, const carry *c,
                          uint64_t *vertex_count) {
    reference r;
    tc_status status = reference_begin(&r, grid, options);
    const int64_t first = own_layer(&r, 0), end = own_layer(&r, 1);
    r.carried = c;
    for (int64_t layer = first; layer < end && !status; layer++) {
        layer_run(&r, layer, row_vertices);
        status = context_progress(grid->context, "carry", (double)(layer + 1 - first) / (double)(end - first));
    }
    *vertex_count = r.vertex_count;
    reference_end(&r);
    return status;
}
