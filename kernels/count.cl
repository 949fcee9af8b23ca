/*
 * count.cl - the second stage of kernel 1: what the rows of a tile's bricks emit, and where in the brick it begins
 *
 * A tile is a run of bricks: tile_rows rows of bricks in one layer, or tile_layers whole layers. The words of its
 * samples are where sign.cl left them; of the halo, the next row and the next plane of samples, which other tiles own,
 * they are in scratch. Where a work-item has bricks to itself it skips those that are uniform and whose neighbours
 * are the same.
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

typedef struct tile_words {
    global ulong *words, *scratch;
    global brick_state *bricks;
} tile_words;

/* Scratch holds the plane z1, brick by brick the eight words of its rows (of the last brick, at y1, but one), then for
 * every plane of the tile the words of row y1. */
inline_always ulong halo_plane(const slab *s, tile t, uint y, uint w) {
    return BRICK_ROWS * ((ulong)(y - t.y0) / BRICK_ROWS * s->words_x + w) + y % BRICK_ROWS;
}

inline_always ulong halo_row(const slab *s, tile t, uint z, uint w) {
    return BRICK_ROWS * (ulong)(s->tile_rows + 1) * s->words_x + (ulong)(z - t.z0) * s->words_x + w;
}

/* The word of a row in the grid, which the words of the next rows of its brick follow (not at y1). */
inline_always global const ulong *tile_row(const slab *s, tile t, uint y, uint z, uint w, tile_words k) {
    if (z >= t.z1) return k.scratch + halo_plane(s, t, y, w);
    if (y >= t.y1) return k.scratch + halo_row(s, t, z, w);
    uint number = brick_index(s, y, z, w);
    return brick_words(number, k.bricks[number].sign, k.words) + row_place(s, y, z);
}

inline_always void halo_make(const slab *s, tile t, global const BITS *samples, global const brick_range *ranges,
                             global ulong *scratch) {
    if (t.y1 < s->ny)
        for (uint z = t.z0; z < t.z1; z++) row_words_make(s, t.y1, z, samples, ranges, scratch + halo_row(s, t, z, 0));
    if (t.z1 < s->nz)
        for (uint y = t.y0; y < min(t.y1 + 1, s->ny); y += BRICK_ROWS)
            rows_words_make(s, y, min(t.y1 + 1, s->ny), t.z1, samples, ranges, scratch + halo_plane(s, t, y, 0));
}

typedef struct emission {
    uint vertices, triangles, cells;
} emission;

/* Of LANES rows of 64 cubes. */
typedef struct row_counts {
    lanes packed; /* as offsets_pack makes it */
    lanes vertices, triangles, cells;
} row_counts;

inline_always row_counts rows_count(const slab *s, const cube_rows *r, uint y, uint z, uint w,
                                    global const ulong *cells) {
    row_counts c = {0, 0, 0, 0};
    crossings k = crossings_owned(r);
    lanes active = cubes_active(r);
#if MISSING
    crossings_keep(s, cells, y, z, w, &k);
    active &= cells_rows(s, cells, y, z, w);
#endif
    if (!lanes_any(active | crossings_any(&k))) return c;
    c.packed = offsets_pack(&k, &c.vertices);
    c.triangles = triangles_count(r, active);
    c.cells = lanes_popcount(active);
    return c;
}

inline_always uint layer_bricks(const slab *s, tile t) {
    return (t.y1 - t.y0 + BRICK_ROWS - 1) / BRICK_ROWS * s->words_x;
}

#if WORK_ITEMS == 1

/* Samples of rows that exist. */
inline_always lanes rows_valid(const slab *s, uint y, uint w) {
    return lanes_select(LANE_NUMBERS + y < (lanes)s->ny) & word_valid(s, w);
}

/* Whether the samples that follow a uniform brick in x, y or z have one on the other side. Those of its tile that are
 * uniform too have not where they are on its side. */
