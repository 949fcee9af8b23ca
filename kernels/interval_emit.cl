/*
 * interval_emit.cl - kernel interval_emit: vertices and tetrahedra of an interval volume
 *
 * The number of a vertex is that of kernel 2 (mesh.cl), of a sample within likewise: what bricks, rows and samples
 * before it have. For a row of cubes a table holds the words in which vertices are counted, for each place that owns
 * some: block, row of samples, type of edge. Tetrahedra come from the table of cases; runs of cubes that lie within
 * whole have numbers that rise by one from cube to cube.
 */
#ifndef INTERVAL_EMIT_CL
#define INTERVAL_EMIT_CL

#include "interval_rows.cl"

#ifdef REAL

/* The four buffers of what is made. */
typedef struct interval_mesh {
    global float *positions[INTERVAL_BLOCKS];
    global uint *tetrahedra;
} interval_mesh;

/* Sums over bricks and rows. */
typedef struct interval_sums {
    global const uint *rows;
    global const interval_brick *bricks;
} interval_sums;

/* -------------------------------------------------------------------------------------------------------- vertices */

/* The vertex at t on an edge, of the brick at a corner. */
inline_always void vertex_store(const slab *s, corner first, uint edge, bool is_sample, REAL isovalue, grid_arrays in,
                                global float *out) {
    const ulong from =
        row_start(s, first.y + (edge >> 7 & 0xf), first.z + (edge >> 11 & 7)) + (uint)(first.x + (edge & 0x7f));
    const long step = edge_step(s, edge);
    float position[3], t = 0;
    if (!is_sample) t = crossing(SAMPLE_VALUE(in.samples[from]), SAMPLE_VALUE(in.samples[from + step]), isovalue);
#if GRID
    position_between(s, in, first, edge, from, step, t, position);
#else
    position_make(s, first, edge, t, position);
#endif
    for (uint m = 0; m < 3; m++) out[m] = position[m];
}

/* Vertices at a row's samples within. */
inline_always void samples_store(const slab *s, corner first, uint y, uint z, ulong within, grid_arrays in,
                                 global float *out) {
    const uint row = EDGE_PLACE + ((y - first.y) << 7 | (z - first.z) << 11);
    for (; within; within &= within - 1, out += 3) vertex_store(s, first, row + lowest_bit(within), true, 0, in, out);
}

/* Vertices of a bound that a row's samples own. */
inline_always void crossings_store(const slab *s, corner first, uint y, uint z, const crossings *edges, REAL isovalue,
                                   grid_arrays in, global float *out) {
    const uint row = (y - first.y) << 7 | (z - first.z) << 11;
    const ulong even = even_cubes(s, y, z);
#pragma unroll
    for (uint type = 0; type < 6; type++) {
        const uint codes[2] = {row + edge_code(type, true), row + edge_code(type, false)};
#pragma unroll 1
        for (ulong crossed = edges->type[type]; crossed; crossed &= crossed - 1, out += 3) {
            const uint bit = lowest_bit(crossed);
            vertex_store(s, first, (even >> bit & 1 ? codes[1] : codes[0]) + bit, false, isovalue, in, out);
        }
    }
}

/* --------------------------------------------------------------------------------------------------------- numbers */

/* For each place (INTERVAL_PLACE): samples that own a vertex, the number of the first one, and of the first one in the
 * next word. */
typedef struct row_places {
    ulong word[INTERVAL_PLACES];
    uint first[INTERVAL_PLACES], next[INTERVAL_PLACES];
} row_places;

/* The number of the first sample within of a row. */
inline_always uint sample_first(const slab *s, const interval_job *job, interval_sums sums, uint y, uint z, uint w) {
    const uint number = brick_index(s, y, z, w);
    return job->first[INTERVAL_SAMPLES] + sums.bricks[number].samples +
           (sums.rows[BRICK_WORDS * number + row_in_brick(s, y, z)] & 0xffff);
}

