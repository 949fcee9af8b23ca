/*
 * spare_blocks.h - large memory of results that were destroyed, for the next ones
 *
 * New memory is cleared by the system, page by page (host_block.h). So a context keeps some of what its results had. It
 * lies idle: the system takes its pages where memory is short.
 *
 * All functions may be called by any thread: a binding may destroy a result while another thread extracts.
 */
#ifndef SPARE_BLOCKS_H
#define SPARE_BLOCKS_H

#include "base/host_block.h"

typedef struct spare_blocks spare_blocks;

/* For a context, which closes it. NULL: no memory. */
spare_blocks *spare_blocks_create(void);

/* Releases all blocks, and from now on those that are given. Results may live longer than their context. */
void spare_blocks_close(spare_blocks *spare);

/* For a result, which leaves it when destroyed; NULL stays NULL: nothing is kept. */
spare_blocks *spare_blocks_join(spare_blocks *spare);
void spare_blocks_leave(spare_blocks *spare);

/* As host_block_reserve; takes the smallest spare block that is large enough. Where none is, the largest is released,
 * so that results that grow leave nothing behind. */
tc_status spare_block_take(spare_blocks *spare, host_block *block, uint64_t bytes);

/* Makes the block a spare one, or releases it where those are larger. */
void spare_block_give(spare_blocks *spare, host_block *block);

uint64_t spare_blocks_bytes(spare_blocks *spare);

#endif
