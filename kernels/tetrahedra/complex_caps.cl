/*
 * complex_caps.cl - the program that closes surfaces of complexes: vertices at the inside points of the border, and the
 * inside parts of its faces
 *
 * Points and faces of the border are counted together: item n is point n and face n. A face's inside part is a polygon
 * around inside points and vertices on crossed edges, which are looked up in the table of edges; it is fanned around
 * an inside point, which the surface does not have:
 *
 *       a             a             a             a---da        a triangle is turned until a is inside and, where two
 *      / \           / \           / \            | \   \       are, b too; a quadrilateral whose diagonal has no
 *    ab---ca        b   ca        b---c           |   \  cd     vertex until a is the end of it that is inside
 *                    bc                           b---bc
 */
#ifndef COMPLEX_CAPS_CL
#define COMPLEX_CAPS_CL

#include "complex_edges.cl"

/* The border, and the surface that its edges are looked up in. */
typedef struct cap_arrays {
    global const uint *points;
    global const cap_face *faces;
    global const active_item *active;
    global const uchar *cases;
    volatile global uint *table;
} cap_arrays;

inline_always bool cap_is_half(const cap_face *f) { return f->points[3] == CAP_HALF; }
inline_always bool cap_is_triangle(const cap_face *f) { return f->points[3] >= CAP_HALF; }

/* The entry of the edge between two points of the border, EDGE_NONE where the surface has none. */
inline_always uint cap_edge(const complex_job *c, uint a, uint b, cap_arrays in) {
    const uint2 edge = (uint2)(in.points[min(a, b)], in.points[max(a, b)]);
    return c->active_count ? edge_find(c, edge, edge_hash(edge) & c->table_mask, in.active, in.cases, in.table)
                           : EDGE_NONE;
}

/* Whether a face is cut as two triangles: not where its diagonal is crossed but has no vertex, as no tetrahedron has it
 * for an edge. Bit n of inside: point n is inside. */
inline_always bool cap_splits(const complex_job *c, const cap_face *f, uint inside, cap_arrays in) {
    const uint end = cap_is_half(f) ? 1 : 2;
    if (f->points[3] == CAP_TRIANGLE || !((inside ^ inside >> end) & 1)) return true;
    return cap_edge(c, f->points[0], end == 1 ? f->points[1] : f->points[2], in) != EDGE_NONE;
}

/* Which points of the second half of a quadrilateral are inside. */
inline_always uint second_half(uint inside) { return (inside & 1) | (inside >> 1 & 6); }

/* Triangles of a triangle's inside part, four bits for each number of points inside: 0, 1, 2, 1. */
inline_always uint triangle_parts(uint inside) { return 0x1210u >> 4 * popcount(inside & 7) & 3; }

inline_always uint cap_parts(const complex_job *c, const cap_face *f, uint inside, cap_arrays in) {
    const bool splits = cap_splits(c, f, inside, in);
    if (cap_is_triangle(f)) return splits ? triangle_parts(inside) : 0;
    return splits ? triangle_parts(inside) + triangle_parts(second_half(inside)) : (uint)popcount(inside);
}

/* --------------------------------------------------------------------------------------------------------- counting */

/* What the kernel that counts works on. */
typedef struct cap_count {
    cap_arrays in;
    global const BITS *samples;
    global uint *numbers, *firsts, *head;
} cap_count;

inline_always bool cap_inside(const complex_job *c, uint point, cap_count a) {
    return bits_inside(a.samples[a.in.points[point]], &c->test);
}

inline_always uint face_inside(const complex_job *c, const cap_face *f, cap_count a) {
    uint inside = 0;
    for (uint n = 0; n < 3; n++) inside |= (uint)cap_inside(c, f->points[n], a) << n;
    return cap_is_triangle(f) ? inside : inside | (uint)cap_inside(c, f->points[3], a) << 3;
}

