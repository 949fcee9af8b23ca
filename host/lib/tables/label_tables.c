#include "tables/label_tables.h"

#include <string.h>

/* -------------------------------------------------------------------------------------------------------- vertices */

static void position_add(label_tables *t, unsigned parity, unsigned type, unsigned corners, unsigned low) {
    label_corners *to = &t->corners[parity][type];
    *to = (label_corners){0};
    float sum[3] = {0, 0, 0};
    for (unsigned c = 0; c < 8; c++) {
        if (!(corners >> c & 1)) continue;
        to->corners[to->count++] = (uint8_t)(c - low);
        for (unsigned axis = 0; axis < 3; axis++) sum[axis] += (float)((c - low) >> axis & 1);
    }
    for (unsigned axis = 0; axis < 3; axis++) t->offsets[parity][type][axis] = sum[axis] / (float)to->count;
}

/* corners: some of the cube's, a bit each. If one face of the cube has them all: its lowest corner, and its two axes as
 * bits. Else false. */
static bool cube_face_of(unsigned corners, unsigned *low, unsigned *axes) {
    unsigned all = 7, any = 0;
    for (unsigned c = 0; c < 8; c++)
        if (corners >> c & 1) all &= c, any |= c;
    *low = all;
    *axes = any ^ all;
    return *axes != 7;
}

/* Of the two triangles of a square, the first has the first of the corners that its diagonal does not join. */
static unsigned half_of(unsigned corners, unsigned low, unsigned axes, unsigned diagonal) {
    for (unsigned c = 0; c < 8; c++)
        if ((c & ~axes & 7) == low && !(diagonal >> c & 1)) return !(corners >> c & 1);
    return 0;
}

/* The owner of the vertex on a face of a tetrahedron: half of a face of the cube, or one that lies within the cube and
 * then has the number inner. */
static owned_vertex face_owner(unsigned parity, unsigned corners, unsigned inner) {
    unsigned low, axes, diagonal = 0;
    if (!cube_face_of(corners, &low, &axes)) return (owned_vertex){0, 0, 0, (uint8_t)(LABEL_TYPE_INNER + inner)};
    for (unsigned n = 0; n < 4; n++) diagonal |= 1u << tetrahedron_corners[parity][0][n];
    const unsigned half = half_of(corners, low, axes, diagonal), plane = axes == 3 ? 0 : axes == 5 ? 1 : 2;
    return (owned_vertex){low & 1, low >> 1 & 1, (uint8_t)(low >> 2), (uint8_t)(LABEL_TYPE_FACES + 2 * plane + half)};
}

/* Within the cube are the faces of its middle tetrahedron. The one beside the tetrahedron at a corner is that which
 * does not have the corner across the cube. */
static unsigned middle_face(unsigned parity, unsigned corner) {
    unsigned n = 0;
    while (tetrahedron_corners[parity][0][n] != (corner ^ 7)) n++;
    return n;
}

/* The position of a type, as corners of the cube at its owner: known where a tetrahedron of that cube has it. */
static void vertex_locate(label_tables *t, unsigned parity, owned_vertex owner, unsigned corners) {
    if (!owner.dx && !owner.dy && !owner.dz) position_add(t, parity, owner.type, corners, 0);
}

/* Edges and faces at x + 1, y + 1 or z + 1 are those of the next cube, which finds them at its own first sample. */
static void vertices_derive(label_tables *t, unsigned parity, unsigned tetrahedron) {
    const uint8_t *corners = tetrahedron_corners[parity][tetrahedron];
    owned_vertex *owners = t->owners[parity][tetrahedron];
    unsigned all = 0;
    for (unsigned n = 0; n < 4; n++) all |= 1u << corners[n];
    for (unsigned e = 0; e < 6; e++) {
        const unsigned a = corners[tetrahedron_edges[e][0]], b = corners[tetrahedron_edges[e][1]];
        owners[LABEL_EDGE + e] = edge_between(a, b);
        vertex_locate(t, parity, owners[LABEL_EDGE + e], 1u << a | 1u << b);
    }
    for (unsigned n = 0; n < 4; n++) {
        const unsigned face = all & ~(1u << corners[n]);
        const unsigned inner = tetrahedron ? middle_face(parity, corners[0]) : n;
        owners[LABEL_FACE + n] = face_owner(parity, face, inner);
        vertex_locate(t, parity, owners[LABEL_FACE + n], face);
    }
    owners[LABEL_CELL] = (owned_vertex){0, 0, 0, (uint8_t)(LABEL_TYPE_CELLS + tetrahedron)};
    vertex_locate(t, parity, owners[LABEL_CELL], all);
}

/* ------------------------------------------------------------------------------------------------------- triangles */

static unsigned edge_of(unsigned a, unsigned b) {
    for (unsigned e = 0; e < 6; e++)
        if ((tetrahedron_edges[e][0] == a && tetrahedron_edges[e][1] == b) ||
            (tetrahedron_edges[e][0] == b && tetrahedron_edges[e][1] == a))
            return e;
    return 0;
}

static bool differ(unsigned pattern, unsigned a, unsigned b) { return a != b && pattern >> edge_of(a, b) & 1; }

static unsigned part_of(unsigned pattern, unsigned corner) {
    unsigned part = 0;
    for (unsigned n = 0; n < 4; n++) part |= (unsigned)!differ(pattern, corner, n) << n;
    return part;
}

/* Whether corners that are equal to one are equal to each other. */
static bool is_partition(unsigned pattern) {
    for (unsigned a = 0; a < 4; a++)
        for (unsigned b = 0; b < 4; b++)
            if (!differ(pattern, a, b) && part_of(pattern, a) != part_of(pattern, b)) return false;
    return true;
}

