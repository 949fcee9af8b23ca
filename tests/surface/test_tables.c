/*
 * test_tables.c - every table derived again from geometry
 *
 * The split: five tetrahedra fill the cube (volumes 1/3 and 4 x 1/6, positive orientation, no point in two), are those
 * of split.h, and neighbours share face diagonals all over a 3 x 3 x 3 block. The cases: tetrahedra of random shape
 * with a random linear function, whose level set is a plane, so that winding is exact. Cube tables: all patterns, both
 * parities, both windings.
 */
#include "expect.h"
#include "random.h"
#include "split.h"
#include "tables/tables.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct vector {
    double x, y, z;
} vector;

static vector minus(vector a, vector b) { return (vector){a.x - b.x, a.y - b.y, a.z - b.z}; }

static double dot(vector a, vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

static vector cross(vector a, vector b) {
    return (vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* Six times the signed volume. */
static double volume6(const vector p[4]) { return dot(cross(minus(p[1], p[0]), minus(p[2], p[0])), minus(p[3], p[0])); }

static vector corner_position(unsigned c) { return (vector){c & 1, c >> 1 & 1, c >> 2}; }

/* ------------------------------------------------------------------------------------------------------- the split */

static void test_split_volumes(void) {
    for (unsigned parity = 0; parity < 2; parity++) {
        double total = 0;
        for (unsigned t = 0; t < TETRAHEDRA_PER_CUBE; t++) {
            vector p[4];
            for (unsigned n = 0; n < 4; n++) p[n] = corner_position(tetrahedron_corners[parity][t][n]);
            double volume = volume6(p);
            EXPECT(volume == (t ? 1 : 2), "parity %u, tetrahedron %u: volume %g / 6", parity, t, volume);
            total += volume;
        }
        EXPECT(total == 6, "parity %u: the five have %g / 6 of the cube", parity, total);
    }
}

static unsigned tetrahedra_around(unsigned parity, vector point) {
    unsigned count = 0;
    for (unsigned t = 0; t < TETRAHEDRA_PER_CUBE; t++) {
        unsigned sides = 0;
        for (unsigned n = 0; n < 4; n++) {
            vector p[4];
            for (unsigned m = 0; m < 4; m++) p[m] = m == n ? point : corner_position(tetrahedron_corners[parity][t][m]);
            sides += volume6(p) > 0;
        }
        count += sides == 4;
    }
    return count;
}

static void test_split_covers_once(void) {
    for (unsigned n = 0; n < 2000; n++) {
        vector p = {random_between(0, 1), random_between(0, 1), random_between(0, 1)};
        unsigned count = tetrahedra_around(n & 1, p);
        EXPECT(count == 1, "parity %u: %g, %g, %g is in %u tetrahedra", n & 1, p.x, p.y, p.z, count);
    }
}

static void test_split_is_the_documented_one(void) {
    static const unsigned central[4] = {0, 3, 5, 6}; /* x + 2 y + 4 z of 000, 110, 101, 011 */
    for (unsigned parity = 0; parity < 2; parity++)
        for (unsigned t = 0; t < TETRAHEDRA_PER_CUBE; t++) {
            unsigned corners[4] = {0}, should = 0, is = 0, mirror = 0;
            split_tetrahedron(parity, t, corners);
            for (unsigned n = 0; n < 4; n++) {
                should |= 1u << corners[n];
                is |= 1u << tetrahedron_corners[parity][t][n];
                mirror |= 1u << (tetrahedron_corners[!parity][t][n] ^ 1);
            }
            EXPECT(is == should, "parity %u, tetrahedron %u: corners %02x, not %02x", parity, t, is, should);
            EXPECT(is == mirror, "tetrahedron %u: the odd split is not the mirror in x of the even one", t);
        }
    for (unsigned n = 0; n < 4; n++)
        EXPECT(memchr(tetrahedron_corners[0][0], (int)central[n], 4), "corner %u is not central", central[n]);
}

enum { BLOCK = 3, POINTS = BLOCK + 1 };

/* Which two of the 64 points of the block each face diagonal joins, told by both cubes of a face. */
static void test_neighbours_share_diagonals(void) {
    static unsigned char joined[POINTS * POINTS * POINTS][POINTS * POINTS * POINTS];
    unsigned faces = 0, crossed = 0;
    for (unsigned cube = 0; cube < BLOCK * BLOCK * BLOCK; cube++) {
        unsigned x = cube % BLOCK, y = cube / BLOCK % BLOCK, z = cube / BLOCK / BLOCK;
        for (unsigned t = 0; t < TETRAHEDRA_PER_CUBE; t++)
            for (unsigned n = 0; n < 4; n++)
                for (unsigned m = 0; m < 4; m++) {
                    unsigned c = tetrahedron_corners[(x + y + z) & 1][t][n];
                    unsigned d = tetrahedron_corners[(x + y + z) & 1][t][m];
                    unsigned p = x + (c & 1) + POINTS * (y + (c >> 1 & 1)) + POINTS * POINTS * (z + (c >> 2));
                    unsigned q = x + (d & 1) + POINTS * (y + (d >> 1 & 1)) + POINTS * POINTS * (z + (d >> 2));
                    EXPECT((c ^ d) != 7, "tetrahedron %u of a cube has an edge through its middle", t);
                    joined[p][q] = 1;
                }
    }
    for (unsigned p = 0; p < POINTS * POINTS * POINTS; p++) {
        unsigned at[3] = {p % POINTS, p / POINTS % POINTS, p / POINTS / POINTS}, step[3] = {1, POINTS, POINTS * POINTS};
        for (int axis = 0; axis < 3; axis++) {
            int u = (axis + 1) % 3, v = (axis + 2) % 3;
            if (at[u] + 1 == POINTS || at[v] + 1 == POINTS) continue;
            faces++;
            crossed += joined[p][p + step[u] + step[v]] + joined[p + step[u]][p + step[v]];
            EXPECT(joined[p][p + step[u] + step[v]] != joined[p + step[u]][p + step[v]],
                   "the face at point %u across axis %d is cut by none or both of its diagonals", p, axis);
        }
    }
    EXPECT(faces == 108 && crossed == 108, "%u faces, %u diagonals", faces, crossed);
}

/* ------------------------------------------------------------------------------------------------------- the cases */

static void test_edges_of_a_tetrahedron(void) {
    unsigned seen = 0;
    for (unsigned e = 0; e < 6; e++) {
        EXPECT(tetrahedron_edges[e][0] < tetrahedron_edges[e][1], "edge %u joins its ends in falling order", e);
        seen |= 1u << (4 * tetrahedron_edges[e][0] + tetrahedron_edges[e][1]);
    }
    EXPECT(seen == (1u << 1 | 1u << 2 | 1u << 3 | 1u << 6 | 1u << 7 | 1u << 11), "edges %x are not all six pairs",
           seen);
}

static bool edge_differs(unsigned pattern, unsigned edge) {
    return (pattern >> tetrahedron_edges[edge][0] ^ pattern >> tetrahedron_edges[edge][1]) & 1;
}

static void test_cases_use_the_crossed_edges(void) {
    for (unsigned pattern = 0; pattern < 16; pattern++) {
        const tetrahedron_case *c = &tetrahedron_cases[pattern];
        unsigned used = 0, crossed = 0, inside = 0;
        for (unsigned n = 0; n < 4; n++) inside += pattern >> n & 1;
        for (unsigned e = 0; e < 6; e++) crossed |= (unsigned)edge_differs(pattern, e) << e;
        for (unsigned n = 0; n < c->triangle_count; n++)
            for (unsigned m = 0; m < 3; m++) used |= 1u << c->triangles[n][m];
        for (unsigned n = c->triangle_count; n < 2; n++)
            for (unsigned m = 0; m < 3; m++)
                EXPECT(c->triangles[n][m] == 0, "case %u: triangle %u is not used, but not 0", pattern, n);
        EXPECT(c->triangle_count == split_triangle_count(inside), "case %u has %u triangles", pattern,
               c->triangle_count);
        EXPECT(used == crossed, "case %u uses edges %02x, crossed are %02x", pattern, used, crossed);
    }
}

/* The face, by the vertex that it lacks, that holds two edges; 4 where none does. */
static unsigned face_of(unsigned e, unsigned f) {
    unsigned all = 0;
    for (unsigned n = 0; n < 2; n++) all |= 1u << tetrahedron_edges[e][n] | 1u << tetrahedron_edges[f][n];
    for (unsigned n = 0; n < 4; n++)
        if (all == (15u & ~(1u << n))) return n;
    return 4;
}

/* A side that one triangle of the case alone has lies in a crossed face; every crossed face has one such side. */
static void test_cases_end_in_faces(void) {
    for (unsigned pattern = 0; pattern < 16; pattern++) {
        const tetrahedron_case *c = &tetrahedron_cases[pattern];
        int passed[6][6] = {{0}}, sides[5] = {0};
        for (unsigned n = 0; n < c->triangle_count; n++)
            for (unsigned m = 0; m < 3; m++) passed[c->triangles[n][m]][c->triangles[n][(m + 1) % 3]]++;
        for (unsigned e = 0; e < 6; e++)
            for (unsigned f = 0; f < 6; f++)
                if (passed[e][f] && !passed[f][e]) sides[face_of(e, f)] += passed[e][f];
        for (unsigned face = 0; face < 4; face++) {
            unsigned left = pattern & 15u & ~(1u << face);
            int crossed = left != 0 && left != (15u & ~(1u << face));
            EXPECT(sides[face] == crossed, "case %u has %d sides in face %u", pattern, sides[face], face);
        }
        EXPECT(sides[4] == 0, "case %u has a border inside the tetrahedron", pattern);
    }
}

static vector random_vector(void) {
    return (vector){random_between(-1, 1), random_between(-1, 1), random_between(-1, 1)};
}

/* A linear function with the signs of the pattern at the vertices: its zeros are a plane, so winding is the sign of a
 * product with its gradient. */
static void test_cases_wind_outward(void) {
    for (unsigned trial = 0; trial < 3200; trial++) {
        unsigned pattern = trial % 16;
        const tetrahedron_case *c = &tetrahedron_cases[pattern];
        vector p[4], gradient = {0, 0, 0};
        double value[4];
        do
            for (unsigned n = 0; n < 4; n++) p[n] = random_vector();
        while (volume6(p) < 0.05);
        for (unsigned n = 0; n < 4; n++) value[n] = random_between(0.1, 1) * (pattern >> n & 1 ? 1 : -1);
        for (unsigned n = 1; n < 4; n++) {
            vector u = minus(p[n % 3 + 1], p[0]), v = minus(p[(n + 1) % 3 + 1], p[0]), w = cross(u, v);
            double factor = (value[n] - value[0]) / volume6(p);
            gradient = (vector){gradient.x + factor * w.x, gradient.y + factor * w.y, gradient.z + factor * w.z};
        }
        for (unsigned n = 0; n < c->triangle_count; n++) {
            vector q[3];
            for (unsigned m = 0; m < 3; m++) {
                unsigned a = tetrahedron_edges[c->triangles[n][m]][0], b = tetrahedron_edges[c->triangles[n][m]][1];
                double t = value[a] / (value[a] - value[b]);
                vector d = minus(p[b], p[a]);
                q[m] = (vector){p[a].x + t * d.x, p[a].y + t * d.y, p[a].z + t * d.z};
            }
            double facing = dot(cross(minus(q[1], q[0]), minus(q[2], q[0])), gradient);
            EXPECT(facing < 0, "case %u, triangle %u does not face the lower values", pattern, n);
        }
    }
}

/* ----------------------------------------------------------------------------------------------------- cube tables */

/* The corners that edge n of cube_edges joins, from its owner and type; diagonals join the cube's even samples. */
static split_edge ends_of(unsigned n, unsigned parity) {
    static const unsigned axes_of_type[6] = {1, 2, 4, 3, 5, 6};
    owned_vertex e = cube_edges[n];
    unsigned a = (unsigned)(e.dx + 2 * e.dy + 4 * e.dz), axes = axes_of_type[e.type];
    if (e.type >= EDGE_XY && split_corner_is_odd(a) != parity) {
        unsigned first = axes & (~axes + 1);
        return (split_edge){a ^ first, a ^ axes ^ first};
    }
    return (split_edge){a, a ^ axes};
}

static void test_cube_edges(void) {
    for (unsigned parity = 0; parity < 2; parity++) {
        unsigned joined[8] = {0};
        for (unsigned n = 0; n < CUBE_EDGES; n++) {
            split_edge e = ends_of(n, parity);
            owned_vertex found = edge_between(e.a, e.b);
            EXPECT(!memcmp(&found, &cube_edges[n], sizeof found), "edge_between(%u, %u) is not edge %u", e.a, e.b, n);
            EXPECT((n < 13) == (cube_edges[n].dx == 0), "edge %u is numbered in the wrong column", n);
            joined[e.a] |= 1u << e.b;
            joined[e.b] |= 1u << e.a;
        }
        for (unsigned c = 0; c < 8; c++) {
            unsigned should = 0;
            for (unsigned d = 0; d < 8; d++) {
                unsigned axes = c ^ d, spanned = (axes & 1) + (axes >> 1 & 1) + (axes >> 2);
                should |= (unsigned)(spanned == 1 || (spanned == 2 && split_corner_is_odd(c) == parity)) << d;
            }
            EXPECT(joined[c] == should, "parity %u: corner %u is joined to %02x, not %02x", parity, c, joined[c],
                   should);
        }
    }
}

static void expect_cube_case(const cube_case *c, unsigned parity, unsigned pattern, bool mirrored) {
    unsigned next = 0;
    for (unsigned t = 0; t < 5; t++) {
        unsigned corners[4];
        split_tetrahedron(parity, t, corners);
        unsigned count = split_triangle_count(split_inside_count(corners, pattern));
        split_edge triangles[2][3] = {{{0, 0}}};
        for (unsigned n = 0; n < count && next < CUBE_TRIANGLES_MAX; n++, next++)
            for (unsigned m = 0; m < 3; m++) triangles[n][m] = ends_of(c->vertices[next][m] % CUBE_EDGES, parity);
        const char *fault = split_fault(corners, pattern, triangles, mirrored);
        EXPECT(!fault, "parity %u, pattern %02x, tetrahedron %u: %s", parity, pattern, t, fault);
    }
    EXPECT(c->triangle_count == next, "parity %u, pattern %02x: %u triangles, not %u", parity, pattern,
           c->triangle_count, next);
}

static void test_cube_cases(void) {
    static cube_case cases[2][2][256];
    EXPECT(sizeof(cube_case) == 32, "the emit kernel reads 32 bytes per case, not %zu", sizeof(cube_case));
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        tetra_cases_derive(cases[mirrored][0], mirrored);
        for (unsigned parity = 0; parity < 2; parity++)
            for (unsigned pattern = 0; pattern < 256; pattern++)
                expect_cube_case(&cases[mirrored][parity][pattern], parity, pattern, mirrored);
    }
    for (unsigned n = 0; n < 512; n++) {
        const cube_case *plain = &cases[0][n / 256][n % 256], *turned = &cases[1][n / 256][n % 256];
        for (unsigned t = 0; t < plain->triangle_count; t++)
            EXPECT(plain->vertices[t][0] == turned->vertices[t][0] && plain->vertices[t][1] == turned->vertices[t][2] &&
                       plain->vertices[t][2] == turned->vertices[t][1],
                   "parity %u, pattern %02x: triangle %u mirrored is not itself turned over", n / 256, n % 256, t);
    }
}

int main(void) {
    random_state = 1996;
    test_split_volumes();
    test_split_covers_once();
    test_split_is_the_documented_one();
    test_neighbours_share_diagonals();
    test_edges_of_a_tetrahedron();
    test_cases_use_the_crossed_edges();
    test_cases_end_in_faces();
    test_cases_wind_outward();
    test_cube_edges();
    test_cube_cases();
    return EXPECT_DONE();
}
