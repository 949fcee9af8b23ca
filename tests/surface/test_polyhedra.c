/*
 * test_polyhedra.c - the converter on cells with faces of many corners: prisms and polyhedra of any numbering and
 * winding, beside each other and beside other types, divided faces, cells that do not close, surplus points
 */
#include "api.h"
#include "cut.h"
#include "random.h"

#include <string.h>

enum { ROUNDS = 400 };

/* As expect_conforming; and the cells that were put in inverted are counted, and no others. */
static void expect_cut(const tc_tetrahedra *complex, const cell_list *list, uint64_t boundary_faces, double volume,
                       const char *what) {
    const tc_cells cells = cell_list_view(list);
    expect_conforming(complex, &cells, boundary_faces, volume, what);
    EXPECT(complex->inverted_cell_count == list->inverted_count && !complex->folded_cell_count,
           "%s: %llu cells inverted, not %llu, and %llu folded", what, (unsigned long long)complex->inverted_cell_count,
           (unsigned long long)list->inverted_count, (unsigned long long)complex->folded_cell_count);
}

/* -------------------------------------------------------------------------------------------------------- one cell */

static double height(const float *points, const uint32_t plane[3], uint32_t p) {
    double e[3][3];
    const uint32_t to[3] = {plane[1], plane[2], p};
    for (int n = 0; n < 3; n++)
        for (int a = 0; a < 3; a++)
            e[n][a] = (double)points[3 * to[n] + (unsigned)a] - points[3 * plane[0] + (unsigned)a];
    return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
           e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

/* All tetrahedra of a convex cell have its smallest point, 0, and all triangles on its border the smallest point of
 * their plane. */
static void expect_smallest(const tc_tetrahedra *one, const cell_list *list, const char *what) {
    for (uint64_t n = 0; n < one->tetrahedron_count; n++) {
        const uint32_t *t = one->tetrahedra + 4 * n;
        EXPECT(!t[0] || !t[1] || !t[2] || !t[3], "%s: a tetrahedron without the smallest point", what);
        for (int left_out = 0; left_out < 4; left_out++) {
            uint32_t plane[3], smallest = UINT32_MAX;
            int above = 0, below = 0;
            for (int v = 0, m = 0; v < 4; v++)
                if (v != left_out) plane[m++] = t[v];
            for (uint32_t p = 0; p < list->point_count; p++) {
                double h = height(list->points, plane, p);
                above += h > 0, below += h < 0;
                if (h == 0 && p < smallest) smallest = p;
            }
            EXPECT((above && below) || plane[0] == smallest || plane[1] == smallest || plane[2] == smallest,
                   "%s: a face is no fan around its smallest point", what);
        }
    }
}

/* A prism on a convex base of n integer corners. */
static void prism_check(int sides, bool as_polyhedron) {
    static const int hexagon[6][2] = {{2, 0}, {3, 1}, {3, 2}, {2, 3}, {1, 2}, {1, 1}};
    static const int counts[8] = {0, 0, 4, 4, 4, 4, 4, 4};
    cell_list list = cell_list_make(12, 1);
    uint32_t h[12], faces[36], *to = faces;
    int face_counts[8];
    const char *what = sides == 5 ? "pentagonal prism" : "hexagonal prism";
    for (int n = 0; n < 2 * sides; n++)
        h[n] = cell_list_point(&list, hexagon[n % sides][0], hexagon[n % sides][1], n < sides ? 0 : 2);
    for (int n = 0; n < 8; n++) face_counts[n] = counts[n] ? counts[n] : sides;
    for (int n = 0; n < 2 * sides; n++) *to++ = h[n];
    for (int n = 0; n < sides; n++) {
        *to++ = h[n], *to++ = h[(n + 1) % sides];
        *to++ = h[sides + (n + 1) % sides], *to++ = h[sides + n];
    }
    if (as_polyhedron)
        cell_list_add_polyhedron(&list, sides + 2, face_counts, faces);
    else
        cell_list_add(&list, sides + 10, 2 * sides, h, random_below(2));
    cell_list_renumber(&list);
    tc_cells cells = cell_list_view(&list);
    tc_tetrahedra complex = cut(&cells, what);
    int twice_area = 0;
    for (int n = 0; n < sides; n++) {
        const int *a = hexagon[n], *b = hexagon[(n + 1) % sides];
        twice_area += a[0] * b[1] - a[1] * b[0];
    }
    EXPECT(complex.tetrahedron_count == (unsigned)(3 * (sides - 2)), "%s: %llu tetrahedra", what,
           (unsigned long long)complex.tetrahedron_count);
    expect_cut(&complex, &list, (unsigned)(4 * sides - 4), 6.0 * twice_area, what);
    expect_smallest(&complex, &list, what);
    tc_tetrahedra_release(&complex);
    cell_list_free(&list);
}

static void truncated_octahedron_check(uint64_t seed) {
    cell_list list = kelvin_block_make(1, seed);
    tc_cells cells = cell_list_view(&list);
    cells.cell_count = 1;
    list.cell_count = 1;
    tc_tetrahedra both = cut(&cells, "truncated octahedron");
    complex_facts f = complex_facts_of(&both, list.points, list.point_count);
    EXPECT(f.boundary_faces == 6 * 2 + 8 * 4 && f.volume == 6 * 32 && !f.bad_faces && !f.not_positive,
           "truncated octahedron: %llu faces, volume %g", (unsigned long long)f.boundary_faces, f.volume);
    tc_tetrahedra_release(&both);
    cell_list_free(&list);
}

/* ------------------------------------------------------------------------------------------------------- many cells */

/* Triangles of the faces that one cell only has. */
static uint64_t kelvin_boundary(uint32_t size) {
    const uint64_t n = size, cells = 2 * n * n * n;
    /* squares join centres of one kind, hexagons those of both, 4 apart along each axis */
    uint64_t inner_squares = 2 * 3 * n * n * (n - 1),
             inner_hexagons = n * n * n + 3 * n * n * (n - 1) + 3 * n * (n - 1) * (n - 1) + (n - 1) * (n - 1) * (n - 1);
    return 2 * (6 * cells - 2 * inner_squares) + 4 * (8 * cells - 2 * inner_hexagons);
}

static void kelvin_check(uint32_t size) {
    char what[64];
    snprintf(what, sizeof what, "truncated octahedra, %u", size);
    cell_list list = kelvin_block_make(size, random_u64());
    tc_cells cells = cell_list_view(&list);
    tc_tetrahedra complex = cut(&cells, what);
    expect_cut(&complex, &list, kelvin_boundary(size), 6.0 * 32 * (double)list.cell_count, what);
    tc_tetrahedra_release(&complex);
    cell_list_free(&list);
}

static void honeycomb_check(uint32_t size) {
    char what[64];
    snprintf(what, sizeof what, "honeycomb, %u", size);
    cell_list list = honeycomb_make(size, random_u64());
    tc_cells cells = cell_list_view(&list);
    tc_tetrahedra complex = cut(&cells, what);
    const uint64_t n = size, sides = 6 * n * n - 2 * (n * (n - 1) * 2 + (n - 1) * (n - 1));
    expect_cut(&complex, &list, 2 * sides * n + 2 * 4 * n * n, 6.0 * 3 * (double)(n * n * n), what);
    tc_tetrahedra_release(&complex);
    cell_list_free(&list);
}

/* A cube whose neighbours on one side are four of half its size, so that this face is four, and those beside it have
 * five corners, two edges of them in a line: tetrahedra without a volume arise. Turned in space, by rounding, some have
 * a negative one, of no matter. */
static void divided_check(bool turned) {
    cell_list list = cell_list_make(32, 5);
    uint32_t made[3][3][4];
    memset(made, 255, sizeof made);
    for (int n = 0; n < 36; n++) {
        int x = n % 4, y = n / 4 % 3, z = n / 12;
        if (x == 1 || (x == 0 && (y == 1 || z == 1))) continue;
        const double c = turned ? 0.8 : 1, s = turned ? 0.6 : 0;
        made[z][y][x] = cell_list_point(&list, c * x - s * y, c * (s * x + c * y) - s * z, s * (s * x + c * y) + c * z);
    }
#define P(x, y, z) made[z][y][x]
    const uint32_t coarse[] = {
        P(0, 0, 0), P(0, 2, 0), P(0, 2, 2), P(0, 0, 2), /* x = 0 */
        P(2, 0, 0), P(2, 1, 0), P(2, 1, 1), P(2, 0, 1), P(2, 1, 0), P(2, 2, 0), P(2, 2, 1), P(2, 1, 1), P(2, 0, 1),
        P(2, 1, 1), P(2, 1, 2), P(2, 0, 2), P(2, 1, 1), P(2, 2, 1), P(2, 2, 2), P(2, 1, 2), P(0, 0, 0), P(2, 0, 0),
        P(2, 0, 1), P(2, 0, 2), P(0, 0, 2), P(0, 2, 0), P(2, 2, 0), P(2, 2, 1), P(2, 2, 2), P(0, 2, 2), P(0, 0, 0),
        P(2, 0, 0), P(2, 1, 0), P(2, 2, 0), P(0, 2, 0), P(0, 0, 2), P(2, 0, 2), P(2, 1, 2), P(2, 2, 2), P(0, 2, 2)};
    static const int counts[] = {4, 4, 4, 4, 4, 5, 5, 5, 5};
    cell_list_add_polyhedron(&list, 9, counts, coarse);
    for (int n = 0; n < 4; n++) {
        const int y = n % 2, z = n / 2;
        const uint32_t fine[8] = {P(2, y, z),     P(3, y, z),     P(3, y + 1, z),     P(2, y + 1, z),
                                  P(2, y, z + 1), P(3, y, z + 1), P(3, y + 1, z + 1), P(2, y + 1, z + 1)};
        cell_list_add(&list, 12, 8, fine, random_below(2));
    }
#undef P
    cell_list_renumber(&list);
    tc_cells cells = cell_list_view(&list);
    tc_tetrahedra complex = cut(&cells, "divided face");
    complex_facts f = complex_facts_of(&complex, list.points, list.point_count);
    EXPECT(!f.bad_faces && f.boundary_faces == 2 + 4 * 3 + 8 + 16, "divided face: %llu bad faces, %llu at the boundary",
           (unsigned long long)f.bad_faces, (unsigned long long)f.boundary_faces);
    EXPECT(fabs(f.volume - 72) < (turned ? 1e-4 : 1e-12), "divided face: volume %g", f.volume);
    EXPECT(!complex.folded_cell_count && complex.inverted_cell_count == list.inverted_count,
           "divided face: %llu folded", (unsigned long long)complex.folded_cell_count);
    tc_tetrahedra_release(&complex);
    cell_list_free(&list);
}

/* A face around which more corners stand than most cells have: memory of its own, and the other way to sort. */
static void many_corners(int sides) {
    cell_list list = cell_list_make((uint64_t)sides + 1, 1);
    int64_t *starts = calloc(2, 8), *offsets = calloc((size_t)sides + 2, 8), *points = calloc(4 * (size_t)sides, 8);
    for (int n = 0; n < sides; n++) cell_list_point(&list, cos(2 * M_PI * n / sides), sin(2 * M_PI * n / sides), 0);
    cell_list_point(&list, 0, 0, 1);
    for (int n = 0; n < sides; n++) {
        int64_t *side = points + 3 * n;
        const int next = (n + 1) % sides, flip = (int)random_below(2);
        side[0] = sides, side[1 + flip] = n, side[2 - flip] = next;
        offsets[n] = 3 * n;
        points[3 * sides + n] = n;
    }
    offsets[sides] = 3 * sides, offsets[sides + 1] = 4 * sides;
    starts[1] = sides + 1;
    list.types[0] = 42, list.cell_count = 1;
    tc_cells cells = cell_list_view(&list);
    cells.cell_faces = starts, cells.face_offsets = offsets, cells.face_connectivity = points;
    tc_tetrahedra complex = cut(&cells, "a cone of many sides");
    complex_facts f = complex_facts_of(&complex, list.points, list.point_count);
    EXPECT(complex.tetrahedron_count == (unsigned)sides - 2 && !f.bad_faces && !f.not_positive &&
               f.boundary_faces == 2 * (unsigned)sides - 2 && fabs(f.volume - sides * sin(2 * M_PI / sides)) < 1e-4,
           "a cone of %d sides: %llu tetrahedra, volume %g", sides, (unsigned long long)complex.tetrahedron_count,
           f.volume);
    tc_tetrahedra_release(&complex);
    free(starts), free(offsets), free(points);
    cell_list_free(&list);
}

/* ------------------------------------------------------------------------------------------ damage, and what is odd */

static void refused(const tc_cells *cells, tc_status wanted, const char *word) {
    tc_tetrahedra complex = {.struct_size = sizeof complex};
    EXPECT_REFUSED(tc_tetrahedralize(cells, &complex), wanted, word);
    EXPECT(strstr(tc_message(), word), "no \"%s\" in \"%s\"", word, tc_message());
    EXPECT(!complex.tetrahedra && !complex.cells && !complex.tetrahedron_count, "%s: something is left", word);
}

/* A tetrahedron of four faces, and another of type 10. */
typedef struct pair {
    float points[15];
    uint8_t types[2];
    int64_t offsets[3], links[4], starts[3], face_offsets[5], faces[12];
    tc_cells cells;
} pair;

static void pair_make(pair *p) {
    *p = (pair){.points = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1},
                .types = {42, 10},
                .offsets = {0, 0, 4},
                .links = {1, 2, 3, 4},
                .starts = {0, 4, 4},
                .face_offsets = {0, 3, 6, 9, 12},
                .faces = {0, 1, 2, 0, 1, 3, 3, 1, 2, 2, 0, 3}};
    p->cells = (tc_cells){.struct_size = sizeof p->cells,
                          .point_count = 5,
                          .points = p->points,
                          .cell_count = 2,
                          .types = p->types,
                          .offsets = p->offsets,
                          .connectivity = p->links,
                          .cell_faces = p->starts,
                          .face_offsets = p->face_offsets,
                          .face_connectivity = p->faces};
}

