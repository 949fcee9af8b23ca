/*
 * test_tetrahedralize.c - the converter: every order of point numbers in every type of cell, random complexes of all
 * types, collapsed and curved cells, structured grids, and what has to be refused
 */
#include "api.h"
#include "cut.h"
#include "random.h"

#include <float.h>
#include <string.h>

/* ------------------------------------------------------------------------------------------------- orders of points */

typedef struct shape {
    const char *name;
    int type, corner_count;
    double corners[8][3];
    double volume;  /* six times it */
    int tetrahedra; /* 0: of cubes, it depends */
    int faces;
} shape;

static const shape shapes[] = {
    {"tetrahedron", 10, 4, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 1, 1, 4},
    {"voxel",
     11,
     8,
     {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}},
     6,
     0,
     12},
    {"hexahedron",
     12,
     8,
     {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
     6,
     0,
     12},
    {"wedge", 13, 6, {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}}, 3, 3, 8},
    {"pyramid", 14, 5, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}}, 2, 2, 6},
};

/* The next permutation in lexicographic order; false after the last. */
static bool permute(uint32_t *p, int count) {
    int n = count - 2, m = count - 1;
    while (n >= 0 && p[n] > p[n + 1]) n--;
    if (n < 0) return false;
    while (p[m] < p[n]) m--;
    uint32_t swapped = p[n];
    p[n] = p[m], p[m] = swapped;
    for (int low = n + 1, high = count - 1; low < high; low++, high--)
        swapped = p[low], p[low] = p[high], p[high] = swapped;
    return true;
}

/* A diagonal from the smallest point of every quadrilateral: a face's four points span two triangles of the boundary,
 * both with the smallest one. */
static void expect_smallest_diagonals(const shape *s, const tc_tetrahedra *one, const uint32_t *numbers) {
    for (uint32_t n = 0; n < 4 * one->tetrahedron_count; n++) {
        uint32_t plane_points[3], smallest = UINT32_MAX;
        for (uint32_t v = 0, m = 0; v < 4; v++)
            if (v != n % 4) plane_points[m++] = one->tetrahedra[n / 4 * 4 + v];
        for (int axis = 0; axis < 3; axis++)
            for (int side = 0; side < 2; side++) {
                int in_plane = 0, face_points = 0;
                smallest = UINT32_MAX;
                for (int c = 0; c < s->corner_count; c++) {
                    if (s->corners[c][axis] != side) continue;
                    face_points++;
                    if (numbers[c] < smallest) smallest = numbers[c];
                    for (int m = 0; m < 3; m++) in_plane += plane_points[m] == numbers[c];
                }
                if (in_plane < 3 || face_points != 4) continue;
                EXPECT(plane_points[0] == smallest || plane_points[1] == smallest || plane_points[2] == smallest,
                       "%s: a diagonal that does not meet the smallest point of its face", s->name);
            }
    }
}

/* Corners of a cube are of two kinds, which alternate along its edges. A diagonal joins two of one kind; where all are
 * of one, they bound a tetrahedron in the middle, and the cube is cut into five. */
static int cube_tetrahedra(const shape *s, const uint32_t *numbers) {
    int odd_faces = 0;
    for (int face = 0; face < 6; face++) {
        uint32_t smallest = UINT32_MAX;
        bool odd = false;
        for (int c = 0; c < 8; c++) {
            const double *at = s->corners[c];
            if (at[face / 2] != face % 2 || numbers[c] > smallest) continue;
            smallest = numbers[c];
            odd = (int)(at[0] + at[1] + at[2]) % 2;
        }
        odd_faces += odd;
    }
    return odd_faces % 6 == 0 ? 5 : 6;
}

static void order_check(const shape *s, const uint32_t *numbers) {
    const uint64_t count = s->corner_count == 8 ? (uint64_t)cube_tetrahedra(s, numbers) : (uint64_t)s->tetrahedra;
    cell_list list = cell_list_make(8, 1);
    list.point_count = (uint64_t)s->corner_count;
    for (int c = 0; c < s->corner_count; c++)
        for (int axis = 0; axis < 3; axis++) list.points[3 * numbers[c] + (unsigned)axis] = (float)s->corners[c][axis];
    bool inverted = random_below(2);
    cell_list_add(&list, s->type, s->corner_count, numbers, inverted);
    tc_cells cells = cell_list_view(&list);
    tc_tetrahedra complex = cut(&cells, s->name);
    EXPECT(complex.tetrahedron_count == count, "%s: %llu tetrahedra, not %llu", s->name,
           (unsigned long long)complex.tetrahedron_count, (unsigned long long)count);
    EXPECT(complex.inverted_cell_count == inverted && complex.folded_cell_count == 0, "%s: orientation miscounted",
           s->name);
    EXPECT(complex.curved_cell_count + complex.flat_cell_count == 0, "%s: kinds miscounted", s->name);
    expect_conforming(&complex, &cells, (uint64_t)s->faces, s->volume, s->name);
    expect_smallest_diagonals(s, &complex, numbers);
    tc_tetrahedra_release(&complex);
    cell_list_free(&list);
}

