/*
 * crossed_rows.h - which edges the surface crosses, in rows of 64 samples: by the host, from what kernel 1 has left
 */
#ifndef CROSSED_ROWS_H
#define CROSSED_ROWS_H

#include "grid/grid.h"
#include "kernels/base/slab.h"
#include "structured/slab_plan.h"
#include "tables/tables.h"

/* Results of kernel 1 for all slabs of a grid, in the host's memory. */
typedef struct classified_rows {
    const tc_grid *grid;
    const slab_plan *plan;
    int edge_types;                          /* those below this one have vertices */
    bool is_closed;                          /* inside samples on the border are vertices, too */
    const uint64_t *words, *zeros, *offsets; /* zeros: NULL where the method has none */
    const brick_state *bricks;
} classified_rows;

/* Words of a brick [0] and of the brick at higher x [1]: in the brick's planes and the plane after, of its rows and the
 * row after. Those of rows and planes outside the grid are undefined. */
typedef struct brick_words {
    uint64_t word[2][BRICK_PLANES + 1][BRICK_ROWS + 1];
    uint64_t zero[2][BRICK_PLANES + 1][BRICK_ROWS + 1];
} brick_words;

/* at: the brick's indices along x, y and z. Words of zeros stay as they are where the method has none. */
void brick_words_load(const classified_rows *r, uint64_t brick, const uint32_t at[3], brick_words *w);

/* What the samples of a row have: bit n is sample n's. */
typedef struct crossed_row {
    uint64_t crossed[EDGES_PER_SAMPLE]; /* edges that the sample owns, by type */
    uint64_t zeros, border;             /* vertices at samples: snapped ones, and those that close the surface */
} crossed_row;

/* Of a row of the brick, whose first sample is p. packed: what kernel 1 has stored of the row's vertices. */
crossed_row crossed_row_of(const classified_rows *r, const brick_words *w, int row, int plane, const int64_t p[3],
                           uint64_t packed);

/* Bit n: the edges of a type span axis n. */
extern const uint8_t edge_type_axes[EDGES_PER_SAMPLE];

#endif
