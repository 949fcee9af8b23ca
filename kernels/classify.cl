/*
 * classify.cl - kernel 1: sign words, what each row of 64 cubes will emit, and its prefix sums
 *
 * A tile is a run of bricks: tile_rows rows of bricks in one layer, or tile_layers whole layers. Its group
 *
 * 1. makes the sign words of the tile's samples, and of the halo: the next row and the next plane of samples, which
 *    others own, into scratch;
 * 2. counts the vertices and triangles of every brick that is not uniform, row by row, and stores where in the brick
 *    each row's output begins;
 * 3. posts the tile's sums and, now or after its other tiles, obtains what all tiles before it emit (scan.cl);
 * 4. stores where each brick's output begins, and appends the bricks that emit something to the list for kernel 2.
 *
 * Groups stay and take tiles by ticket. Uniform bricks cost no stores but their base. Loops over a group's items run
 * equally often for all of them and test inside: PoCL 3.1 has been seen to run loops of unequal length too often.
 */

typedef struct tile {
    uint y0, y1, z0, z1; /* rows and planes of samples */
} tile;

inline_always tile tile_locate(const slab *s, uint n) {
    tile t;
    uint groups_y = (s->bricks_y + s->tile_rows - 1) / s->tile_rows;
    t.y0 = n % groups_y * s->tile_rows * BRICK_ROWS;
    t.y1 = min(t.y0 + s->tile_rows * BRICK_ROWS, s->ny);
    t.z0 = s->z0 + n / groups_y * s->tile_layers * BRICK_PLANES;
    t.z1 = min(t.z0 + s->tile_layers * BRICK_PLANES, s->z1);
    return t;
}

/* A row of sign words: the tile's own are in words; of the halo, the plane z1 comes first in scratch (rows y0 to y1),
 * then the rows y1 of the other planes. */
inline_always global ulong *tile_row(const slab *s, tile t, uint y, uint z, global ulong *words,
                                     global ulong *scratch) {
    if (z >= t.z1) return scratch + (y - t.y0) * s->words_x;
    if (y >= t.y1) return scratch + (t.y1 - t.y0 + 1 + z - t.z0) * s->words_x;
    return words + word_index(s, y, z, 0);
}

/* Sign words of the planes z0 <= z < z1 of the tile, halo rows included. */
inline_always uint planes_sign(const slab *s, tile t, uint z0, uint z1, global const BITS *samples, global ulong *words,
                               global ulong *scratch) {
    uint rows = min(t.y1 + 1, s->ny) - t.y0;
    uint nonfinite = 0;
#if WORK_ITEMS == 1
    for (uint z = z0; z < z1; z++)
        for (uint y = t.y0; y < t.y0 + rows; y++)
            row_sign(samples, s, y, z, tile_row(s, t, y, z, words, scratch), &nonfinite);
#else
    uint parts = 4 * s->words_x;
    uint count = (z1 - z0) * rows * parts;
    for (uint first = 0; first < count; first += WORK_ITEMS) {
        uint n = first + (uint)get_local_id(0), row = n / parts, part = n % parts;
        uint y = t.y0 + row % rows, z = z0 + row / rows;
        global ushort *out = (global ushort *)tile_row(s, t, y, z, words, scratch);
        if (n < count) out[part] = (ushort)word_part(samples, s, y, z, part, &nonfinite);
    }
#endif
    return nonfinite;
}

typedef struct emission {
    uint vertices, triangles, cells;
} emission;

/* What one row of 64 cubes emits; *packed as offsets_pack makes it, for a row that comes first in its brick. */
inline_always emission row_count(const slab *s, const cube_row *r, uint y, uint z, uint w, global const ulong *cells,
                                 ulong *packed) {
    crossings k = crossings_owned(r);
    ulong active = cubes_active(r);
#if MISSING
    crossings_keep(s, cells, y, z, w, &k);
    active &= cells_at(s, cells, y, z, w);
#endif
    emission e = {0, 0, 0};
    *packed = 0;
    if (!(active | k.type[0] | k.type[1] | k.type[2] | k.type[3] | k.type[4] | k.type[5])) return e;
    *packed = offsets_pack(&k, 0, &e.vertices);
    e.triangles = active ? triangles_count(r, active) : 0;
    e.cells = (uint)popcount(active);
    return e;
}