/* Where the numbers of the vertices of a bound begin that a row owns. */
inline_always owner bound_owner(const slab *s, const bound *b, uint first, uint y, uint z, uint w) {
    const uint number = brick_index(s, y, z, w);
    owner o = {first + b->bricks[number].vertices, b->offsets[BRICK_WORDS * number + row_in_brick(s, y, z)]};
    return o;
}

/* Edges with a vertex that the samples of row n of a row of cubes own. In rows behind the first only those of types are
 * right that the cubes have. */
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

/* Types of edges that cubes have of each of their rows of samples, and at x + 1: a bit each. */
#define ROW_TYPES(n)  ((n) == 0 ? 0x3fu : (n) == 1 ? 0x15u : (n) == 2 ? 0x0bu : 0x01u)
#define NEXT_TYPES(n) ((n) == 0 ? 0x26u : (n) == 1 ? 0x04u : (n) == 2 ? 0x02u : 0)

inline_always void places_of_bound(const slab *s, const bound *b, const sample_rows rows[4], uint block, uint first,
                                   global const ulong *cells, uint y, uint z, uint w, row_places *p) {
    if (!b->exists) return;
#pragma unroll 1
    for (uint n = 0; n < 4; n++) {
        const crossings edges = row_crossings(s, rows, n, cells, y, z, w);
        const uint yn = y + (n & 1), zn = z + (n >> 1);
        const owner o = bound_owner(s, b, first, yn, zn, w);
        owner next = o;
        if (w + 1 < s->words_x) next = bound_owner(s, b, first, yn, zn, w + 1);
#pragma unroll
        for (uint type = 0; type < 6; type++) {
            const uint place = INTERVAL_PLACE(block, n, type);
            if (!(ROW_TYPES(n) >> type & 1)) continue;
            p->word[place] = edges.type[type], p->first[place] = number_of(o, type);
            if (NEXT_TYPES(n) >> type & 1) p->next[place] = number_of(next, type);
        }
    }
}

inline_always void places_of_samples(const slab *s, const interval_job *job, const bound *low, const bound *high,
                                     interval_sums sums, global const ulong *cells, uint y, uint z, uint w,
                                     row_places *p) {
#pragma unroll
    for (uint n = 0; n < 4; n++) {
        const uint place = INTERVAL_PLACE(INTERVAL_SAMPLES, n, 0), yn = y + (n & 1), zn = z + (n >> 1);
        p->word[place] = samples_within(s, low, high, cells, yn, zn, w);
        p->first[place] = sample_first(s, job, sums, yn, zn, w);
        p->next[place] = w + 1 < s->words_x ? sample_first(s, job, sums, yn, zn, w + 1) : 0;
    }
}

/* The number of a vertex (INTERVAL_VERTEX) of the cube at a bit of the row. */
inline_always uint place_number(const row_places *p, uint vertex, uint bit) {
    const uint place = vertex >> 1, x = bit + (vertex & 1);
    return x == 64 ? p->next[place] : p->first[place] + (uint)popcount(p->word[place] & ((1ul << x) - 1));
}

/* ------------------------------------------------------------------------------------------------------- tetrahedra */

/* A pattern of the corners of the cube at a bit, of words that are `at` and shifted. */
inline_always uint corners_at(const sample_rows rows[4], uint bit) {
    uint pattern = 0;
#pragma unroll
    for (uint n = 0; n < 4; n++)
        pattern |= (uint)(rows[n].at >> bit & 1) << (2 * n) | (uint)(rows[n].next >> bit & 1) << (2 * n + 1);
    return pattern;
}

inline_always global uint *cube_store(const interval_rows *r, uint bit, uint odd, const row_places *p,
                                      global const uchar *cases, global uint *out) {
    const uint low = corners_at(r->low, bit), high = corners_at(r->high, bit);
#pragma unroll 1
    for (uint n = 5 * odd; n < 5 * odd + 5; n++) {
        const uint index = (uint)cases[256 * n + low] + cases[256 * n + high];
        global const uchar *entry =
            cases + INTERVAL_DIGIT_BYTES + INTERVAL_ENTRY_BYTES * (INTERVAL_CASE_COUNT * n + index);
        const uint count = 4 * (uint)entry[0];
        for (uint m = 0; m < count; m++) out[m] = place_number(p, entry[1 + m], bit);
        out += count;
    }
    return out;
}

