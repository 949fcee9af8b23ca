#include "tables/cell_split.h"

#include <string.h>

/* clang-format off */
#define HEXAHEDRON {0, 1, 2, 3, 4, 5, 6, 7}
#define VOXEL      {0, 1, 3, 2, 4, 5, 7, 6}
#define WEDGE      {0, 2, 1, 3, 5, 4}
#define WEDGE_UP   {0, 1, 2, 3, 4, 5} /* VTK turns its curved wedges the other way round */
#define PRISM_5    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}
#define PRISM_6    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}

static const cell_type types[] = {
    [0] = {"empty cell", CELL_FLAT, 0, 0, false, {0}},
    [1] = {"vertex", CELL_FLAT, 0, 0, false, {0}},
    [2] = {"poly-vertex", CELL_FLAT, 0, 0, false, {0}},
    [3] = {"line", CELL_FLAT, 0, 0, false, {0}},
    [4] = {"poly-line", CELL_FLAT, 0, 0, false, {0}},
    [5] = {"triangle", CELL_FLAT, 0, 0, false, {0}},
    [6] = {"triangle strip", CELL_FLAT, 0, 0, false, {0}},
    [7] = {"polygon", CELL_FLAT, 0, 0, false, {0}},
    [8] = {"pixel", CELL_FLAT, 0, 0, false, {0}},
    [9] = {"quadrilateral", CELL_FLAT, 0, 0, false, {0}},
    [10] = {"tetrahedron", CELL_TETRAHEDRON, 4, 4, false, {0, 1, 2, 3}},
    [11] = {"voxel", CELL_HEXAHEDRON, 8, 8, false, VOXEL},
    [12] = {"hexahedron", CELL_HEXAHEDRON, 8, 8, false, HEXAHEDRON},
    [13] = {"wedge", CELL_WEDGE, 6, 6, false, WEDGE},
    [14] = {"pyramid", CELL_PYRAMID, 5, 5, false, {0, 1, 2, 3, 4}},
    [15] = {"pentagonal prism", CELL_PENTAGONAL_PRISM, 10, 10, false, PRISM_5},
    [16] = {"hexagonal prism", CELL_HEXAGONAL_PRISM, 12, 12, false, PRISM_6},
    [21] = {"quadratic edge", CELL_FLAT, 0, 0, true, {0}},
    [22] = {"quadratic triangle", CELL_FLAT, 0, 0, true, {0}},
    [23] = {"quadratic quadrilateral", CELL_FLAT, 0, 0, true, {0}},
    [24] = {"quadratic tetrahedron", CELL_TETRAHEDRON, 4, 10, true, {0, 1, 2, 3}},
    [25] = {"quadratic hexahedron", CELL_HEXAHEDRON, 8, 20, true, HEXAHEDRON},
    [26] = {"quadratic wedge", CELL_WEDGE, 6, 15, true, WEDGE_UP},
    [27] = {"quadratic pyramid", CELL_PYRAMID, 5, 13, true, {0, 1, 2, 3, 4}},
    [28] = {"biquadratic quadrilateral", CELL_FLAT, 0, 0, true, {0}},
    [29] = {"triquadratic hexahedron", CELL_HEXAHEDRON, 8, 27, true, HEXAHEDRON},
    [30] = {"quadratic linear quadrilateral", CELL_FLAT, 0, 0, true, {0}},
    [31] = {"quadratic linear wedge", CELL_WEDGE, 6, 12, true, WEDGE_UP},
    [32] = {"biquadratic quadratic wedge", CELL_WEDGE, 6, 18, true, WEDGE_UP},
    [33] = {"biquadratic quadratic hexahedron", CELL_HEXAHEDRON, 8, 24, true, HEXAHEDRON},
    [34] = {"biquadratic triangle", CELL_FLAT, 0, 0, true, {0}},
    [35] = {"cubic line", CELL_FLAT, 0, 0, true, {0}},
    [36] = {"quadratic polygon", CELL_FLAT, 0, 0, true, {0}},
    [37] = {"triquadratic pyramid", CELL_PYRAMID, 5, 19, true, {0, 1, 2, 3, 4}},
    [41] = {"convex point set", CELL_OTHER, 0, 0, false, {0}},
    [42] = {"polyhedron", CELL_POLYHEDRON, 0, 0, false, {0}},
    [68] = {"Lagrange curve", CELL_FLAT, 0, 0, true, {0}},
    [69] = {"Lagrange triangle", CELL_FLAT, 0, 0, true, {0}},
    [70] = {"Lagrange quadrilateral", CELL_FLAT, 0, 0, true, {0}},
    [71] = {"Lagrange tetrahedron", CELL_TETRAHEDRON, 4, 0, true, {0, 1, 2, 3}},
    [72] = {"Lagrange hexahedron", CELL_HEXAHEDRON, 8, 0, true, HEXAHEDRON},
    [73] = {"Lagrange wedge", CELL_WEDGE, 6, 0, true, WEDGE_UP},
    [74] = {"Lagrange pyramid", CELL_PYRAMID, 5, 0, true, {0, 1, 2, 3, 4}},
    [75] = {"Bezier curve", CELL_FLAT, 0, 0, true, {0}},
    [76] = {"Bezier triangle", CELL_FLAT, 0, 0, true, {0}},
    [77] = {"Bezier quadrilateral", CELL_FLAT, 0, 0, true, {0}},
    [78] = {"Bezier tetrahedron", CELL_TETRAHEDRON, 4, 0, true, {0, 1, 2, 3}},
    [79] = {"Bezier hexahedron", CELL_HEXAHEDRON, 8, 0, true, HEXAHEDRON},
    [80] = {"Bezier wedge", CELL_WEDGE, 6, 0, true, WEDGE_UP},
    [81] = {"Bezier pyramid", CELL_PYRAMID, 5, 0, true, {0, 1, 2, 3, 4}},
};

