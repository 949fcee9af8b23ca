/*
 * test_hybrid_tables.c - the patches of the hybrid method against the tetrahedra that they stand for
 *
 * Of every pattern, parity and winding: the patch is an oriented surface whose border, in the faces of the cube, joins
 * what the border of the five tetrahedra's surface joins (split.h), whose components have the same crossed edges, and
 * whose components are disks, as theirs are. No chord lies in a face, but in the twelve loops of which all
 * triangulations have one: there it lies in a low face. Chords are as short as they can be, and of equal triangulations
 * the one is taken that all meshes have had so far. All pairs of neighbours fit together. Faults put into the table are
 * found.
 */
#include "expect.h"
#include "random.h"
#include "split.h"
#include "tables/tables.h"
#include "kernels/base/methods.h"

#include <string.h>

/* Vertices are edges of the split, by two corners: 8 a + b, a < b. */
enum { VERTICES = 64, LOOP_MOST = 12 };

#define KNOWN_HASH UINT64_C(0xbf4718eb759c0723)

static unsigned vertex_between(unsigned a, unsigned b) { return a < b ? 8 * a + b : 8 * b + a; }

static unsigned vertex_of_place(unsigned place) {
    const owned_vertex e = cube_edges[place];
    unsigned corner = (unsigned)(e.dx + 2 * e.dy + 4 * e.dz);
    return vertex_between(corner, corner ^ 1u << e.type);
}

static bool is_crossed(unsigned vertex, unsigned pattern) {
    return (pattern >> vertex / 8 ^ pattern >> vertex % 8) & 1;
}

static bool is_cube_edge(unsigned vertex) {
    unsigned axes = vertex / 8 ^ vertex % 8;
    return axes == 1 || axes == 2 || axes == 4;
}

static int middle(unsigned vertex, int axis) { return split_middle((split_edge){vertex / 8, vertex % 8}, axis); }

/* The face that two vertices lie in: axis, plus 3 where it is the high one; 6 where there is none. */
static unsigned common_face(unsigned p, unsigned q) {
    for (int axis = 0; axis < 3; axis++)
        if (middle(p, axis) == middle(q, axis) && middle(p, axis) != 1)
            return (unsigned)(axis + 3 * middle(p, axis) / 2);
    return 6;
}

/* ----------------------------------------------------------------------------------------------- the five's surface */

/* What the surface of the five tetrahedra says of a pattern. */
typedef struct split_surface {
    unsigned char component[VERTICES];           /* of crossed edges, by its lowest one */
    unsigned char bordering[VERTICES][VERTICES]; /* cube edges that its border joins directly, or through a diagonal */
    int euler[VERTICES];                         /* of a component */
} split_surface;

static void component_join(split_surface *s, unsigned p, unsigned q) {
    unsigned from = s->component[p] > s->component[q] ? s->component[p] : s->component[q];
    unsigned to = s->component[p] + s->component[q] - from;
    for (unsigned v = 0; v < VERTICES; v++)
        if (s->component[v] == from) s->component[v] = (unsigned char)to;
}

/* The two crossed edges of a triangle; false where it is not crossed. */
static bool triangle_crossed(const unsigned c[3], unsigned pattern, unsigned vertices[2]) {
    unsigned count = 0;
    for (unsigned n = 0; n < 3; n++) {
        unsigned vertex = vertex_between(c[n], c[(n + 1) % 3]);
        if (is_crossed(vertex, pattern)) vertices[count++] = vertex;
    }
    return count == 2;
}

/* Sides in faces of the cube: through diagonals the border joins cube edges. */
static void border_contract(split_surface *s, unsigned char sides[VERTICES][VERTICES]) {
    for (unsigned p = 0; p < VERTICES; p++)
        for (unsigned q = 0; q < VERTICES; q++) {
            if (!sides[p][q] || !is_cube_edge(p)) continue;
            unsigned before = p, at = q;
            while (!is_cube_edge(at)) {
                unsigned next = 0;
                while (!sides[at][next] || next == before) next++;
                before = at, at = next;
            }
            s->bordering[p][at] = 1;
        }
}

