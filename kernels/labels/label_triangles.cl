/*
 * label_triangles.cl - triangles of a tetrahedron of a label map, by the table of its partition
 */
#ifndef LABEL_TRIANGLES_CL
#define LABEL_TRIANGLES_CL

#include "label_row_numbers.cl"

/* The numbers of a cube's vertices: made where a triangle names them, so no memory is needed for them. */
typedef struct label_numbers {
    local const label_row *row;
    uint x; /* of the cube's first sample in the row */
} label_numbers;

inline_always uint label_vertex(label_numbers v, uint vertex) {
    const uint word = LABEL_VERTEX_WORD(vertex), at = v.x + LABEL_VERTEX_NEXT(vertex);
    if (at == 64) return v.row->next[word];
    return v.row->numbers[word] + (uint)popcount(v.row->words[word] & ((1ul << at) - 1));
}

inline_always uint label_pick(uint4 labels, uint n) {
    return n == 0 ? labels.x : n == 1 ? labels.y : n == 2 ? labels.z : labels.w;
}

/* Bit n: the ends of edge n differ. */
inline_always uint label_pattern(uint4 l) {
    return (uint)(l.x != l.y) | (uint)(l.x != l.z) << 1 | (uint)(l.x != l.w) << 2 | (uint)(l.y != l.z) << 3 |
           (uint)(l.y != l.w) << 4 | (uint)(l.z != l.w) << 5;
}

/* Where the next triangle and its labels go: to the mesh, or where a work-item is alone to memory of its own first. */
#if WORK_ITEMS == 1
#define LABEL_OUT private
#else
#define LABEL_OUT global
#endif

typedef struct label_triangles {
    LABEL_OUT uint *triangles, *labels;
} label_triangles;

inline_always label_triangles label_triangles_after(label_triangles to, uint count) {
    label_triangles after = {to.triangles + 3 * count, to.labels + 2 * count};
    return after;
}

/* The two triangles of an interface, or the one; returns how many. */
inline_always uint label_interface_emit(const label_job *s, label_numbers v, uint interface, uint4 l,
                                        global const uint *map, label_triangles out) {
    const uint inner = label_pick(l, interface >> 16 & 3), outer = label_pick(l, interface >> 18 & 3);
    const uint count = interface >> 20;
    const bool turned = outer - 1 < inner - 1; /* the lower label comes first, and the background last */
    const uint2 labels = turned ? (uint2)(outer, inner) : (uint2)(inner, outer);
    const uint v0 = label_vertex(v, map[interface & 15]);
    const uint v1 = label_vertex(v, map[interface >> 4 & 15]), v2 = label_vertex(v, map[interface >> 8 & 15]);
    const uint v3 = count > 1 ? label_vertex(v, map[interface >> 12 & 15]) : v2;
    /* a fan of v0, the others in this order or the reverse; mirrored: each triangle is turned over by itself */
    const uint a = turned ? v3 : v1, b = v2, c = turned ? v1 : v3;
    LABEL_OUT uint *to = out.triangles, *sides = out.labels;
    const uint second = count > 1 ? b : turned ? v1 : v2;
    to[0] = v0, to[1] = s->mirrored ? second : a, to[2] = s->mirrored ? a : second;
    vstore2(labels, 0, sides);
    if (count > 1) {
        to[3] = v0, to[4] = s->mirrored ? c : b, to[5] = s->mirrored ? b : c;
        vstore2(labels, 1, sides);
    }
    return count;
}

/* Triangles of tetrahedron t of a cube of that parity; labels: of its corners. Returns how many. */
inline_always uint label_cell_emit(const label_job *s, label_numbers v, uint4 labels, uint t, uint odd,
                                   global const uint *tables, label_triangles out) {
    global const uint *map = tables + LABEL_MAPS + (5 * odd + t) * LABEL_MAP_WORDS;
    global const uint *interfaces = tables + LABEL_CASE_WORDS * label_pattern(labels);
    const uint count = interfaces[0];
    uint n = 0;
    for (uint m = 1; m <= count; m++)
        n += label_interface_emit(s, v, interfaces[m], labels, map, label_triangles_after(out, n));
    return n;
}

#endif
