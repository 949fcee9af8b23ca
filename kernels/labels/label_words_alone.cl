/*
 * label_words_alone.cl - words of a label map where a work-item is alone: 64 samples at a time
 */
#ifndef LABEL_WORDS_ALONE_CL
#define LABEL_WORDS_ALONE_CL

#include "label_words.cl"

/* 64 samples from index n on; past the end of the buffer, 0. */
inline_always samples64 label_load(const label_job *s, ulong n, global const BITS *samples) {
    const ulong end = s->sample_offset + s->sample_count;
    if (n + 64 <= end) return *(global const samples64_unaligned *)(samples + n);
    BITS last[64];
    for (uint m = 0; m < 64; m++) last[m] = n + m < end ? samples[n + m] : (BITS)0;
    return *(const samples64_unaligned *)last;
}

/* Bit n: elements n differ. */
inline_always ulong label_differ(samples64 a, samples64 b) {
    return mask_word(__builtin_convertvector(a != b, bytes64));
}

inline_always void label_edges_make(const label_job *s, row_origin p, global const BITS *samples,
                                    ulong e[LABEL_EDGES]) {
    const bool has_y = p.y + 1 < s->ny, has_z = p.z + 1 < s->nz;
    const uint left = s->nx - 64 * p.w;
    const ulong even = label_even(s, p.y, p.z), all = label_mask(left), along = label_mask(left - 1);
    const ulong in_y = has_y ? all : 0, in_z = has_z ? all : 0, in_yz = in_y & in_z;
    const ulong start = label_start(s, p.y, p.z, p.w), dy = has_y ? s->nx : 0, dz = has_z ? (ulong)s->nx * s->ny : 0;
    const samples64 a = label_load(s, start, samples), a1 = label_load(s, start + 1, samples);
    const samples64 b = label_load(s, start + dy, samples), b1 = label_load(s, start + dy + 1, samples);
    const samples64 c = label_load(s, start + dz, samples), c1 = label_load(s, start + dz + 1, samples);
    const samples64 d = label_load(s, start + dy + dz, samples), d1 = label_load(s, start + dy + dz + 1, samples);
    e[EX] = label_differ(a, a1) & along;
    e[EY] = label_differ(a, b) & in_y;
    e[EZ] = label_differ(a, c) & in_z;
    e[EXY] = label_select(even, label_differ(a, b1), label_differ(a1, b)) & in_y & along;
    e[EXZ] = label_select(even, label_differ(a, c1), label_differ(a1, c)) & in_z & along;
    e[EYZ] = label_select(even, label_differ(a, d), label_differ(b, c)) & in_yz;
    e[EX_Y1] = label_differ(b, b1) & in_y & along;
    e[EZ_Y1] = label_differ(b, d) & in_yz;
    e[EXZ_Y1] = label_select(even, label_differ(b1, d), label_differ(b, d1)) & in_yz & along;
    e[EX_Z1] = label_differ(c, c1) & in_z & along;
    e[EY_Z1] = label_differ(c, d) & in_yz;
    e[EXY_Z1] = label_select(even, label_differ(c1, d), label_differ(c, d1)) & in_yz & along;
    e[EX_YZ1] = label_differ(d, d1) & in_yz & along;
    /* the samples behind the row, which are those at 64 */
    const ulong beyond = left > 64 ? 1ul << 63 : 0, is_odd = ~even << 63;
    const ulong y1 = has_y ? beyond : 0, z1 = has_z ? beyond : 0, yz1 = y1 & z1;
    e[EY_X1] = e[EY] >> 1 | (a1[63] != b1[63] ? y1 : 0);
    e[EZ_X1] = e[EZ] >> 1 | (a1[63] != c1[63] ? z1 : 0);
    e[EYZ_X1] = e[EYZ] >> 1 | ((is_odd ? b1[63] != c1[63] : a1[63] != d1[63]) ? yz1 : 0);
    e[EZ_XY1] = e[EZ_Y1] >> 1 | (b1[63] != d1[63] ? yz1 : 0);
    e[EY_XZ1] = e[EY_Z1] >> 1 | (c1[63] != d1[63] ? yz1 : 0);
}

/* Prefetches the samples of a brick and of the next row and plane. */
inline_always void label_samples_prefetch(const label_job *s, uint brick, global const BITS *samples) {
    const row_origin p = row_origin_of(s, brick, 0);
    for (uint z = p.z; z < min(p.z + BRICK_PLANES + 1, s->nz); z++)
        for (uint y = p.y; y < min(p.y + BRICK_ROWS + 1, s->ny); y++) {
            global const BITS *row = samples + label_start(s, y, z, p.w);
            for (uint n = 0; n < 64; n += 64 / sizeof(BITS)) line_prefetch(row + n);
        }
}

/* Whether a brick, with the next row, plane and column, has one label: it then emits nothing. */
inline_always bool label_brick_uniform(const label_job *s, uint brick, global const BITS *samples) {
    const row_origin p = row_origin_of(s, brick, 0);
    const uint left = s->nx - 64 * p.w, y1 = min(p.y + BRICK_ROWS + 1, s->ny), z1 = min(p.z + BRICK_PLANES + 1, s->nz);
    const ulong all = label_mask(left);
    const BITS label = samples[label_start(s, p.y, p.z, p.w)];
    for (uint z = p.z; z < z1; z++)
        for (uint y = p.y; y < y1; y++) {
            const ulong start = label_start(s, y, z, p.w);
            if (label_differ(label_load(s, start, samples), (samples64)label) & all) return false;
            if (left > 64 && samples[start + 64] != label) return false;
        }
    return true;
}

#endif