inline_always bool neighbours_differ(const slab *s, tile t, uint y, uint z, uint w, tile_words k, uint sign) {
    const ulong uniform = sign_word(sign);
    for (uint n = 1; n < 8; n++) {
        const uint across = w + (n & 1), up = y + (n & 2 ? BRICK_ROWS : 0), deep = z + (n & 4 ? BRICK_PLANES : 0);
        if (across >= s->words_x || up >= s->ny || deep >= s->nz) continue;
        const uint found = up < t.y1 && deep < t.z1 ? k.bricks[brick_index(s, up, deep, across)].sign : SIGN_MIXED;
        if (found == sign) continue;
        if (found != SIGN_MIXED) return true;
        const ulong columns = n & 1 ? 1 : word_valid(s, across);
        const uint planes = n & 4 ? 1 : min((uint)BRICK_PLANES, t.z1 - z);
        const uint stride = up < t.y1 ? BRICK_ROWS : s->words_x; /* from plane to plane */
        global const ulong *row = tile_row(s, t, up, deep, across, k);
        lanes differ = 0;
        ulong differs = 0;
        for (uint plane = 0; plane < planes; plane++, row += stride)
            if (n & 2)
                differs |= *row ^ uniform;
            else
                differ |= vload8(0, row) ^ uniform;
        if (n & 2 ? differs & columns : lanes_any(differ & rows_valid(s, up, across) & columns)) return true;
    }
    return false;
}

/* Whether a brick emits something, or, where it is mixed, may. The bricks at higher x, y and z tell at once where they
 * are of this tile and on its side. */
inline_always bool brick_emits(const slab *s, tile t, uint y, uint z, uint w, tile_words k) {
    const uint number = brick_index(s, y, z, w), sign = k.bricks[number].sign;
    if (sign == SIGN_MIXED) return true;
    const uint across = w + 1 < s->words_x ? 1 : 0, up = y + BRICK_ROWS < t.y1 ? s->words_x : 0;
    const uint deep = z + BRICK_PLANES < t.z1 ? s->words_x * s->bricks_y : 0;
    global const brick_state *here = k.bricks + number, *behind = here + deep;
    const uint differ = (here[across].sign ^ sign) | (here[up].sign ^ sign) | (here[up + across].sign ^ sign) |
                        (behind[0].sign ^ sign) | (behind[across].sign ^ sign) | (behind[up].sign ^ sign) |
                        (behind[up + across].sign ^ sign);
    const bool halo = (!up && t.y1 < s->ny) || (!deep && t.z1 < s->nz);
    return (differ || halo) && neighbours_differ(s, t, y, z, w, k, sign);
}

/* The words that cubes of a brick take from one brick: where those of its planes are, and of the plane after. */
typedef struct column {
    global const ulong *first, *after;
    uint stride; /* from plane to plane */
    lanes valid; /* samples that exist */
} column;

/* Outside the grid all words are 0. */
inline_always column column_of(const slab *s, tile t, uint y, uint z, uint w, tile_words k) {
    global const ulong *none = brick_words(0, SIGN_OUTSIDE, k.words);
    column c = {none, none, 0, 0};
    if (w >= s->words_x || y >= s->ny) return c;
    const uint end = min(z + BRICK_PLANES, t.z1);
    c.first = tile_row(s, t, y, z, w, k), c.stride = y < t.y1 ? BRICK_ROWS : s->words_x;
    if (end < s->nz) c.after = tile_row(s, t, y, end, w, k);
    c.valid = rows_valid(s, y, w);
    return c;
}

/* Of the brick, of that at higher x, and of the rows after both. */
typedef struct brick_columns {
    column at, next, last, last_next;
} brick_columns;

inline_always brick_columns columns_of(const slab *s, tile t, uint y, uint z, uint w, tile_words k) {
    brick_columns c = {column_of(s, t, y, z, w, k), column_of(s, t, y, z, w + 1, k),
                       column_of(s, t, y + BRICK_ROWS, z, w, k), column_of(s, t, y + BRICK_ROWS, z, w + 1, k)};
    return c;
}

