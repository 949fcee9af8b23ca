/*
 * count_groups.cl - counting where the work-items of a group share bricks: each takes a row
 */

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

/* What a group needs of local memory. */
typedef struct count_room {
    row_report rows[WORK_ITEMS];
} count_room;

/* Counts the layer that begins with plane z; *sums runs on from brick to brick. Each work-item adds up the rows before
 * its own. What comes before a brick is stored within the tile. *emitting: how many bricks of the tile emit something.
 * Nothing but the sums lives across a barrier, and work-items without a row count another one's, as compilers have gone
 * wrong on either. All work-items leave with the same sums. */
inline_always void layer_count(const slab *s, tile t, uint z0, tile_words k, global const ulong *cells,
                               global const brick_range *ranges, global ulong *offsets, global ushort *triangle_offsets,
                               emission *sums, global uint *emitting, local count_room *room) {
    local row_report *rows = room->rows;
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
