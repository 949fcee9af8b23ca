/*
 * label_emit_alone.cl - a row of a label map where a work-item has it to itself: it makes a table of all numbers first
 */
#ifndef LABEL_EMIT_ALONE_CL
#define LABEL_EMIT_ALONE_CL

#include "label_triangles.cl"

/* LABEL_VERTEX is the index of a vertex in the table, from the cube's first sample on. */
#define LABEL_COLUMNS 65

/* Numbers of the vertices in a word. */
inline_always void label_numbers_make(local const label_row *r, uint word, uint *table) {
    uint number = r->numbers[word];
    for (ulong rest = r->words[word]; rest; rest &= rest - 1)
        table[LABEL_ROW_WORDS * lowest_bit(rest) + word] = number++;
    table[LABEL_ROW_WORDS * 64 + word] = r->next[word];
}

/* Vertices of a type: those at even samples, then those at odd ones. */
inline_always void label_vertices_emit(const label_job *s, local const label_row *r, uint type, const uint *table,
                                       global const uint *tables, label_mesh out) {
    const label_place p = r->place;
    const ulong even = label_even(s, p.y, p.z);
    for (uint odd = 0; odd < (type < LABEL_WORDS ? 1 : 2); odd++) { /* on edges both are in one place */
        ulong rest = r->words[type] & (type < LABEL_WORDS ? ~0ul : odd ? ~even : even);
        if (!rest) continue;
        const label_line line = label_line_of(s, p, type, odd, tables);
        for (; rest; rest &= rest - 1) {
            const uint x = lowest_bit(rest);
            label_vertex_emit(s, line, 64 * p.w + x, table[LABEL_ROW_WORDS * x + type], out);
        }
    }
}

/* Labels of the corners of the cube at a sample. */
inline_always BITS8 label_corners(const label_job *s, global const BITS *first) {
    global const BITS *y1 = first + s->nx, *z1 = first + (ulong)s->nx * s->ny, *yz1 = z1 + s->nx;
    return (BITS8)(first[0], first[1], y1[0], y1[1], z1[0], z1[1], yz1[0], yz1[1]);
}

/* Bit n: corner n has the label. */
inline_always uint label_equal(BITS8 corners, BITS label) {
    const char8 is = convert_char8(corners == (BITS8)label);
    return (uint)(((as_ulong(is) & 0x8040201008040201ul) * 0x0101010101010101ul) >> 56);
}

/* Triangles of a cube with two labels, which are those of an isovalue between them. inside: corners of the first. */
inline_always uint label_two_emit(const label_job *s, label_numbers v, uint odd, uint inside, uint first, uint second,
                                  uint n, global const uint *tables, label_mesh out) {
    global const uchar *c = (global const uchar *)(tables + LABEL_CUBES + LABEL_CASE_WORDS * (256 * odd + inside));
    global uint *to = out.triangles + s->triangle_offset + 3ul * n, *sides = out.labels + s->label_offset + 2ul * n;
    const uint count = c[0];
    for (uint m = 0; m < count; m++) {
        vstore3((uint3)(v[c[3 * m + 1]], v[c[3 * m + 2]], v[c[3 * m + 3]]), m, to);
        vstore2((uint2)(first, second), m, sides);
    }
    return count;
}

inline_always uint label_cube_emit(const label_job *s, label_numbers v, uint odd, BITS8 corners, uint cells, uint n,
                                   global const uint *tables, label_mesh out) {
    const uint first = corners.s0, inside = label_equal(corners, corners.s0), before = n;
    BITS l[8];
    vstore8(corners, 0, l);
    const uint other = l[lowest_bit(~(ulong)inside) & 7], rest = label_equal(corners, (BITS)other);
    if ((inside | rest) == 255)
        return other - 1 < first - 1 ? label_two_emit(s, v, odd, rest, other, first, n, tables, out)
                                     : label_two_emit(s, v, odd, inside, first, other, n, tables, out);
    for (; cells; cells &= cells - 1) {
        const uint t = lowest_bit(cells);
        const uint at = tables[LABEL_MAPS + (5 * odd + t) * LABEL_MAP_WORDS + LABEL_MAP_CORNERS];
        const uint4 own = (uint4)(l[at & 7], l[at >> 4 & 7], l[at >> 8 & 7], l[at >> 12 & 7]);
        n += label_cell_emit(s, v, own, t, odd, n, tables, out);
    }
    return n - before;
}

inline_always void label_row_emit(const label_job *s, local const label_row *r, uint lane, global const BITS *samples,
                                  global const uint *tables, label_mesh out) {
    const label_place p = r->place;
    global const BITS *first = samples + label_start(s, p.y, p.z, p.w);
    uint table[LABEL_COLUMNS * LABEL_ROW_WORDS], n = r->triangles;
    ulong cells[5], cubes = 0;
    for (uint word = 0; word < LABEL_ROW_WORDS; word++) label_numbers_make(r, word, table);
    for (uint type = 0; type < LABEL_ROW_TYPES; type++) label_vertices_emit(s, r, type, table, tables, out);
    for (uint t = 0; t < 5; t++) cubes |= cells[t] = label_cells_any(r->cells[t]);
    for (; cubes; cubes &= cubes - 1) {
        const uint x = lowest_bit(cubes), odd = (s->parity + 64 * p.w + x + p.y + p.z) & 1;
        uint own = 0;
        for (uint t = 0; t < 5; t++) own |= (uint)(cells[t] >> x & 1) << t;
        n += label_cube_emit(s, table + LABEL_ROW_WORDS * x, odd, label_corners(s, first + x), own, n, tables, out);
    }
}

#endif
