/*
 * What lies within an interval in a tetrahedron is a convex polyhedron. Its faces are what the tetrahedron's faces have
 * of it, and those on the two surfaces. It is cut by pulling: a cone from its first vertex over the faces that do not
 * have that, each a fan around its own first vertex.
 */
#include "tables/interval_cases.h"

#include <string.h>

/* Vertices of a face, in their order around it. */
typedef struct polygon {
    unsigned count;
    uint8_t vertices[6];
} polygon;

static void polygon_add(polygon *p, unsigned vertex) { p->vertices[p->count++] = (uint8_t)vertex; }

static unsigned edge_of(unsigned a, unsigned b) {
    unsigned edge = 0;
    while (tetrahedron_edges[edge][0] != (a < b ? a : b) || tetrahedron_edges[edge][1] != (a < b ? b : a)) edge++;
    return edge;
}

/* The corner a, where it is within, and the crossings on the way from it to corner b. */
static void side_add(polygon *p, const unsigned where[4], unsigned a, unsigned b) {
    const bool low = (where[a] == SAMPLE_BELOW) != (where[b] == SAMPLE_BELOW);
    const bool high = (where[a] == SAMPLE_ABOVE) != (where[b] == SAMPLE_ABOVE);
    const unsigned edge = edge_of(a, b);
    if (where[a] == SAMPLE_WITHIN) polygon_add(p, INTERVAL_CORNER + a);
    if (high && where[a] == SAMPLE_ABOVE) polygon_add(p, INTERVAL_HIGH + edge);
    if (low) polygon_add(p, INTERVAL_LOW + edge);
    if (high && where[a] != SAMPLE_ABOVE) polygon_add(p, INTERVAL_HIGH + edge);
}

/* What the face opposite to a corner has of the polyhedron. */
static polygon face_make(const unsigned where[4], unsigned opposite) {
    polygon p = {0};
    for (unsigned n = 1; n < 4; n++) side_add(&p, where, (opposite + n) & 3, (opposite + n % 3 + 1) & 3);
    return p;
}

/* The crossings of a bound, which separates the corners of `side` from the others: around one corner, or around two. */
static polygon bound_make(unsigned side, unsigned first) {
    polygon p = {0};
    unsigned in[4], out[4], in_count = 0, out_count = 0;
    for (unsigned c = 0; c < 4; c++) {
        if (side >> c & 1)
            in[in_count++] = c;
        else
            out[out_count++] = c;
    }
    if (in_count == 2) {
        for (unsigned n = 0; n < 4; n++) polygon_add(&p, first + edge_of(in[n >> 1], out[(n >> 1) ^ (n & 1)]));
    } else if (in_count && out_count) {
        for (unsigned n = 0; n < 3; n++)
            polygon_add(&p, first + edge_of(in_count == 1 ? in[0] : in[n], in_count == 1 ? out[n] : out[0]));
    }
    return p;
}

/* ------------------------------------------------------------------------------------------------------ orientation */

/* A vertex in barycentric coordinates, for samples of -2 below, 1/2 within and 3 above an interval from 0 to 1. */
static void vertex_position(const unsigned where[4], unsigned vertex, double out[4]) {
    static const double values[3] = {-2, 0.5, 3};
    memset(out, 0, 4 * sizeof *out);
    if (vertex < INTERVAL_LOW) {
        out[vertex] = 1;
        return;
    }
    const uint8_t *ends = tetrahedron_edges[(vertex - INTERVAL_LOW) % 6];
    const double a = values[where[ends[0]]], b = values[where[ends[1]]];
    const double t = ((vertex >= INTERVAL_HIGH ? 1 : 0) - a) / (b - a);
    out[ends[0]] = 1 - t, out[ends[1]] = t;
}

/* Volume of four vertices by that of the tetrahedron. */
static double part_volume(const unsigned where[4], const uint8_t part[4]) {
    double p[4][4], d[3][3];
    for (unsigned n = 0; n < 4; n++) vertex_position(where, part[n], p[n]);
    for (unsigned n = 0; n < 3; n++)
        for (unsigned c = 0; c < 3; c++) d[n][c] = p[n + 1][c + 1] - p[0][c + 1];
    return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
           d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
}

/* ------------------------------------------------------------------------------------------------------------ cases */

static unsigned first_of(const polygon *p) {
    unsigned first = 0;
    for (unsigned n = 1; n < p->count; n++)
        if (p->vertices[n] < p->vertices[first]) first = n;
    return first;
}

/* The cone from a vertex over a face: a fan around the face's first vertex. */
static void face_cone(const unsigned where[4], const polygon *face, unsigned apex, interval_case *out) {
    const unsigned first = first_of(face);
    for (unsigned n = 1; n + 1 < face->count; n++) {
        uint8_t *part = out->parts[out->count++];
        part[0] = (uint8_t)apex;
        for (unsigned m = 0; m < 3; m++) part[m + 1] = face->vertices[(first + (m ? n + m - 1 : 0)) % face->count];
        if (part_volume(where, part) > 0) continue;
        const uint8_t third = part[2];
        part[2] = part[3], part[3] = third;
    }
}

static void case_derive(const unsigned where[4], interval_case *out) {
    polygon faces[6];
    unsigned not_below = 0, above = 0, apex = INTERVAL_VERTICES;
    for (unsigned c = 0; c < 4; c++) {
        not_below |= (unsigned)(where[c] != SAMPLE_BELOW) << c, above |= (unsigned)(where[c] == SAMPLE_ABOVE) << c;
        faces[c] = face_make(where, c);
    }
    faces[4] = bound_make(not_below, INTERVAL_LOW);
    faces[5] = bound_make(above, INTERVAL_HIGH);
    *out = (interval_case){0};
    for (unsigned n = 0; n < 6; n++)
        for (unsigned m = 0; m < faces[n].count; m++)
            if (faces[n].vertices[m] < apex) apex = faces[n].vertices[m];
    for (unsigned n = 0; n < 6; n++)
        if (faces[n].count && !memchr(faces[n].vertices, (int)apex, faces[n].count))
            face_cone(where, &faces[n], apex, out);
}

void interval_cases_derive(interval_case cases[INTERVAL_CASES]) {
    for (unsigned n = 0; n < INTERVAL_CASES; n++) {
        const unsigned where[4] = {n % 3, n / 3 % 3, n / 9 % 3, n / 27};
        case_derive(where, &cases[n]);
    }
}

bool corners_sort(uint32_t corners[4]) {
    bool is_odd = false;
    for (unsigned n = 3; n > 0; n--)
        for (unsigned m = 0; m < n; m++) {
            const uint32_t a = corners[m], b = corners[m + 1];
            if (a <= b) continue;
            corners[m] = b, corners[m + 1] = a;
            is_odd = !is_odd;
        }
    return is_odd;
}

ordered_tetrahedron tetrahedron_order(unsigned parity, unsigned tetrahedron) {
    const uint8_t *corners = tetrahedron_corners[parity][tetrahedron];
    uint32_t sorted[4] = {corners[0], corners[1], corners[2], corners[3]};
    ordered_tetrahedron out = {.is_odd = corners_sort(sorted)};
    for (unsigned n = 0; n < 4; n++) out.corners[n] = (uint8_t)sorted[n];
    return out;
}
