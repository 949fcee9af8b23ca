/*
 * interval_numbers.cl - numbers of the vertices of an interval volume
 *
 * A vertex is owned by a sample: it lies at the sample, or on an edge with a bound. A slot (INTERVAL_SLOT) is
 * a row of samples and a type of edge of a bound, or the samples themselves. The number of a vertex is that of its
 * slot's first vertex in the row, plus the slot's vertices at lower x: a population count of a word. For a row of cubes
 * a work-item alone makes a table of words and first numbers. Work-items of groups make the word when a tetrahedron
 * names the vertex, as a table with a variable index would lie in slow memory.
 */
#ifndef INTERVAL_NUMBERS_CL
#define INTERVAL_NUMBERS_CL

#include "interval_rows.cl"

/* Sums over bricks and rows. */
typedef struct interval_sums {
    global const uint *rows;
    global const interval_brick *bricks;
} interval_sums;

/* A row of cubes, and what its numbers are made of. */
typedef struct slot_source {
    const slab *s;
    const interval_job *job;
    const bound *low, *high;
    interval_sums sums;
    const interval_rows *rows;
    global const ulong *cells;
    uint y, z, w;
} slot_source;

/* The number of the first sample within of a row. */
inline_always uint sample_first(const slab *s, const interval_job *job, interval_sums sums, uint y, uint z, uint w) {
    const uint brick = brick_index(s, y, z, w);
    return job->first[INTERVAL_SAMPLES] + sums.bricks[brick].samples +
           (sums.rows[BRICK_WORDS * brick + row_in_brick(s, y, z)] & 0xffff);
}

/* Where the numbers of the vertices of a bound begin that a row owns. */
inline_always row_numbers bound_numbers(const slab *s, const bound *b, uint first, uint y, uint z, uint w) {
    const uint brick = brick_index(s, y, z, w);
    row_numbers o = {first + b->bricks[brick].vertices, b->offsets[BRICK_WORDS * brick + row_in_brick(s, y, z)]};
    return o;
}

/* Edges with a vertex that the samples of row n of a row of cubes own. In rows 1 to 3 only the types that the cubes
 * have are correct. */
inline_always crossings row_crossings(const slab *s, const sample_rows rows[4], uint n, global const ulong *cells,
                                      uint y, uint z, uint w) {
    const sample_rows none = rows_shifted(0, 0);
    const cube_rows r = cube_rows_of(s, y + (n & 1), z + (n >> 1), w, rows[n], n & 1 ? none : rows[n + 1 & 3],
                                     n >> 1 ? none : rows[n + 2 & 3], n ? none : rows[3]);
    crossings edges = crossings_owned(&r);
#if MISSING
    crossings_keep(s, cells, y + (n & 1), z + (n >> 1), w, &edges);
#endif
    return edges;
}

/* This program has one text, in which the build decides on WORK_ITEMS; in others embed.cmake has done so. */
#if WORK_ITEMS >= 32
#if MISSING

/* Edges of a type that a present cube has. */
inline_always ulong edges_kept(const slab *s, global const ulong *cells, uint y, uint z, uint w, uint type) {
    const bool spans_x = type == 0 || type == 3 || type == 4, low_y = type == 0 || type == 2 || type == 4;
    const bool low_z = type == 0 || type == 1 || type == 3;
    ulong kept = spans_x ? cells_at(s, cells, y, z, w) : cells_before(s, cells, y, z, w);
    if (low_y) kept |= spans_x ? cells_at(s, cells, y - 1, z, w) : cells_before(s, cells, y - 1, z, w);
    if (low_z) kept |= spans_x ? cells_at(s, cells, y, z - 1, w) : cells_before(s, cells, y, z - 1, w);
    if (low_y && low_z) kept |= cells_at(s, cells, y - 1, z - 1, w);
    return kept;
}

#endif

