/*
 * cells.cl - grids with missing samples: one bit per cube whose eight corners are present
 *
 * The bits are made before kernel 1, only where a sample is missing (not finite, equal to the missing value, or
 * blanked) or a cube is blanked. The cells buffer holds the planes cell_z <= z of the slab, in the layout of sign
 * words. A vertex exists only on an edge of a present cube.
 */
#ifndef CELLS_CL
#define CELLS_CL

#include "tetrahedra.cl"

#if MISSING

/* Samples of a row that are present and whose next sample in x is present too. */
inline_always ulong word_present_pair(global const BITS *samples, global const uchar *blanked, const slab *s, uint y,
                                      uint z, uint w) {
    ulong word = word_present(samples, blanked, s, y, z, w);
    ulong next = w + 1 < s->words_x && !sample_missing(samples, blanked, s, row_start(s, y, z) + 64ul * (w + 1));
    return word & word_shifted(word, next);
}

/* Blanked cubes of a row; bits past its end are meaningless. */
inline_always ulong word_blanked(global const uchar *blanked, const slab *s, uint y, uint z, uint w) {
    ulong row = s->arrays.blanked_cell_offset + ((ulong)(z - s->arrays.sample_z) * (s->ny - 1) + y) * (s->nx - 1);
    return bytes_word(blanked, row + 64ul * w, s->arrays.blanked_cell_offset + s->arrays.blanked_cell_count);
}

/* All groups together go through the words of the planes from cell_z on, plane_count of them. */
kernel void cells_mark(slab s, global const BITS *samples, global const uchar *blanked_samples,
                       global const uchar *blanked_cells, global ulong *cells, uint plane_count) {
    uint row_count = s.ny * plane_count;
    for (uint row = (uint)get_group_id(0); row < row_count; row += (uint)get_num_groups(0)) {
        uint y = row % s.ny, z = s.arrays.cell_z + row / s.ny;
        bool last = y + 1 == s.ny || z + 1 == s.nz;
        for (uint first = 0; first < s.words_x; first += WORK_ITEMS) {
            uint w = first + (uint)get_local_id(0);
            if (w >= s.words_x) continue;
            ulong present = last ? 0 : ~0ul;
#pragma unroll 1
            for (uint n = 0; n < 4 && present; n++)
                present &= word_present_pair(samples, blanked_samples, &s, y + (n & 1), z + (n >> 1), w);
            if (present && s.arrays.has_blanked_cells) present &= ~word_blanked(blanked_cells, &s, y, z, w);
            cells[(ulong)row * s.words_x + w] = present;
        }
    }
}

/* Present cubes of the row (y, z); none where that is outside the grid. */
inline_always ulong cells_at(const slab *s, global const ulong *cells, uint y, uint z, uint w) {
    if (y >= s->ny || z >= s->nz || z < s->arrays.cell_z) return 0; /* y and z wrap below 0 */
    return cells[((z - s->arrays.cell_z) * s->ny + y) * s->words_x + w];
}

/* Present cubes of LANES rows from y on. */
inline_always lanes cells_rows(const slab *s, global const ulong *cells, uint y, uint z, uint w) {
#if LANES == 8
    return (lanes)(cells_at(s, cells, y, z, w), cells_at(s, cells, y + 1, z, w), cells_at(s, cells, y + 2, z, w),
                   cells_at(s, cells, y + 3, z, w), cells_at(s, cells, y + 4, z, w), cells_at(s, cells, y + 5, z, w),
                   cells_at(s, cells, y + 6, z, w), cells_at(s, cells, y + 7, z, w));
#else
    return cells_at(s, cells, y, z, w);
#endif
}

/* Bit n: cube n or the cube at x - 1 is present. */
inline_always lanes cells_before(const slab *s, global const ulong *cells, uint y, uint z, uint w) {
    lanes word = cells_rows(s, cells, y, z, w);
    return word | word << 1 | (w ? cells_rows(s, cells, y, z, w - 1) >> 63 : (lanes)0);
}

/* Keeps the crossings of edges that a present cube contains. */
inline_always void crossings_keep(const slab *s, global const ulong *cells, uint y, uint z, uint w, crossings *edges) {
    lanes here = cells_rows(s, cells, y, z, w), low_y = cells_rows(s, cells, y - 1, z, w);
    lanes low_z = cells_rows(s, cells, y, z - 1, w), low_yz = cells_rows(s, cells, y - 1, z - 1, w);
    lanes before = cells_before(s, cells, y, z, w);
    edges->type[0] &= here | low_y | low_z | low_yz;
    edges->type[1] &= before | cells_before(s, cells, y, z - 1, w);
    edges->type[2] &= before | cells_before(s, cells, y - 1, z, w);
    edges->type[3] &= here | low_z;
    edges->type[4] &= here | low_y;
    edges->type[5] &= before;
}

#endif

#endif
