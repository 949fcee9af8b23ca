#include "dataset/array_memory.h"

#include <stddef.h>
#include <stdlib.h>
#include <sys/mman.h>

void *samples_allocate(uint64_t bytes) {
    enum { SMALL_PAGE = 4096, HUGE_PAGE = 2 << 20, HUGE_FROM = 256 << 10 };
    size_t page = bytes < HUGE_FROM ? SMALL_PAGE : HUGE_PAGE;
    void *memory = NULL;
    if (bytes > SIZE_MAX / 2) return NULL;
    size_t whole_pages = ((size_t)bytes + page - 1) & ~(page - 1);
    if (posix_memalign(&memory, page, whole_pages ? whole_pages : page)) return NULL;
    if (page == HUGE_PAGE) madvise(memory, whole_pages, MADV_HUGEPAGE);
    return memory;
}
