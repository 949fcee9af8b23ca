/*
 * used_points.h - the points of a complex that a present tetrahedron has: at those with samples within an interval its
 * volume has vertices
 *
 * They depend on the grid alone, and are found by threads of the host when they are first asked for.
 */
#ifndef USED_POINTS_H
#define USED_POINTS_H

#include "grid/complex.h"

/* Words of 64 points. */
uint64_t point_word_count(const complex_grid *c);

/* Finds them where they are not known yet. TC_ERROR_DATA for invalid point numbers. */
tc_status used_points_provide(tc_grid *grid);

/* Those with samples within, and how many come before each word of 64 points. */
typedef struct points_within {
    uint64_t *words;
    uint32_t *before;
    uint64_t count;
} points_within;

/* To be released in any case. */
tc_status points_within_find(tc_grid *grid, const tc_interval_volume_options *options, points_within *out);
void points_within_release(points_within *p);

static inline uint32_t point_within_number(const points_within *p, uint32_t point) {
    const uint64_t lower = p->words[point / 64] & ((UINT64_C(1) << point % 64) - 1);
    return p->before[point / 64] + (uint32_t)__builtin_popcountll(lower);
}

#endif
