/*
 * test_cells.c - method hybrid on cells of all types, against what signs, faces and the tetrahedra's surface call for
 *
 * Blocks of mixed cells under random point numbers, whole and with cells collapsed to simpler ones, and prisms; noise,
 * few values with many ties, and spheres. The mesh is an oriented manifold. It has one vertex for each crossed edge,
 * which is one of the tetrahedra's; its border has the sides in faces that one cell has, and no others, so that there
 * are no cracks between neighbours. Its Euler characteristic is that of the tetrahedra's surface, after every piece of
 * that in a cell has been replaced by a disc for each of its border curves.
 *
 * Usage: test_cells [SEED [COUNT]]. A failure names its seed.
 */
#include "cut.h"
#include "engines.h"
#include "random.h"
#include "topology.h"

#include <inttypes.h>
#include <math.h>

enum { EDGES = 26, FACES = 14, CORNERS = 12 };

static tc_context *reference;
static tc_mesh *meshes[2]; /* tetra, hybrid */

static void *memory_get(uint64_t bytes) {
    void *memory = calloc(bytes + 1, 1);
    if (!memory) exit(EXIT_FAILURE);
    return memory;
}

/* --------------------------------------------------------------------------------------------- faces of VTK's cells */

/* By VTK's own pictures; a face ends at -1. */
typedef struct shape {
    int type, corners;
    int faces[8][7];
} shape;