static void all_orders(void) {
    for (size_t n = 0; n < sizeof shapes / sizeof *shapes; n++) {
        uint32_t numbers[8] = {0, 1, 2, 3, 4, 5, 6, 7};
        do order_check(&shapes[n], numbers);
        while (permute(numbers, shapes[n].corner_count));
    }
}

/* ------------------------------------------------------------------------------------------------------- complexes */

static void mixed_blocks(void) {
    for (int round = 0; round < 40; round++) {
        uint32_t size = 1 + random_below(7);
        if (round == 39) size = 24; /* several blocks of cells */
        char what[64];
        snprintf(what, sizeof what, "mixed block %d of size %u", round, size);
        cell_list list = mixed_block_make(size, random_u64());
        tc_cells cells = cell_list_view(&list);
        tc_tetrahedra complex = cut(&cells, what);
        expect_conforming(&complex, &cells, 12ull * size * size, 6.0 * size * size * size, what);
        EXPECT(complex.inverted_cell_count == list.inverted_count, "%s: %llu cells inverted, not %llu", what,
               (unsigned long long)complex.inverted_cell_count, (unsigned long long)list.inverted_count);
        EXPECT(complex.folded_cell_count == 0, "%s: folded cells", what);
        for (uint64_t n = 1; n < complex.tetrahedron_count; n++)
            EXPECT(complex.cells[n - 1] <= complex.cells[n] && complex.cells[n] <= complex.cells[n - 1] + 1,
                   "%s: tetrahedra not in the order of cells", what);
        tc_tetrahedra_release(&complex);
        cell_list_free(&list);
    }
}

