/*
 * interval.h - an interval volume as its engines fill it, in host memory that is kept between extractions
 */
#ifndef INTERVAL_H
#define INTERVAL_H

#include "base/spare_blocks.h"
#include "grid/inside.h"
#include "tetracubes.h"

enum { TETRAHEDRON_BYTES = 16 };

enum { BOUND_LOW, BOUND_HIGH, BOUND_COUNT };

/* Vertices lie in blocks: samples within, crossings of the low bound, crossings of the high bound. */
enum { BLOCK_SAMPLES, BLOCK_LOW, BLOCK_HIGH, BLOCK_COUNT };

typedef struct interval_size {
    uint64_t vertices[BLOCK_COUNT];
    uint64_t tetrahedra;
} interval_size;

struct tc_interval_volume {
    spare_blocks *spare; /* of the context */
    interval_size size;
    double origin[3]; /* that positions are relative to */
    host_block positions, tetrahedra;
    uint32_t slab_count;
    tc_timings timings;
};

/* Whether samples of the type can be within; and which bounds separate any, with their tests. */
bool interval_bounds_find(tc_type type, const tc_interval_volume_options *options, inside_range inside[BOUND_COUNT],
                          bool exists[BOUND_COUNT]);

/* The number of a block's first vertex; of BLOCK_COUNT: of all vertices. */
uint64_t interval_first(const interval_size *size, int block);

/* Bytes of positions and tetrahedra. */
uint64_t interval_bytes(const interval_size *size);

/* An empty one, the caller's to destroy; NULL: no memory. */
tc_interval_volume *interval_create(spare_blocks *spare);

/* Sets the size and reserves the memory; checks that indices fit 32 bits. */
tc_status interval_allocate(tc_interval_volume *interval, const interval_size *size);

/* Nothing in it; memory is kept. */
void interval_clear(tc_interval_volume *interval);

#endif
