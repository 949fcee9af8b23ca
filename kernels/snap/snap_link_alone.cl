/*
 * snap_link_alone.cl - regular points for a work-item alone: the links of all samples of a set
 */
#ifndef SNAP_LINK_ALONE_CL
#define SNAP_LINK_ALONE_CL

#include "reduced_alone.cl"
#include "regular_alone.cl"
#include "snap_samples.cl"

inline_always void link_enter(link_signs *l, uint n, lanes sign, lanes zero, lanes exists) {
    l->plus[n] = sign & ~zero & exists;
    l->minus[n] = ~sign & ~zero & exists;
    l->zero[n] = zero & exists;
}

/* Which samples of the links are in one row beside a sample: at the same x, at x - 1, at x + 1; NONE: not in the link.
 */
typedef struct link_column {
    uint at, before, after;
} link_column;

#define NONE LINK_EVEN

/* Which parts of links are loaded, as some need not be. */
typedef struct link_parts {
    bool odd;      /* of odd samples: else of even ones, which have more */
    bool borders;  /* samples on the grid's borders matter: those outside it are left out */
    bool ends;     /* first and last samples of words matter: samples of the words beside are loaded */
    bool zeros[4]; /* there may be zeros in rows a step away in neither axis, in y, in z, in both */
} link_parts;

/* Zeros are even, of colours before that of the set. Of an even link, those in its own row are odd. */
inline_always link_parts parts_of(const slab *s, row_set r, bool odd, lanes wanted) {
    const uint odd_j = (r.y ^ (uint)s->first[1]) & 1, odd_k = (r.z ^ (uint)s->first[2]) & 1;
    const uint colour = odd ? COLOUR_ODD : COLOUR_EVEN(odd_j, odd_k);
    link_parts parts = {odd, false, lanes_any(wanted & 0x8000000000000001ul) != 0, {odd}};
    for (uint n = 1; n < 4; n++) parts.zeros[n] = COLOUR_EVEN(odd_j ^ (n & 1), odd_k ^ (n >> 1)) < colour;
    return parts;
}

inline_always void column_enter(const slab *s, const brick_around *a, row_set r, bool strided, int step_y, int step_z,
                                lanes exists, const link_parts *parts, link_column c, link_signs *l) {
    const lanes low = parts->borders ? exists & has_before(r.w) : exists;
    const lanes high = parts->borders ? exists & has_after(s, r.w) : exists;
    const bool zeros = parts->zeros[(step_y != 0) + 2 * (step_z != 0)];
    const lanes sign = words_beside(s, a, r, strided, step_y, step_z, 0, false);
    const lanes zero = zeros ? words_beside(s, a, r, strided, step_y, step_z, 0, true) : (lanes)0;
    if (c.at != NONE) link_enter(l, c.at, sign, zero, exists);
    if (c.before == NONE) return;
    lanes sign_low = 0, sign_high = 0, zero_low = 0, zero_high = 0;
    if (parts->ends) {
        sign_low = words_beside(s, a, r, strided, step_y, step_z, -1, false);
        sign_high = words_beside(s, a, r, strided, step_y, step_z, 1, false);
        zero_low = zeros ? words_beside(s, a, r, strided, step_y, step_z, -1, true) : (lanes)0;
        zero_high = zeros ? words_beside(s, a, r, strided, step_y, step_z, 1, true) : (lanes)0;
    }
    link_enter(l, c.before, shifted_up(sign, sign_low), shifted_up(zero, zero_low), low);
    link_enter(l, c.after, shifted_down(sign, sign_high), shifted_down(zero, zero_high), high);
}

/* Enters the samples of the links. */
inline_always void link_load(const slab *s, const brick_around *a, row_set r, bool strided, const link_parts *parts,
                             link_signs *l) {
    const lanes all = ~(lanes)0;
    const bool odd = parts->odd, borders = parts->borders;
    const lanes low = borders ? lanes_select(r.at_y > (lanes)0) : all;
    const lanes high = borders ? lanes_select(r.at_y + 1ul < (lanes)s->ny) : all;
    const lanes below = borders ? lanes_select(r.at_z > (lanes)s->results.word_z) : all;
    const lanes above = borders ? lanes_select(r.at_z + 1ul < (lanes)s->z1) : all;
    const link_column own = {NONE, 0, 1}, y_low = {2, odd ? NONE : 6, 7}, y_high = {3, odd ? NONE : 8, 9};
    const link_column z_low = {4, odd ? NONE : 10, 11}, z_high = {5, odd ? NONE : 12, 13};
    column_enter(s, a, r, strided, 0, 0, all, parts, own, l);
    column_enter(s, a, r, strided, -1, 0, low, parts, y_low, l);
    column_enter(s, a, r, strided, 1, 0, high, parts, y_high, l);
    column_enter(s, a, r, strided, 0, -1, below, parts, z_low, l);
    column_enter(s, a, r, strided, 0, 1, above, parts, z_high, l);
    if (odd) return;
    const link_column corner[4] = {{14, NONE, NONE}, {15, NONE, NONE}, {16, NONE, NONE}, {17, NONE, NONE}};
    column_enter(s, a, r, strided, -1, -1, low & below, parts, corner[0], l);
    column_enter(s, a, r, strided, 1, -1, high & below, parts, corner[1], l);
    column_enter(s, a, r, strided, -1, 1, low & above, parts, corner[2], l);
    column_enter(s, a, r, strided, 1, 1, high & above, parts, corner[3], l);
}

/* Of the samples in a set those that are regular points. */
inline_always lanes rows_regular(const slab *s, const brick_around *a, row_set r, bool strided, lanes wanted,
                                 bool odd) {
    const borders b = borders_of(s, r);
    const lanes border = b.by_axis[0] | b.by_axis[1] | b.by_axis[2];
    link_parts parts = parts_of(s, r, odd, wanted);
    link_signs l;
    lanes open;
    link_load(s, a, r, strided, &parts, &l);
    const lanes regular = points_reduced(&l, odd, &open) & ~border & wanted, rest = wanted & (border | open);
    if (!lanes_any(rest)) return regular;
    parts.borders = true;
    link_load(s, a, r, strided, &parts, &l);
    return regular | points_regular(&l, b.by_axis, rest, odd);
}

#endif
