/*
 * host_block.h - large memory on the host, cheap to touch for the first time
 *
 * New memory costs a page fault and clearing per page, a large part of an extraction's time. So blocks are kept between
 * extractions, also where a mesh is destroyed and the next one made, and lie in huge pages.
 */
#ifndef HOST_BLOCK_H
#define HOST_BLOCK_H

#include "tetracubes.h"

/* Of x86-64. Devices that share the host's memory use arrays from the start of a page on. */
enum { PAGE_BYTES = 4096, HUGE_PAGE_BYTES = 2 << 20 };

/* Memory of blocks that were released, kept for others: of a context, for the meshes that it makes. */
typedef struct host_spares host_spares;

typedef struct host_block {
    void *memory;
    size_t bytes;        /* whole pages */
    host_spares *spares; /* where memory is looked for first, and goes back to; NULL: the system alone */
} host_block;

/* Makes the block at least `bytes` large, page-aligned; its content is lost where it has to grow. Returns 0 or
 * TC_ERROR_MEMORY. */
tc_status host_block_reserve(host_block *block, uint64_t bytes);
void host_block_release(host_block *block);

/* NULL without memory. Every owner of a block with spares shares them. Those who leave may do so in any order, and from
 * any thread; the first one who closes them gives all memory back, and no more is kept. */
host_spares *host_spares_create(void);
host_spares *host_spares_share(host_spares *spares);
void host_spares_leave(host_spares *spares);
void host_spares_close(host_spares *spares);

/* Keeps a block for its next use. Its content is lost; where memory is short, the system takes its pages. */
void host_block_idle(const host_block *block);

#endif