inline_always global const ulong *column_row(column c, uint plane, bool after) {
    return after ? c.after : c.first + plane * c.stride;
}

/* Rows y to y + 7 and y + 1 to y + 8 of a plane, which may be the one after the brick. */
inline_always void plane_rows(brick_columns c, uint plane, bool after, sample_rows *a, sample_rows *b) {
    lanes at = vload8(0, column_row(c.at, plane, after)) & c.at.valid;
    lanes next = vload8(0, column_row(c.next, plane, after)) & c.next.valid;
    ulong last = *column_row(c.last, plane, after) & c.last.valid.s0;
    ulong last_next = *column_row(c.last_next, plane, after) & c.last_next.valid.s0;
    *a = rows_shifted(at, next);
    *b = rows_shifted(lanes_up(at, last), lanes_up(next, last_next));
}

/* Of each lane, what the lanes before it have in all. */
inline_always lanes lanes_before(lanes x) {
    x = (lanes)(0, x.s0123, x.s456);
    x += (lanes)(0, x.s0123, x.s456);
    x += (lanes)(0, 0, x.s0123, x.s45);
    return x + (lanes)(0, 0, 0, 0, x.s0123);
}

typedef ushort ushorts8 __attribute__((ext_vector_type(8)));

/* Counts a brick, stores where in it each row's output begins and returns which rows emit. */
inline_always uint brick_count(const slab *s, tile t, uint y, uint z, uint w, tile_words k, global const ulong *cells,
                               global ulong *offsets, global ushort *triangle_offsets, emission *sums) {
    const uint number = brick_index(s, y, z, w), planes = min((uint)BRICK_PLANES, t.z1 - z);
    const brick_columns columns = columns_of(s, t, y, z, w, k);
    uint mask = 0;
    lanes cells_seen = 0, begins = 0; /* vertices, and 32 bits higher triangles, of the planes before */
    sample_rows a, b, c, d;
    plane_rows(columns, 0, false, &a, &b);
    for (uint plane = 0; plane < planes; plane++) {
        plane_rows(columns, plane + 1, plane + 1 == planes, &c, &d);
        cube_rows r = cube_rows_of(s, y, z + plane, w, a, b, c, d);
        a = c, b = d;
        row_counts rows = rows_count(s, &r, y, z + plane, w, cells);
        lanes both = rows.vertices | rows.triangles << 32;
        if (!lanes_any(both)) continue;
        lanes before = lanes_before(both) + begins;
        vstore8(rows.packed + (before & 0xfffffffful), BRICK_PLANES * number + plane, offsets);
        *(global ushorts8 *)(triangle_offsets + BRICK_ROWS * (BRICK_PLANES * number + plane)) =
            __builtin_convertvector(before >> 32, ushorts8);
        begins = (lanes)(before.s7 + both.s7);
        mask |= lanes_nonzero(both) << (BRICK_ROWS * plane);
        cells_seen += rows.cells;
    }
    sums->cells += (uint)lanes_sum(cells_seen);
    sums->vertices += (uint)begins.s0, sums->triangles += (uint)(begins.s0 >> 32);
    return mask;
}

/* Whether a run of bricks and those at higher x, y and z are known to be all on one side: nothing of it emits. */
inline_always bool run_skipped(const slab *s, tile t, uint y, uint z, uint w, uint count,
                               global const brick_range *ranges) {
    const uint up = y + BRICK_ROWS < s->ny ? s->words_x : 0;
    const uint deep = z + BRICK_PLANES < s->z1 ? s->words_x * s->bricks_y : 0;
    const uint across = w + count < s->words_x ? count : count - 1;
    if (z + BRICK_PLANES >= s->z1 && s->z1 < s->nz) return false;
    if (!s->ranges_known && (y + BRICK_ROWS >= t.y1 || z + BRICK_PLANES >= t.z1)) return false;
    global const brick_range *here = ranges + s->range_offset + brick_index(s, y, z, w);
    uint sign = run_sign(s, here, count);
    return sign != SIGN_MIXED && run_sign(s, here + up, count) == sign && run_sign(s, here + deep, count) == sign &&
           run_sign(s, here + up + deep, count) == sign && range_sign(s, here[across]) == sign &&
           range_sign(s, here[up + across]) == sign && range_sign(s, here[deep + across]) == sign &&
           range_sign(s, here[up + deep + across]) == sign;
}

