/*
 * snap_crossed.cl - method snap: which samples of LANES rows have a crossing
 */
#ifndef SNAP_CROSSED_CL
#define SNAP_CROSSED_CL

#include "../structured/cells.cl"
#include "snap_samples.cl"

#if MISSING
/* Samples of a dense set of which all cubes in the grid are present. */
inline_always lanes cubes_around(const slab *s, global const ulong *cells, row_set r) {
    lanes present = ~(lanes)0;
#pragma unroll 1
    for (uint n = 0; n < 4; n++) {
        const uint back_y = n & 1, back_z = n >> 1;
        if (r.z < back_z || r.z - back_z + 1 >= s->nz) continue;
        const lanes beside = r.at_y - (ulong)back_y; /* wraps below 0 */
        const lanes outside = lanes_select(beside + 1ul >= (lanes)s->ny) | lanes_select(beside + 1ul == (lanes)0ul);
        const lanes word = cells_rows(s, cells, r.y - back_y, r.z - back_z, r.w) | outside;
        const lanes low = (r.w ? cells_rows(s, cells, r.y - back_y, r.z - back_z, r.w - 1) : (lanes)~0ul) | outside;
        present &= (word | ~(lanes)has_after(s, r.w)) & shifted_up(word, low);
    }
    return present;
}
#endif

/* Adds the samples of a plane's rows that have a crossing with a sample a step away in y and z: at the same x, where
 * `straight`, to *same_x; at lower or higher x, where `aside`, to *other_x. Only those that may move there: `moves` in
 * y and z, `moves_x` in x. */
inline_always void crossed_beside(const slab *s, const brick_around *a, row_set r, int step_y, int step_z, lanes sign,
                                  lanes moves, lanes moves_x, bool straight, bool aside, lanes *same_x,
                                  lanes *other_x) {
    const lanes beside = words_beside(s, a, r, false, step_y, step_z, 0, false);
    if (straight) *same_x |= (beside ^ sign) & moves;
    if (!aside) return;
    const lanes low = words_beside(s, a, r, false, step_y, step_z, -1, false);
    const lanes high = words_beside(s, a, r, false, step_y, step_z, 1, false);
    *other_x |= ((shifted_up(beside, low) ^ sign) | (shifted_down(beside, high) ^ sign)) & moves & moves_x;
}

inline_always lanes rows_crossed(const slab *s, const brick_around *a, row_set r, const borders *b) {
    const lanes sign = words_beside(s, a, r, false, 0, 0, 0, false), all = ~(lanes)0;
    const lanes x = ~b->by_axis[0], y = ~b->by_axis[1], z = ~b->by_axis[2];
    const lanes low = lanes_select(r.at_y > (lanes)0), high = lanes_select(r.at_y + 1ul < (lanes)s->ny);
    const lanes below = lanes_select(r.at_z > (lanes)s->results.word_z);
    const lanes above = lanes_select(r.at_z + 1ul < (lanes)s->z1);
    lanes along = 0, across = 0, unused = 0;
    crossed_beside(s, a, r, 0, 0, sign, all, x, false, true, &unused, &along);
    crossed_beside(s, a, r, -1, 0, sign, low & y, x, true, true, &along, &across);
    crossed_beside(s, a, r, 1, 0, sign, high & y, x, true, true, &along, &across);
    crossed_beside(s, a, r, 0, -1, sign, below & z, x, true, true, &along, &across);
    crossed_beside(s, a, r, 0, 1, sign, above & z, x, true, true, &along, &across);
    crossed_beside(s, a, r, -1, -1, sign, low & below & y & z, x, true, false, &across, &unused);
    crossed_beside(s, a, r, 1, -1, sign, high & below & y & z, x, true, false, &across, &unused);
    crossed_beside(s, a, r, -1, 1, sign, low & above & y & z, x, true, false, &across, &unused);
    crossed_beside(s, a, r, 1, 1, sign, high & above & y & z, x, true, false, &across, &unused);
    return (along | (across & samples_even(s, r))) & samples_valid(s, r);
}

/* Samples with a crossing whose cubes are all present. None of rows outside the grid, nor of a window's first or last
 * plane where the grid goes on: a slab's own samples are further in. */
inline_always lanes rows_wanted(const slab *s, const brick_around *a, row_set r, const borders *b,
                                global const ulong *cells) {
    const bool cut_below = r.z == s->results.word_z && r.z > 0, cut_above = r.z + 1 == s->z1 && s->z1 < s->nz;
    if (r.y >= s->ny || r.z >= s->z1 || cut_below || cut_above) return 0;
    lanes wanted = rows_crossed(s, a, r, b);
#if MISSING
    if (lanes_any(wanted)) wanted &= cubes_around(s, cells, r);
#endif
    return wanted;
}

#endif