/* Edges of a type with a vertex of the bound that the samples of a row own. */
inline_always ulong edges_word(const slab *s, const bound *b, global const ulong *cells, uint y, uint z, uint w,
                               uint type) {
    const uint next_y = type == 1 || type == 3 || type == 5, next_z = type == 2 || type >= 4;
    if (y + next_y >= s->ny || z + next_z >= s->nz) return 0;
    const ulong even = even_cubes(s, y, z), valid = word_valid(s, w), has_x = w + 1 < s->words_x ? valid : valid >> 1;
    const sample_rows here = bound_row(s, b, y, z, w), there = bound_row(s, b, y + next_y, z + next_z, w);
    ulong crossed = (here.at ^ there.at) & valid;
    if (type == 0) crossed = (here.at ^ here.next) & has_x;
    if (type == 3 || type == 4) crossed = choose(even, here.at ^ there.next, here.next ^ there.at) & has_x;
    if (type == 5)
        crossed = choose(even, crossed, (bound_row(s, b, y + 1, z, w).at ^ bound_row(s, b, y, z + 1, w).at) & valid);
#if MISSING
    crossed &= edges_kept(s, cells, y, z, w, type);
#endif
    return crossed;
}

/* The word of a slot: samples that own a vertex there. */
inline_always ulong slot_word(const slot_source *r, uint slot) {
    const uint block = slot >> 5, y = r->y + (slot >> 3 & 1), z = r->z + (slot >> 4 & 1);
    if (block == INTERVAL_SAMPLES) return samples_within(r->s, r->low, r->high, r->cells, y, z, r->w);
    return edges_word(r->s, block == INTERVAL_LOW_BOUND ? r->low : r->high, r->cells, y, z, r->w, slot & 7);
}

#endif

/* The number of the first vertex of a slot, in word w of its row. */
inline_always uint slot_first(const slot_source *r, uint slot, uint w) {
    const uint block = slot >> 5, y = r->y + (slot >> 3 & 1), z = r->z + (slot >> 4 & 1);
    if (block == INTERVAL_SAMPLES) return sample_first(r->s, r->job, r->sums, y, z, w);
    const bound *b = block == INTERVAL_LOW_BOUND ? r->low : r->high;
    const uint first = r->job->first[block == INTERVAL_LOW_BOUND ? INTERVAL_LOW_BOUND : INTERVAL_HIGH_BOUND];
    return number_of(bound_numbers(r->s, b, first, y, z, w), slot & 7);
}

/* An entry of the table of cases: parity of a cube, tetrahedron, case. */
inline_always global const uchar *interval_entry(global const uchar *cases, uint tetrahedron, uint index) {
    return cases + INTERVAL_DIGIT_BYTES + INTERVAL_ENTRY_BYTES * (INTERVAL_CASE_COUNT * tetrahedron + index);
}

/* Corner m, of 40, of the ten tetrahedra of two cubes side by side that lie wholly within. */
inline_always uint run_vertex(global const uchar *cases, uint odd, uint m) {
    global const uchar *entry = interval_entry(cases, 5 * (odd ^ (m >= 20)) + m / 4 % 5, INTERVAL_WITHIN);
    return entry[INTERVAL_ENTRY_VERTICES + entry[INTERVAL_ENTRY_CORNERS + m % 4]];
}

#if WORK_ITEMS < 32

/* For each slot its word, the number of the first vertex, and of the first one in the next word, where the last cube
 * of the row needs that. */
typedef struct row_slots {
    ulong word[INTERVAL_SLOTS];
    uint first[INTERVAL_SLOTS], next[INTERVAL_SLOTS];
    bool has_next;
} row_slots;

/* Types of edges that cubes have of row n of their rows of samples: a bit each. */
#define ROW_TYPES(n) ((n) == 0 ? 0x3fu : (n) == 1 ? 0x15u : (n) == 2 ? 0x0bu : 0x01u)

inline_always void slot_fill(const slot_source *r, uint slot, ulong word, row_slots *p) {
    p->word[slot] = word;
    p->first[slot] = slot_first(r, slot, r->w);
    if (p->has_next) p->next[slot] = slot_first(r, slot, r->w + 1);
}

inline_always void slots_of_bound(const slot_source *r, const bound *b, const sample_rows rows[4], uint block,
                                  row_slots *p) {
    if (!b->exists) return;
#pragma unroll
    for (uint n = 0; n < 4; n++) {
        const crossings edges = row_crossings(r->s, rows, n, r->cells, r->y, r->z, r->w);
#pragma unroll
        for (uint type = 0; type < 6; type++)
            if (ROW_TYPES(n) >> type & 1) slot_fill(r, INTERVAL_SLOT(block, n, type), edges.type[type], p);
    }
}

/* reached: cubes that have any tetrahedra; partial: those of them that are not wholly within, so that their vertices
 * are on edges too. */