static void expect_left_out(const pair *p, const char *what) {
    tc_tetrahedra complex = cut(&p->cells, what);
    EXPECT(complex.tetrahedron_count == 1 && complex.cells[0] == 1 && complex.unsupported_cell_count == 1,
           "%s: %llu tetrahedra, %llu cells unsupported", what, (unsigned long long)complex.tetrahedron_count,
           (unsigned long long)complex.unsupported_cell_count);
    tc_tetrahedra_release(&complex);
}

static void damaged_faces(void) {
    pair p;
    pair_make(&p);
    tc_tetrahedra complex = cut(&p.cells, "two tetrahedra");
    EXPECT(complex.tetrahedron_count == 2 && !complex.inverted_cell_count, "two tetrahedra: %llu",
           (unsigned long long)complex.tetrahedron_count);
    tc_tetrahedra_release(&complex);

    p.cells.cell_faces = NULL;
    refused(&p.cells, TC_ERROR_DATA, "cell 0, a polyhedron, has no faces");
    pair_make(&p), p.starts[1] = p.starts[2] = 0;
    refused(&p.cells, TC_ERROR_DATA, "has no faces");
    pair_make(&p), memset(p.face_offsets, 0, sizeof p.face_offsets);
    p.cells.face_connectivity = NULL;
    refused(&p.cells, TC_ERROR_DATA, "has no faces");
    static const int64_t odd_starts[][3] = {
        {1, 0, 4}, {-1, 4, 4}, {0, 5, 4}, {INT64_MIN, INT64_MAX, 4}, {-1000000000, 4, 4}};
    for (size_t n = 0; n < sizeof odd_starts / sizeof *odd_starts; n++) {
        pair_make(&p), memcpy(p.starts, odd_starts[n], sizeof p.starts);
        refused(&p.cells, TC_ERROR_DATA, "do not rise");
    }
    static const int64_t odd_offsets[] = {-1, 13, INT64_MIN, INT64_MAX};
    for (size_t n = 0; n < sizeof odd_offsets / sizeof *odd_offsets; n++) {
        pair_make(&p), p.face_offsets[2] = odd_offsets[n];
        refused(&p.cells, TC_ERROR_DATA, "do not rise");
    }
    static const int64_t odd_points[] = {-1, 5, INT64_MIN, INT64_MAX};
    for (size_t n = 0; n < sizeof odd_points / sizeof *odd_points; n++) {
        pair_make(&p), p.faces[11] = odd_points[n];
        refused(&p.cells, TC_ERROR_DATA, "a point that is not among those");
    }
    pair_make(&p), p.points[10] = NAN;
    refused(&p.cells, TC_ERROR_DATA, "point 3 of cell 0, a polyhedron");
    uint8_t marks[5] = {[0] = 1};
    p.cells.blanked_points = marks;
    p.points[10] = 0;
    complex = cut(&p.cells, "a blanked point of a polyhedron");
    EXPECT(complex.tetrahedron_count == 1 && complex.blanked_cell_count == 1, "a blanked point of a polyhedron");
    tc_tetrahedra_release(&complex);

    pair_make(&p), p.cells.face_offsets = NULL;
    refused(&p.cells, TC_ERROR_ARGUMENT, "face_offsets");
    pair_make(&p), p.face_offsets[0] = -1;
    refused(&p.cells, TC_ERROR_ARGUMENT, "face_offsets");
    pair_make(&p), p.cells.face_connectivity = NULL;
    refused(&p.cells, TC_ERROR_ARGUMENT, "face_connectivity");
    pair_make(&p), p.cells.face_offsets = (const int64_t *)(const void *)((const char *)p.face_offsets + 4);
    refused(&p.cells, TC_ERROR_ARGUMENT, "not aligned");
}