static const shape shapes[] = {
    {10, 4, {{0, 1, 2, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {0, 2, 3, -1}}},
    {11,
     8,
     {{0, 1, 3, 2, -1}, {4, 5, 7, 6, -1}, {0, 1, 5, 4, -1}, {2, 3, 7, 6, -1}, {0, 2, 6, 4, -1}, {1, 3, 7, 5, -1}}},
    {12,
     8,
     {{0, 1, 2, 3, -1}, {4, 5, 6, 7, -1}, {0, 1, 5, 4, -1}, {1, 2, 6, 5, -1}, {2, 3, 7, 6, -1}, {3, 0, 4, 7, -1}}},
    {13, 6, {{0, 1, 2, -1}, {3, 4, 5, -1}, {0, 1, 4, 3, -1}, {1, 2, 5, 4, -1}, {2, 0, 3, 5, -1}}},
    {14, 5, {{0, 1, 2, 3, -1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}},
    {15,
     10,
     {{0, 1, 2, 3, 4, -1},
      {5, 6, 7, 8, 9, -1},
      {0, 1, 6, 5, -1},
      {1, 2, 7, 6, -1},
      {2, 3, 8, 7, -1},
      {3, 4, 9, 8, -1},
      {4, 0, 5, 9, -1}}},
    {16,
     12,
     {{0, 1, 2, 3, 4, 5, -1},
      {6, 7, 8, 9, 10, 11, -1},
      {0, 1, 7, 6, -1},
      {1, 2, 8, 7, -1},
      {2, 3, 9, 8, -1},
      {3, 4, 10, 9, -1},
      {4, 5, 11, 10, -1},
      {5, 0, 6, 11, -1}}},
};

static const shape *shape_of(int type) {
    for (size_t n = 0; n < sizeof shapes / sizeof *shapes; n++)
        if (shapes[n].type == type) return &shapes[n];
    return NULL;
}

/* The points of a face, those that stand twice once; from the smallest on. */
static int face_points(const int64_t *points, const int *corners, uint32_t out[6]) {
    uint32_t all[6];
    int count = 0, first = 0;
    for (; *corners >= 0; corners++) {
        const uint32_t point = (uint32_t)points[*corners];
        if (!count || all[count - 1] != point) all[count++] = point;
    }
    while (count > 1 && all[count - 1] == all[0]) count--;
    for (int n = 1; n < count; n++)
        if (all[n] < all[first]) first = n;
    for (int n = 0; n < count; n++) out[n] = all[(first + n) % count];
    return count;
}

/* ------------------------------------------------------------------------------------------------- what is expected */

typedef struct subject {
    const cell_list *list;
    const tc_tetrahedra *complex;
    const float *values;
    double isovalue;
} subject;

static bool is_inside(const subject *s, uint32_t point) { return s->values[point] >= s->isovalue; }

typedef struct wanted {
    uint64_t vertices, border_edges, active_cells;
} wanted;

typedef struct face_key {
    uint32_t points[6]; /* rising */
    uint32_t sides;
} face_key;

static int number_order(const void *a, const void *b) {
    const uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
    return (p > q) - (p < q);
}

static int edge_order(const void *a, const void *b) {
    const uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
    return (p > q) - (p < q);
}

static int key_order(const void *a, const void *b) { return memcmp(a, b, sizeof((face_key *)0)->points); }

static uint64_t edge_of(uint32_t a, uint32_t b) { return (uint64_t)(a < b ? a : b) << 32 | (a < b ? b : a); }

/* Edges, each once, and faces as they are when all edges are known: a quadrilateral whose diagonal is an edge, and a
 * face of more corners, is a fan of triangles. */
typedef struct parts {
    uint64_t *edges, edge_count;
    face_key *faces;
    uint64_t face_count;
} parts;

static void edges_note(const uint32_t *p, int count, parts *all) {
    for (int n = 0; n < count && count > 2; n++) all->edges[all->edge_count++] = edge_of(p[n], p[(n + 1) % count]);
    for (int n = 2; n + 1 < count && count > 4; n++) all->edges[all->edge_count++] = edge_of(p[0], p[n]);
}

static void face_note(const subject *s, const uint32_t *p, int count, parts *all) {
    const uint64_t diagonal = count == 4 ? edge_of(p[0], p[2]) : 0;
    if (count > 4 || (count == 4 && bsearch(&diagonal, all->edges, all->edge_count, 8, edge_order))) {
        for (int n = 1; n + 1 < count; n++) face_note(s, (uint32_t[3]){p[0], p[n], p[n + 1]}, 3, all);
        return;
    }
    face_key *key = &all->faces[all->face_count];
    for (int n = 0; n < 6; n++) key->points[n] = n < count ? p[n] : UINT32_MAX;
    key->sides = 0;
    for (int n = 0; n < count; n++) key->sides += is_inside(s, p[n]) != is_inside(s, p[(n + 1) % count]);
    key->sides /= 2;
    qsort(key->points, 6, 4, number_order);
    all->face_count += count > 2;
}

static void cells_walk(const subject *s, bool faces, parts *all) {
    const cell_list *list = s->list;
    for (uint64_t c = 0; c < list->cell_count; c++)
        for (int f = 0; f < 8; f++) {
            const int *corners = shape_of(list->types[c])->faces[f];
            uint32_t points[6];
            if (corners[0] == corners[1]) break; /* no more faces */
            const int count = face_points(list->connectivity + list->offsets[c], corners, points);
            if (faces)
                face_note(s, points, count, all);
            else
                edges_note(points, count, all);
        }
}

static uint64_t active_count(const subject *s) {
    uint64_t sum = 0;
    for (uint64_t c = 0; c < s->list->cell_count; c++) {
        const int64_t *points = s->list->connectivity + s->list->offsets[c];
        const int corners = shape_of(s->list->types[c])->corners;
        int inside = 0;
        for (int n = 0; n < corners; n++) inside += is_inside(s, (uint32_t)points[n]);
        sum += inside > 0 && inside < corners;
    }
    return sum;
}

static wanted wanted_of(const subject *s) {
    parts all = {.edges = memory_get(8 * 72 * s->list->cell_count),
                 .faces = memory_get(20 * s->list->cell_count * sizeof *all.faces)};
    wanted w = {.active_cells = active_count(s)};
    uint64_t kept = 0;
    cells_walk(s, false, &all);
    qsort(all.edges, all.edge_count, 8, edge_order);
    for (uint64_t n = 0; n < all.edge_count; n++)
        if (!n || all.edges[n] != all.edges[n - 1]) all.edges[kept++] = all.edges[n];
    all.edge_count = kept;
    for (uint64_t n = 0; n < kept; n++)
        w.vertices += is_inside(s, (uint32_t)(all.edges[n] >> 32)) != is_inside(s, (uint32_t)all.edges[n]);
    cells_walk(s, true, &all);
    const face_key *f = all.faces;
    qsort(all.faces, all.face_count, sizeof *f, key_order);
    for (uint64_t n = 0; n < all.face_count; n++)
        if ((!n || key_order(&f[n], &f[n - 1])) && (n + 1 == all.face_count || key_order(&f[n], &f[n + 1])))
            w.border_edges += f[n].sides;
    free(all.edges);
    free(all.faces);
    return w;
}

/* --------------------------------------------------------------------------------------- pieces of the tetrahedra's */

static uint32_t root_of(uint32_t *parent, uint32_t n) {
    while (parent[n] != n) n = parent[n] = parent[parent[n]];
    return n;
}

/* Border curves of a piece, less its Euler characteristic. */
static int64_t piece_defect(const uint32_t *triangles, uint64_t count) {
    enum { MOST = 72 };
    uint32_t vertices[3 * MOST], parent[3 * MOST], vertex_count = 0;
    uint64_t sides[3 * MOST], edge_count = 0;
    bool at_border[3 * MOST] = {false};
    int64_t curves = 0;
    if (count > MOST) exit(EXIT_FAILURE);
    for (uint64_t n = 0; n < 3 * count; n++) {
        uint32_t at[2];
        for (int end = 0; end < 2; end++) {
            const uint32_t v = triangles[end ? (n % 3 == 2 ? n - 2 : n + 1) : n];
            for (at[end] = 0; at[end] < vertex_count && vertices[at[end]] != v;) at[end]++;
            if (at[end] == vertex_count) parent[vertex_count] = vertex_count, vertices[vertex_count++] = v;
        }
        sides[n] = (uint64_t)(at[0] < at[1] ? at[0] : at[1]) << 32 | (at[0] < at[1] ? at[1] : at[0]);
    }
    qsort(sides, 3 * count, 8, edge_order);
    for (uint64_t n = 0; n < 3 * count; n++) {
        if (n && sides[n] == sides[n - 1]) continue;
        edge_count++;
        if (n + 1 < 3 * count && sides[n] == sides[n + 1]) continue;
        const uint32_t a = (uint32_t)(sides[n] >> 32), b = (uint32_t)sides[n];
        at_border[a] = at_border[b] = true;
        parent[root_of(parent, a)] = root_of(parent, b);
    }
    for (uint32_t v = 0; v < vertex_count; v++) curves += at_border[v] && root_of(parent, v) == v;
    return curves - ((int64_t)vertex_count - (int64_t)edge_count + (int64_t)count);
}

/* What the Euler characteristic grows by, as pieces give way to discs. */
static int64_t defect_of(const subject *s, const tc_mesh_data *tetra) {
    const tc_tetrahedra *c = s->complex;
    uint64_t triangle = 0;
    int64_t sum = 0;
    for (uint64_t n = 0; n < c->tetrahedron_count;) {
        const uint32_t cell = c->cells[n];
        const uint64_t first = triangle;
        for (; n < c->tetrahedron_count && c->cells[n] == cell; n++) {
            int inside = 0;
            for (int v = 0; v < 4; v++) inside += is_inside(s, c->tetrahedra[4 * n + (unsigned)v]);
            triangle += inside == 2 ? 2u : (unsigned)inside % 2;
        }
        if (triangle > first) sum += piece_defect(tetra->triangles + 3 * first, triangle - first);
    }
    return triangle == tetra->triangle_count ? sum : INT64_MAX / 2;
}

/* ----------------------------------------------------------------------------------------------------------- checks */

typedef struct place {
    float p[3];
} place;

static int place_order(const void *a, const void *b) { return memcmp(a, b, sizeof(place)); }

static place *places_sorted(const tc_mesh_data *mesh) {
    place *places = memory_get(mesh->vertex_count * sizeof *places);
    if (mesh->vertex_count) memcpy(places, mesh->positions, mesh->vertex_count * sizeof *places);
    qsort(places, mesh->vertex_count, sizeof *places, place_order);
    return places;
}

static bool places_contained(const tc_mesh_data *all, const tc_mesh_data *some) {
    place *a = places_sorted(all), *s = places_sorted(some);
    uint64_t n = 0, m = 0;
    for (; n < all->vertex_count && m < some->vertex_count; n++) m += !place_order(&a[n], &s[m]);
    free(a);
    free(s);
    return m == some->vertex_count;
}

static const char *cells_fault(const subject *s, const tc_mesh_data *tetra, const tc_mesh_data *hybrid) {
    const wanted w = wanted_of(s);
    topology t, h;
    topology_of(tetra->positions, tetra->vertex_count, tetra->triangles, tetra->triangle_count, &t);
    topology_of(hybrid->positions, hybrid->vertex_count, hybrid->triangles, hybrid->triangle_count, &h);
    if (hybrid->active_cell_count != w.active_cells) return "active cells differ in number";
    if (hybrid->vertex_count != w.vertices) return "there are more or fewer vertices than crossed edges";
    if (h.bad_triangles || h.orphans) return "a triangle names no vertex, or one twice, or a vertex has no triangle";
    if (h.bad_edges) return "an edge has more than two triangles, or two in one direction";
    if (h.fans != hybrid->vertex_count) return "a vertex has several fans";
    if (h.boundary_edges != w.border_edges) return "the border is not that of the grid: there is a crack";
    if (h.euler_characteristic != t.euler_characteristic + defect_of(s, tetra)) return "Euler characteristics differ";
    if (!places_contained(tetra, hybrid)) return "a vertex is not among those of the tetrahedra";
    if (!t.boundary_edges && t.volume > 30 && fabs(h.volume - t.volume) > 0.05 * t.volume) return "volumes differ";
    return NULL;
}

static bool mesh_extract(const subject *s, const tc_cells *cells, tc_method method, tc_mesh **mesh,
                         tc_mesh_data *data) {
    tc_tetrahedra_grid_options o;
    tc_extract_options how;
    tc_grid *grid = NULL;
    tc_tetrahedra_grid_options_init(&o);
    tc_extract_options_init(&how);
    o.point_count = s->list->point_count, o.points = s->list->points;
    o.type = TC_F32, o.samples = s->values;
    o.tetrahedron_count = s->complex->tetrahedron_count, o.tetrahedra = s->complex->tetrahedra;
    o.source = cells, o.cells = s->complex->cells;
    how.isovalue = s->isovalue, how.method = method;
    *data = (tc_mesh_data){.struct_size = sizeof *data};
    tc_counts counts = {.struct_size = sizeof counts};
    tc_status status = tc_tetrahedra_grid_create(reference, &o, &grid);
    if (!status) status = tc_count(grid, &how, &counts);
    if (!status) status = tc_extract(grid, &how, mesh);
    if (!status) status = tc_mesh_get(*mesh, data);
    tc_grid_destroy(grid);
    EXPECT(!status, "extraction fails with status %d: %s", (int)status, tc_message());
    EXPECT(status || (counts.vertex_count == data->vertex_count && counts.triangle_count == data->triangle_count &&
                      counts.active_cell_count == data->active_cell_count),
           "what is counted is not what is extracted");
    return !status;
}

/* ------------------------------------------------------------------------------------------------------------ grids */

static void values_choose(const cell_list *list, float *values, int kind) {
    float middle[3] = {0, 0, 0};
    for (uint64_t n = 0; n < 3 * list->point_count; n++) middle[n % 3] += list->points[n] / (float)list->point_count;
    for (uint64_t n = 0; n < list->point_count; n++) {
        double square = 0;
        for (unsigned a = 0; a < 3; a++) square += pow((double)list->points[3 * n + a] - (double)middle[a], 2);
        values[n] = kind == 0 ? (float)random_between(-1, 1) : kind == 1 ? (float)random_below(3) - 1 : 0;
        if (kind == 2) values[n] = (float)(0.8 * middle[0] - sqrt(square));
    }
}

static void grid_check(cell_list *list, int kind, bool complete, const char *name) {
    float *values = memory_get(4 * list->point_count);
    values_choose(list, values, kind);
    tc_cells cells = cell_list_view(list);
    tc_tetrahedra complex = cut(&cells, name);
    const subject s = {list, &complex, values, 0};
    tc_mesh_data tetra, hybrid;
    if (mesh_extract(&s, &cells, TC_METHOD_TETRA, &meshes[0], &tetra) &&
        mesh_extract(&s, &cells, TC_METHOD_HYBRID, &meshes[1], &hybrid)) {
        const char *fault = cells_fault(&s, &tetra, &hybrid);
        if (fault && !complete && strstr(fault, "several fans")) fault = NULL; /* cells meet in edges and points */
        EXPECT(!fault, "%s: %s", name, fault);
    }
    tc_tetrahedra_release(&complex);
    free(values);
}

static void run(uint64_t seed) {
    char name[120];
    random_state = seed * 0x2545f4914f6cdd1du;
    const uint32_t size = 1 + random_below(5);
    const int kind = (int)random_below(3);
    const bool prisms = random_below(4) == 0, collapsed = !prisms && random_below(3) == 0;
    const uint64_t block_seed = random_u64();
    cell_list list = prisms ? honeycomb_make(size, block_seed) : mixed_block_make(size, block_seed);
    if (prisms) cell_list_drop_polyhedra(&list);
    if (collapsed) cell_list_collapse(&list);
    snprintf(name, sizeof name, "seed %" PRIu64 ": %s of %u, kind %d%s", seed, prisms ? "prisms" : "mixed block", size,
             kind, collapsed ? ", collapsed" : "");
    grid_check(&list, kind, !prisms, name);
    cell_list_free(&list);
}

/* All patterns of two hexahedra with a face in common, under random numbers. */
static void test_two_hexahedra(void) {
    for (unsigned pattern = 0; pattern < 4096; pattern++) {
        cell_list list = hexahedra_make((uint32_t[3]){1, 1, 2}, true);
        float values[12];
        char name[60];
        for (int n = 0; n < 12; n++) values[n] = (float)(pattern >> n & 1) - 0.5f;
        tc_cells cells = cell_list_view(&list);
        tc_tetrahedra complex = cut(&cells, "two hexahedra");
        const subject s = {&list, &complex, values, 0};
        tc_mesh_data tetra, hybrid;
        snprintf(name, sizeof name, "two hexahedra, pattern %03x", pattern);
        if (mesh_extract(&s, &cells, TC_METHOD_TETRA, &meshes[0], &tetra) &&
            mesh_extract(&s, &cells, TC_METHOD_HYBRID, &meshes[1], &hybrid)) {
            const char *fault = cells_fault(&s, &tetra, &hybrid);
            EXPECT(!fault, "%s: %s", name, fault);
        }
        tc_tetrahedra_release(&complex);
        cell_list_free(&list);
    }
}

/* Cells with a missing sample are left out, as if they were blanked. */
static void test_missing(uint64_t seed) {
    cell_list list = mixed_block_make(4, seed);
    float *values = memory_get(4 * list.point_count);
    uint8_t *blanked = memory_get(list.point_count);
    tc_cells cells = cell_list_view(&list);
    values_choose(&list, values, 0);
    tc_tetrahedra complex = cut(&cells, "missing samples"), others;
    cells.blanked_points = blanked;
    for (uint64_t n = 0; n < list.point_count; n++) blanked[n] = random_below(12) == 0;
    others = cut(&cells, "blanked points");
    subject s = {&list, &others, values, 0};
    tc_mesh_data by_blanking, by_nan;
    bool made = mesh_extract(&s, &cells, TC_METHOD_HYBRID, &meshes[0], &by_blanking);
    for (uint64_t n = 0; n < list.point_count; n++)
        if (blanked[n]) values[n] = random_below(2) ? NAN : INFINITY;
    s.complex = &complex;
    if (made && mesh_extract(&s, &cells, TC_METHOD_HYBRID, &meshes[1], &by_nan)) {
        const char *difference = mesh_difference(&by_blanking, &by_nan);
        EXPECT(!difference && by_nan.triangle_count, "missing samples and blanked points: %s", difference);
    }
    tc_tetrahedra_release(&complex);
    tc_tetrahedra_release(&others);
    free(values);
    free(blanked);
    cell_list_free(&list);
}

/* ---------------------------------------------------------------------------------------------- faults and refusals */

/* What all grids are checked with finds a corner moved, and a triangle less. */
static void test_faults_are_found(void) {
    cell_list list = mixed_block_make(3, 5);
    float *values = memory_get(4 * list.point_count);
    values_choose(&list, values, 0);
    tc_cells cells = cell_list_view(&list);
    tc_tetrahedra complex = cut(&cells, "faults");
    const subject s = {&list, &complex, values, 0};
    tc_mesh_data tetra, hybrid;
    if (mesh_extract(&s, &cells, TC_METHOD_TETRA, &meshes[0], &tetra) &&
        mesh_extract(&s, &cells, TC_METHOD_HYBRID, &meshes[1], &hybrid)) {
        const size_t count = 3 * (size_t)hybrid.triangle_count;
        uint32_t *triangles = memory_get(4 * count);
        memcpy(triangles, hybrid.triangles, 4 * count);
        hybrid.triangles = triangles;
        for (int n = 0; n < 100; n++) {
            uint32_t *corner = triangles + random_below((uint32_t)count), old = *corner;
            *corner = (old + 1 + random_below((uint32_t)hybrid.vertex_count - 1)) % (uint32_t)hybrid.vertex_count;
            EXPECT(cells_fault(&s, &tetra, &hybrid), "a corner moved from %u to %u is not found", old, *corner);
            *corner = old;
        }
        hybrid.triangle_count--;
        EXPECT(cells_fault(&s, &tetra, &hybrid), "a missing triangle is not found");
        free(triangles);
    }
    tc_tetrahedra_release(&complex);
    free(values);
    cell_list_free(&list);
}

static tc_status try_hybrid(tc_context *context, const tc_tetrahedra_grid_options *o) {
    tc_extract_options how;
    tc_counts counts = {.struct_size = sizeof counts};
    tc_grid *grid = NULL;
    tc_extract_options_init(&how);
    how.method = TC_METHOD_HYBRID;
    tc_status status = tc_tetrahedra_grid_create(context, o, &grid);
    if (!status) status = tc_count(grid, &how, &counts);
    tc_grid_destroy(grid);
    return status;
}

static void test_refusals(void) {
    cell_list list = mixed_block_make(2, 9), columns = honeycomb_make(4, 3);
    float *values = memory_get(4 * (list.point_count + columns.point_count));
    tc_cells cells = cell_list_view(&list), prisms = cell_list_view(&columns);
    tc_tetrahedra complex = cut(&cells, "refusals"), of_prisms = cut(&prisms, "prisms");
    tc_tetrahedra_grid_options o;
    tc_tetrahedra_grid_options_init(&o);
    values[0] = 1;
    o.point_count = list.point_count, o.points = list.points, o.type = TC_F32, o.samples = values;
    o.tetrahedron_count = complex.tetrahedron_count, o.tetrahedra = complex.tetrahedra;
    EXPECT_REFUSED(try_hybrid(reference, &o), TC_ERROR_ARGUMENT, "no cells");
    o.source = &cells;
    EXPECT_REFUSED(try_hybrid(reference, &o), TC_ERROR_ARGUMENT, "source alone");
    o.source = NULL, o.cells = complex.cells;
    EXPECT_REFUSED(try_hybrid(reference, &o), TC_ERROR_ARGUMENT, "cells alone");
    o.source = &cells;
    EXPECT(try_hybrid(reference, &o) == TC_OK, "cells: %s", tc_message());
    tc_cells changed = cells;
    changed.types = NULL, o.source = &changed;
    EXPECT_REFUSED(try_hybrid(reference, &o), TC_ERROR_ARGUMENT, "no types");
    changed = cells, changed.struct_size = 0;
    EXPECT_REFUSED(try_hybrid(reference, &o), TC_ERROR_ARGUMENT, "a struct without a size");
    changed = cells, changed.cell_count = 1;
    EXPECT_REFUSED(try_hybrid(reference, &o), TC_ERROR_DATA, "cells that are not there");
    o.source = &cells;
    for (uint64_t c = 0; c < list.cell_count; c++) {
        int64_t *point = list.connectivity + list.offsets[c], old = *point;
        *point = point[1];
        EXPECT_REFUSED(try_hybrid(reference, &o), TC_ERROR_DATA, "a corner that has changed");
        *point = (int64_t)list.point_count;
        EXPECT_REFUSED(try_hybrid(reference, &o), TC_ERROR_DATA, "a corner that is no point");
        *point = old;
    }
    uint32_t *numbers = memory_get(4 * complex.tetrahedron_count), last = (uint32_t)complex.tetrahedron_count - 1;
    memcpy(numbers, complex.cells, 4 * complex.tetrahedron_count);
    o.cells = numbers;
    for (uint32_t n = 0; n <= last; n += last) {
        const uint32_t others[2] = {UINT32_MAX, numbers[n] ? 0 : 1};
        for (int other = 0; other < 2; other++) {
            numbers[n] = others[other];
            EXPECT_REFUSED(try_hybrid(reference, &o), TC_ERROR_DATA, "a cell's number that has changed");
            numbers[n] = complex.cells[n];
        }
    }
    for (uint32_t n = 1; n <= last; n++) {
        if (numbers[n] != numbers[n - 1]) continue;
        numbers[n] = (numbers[n] + 1) % (uint32_t)list.cell_count;
        EXPECT_REFUSED(try_hybrid(reference, &o), TC_ERROR_DATA, "a tetrahedron in the middle that is another cell's");
        numbers[n] = complex.cells[n];
    }
    free(numbers);
    o.point_count = columns.point_count, o.points = columns.points;
    o.tetrahedron_count = of_prisms.tetrahedron_count, o.tetrahedra = of_prisms.tetrahedra;
    o.source = &prisms, o.cells = of_prisms.cells;
    EXPECT_REFUSED(try_hybrid(reference, &o), TC_ERROR_DATA, "polyhedra");
    EXPECT(strstr(tc_message(), "polyhedron") && strstr(tc_message(), "tetra"), "%s", tc_message());
    tc_tetrahedra_release(&complex);
    tc_tetrahedra_release(&of_prisms);
    free(values);
    cell_list_free(&list);
    cell_list_free(&columns);
}

int main(int argument_count, char **arguments) {
    const uint64_t seed = argument_count > 1 ? strtoull(arguments[1], NULL, 10) : 1;
    const uint64_t count = argument_count > 2 ? strtoull(arguments[2], NULL, 10) : 2000;
    reference = reference_open();
    for (uint64_t n = 0; n < count; n++) run(seed + n);
    if (argument_count <= 1) {
        test_two_hexahedra();
        for (uint64_t n = 1; n < 20; n++) test_missing(n);
        test_faults_are_found();
        test_refusals();
    }
    for (int n = 0; n < 2; n++) tc_mesh_destroy(meshes[n]);
    tc_context_destroy(reference);
    return EXPECT_DONE();
}
