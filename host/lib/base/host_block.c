#include "base/host_block.h"

#include "failure.h"

#include <sys/mman.h>

/* Unused address space behind a block. Where the caller changes samples during an extraction, a brick may emit more
 * vertices, triangles or tetrahedra than were counted; the margin keeps these from overwriting other memory. A brick
 * has 2,048 cubes, and these, at 12 bytes, ten triangles each; of label maps 60, twelve for each tetrahedron, which is
 * most. */
static const size_t margin_bytes = 1536 << 10;

/* From here on, faults of small pages cost more than clearing a huge one. */
static const size_t huge_from_bytes = 256 << 10;

tc_status host_block_reserve(host_block *block, uint64_t bytes) {
    if (bytes <= block->bytes) return TC_OK;
    host_block_release(block);
    if (bytes > SIZE_MAX / 2)
        return (tc_status)fail(TC_ERROR_MEMORY, "%llu bytes do not fit the address space", (unsigned long long)bytes);
    size_t alignment = bytes < huge_from_bytes ? PAGE_BYTES : HUGE_PAGE_BYTES;
    size_t rounded = ((size_t)bytes + alignment - 1) & ~(alignment - 1);
    size_t mapped = rounded + margin_bytes + alignment - PAGE_BYTES;
    char *start = mmap(NULL, mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (start == MAP_FAILED)
        return (tc_status)fail(TC_ERROR_MEMORY, "the host has no %llu bytes of memory more", (unsigned long long)bytes);
    char *aligned = start + (-(uintptr_t)start & (alignment - 1));
    if (aligned > start) munmap(start, (size_t)(aligned - start));
    char *end = aligned + rounded + margin_bytes;
    if (end < start + mapped) munmap(end, (size_t)(start + mapped - end));
    if (alignment == HUGE_PAGE_BYTES) madvise(aligned, rounded, MADV_HUGEPAGE);
    *block = (host_block){aligned, rounded};
    return TC_OK;
}

void host_block_release(host_block *block) {
    if (block->memory) munmap(block->memory, block->bytes + margin_bytes);
    *block = (host_block){0};
}

void host_block_idle(const host_block *block) {
    if (block->memory) madvise(block->memory, block->bytes, MADV_FREE);
}