static void left_out(void) {
    pair p;
    pair_make(&p), p.starts[1] = p.starts[2] = 3; /* the last face is missing */
    p.cells.skip_unsupported = 1;
    expect_left_out(&p, "an open polyhedron");
    p.cells.skip_unsupported = 0;
    refused(&p.cells, TC_ERROR_DATA, "has faces that are not closed");
    pair_make(&p), p.faces[4] = 2; /* one edge is gone, another there three times */
    refused(&p.cells, TC_ERROR_DATA, "has faces that are not closed");
    pair_make(&p), p.types[0] = 41, p.offsets[1] = 0;
    refused(&p.cells, TC_ERROR_DATA, "of type 41 (convex point set)");
    p.cells.skip_unsupported = 1;
    expect_left_out(&p, "a convex point set");
    p.types[0] = 200;
    expect_left_out(&p, "a type that is none");
    pair_make(&p), p.types[0] = 12, p.cells.skip_unsupported = 1;
    refused(&p.cells, TC_ERROR_DATA, "0 points, not 8");
}

/* A face of two points, points twice in a row, a face around which nothing lies: they add nothing. */
static void degenerate_faces(void) {
    pair p;
    const int64_t faces[] = {0, 1, 2, 2, 0, 1, 3, 3, 1, 1, 2, 2, 0, 3, 4, 1, 1, 4},
                  offsets[] = {0, 4, 7, 11, 14, 16, 18};
    const int64_t starts[] = {0, 6, 6};
    pair_make(&p);
    p.cells.cell_faces = starts, p.cells.face_offsets = offsets, p.cells.face_connectivity = faces;
    tc_tetrahedra complex = cut(&p.cells, "degenerate faces");
    complex_facts f = complex_facts_of(&complex, p.points, 5);
    EXPECT(complex.tetrahedron_count == 2 && !f.not_positive && !f.bad_tetrahedra && f.volume == 3,
           "degenerate faces: %llu tetrahedra, volume %g", (unsigned long long)complex.tetrahedron_count, f.volume);
    tc_tetrahedra_release(&complex);
}