inline_always emission tile_row_count(const slab *s, tile t, uint y, uint z, uint w, global ulong *words,
                                      global ulong *scratch, global const ulong *cells, ulong *packed) {
    cube_row r =
        cube_row_load(s, y, z, w, tile_row(s, t, y, z, words, scratch), tile_row(s, t, y + 1, z, words, scratch),
                      tile_row(s, t, y, z + 1, words, scratch), tile_row(s, t, y + 1, z + 1, words, scratch));
    return row_count(s, &r, y, z, w, cells, packed);
}

/* Brick n of a layer of the tile: x, then y. */
typedef struct brick {
    uint w, y0;
} brick;

inline_always brick brick_locate(const slab *s, tile t, uint n) {
    brick b = {n % s->words_x, t.y0 + n / s->words_x * BRICK_ROWS};
    return b;
}

inline_always uint layer_bricks(const slab *s, tile t) {
    return (t.y1 - t.y0 + BRICK_ROWS - 1) / BRICK_ROWS * s->words_x;
}

#if WORK_ITEMS == 1

/* Which of the eight bricks from w on have samples on both sides, neighbours included; the others emit nothing. Reads
 * up to eight words past the end of a row: buffers of words are that much longer. */
inline_always ulong8 bricks_mixed(const slab *s, tile t, uint y0, uint z0, uint w, global ulong *words,
                                  global ulong *scratch) {
    const ulong8 column = w + (ulong8)(0, 1, 2, 3, 4, 5, 6, 7);
    const ulong8 has_next = as_ulong8(column + 1 < (ulong8)s->words_x);
    const ulong8 past_end = as_ulong8(column + 1 == (ulong8)s->words_x) & ~word_valid(s, s->words_x - 1);
    ulong8 any = 0, all = ~0ul;
    for (uint z = z0; z <= z0 + BRICK_PLANES && z < s->nz; z++)
        for (uint y = y0; y <= y0 + BRICK_ROWS && y < s->ny; y++) {
            global const ulong *row = tile_row(s, t, y, z, words, scratch) + w;
            ulong8 here = vload8(0, row), next = vload8(0, row + 1);
            any |= here | (next & has_next & 1ul);
            all &= (here | past_end) & (next | ~1ul | ~has_next);
        }
    return as_ulong8((any != 0ul) & (all != ~0ul) & (column < (ulong8)s->words_x));
}

/* Counts a brick row by row, stores where in the brick each row's output begins and returns which rows emit. */
inline_always uint brick_count(const slab *s, tile t, uint y0, uint z0, uint w, global ulong *words,
                               global ulong *scratch, global const ulong *cells, global ulong *offsets,
                               global ushort *triangle_offsets, emission *sums) {
    uint y1 = min(y0 + BRICK_ROWS, t.y1), z1 = min(z0 + BRICK_PLANES, t.z1), mask = 0;
    emission e = {0, 0, 0};
    for (uint z = z0; z < z1; z++)
        for (uint y = y0; y < y1; y++) {
            ulong packed;
            emission row = tile_row_count(s, t, y, z, w, words, scratch, cells, &packed);
            if (row.vertices + row.triangles == 0) continue;
            uint index = word_index(s, y, z, w);
            offsets[index] = packed + e.vertices;
            triangle_offsets[index] = (ushort)e.triangles;
            e.vertices += row.vertices, e.triangles += row.triangles, e.cells += row.cells;
            mask |= 1u << ((z - z0) * BRICK_ROWS + (y - y0));
        }
    sums->vertices += e.vertices, sums->triangles += e.triangles, sums->cells += e.cells;
    return mask;
}