/* Counts the layer that begins with plane z, brick by brick; *sums runs on from brick to brick. What comes before a
 * brick is stored within the tile. *emitting: how many bricks of the tile emit something. */
inline_always void layer_count(const slab *s, tile t, uint z, tile_words k, global const ulong *cells,
                               global const brick_range *ranges, global ulong *offsets, global ushort *triangle_offsets,
                               emission *sums, global uint *emitting) {
    global brick_state *first = &k.bricks[brick_index(s, t.y0, z, 0)];
    first->vertices = sums->vertices, first->triangles = sums->triangles;
    for (uint y = t.y0; y < t.y1; y += BRICK_ROWS)
        for (uint run = 0; run < s->words_x; run += RUN_BRICKS_X) {
            uint end = min(run + RUN_BRICKS_X, s->words_x);
            if (run_skipped(s, t, y, z, run, end - run, ranges)) continue;
            for (uint w = run; w < end; w++) {
                if (!brick_emits(s, t, y, z, w, k)) continue;
                global brick_state *b = &k.bricks[brick_index(s, y, z, w)];
                b->vertices = sums->vertices, b->triangles = sums->triangles;
                b->rows = brick_count(s, t, y, z, w, k, cells, offsets, triangle_offsets, sums);
                *emitting += b->rows != 0;
            }
        }
}

#else

/* Brick n of a layer of the tile: x, then y. */
typedef struct brick {
    uint w, y0;
} brick;

inline_always brick brick_locate(const slab *s, tile t, uint n) {
    brick b = {n % s->words_x, t.y0 + n / s->words_x * BRICK_ROWS};
    return b;
}

inline_always sample_rows tile_rows_at(const slab *s, tile t, uint y, uint z, uint w, tile_words k) {
    ulong at = 0, next = 0;
    if (y < s->ny && z < s->nz) {
        at = *tile_row(s, t, y, z, w, k) & word_valid(s, w);
        if (w + 1 < s->words_x) next = *tile_row(s, t, y, z, w + 1, k) & word_valid(s, w + 1);
    }
    return rows_shifted(at, next);
}

/* What a work-item tells its group about the row that it counted. */
typedef struct row_report {
    ulong packed;
    emission e;
} row_report;

inline_always row_report row_count(const slab *s, tile t, uint y, uint z, uint w, tile_words k,
                                   global const ulong *cells) {
    cube_rows r = cube_rows_of(s, y, z, w, tile_rows_at(s, t, y, z, w, k), tile_rows_at(s, t, y + 1, z, w, k),
                               tile_rows_at(s, t, y, z + 1, w, k), tile_rows_at(s, t, y + 1, z + 1, w, k));
    row_counts c = rows_count(s, &r, y, z, w, cells);
    row_report report = {c.packed, {(uint)c.vertices, (uint)c.triangles, (uint)c.cells}};
    return report;
}

/* The same with a work-item per row of a brick: each adds up the rows before its own. Nothing but the sums lives across
 * a barrier, and work-items without a row count another one's, as compilers have gone wrong on either. All work-items
 * leave with the same sums. */