static void split_surface_of(unsigned parity, unsigned pattern, split_surface *s) {
    static unsigned char sides[VERTICES][VERTICES], inner[VERTICES][VERTICES];
    memset(s, 0, sizeof *s), memset(sides, 0, sizeof sides), memset(inner, 0, sizeof inner);
    for (unsigned v = 0; v < VERTICES; v++) s->component[v] = (unsigned char)v;
    for (unsigned t = 0; t < 5; t++) {
        unsigned corners[4] = {0}, side[2] = {0};
        split_tetrahedron(parity, t, corners);
        for (unsigned n = 0; n < 4; n++) {
            const unsigned c[3] = {corners[(n + 1) % 4], corners[(n + 2) % 4], corners[(n + 3) % 4]};
            if (!triangle_crossed(c, pattern, side)) continue;
            component_join(s, side[0], side[1]);
            bool outer = common_face(side[0], side[1]) < 6;
            (outer ? sides : inner)[side[0]][side[1]] = (outer ? sides : inner)[side[1]][side[0]] = 1;
        }
    }
    border_contract(s, sides);
    for (unsigned t = 0; t < 5; t++) { /* faces, less the side that cuts a quadrilateral in two: one in either case */
        unsigned corners[4], any = 0;
        split_tetrahedron(parity, t, corners);
        for (unsigned n = 0; n < 4; n++)
            for (unsigned m = 0; m < n; m++) {
                unsigned vertex = vertex_between(corners[n], corners[m]);
                if (is_crossed(vertex, pattern)) any = vertex;
            }
        if (any) s->euler[s->component[any]]++;
    }
    for (unsigned p = 0; p < VERTICES; p++)
        for (unsigned q = 0; q < p; q++)
            if (sides[p][q] || inner[p][q]) s->euler[s->component[p]]--;
    static unsigned char seen[VERTICES];
    memset(seen, 0, sizeof seen);
    for (unsigned p = 0; p < VERTICES; p++)
        for (unsigned q = 0; q < VERTICES; q++)
            if ((sides[p][q] || inner[p][q]) && !seen[p]) seen[p] = 1, s->euler[s->component[p]]++;
}

/* ---------------------------------------------------------------------------------------------------------- a patch */

typedef struct patch {
    unsigned char passed[VERTICES][VERTICES]; /* how often triangles pass from one vertex to the other */
    bool used[VERTICES];
} patch;

static bool patch_of(const cube_case *c, unsigned pattern, patch *p) {
    memset(p, 0, sizeof *p);
    for (unsigned n = 0; n < c->triangle_count; n++)
        for (unsigned m = 0; m < 3; m++) {
            if (c->vertices[n][m] >= CUBE_EDGES || c->vertices[n][(m + 1) % 3] >= CUBE_EDGES) return false;
            if (cube_edges[c->vertices[n][m]].type > EDGE_Z || cube_edges[c->vertices[n][(m + 1) % 3]].type > EDGE_Z)
                return false;
            unsigned from = vertex_of_place(c->vertices[n][m]), to = vertex_of_place(c->vertices[n][(m + 1) % 3]);
            if (from == to || !is_crossed(from, pattern)) return false;
            p->passed[from][to]++;
            p->used[from] = true;
        }
    return true;
}

/* Whether a side of the border in a face has the inside to its right, seen from outside the cube. */
static bool side_winds(unsigned pattern, unsigned from, unsigned to) {
    unsigned face = common_face(from, to);
    int axis = (int)face % 3, u = (axis + 1) % 3, v = (axis + 2) % 3, sum = 0;
    int along[2] = {middle(to, u) - middle(from, u), middle(to, v) - middle(from, v)};
    for (int end = 0; end < 2; end++) { /* from the corner inside to the one outside */
        unsigned vertex = end ? to : from, a = vertex / 8, b = vertex % 8;
        int sign = pattern >> a & 1 ? 1 : -1;
        int out[2] = {sign * (split_axis(b, u) - split_axis(a, u)), sign * (split_axis(b, v) - split_axis(a, v))};
        sum += along[0] * out[1] - along[1] * out[0];
    }
    return face < 3 ? sum < 0 : sum > 0;
}

/* Sides once, in the faces, where the tetrahedra have them; chords twice, in opposite directions. */
static const char *sides_fault(const patch *p, const split_surface *s, unsigned pattern, bool mirrored) {
    for (unsigned a = 0; a < VERTICES; a++)
        for (unsigned b = 0; b < VERTICES; b++) {
            unsigned there = p->passed[a][b], back = p->passed[b][a];
            if (there > 1) return "an edge is passed twice in one direction";
            if (s->bordering[a][b] && there + back != 1) return "a side that the tetrahedra have is not in the border";
            if (there + back == 1 && !s->bordering[a][b]) return "a side in the border that the tetrahedra have not";
            if (there == 1 && back == 0 && side_winds(pattern, a, b) == mirrored) return "a side winds the wrong way";
        }
    return NULL;
}