inline_always void slots_begin(const slot_source *r, ulong reached, ulong partial, row_slots *p) {
    p->has_next = reached >> 63;
#pragma unroll
    for (uint n = 0; n < 4; n++)
        slot_fill(r, INTERVAL_SLOT(INTERVAL_SAMPLES, n, 0),
                  samples_within(r->s, r->low, r->high, r->cells, r->y + (n & 1), r->z + (n >> 1), r->w), p);
    if (!partial) return;
    slots_of_bound(r, r->low, r->rows->low, INTERVAL_LOW_BOUND, p);
    slots_of_bound(r, r->high, r->rows->high, INTERVAL_HIGH_BOUND, p);
}

/* The number of a vertex (INTERVAL_VERTEX) of the cube at a bit of the row. */
inline_always uint slot_number(const slot_source *r, const row_slots *p, uint vertex, uint bit) {
    const uint slot = vertex >> 1, x = bit + (vertex & 1);
    return x == 64 ? p->next[slot] : p->first[slot] + (uint)popcount(p->word[slot] & ((1ul << x) - 1));
}

/* The tetrahedra of an entry, for the cube at a bit. */
inline_always global uint *tetrahedra_store(const slot_source *r, const row_slots *p, global const uchar *entry,
                                            uint bit, global uint *out) {
    uint numbers[INTERVAL_VERTICES_MOST];
    const uint count = entry[0], vertices = entry[1];
    for (uint n = 0; n < vertices; n++) numbers[n] = slot_number(r, p, entry[INTERVAL_ENTRY_VERTICES + n], bit);
    for (uint n = 0; n < count; n++) {
        const uchar4 at = vload4(n, entry + INTERVAL_ENTRY_CORNERS);
        vstore4((uint4)(numbers[at.x], numbers[at.y], numbers[at.z], numbers[at.w]), n, out);
    }
    return out + 4 * count;
}

/* Cubes that lie wholly within, `length` of them from a bit on; none is cube 63, some of whose vertices are in the next
 * word. Numbers rise by one from cube to cube. */
inline_always global uint *run_store(const slot_source *r, const row_slots *p, uint bit, uint length, uint odd,
                                     global const uchar *cases, global uint *out) {
    uint start[40];
    uint8 pair[5];
    for (uint m = 0; m < 40; m++) start[m] = slot_number(r, p, run_vertex(cases, odd, m), bit + (m >= 20));
#pragma unroll
    for (uint n = 0; n < 5; n++) pair[n] = vload8(n, start);
    for (uint n = 0; n + 2 <= length; n += 2, out += 40) {
#pragma unroll
        for (uint m = 0; m < 5; m++) vstore8(pair[m] + n, m, out);
    }
    for (uint m = 0; m < 20 && length & 1; m++) out[m] = start[m] + length - 1;
    return length & 1 ? out + 20 : out;
}

#else

typedef struct row_slots {
    uint none;
} row_slots;

inline_always void slots_begin(const slot_source *r, ulong reached, ulong partial, row_slots *p) { p->none = 0; }

inline_always uint slot_number(const slot_source *r, const row_slots *p, uint vertex, uint bit) {
    const uint slot = vertex >> 1, x = bit + (vertex & 1);
    if (x == 64) return slot_first(r, slot, r->w + 1);
    return slot_first(r, slot, r->w) + (uint)popcount(slot_word(r, slot) & ((1ul << x) - 1));
}

inline_always global uint *tetrahedra_store(const slot_source *r, const row_slots *p, global const uchar *entry,
                                            uint bit, global uint *out) {
    const uint corners = 4 * (uint)entry[0];
    for (uint m = 0; m < corners; m++)
        out[m] = slot_number(r, p, entry[INTERVAL_ENTRY_VERTICES + entry[INTERVAL_ENTRY_CORNERS + m]], bit);
    return out + corners;
}

inline_always global uint *run_store(const slot_source *r, const row_slots *p, uint bit, uint length, uint odd,
                                     global const uchar *cases, global uint *out) {
#pragma unroll 1
    for (uint m = 0; m < 40; m++) {
        const uint start = slot_number(r, p, run_vertex(cases, odd, m), bit + (m >= 20));
        for (uint n = 0; n + (m >= 20) < length; n += 2) out[20 * n + m] = start + n;
    }
    return out + 20 * length;
}

#endif

#endif