/* Cubes that lie within whole, `length` of them from a bit on; the last is not the row's. */
inline_always global uint *run_store(uint bit, uint length, uint odd, const row_places *p, global const uchar *cases,
                                     global uint *out) {
    uint start[40];
    uint8 pair[5];
    for (uint m = 0; m < 40; m++) {
        const uint second = m >= 20, n = 5 * (odd ^ second) + m / 4 % 5;
        global const uchar *entry =
            cases + INTERVAL_DIGIT_BYTES + INTERVAL_ENTRY_BYTES * (INTERVAL_CASE_COUNT * n + INTERVAL_WITHIN);
        start[m] = place_number(p, entry[1 + m % 4], bit + second);
    }
#pragma unroll
    for (uint n = 0; n < 5; n++) pair[n] = vload8(n, start);
    for (uint n = 0; n + 2 <= length; n += 2, out += 40) {
#pragma unroll
        for (uint m = 0; m < 5; m++) vstore8(pair[m] + n, m, out);
    }
    for (uint m = 0; m < 20 && length & 1; m++) out[m] = start[m] + length - 1;
    return length & 1 ? out + 20 : out;
}

/* Cubes that lie within whole. */
inline_always ulong cubes_within(const interval_rows *r, ulong present) {
#pragma unroll
    for (uint n = 0; n < 4; n++) present &= r->low[n].at & r->low[n].next & ~(r->high[n].at | r->high[n].next);
    return present;
}

inline_always void row_tetrahedra(const slab *s, const interval_job *job, const bound *low, const bound *high,
                                  interval_sums sums, const interval_rows *r, global const ulong *cells, uint y, uint z,
                                  uint w, global const uchar *cases, global uint *out) {
    const ulong present = cubes_present(s, cells, y, z, w), even = even_cubes(s, y, z);
    const ulong whole = cubes_within(r, present);
    ulong left = cubes_reached(r, present);
    row_places p;
    if (!left) return;
    places_of_samples(s, job, low, high, sums, cells, y, z, w, &p);
    if (left & ~whole) {
        places_of_bound(s, low, r->low, INTERVAL_LOW_BOUND, job->first[INTERVAL_LOW_BOUND], cells, y, z, w, &p);
        places_of_bound(s, high, r->high, INTERVAL_HIGH_BOUND, job->first[INTERVAL_HIGH_BOUND], cells, y, z, w, &p);
    }
    while (left) {
        const uint bit = lowest_bit(left), odd = (uint)(~even >> bit & 1);
        const uint length = min(lowest_bit(~(whole >> bit)), 63 - bit);
        if (length > 1) {
            out = run_store(bit, length, odd, &p, cases, out);
            left &= ~(((1ul << length) - 1) << bit);
        } else {
            out = cube_store(r, bit, odd, &p, cases, out);
            left &= left - 1;
        }
    }
}

/* ------------------------------------------------------------------------------------------------------------- rows
 */