static const char *topology_fault(const cube_case *c, const patch *p, const split_surface *s, unsigned pattern) {
    int euler[VERTICES] = {0};
    for (unsigned v = 0; v < VERTICES; v++) {
        bool should = is_cube_edge(v) && v / 8 < v % 8 && is_crossed(v, pattern);
        if (should != p->used[v]) return should ? "a crossed edge is not used" : "an edge that is not crossed is used";
        if (p->used[v]) euler[s->component[v]]++;
    }
    for (unsigned a = 0; a < VERTICES; a++)
        for (unsigned b = 0; b < a; b++) {
            if (!p->passed[a][b] && !p->passed[b][a]) continue;
            if (s->component[a] != s->component[b]) return "two components of the tetrahedra's surface are joined";
            euler[s->component[a]]--;
        }
    for (unsigned n = 0; n < c->triangle_count; n++) euler[s->component[vertex_of_place(c->vertices[n][0])]]++;
    for (unsigned v = 0; v < VERTICES; v++) {
        if (euler[v] != s->euler[v]) return "a component has another Euler characteristic than the tetrahedra's";
        if (euler[v] != 0 && euler[v] != 1) return "a component is no disk";
    }
    return NULL;
}

/* Chords that lie in a face of the cube; those in high ones. */
static void chords_count(const patch *p, unsigned *in_faces, unsigned *in_high) {
    *in_faces = *in_high = 0;
    for (unsigned a = 0; a < VERTICES; a++)
        for (unsigned b = 0; b < a; b++) {
            if (!p->passed[a][b] || !p->passed[b][a] || common_face(a, b) == 6) continue;
            ++*in_faces;
            *in_high += common_face(a, b) >= 3;
        }
}

/* What a chord costs, of the costs that triangulations are compared by. */
typedef unsigned chord_cost(unsigned p, unsigned q);

static unsigned cost_in_face(unsigned p, unsigned q) { return common_face(p, q) < 6; }

/* Squared length, of chords in faces far more than of any others. */
static unsigned cost_of_length(unsigned p, unsigned q) {
    unsigned face = common_face(p, q), cost = face == 6 ? 0 : face < 3 ? 1000 : 1000000;
    for (int axis = 0; axis < 3; axis++) {
        int difference = middle(p, axis) - middle(q, axis);
        cost += (unsigned)(difference * difference);
    }
    return cost;
}

/* The least that a triangulation of vertices first to last of a loop can have. */
static unsigned chords_least(const unsigned *vertices, unsigned first, unsigned last, unsigned count,
                             chord_cost *cost) {
    unsigned least = last - first < 2 ? 0 : ~0u;
    for (unsigned apex = first + 1; apex < last; apex++) {
        unsigned chords =
            chords_least(vertices, first, apex, count, cost) + chords_least(vertices, apex, last, count, cost);
        if (chords < least) least = chords;
    }
    bool side = last - first == 1 || last - first == count - 1;
    return least + (side ? 0 : cost(vertices[first], vertices[last]));
}

/* The same of a whole pattern; *longest: its longest loop. */
static unsigned chords_needed(const split_surface *s, chord_cost *cost, unsigned *longest) {
    bool seen[VERTICES] = {false};
    unsigned needed = 0;
    *longest = 0;
    for (unsigned start = 0; start < VERTICES; start++) {
        unsigned loop[VERTICES], count = 0, at = start, next = start;
        while (next < VERTICES && !seen[next]) {
            at = next;
            seen[at] = true;
            loop[count++] = at;
            for (next = 0; next < VERTICES && (!s->bordering[at][next] || seen[next]);) next++;
        }
        if (count > 2) needed += chords_least(loop, 0, count - 1, count, cost);
        if (count > *longest) *longest = count;
    }
    return needed;
}

#define MOST(name, types, most, usual) most,
static const unsigned triangles_most[] = {METHODS(MOST)}; /* as kernel 2 copies them */

static const char *case_fault(const cube_case *c, unsigned parity, unsigned pattern, bool mirrored) {
    static split_surface s;
    static patch p;
    unsigned in_faces, in_high, longest;
    if (c->triangle_count > triangles_most[method_hybrid]) return "there are more triangles than kernel 2 copies";
    split_surface_of(parity, pattern, &s);
    if (!patch_of(c, pattern, &p)) return "a corner is on no crossed edge of the cube";
    const char *fault = sides_fault(&p, &s, pattern, mirrored);
    if (!fault) fault = topology_fault(c, &p, &s, pattern);
    if (fault) return fault;
    chords_count(&p, &in_faces, &in_high);
    if (in_high) return "a chord lies in a high face";
    return in_faces != chords_needed(&s, cost_in_face, &longest) ? "a chord lies in a face without need" : NULL;
}

