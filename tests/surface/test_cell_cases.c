/*
 * test_cell_cases.c - the triangles of cells that are kept whole, for every shape, against the faces alone
 *
 * All patterns of shapes of up to eight corners, under many numberings, with quadrilaterals cut and with corners in one
 * place; random ones of prisms. Every crossed edge is passed by one border curve of the triangles; the curves' sides
 * are in faces, and on a face with four crossings they do not separate the ends of the diagonal. The triangles are a
 * disc for each curve. No chord lies in a face unless both its edges leave the side of the face's smallest corner,
 * walking counter-clockwise seen from outside: a neighbour, who walks the other way, then has no such chord.
 */
#include "tables/cell_split.h"
#include "expect.h"
#include "tables/cell_cases.h"
#include "random.h"

#include <string.h>

typedef struct subject {
    cell_shape shape;
    int corners;
    uint32_t points[CELL_CORNERS_MAX];
    cell_frame frame;
    unsigned pattern;
} subject;

static bool is_inside(const subject *s, unsigned corner) { return s->pattern >> corner & 1; }

static bool has_edge(const subject *s, int edge, unsigned a, unsigned b) {
    const uint8_t *ends = s->frame.edges[edge];
    return (ends[0] == a && ends[1] == b) || (ends[0] == b && ends[1] == a);
}

static int corner_place(const cell_face *f, unsigned corner) {
    for (int n = 0; n < f->corner_count; n++)
        if (f->corners[n] == corner) return n;
    return -1;
}

/* Whether both ends of an edge are corners of the face. */
static bool face_has(const subject *s, const cell_face *f, int edge) {
    return corner_place(f, s->frame.edges[edge][0]) >= 0 && corner_place(f, s->frame.edges[edge][1]) >= 0;
}

/* Whether a walk around the face leaves by this edge the side of the isovalue that its smallest corner is on. */
static bool is_left(const subject *s, const cell_face *f, int edge) {
    for (int n = 0; n < f->corner_count; n++) {
        const unsigned a = f->corners[n], b = f->corners[(n + 1) % f->corner_count];
        if (has_edge(s, edge, a, b))
            return is_inside(s, a) == is_inside(s, f->corners[0]) && is_inside(s, b) != is_inside(s, a);
    }
    return false;
}

/* Whether a side may run between two edges of a face: within a triangle of its fan, or, where it is a quadrilateral
 * that is not cut, across a diagonal that is crossed. */
static bool is_side(const subject *s, const cell_face *f, bool is_cut, int a, int b) {
    for (int n = 1; n + 1 < f->corner_count; n++) {
        const cell_face t = {3, {f->corners[0], f->corners[n], f->corners[n + 1]}};
        if (face_has(s, &t, a) && face_has(s, &t, b)) return true;
    }
    return f->corner_count == 4 && !is_cut && is_inside(s, f->corners[0]) != is_inside(s, f->corners[2]);
}

static const char *edges_fault(const subject *s, const cell_case *c, int passed[CELL_EDGES_MAX][CELL_EDGES_MAX]) {
    for (int n = 0; n < c->triangle_count; n++)
        for (int m = 0; m < 3; m++) {
            const int a = c->triangles[n][m], b = c->triangles[n][(m + 1) % 3];
            if (a >= s->frame.edge_count || a == b) return "a triangle has no edge of the cell, or one twice";
            if (is_inside(s, s->frame.edges[a][0]) == is_inside(s, s->frame.edges[a][1]))
                return "an edge is not crossed";
            if (passed[a][b]++) return "two triangles pass a side in one direction";
        }
    return NULL;
}