/* Counts a layer of the tile, brick by brick; *sums runs on from brick to brick. Stores bases within the tile. */
inline_always void layer_count(const slab *s, tile t, uint z0, global ulong *words, global ulong *scratch,
                               global const ulong *cells, global ulong *offsets, global ushort *triangle_offsets,
                               global uint2 *bases, global uint *masks, emission *sums) {
    for (uint y0 = t.y0; y0 < t.y1; y0 += BRICK_ROWS)
        for (uint w0 = 0; w0 < s->words_x; w0 += 8) {
            ulong mixed[8];
            vstore8(bricks_mixed(s, t, y0, z0, w0, words, scratch), 0, mixed);
            for (uint w = w0; w < min(w0 + 8, s->words_x); w++) {
                uint index = brick_index(s, y0, z0, w);
                bases[index] = (uint2)(sums->vertices, sums->triangles);
                masks[index] =
                    mixed[w - w0] ? brick_count(s, t, y0, z0, w, words, scratch, cells, offsets, triangle_offsets, sums)
                                  : 0;
            }
        }
}

#else

#define BRICKS_AT_ONCE (WORK_ITEMS / BRICK_WORDS)

/* What a work-item tells its group about the row that it counted. */
typedef struct row_report {
    ulong packed;
    emission e;
} row_report;

/* The same with a work-item per row of a brick: each adds up the rows before its own. Nothing but the sums lives across
 * a barrier, and work-items without a row count another one's, as compilers have gone wrong on either. All work-items
 * leave with the same sums. */
inline_always void layer_count(const slab *s, tile t, uint z0, global ulong *words, global ulong *scratch,
                               global const ulong *cells, global ulong *offsets, global ushort *triangle_offsets,
                               global uint2 *bases, global uint *masks, emission *sums, local row_report *rows) {
    uint count = layer_bricks(s, t);
    for (uint n = 0; n < count; n += BRICKS_AT_ONCE) {
        {
            uint lid = (uint)get_local_id(0), place = lid % BRICK_WORDS;
            brick b = brick_locate(s, t, min(n + lid / BRICK_WORDS, count - 1));
            uint y = b.y0 + place % BRICK_ROWS, z = z0 + place / BRICK_ROWS;
            bool mine = n + lid / BRICK_WORDS < count && y < t.y1 && z < t.z1;
            row_report report;
            report.e = tile_row_count(s, t, mine ? y : b.y0, mine ? z : z0, b.w, words, scratch, cells, &report.packed);
            if (!mine) report.e.vertices = 0, report.e.triangles = 0, report.e.cells = 0;
            rows[lid] = report;
        }
        group_barrier();
        {
            uint lid = (uint)get_local_id(0), first = lid - lid % BRICK_WORDS;
            emission total = *sums, before = {0, 0, 0}, own = rows[lid].e;
            uint2 base = (uint2)(0, 0);
            uint mask = 0;
            for (uint m = 0; m < WORK_ITEMS; m++) {
                emission row = rows[m].e;
                if (m == first) base = (uint2)(total.vertices, total.triangles);
                if (m >= first && m < lid) before.vertices += row.vertices, before.triangles += row.triangles;
                if (m >= first && m < first + BRICK_WORDS && row.vertices + row.triangles > 0)
                    mask |= 1u << (m - first);
                total.vertices += row.vertices, total.triangles += row.triangles, total.cells += row.cells;
            }
            *sums = total;
            brick b = brick_locate(s, t, min(n + lid / BRICK_WORDS, count - 1));
            if (lid == first && n + lid / BRICK_WORDS < count) {
                bases[brick_index(s, b.y0, z0, b.w)] = base;
                masks[brick_index(s, b.y0, z0, b.w)] = mask;
            }
            if (own.vertices + own.triangles > 0) {
                uint place = lid - first;
                uint index = word_index(s, b.y0 + place % BRICK_ROWS, z0 + place / BRICK_ROWS, b.w);
                offsets[index] = rows[lid].packed + before.vertices;
                triangle_offsets[index] = (ushort)before.triangles;
            }
        }
        group_barrier();
    }
}

#endif

