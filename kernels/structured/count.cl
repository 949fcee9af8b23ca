/*
 * count.cl - the second stage of kernel 1: how much each row of a brick emits, and where in the brick its output begins
 *
 * A tile is a run of bricks: tile_rows rows of bricks in one layer, or tile_layers whole layers. sign.cl has made
 * the words of its samples. The halo is the next row and the next plane of samples, which other tiles own; its words
 * are in scratch. The loops over a layer of bricks are in count_alone.cl and count_groups.cl.
 */
#ifndef COUNT_CL
#define COUNT_CL

#include "border.cl"
#include "sign.cl"
#include "tetrahedra.cl"

typedef struct tile {
    uint y0, y1, z0, z1; /* rows and planes of samples */
} tile;

inline_always tile tile_locate(const slab *s, uint n) {
    tile t;
    uint tiles_y = (s->bricks_y + s->tiling.tile_rows - 1) / s->tiling.tile_rows;
    t.y0 = n % tiles_y * s->tiling.tile_rows * BRICK_ROWS;
    t.y1 = min(t.y0 + s->tiling.tile_rows * BRICK_ROWS, s->ny);
    t.z0 = s->z0 + n / tiles_y * s->tiling.tile_layers * BRICK_PLANES;
    t.z1 = min(t.z0 + s->tiling.tile_layers * BRICK_PLANES, s->z1);
    return t;
}

typedef struct tile_words {
    global ulong *words, *scratch;
    global brick_state *bricks;
} tile_words;

/* Scratch holds the words of the halo. First those of plane z1, eight per brick, also of the bricks that begin at y1,
 * of which only the first row is filled. Then those of row y1, plane after plane. */
inline_always ulong halo_plane(const slab *s, tile t, uint y, uint w) {
    return BRICK_ROWS * ((ulong)(y - t.y0) / BRICK_ROWS * s->words_x + w) + y % BRICK_ROWS;
}

inline_always ulong halo_row(const slab *s, tile t, uint z, uint w) {
    return BRICK_ROWS * (ulong)(s->tiling.tile_rows + 1) * s->words_x + (ulong)(z - t.z0) * s->words_x + w;
}

/* Whether the words of a row are with those of its brick, or in scratch. Where samples are snapped the words of all
 * tiles have been made before. */
inline_always bool row_in_tile(tile t, uint y) { return ZEROS || y < t.y1; }
inline_always bool plane_in_tile(tile t, uint z) { return ZEROS || z < t.z1; }

/* The word of a row in the grid. The words of the next rows of its brick follow it, except in row y1 of scratch. */
inline_always global const ulong *tile_row(const slab *s, tile t, uint y, uint z, uint w, tile_words signs) {
    if (!plane_in_tile(t, z)) return signs.scratch + halo_plane(s, t, y, w);
    if (!row_in_tile(t, y)) return signs.scratch + halo_row(s, t, z, w);
    uint brick = brick_index(s, y, z, w);
    return brick_words(brick, signs.bricks[brick].sign, signs.words) + row_in_brick(s, y, z);
}

inline_always void halo_make(const slab *s, tile t, global const BITS *samples, global const brick_range *ranges,
                             global ulong *scratch) {
    if (t.y1 < s->ny)
        for (uint z = t.z0; z < t.z1; z++) row_words_make(s, t.y1, z, samples, ranges, scratch + halo_row(s, t, z, 0));
    if (t.z1 < s->nz)
        for (uint y = t.y0; y < min(t.y1 + 1, s->ny); y += BRICK_ROWS)
            rows_words_make(s, y, min(t.y1 + 1, s->ny), t.z1, samples, ranges, scratch + halo_plane(s, t, y, 0));
}

typedef struct emit_counts {
    uint vertices, triangles, cells;
} emit_counts;

/* Of LANES rows of 64 cubes. */
typedef struct row_counts {
    lanes packed; /* as offsets_pack makes it */
    lanes vertices, triangles, cells;
} row_counts;