inline_always void layer_count(const slab *s, tile t, uint z0, tile_words k, global const ulong *cells,
                               global const brick_range *ranges, global ulong *offsets, global ushort *triangle_offsets,
                               emission *sums, global uint *emitting, local row_report *rows) {
    uint count = layer_bricks(s, t);
    for (uint n = 0; n < count; n += BRICKS_AT_ONCE) {
        {
            uint lid = (uint)get_local_id(0), place = lid % BRICK_WORDS;
            brick b = brick_locate(s, t, min(n + lid / BRICK_WORDS, count - 1));
            uint y = b.y0 + place % BRICK_ROWS, z = z0 + place / BRICK_ROWS;
            bool mine = n + lid / BRICK_WORDS < count && y < t.y1 && z < t.z1;
            row_report report = row_count(s, t, mine ? y : b.y0, mine ? z : z0, b.w, k, cells);
            if (!mine) report.e.vertices = 0, report.e.triangles = 0, report.e.cells = 0;
            rows[lid] = report;
        }
        group_barrier();
        {
            uint lid = (uint)get_local_id(0), first = lid - lid % BRICK_WORDS;
            emission total = *sums, before = {0, 0, 0}, own = rows[lid].e;
            uint vertices = 0, triangles = 0, mask = 0;
            for (uint m = 0; m < WORK_ITEMS; m++) {
                emission row = rows[m].e;
                if (m == first) vertices = total.vertices, triangles = total.triangles;
                if (m >= first && m < lid) before.vertices += row.vertices, before.triangles += row.triangles;
                if (m >= first && m < first + BRICK_WORDS && row.vertices + row.triangles > 0)
                    mask |= 1u << (m - first);
                total.vertices += row.vertices, total.triangles += row.triangles, total.cells += row.cells;
            }
            *sums = total;
            brick b = brick_locate(s, t, min(n + lid / BRICK_WORDS, count - 1));
            uint number = brick_index(s, b.y0, z0, b.w);
            if (lid == first && n + lid / BRICK_WORDS < count) {
                k.bricks[number].vertices = vertices, k.bricks[number].triangles = triangles;
                k.bricks[number].rows = mask;
                if (mask) atomic_inc(emitting);
            }
            if (own.vertices + own.triangles > 0) {
                offsets[BRICK_WORDS * number + lid - first] = rows[lid].packed + before.vertices;
                triangle_offsets[BRICK_WORDS * number + lid - first] = (ushort)before.triangles;
            }
        }
        group_barrier();
    }
}

#endif

/* LANES rows of samples straight from the samples. */
inline_always lanes rows_inside(const slab *s, uint y, uint z, uint w, global const BITS *samples) {
    ulong word[LANES];
    for (uint n = 0; n < LANES; n++)
        word[n] = w < s->words_x && y + n < s->ny && z < s->nz ? word_inside(samples, s, y + n, z, w) : 0;
#if LANES == 8
    return vload8(0, word);
#else
    return word[0];
#endif
}

/* The fallback of the scan: one work-item's share of a tile's sums, straight from the samples. */
inline_always emission tile_recount(const slab *s, uint number, global const BITS *samples, global const ulong *cells) {
    tile t = tile_locate(s, number);
    emission sums = {0, 0, 0};
    uint rows = (t.y1 - t.y0 + LANES - 1) / LANES, count = rows * (t.z1 - t.z0) * s->words_x;
    for (uint first = 0; first < count; first += WORK_ITEMS) {
        uint n = first + (uint)get_local_id(0);
        if (n >= count) continue;
        uint w = n % s->words_x, y = t.y0 + n / s->words_x % rows * LANES, z = t.z0 + n / s->words_x / rows;
        lanes words[4][2]; /* of the cubes' four rows, at w and w + 1 */
#pragma unroll 1
        for (uint m = 0; m < 8; m++) words[m / 2][m % 2] = rows_inside(s, y + m / 2 % 2, z + m / 4, w + m % 2, samples);
        cube_rows r =
            cube_rows_of(s, y, z, w, rows_shifted(words[0][0], words[0][1]), rows_shifted(words[1][0], words[1][1]),
                         rows_shifted(words[2][0], words[2][1]), rows_shifted(words[3][0], words[3][1]));
        row_counts c = rows_count(s, &r, y, z, w, cells);
        sums.vertices += (uint)lanes_sum(c.vertices), sums.triangles += (uint)lanes_sum(c.triangles);
    }
    return sums;
}