static const uint8_t hexahedron_faces[6][4] = {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4},
                                               {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}};
static const uint8_t wedge_faces[3][4] = {{0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
static const uint8_t wedge_ends[2][3] = {{0, 2, 1}, {3, 4, 5}};
static const uint8_t pyramid_base[4] = {0, 3, 2, 1};
static const uint8_t pyramid_sides[4][3] = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
static const uint8_t tetrahedron_faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
static const uint8_t hexahedron_opposite[8] = {6, 7, 4, 5, 2, 3, 0, 1};
/* clang-format on */

const cell_type *cell_type_get(unsigned vtk_type) {
    static const cell_type unknown = {NULL, CELL_OTHER, 0, 0, false, {0}};
    bool known = vtk_type < sizeof types / sizeof *types && types[vtk_type].name;
    return known ? &types[vtk_type] : &unknown;
}

typedef struct splitting {
    const uint32_t *points;
    uint32_t (*out)[4];
    int count;
} splitting;

static void tetrahedron_add(splitting *s, int a, int b, int c, int d) {
    const uint32_t *p = s->points, v[4] = {p[a], p[b], p[c], p[d]};
    if (v[0] == v[1] || v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3] || v[2] == v[3]) return;
    memcpy(s->out[s->count++], v, sizeof v);
}

static int smallest_corner(const uint32_t *points, int count) {
    int smallest = 0;
    for (int n = 1; n < count; n++)
        if (points[n] < points[smallest]) smallest = n;
    return smallest;
}

static bool face_has(const uint8_t *face, int corner_count, int corner) {
    return memchr(face, corner, (size_t)corner_count) != NULL;
}

/* Which corner of a face is its smallest: the first of them. */
static int smallest_of_face(const uint32_t *points, const uint8_t *face, int corner_count) {
    int first = 0;
    for (int n = 1; n < corner_count; n++)
        if (points[face[n]] < points[face[first]]) first = n;
    return first;
}

/* The face's corners from its smallest on: the diagonal joins the first and the third. */
static void face_turn(const uint32_t *points, const uint8_t face[4], uint8_t turned[4]) {
    const int first = smallest_of_face(points, face, 4);
    for (int n = 0; n < 4; n++) turned[n] = face[(first + n) % 4];
}

static void face_cone(splitting *s, int apex, const uint8_t face[4]) {
    uint8_t f[4];
    face_turn(s->points, face, f);
    tetrahedron_add(s, apex, f[0], f[1], f[2]);
    tetrahedron_add(s, apex, f[0], f[2], f[3]);
}

/* Where none of the three far diagonals meets the far corner, they form a triangle that cuts this corner off. */
static void hexahedron_split_5(splitting *s, int apex, uint8_t faces[3][4]) {
    const int far = hexahedron_opposite[apex];
    uint8_t cut[3] = {0}; /* a face's triangle at the far corner, which is in the middle */
    int third = 0;
    for (int n = 0; n < 3; n++) {
        const uint8_t *f = faces[n];
        bool far_first = f[1] == far;
        tetrahedron_add(s, apex, f[0], far_first ? f[2] : f[1], far_first ? f[3] : f[2]);
        const uint8_t at_far[3] = {far_first ? f[0] : f[2], (uint8_t)far, far_first ? f[2] : f[0]};
        if (n == 0) memcpy(cut, at_far, sizeof cut);
        if (n == 1) third = face_has(cut, 3, at_far[0]) ? at_far[2] : at_far[0];
    }
    tetrahedron_add(s, apex, third, cut[2], cut[0]);
    tetrahedron_add(s, third, cut[0], far, cut[2]);
}

static void hexahedron_split(splitting *s) {
    const int apex = smallest_corner(s->points, 8), far = hexahedron_opposite[apex];
    uint8_t faces[3][4];
    int face_count = 0, meeting = 0;
    for (int n = 0; n < 6; n++) {
        if (face_has(hexahedron_faces[n], 4, apex)) continue;
        face_turn(s->points, hexahedron_faces[n], faces[face_count]);
        meeting += faces[face_count][0] == far || faces[face_count][2] == far;
        face_count++;
    }
    if (meeting)
        for (int n = 0; n < 3; n++) face_cone(s, apex, faces[n]);
    else
        hexahedron_split_5(s, apex, faces);
}

static void wedge_split(splitting *s) {
    const int apex = smallest_corner(s->points, 6);
    for (int n = 0; n < 3; n++)
        if (!face_has(wedge_faces[n], 4, apex)) face_cone(s, apex, wedge_faces[n]);
    const uint8_t *end = wedge_ends[apex < 3];
    tetrahedron_add(s, apex, end[0], end[1], end[2]);
}

/* A face as a fan around its smallest corner, coned from the apex unless that is one of its corners. */
static void fan_cone(splitting *s, int apex, const uint8_t *face, int corner_count) {
    const int first = smallest_of_face(s->points, face, corner_count);
    if (face_has(face, corner_count, apex)) return;
    for (int n = 1; n + 1 < corner_count; n++)
        tetrahedron_add(s, apex, face[first], face[(first + n) % corner_count], face[(first + n + 1) % corner_count]);
}

typedef struct prism {
    uint8_t sides[CELL_CORNERS_MAX / 2][4], ends[2][CELL_CORNERS_MAX / 2]; /* bottom, top */
} prism;

/* Corners 0 to sides - 1 wind around the bottom, the next around the top, each above its like. */
static prism prism_of(int sides) {
    prism p = {0};
    for (int n = 0; n < sides; n++) {
        const int next = (n + 1) % sides;
        const uint8_t side[4] = {(uint8_t)n, (uint8_t)next, (uint8_t)(sides + next), (uint8_t)(sides + n)};
        memcpy(p.sides[n], side, sizeof side);
        p.ends[0][n] = (uint8_t)(sides - 1 - n);
        p.ends[1][n] = (uint8_t)(sides + n);
    }
    return p;
}

static void prism_split(splitting *s, int sides) {
    const int apex = smallest_corner(s->points, 2 * sides);
    const prism p = prism_of(sides);
    for (int n = 0; n < sides; n++) fan_cone(s, apex, p.sides[n], 4);
    for (int end = 0; end < 2; end++) fan_cone(s, apex, p.ends[end], sides);
}

int cell_split(cell_shape shape, const uint32_t points[CELL_CORNERS_MAX], uint32_t out[CELL_TETRAHEDRA_MAX][4]) {
    splitting s = {points, out, 0};
    switch (shape) {
    case CELL_TETRAHEDRON:
        tetrahedron_add(&s, 0, 1, 2, 3);
        break;
    case CELL_HEXAHEDRON:
        hexahedron_split(&s);
        break;
    case CELL_WEDGE:
        wedge_split(&s);
        break;
    case CELL_PYRAMID:
        face_cone(&s, 4, pyramid_base);
        break;
    case CELL_PENTAGONAL_PRISM:
        prism_split(&s, 5);
        break;
    case CELL_HEXAGONAL_PRISM:
        prism_split(&s, 6);
        break;
    default:
        break;
    }
    return s.count;
}

/* ------------------------------------------------------------------------------------------------------------ faces */

typedef struct face_list {
    const uint32_t *points;
    cell_face *faces;
    int count;
} face_list;

static void face_put(face_list *l, const uint8_t *corners, int corner_count) {
    cell_face *f = &l->faces[l->count++];
    const int first = smallest_of_face(l->points, corners, corner_count);
    f->corner_count = (uint8_t)corner_count;
    for (int n = 0; n < corner_count; n++) f->corners[n] = corners[(first + n) % corner_count];
}

static void prism_faces(face_list *l, int sides) {
    const prism p = prism_of(sides);
    for (int n = 0; n < sides; n++) face_put(l, p.sides[n], 4);
    for (int end = 0; end < 2; end++) face_put(l, p.ends[end], sides);
}

int cell_faces(cell_shape shape, const uint32_t points[CELL_CORNERS_MAX], cell_face faces[CELL_FACES_MAX]) {
    face_list l = {points, faces, 0};
    switch (shape) {
    case CELL_TETRAHEDRON:
        for (int n = 0; n < 4; n++) face_put(&l, tetrahedron_faces[n], 3);
        break;
    case CELL_HEXAHEDRON:
        for (int n = 0; n < 6; n++) face_put(&l, hexahedron_faces[n], 4);
        break;
    case CELL_WEDGE:
        for (int n = 0; n < 3; n++) face_put(&l, wedge_faces[n], 4);
        for (int n = 0; n < 2; n++) face_put(&l, wedge_ends[n], 3);
        break;
    case CELL_PYRAMID:
        face_put(&l, pyramid_base, 4);
        for (int n = 0; n < 4; n++) face_put(&l, pyramid_sides[n], 3);
        break;
    case CELL_PENTAGONAL_PRISM:
        prism_faces(&l, 5);
        break;
    case CELL_HEXAGONAL_PRISM:
        prism_faces(&l, 6);
        break;
    default:
        break;
    }
    return l.count;
}