/* Emits row n of brick `number`. */
inline_always void interval_row(const slab *s, const interval_job *job, const bound *low, const bound *high,
                                interval_sums sums, uint number, uint n, grid_arrays in, global const ulong *cells,
                                global const uchar *cases, const interval_mesh *mesh) {
    const corner first = brick_corner(s, number);
    const uint y = first.y + n % BRICK_ROWS, z = first.z + n / BRICK_ROWS, w = first.x / 64;
    if (y >= s->ny || z >= s->z1) return;
    const interval_rows r = rows_load(s, low, high, y, z, w);
    const ulong within = samples_within(s, low, high, cells, y, z, w);
    if (within)
        samples_store(s, first, y, z, within, in,
                      mesh->positions[INTERVAL_SAMPLES] +
                          3ul * (sample_first(s, job, sums, y, z, w) - job->window[INTERVAL_SAMPLES]));
    if (low->exists && low->bricks[number].rows >> n & 1) {
        const crossings edges = row_crossings(s, r.low, 0, cells, y, z, w);
        const owner o = bound_owner(s, low, job->first[INTERVAL_LOW_BOUND], y, z, w);
        crossings_store(s, first, y, z, &edges, ISOVALUE(&s->test), in,
                        mesh->positions[INTERVAL_LOW_BOUND] +
                            3ul * (number_of(o, 0) - job->window[INTERVAL_LOW_BOUND]));
    }
    if (high->exists && high->bricks[number].rows >> n & 1) {
#if WIDE
        const REAL isovalue = as_double(job->high_isovalue64);
#else
        const REAL isovalue = job->high_isovalue32;
#endif
        const crossings edges = row_crossings(s, r.high, 0, cells, y, z, w);
        const owner o = bound_owner(s, high, job->first[INTERVAL_HIGH_BOUND], y, z, w);
        crossings_store(s, first, y, z, &edges, isovalue, in,
                        mesh->positions[INTERVAL_HIGH_BOUND] +
                            3ul * (number_of(o, 0) - job->window[INTERVAL_HIGH_BOUND]));
    }
    const uint before = sums.bricks[number].tetrahedra + (sums.rows[BRICK_WORDS * number + n] >> 16);
    row_tetrahedra(s, job, low, high, sums, &r, cells, y, z, w, cases,
                   mesh->tetrahedra + 4ul * (before - job->tetrahedron_window));
}

/* Bricks that a group takes at once by ticket. */
#define INTERVAL_RUN 16u

/* Whether brick `number` has anything. Rows of those that have not were not counted. */
inline_always bool brick_has_any(const slab *s, const bound *low, const bound *high, uint number) {
    return !brick_is(s, low, number, SIGN_OUTSIDE) && !brick_is(s, high, number, SIGN_INSIDE);
}

kernel void interval_emit(slab s, interval_job job, global const BITS *samples, global const ulong *cells,
                          global const ulong *low_words, global const ulong *low_offsets,
                          global const brick_state *low_bricks, global const ulong *high_words,
                          global const ulong *high_offsets, global const brick_state *high_bricks,
                          global const uint *rows, global const interval_brick *bricks, global uint *ticket,
                          global const uchar *cases, global const float *coordinates, global float *at_samples,
                          global float *at_low, global float *at_high, global uint *tetrahedra) {
    local uint shared[1];
    const bound low = bound_of(low_words, low_offsets, low_bricks, job.has_low, ~0ul);
    const bound high = bound_of(high_words, high_offsets, high_bricks, job.has_high, 0);
    const grid_arrays in = {samples, coordinates, 0};
    const interval_sums sums = {rows, bricks};
    const interval_mesh mesh = {{at_samples + job.offset[INTERVAL_SAMPLES], at_low + job.offset[INTERVAL_LOW_BOUND],
                                 at_high + job.offset[INTERVAL_HIGH_BOUND]},
                                tetrahedra + job.tetrahedron_offset};
    uint run = job.brick_first;
    while (run < job.brick_last) {
        group_barrier();
        if (get_local_id(0) == 0) shared[0] = job.brick_first + INTERVAL_RUN * atomic_inc(ticket);
        group_barrier();
        run = shared[0];
        const uint end = min(run + INTERVAL_RUN, job.brick_last);
        for (uint item = (uint)get_local_id(0); item < INTERVAL_RUN * BRICK_WORDS; item += WORK_ITEMS) {
            const uint number = run + item / BRICK_WORDS;
            if (number < end && brick_has_any(&s, &low, &high, number))
                interval_row(&s, &job, &low, &high, sums, number, item % BRICK_WORDS, in, cells, cases, &mesh);
        }
    }
}

#endif

#endif
