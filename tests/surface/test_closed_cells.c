/*
 * test_closed_cells.c - closed surfaces of unstructured grids by the reference engine, methods tetra and hybrid
 *
 * All patterns of a cell of each shape and of two hexahedra; blocks of mixed cells under random point numbers, some
 * with collapsed cells, prisms, or with points missing; noise, few values with ties, distances, and linear fields. The
 * closed mesh begins with the open one. No edge is on a border; where no cell is missing it is an oriented manifold.
 * The border's part has the Euler characteristic of the one by the other method. The volume is that of the inside part
 * of the tetrahedra; by method hybrid where the field is linear, and else the sum over cells that are closed one by
 * one.
 *
 * Usage: test_closed_cells [SEED [COUNT]]. A failure names its seed.
 */
#include "closed.h"
#include "cut.h"
#include "engines.h"
#include "random.h"
#include "topology.h"

#include <inttypes.h>
#include <math.h>

static tc_context *reference;

static void *memory_get(uint64_t bytes) {
    void *memory = calloc(bytes + 1, 1);
    if (!memory) exit(EXIT_FAILURE);
    return memory;
}

typedef enum field_kind { NOISE, TIES, DISTANCE, LINEAR, FIELDS } field_kind;

typedef struct subject {
    const char *name;
    const cell_list *list;
    tc_tetrahedra complex;
    float *values;
    double isovalue;
    bool linear, complete; /* complete: no cell is missing */
} subject;

/* ---------------------------------------------------------------------------------------------------------- meshes */

static tc_mesh *mesh_make(const subject *s, tc_method method, int closed, tc_mesh_data *data) {
    const tc_cells cells = cell_list_view(s->list);
    tc_tetrahedra_grid_options o;
    tc_extract_options how;
    tc_counts counts = {.struct_size = sizeof counts};
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_tetrahedra_grid_options_init(&o);
    tc_extract_options_init(&how);
    o.point_count = s->list->point_count, o.points = s->list->points;
    o.type = TC_F32, o.samples = s->values;
    o.tetrahedron_count = s->complex.tetrahedron_count, o.tetrahedra = s->complex.tetrahedra;
    o.source = &cells, o.cells = s->complex.cells;
    how.isovalue = s->isovalue, how.method = method, how.closed = closed;
    *data = (tc_mesh_data){.struct_size = sizeof *data};
    tc_status status = tc_tetrahedra_grid_create(reference, &o, &grid);
    if (!status) status = tc_extract(grid, &how, &mesh);
    if (!status) status = tc_mesh_get(mesh, data);
    if (!status) status = tc_count(grid, &how, &counts);
    EXPECT(!status, "%s: %s", s->name, tc_message());
    EXPECT(counts.vertex_count == data->vertex_count && counts.triangle_count == data->triangle_count,
           "%s: what is counted is not what is extracted", s->name);
    tc_grid_destroy(grid);
    return mesh;
}

static topology topology_get(const tc_mesh_data *m) {
    topology t;
    topology_of(m->positions, m->vertex_count, m->triangles, m->triangle_count, &t);
    return t;
}

/* Cells in one place may be flat: rounding decides the volume then. */
static bool is_near(double a, double b, const subject *s) {
    return fabs(a - b) < 1e-4 * (1 + (double)s->list->cell_count);
}

static const char *closed_fault(const subject *s, const tc_mesh_data *open, const tc_mesh_data *closed, bool exact) {
    const topology t = topology_get(closed);
    if (!begins_with(closed, open)) return "the open surface is another";
    if (closed->active_cell_count != open->active_cell_count) return "active cells differ in number";
    if (!is_closed(closed, closed->triangle_count)) return "not closed";
    if (t.bad_triangles || t.orphans) return "a triangle names no vertex, or one twice, or a vertex has no triangle";
    if (s->complete && (t.boundary_edges || t.bad_edges)) return "an edge has not two triangles";
    if (s->complete && t.fans != closed->vertex_count) return "a vertex has several fans";
    if (exact && !is_near(t.volume, inside_of_tetrahedra(&s->complex, s->list->points, s->values, s->isovalue), s))
        return "the volume is not that of the tetrahedra";
    return NULL;
}

/* Closed by both methods. Returns the volume by method hybrid. */
static double subject_check(const subject *s) {
    enum { OPEN, CLOSED };
    tc_mesh *meshes[2][2];
    tc_mesh_data m[2][2];
    int64_t border[2];
    for (int hybrid = 0; hybrid < 2; hybrid++) {
        for (int closed = 0; closed < 2; closed++)
            meshes[hybrid][closed] =
                mesh_make(s, hybrid ? TC_METHOD_HYBRID : TC_METHOD_TETRA, closed, &m[hybrid][closed]);
        const char *fault = closed_fault(s, &m[hybrid][OPEN], &m[hybrid][CLOSED], !hybrid || s->linear);
        EXPECT(!fault, "%s, %s: %s", s->name, hybrid ? "hybrid" : "tetra", fault);
        border[hybrid] =
            topology_get(&m[hybrid][CLOSED]).euler_characteristic - topology_get(&m[hybrid][OPEN]).euler_characteristic;
    }
    EXPECT(!s->complete || border[0] == border[1], "%s: the border's Euler characteristics are %" PRId64 ", %" PRId64,
           s->name, border[0], border[1]);
    const double volume = enclosed(&m[1][CLOSED]);
    for (int n = 0; n < 4; n++) tc_mesh_destroy(meshes[n / 2][n % 2]);
    return volume;
}

