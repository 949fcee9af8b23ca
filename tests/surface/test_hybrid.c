/*
 * test_hybrid.c - the hybrid method's surface against that of the tetrahedra, of the same grid
 *
 * All 256 patterns as a cube of its own and with samples around it; thousands of random grids, with ties and missing
 * samples: the mesh is a manifold whose border lies on the grid's border, it has the Euler characteristic and the
 * components of the other, and its vertices are those of the other that lie on edges of cubes, in the same order.
 * Device and reference are compared byte for byte over types and sizes around words and bricks. test_device does so
 * over ways to cut the work.
 *
 * Usage: test_hybrid [SEED [COUNT]]. A failure names the seed of its grid: `test_hybrid SEED 1` repeats it.
 */
#include "engines.h"
#include "mesh_check.h"
#include "random.h"
#include "random_field.h"
#include "samples.h"

#include <inttypes.h>
#include <math.h>

enum { SAMPLES_MAX = 30000 };

static tc_context *reference, *device; /* device: NULL where there is none */
static tc_mesh *meshes[3];             /* tetrahedra's; hybrid, by the reference; by the device */
static double memory[SAMPLES_MAX];     /* aligned for every type */

/* ------------------------------------------------------------------------------------------------------- comparison */

/* A side of a triangle: its vertices, the lower one first, and which way it is passed. */
typedef struct side {
    uint32_t low, high, falls;
} side;

static int side_order(const void *a, const void *b) {
    const side *p = a, *q = b;
    if (p->low != q->low) return p->low < q->low ? -1 : 1;
    return p->high < q->high ? -1 : p->high > q->high;
}

static bool on_border(const tc_grid_options *grid, const tc_mesh_data *mesh, const side *s) {
    for (unsigned axis = 0; axis < 3; axis++) {
        float p = mesh->positions[3 * s->low + axis], q = mesh->positions[3 * s->high + axis];
        if (p == q && (p == 0 || p == (float)(grid->dims[axis] - 1))) return true;
    }
    return false;
}

/* Every edge has two triangles that pass it in opposite directions, or one, on the border of a complete grid. */
static const char *sides_fault(const tc_grid_options *grid, const tc_mesh_data *mesh, bool complete) {
    const size_t count = 3 * (size_t)mesh->triangle_count;
    const char *fault = NULL;
    side *sides = malloc((count + 1) * sizeof *sides);
    if (!sides) exit(EXIT_FAILURE);
    for (size_t n = 0; n < count; n++) {
        uint32_t from = mesh->triangles[n], to = mesh->triangles[n % 3 == 2 ? n - 2 : n + 1];
        sides[n] = from < to ? (side){from, to, 0} : (side){to, from, 1};
    }
    qsort(sides, count, sizeof *sides, side_order);
    for (size_t n = 0, end; n < count && !fault; n = end) {
        for (end = n + 1; end < count && !side_order(&sides[n], &sides[end]);) end++;
        if (end - n > 2) fault = "an edge has more than two triangles";
        if (end - n == 2 && sides[n].falls == sides[n + 1].falls) fault = "two triangles pass an edge in one direction";
        if (end - n == 1 && complete && !on_border(grid, mesh, &sides[n])) fault = "there is a crack inside the grid";
    }
    free(sides);
    return fault;
}

static const char *topology_fault(const tc_mesh_data *tetra, const tc_mesh_data *hybrid, bool complete) {
    mesh_topology t, h;
    if (mesh_check(tetra->positions, tetra->vertex_count, tetra->triangles, tetra->triangle_count, &t) ||
        mesh_check(hybrid->positions, hybrid->vertex_count, hybrid->triangles, hybrid->triangle_count, &h))
        exit(EXIT_FAILURE);
    if (h.invalid_triangles) return "a triangle names no vertex, or one twice";
    if (h.orphan_vertices) return "a vertex has no triangle";
    if (h.nonmanifold_edges || h.misoriented_edges) return "the mesh is no oriented surface";
    if (complete && h.nonmanifold_vertices) return "a vertex of a complete grid has several fans";
    if (h.nonmanifold_vertices != t.nonmanifold_vertices) return "vertices with several fans differ in number";
    if (h.components != t.components) return "components differ in number";
    if (h.euler_characteristic != t.euler_characteristic) return "Euler characteristics differ";
    return NULL;
}

