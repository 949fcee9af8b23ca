/*
 * host_block.h - large memory on the host, cheap to touch for the first time
 *
 * New memory costs a fault and a clearing per page, which at these speeds is much of a run: blocks are kept between
 * runs and lie in huge pages.
 */
#ifndef HOST_BLOCK_H
#define HOST_BLOCK_H

#include "tetracubes.h"

typedef struct host_block {
    void *memory;
    size_t bytes; /* whole pages */
} host_block;

/* Makes the block at least so large, from a page's boundary on; its content is lost where it has to grow. Returns 0 or
 * TC_ERROR_MEMORY. */
tc_status host_block_reserve(host_block *block, uint64_t bytes);
void host_block_release(host_block *block);

#endif
