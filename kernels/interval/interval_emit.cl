/*
 * interval_emit.cl - kernel interval_emit: vertices and tetrahedra of an interval volume
 *
 * Tetrahedra come from the table of cases; those of runs of cubes that lie wholly within, whose numbers rise by one
 * from cube to cube, from the first two of them (interval_numbers.cl).
 */
#ifndef INTERVAL_EMIT_CL
#define INTERVAL_EMIT_CL

#include "interval_numbers.cl"

#ifdef REAL

/* The four buffers of what is made. */
typedef struct interval_mesh {
    global float *positions[INTERVAL_BLOCKS];
    global uint *tetrahedra;
} interval_mesh;

/* -------------------------------------------------------------------------------------------------------- vertices */

/* Stores the vertex on an edge of the brick whose first sample is `first`; is_sample: at the edge's first end. */
inline_always void vertex_store(const slab *s, grid_index first, uint edge, bool is_sample, REAL isovalue,
                                grid_arrays in, global float *out) {
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
inline_always void samples_store(const slab *s, grid_index first, uint y, uint z, ulong within, grid_arrays in,
                                 global float *out) {
    const uint row = EDGE_AT_SAMPLE + ((y - first.y) << 7 | (z - first.z) << 11);
    for (; within; within &= within - 1, out += 3) vertex_store(s, first, row + lowest_bit(within), true, 0, in, out);
}

/* Vertices of a bound that a row's samples own. */
inline_always void crossings_store(const slab *s, grid_index first, uint y, uint z, const crossings *edges,
                                   REAL isovalue, grid_arrays in, global float *out) {
    const uint row = (y - first.y) << 7 | (z - first.z) << 11;
    const ulong even = even_cubes(s, y, z);
#pragma unroll
    for (uint type = 0; type < 6; type++) {
        const uint odd_code = row + edge_code(type, true), even_code = row + edge_code(type, false);
#pragma unroll 1
        for (ulong crossed = edges->type[type]; crossed; crossed &= crossed - 1, out += 3) {
            const uint bit = lowest_bit(crossed);
            vertex_store(s, first, (even >> bit & 1 ? even_code : odd_code) + bit, false, isovalue, in, out);
        }
    }
}

/* ------------------------------------------------------------------------------------------------------- tetrahedra */

/* Bit n: the bit that corner n of the cube at `bit` has in these words. */
inline_always uint corners_at(const sample_rows rows[4], uint bit) {
    uint pattern = 0;
#pragma unroll
    for (uint n = 0; n < 4; n++)
        pattern |= (uint)(rows[n].at >> bit & 1) << (2 * n) | (uint)(rows[n].next >> bit & 1) << (2 * n + 1);
    return pattern;
}

inline_always global uint *cube_store(const slot_source *at, const row_slots *p, const interval_rows *r, uint bit,
                                      uint odd, global const uchar *cases, global uint *out) {
    const uint low = corners_at(r->low, bit), high = corners_at(r->high, bit);
#pragma unroll 1
    for (uint n = 5 * odd; n < 5 * odd + 5; n++) {
        const uint index = (uint)cases[256 * n + low] + cases[256 * n + high];
        out = tetrahedra_store(at, p, interval_entry(cases, n, index), bit, out);
    }
    return out;
}

/* Cubes that lie wholly within. */
inline_always ulong cubes_within(const interval_rows *r, ulong present) {
#pragma unroll
    for (uint n = 0; n < 4; n++) present &= r->low[n].at & r->low[n].next & ~(r->high[n].at | r->high[n].next);
    return present;
}

inline_always void row_tetrahedra(const slab *s, const interval_job *job, const bound *low, const bound *high,
                                  interval_sums sums, const interval_rows *r, global const ulong *cells, uint y, uint z,
                                  uint w, global const uchar *cases, global uint *out) {
    const ulong present = cubes_present(s, cells, y, z, w), even = even_cubes(s, y, z);
    const ulong within = cubes_within(r, present);
    ulong left = cubes_reached(r, present);
    row_slots p;
    if (!left) return;
    const slot_source at = {s, job, low, high, sums, r, cells, y, z, w};
    slots_begin(&at, left, left & ~within, &p);
    while (left) {
        const uint bit = lowest_bit(left), odd = (uint)(~even >> bit & 1);
        const uint length = min(lowest_bit(~(within >> bit)), 63 - bit);
        if (length > 1) {
            out = run_store(&at, &p, bit, length, odd, cases, out);
            left &= ~(((1ul << length) - 1) << bit);
        } else {
            out = cube_store(&at, &p, r, bit, odd, cases, out);
            left &= left - 1;
        }
    }
}

/* ------------------------------------------------------------------------------------------------------------- rows */

/* Vertices of a bound that a row owns, into the buffer of the bound's block. */
inline_always void bound_store(const slab *s, const interval_job *job, const bound *b, const sample_rows rows[4],
                               uint block, grid_index first, uint y, uint z, global const ulong *cells, REAL isovalue,
                               grid_arrays in, global float *positions) {
    const row_numbers o = bound_numbers(s, b, job->first[block], y, z, first.x / 64);
    const crossings edges = row_crossings(s, rows, 0, cells, y, z, first.x / 64);
    crossings_store(s, first, y, z, &edges, isovalue, in, positions + 3ul * (number_of(o, 0) - job->window[block]));
}

/* Emits row n of a brick. */
inline_always void interval_row(const slab *s, const interval_job *job, const bound *low, const bound *high,
                                interval_sums sums, uint brick, uint n, grid_arrays in, global const ulong *cells,
                                global const uchar *cases, const interval_mesh *mesh) {
    const grid_index first = brick_origin(s, brick);
    const uint y = first.y + n % BRICK_ROWS, z = first.z + n / BRICK_ROWS, w = first.x / 64;
    if (y >= s->ny || z >= s->z1) return;
    const interval_rows r = rows_load(s, low, high, y, z, w);
    const ulong within = samples_within(s, low, high, cells, y, z, w);
    if (within)
        samples_store(s, first, y, z, within, in,
                      mesh->positions[INTERVAL_SAMPLES] +
                          3ul * (sample_first(s, job, sums, y, z, w) - job->window[INTERVAL_SAMPLES]));
#if WIDE
    const REAL high_isovalue = as_double(job->high_isovalue64);
#else
    const REAL high_isovalue = job->high_isovalue32;
#endif
    if (low->exists && low->bricks[brick].rows >> n & 1)
        bound_store(s, job, low, r.low, INTERVAL_LOW_BOUND, first, y, z, cells, ISOVALUE(&s->test), in,
                    mesh->positions[INTERVAL_LOW_BOUND]);
    if (high->exists && high->bricks[brick].rows >> n & 1)
        bound_store(s, job, high, r.high, INTERVAL_HIGH_BOUND, first, y, z, cells, high_isovalue, in,
                    mesh->positions[INTERVAL_HIGH_BOUND]);
    const uint before = sums.bricks[brick].tetrahedra + (sums.rows[BRICK_WORDS * brick + n] >> 16);
    row_tetrahedra(s, job, low, high, sums, &r, cells, y, z, w, cases,
                   mesh->tetrahedra + 4ul * (before - job->tetrahedron_window));
}

/* Bricks that a group takes at once by ticket. */
#define INTERVAL_RUN 16u

/* Whether a brick has anything. Rows of those that have not were not counted. */
inline_always bool brick_has_any(const slab *s, const bound *low, const bound *high, uint brick) {
    return !brick_is(s, low, brick, SIGN_OUTSIDE) && !brick_is(s, high, brick, SIGN_INSIDE);
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
            const uint brick = run + item / BRICK_WORDS;
            if (brick < end && brick_has_any(&s, &low, &high, brick))
                interval_row(&s, &job, &low, &high, sums, brick, item % BRICK_WORDS, in, cells, cases, &mesh);
        }
    }
}

#endif

#endif