static const char *case_fault(const subject *s) {
    const cell_frame *f = &s->frame;
    int passed[CELL_EDGES_MAX][CELL_EDGES_MAX] = {{0}}, next[CELL_EDGES_MAX], curves = 0, vertices = 0, sides = 0;
    cell_case c;
    cell_case_derive(f, s->pattern, &c);
    const char *fault = edges_fault(s, &c, passed);
    if (fault) return fault;
    for (int a = 0; a < f->edge_count; a++) {
        const bool crossed = is_inside(s, f->edges[a][0]) != is_inside(s, f->edges[a][1]);
        int out = 0;
        next[a] = -1;
        vertices += crossed;
        for (int b = 0; b < f->edge_count; b++) {
            sides += passed[a][b] && (a < b || !passed[b][a]);
            bool may_be_side = false, in_face = false, is_own = false;
            for (int n = 0; n < f->face_count && a != b; n++) {
                const cell_face *face = &f->faces[n];
                if (!face_has(s, face, a) || !face_has(s, face, b)) continue;
                in_face = true;
                may_be_side = may_be_side || is_side(s, face, f->is_cut[n], a, b);
                is_own = is_own || (is_left(s, face, a) && is_left(s, face, b));
            }
            if (passed[a][b] && !passed[b][a]) {
                out++, next[a] = b;
                if (!may_be_side) return "the border has a side that is in no face, or crosses a diagonal";
            }
            if (passed[a][b] && passed[b][a] && in_face && !is_own)
                return "a chord in a face may be the neighbour's too";
        }
        if (out != crossed) return "a crossed edge is not on one border curve";
    }
    for (int a = 0; a < f->edge_count; a++) {
        curves += next[a] >= 0;
        for (int at = a; next[at] >= 0;) {
            const int follower = next[at];
            next[at] = -1, at = follower;
        }
    }
    return vertices - sides + c.triangle_count == curves ? NULL : "the curves do not bound discs";
}

static void points_choose(subject *s, bool collapsed) {
    for (uint32_t n = 0; n < CELL_CORNERS_MAX; n++) s->points[n] = n;
    for (uint32_t n = (uint32_t)s->corners - 1; n > 0; n--) {
        const uint32_t m = random_below(n + 1), point = s->points[n];
        s->points[n] = s->points[m], s->points[m] = point;
    }
    if (collapsed && s->shape == CELL_HEXAHEDRON) { /* to a wedge, or a pyramid */
        const bool pyramid = random_below(2);
        if (pyramid) s->points[5] = s->points[6] = s->points[7] = s->points[4];
        if (!pyramid) s->points[3] = s->points[2], s->points[7] = s->points[6];
    }
}

static void test_shape(cell_shape shape, int corners, int numberings) {
    subject s = {.shape = shape, .corners = corners};
    for (int n = 0; n < numberings; n++) {
        points_choose(&s, n % 4 == 3);
        cell_frame_begin(shape, s.points, random_below(2), &s.frame);
        for (int face = 0; face < s.frame.face_count && n % 2; face++)
            if (s.frame.faces[face].corner_count == 4) s.frame.is_cut[face] = random_below(3) == 0;
        cell_frame_end(&s.frame);
        for (unsigned m = 0; m < 256; m++) {
            s.pattern = corners > 8 ? (unsigned)random_u64() & ((1u << corners) - 1) : m & ((1u << corners) - 1);
            for (int c = 0; c < corners; c++) /* corners in one place have one sign */
                for (int d = 0; d < c; d++)
                    if (s.points[c] == s.points[d]) s.pattern = (s.pattern & ~(1u << c)) | (s.pattern >> d & 1) << c;
            const char *fault = case_fault(&s);
            EXPECT(!fault, "shape %d, numbering %d, pattern %03x: %s", (int)shape, n, s.pattern, fault);
        }
    }
}

int main(void) {
    random_state = 1;
    test_shape(CELL_TETRAHEDRON, 4, 50);
    test_shape(CELL_HEXAHEDRON, 8, 1000);
    test_shape(CELL_WEDGE, 6, 500);
    test_shape(CELL_PYRAMID, 5, 500);
    test_shape(CELL_PENTAGONAL_PRISM, 10, 400);
    test_shape(CELL_HEXAGONAL_PRISM, 12, 400);
    return EXPECT_DONE();
}