/* Vertices on edges of cubes have two whole coordinates; those on diagonals may, too. */
static const char *vertices_fault(const tc_mesh_data *tetra, const tc_mesh_data *hybrid) {
    uint64_t found = 0;
    for (uint64_t n = 0; n < tetra->vertex_count && found < hybrid->vertex_count; n++) {
        if (memcmp(tetra->positions + 3 * n, hybrid->positions + 3 * found, 3 * sizeof(float))) continue;
        if (tetra->normals && memcmp(tetra->normals + 3 * n, hybrid->normals + 3 * found, 3 * sizeof(float))) continue;
        found++;
    }
    if (found < hybrid->vertex_count) return "a vertex is not among those of the tetrahedra";
    for (uint64_t n = 0; n < hybrid->vertex_count; n++) {
        int whole = 0;
        for (int axis = 0; axis < 3; axis++) {
            float p = hybrid->positions[3 * n + (uint64_t)axis];
            whole += p == floorf(p);
        }
        if (whole < 2) return "a vertex is on no edge of a cube";
    }
    return NULL;
}

static const char *hybrid_fault(const tc_grid_options *grid, const tc_mesh_data *tetra, const tc_mesh_data *hybrid,
                                bool complete) {
    if (tetra->active_cell_count != hybrid->active_cell_count) return "numbers of active cells differ";
    if (!tetra->triangle_count != !hybrid->triangle_count) return "one has a surface, the other has none";
    const char *fault = sides_fault(grid, hybrid, complete);
    if (!fault) fault = topology_fault(tetra, hybrid, complete);
    return fault ? fault : vertices_fault(tetra, hybrid);
}

/* Extracts by both methods and both engines; name is of the grid. */
static void expect_hybrid(const tc_grid_options *grid, const tc_extract_options *options, bool complete,
                          const char *name) {
    tc_extract_options how = *options;
    tc_mesh_data tetra, hybrid, other;
    how.method = TC_METHOD_TETRA;
    if (!extract(reference, grid, &how, &meshes[0], &tetra)) return;
    how.method = TC_METHOD_HYBRID;
    if (!extract(reference, grid, &how, &meshes[1], &hybrid)) return;
    const char *fault = hybrid_fault(grid, &tetra, &hybrid, complete);
    EXPECT(!fault, "%s: %s", name, fault);
    if (!device || !test_chosen(name) || !extract(device, grid, &how, &meshes[2], &other)) return;
    const char *difference = mesh_difference(&hybrid, &other);
    EXPECT(!difference, "%s: device and reference: %s", name, difference);
}

/* --------------------------------------------------------------------------------------------------------- patterns */

static void grid_begin(tc_grid_options *grid, tc_extract_options *how, int64_t nx, int64_t ny, int64_t nz,
                       tc_type type) {
    tc_grid_options_init(grid);
    tc_extract_options_init(how);
    grid->dims[0] = nx, grid->dims[1] = ny, grid->dims[2] = nz;
    grid->type = type;
    grid->samples = memory;
}

/* A pattern in the middle of `size` samples along each axis, all others outside; parity by where the grid begins. */
static void test_patterns(int64_t size) {
    for (unsigned n = 0; n < 512; n++) {
        tc_grid_options grid;
        tc_extract_options how;
        char name[80];
        int64_t middle = (size - 2) / 2;
        grid_begin(&grid, &how, size, size, size, TC_F32);
        how.isovalue = 0;
        for (int64_t m = 0; m < size * size * size; m++) sample_set(memory, TC_F32, m, -random_between(0.1, 1));
        for (unsigned c = 0; c < 8; c++) {
            int64_t x = middle + (c & 1), y = middle + (c >> 1 & 1), z = middle + (c >> 2);
            if (n >> c & 1) sample_set(memory, TC_F32, (z * size + y) * size + x, random_between(0.1, 1));
        }
        /* positions are compared in the grid's own space, whatever its first index */
        grid.first_index[0] = n / 256;
        grid.matrix[0][3] = -(double)grid.first_index[0];
        snprintf(name, sizeof name, "pattern %02x, parity %u, %d samples", n % 256, n / 256, (int)size);
        expect_hybrid(&grid, &how, true, name);
    }
}

/* ----------------------------------------------------------------------------------------------------- random grids */

static void samples_choose(tc_grid_options *grid, int kind) {
    double wave[4];
    int64_t n = 0;
    wave_choose(wave);
    for (int64_t z = 0; z < grid->dims[2]; z++)
        for (int64_t y = 0; y < grid->dims[1]; y++)
            for (int64_t x = 0; x < grid->dims[0]; x++)
                sample_set(memory, grid->type, n++, field_value(kind, wave, (double)x, (double)y, (double)z));
}

