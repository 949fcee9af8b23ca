/*
 * count_alone.cl - counting where a work-item has bricks to itself: it skips uniform bricks whose neighbours are on the
 * same side
 */
#ifndef COUNT_ALONE_CL
#define COUNT_ALONE_CL

#include "count.cl"

/* For LANES rows from y on: the samples of word w that exist. */
inline_always lanes rows_valid(const slab *s, uint y, uint w) {
    return lanes_select(LANE_NUMBERS + y < (lanes)s->ny) & word_valid(s, w);
}

/* Whether any sample that follows a uniform brick in x, y or z is on the other side. Bricks of the same tile that are
 * uniform decide by their sign; in others the words are read. In method snap a mixed brick counts as different, and
 * its words are not read. */
inline_always bool neighbours_differ(const slab *s, tile t, uint y, uint z, uint w, tile_words signs, uint sign) {
    const ulong uniform = sign_word(sign);
    for (uint n = 1; n < 8; n++) {
        const uint next_x = w + (n & 1), next_y = y + (n & 2 ? BRICK_ROWS : 0), next_z = z + (n & 4 ? BRICK_PLANES : 0);
        if (next_x >= s->words_x || next_y >= s->ny || next_z >= s->nz) continue;
        const uint found = row_in_tile(t, next_y) && plane_in_tile(t, next_z)
                               ? signs.bricks[brick_index(s, next_y, next_z, next_x)].sign
                               : SIGN_MIXED;
        if (found == sign) continue;
        if (found != SIGN_MIXED || ZEROS) return true;
        const ulong columns = n & 1 ? 1 : word_valid(s, next_x);
        const uint planes = n & 4 ? 1 : min((uint)BRICK_PLANES, t.z1 - z);
        const uint stride = row_in_tile(t, next_y) ? BRICK_ROWS : s->words_x; /* from plane to plane */
        global const ulong *row = tile_row(s, t, next_y, next_z, next_x, signs);
        lanes differ = 0;
        ulong differs = 0;
        for (uint plane = 0; plane < planes; plane++, row += stride)
            if (n & 2)
                differs |= *row ^ uniform;
            else
                differ |= vload8(0, row) ^ uniform;
        if (n & 2 ? differs & columns : lanes_any(differ & rows_valid(s, next_y, next_x) & columns)) return true;
    }
    return false;
}

/* Whether a uniform brick emits something; true for a mixed brick, which may, and where an inside brick may have a part
 * of the border that closes the surface. Where the seven bricks at higher x, y and z are in this tile and on the same
 * side, their signs suffice. */
inline_always bool brick_emits(const slab *s, tile t, uint y, uint z, uint w, tile_words signs,
                               global const ulong *cells) {
    const uint brick = brick_index(s, y, z, w), sign = signs.bricks[brick].sign;
    if (sign == SIGN_MIXED) return true;
#if CLOSED
    if (sign == SIGN_INSIDE && bricks_at_border(s, cells, y, z, w, 1)) return true;
#endif
    const uint next_x = w + 1 < s->words_x ? 1 : 0, next_y = y + BRICK_ROWS < t.y1 ? s->words_x : 0;
    const uint next_z = z + BRICK_PLANES < t.z1 ? s->words_x * s->bricks_y : 0;
    global const brick_state *here = signs.bricks + brick, *at_next_z = here + next_z;
    const uint differ = (here[next_x].sign ^ sign) | (here[next_y].sign ^ sign) | (here[next_y + next_x].sign ^ sign) |
                        (at_next_z[0].sign ^ sign) | (at_next_z[next_x].sign ^ sign) | (at_next_z[next_y].sign ^ sign) |
                        (at_next_z[next_y + next_x].sign ^ sign);
    const bool halo = (!next_y && t.y1 < s->ny) || (!next_z && t.z1 < s->nz); /* bricks of other tiles follow */
    return (differ || halo) && neighbours_differ(s, t, y, z, w, signs, sign);
}

/* The sign words that cubes take from one brick: those of its first plane, and of the plane behind its last. */
typedef struct word_planes {
    global const ulong *first, *after;
    uint stride; /* from plane to plane */
    lanes valid; /* samples that exist */
} word_planes;