/* Of more points than the type has the first ones are taken. The others have to be nowhere. */
static void surplus_points(void) {
    static const struct {
        int type, points;
    } cases[] = {{10, 4}, {11, 8}, {12, 8}, {13, 6}, {14, 5}, {15, 10}, {16, 12}, {24, 10}, {25, 20}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        cell_list list = honeycomb_make(2, random_u64());
        int64_t links[32], offsets[2] = {0, cases[n].points + 3};
        uint8_t type = (uint8_t)cases[n].type, marks[64] = {0};
        for (int m = 0; m < cases[n].points; m++) links[m] = m;
        for (int m = 0; m < 3; m++) links[cases[n].points + m] = 1000000;
        tc_cells cells = cell_list_view(&list);
        cells.cell_count = 1, cells.types = &type, cells.offsets = offsets, cells.connectivity = links;
        tc_tetrahedra complex = cut(&cells, "surplus points");
        offsets[1] -= 3;
        tc_tetrahedra exact = cut(&cells, "no surplus points");
        EXPECT(complex.surplus_cell_count == 1 && exact.surplus_cell_count == 0, "type %d: surplus points miscounted",
               type);
        EXPECT(complex.tetrahedron_count == exact.tetrahedron_count &&
                   !memcmp(complex.tetrahedra, exact.tetrahedra, 16 * (size_t)exact.tetrahedron_count),
               "type %d: surplus points change the cell", type);
        marks[cases[n].points] = 1;
        links[cases[n].points] = cases[n].points, offsets[1]++;
        cells.blanked_points = marks;
        tc_tetrahedra_release(&complex);
        complex = cut(&cells, "a surplus point that is blanked");
        EXPECT(complex.blanked_cell_count == 0, "type %d: a surplus point blanks the cell", type);
        tc_tetrahedra_release(&complex);
        tc_tetrahedra_release(&exact);
        cell_list_free(&list);
    }
}

int main(void) {
    for (int n = 0; n < ROUNDS; n++) {
        prism_check(5 + n % 2, n & 2);
        truncated_octahedron_check(random_u64());
        divided_check(n % 2);
    }
    for (uint32_t size = 1; size < 9; size++) {
        kelvin_check(size);
        honeycomb_check(size);
    }
    honeycomb_check(24); /* several blocks of cells */
    for (int sides = 60; sides < 5000; sides *= 3) many_corners(sides);
    damaged_faces();
    left_out();
    degenerate_faces();
    surplus_points();
    return EXPECT_DONE();
}