/* Takes some samples away; false where none is. */
static bool samples_remove(tc_grid_options *grid) {
    int64_t count = grid->dims[0] * grid->dims[1] * grid->dims[2];
    uint32_t rarity = 2 + random_below(40);
    if (random_below(2)) return false;
    grid->has_nodata = 1;
    grid->nodata = 3;
    for (int64_t n = 0; n < count; n++)
        if (random_below(rarity) == 0) sample_set(memory, grid->type, n, 3);
    return true;
}

static void run(uint64_t seed, bool large) {
    static const int64_t xs[] = {2, 3, 63, 64, 65, 66, 127, 128, 129, 130}, ys[] = {2, 3, 7, 8, 9, 10, 16, 17};
    static const int64_t zs[] = {2, 3, 4, 5, 8, 9, 13};
    static const tc_type types[] = {TC_U8, TC_I16, TC_U32, TC_F32, TC_F64}; /* one of each width, and a signed one */
    tc_grid_options grid;
    tc_extract_options how;
    char name[160];
    random_state = seed * 0x2545f4914f6cdd1du + large;
    tc_type type = types[random_below(5)];
    if (large)
        grid_begin(&grid, &how, xs[random_below(10)], ys[random_below(8)], zs[random_below(7)], type);
    else
        grid_begin(&grid, &how, 2 + random_below(6), 2 + random_below(6), 2 + random_below(6), TC_F32);
    int kind = (int)random_below(RANDOM_FIELDS);
    samples_choose(&grid, kind);
    how.isovalue = kind == TIES ? 58 + 0.5 * random_below(8) : 60 + random_between(-20, 20);
    /* combinations of type, missing samples and normals that are built anyway */
    bool complete = (grid.type != TC_U8 && !type_is_floating(grid.type)) || !samples_remove(&grid);
    how.normals = large && type_is_floating(type) && !complete;
    snprintf(name, sizeof name, "seed %" PRIu64 ": %lldx%lldx%lld %s, isovalue %.17g, %s", seed,
             (long long)grid.dims[0], (long long)grid.dims[1], (long long)grid.dims[2], tc_type_name(grid.type),
             how.isovalue, complete ? "complete" : "with missing samples");
    expect_hybrid(&grid, &how, complete, name);
}

/* ------------------------------------------------------------------------------------------------------ smooth data */

/* A curvilinear grid with cells left out: bytes of both engines, and topology. */
static void test_curvilinear(void) {
    enum { NX = 70, NY = 12, NZ = 9, CELLS = (NX - 1) * (NY - 1) * (NZ - 1) };
    static float points[NX * NY * NZ][3];
    static uint8_t blanked[CELLS];
    tc_grid_options grid;
    tc_extract_options how;
    tc_mesh_data tetra, hybrid, other;
    random_state = 4;
    grid_begin(&grid, &how, NX, NY, NZ, TC_F32);
    samples_choose(&grid, SMOOTH);
    how.isovalue = 60;
    for (int n = 0; n < NX * NY * NZ; n++) {
        double x = n % NX, y = n / NX % NY, z = n / NX / NY;
        points[n][0] = (float)((2 + 0.1 * x) * cos(0.1 * y));
        points[n][1] = (float)((2 + 0.1 * x) * sin(0.1 * y));
        points[n][2] = (float)(z + 0.3 * sin(0.2 * x));
    }
    grid.points = points[0];
    for (int n = 0; n < CELLS; n++) blanked[n] = random_below(20) == 0;
    grid.blanked_cells = blanked;
    if (!extract(reference, &grid, &how, &meshes[0], &tetra)) return;
    how.method = TC_METHOD_HYBRID;
    if (!extract(reference, &grid, &how, &meshes[1], &hybrid)) return;
    const char *fault = topology_fault(&tetra, &hybrid, false);
    EXPECT(!fault && hybrid.triangle_count > 500, "curvilinear: %s", fault);
    if (!device || !extract(device, &grid, &how, &meshes[2], &other)) return;
    const char *difference = mesh_difference(&hybrid, &other);
    EXPECT(!difference, "curvilinear: device and reference: %s", difference);
}