static cube_case cases[2][2][256]; /* [mirrored] */

static void test_cases(void) {
    unsigned loops_with_chord = 0;
    for (unsigned n = 0; n < 2 * 2 * 256; n++) {
        unsigned mirrored = n / 512, parity = n / 256 % 2, pattern = n % 256, longest;
        const char *fault = case_fault(&cases[mirrored][parity][pattern], parity, pattern, mirrored);
        EXPECT(!fault, "parity %u, pattern %02x, mirrored %u: %s", parity, pattern, mirrored, fault);
        split_surface s;
        split_surface_of(parity, pattern, &s);
        if (mirrored || !chords_needed(&s, cost_in_face, &longest)) continue;
        loops_with_chord++;
        EXPECT(longest == 8 && chords_needed(&s, cost_in_face, &longest) == 1,
               "parity %u, pattern %02x: a loop of %u needs chords", parity, pattern, longest);
    }
    EXPECT(loops_with_chord == 12, "%u loops need a chord in a face", loops_with_chord);
}

static void test_chords_are_short(void) {
    static split_surface s;
    static patch p;
    for (unsigned n = 0; n < 512; n++) {
        unsigned is = 0, longest;
        split_surface_of(n / 256, n % 256, &s);
        patch_of(&cases[0][n / 256][n % 256], n % 256, &p);
        for (unsigned a = 0; a < VERTICES; a++)
            for (unsigned b = 0; b < a; b++)
                if (p.passed[a][b] && p.passed[b][a]) is += cost_of_length(a, b);
        unsigned should = chords_needed(&s, cost_of_length, &longest);
        EXPECT(is == should, "parity %u, pattern %02x: chords come to %u, not %u", n / 256, n % 256, is, should);
    }
}

/* The order of triangles and which of equal triangulations is taken show in every mesh: FNV-1a of both tables. */
static void test_tables_are_the_known_ones(void) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (unsigned n = 0; n < 512; n++) {
        const cube_case *c = &cases[0][n / 256][n % 256];
        for (unsigned m = 0; m < 3u * c->triangle_count; m++)
            hash = (hash ^ c->vertices[m / 3][m % 3]) * 0x100000001b3u;
    }
    EXPECT(hash == KNOWN_HASH, "the tables have hash %llx", (unsigned long long)hash);
}

static void test_mirrored(void) {
    for (unsigned n = 0; n < 512; n++) {
        const cube_case *plain = &cases[0][n / 256][n % 256], *turned = &cases[1][n / 256][n % 256];
        EXPECT(plain->triangle_count == turned->triangle_count, "case %u has other triangles where mirrored", n);
        for (unsigned t = 0; t < plain->triangle_count; t++)
            EXPECT(plain->vertices[t][0] == turned->vertices[t][0] && plain->vertices[t][1] == turned->vertices[t][2] &&
                       plain->vertices[t][2] == turned->vertices[t][1],
                   "case %u: triangle %u mirrored is not itself turned over", n, t);
    }
}

/* ------------------------------------------------------------------------------------------------------- neighbours */

/* Vertices of two cubes that follow each other along an axis, by the place of the edge in the first cube's terms. */
enum { PAIR_VERTICES = 3 * 27 };

static unsigned pair_vertex(unsigned place, unsigned axis, unsigned second) {
    const owned_vertex e = cube_edges[place];
    unsigned at[3] = {e.dx, e.dy, e.dz};
    at[axis] += second;
    return 3 * (at[0] + 3 * at[1] + 9 * at[2]) + e.type;
}

/* Whether an edge of the mesh lies in the outer faces of the pair: the middles of its ends have a coordinate in common,
 * at 0 or, doubled, at the far end. */
static bool pair_outer(unsigned p, unsigned q, unsigned axis) {
    for (unsigned n = 0, step = 3; n < 3; n++, step *= 3) {
        unsigned a = 2 * (p / step % 3) + (p % 3 == n), b = 2 * (q / step % 3) + (q % 3 == n);
        if (a == b && (a == 0 || a == (n == axis ? 4u : 2u))) return true;
    }
    return false;
}