/* A fan of hexahedra around an axis, where their edges are collapsed into it. */
static void collapsed(void) {
    enum { ROUND = 4, UP = 5 };
    cell_list list = cell_list_make(64, 64);
    static const double ring[ROUND][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    uint32_t axis[UP + 1], first[UP + 1];
    for (int k = 0; k <= UP; k++) {
        axis[k] = cell_list_point(&list, 0, 0, k);
        first[k] = cell_list_point(&list, ring[0][0], ring[0][1], k);
        for (int n = 1; n < ROUND; n++) cell_list_point(&list, ring[n][0], ring[n][1], k);
    }
    for (int k = 0; k < UP; k++)
        for (uint32_t n = 0; n < ROUND; n++) {
            uint32_t m = (n + 1) % ROUND;
            uint32_t h[8] = {axis[k],     first[k] + n,     first[k] + m,     axis[k],
                             axis[k + 1], first[k + 1] + n, first[k + 1] + m, axis[k + 1]};
            cell_list_add(&list, 12, 8, h, random_below(2));
        }
    tc_cells cells = cell_list_view(&list);
    tc_tetrahedra complex = cut(&cells, "collapsed hexahedra");
    expect_conforming(&complex, &cells, 2 * ROUND + 2 * ROUND * UP, 6.0 * 2 * UP, "collapsed hexahedra");
    EXPECT(complex.inverted_cell_count == list.inverted_count, "collapsed hexahedra: inverted ones miscounted");
    tc_tetrahedra_release(&complex);
    cell_list_free(&list);
}

/* One corner of a hexahedron pushed through to the other side. */
static void folded(void) {
    cell_list list = cell_list_make(8, 1);
    for (int c = 0; c < 8; c++)
        cell_list_point(&list, shapes[2].corners[c][0], shapes[2].corners[c][1], shapes[2].corners[c][2]);
    const uint32_t h[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    cell_list_add(&list, 12, 8, h, false);
    for (int axis = 0; axis < 3; axis++) list.points[3 * 6 + axis] = -0.2f;
    tc_cells cells = cell_list_view(&list);
    tc_tetrahedra complex = cut(&cells, "folded hexahedron");
    EXPECT(complex.folded_cell_count == 1, "a folded hexahedron is not counted");
    tc_tetrahedra_release(&complex);
    cell_list_free(&list);
}

static void curved_and_flat(void) {
    static const struct {
        int type, like, points; /* of Lagrange's and Bezier's any number, but for the corners */
    } curved[] = {{24, 10, 10}, {25, 12, 20}, {26, 13, 15}, {27, 14, 13}, {29, 12, 27}, {31, 13, 12}, {32, 13, 18},
                  {33, 12, 24}, {37, 14, 19}, {71, 10, 20}, {72, 12, 27}, {73, 13, 18}, {74, 14, 14}, {78, 10, 10},
                  {79, 12, 27}, {80, 13, 18}, {81, 14, 14}, {71, 10, 4},  {72, 12, 8},  {73, 13, 6},  {74, 14, 5},
                  {78, 10, 4},  {79, 12, 8},  {80, 13, 6},  {81, 14, 5}};
    static const uint8_t flat[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  21, 22,
                                   23, 28, 30, 34, 35, 36, 68, 69, 70, 75, 76, 77};
    for (size_t n = 0; n < sizeof curved / sizeof *curved; n++) {
        const shape *s = shapes;
        while (s->type != curved[n].like) s++;
        float points[3 * 32] = {0};
        int64_t connectivity[34] = {0}, offsets[] = {0, 2, 2 + curved[n].points};
        for (int c = 0; c < s->corner_count; c++)
            for (int axis = 0; axis < 3; axis++) points[3 * c + axis] = (float)s->corners[c][axis];
        for (int p = 0; p < curved[n].points; p++) connectivity[2 + p] = p;
        uint8_t types[2] = {flat[n % sizeof flat], (uint8_t)curved[n].type};
        tc_cells cells = {.struct_size = sizeof cells,
                          .point_count = 32,
                          .points = points,
                          .cell_count = 2,
                          .types = types,
                          .offsets = offsets,
                          .connectivity = connectivity};
        tc_tetrahedra complex = cut(&cells, "curved cell");
        expect_conforming(&complex, &cells, (uint64_t)s->faces, s->volume, "curved cell");
        EXPECT(complex.curved_cell_count == 1 && complex.flat_cell_count == 1, "type %d: kinds miscounted",
               curved[n].type);
        /* the base of VTK's wedges lies the other way round where they are curved */
        EXPECT(complex.inverted_cell_count == (curved[n].like == 13), "type %d: orientation miscounted",
               curved[n].type);
        tc_tetrahedra_release(&complex);
    }
    for (size_t n = 0; n < sizeof flat; n++) {
        const int64_t offsets[] = {0, 0};
        tc_cells cells = {.struct_size = sizeof cells,
                          .point_count = 0,
                          .points = NULL,
                          .cell_count = 1,
                          .types = &flat[n],
                          .offsets = offsets,
                          .connectivity = NULL};
        tc_tetrahedra complex = cut(&cells, "flat cell");
        EXPECT(complex.flat_cell_count == 1 && complex.tetrahedron_count == 0, "type %d is not flat", flat[n]);
        tc_tetrahedra_release(&complex);
    }
}

static void blanked(void) {
    cell_list list = mixed_block_make(4, 1);
    uint8_t *points = calloc(list.point_count, 1), *marks = calloc(list.cell_count, 1);
    for (int n = 0; n < 10; n++) points[random_below((uint32_t)list.point_count)] = 1;
    for (int n = 0; n < 10; n++) marks[random_below((uint32_t)list.cell_count)] = 1;
    tc_cells cells = cell_list_view(&list);
    cells.blanked_points = points, cells.blanked_cells = marks;
    tc_tetrahedra complex = cut(&cells, "blanked block");
    uint64_t left_out = 0, next = 0;
    for (uint64_t c = 0; c < list.cell_count; c++) {
        bool out = marks[c], there = false;
        for (int64_t n = list.offsets[c]; n < list.offsets[c + 1]; n++) out = out || points[list.connectivity[n]];
        for (; next < complex.tetrahedron_count && complex.cells[next] == c; next++) there = true;
        EXPECT(there == !out, "blanked block: cell %llu is %s", (unsigned long long)c, out ? "there" : "missing");
        left_out += out;
    }
    EXPECT(complex.blanked_cell_count == left_out, "blanked cells miscounted");
    tc_tetrahedra_release(&complex);
    free(points);
    free(marks);
    cell_list_free(&list);
}

/* ------------------------------------------------------------------------------------------------ structured grids */

enum { NX = 7, NY = 5, NZ = 6 };

/* missing: of samples and of cells. */
static void grid_check(bool missing, bool mirrored, bool bent) {
    static float values[NX * NY * NZ], points[3 * NX * NY * NZ];
    static uint8_t blanked_cells[(NX - 1) * (NY - 1) * (NZ - 1)];
    tc_grid_options grid;
    tc_grid_options_init(&grid);
    grid.dims[0] = NX, grid.dims[1] = NY, grid.dims[2] = NZ;
    grid.type = TC_F32, grid.samples = values;
    grid.first_index[random_below(3)] = (int64_t)random_below(3) - 1;
    if (mirrored) grid.matrix[1][1] = -1;
    if (bent) grid.points = points;
    if (missing) grid.blanked_cells = blanked_cells;
    for (size_t n = 0; n < sizeof blanked_cells; n++) blanked_cells[n] = random_below(12) ? 0 : 32;
    uint64_t cubes = 0, cube = 0;
    for (int n = 0; n < NX * NY * NZ; n++) {
        values[n] = missing && random_below(12) == 0 ? NAN : (float)n;
        points[3 * n] = (float)(n % NX) * (mirrored ? -1 : 1);
        points[3 * n + 1] = (float)(n / NX % NY);
        points[3 * n + 2] = (float)(n / NX / NY);
    }
    for (int n = 0; n < NX * NY * NZ; n++) {
        if (n % NX + 1 == NX || n / NX % NY + 1 == NY || n / NX / NY + 1 == NZ) continue;
        bool present = !missing || !blanked_cells[cube];
        cube++;
        for (int c = 0; c < 8 && present; c++)
            present = !isnan(values[n + (c & 1) + NX * (c >> 1 & 1) + NX * NY * (c >> 2)]);
        cubes += present;
    }
    tc_tetrahedra complex = {.struct_size = sizeof complex};
    EXPECT(tc_tetrahedralize_grid(&grid, &complex) == TC_OK, "grid: %s", tc_message());
    complex_facts f = complex_facts_of(&complex, points, NX * NY * NZ);
    const uint64_t all = (NX - 1) * (NY - 1) * (NZ - 1);
    EXPECT(complex.tetrahedron_count == 5 * cubes, "grid: %llu tetrahedra of %llu cubes",
           (unsigned long long)complex.tetrahedron_count, (unsigned long long)cubes);
    EXPECT(complex.blanked_cell_count == all - cubes, "grid: cubes left out miscounted");
    EXPECT(complex.inverted_cell_count == (mirrored ? cubes : 0), "grid: orientation miscounted");
    EXPECT(f.bad_faces + f.bad_tetrahedra + f.not_positive == 0, "grid: not a conforming complex");
    EXPECT(f.volume == 6.0 * (double)cubes, "grid: volume %g of %llu cubes", f.volume, (unsigned long long)cubes);
    if (!missing)
        EXPECT(f.boundary_faces == 4 * ((NX - 1) * (NY - 1) + (NX - 1) * (NZ - 1) + (NY - 1) * (NZ - 1)),
               "grid: %llu faces at the boundary", (unsigned long long)f.boundary_faces);
    tc_tetrahedra_release(&complex);
}

/* ---------------------------------------------------------------------------------------------------------- refusal */

static void refused(const tc_cells *cells, tc_status wanted, const char *word) {
    tc_tetrahedra complex = {.struct_size = sizeof complex};
    EXPECT_REFUSED(tc_tetrahedralize(cells, &complex), wanted, word);
    EXPECT(strstr(tc_message(), word), "no \"%s\" in \"%s\"", word, tc_message());
    EXPECT(!complex.tetrahedra && !complex.cells && !complex.tetrahedron_count, "%s: something is left", word);
}

static void one_cell_refused(uint8_t type, int64_t count, int64_t odd_point, const char *word) {
    float points[24] = {0};
    int64_t connectivity[32], offsets[2] = {0, count};
    for (int n = 0; n < 32; n++) connectivity[n] = n % 8;
    connectivity[3] = odd_point;
    tc_cells cells = {.struct_size = sizeof cells,
                      .point_count = 8,
                      .points = points,
                      .cell_count = 1,
                      .types = &type,
                      .offsets = offsets,
                      .connectivity = connectivity};
    refused(&cells, TC_ERROR_DATA, word);
}

/* The last offset is the length of the connectivity, which others may not go beyond. */
static void offsets_beyond(void) {
    static const uint8_t types[2] = {10, 10};
    static const int64_t cases[][3] = {{1000000, 1000004, 8}, {4, 12, 8}, {INT64_MAX - 4, INT64_MAX, 8}};
    const float points[24] = {0};
    const int64_t connectivity[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        tc_cells cells = {.struct_size = sizeof cells,
                          .point_count = 8,
                          .points = points,
                          .cell_count = 2,
                          .types = types,
                          .offsets = cases[n],
                          .connectivity = connectivity};
        refused(&cells, TC_ERROR_DATA, "do not rise from 0 to the last one, 8");
    }
}

/* Corners have to be somewhere; points of cells that are left out, midpoints of curved ones and others need not. */
static void positions(void) {
    const float odd[] = {NAN, INFINITY, -INFINITY, 0x1p127f, -FLT_MAX};
    static const uint8_t quadratic = 24, marks[12] = {[2] = 1};
    for (size_t n = 0; n < sizeof odd / sizeof *odd; n++) {
        float points[36] = {0};
        points[3] = points[7] = points[11] = 1;
        int64_t connectivity[10] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, offsets[2] = {0, 10};
        tc_cells cells = {.struct_size = sizeof cells,
                          .point_count = 12,
                          .points = points,
                          .cell_count = 1,
                          .types = &quadratic,
                          .offsets = offsets,
                          .connectivity = connectivity};
        points[3 * 11 + n % 3] = points[3 * 9 + n % 3] = odd[n];
        tc_tetrahedra complex = cut(&cells, "odd midpoint");
        EXPECT(complex.tetrahedron_count == 1, "a midpoint matters");
        tc_tetrahedra_release(&complex);
        points[6 + n % 3] = odd[n];
        refused(&cells, TC_ERROR_DATA, "point 2 of cell 0, a quadratic tetrahedron");
        cells.blanked_points = marks;
        complex = cut(&cells, "odd corner that is blanked");
        EXPECT(complex.blanked_cell_count == 1, "a blanked corner matters");
        tc_tetrahedra_release(&complex);
    }
}

static void refusals(void) {
    one_cell_refused(42, 8, 3, "polyhedron");
    one_cell_refused(41, 8, 3, "convex point set");
    one_cell_refused(15, 9, 3, "9 points, not 10");
    one_cell_refused(16, 11, 3, "11 points, not 12");
    one_cell_refused(200, 4, 3, "200");
    one_cell_refused(12, 7, 3, "7 points");
    one_cell_refused(10, 0, 3, "0 points");
    one_cell_refused(25, 8, 3, "8 points");
    one_cell_refused(72, 7, 3, "7 points");
    one_cell_refused(10, 4, 8, "point that is not");
    one_cell_refused(10, 4, -1, "point that is not");
    one_cell_refused(10, 4, INT64_MIN, "point that is not");
    one_cell_refused(5, -3, 3, "do not rise");
    one_cell_refused(10, -4, 3, "do not rise");

    enum { MANY = 100000 };
    cell_list list = cell_list_make(4, MANY);
    const uint32_t corners[4] = {0, 1, 2, 3};
    for (int n = 0; n < 4; n++) cell_list_point(&list, n == 1, n == 2, n == 3);
    for (int n = 0; n < MANY; n++) cell_list_add(&list, 10, 4, corners, false);
    list.types[99999] = list.types[70001] = 41;
    tc_cells cells = cell_list_view(&list);
    refused(&cells, TC_ERROR_DATA, "cell 70001 ");
    list.types[99999] = list.types[70001] = 10;
    cells.point_count = UINT64_C(1) << 32;
    refused(&cells, TC_ERROR_LIMIT, "4294967296 points");
    cells.point_count = 4;
    cells.cell_count = UINT64_C(1) << 32;
    refused(&cells, TC_ERROR_LIMIT, "4294967296 cells");
    cells.cell_count = 1;
    cells.struct_size = 0;
    refused(&cells, TC_ERROR_ARGUMENT, "struct_size");
    cells.struct_size = sizeof cells;
    tc_tetrahedra unset = {0};
    EXPECT_REFUSED(tc_tetrahedralize(&cells, &unset), TC_ERROR_ARGUMENT, "complex without struct_size");
    cells.cell_count = 0;
    tc_tetrahedra none = cut(&cells, "no cells");
    EXPECT(none.tetrahedron_count == 0, "tetrahedra of nothing");
    tc_tetrahedra_release(&none);
    tc_tetrahedra_release(NULL);
    cell_list_free(&list);

    tc_grid_options grid;
    tc_tetrahedra complex = {.struct_size = sizeof complex};
    tc_grid_options_init(&grid);
    EXPECT_REFUSED(tc_tetrahedralize_grid(&grid, &complex), TC_ERROR_ARGUMENT, "grid without samples");
    EXPECT_REFUSED(tc_tetrahedralize_grid(&grid, &unset), TC_ERROR_ARGUMENT, "grid, complex without struct_size");
}

int main(void) {
    all_orders();
    mixed_blocks();
    collapsed();
    folded();
    curved_and_flat();
    blanked();
    for (int n = 0; n < 8; n++) grid_check(n & 1, n & 2, n & 4);
    positions();
    offsets_beyond();
    refusals();
    return EXPECT_DONE();
}
