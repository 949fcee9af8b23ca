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
    for (uint odd = 0; odd < 2; odd++) {
        ulong rest = r->words[type] & (odd ? ~even : even);
        if (!rest) continue;
        const label_line line = label_line_of(s, p, type, odd, tables);
        for (; rest; rest &= rest - 1) {
            const uint x = lowest_bit(rest);
            label_vertex_emit(s, line, 64 * p.w + x, table[LABEL_ROW_WORDS * x + type], out);
        }
    }
}

/* Labels of the corners of the cube at a sample, those in memory. */
inline_always void label_corners(const label_job *s, global const BITS *first, uint labels[8]) {
    for (uint n = 0; n < 4; n++) {
        global const BITS *row = first + (n & 1) * (ulong)s->nx + (n >> 1) * (ulong)s->nx * s->ny;
        labels[2 * n] = row[0], labels[2 * n + 1] = row[1];
    }
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
        uint l[8];
        label_corners(s, first + x, l);
        for (uint t = 0; t < 5; t++) {
            if (!(cells[t] >> x & 1)) continue;
            const uint corners = tables[LABEL_MAPS + (5 * odd + t) * LABEL_MAP_WORDS + LABEL_MAP_CORNERS];
            const uint4 own = (uint4)(l[corners & 7], l[corners >> 4 & 7], l[corners >> 8 & 7], l[corners >> 12 & 7]);
            n += label_cell_emit(s, table + LABEL_ROW_WORDS * x, own, t, odd, n, tables, out);
        }
    }
}

#endif
