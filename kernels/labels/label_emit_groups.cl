/*
 * label_emit_groups.cl - kernel 2 of label maps where work-items share bricks
 *
 * 32 work-items share a row of the brick. One of them makes the words and numbers that the row's cubes need, then each
 * has cubes of its own.
 */
#ifndef LABEL_EMIT_GROUPS_CL
#define LABEL_EMIT_GROUPS_CL

#include "label_triangles.cl"

/* Triangles of a row before those of the cube at x. */
inline_always uint label_triangles_before(local const label_row *r, uint x) {
    const ulong before = (1ul << x) - 1;
    uint sum = 0;
    for (uint t = 0; t < 5; t++) sum += label_cell_triangles(r->cells[t], before);
    return sum;
}

inline_always void label_cube_emit(const label_job *s, local const label_row *r, uint x, global const BITS *samples,
                                   global const uint *tables, label_mesh out) {
    const row_origin p = r->origin;
    const label_numbers v = {r, x};
    const uint odd = (s->parity + 64 * p.w + x + p.y + p.z) & 1;
    const ulong plane = (ulong)s->nx * s->ny;
    global const BITS *first = samples + label_start(s, p.y, p.z, p.w) + x;
    const ulong n = r->triangles + label_triangles_before(r, x);
    const label_triangles mesh = {out.triangles + s->triangle_offset + 3 * n, out.labels + s->label_offset + 2 * n};
    uint count = 0;
    for (uint t = 0; t < 5; t++) {
        if (!(label_cells_any(r->cells[t]) >> x & 1)) continue;
        const uint corners = tables[LABEL_MAPS + (5 * odd + t) * LABEL_MAP_WORDS + LABEL_MAP_CORNERS];
#define LABEL_CORNER(n)                                                                                                \
    first[(corners >> 4 * (n)&1) + (corners >> (4 * (n) + 1) & 1) * s->nx + (corners >> (4 * (n) + 2) & 1) * plane]
        const uint4 own = (uint4)(LABEL_CORNER(0), LABEL_CORNER(1), LABEL_CORNER(2), LABEL_CORNER(3));
#undef LABEL_CORNER
        count += label_cell_emit(s, v, own, t, odd, tables, label_triangles_after(mesh, count));
    }
}

inline_always void label_row_emit(const label_job *s, local const label_row *r, uint lane, global const BITS *samples,
                                  global const uint *tables, label_mesh out) {
    const row_origin p = r->origin;
    ulong cubes = 0;
    for (uint t = 0; t < 5; t++) cubes |= label_cells_any(r->cells[t]);
    for (uint x = lane; x < 64; x += LABEL_ROW_ITEMS) {
        const uint index = 64 * p.w + x, odd = (s->parity + index + p.y + p.z) & 1;
        const label_numbers v = {r, x};
        for (uint type = 0; type < LABEL_ROW_TYPES; type++)
            if (r->words[type] >> x & 1)
                label_vertex_emit(s, label_line_of(s, p, type, odd, tables), index,
                                  label_vertex(v, LABEL_VERTEX(type, 0)), out);
        if (cubes >> x & 1) label_cube_emit(s, r, x, samples, tables, out);
    }
}

/* Nothing is needed of private memory, and work-items hide the time that memory takes. */
typedef struct label_work {
    uint none;
} label_work;

inline_always void label_brick_prefetch(const label_job *s, uint brick, label_arrays in, global const BITS *samples) {}

inline_always void label_brick_emit(const label_job *s, uint brick, label_arrays in, global const uint *tiles,
                                    global const BITS *samples, global const uint *tables, label_mesh out,
                                    local label_row *made, label_work *work) {
    const uint own = (uint)get_local_id(0) / LABEL_ROW_ITEMS, lane = (uint)get_local_id(0) % LABEL_ROW_ITEMS;
    const label_near near = label_near_of(s, brick, tiles);
    for (uint first = 0; first < BRICK_WORDS; first += LABEL_ROWS_AT_ONCE) {
        const uint row = first + own;
        const bool is_there = row < BRICK_WORDS && (in.rows[brick] >> row & 1);
        if (is_there && lane == 0) label_row_make(s, row_origin_of(s, brick, row), near, in, tiles, &made[own]);
        group_barrier();
        if (is_there) label_row_emit(s, &made[own], lane, samples, tables, out);
        group_barrier();
    }
}

#endif
