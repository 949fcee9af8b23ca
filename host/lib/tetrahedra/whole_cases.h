/*
 * whole_cases.h - the table that drives the kernels of whole cells (complex_job.h): a case for every shape, diagonals,
 * cut faces and pattern that was met, made by cell_cases.h when it is first asked for
 *
 * A context keeps one. Cases of shapes with up to eight different corners and no cut faces are found by an index;
 * others by a hash of the faces and the pattern.
 */
#ifndef WHOLE_CASES_H
#define WHOLE_CASES_H

#include "kernels/tetrahedra/complex_job.h"
#include "grid/complex.h"

typedef struct whole_cases whole_cases;

/* NULL where there is no memory. */
whole_cases *whole_cases_make(void);
void whole_cases_release(whole_cases *cases);

/* How the point numbers at a cell's corners compare: two bits for each quadrilateral, where its smallest is, then three
 * for the corner of the smallest of all. The tetrahedra of a cell follow from that, and the diagonals of its faces.
 * NO_ORDER: of prisms, and of cells of which corners are one. */
#define NO_ORDER UINT32_MAX

enum { ORDER_CORNER_BITS = 3 };

uint32_t whole_order(cell_shape shape, const uint32_t *points);

/* An active cell as its case is asked for. */
typedef struct case_question {
    cell_shape shape;
    bool mirrored;
    const uint32_t *points; /* of its corners */
    uint32_t order;         /* of these */
    unsigned pattern;
    uint32_t found; /* bit n: candidate n is a diagonal that another cell has as its edge; 0 at first */
} case_question;

/* The case's number, and how many edges of its own such a cell has. Threads may ask at once. False: no memory. */
bool whole_case_find(whole_cases *cases, const case_question *q, uint32_t *number, uint32_t *edges);

/* The case of a cell with this case where those diagonals are found to be edges. */
bool whole_case_cut(whole_cases *cases, const uint32_t *points, uint32_t found, uint32_t *number);

/* All cases so far; *bytes may grow by the next question. */
const uint8_t *whole_cases_bytes(const whole_cases *cases, uint64_t *bytes);

static inline const uint8_t *whole_case_at(const uint8_t *cases, uint32_t number) {
    return cases + (uint64_t)CASE_UNIT * number;
}

/* Bit n: candidate n of a case is no diagonal. */
static inline uint32_t whole_case_edges(const uint8_t *c) {
    const uint8_t *d = c + WHOLE_DIAGONALS;
    return ((1u << c[WHOLE_CANDIDATES]) - 1) &
           ~(d[0] | (uint32_t)d[1] << 8 | (uint32_t)d[2] << 16 | (uint32_t)d[3] << 24);
}

#endif