static void list_check(const cell_list *list, float *values, double isovalue, bool linear, bool complete,
                       const char *name) {
    const tc_cells cells = cell_list_view(list);
    subject s = {name, list, cut(&cells, name), values, isovalue, linear, complete};
    subject_check(&s);
    tc_tetrahedra_release(&s.complex);
}

/* -------------------------------------------------------------------------------------------------------- patterns */

/* All patterns of a cell, its points numbered at random. */
static void test_patterns(void) {
    static const struct {
        int type, corners;
        double points[12][3];
    } shapes[6] = {
        {10, 4, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
        {12, 8, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}},
        {13, 6, {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}}},
        {14, 5, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}}},
        {15,
         10,
         {{0, 0, 0},
          {2, 0, 0},
          {3, 1, 0},
          {1, 2, 0},
          {-1, 1, 0},
          {0, 0, 1},
          {2, 0, 1},
          {3, 1, 1},
          {1, 2, 1},
          {-1, 1, 1}}},
        {16,
         12,
         {{0, 0, 0},
          {2, 0, 0},
          {3, 1, 0},
          {2, 2, 0},
          {0, 2, 0},
          {-1, 1, 0},
          {0, 0, 1},
          {2, 0, 1},
          {3, 1, 1},
          {2, 2, 1},
          {0, 2, 1},
          {-1, 1, 1}}},
    };
    for (int shape = 0; shape < 6; shape++)
        for (unsigned pattern = 0; pattern < 1u << shapes[shape].corners; pattern++) {
            cell_list list = cell_list_make(12, 1);
            uint32_t corners[12];
            float values[12];
            char name[60];
            for (int n = 0; n < shapes[shape].corners; n++) {
                const double *p = shapes[shape].points[n];
                corners[n] = cell_list_point(&list, p[0], p[1], p[2]);
            }
            cell_list_add(&list, shapes[shape].type, shapes[shape].corners, corners, random_below(2));
            cell_list_renumber(&list);
            for (int n = 0; n < 12; n++) values[n] = (float)(pattern >> n & 1) - 0.5f;
            snprintf(name, sizeof name, "cell of type %d, pattern %03x", shapes[shape].type, pattern);
            list_check(&list, values, 0, false, true, name);
            cell_list_free(&list);
        }
}

static void test_two_hexahedra(void) {
    for (unsigned pattern = 0; pattern < 4096; pattern++) {
        cell_list list = hexahedra_make((uint32_t[3]){1, 1, 2}, true);
        float values[12];
        char name[60];
        for (int n = 0; n < 12; n++) values[n] = (float)(pattern >> n & 1) - 0.5f;
        snprintf(name, sizeof name, "two hexahedra, pattern %03x", pattern);
        list_check(&list, values, 0, false, true, name);
        cell_list_free(&list);
    }
}

/* ---------------------------------------------------------------------------------------------------- random grids */

/* Few values are those that some points have: the isovalue, 0, among them. */
static void values_choose(const cell_list *list, float *values, field_kind kind) {
    double normal[3];
    for (int n = 0; n < 3; n++) normal[n] = random_between(-1, 1);
    for (uint64_t n = 0; n < list->point_count; n++) {
        const float *p = list->points + 3 * n;
        const double far = sqrt((double)(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]));
        const double level = normal[0] * (p[0] - 1) + normal[1] * (p[1] - 1) + normal[2] * (p[2] - 1);
        values[n] = kind == NOISE    ? (float)random_between(-1, 1)
                    : kind == TIES   ? (float)random_below(3) - 1
                    : kind == LINEAR ? (float)(level + 0.1)
                                     : (float)(2.5 - far);
    }
}

/* Cells with a missing point are left out by method hybrid, as where they are blanked. */
static void missing_check(const cell_list *list, float *values, const char *name) {
    tc_cells cells = cell_list_view(list);
    uint8_t *blanked = memory_get(list->point_count);
    for (uint64_t n = 0; n < list->point_count; n++) blanked[n] = random_below(10) == 0;
    subject s = {name, list, cut(&cells, name), values, 0, false, false}, others = s;
    cells.blanked_points = blanked;
    others.complex = cut(&cells, name);
    tc_mesh_data m[2];
    tc_mesh *meshes[2] = {mesh_make(&others, TC_METHOD_HYBRID, 1, &m[0]), NULL};
    for (uint64_t n = 0; n < list->point_count; n++)
        if (blanked[n]) values[n] = random_below(2) ? NAN : INFINITY;
    meshes[1] = mesh_make(&s, TC_METHOD_HYBRID, 1, &m[1]);
    const char *difference = mesh_difference(&m[0], &m[1]);
    EXPECT(!difference, "%s, missing samples and blanked points: %s", name, difference);
    subject_check(&s);
    for (int n = 0; n < 2; n++) tc_mesh_destroy(meshes[n]);
    tc_tetrahedra_release(&s.complex);
    tc_tetrahedra_release(&others.complex);
    free(blanked);
}