/* Outside the grid all words are 0. */
inline_always word_planes word_planes_of(const slab *s, tile t, uint y, uint z, uint w, tile_words signs) {
    global const ulong *none = brick_words(0, SIGN_OUTSIDE, signs.words);
    word_planes c = {none, none, 0, 0};
    if (w >= s->words_x || y >= s->ny) return c;
    const uint end = min(z + BRICK_PLANES, t.z1);
    c.first = tile_row(s, t, y, z, w, signs), c.stride = row_in_tile(t, y) ? BRICK_ROWS : s->words_x;
    if (end < s->nz) c.after = tile_row(s, t, y, end, w, signs);
    c.valid = rows_valid(s, y, w);
    return c;
}

/* What the cubes of a brick need: words of the brick, of the brick at higher x, and of the bricks at higher y of both.
 */
typedef struct cube_planes {
    word_planes at, next, next_y, xy;
} cube_planes;

inline_always cube_planes cube_planes_of(const slab *s, tile t, uint y, uint z, uint w, tile_words signs) {
    cube_planes c = {word_planes_of(s, t, y, z, w, signs), word_planes_of(s, t, y, z, w + 1, signs),
                     word_planes_of(s, t, y + BRICK_ROWS, z, w, signs),
                     word_planes_of(s, t, y + BRICK_ROWS, z, w + 1, signs)};
    return c;
}

inline_always global const ulong *plane_first(word_planes c, uint plane, bool after) {
    return after ? c.after : c.first + plane * c.stride;
}

/* Loads rows y to y + 7 into *a and y + 1 to y + 8 into *b, of a plane of the brick or of the plane after. */
inline_always void plane_rows(const slab *s, cube_planes c, uint plane, bool after, sample_rows *a, sample_rows *b) {
    lanes at = vload8(0, plane_first(c.at, plane, after)) & c.at.valid;
    lanes next = vload8(0, plane_first(c.next, plane, after)) & c.next.valid;
    ulong next_y = *plane_first(c.next_y, plane, after) & c.next_y.valid.s0;
    ulong xy = *plane_first(c.xy, plane, after) & c.xy.valid.s0;
    if (ZEROS) {
        const lanes zero = vload8(0, zeros_of(s, plane_first(c.at, plane, after)));
        const lanes zero_next = vload8(0, zeros_of(s, plane_first(c.next, plane, after)));
        const ulong zero_y = *zeros_of(s, plane_first(c.next_y, plane, after));
        const ulong zero_xy = *zeros_of(s, plane_first(c.xy, plane, after));
        *a = rows_with_zeros(at, next, zero, zero_next);
        *b = rows_with_zeros(lanes_next_row(at, next_y), lanes_next_row(next, xy), lanes_next_row(zero, zero_y),
                             lanes_next_row(zero_next, zero_xy));
    } else {
        *a = rows_shifted(at, next);
        *b = rows_shifted(lanes_next_row(at, next_y), lanes_next_row(next, xy));
    }
}

/* Exclusive prefix sum over lanes. */
inline_always lanes lanes_before(lanes x) {
    x = (lanes)(0, x.s0123, x.s456);
    x += (lanes)(0, x.s0123, x.s456);
    x += (lanes)(0, 0, x.s0123, x.s45);
    return x + (lanes)(0, 0, 0, 0, x.s0123);
}