/* The fallback of the scan: one work-item's share of a tile's sums, straight from the samples. */
inline_always emission tile_recount(const slab *s, uint number, global const BITS *samples, global const ulong *cells) {
    tile t = tile_locate(s, number);
    emission sums = {0, 0, 0};
    uint rows = t.y1 - t.y0, count = rows * (t.z1 - t.z0) * s->words_x, ignored = 0;
    for (uint first = 0; first < count; first += WORK_ITEMS) {
        uint n = first + (uint)get_local_id(0);
        if (n >= count) continue;
        uint w = n % s->words_x, y = t.y0 + n / s->words_x % rows, z = t.z0 + n / s->words_x / rows;
        bool next = w + 1 < s->words_x;
        ulong word[4][2];
        for (uint m = 0; m < 4; m++) {
            uint ym = y + (m & 1), zm = z + (m >> 1);
            bool here = ym < s->ny && zm < s->nz;
            word[m][0] = here ? word_inside(samples, s, ym, zm, w, &ignored) : 0;
            word[m][1] = here && next ? word_inside(samples, s, ym, zm, w + 1, &ignored) : 0;
        }
        ulong packed;
        cube_row r = cube_row_of(s, y, z, w, word);
        emission e = row_count(s, &r, y, z, w, cells, &packed);
        sums.vertices += e.vertices, sums.triangles += e.triangles;
    }
    return sums;
}

/* What all tiles before this one emit. Called by the whole group; shared: 4 words of local memory. With spin_limit 1
 * the tile before is always recomputed: that is how a test gets at the fallback. */
inline_always uint2 tile_prefix(const slab *s, uint number, global const BITS *samples, global const ulong *cells,
                                global uint *tiles, local uint *shared) {
    bool leader = get_local_id(0) == 0, complete = false, look = s->spin_limit > 1 || number == 0;
    uint back[2] = {number, number}, prefix[2] = {0, 0};
    while (!complete) {
        group_barrier();
        if (leader) {
            bool done = look && scan_look_back(tiles, TILE_VERTICES, &back[0], &prefix[0], s->spin_limit);
            shared[0] = done && scan_look_back(tiles, TILE_TRIANGLES, &back[1], &prefix[1], s->spin_limit);
            shared[1] = done ? back[1] : back[0];
            shared[2] = shared[3] = 0;
        }
        group_barrier();
        complete = shared[0];
        uint missing = shared[1] - 1;
        look = true;
        if (!complete) {
            emission e = tile_recount(s, missing, samples, cells);
            atomic_add(&shared[2], e.vertices);
            atomic_add(&shared[3], e.triangles);
        }
        group_barrier();
        if (leader && !complete) {
            for (uint channel = 0; channel < 2; channel++) {
                scan_post_sum(tiles, missing, channel, shared[2 + channel]);
                if (back[channel] == missing + 1) prefix[channel] += shared[2 + channel], back[channel] = missing;
            }
        }
    }
    if (leader) {
        shared[0] = prefix[0];
        shared[1] = prefix[1];
    }
    group_barrier();
    return (uint2)(shared[0], shared[1]);
}

/* Turns bases within the tile into bases within the slab, and appends the bricks that emit something to the list. */
inline_always void tile_finish(const slab *s, tile t, uint2 prefix, global uint2 *bases, global const uint *masks,
                               global uint *active, global uint *head, local uint *shared) {
    uint first = brick_index(s, t.y0, t.z0, 0);
    uint count = layer_bricks(s, t) * ((t.z1 - t.z0 + BRICK_PLANES - 1) / BRICK_PLANES);
    uint lid = (uint)get_local_id(0);
    group_barrier();
    if (lid == 0) shared[0] = 0;
    group_barrier();
    for (uint start = 0; start < count; start += WORK_ITEMS)
        if (start + lid < count && masks[first + start + lid]) atomic_inc(&shared[0]);
    group_barrier();
    if (lid == 0) shared[1] = shared[0] ? atomic_add(&head[STATE_ACTIVE_BRICKS], shared[0]) : 0;
    group_barrier();
    for (uint start = 0; start < count; start += WORK_ITEMS) {
        uint n = start + lid;
        if (n < count) bases[first + n] += prefix;
        if (n < count && masks[first + n]) active[atomic_inc(&shared[1])] = first + n;
    }
}

