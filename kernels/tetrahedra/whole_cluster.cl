/*
 * whole_cluster.cl - a cluster of cells that are kept whole: the range of samples at their corners, and which of them
 * the surface passes through
 *
 * Cells are read where the caller has them: point numbers of 32 or 64 bits, one cell behind the other. Where a cluster
 * has eight cells of eight corners and nothing else, its 64 points follow each other like those of 16 tetrahedra.
 */
#ifndef WHOLE_CLUSTER_CL
#define WHOLE_CLUSTER_CL

#include "complex_cluster.cl"

inline_always uint cell_code(const complex_job *c, uint cell, complex_arrays in) {
    return c->one_code ? c->one_code : in.codes[cell];
}

/* Row of the table of shapes. */
inline_always global const uchar *shape_of(uint code, complex_arrays in) {
    return in.shapes + SHAPE_BYTES * (code & (SHAPE_CODES - 1));
}

/* The numbers of a cell's points, one or two 32-bit words each. */
inline_always global const uint *cell_points_at(const complex_job *c, uint cell, complex_arrays in) {
    const ulong point = c->cell_points ? (ulong)c->cell_points * cell : in.begins[cell];
    return in.tetrahedra + point * c->word_step;
}

/* Whether a point number, of one word or two (64 bits), is not below the number of points. */
inline_always bool point_invalid(const complex_job *c, global const uint *word) {
    return word[0] >= c->point_count || (c->word_step == 2 && word[1]);
}

inline_always bool cells_valid(const complex_job *c, uint n, complex_arrays in) {
    const uint first = n * CLUSTER_CELLS, end = first + cluster_size(c, n);
    bool invalid = false;
    for (uint cell = first; cell < end; cell++) {
        global const uint *words = cell_points_at(c, cell, in);
        const uint corners = shape_of(cell_code(c, cell, in), in)[SHAPE_CORNERS];
        for (uint m = 0; m < corners; m++) invalid |= point_invalid(c, words + m * c->word_step);
    }
    return !invalid;
}

inline_always brick_range cells_range(const complex_job *c, uint n, complex_arrays in) {
    const uint first = n * CLUSTER_CELLS, end = first + cluster_size(c, n);
    BITS low = (BITS) ~(BITS)0, high = 0;
    for (uint cell = first; cell < end; cell++) {
        global const uint *words = cell_points_at(c, cell, in);
        const uint corners = shape_of(cell_code(c, cell, in), in)[SHAPE_CORNERS];
        for (uint m = 0; m < corners; m++) {
            const BITS key = key_of(in.samples[words[m * c->word_step]], &c->test);
            low = min(low, key), high = max(high, key);
        }
    }
    brick_range range = {key_upper(low), key_upper(high)};
    return range;
}

/* Which corners of a cell are inside; 0 too where a sample is missing, and where all are inside. */
inline_always uint cell_pattern(const complex_job *c, global const uint *words, global const uchar *shape,
                                global const BITS *samples) {
    const uint corners = shape[SHAPE_CORNERS];
    uint inside = 0;
    bool missing = false;
    for (uint m = 0; m < corners; m++) {
        const BITS bits = samples[words[shape[SHAPE_ORDER + m] * c->word_step]];
        inside |= (uint)bits_inside(bits, &c->test) << m;
        missing |= bits_missing(bits, &c->test);
    }
    return missing || inside == (1u << corners) - 1 ? 0 : inside;
}

/* Bit n: cell n of the cluster is active. */
inline_always cluster_report cells_report(ulong mask) {
    cluster_report report = {mask, (uint)popcount(mask), 0, 0};
    return report;
}

inline_always cluster_report cells_count(const complex_job *c, uint n, complex_arrays in) {
    const uint first = n * CLUSTER_CELLS, size = cluster_size(c, n);
    ulong mask = 0;
    for (uint m = 0; m < size; m++) {
        global const uchar *shape = shape_of(cell_code(c, first + m, in), in);
        mask |= (ulong)(cell_pattern(c, cell_points_at(c, first + m, in), shape, in.samples) != 0) << m;
    }
    return cells_report(mask);
}

#if WORK_ITEMS == 1
#include "whole_cluster_alone.cl"
#else
#include "whole_cluster_groups.cl"
#endif

#endif
