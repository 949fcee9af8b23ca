/*
 * snap_samples.cl - method snap: what is known of the samples of LANES rows by their position: neighbours, borders,
 * parity
 */
#ifndef SNAP_SAMPLES_CL
#define SNAP_SAMPLES_CL

#include "snap_rows.cl"
#include "../structured/tetrahedra.cl"

inline_always lanes shifted_up(lanes word, lanes before) { return word << 1 | before >> 63; }
inline_always lanes shifted_down(lanes word, lanes after) { return word >> 1 | after << 63; }

/* On which borders of the grid samples are, by axis. */
typedef struct borders {
    lanes by_axis[3]; /* at the first or the last sample along it */
} borders;

inline_always borders borders_of(const slab *s, row_set r) {
    borders b = {{~((lanes)has_before(r.w) & has_after(s, r.w)),
                  lanes_select(r.at_y == (lanes)0) | lanes_select(r.at_y + 1ul == (lanes)s->ny),
                  lanes_select(r.at_z == (lanes)0) | lanes_select(r.at_z + 1ul == (lanes)s->nz)}};
    return b;
}

/* Even samples of the rows, also beyond the grid. */
inline_always lanes samples_even(const slab *s, row_set r) {
    return (lanes)0x5555555555555555ul << ((r.at_y + r.at_z + s->parity) & 1ul);
}

/* Samples of the rows that are in the grid and in the window. */
inline_always lanes samples_valid(const slab *s, row_set r) {
    return lanes_select(r.at_y < (lanes)s->ny) & lanes_select(r.at_z < (lanes)s->z1) & word_valid(s, r.w);
}

#endif