/* Counts a brick, stores where in it each row's output begins and returns which rows emit. */
inline_always uint brick_count(const slab *s, tile t, uint y, uint z, uint w, tile_words signs,
                               global const ulong *cells, global ulong *offsets, global ushort *triangle_offsets,
                               emit_counts *sums) {
    const uint brick = brick_index(s, y, z, w), planes = min((uint)BRICK_PLANES, t.z1 - z);
    const cube_planes columns = cube_planes_of(s, t, y, z, w, signs);
    uint mask = 0;
    lanes cells_seen = 0, begins = 0; /* vertices, and 32 bits higher triangles, of the planes before */
    sample_rows a, b, c, d;
    plane_rows(s, columns, 0, false, &a, &b);
    for (uint plane = 0; plane < planes; plane++) {
        plane_rows(s, columns, plane + 1, plane + 1 == planes, &c, &d);
        cube_rows r = cube_rows_of(s, y, z + plane, w, a, b, c, d);
        a = c, b = d;
        row_counts rows = rows_count(s, &r, y, z + plane, w, cells);
        lanes both = rows.vertices | rows.triangles << 32;
        if (!lanes_any(both)) continue;
        lanes before = lanes_before(both) + begins;
        vstore8(rows.packed + (before & 0xfffffffful), BRICK_PLANES * brick + plane, offsets);
        vstore8(convert_ushort8(before >> 32), BRICK_PLANES * brick + plane, triangle_offsets);
        begins = (lanes)(before.s7 + both.s7);
        mask |= lanes_nonzero(both) << (BRICK_ROWS * plane);
        cells_seen += rows.cells;
    }
    sums->cells += (uint)lanes_sum(cells_seen);
    sums->vertices += (uint)begins.s0, sums->triangles += (uint)(begins.s0 >> 32);
    return mask;
}

/* Whether a run of bricks and the bricks at higher x, y and z are known to be on one side, so that the run emits
 * nothing. */
inline_always bool run_skipped(const slab *s, tile t, uint y, uint z, uint w, uint count,
                               global const brick_range *ranges) {
    const uint next_y = y + BRICK_ROWS < s->ny ? s->words_x : 0;
    const uint next_z = z + BRICK_PLANES < s->z1 ? s->words_x * s->bricks_y : 0;
    const uint next_x = w + count < s->words_x ? count : count - 1;
    if (z + BRICK_PLANES >= s->z1 && s->z1 < s->nz) return false;
    if (!s->results.ranges_known && (y + BRICK_ROWS >= t.y1 || z + BRICK_PLANES >= t.z1)) return false;
    global const brick_range *here = ranges + s->results.range_offset + brick_index(s, y, z, w);
    uint sign = run_sign(&s->test, here, count);
#if CLOSED
    const bool closes = MISSING ? true : bricks_at_border(s, NULL, y, z, w, count);
    if (sign == SIGN_INSIDE && closes) return false;
#endif
    return sign != SIGN_MIXED && run_sign(&s->test, here + next_y, count) == sign &&
           run_sign(&s->test, here + next_z, count) == sign &&
           run_sign(&s->test, here + next_y + next_z, count) == sign && range_sign(&s->test, here[next_x]) == sign &&
           range_sign(&s->test, here[next_y + next_x]) == sign && range_sign(&s->test, here[next_z + next_x]) == sign &&
           range_sign(&s->test, here[next_y + next_z + next_x]) == sign;
}

/* A group needs no local memory here. */
typedef struct count_memory {
    uint none;
} count_memory;

/* Counts the layer that begins with plane z, brick by brick, and adds to *sums. A brick stores the sums before it, from
 * the start of the tile. *emitting: how many bricks of the tile emit something. */
inline_always void layer_count(const slab *s, tile t, uint z, tile_words signs, global const ulong *cells,
                               global const brick_range *ranges, global ulong *offsets, global ushort *triangle_offsets,
                               emit_counts *sums, global uint *emitting, local count_memory *memory) {
    global brick_state *first = &signs.bricks[brick_index(s, t.y0, z, 0)];
    first->vertices = sums->vertices, first->triangles = sums->triangles;
    for (uint y = t.y0; y < t.y1; y += BRICK_ROWS)
        for (uint run = 0; run < s->words_x; run += RUN_BRICKS_X) {
            uint end = min(run + RUN_BRICKS_X, s->words_x);
            if (!ZEROS && run_skipped(s, t, y, z, run, end - run, ranges)) continue;
            for (uint w = run; w < end; w++) {
                if (!brick_emits(s, t, y, z, w, signs, cells)) continue;
                global brick_state *b = &signs.bricks[brick_index(s, y, z, w)];
                b->vertices = sums->vertices, b->triangles = sums->triangles;
                b->rows = brick_count(s, t, y, z, w, signs, cells, offsets, triangle_offsets, sums);
                *emitting += b->rows != 0;
            }
        }
}

#endif