/* Inside points and triangles of a tile; stores where they begin, unless it is a recount. */
inline_always uint2 tile_caps_count(tile_tools tools, uint tile_index, cap_count a, bool recount) {
    const complex_job *c = tools.c;
    uint2 running = 0;
    for (uint start = 0; start < c->tile_caps; start += WORK_ITEMS) {
        const uint n = tile_index * c->tile_caps + start + (uint)get_local_id(0);
        const bool exists = start + (uint)get_local_id(0) < c->tile_caps;
        const bool has_point = exists && n < c->cap_points, has_face = exists && n < c->cap_faces;
        bool inside = false;
        uint triangles = 0;
        if (has_point) inside = cap_inside(c, n, a);
        if (has_face) {
            const cap_face f = a.in.faces[n];
            triangles = cap_parts(c, &f, face_inside(c, &f, a), a.in);
        }
        const uint2 before = group_prefix((uint2)(inside, triangles), &running, tools.scan.sums);
        if (has_point && !recount) a.numbers[n] = inside ? before.x : EDGE_NONE;
        if (has_face && !recount) a.firsts[n] = before.y;
    }
    return running;
}

inline_always void cap_tile_settle(tile_tools tools, uint tile_index, cap_count a) {
    uint unposted;
    bool look = false;
    while (!tile_settle(tools.scan, tile_index, look, &unposted)) {
        tile_post(tools.scan, unposted, tile_caps_count(tools, unposted, a, true));
        look = true;
    }
    if (get_local_id(0) == 0 && tile_index + 1 == tools.c->cap_tiles) {
        a.head[HEAD_CAP_VERTICES] = tile_before(tools.scan.tiles, tile_index + 1, TILE_SUM_X);
        a.head[HEAD_CAP_TRIANGLES] = tile_before(tools.scan.tiles, tile_index + 1, TILE_SUM_Y);
    }
}

/* Counts what the border adds, once the surface's vertices are numbered. `tiles` has to be cleared. */
kernel void caps_count(complex_job c, global const BITS *samples, global const uint *points,
                       global const cap_face *faces, global const active_item *active, global const uchar *cases,
                       global uint *state, global uint *table, global uint *tiles, global uint *numbers,
                       global uint *firsts) {
    local uint shared[4];
    local uint2 sums[WORK_ITEMS + 1];
    tile_tools tools = {&c, {c.spin_limit, tiles, shared, sums}};
    cap_count a = {{points + c.cap_point_offset, faces + c.cap_face_offset, active, cases, table},
                   samples + c.sample_offset,
                   numbers,
                   firsts,
                   state};
    own_tiles own = {NO_TILE, NO_TILE};
    uint tile_index = 0;
    while (tile_index < c.cap_tiles) {
        tile_index = ticket_take(&state[HEAD_TICKETS + TICKET_CAPS_COUNT], shared);
        if (tile_index < c.cap_tiles) {
            tile_post(tools.scan, tile_index, tile_caps_count(tools, tile_index, a, false));
            if (SETTLES_LATER)
                own_append(&own, tile_index, tiles);
            else
                cap_tile_settle(tools, tile_index, a);
        }
    }
    for (uint n = own.first; SETTLES_LATER && n != NO_TILE; n = tiles[TILE_WORDS * n + TILE_NEXT])
        cap_tile_settle(tools, n, a);
}

/* --------------------------------------------------------------------------------------------------------- emission */

/* What the kernel that emits works on. */
typedef struct cap_emit {
    cap_arrays in;
    global const uint *numbers, *firsts;
    global uint *state;
    global const uint *tiles, *cap_tiles; /* of the surface's vertices, of points and faces */
    global uint *triangles;
} cap_emit;

/* The vertex at an inside point. */
inline_always uint point_vertex(const complex_job *c, uint point, cap_emit e) {
    return e.state[HEAD_VERTICES] + tile_before(e.cap_tiles, point / c->tile_caps, TILE_SUM_X) + e.numbers[point];
}

/* The vertex on a crossed edge; where there is none, samples have changed, which the head tells. */
inline_always uint crossing_vertex(const complex_job *c, uint a, uint b, cap_emit e) {
    const uint entry = cap_edge(c, a, b, e.in);
    if (entry != EDGE_NONE) return edge_number(c, e.in.table[entry], e.in.active, e.tiles);
    atomic_or(&e.state[HEAD_INVALID], 1u);
    return 0;
}

inline_always void cap_put(uint a, uint b, uint c, global uint **out) {
    (*out)[0] = a, (*out)[1] = b, (*out)[2] = c;
    *out += 3;
}