/* Looks back for a tile whose sums are posted, posts its prefix and stores what follows from it. */
inline_always void tile_settle(const slab *s, uint number, global const BITS *samples, global const ulong *cells,
                               global uint2 *bases, global const uint *masks, global uint *active, global uint *head,
                               global uint *tiles, local uint *shared) {
    uint2 prefix = tile_prefix(s, number, samples, cells, tiles, shared);
    if (get_local_id(0) == 0) {
        uint vertices = prefix.x + scan_own_sum(tiles, number, TILE_VERTICES);
        uint triangles = prefix.y + scan_own_sum(tiles, number, TILE_TRIANGLES);
        scan_post_prefix(tiles, number, TILE_VERTICES, vertices);
        scan_post_prefix(tiles, number, TILE_TRIANGLES, triangles);
        if (number + 1 == s->tile_count) head[STATE_VERTICES] = vertices, head[STATE_TRIANGLES] = triangles;
    }
    tile_finish(s, tile_locate(s, number), prefix, bases, masks, active, head, shared);
}

/* state: heads and tiles of the slabs, cleared. scratch: per group, room for the halo of a tile. */
kernel void classify(slab s, global const BITS *samples, global const ulong *cells, global ulong *words,
                     global ulong *offsets, global ushort *triangle_offsets, global uint2 *bases, global uint *masks,
                     global uint *active, global uint *state, global ulong *scratch, uint scratch_words) {
    local uint shared[4];
#if WORK_ITEMS > 1
    local row_report rows[WORK_ITEMS];
#endif
    global uint *head = state + s.head_offset, *tiles = state + s.tiles_offset;
    active += s.active_offset;
    scratch += get_group_id(0) * (size_t)scratch_words;
    uint number = 0, first_own = s.tile_count, last_own = s.tile_count, cell_count = 0, nonfinite = 0;
    while (number < s.tile_count) {
        group_barrier();
        if (get_local_id(0) == 0) shared[0] = atomic_inc(&head[STATE_TICKET]);
        group_barrier();
        number = shared[0];
        group_barrier();
        if (number < s.tile_count) {
            tile t = tile_locate(&s, number);
            emission sums = {0, 0, 0};
            nonfinite |= planes_sign(&s, t, t.z0, t.z0 + 1, samples, words, scratch);
            for (uint z = t.z0; z < t.z1; z += BRICK_PLANES) {
                nonfinite |=
                    planes_sign(&s, t, z + 1, min(z + BRICK_PLANES, min(t.z1, s.nz - 1)) + 1, samples, words, scratch);
                group_barrier();
                layer_count(&s, t, z, words, scratch, cells, offsets, triangle_offsets, bases, masks, &sums
#if WORK_ITEMS > 1
                            ,
                            rows
#endif
                );
            }
            cell_count += sums.cells;
            if (get_local_id(0) == 0) {
                scan_post_sum(tiles, number, TILE_VERTICES, sums.vertices);
                scan_post_sum(tiles, number, TILE_TRIANGLES, sums.triangles);
            }
#if WORK_ITEMS == 1
            if (first_own == s.tile_count)
                first_own = number;
            else
                tiles[TILE_WORDS * last_own + TILE_NEXT] = number;
            tiles[TILE_WORDS * number + TILE_NEXT] = s.tile_count;
            last_own = number;
#else
            tile_settle(&s, number, samples, cells, bases, masks, active, head, tiles, shared);
#endif
        }
    }
#if WORK_ITEMS == 1
    for (uint own = first_own; own < s.tile_count; own = tiles[TILE_WORDS * own + TILE_NEXT])
        tile_settle(&s, own, samples, cells, bases, masks, active, head, tiles, shared);
#endif
    if (nonfinite) atomic_or(&head[STATE_NONFINITE], 1u);
    if (get_local_id(0) == 0 && cell_count) atomic_add(&head[STATE_ACTIVE_CELLS], cell_count);
}