/* Signs of 12 samples: x fastest, 3 of them along the axis. */
static unsigned pair_pattern(unsigned signs, unsigned axis, unsigned second) {
    unsigned pattern = 0;
    for (unsigned c = 0; c < 8; c++) {
        unsigned along = (c >> axis & 1) + second, u = c >> (axis + 1) % 3 & 1, v = c >> (axis + 2) % 3 & 1;
        pattern |= (signs >> (along + 3 * u + 6 * v) & 1) << c;
    }
    return pattern;
}

static const char *pair_fault(const cube_case table[2][256], unsigned axis, unsigned parity, unsigned signs) {
    static unsigned char passed[PAIR_VERTICES][PAIR_VERTICES];
    memset(passed, 0, sizeof passed);
    for (unsigned second = 0; second < 2; second++) {
        const cube_case *c = &table[parity ^ second][pair_pattern(signs, axis, second)];
        for (unsigned n = 0; n < c->triangle_count; n++)
            for (unsigned m = 0; m < 3; m++)
                passed[pair_vertex(c->vertices[n][m], axis, second)]
                      [pair_vertex(c->vertices[n][(m + 1) % 3], axis, second)]++;
    }
    for (unsigned p = 0; p < PAIR_VERTICES; p++)
        for (unsigned q = 0; q < p; q++) {
            unsigned there = passed[p][q], back = passed[q][p];
            if (there > 1 || back > 1) return "an edge is passed twice in one direction";
            if (there != back && !pair_outer(p, q, axis)) return "there is a crack between the cubes";
        }
    return NULL;
}

static void test_pairs(void) {
    for (unsigned n = 0; n < 2 * 3 * 2 * 4096; n++) {
        unsigned mirrored = n / 24576, axis = n / 8192 % 3, parity = n / 4096 % 2, signs = n % 4096;
        const char *fault = pair_fault((const cube_case(*)[256])cases[mirrored], axis, parity, signs);
        EXPECT(!fault, "axis %u, parity %u, signs %03x: %s", axis, parity, signs, fault);
    }
}

/* ----------------------------------------------------------------------------------------------------------- faults */

/* A triangle less, a corner moved to any other edge, a triangle turned over, a quadrilateral cut in both ways. */
static void test_faults_are_found(void) {
    for (unsigned n = 0; n < 512; n++) {
        unsigned parity = n / 256, pattern = n % 256;
        cube_case c = cases[0][parity][pattern];
        if (c.triangle_count == 0) continue;
        c.triangle_count--;
        EXPECT(case_fault(&c, parity, pattern, false), "case %u: a missing triangle is not found", n);
        c.triangle_count++;
        for (unsigned t = 0; t < c.triangle_count; t++) {
            for (unsigned place = 0; place < CUBE_EDGES; place++) {
                uint8_t *corner = &c.vertices[t][random_below(3)], old = *corner;
                if (place == old) continue;
                *corner = (uint8_t)place;
                EXPECT(case_fault(&c, parity, pattern, false), "case %u: triangle %u with edge %u for %u is not found",
                       n, t, place, old);
                *corner = old;
            }
            uint8_t first = c.vertices[t][0];
            c.vertices[t][0] = c.vertices[t][1], c.vertices[t][1] = first;
            EXPECT(case_fault(&c, parity, pattern, false), "case %u: triangle %u turned over is not found", n, t);
            c.vertices[t][1] = c.vertices[t][0], c.vertices[t][0] = first;
        }
    }
}

/* A cube that is cut by the other parity's diagonals does not fit to its neighbours. */
static void test_wrong_parity_is_found(void) {
    unsigned found = 0;
    static cube_case wrong[2][256];
    memcpy(wrong[0], cases[0][0], sizeof wrong[0]);
    memcpy(wrong[1], cases[0][0], sizeof wrong[1]);
    for (unsigned n = 0; n < 3 * 4096; n++)
        found += pair_fault((const cube_case(*)[256])wrong, n / 4096, 0, n % 4096) != 0;
    EXPECT(found >= 3 * 2 * 256, "only %u of the pairs with an ambiguous face between them do not fit", found);
}

int main(void) {
    random_state = 1996;
    for (int mirrored = 0; mirrored < 2; mirrored++) hybrid_cases_derive(cases[mirrored][0], mirrored);
    test_cases();
    test_chords_are_short();
    test_tables_are_the_known_ones();
    test_mirrored();
    test_pairs();
    test_faults_are_found();
    test_wrong_parity_is_found();
    return EXPECT_DONE();
}