/* The inside part of a triangle. */
inline_always void triangle_emit(const complex_job *c, uint3 p, uint inside, cap_emit e, global uint **out) {
    const uint count = (uint)popcount(inside);
    const uint turn = 0x9a10u >> 2 * inside & 3; /* where a is, two bits for each pattern: 0 0 1 0 2 2 1 2 */
    if (!count) return;
    if (turn == 1) p = p.yzx;
    if (turn == 2) p = p.zxy;
    const uint a = point_vertex(c, p.x, e);
    const uint b = count == 1 ? crossing_vertex(c, p.x, p.y, e) : point_vertex(c, p.y, e);
    const uint last = count == 3 ? point_vertex(c, p.z, e) : crossing_vertex(c, p.z, p.x, e);
    const uint between = count == 2 ? crossing_vertex(c, p.y, p.z, e) : last;
    cap_put(a, b, between, out);
    if (count == 2) cap_put(a, between, last, out);
}

/* That of a quadrilateral whose diagonal is crossed and has no vertex. */
inline_always void quadrilateral_emit(const complex_job *c, uint4 p, uint inside, cap_emit e, global uint **out) {
    if (!(inside & 1)) p = p.zwxy, inside = (inside >> 2 | inside << 2) & 15;
    const bool has_b = inside & 2, has_d = inside & 8;
    const uint a = point_vertex(c, p.x, e);
    uint before = has_b ? point_vertex(c, p.y, e) : crossing_vertex(c, p.x, p.y, e);
    if (has_b) {
        const uint bc = crossing_vertex(c, p.y, p.z, e);
        cap_put(a, before, bc, out);
        before = bc;
    }
    if (has_d) {
        const uint cd = crossing_vertex(c, p.z, p.w, e);
        cap_put(a, before, cd, out);
        before = cd;
    }
    cap_put(a, before, has_d ? point_vertex(c, p.w, e) : crossing_vertex(c, p.w, p.x, e), out);
}

inline_always void cap_face_emit(const complex_job *c, uint n, cap_emit e) {
    const cap_face f = e.in.faces[n];
    global uint *out = e.triangles + 3ul * (e.state[HEAD_TRIANGLES] +
                                            tile_before(e.cap_tiles, n / c->tile_caps, TILE_SUM_Y) + e.firsts[n]);
    const bool triangle = cap_is_triangle(&f);
    uint inside = 0;
    for (uint m = 0; m < 3; m++) inside |= (uint)(e.numbers[f.points[m]] != EDGE_NONE) << m;
    if (!triangle) inside |= (uint)(e.numbers[f.points[3]] != EDGE_NONE) << 3;
    const bool splits = cap_splits(c, &f, inside, e.in);
    const uint3 first = (uint3)(f.points[0], f.points[1], f.points[2]);
    const uint3 second = (uint3)(f.points[0], f.points[2], f.points[3]);
    if (!triangle && !splits) quadrilateral_emit(c, (uint4)(first, f.points[3]), inside, e, &out);
    if (splits) triangle_emit(c, first, inside & 7, e, &out);
    if (splits && !triangle) triangle_emit(c, second, second_half(inside), e, &out);
}

/* Emits the border's vertices and triangles behind the surface's. */
kernel void caps_emit(complex_job c, global const float *points, global const uint *cap_points,
                      global const cap_face *faces, global const active_item *active, global const uchar *cases,
                      global uint *state, global const uint *tiles, global uint *table, global const uint *cap_tiles,
                      global const uint *numbers, global const uint *firsts, global float *positions,
                      global uint *triangles) {
    local uint shared[4];
    uint tile_index = 0;
    const cap_emit e = {{cap_points + c.cap_point_offset, faces + c.cap_face_offset, active, cases, table},
                        numbers,
                        firsts,
                        state,
                        tiles,
                        cap_tiles,
                        triangles};
    points += c.point_offset;
    while (tile_index < c.cap_tiles) {
        tile_index = ticket_take(&state[HEAD_TICKETS + TICKET_CAPS_EMIT], shared);
        for (uint start = 0; start < c.tile_caps && tile_index < c.cap_tiles; start += WORK_ITEMS) {
            const uint n = tile_index * c.tile_caps + start + (uint)get_local_id(0);
            if (start + (uint)get_local_id(0) >= c.tile_caps) continue;
            if (n < c.cap_points && numbers[n] != EDGE_NONE)
                vstore3(vload3(e.in.points[n], points), point_vertex(&c, n, e), positions);
            if (n < c.cap_faces) cap_face_emit(&c, n, e);
        }
    }
}

#endif
