/*
 * The table of cases for the kernels of interval volumes, from the 81 cases whose points are in the order of their
 * numbers (interval_cases.h): for each order of a tetrahedron's points its own entries, which name the points and the
 * slots of crossed edges as the tetrahedron has them.
 */
#include "tables/interval_cases.h"
#include "tetrahedra/complex_interval.h"

#include <stdlib.h>
#include <string.h>

/* order[n]: which of a tetrahedron's points is the n-th by number. */
static void order_make(unsigned number, uint8_t order[4]) {
    uint8_t left[4] = {0, 1, 2, 3};
    static const uint8_t choices[4] = {4, 3, 2, 1};
    for (unsigned n = 0; n < 4; n++) {
        const unsigned chosen = number % choices[n];
        number /= choices[n];
        order[n] = left[chosen];
        memmove(left + chosen, left + chosen + 1, 3 - chosen);
    }
}

/* Bit e: of the two points of edge e the first has the larger number. */
static unsigned pairs_of(const uint8_t order[4]) {
    unsigned rank[4], pairs = 0;
    for (unsigned n = 0; n < 4; n++) rank[order[n]] = n;
    for (unsigned e = 0; e < 6; e++)
        pairs |= (unsigned)(rank[tetrahedron_edges[e][0]] > rank[tetrahedron_edges[e][1]]) << e;
    return pairs;
}

/* The slot of the edge between points a and b among those that a bound crosses; sides: bit n, point n's. */
static unsigned slot_of(unsigned sides, unsigned a, unsigned b) {
    unsigned slot = 0;
    for (unsigned e = 0; e < 6; e++) {
        const uint8_t *ends = tetrahedron_edges[e];
        if ((ends[0] == a && ends[1] == b) || (ends[0] == b && ends[1] == a)) break;
        slot += (sides >> ends[0] & 1) != (sides >> ends[1] & 1);
    }
    return slot;
}

/* A vertex of a case, as the tetrahedron with this order of points has it. where: of its points, as they are. */
static uint8_t vertex_name(const uint8_t order[4], const unsigned where[4], unsigned vertex) {
    if (vertex < INTERVAL_LOW) return (uint8_t)(VOLUME_POINT + order[vertex]);
    const bool is_high = vertex >= INTERVAL_HIGH;
    const uint8_t *ends = tetrahedron_edges[(vertex - INTERVAL_LOW) % 6];
    unsigned sides = 0;
    for (unsigned n = 0; n < 4; n++)
        sides |= (unsigned)(where[n] >= (unsigned)(is_high ? SAMPLE_ABOVE : SAMPLE_WITHIN)) << n;
    return (uint8_t)((is_high ? VOLUME_HIGH_SLOT : VOLUME_LOW_SLOT) + slot_of(sides, order[ends[0]], order[ends[1]]));
}

static void entry_make(const interval_case cases[INTERVAL_CASES], const uint8_t order[4], bool is_odd, unsigned number,
                       uint8_t *entry) {
    const unsigned where[4] = {number % 3, number / 3 % 3, number / 9 % 3, number / 27};
    unsigned sorted = 0;
    for (unsigned n = 4; n-- > 0;) sorted = 3 * sorted + where[order[n]];
    entry[0] = cases[sorted].count;
    for (unsigned n = 0; n < 4u * cases[sorted].count; n++) {
        const unsigned corner = is_odd && n % 4 > 1 ? 5 - n % 4 : n % 4;
        entry[1 + n] = vertex_name(order, where, cases[sorted].parts[n / 4][corner]);
    }
}

/* The edges that a bound crosses, by its pattern. */
static void edges_make(uint8_t *edges) {
    memset(edges, VOLUME_NO_EDGE, 16 * 4);
    for (unsigned pattern = 0; pattern < 16; pattern++) {
        unsigned count = 0;
        for (unsigned e = 0; e < 6; e++) {
            const uint8_t *ends = tetrahedron_edges[e];
            if ((pattern >> ends[0] & 1) != (pattern >> ends[1] & 1)) edges[4 * pattern + count++] = (uint8_t)e;
        }
    }
}

/* The same as lanes of words. */
static void lanes_make(const uint8_t *edges, uint8_t *lanes) {
    for (unsigned pattern = 0; pattern < 16; pattern++)
        for (unsigned n = 0; n < 4; n++) {
            const uint8_t edge = edges[4 * pattern + n];
            lanes[16 * pattern + 2 * n] = edge;
            lanes[16 * pattern + 2 * n + 1] = (uint8_t)(8 + edge);
            lanes[16 * pattern + 8 + n] = (uint8_t)(16 + edge);
        }
}

uint8_t *volume_table_make(void) {
    _Static_assert((int)VOLUME_CASES == (int)INTERVAL_CASES && 1 + 4 * INTERVAL_PARTS_MOST <= VOLUME_ENTRY_BYTES,
                   "kernels read them so");
    interval_case cases[INTERVAL_CASES];
    uint8_t *table = calloc(1, VOLUME_TABLE_BYTES);
    if (!table) return NULL;
    interval_cases_derive(cases);
    edges_make(table + VOLUME_EDGES_OF);
    lanes_make(table + VOLUME_EDGES_OF, table + VOLUME_LANES);
    for (unsigned pattern = 0; pattern < VOLUME_PATTERNS; pattern++) {
        unsigned number = 0;
        for (unsigned n = 4; n-- > 0;) number = 3 * number + (pattern >> (4 + n) & 1) + (pattern >> n & 1);
        table[pattern] = cases[number].count;
        table[VOLUME_CASE_OF + pattern] = (uint8_t)number;
    }
    for (unsigned n = 0; n < VOLUME_ORDERS; n++) {
        uint8_t order[4];
        order_make(n, order);
        const unsigned pairs = pairs_of(order);
        table[VOLUME_ORDER_OF + pairs] = (uint8_t)n;
        for (unsigned m = 0; m < VOLUME_CASES; m++)
            entry_make(cases, order, __builtin_popcount(pairs) & 1, m,
                       table + VOLUME_ENTRIES + (size_t)VOLUME_ENTRY_BYTES * (VOLUME_CASES * n + m));
    }
    return table;
}
