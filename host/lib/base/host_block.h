/*
 * host_block.h - large memory on the host, cheap to touch for the first time
 *
 * New memory costs a page fault and clearing per page, a large part of an extraction's time. So blocks are kept between
 * extractions and lie in huge pages.
 */
#ifndef HOST_BLOCK_H
#define HOST_BLOCK_H

#include "tetracubes.h"

/* Of x86-64. Devices that share the host's memory use arrays from the start of a page on. */
enum { PAGE_BYTES = 4096, HUGE_PAGE_BYTES = 2 << 20 };

typedef struct host_block {
    void *memory;
    size_t bytes; /* whole pages */
} host_block;

/* Makes the block at least `bytes` large, page-aligned; its content is lost where it has to grow. Returns 0 or
 * TC_ERROR_MEMORY. */
tc_status host_block_reserve(host_block *block, uint64_t bytes);
void host_block_release(host_block *block);

/* Keeps a block for its next use. Its content is lost; where memory is short, the system takes its pages. */
void host_block_idle(const host_block *block);

#endif
