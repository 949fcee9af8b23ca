/*
 * label_words_groups.cl - words of a label map where each work-item makes those of a row: sample by sample
 */
#ifndef LABEL_WORDS_GROUPS_CL
#define LABEL_WORDS_GROUPS_CL

#include "label_words.cl"

/* Words of edges that the next samples own have one bit more, at 64. */
typedef struct label_long {
    ulong word, last;
} label_long;

inline_always void label_bit(label_long *l, uint x, bool differs) {
    if (x < 64)
        l->word |= (ulong)differs << x;
    else
        l->last = differs;
}

inline_always ulong label_shifted(label_long l) { return l.word >> 1 | l.last << 63; }

inline_always void label_edges_make(const label_job *s, row_origin p, global const BITS *samples,
                                    ulong e[LABEL_EDGES]) {
    const bool has_y = p.y + 1 < s->ny, has_z = p.z + 1 < s->nz;
    const uint left = s->nx - 64 * p.w, end = min(left, 65u);
    const ulong start = label_start(s, p.y, p.z, p.w), plane = (ulong)s->nx * s->ny;
    global const BITS *row = samples + start, *row_y = row + (has_y ? s->nx : 0);
    global const BITS *row_z = row + (has_z ? plane : 0), *row_yz = row_y + (has_z ? plane : 0);
    label_long y = {0, 0}, z = {0, 0}, yz = {0, 0}, z_y1 = {0, 0}, y_z1 = {0, 0};
    const uint odd = (s->parity + p.y + p.z) & 1;
    BITS a = row[0], b = row_y[0], c = row_z[0], d = row_yz[0];
#pragma unroll
    for (uint n = 0; n < LABEL_EDGES; n++) e[n] = 0;
    for (uint x = 0; x <= 64; x++) {
        if (x >= end) continue; /* the same number of iterations for all work-items: see classify.cl */
        const bool is_odd = (x + odd) & 1, has_x = x + 1 < left, own = has_x && x < 64;
        const uint next = has_x ? x + 1 : x;
        const BITS a1 = row[next], b1 = row_y[next], c1 = row_z[next], d1 = row_yz[next];
        label_bit(&y, x, has_y && a != b);
        label_bit(&z, x, has_z && a != c);
        label_bit(&yz, x, has_y && has_z && (is_odd ? b != c : a != d));
        label_bit(&z_y1, x, has_y && has_z && b != d);
        label_bit(&y_z1, x, has_y && has_z && c != d);
        if (own) {
            e[EX] |= (ulong)(a != a1) << x;
            e[EXY] |= (ulong)(has_y && (is_odd ? a1 != b : a != b1)) << x;
            e[EXZ] |= (ulong)(has_z && (is_odd ? a1 != c : a != c1)) << x;
            e[EX_Y1] |= (ulong)(has_y && b != b1) << x;
            e[EXZ_Y1] |= (ulong)(has_y && has_z && (is_odd ? b != d1 : b1 != d)) << x;
            e[EX_Z1] |= (ulong)(has_z && c != c1) << x;
            e[EXY_Z1] |= (ulong)(has_y && has_z && (is_odd ? c != d1 : c1 != d)) << x;
            e[EX_YZ1] |= (ulong)(has_y && has_z && d != d1) << x;
        }
        a = a1, b = b1, c = c1, d = d1;
    }
    e[EY] = y.word, e[EZ] = z.word, e[EYZ] = yz.word, e[EZ_Y1] = z_y1.word, e[EY_Z1] = y_z1.word;
    e[EY_X1] = label_shifted(y), e[EZ_X1] = label_shifted(z), e[EYZ_X1] = label_shifted(yz);
    e[EZ_XY1] = label_shifted(z_y1), e[EY_XZ1] = label_shifted(y_z1);
}

/* Bricks are not looked at as a whole: their rows are shared. */
inline_always bool label_brick_uniform(const label_job *s, uint brick, global const BITS *samples) { return false; }

#endif