/* The corners as points, in the order of tables.h; all vertices are means of some of them. */
static const int corner_positions[4][3] = {{0, 0, 0}, {12, 0, 0}, {0, 12, 0}, {0, 0, 12}};

static void vertex_position(unsigned vertex, int out[3]) {
    for (unsigned axis = 0; axis < 3; axis++) {
        int sum = 0, all = 0;
        for (unsigned n = 0; n < 4; n++) all += corner_positions[n][axis];
        if (vertex == LABEL_CELL)
            sum = all / 4;
        else if (vertex >= LABEL_FACE)
            sum = (all - corner_positions[vertex - LABEL_FACE][axis]) / 3;
        else
            sum = (corner_positions[tetrahedron_edges[vertex][0]][axis] +
                   corner_positions[tetrahedron_edges[vertex][1]][axis]) /
                  2;
        out[axis] = sum;
    }
}

/* Whether the interface winds counter-clockwise seen from its outer corner's side. */
static bool faces_outer(const label_interface *i) {
    int p[3][3], u[3], v[3], across = 0;
    for (unsigned n = 0; n < 3; n++) vertex_position(i->vertices[n], p[n]);
    for (unsigned axis = 0; axis < 3; axis++) u[axis] = p[1][axis] - p[0][axis], v[axis] = p[2][axis] - p[0][axis];
    for (unsigned axis = 0; axis < 3; axis++) {
        const unsigned y = (axis + 1) % 3, z = (axis + 2) % 3;
        across += (u[y] * v[z] - u[z] * v[y]) * (corner_positions[i->outer][axis] - corner_positions[i->inner][axis]);
    }
    return across > 0;
}

/* Two parts: the surface of the first corner's. */
static void separate_two(label_case *c, unsigned part) {
    const tetrahedron_case *from = &tetrahedron_cases[part];
    label_interface *to = &c->interfaces[c->interface_count++];
    while (part >> to->outer & 1) to->outer++;
    to->vertex_count = (uint8_t)(from->triangle_count + 2);
    memcpy(to->vertices, from->triangles[0], 3);
    to->vertices[3] = from->triangles[1][2];
}

static void turn_over(label_interface *i) {
    const unsigned last = i->vertex_count - 1u;
    const uint8_t vertex = i->vertices[1];
    i->vertices[1] = i->vertices[last];
    i->vertices[last] = vertex;
}

/* The interface between the parts of two corners, where there are more parts. */
static void separate(label_case *c, unsigned pattern, unsigned a, unsigned b) {
    label_interface *to = &c->interfaces[c->interface_count++];
    unsigned others[2], count = 0, twin = 4; /* a corner that is like a or b */
    for (unsigned n = 0; n < 4; n++) {
        if (n == a || n == b) continue;
        others[count++] = n;
        if (!differ(pattern, n, a) || !differ(pattern, n, b)) twin = n;
    }
    *to = (label_interface){.inner = (uint8_t)a, .outer = (uint8_t)b, .vertex_count = 4};
    to->vertices[0] = (uint8_t)edge_of(a, b);
    if (twin < 4) { /* from one edge to the other, and back between the two faces that the third part touches */
        const unsigned like = differ(pattern, twin, a) ? b : a, single = like == a ? b : a;
        to->vertices[1] = (uint8_t)edge_of(twin, single);
        to->vertices[2] = (uint8_t)(LABEL_FACE + like);
        to->vertices[3] = (uint8_t)(LABEL_FACE + twin);
    } else { /* the faces on either side of the edge, and between them the cell's vertex, where that is */
        to->vertices[1] = (uint8_t)(LABEL_FACE + others[0]);
        to->vertices[2] = LABEL_CELL;
        to->vertices[3] = (uint8_t)(LABEL_FACE + others[1]);
        if (!differ(pattern, others[0], others[1])) {
            to->vertices[2] = to->vertices[3];
            to->vertex_count = 3;
        }
    }
    if (!faces_outer(to)) turn_over(to);
}

/* Whether an edge before this one is between the same parts. */
static bool is_separated(unsigned pattern, unsigned edge) {
    const unsigned parts = part_of(pattern, tetrahedron_edges[edge][0]) | part_of(pattern, tetrahedron_edges[edge][1]);
    for (unsigned e = 0; e < edge; e++)
        if ((pattern >> e & 1) &&
            (part_of(pattern, tetrahedron_edges[e][0]) | part_of(pattern, tetrahedron_edges[e][1])) == parts)
            return true;
    return false;
}

static void case_derive(label_case *c, unsigned pattern) {
    *c = (label_case){0};
    if (!pattern || !is_partition(pattern)) return;
    for (unsigned e = 0; e < 6; e++) {
        const unsigned a = tetrahedron_edges[e][0], b = tetrahedron_edges[e][1];
        if (!(pattern >> e & 1) || is_separated(pattern, e)) continue;
        if ((part_of(pattern, a) | part_of(pattern, b)) == 15)
            separate_two(c, part_of(pattern, 0));
        else
            separate(c, pattern, a, b);
    }
    for (unsigned n = 0; n < c->interface_count; n++)
        c->triangle_count = (uint8_t)(c->triangle_count + c->interfaces[n].vertex_count - 2);
}

void label_tables_derive(label_tables *tables) {
    memset(tables, 0, sizeof *tables);
    for (unsigned pattern = 0; pattern < LABEL_PATTERNS; pattern++) case_derive(&tables->cases[pattern], pattern);
    for (unsigned parity = 0; parity < 2; parity++)
        for (unsigned t = 0; t < TETRAHEDRA_PER_CUBE; t++) vertices_derive(tables, parity, t);
}