inline_always row_counts rows_count(const slab *s, const cube_rows *r, uint y, uint z, uint w,
                                    global const ulong *cells) {
    row_counts c = {0, 0, 0, 0};
    crossings edges = crossings_owned(r); /* not by vertices_owned: this order needs fewer registers */
    lanes active = cubes_active(r), in_border = 0;
#if MISSING
    crossings_keep(s, cells, y, z, w, &edges);
    active &= cells_rows(s, cells, y, z, w);
#endif
#if CLOSED
    edges.type[AT_SAMPLE_TYPE] = at_samples_owned(s, r, y, z, w, cells);
    border_faces faces = border_faces_of(s, cells, y, z, w);
    if (lanes_any(border_faces_any(&faces))) in_border = border_triangles(r, &faces);
#endif
    if (!lanes_any(active | in_border | crossings_any(&edges))) return c;
    c.packed = offsets_pack(&edges, &c.vertices);
    c.triangles = triangles_count(r, &active) + in_border;
    c.cells = lanes_popcount(active);
    return c;
}

inline_always uint layer_bricks(const slab *s, tile t) {
    return (t.y1 - t.y0 + BRICK_ROWS - 1) / BRICK_ROWS * s->words_x;
}

/* The words of LANES rows, made of the samples, or where samples are snapped read; 0 outside the grid. */
inline_always lanes rows_inside(const slab *s, uint y, uint z, uint w, global const BITS *samples, tile_words signs,
                                lanes *zeros) {
    ulong word[LANES], zero[LANES];
    for (uint n = 0; n < LANES; n++) {
        word[n] = zero[n] = 0;
        if (w >= s->words_x || y + n >= s->ny || z >= s->nz) continue;
        if (ZEROS) {
            uint brick = brick_index(s, y + n, z, w), brick_row = row_in_brick(s, y + n, z);
            global const ulong *words = brick_words(brick, signs.bricks[brick].sign, signs.words);
            word[n] = words[brick_row] & word_valid(s, w), zero[n] = zeros_of(s, words)[brick_row];
        } else {
            word[n] = word_inside(samples, s, y + n, z, w);
        }
    }
#if LANES == 8
    *zeros = vload8(0, zero);
    return vload8(0, word);
#else
    *zeros = zero[0];
    return word[0];
#endif
}

/* The fallback of the scan: one work-item's share of a tile's sums, made from samples, as other groups may not have
 * stored their words yet. */
inline_always emit_counts tile_recount(const slab *s, uint tile_index, global const BITS *samples,
                                       global const ulong *cells, tile_words signs) {
    tile t = tile_locate(s, tile_index);
    emit_counts sums = {0, 0, 0};
    uint rows = (t.y1 - t.y0 + LANES - 1) / LANES, count = rows * (t.z1 - t.z0) * s->words_x;
    for (uint first = 0; first < count; first += WORK_ITEMS) {
        uint n = first + (uint)get_local_id(0);
        if (n >= count) continue;
        uint w = n % s->words_x, y = t.y0 + n / s->words_x % rows * LANES, z = t.z0 + n / s->words_x / rows;
        lanes words[8] = {0}, zeros[8] = {0}; /* the cubes' four rows, at w and w + 1. They enter at [7] and move down:
                                                 a variable index needs memory. */
#pragma unroll 1
        for (uint m = 0; m < 8; m++) {
#pragma unroll
            for (uint lower = 0; lower < 7; lower++) words[lower] = words[lower + 1], zeros[lower] = zeros[lower + 1];
            words[7] = rows_inside(s, y + m / 2 % 2, z + m / 4, w + m % 2, samples, signs, &zeros[7]);
        }
        cube_rows r = cube_rows_of(s, y, z, w, rows_with_zeros(words[0], words[1], zeros[0], zeros[1]),
                                   rows_with_zeros(words[2], words[3], zeros[2], zeros[3]),
                                   rows_with_zeros(words[4], words[5], zeros[4], zeros[5]),
                                   rows_with_zeros(words[6], words[7], zeros[6], zeros[7]));
        row_counts c = rows_count(s, &r, y, z, w, cells);
        sums.vertices += (uint)lanes_sum(c.vertices), sums.triangles += (uint)lanes_sum(c.triangles);
    }
    return sums;
}

#if WORK_ITEMS == 1
#include "count_alone.cl"
#else
#include "count_groups.cl"
#endif

#endif