/* The hybrid method saves triangles: of the gyroid the tetrahedra make about 2.4 times as many. */
static void test_fewer_triangles(void) {
    enum { N = 30 };
    tc_grid_options grid;
    tc_extract_options how;
    tc_mesh_data tetra, hybrid;
    const double step = 2 * 3.14159265358979323846 / (N - 1);
    grid_begin(&grid, &how, N, N, N, TC_F32);
    for (int64_t n = 0; n < N * N * N; n++) {
        double x = step * (double)(n % N), y = step * (double)(n / N % N), z = step * (double)(n / N / N);
        sample_set(memory, TC_F32, n, sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x));
    }
    how.isovalue = 0.05;
    expect_hybrid(&grid, &how, true, "gyroid");
    if (!extract(reference, &grid, &how, &meshes[0], &tetra)) return;
    how.method = TC_METHOD_HYBRID;
    if (!extract(reference, &grid, &how, &meshes[1], &hybrid)) return;
    double ratio = (double)tetra.triangle_count / (double)hybrid.triangle_count;
    EXPECT(ratio > 2.2 && ratio < 2.6, "the tetrahedra have %g times as many triangles", ratio);
}

/* A triangle less and a corner moved are found by what all grids are checked with. */
static void test_faults_are_found(void) {
    tc_grid_options grid;
    tc_extract_options how;
    tc_mesh_data tetra, hybrid;
    random_state = 7;
    grid_begin(&grid, &how, 12, 12, 12, TC_F32);
    samples_choose(&grid, NOISE);
    how.isovalue = 60;
    if (!extract(reference, &grid, &how, &meshes[0], &tetra)) return;
    how.method = TC_METHOD_HYBRID;
    if (!extract(reference, &grid, &how, &meshes[1], &hybrid)) return;
    const size_t count = 3 * (size_t)hybrid.triangle_count;
    uint32_t *triangles = malloc(count * sizeof *triangles);
    if (!triangles) exit(EXIT_FAILURE);
    memcpy(triangles, hybrid.triangles, count * sizeof *triangles);
    hybrid.triangles = triangles;
    EXPECT(!hybrid_fault(&grid, &tetra, &hybrid, true), "%s", hybrid_fault(&grid, &tetra, &hybrid, true));
    for (int n = 0; n < 200; n++) {
        uint32_t *corner = triangles + random_below((uint32_t)count), old = *corner;
        *corner = (old + 1 + random_below((uint32_t)hybrid.vertex_count - 1)) % (uint32_t)hybrid.vertex_count;
        EXPECT(hybrid_fault(&grid, &tetra, &hybrid, true), "a corner moved from %u to %u is not found", old, *corner);
        *corner = old;
    }
    hybrid.triangle_count--;
    EXPECT(hybrid_fault(&grid, &tetra, &hybrid, true), "a missing triangle is not found");
    free(triangles);
}

static void test_options(void) {
    tc_grid_options options;
    tc_extract_options how;
    tc_grid *grid = NULL;
    tc_counts counts = {.struct_size = sizeof counts};
    grid_begin(&options, &how, 2, 2, 2, TC_U8);
    EXPECT(tc_grid_create(reference, &options, &grid) == TC_OK, "no grid: %s", tc_message());
    how.method = (tc_method)100;
    EXPECT(tc_count(grid, &how, &counts) == TC_ERROR_ARGUMENT && strstr(tc_message(), "method"), "%s", tc_message());
    tc_grid_destroy(grid);
}

int main(int argc, char **argv) {
    uint64_t seed = argc > 1 ? strtoull(argv[1], NULL, 0) : 1996;
    uint64_t count = argc > 2 ? strtoull(argv[2], NULL, 0) : 150;
    tc_context_options options;
    tc_context_options_init(&options);
    reference = reference_open();
    if (device_exists()) device = context_open(&options);
    bool skipped = !device;
    random_state = 1996;
    for (int64_t size = 2; size <= 4; size += 2) test_patterns(size);
    for (uint64_t n = 0; n < 20 * count; n++) run(seed + n, false);
    for (uint64_t n = 0; n < count; n++) run(seed + n, true);
    test_curvilinear();
    test_fewer_triangles();
    test_faults_are_found();
    test_options();
    for (int n = 0; n < 3; n++) tc_mesh_destroy(meshes[n]);
    tc_context_destroy(reference);
    tc_context_destroy(device);
    int failed = EXPECT_DONE();
    return failed || !skipped ? failed : SKIPPED;
}
