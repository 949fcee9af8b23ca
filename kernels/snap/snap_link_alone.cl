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

inline_always void column_enter(const slab *s, const brick_around *a, row_set r, bool strided, int step_y, int step_z,
                                lanes exists, bool inner, link_column c, bool zeros, link_signs *l) {
    const lanes low = inner ? exists : exists & has_before(r.w), high = inner ? exists : exists & has_after(s, r.w);
    const lanes sign = words_beside(s, a, r, strided, step_y, step_z, 0, false);
    const lanes zero = zeros ? words_beside(s, a, r, strided, step_y, step_z, 0, true) : (lanes)0;
    if (c.at != NONE) link_enter(l, c.at, sign, zero, exists);
    if (c.before == NONE) return;
    const lanes sign_low = words_beside(s, a, r, strided, step_y, step_z, -1, false);
    const lanes sign_high = words_beside(s, a, r, strided, step_y, step_z, 1, false);
    const lanes zero_low = zeros ? words_beside(s, a, r, strided, step_y, step_z, -1, true) : (lanes)0;
    const lanes zero_high = zeros ? words_beside(s, a, r, strided, step_y, step_z, 1, true) : (lanes)0;
    link_enter(l, c.before, shifted_up(sign, sign_low), shifted_up(zero, zero_low), low);
    link_enter(l, c.after, shifted_down(sign, sign_high), shifted_down(zero, zero_high), high);
}

/* Enters the samples of the links: of odd ones, or of even ones, which have more. Of an even link, samples along the
 * axes are odd, and no zeros yet. inner: only samples on no border of the grid matter. */
inline_always void link_load(const slab *s, const brick_around *a, row_set r, bool strided, bool odd, bool inner,
                             link_signs *l) {
    const lanes all = ~(lanes)0;
    const lanes low = inner ? all : lanes_select(r.at_y > (lanes)0);
    const lanes high = inner ? all : lanes_select(r.at_y + 1ul < (lanes)s->ny);
    const lanes below = inner ? all : lanes_select(r.at_z > (lanes)s->results.word_z);
    const lanes above = inner ? all : lanes_select(r.at_z + 1ul < (lanes)s->z1);
    const link_column own = {NONE, 0, 1}, y_low = {2, odd ? NONE : 6, 7}, y_high = {3, odd ? NONE : 8, 9};
    const link_column z_low = {4, odd ? NONE : 10, 11}, z_high = {5, odd ? NONE : 12, 13};
    column_enter(s, a, r, strided, 0, 0, all, inner, own, odd, l);
    column_enter(s, a, r, strided, -1, 0, low, inner, y_low, true, l);
    column_enter(s, a, r, strided, 1, 0, high, inner, y_high, true, l);
    column_enter(s, a, r, strided, 0, -1, below, inner, z_low, true, l);
    column_enter(s, a, r, strided, 0, 1, above, inner, z_high, true, l);
    if (odd) return;
    const link_column corner[4] = {{14, NONE, NONE}, {15, NONE, NONE}, {16, NONE, NONE}, {17, NONE, NONE}};
    column_enter(s, a, r, strided, -1, -1, low & below, inner, corner[0], true, l);
    column_enter(s, a, r, strided, 1, -1, high & below, inner, corner[1], true, l);
    column_enter(s, a, r, strided, -1, 1, low & above, inner, corner[2], true, l);
    column_enter(s, a, r, strided, 1, 1, high & above, inner, corner[3], true, l);
}

/* Of the samples in a set those that are regular points. */
inline_always lanes set_snap(const slab *s, const brick_around *a, row_set r, bool strided, lanes wanted, bool odd) {
    const borders b = borders_of(s, r);
    const lanes border = b.across[0] | b.across[1] | b.across[2];
    link_signs l;
    lanes open;
    link_load(s, a, r, strided, odd, true, &l);
    const lanes regular = points_reduced(&l, odd, &open) & ~border & wanted, rest = wanted & (border | open);
    if (!lanes_any(rest)) return regular;
    link_load(s, a, r, strided, odd, false, &l);
    return regular | points_regular(&l, b.across, rest, odd);
}

#endif