static void run(uint64_t seed) {
    char name[120];
    random_state = seed * 0x2545f4914f6cdd1du;
    const uint32_t size = 1 + random_below(4);
    const field_kind kind = (field_kind)random_below(FIELDS);
    const bool prisms = random_below(4) == 0, collapsed = !prisms && random_below(3) == 0;
    const uint64_t block_seed = random_u64();
    cell_list list = prisms ? honeycomb_make(size, block_seed) : mixed_block_make(size, block_seed);
    if (prisms) cell_list_drop_polyhedra(&list);
    if (collapsed) cell_list_collapse(&list);
    snprintf(name, sizeof name, "seed %" PRIu64 ": %s of %u, field %d%s", seed, prisms ? "prisms" : "mixed block", size,
             (int)kind, collapsed ? ", collapsed" : "");
    random_state = block_seed;
    float *values = memory_get(4 * list.point_count);
    values_choose(&list, values, kind);
    list_check(&list, values, 0, kind == LINEAR, !prisms, name);
    if (random_below(3) == 0) missing_check(&list, values, name);
    free(values);
    cell_list_free(&list);
}

/* ----------------------------------------------------------------------------------------------------- cell by cell */

/* Hexahedra under random numbers, with cells of noise: the whole encloses what its cells do, as both sides of a face
 * are cut alike, one from either side. */
static void test_cells_add_up(void) {
    enum { SIZE = 3, CELLS = SIZE * SIZE * SIZE };
    cell_list list = hexahedra_make((uint32_t[3]){SIZE, SIZE, SIZE}, true);
    float *values = memory_get(4 * list.point_count);
    double sum = 0;
    values_choose(&list, values, NOISE);
    for (uint64_t n = 0; n <= CELLS; n++) {
        tc_cells cells = cell_list_view(&list);
        if (n < CELLS) cells.cell_count = 1, cells.types += n, cells.offsets += n;
        cell_list one = list;
        one.cell_count = cells.cell_count, one.types += n < CELLS ? n : 0, one.offsets += n < CELLS ? n : 0;
        subject s = {"cell by cell", &one, cut(&cells, "cell by cell"), values, 0, false, n == CELLS};
        const double volume = subject_check(&s);
        tc_tetrahedra_release(&s.complex);
        if (n < CELLS) sum += volume;
        if (n == CELLS) EXPECT(fabs(sum - volume) < 1e-3, "cells enclose %g, all together %g", sum, volume);
    }
    free(values);
    cell_list_free(&list);
}

/* What all grids are checked with finds a corner moved, and a triangle less. */
static void test_faults_are_found(void) {
    cell_list list = mixed_block_make(3, 5);
    const tc_cells cells = cell_list_view(&list);
    float *values = memory_get(4 * list.point_count);
    values_choose(&list, values, NOISE);
    subject s = {"faults", &list, cut(&cells, "faults"), values, 0, false, true};
    tc_mesh_data open, closed;
    tc_mesh *meshes[2] = {mesh_make(&s, TC_METHOD_HYBRID, 0, &open), mesh_make(&s, TC_METHOD_HYBRID, 1, &closed)};
    const uint64_t first = 3 * open.triangle_count, count = 3 * closed.triangle_count;
    uint32_t *triangles = memory_get(4 * count);
    memcpy(triangles, closed.triangles, 4 * count);
    closed.triangles = triangles;
    EXPECT(!closed_fault(&s, &open, &closed, false), "a fault where none is");
    for (int n = 0; n < 100; n++) {
        uint32_t *corner = triangles + first + random_below((uint32_t)(count - first)), old = *corner;
        *corner = (old + 1 + random_below((uint32_t)closed.vertex_count - 1)) % (uint32_t)closed.vertex_count;
        EXPECT(closed_fault(&s, &open, &closed, false), "a corner moved from %u to %u is not found", old, *corner);
        *corner = old;
    }
    closed.triangle_count--;
    EXPECT(closed_fault(&s, &open, &closed, false), "a missing triangle is not found");
    free(triangles);
    for (int n = 0; n < 2; n++) tc_mesh_destroy(meshes[n]);
    tc_tetrahedra_release(&s.complex);
    free(values);
    cell_list_free(&list);
}

int main(int argc, char **argv) {
    const uint64_t seed = argc > 1 ? strtoull(argv[1], NULL, 10) : 1;
    const uint64_t count = argc > 2 ? strtoull(argv[2], NULL, 10) : 1000;
    reference = reference_open();
    for (uint64_t n = 0; n < count; n++) run(seed + n);
    if (argc <= 1) {
        test_patterns();
        test_two_hexahedra();
        test_cells_add_up();
        test_faults_are_found();
    }
    tc_context_destroy(reference);
    return EXPECT_DONE();
}
