/*
 * label_emit_alone.cl - a row of a label map where a work-item has it to itself
 */
#ifndef LABEL_EMIT_ALONE_CL
#define LABEL_EMIT_ALONE_CL

#include "label_triangles.cl"

/* Vertices of a type, which follow each other; returns the number after the last. Those on edges are in one place for
 * both parities. */
inline_always uint label_vertices_emit(const label_job *s, label_place p, ulong word, uint type, uint number,
                                       global const uint *tables, label_mesh out) {
    label_line line = label_line_of(s, p, type, 0, tables);
    for (; word; word &= word - 1, number++) {
        const uint x = 64 * p.w + lowest_bit(word);
        if (type >= LABEL_WORDS) line = label_line_of(s, p, type, (s->parity + x + p.y + p.z) & 1, tables);
        label_vertex_emit(s, line, x, number, out);
    }
    return number;
}

/* Labels of the corners of the cube at a sample. */
inline_always BITS8 label_corners(const label_job *s, global const BITS *first) {
    global const BITS *z1 = first + (ulong)s->nx * s->ny;
    return (BITS8)(vload2(0, first), vload2(0, first + s->nx), vload2(0, z1), vload2(0, z1 + s->nx));
}

/* Bit n: corner n has the label. */
inline_always uint label_equal(BITS8 corners, BITS label) {
    const char8 is = convert_char8(corners == (BITS8)label);
    return (uint)(((as_ulong(is) & 0x8040201008040201ul) * 0x0101010101010101ul) >> 56);
}

/* A cube that emits triangles. entry: its triangles in the tables, where it has two labels; else 0. */
typedef struct label_cube {
    uint x, entry, first, second;
} label_cube;

inline_always label_cube label_cube_of(uint x, uint odd, BITS8 corners) {
    const uint first = corners.s0, inside = label_equal(corners, corners.s0);
    BITS l[8];
    vstore8(corners, 0, l);
    const uint other = l[lowest_bit(~(ulong)inside) & 7], rest = label_equal(corners, (BITS)other);
    const bool turned = other - 1 < first - 1;
    label_cube c;
    c.x = x;
    c.entry = (inside | rest) == 255 ? LABEL_CUBES + LABEL_CASE_WORDS * (256 * odd + (turned ? rest : inside)) : 0;
    c.first = turned ? other : first, c.second = turned ? first : other;
    return c;
}

/* Triangles of a cube with two labels, which are those of an isovalue between them. Returns how many. */
inline_always uint label_two_emit(const label_job *s, label_numbers v, label_cube cube, uint n,
                                  global const uint *tables, label_mesh out) {
    global const uchar *c = (global const uchar *)(tables + cube.entry);
    global uint *to = out.triangles + s->triangle_offset + 3ul * n, *sides = out.labels + s->label_offset + 2ul * n;
    const uint count = c[0];
    for (uint m = 0; m < count; m++, c += 3) {
        vstore3((uint3)(label_vertex(v, c[1]), label_vertex(v, c[2]), label_vertex(v, c[3])), m, to);
        vstore2((uint2)(cube.first, cube.second), m, sides);
    }
    return count;
}

/* Of one with more labels. cells: by tetrahedron, bits of the row's cubes. */
inline_always uint label_more_emit(const label_job *s, label_numbers v, uint odd, BITS8 corners, const ulong cells[5],
                                   uint n, global const uint *tables, label_mesh out) {
    const uint before = n;
    BITS l[8];
    vstore8(corners, 0, l);
    for (uint t = 0; t < 5; t++) {
        if (!(cells[t] >> v.x & 1)) continue;
        const uint at = tables[LABEL_MAPS + (5 * odd + t) * LABEL_MAP_WORDS + LABEL_MAP_CORNERS];
        const uint4 own = (uint4)(l[at & 7], l[at >> 4 & 7], l[at >> 8 & 7], l[at >> 12 & 7]);
        n += label_cell_emit(s, v, own, t, odd, n, tables, out);
    }
    return n - before;
}

/* Cubes are listed first: how many triangles one has cannot be foreseen, and would be waited for. */
inline_always void label_row_emit(const label_job *s, local const label_row *r, uint lane, global const BITS *samples,
                                  global const uint *tables, label_mesh out) {
    const label_place p = r->place;
    const uint odd = (s->parity + p.y + p.z) & 1; /* of the row's first cube */
    global const BITS *first = samples + label_start(s, p.y, p.z, p.w);
    uint n = r->triangles, number = r->numbers[0], count = 0;
    ulong cells[5], cubes = 0;
    label_cube list[64];
    for (uint type = 0; type < LABEL_ROW_TYPES; type++)
        if (r->words[type]) number = label_vertices_emit(s, p, r->words[type], type, number, tables, out);
    for (uint t = 0; t < 5; t++) cubes |= cells[t] = label_cells_any(r->cells[t]);
    for (; cubes; cubes &= cubes - 1) {
        const uint x = lowest_bit(cubes);
        list[count++] = label_cube_of(x, (odd + x) & 1, label_corners(s, first + x));
    }
    for (uint m = 0; m < count; m++) {
        const uint x = list[m].x;
        const label_numbers v = {r, x};
        n += list[m].entry ? label_two_emit(s, v, list[m], n, tables, out)
                           : label_more_emit(s, v, (odd + x) & 1, label_corners(s, first + x), cells, n, tables, out);
    }
}

#endif
