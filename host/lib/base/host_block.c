#include "base/host_block.h"

#include "failure.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <sys/mman.h>

/* Unused address space behind a block. Where the caller changes samples during an extraction, a brick may emit more
 * vertices, triangles or tetrahedra than were counted; the margin keeps these from overwriting other memory. A brick
 * has 2,048 cubes, and these, at 12 bytes, ten triangles each; of label maps 60, twelve for each tetrahedron, which is
 * most. */
static const size_t margin_bytes = 1536 << 10;

/* From here on, faults of small pages cost more than clearing a huge one. */
static const size_t huge_from_bytes = 256 << 10;

/* ------------------------------------------------------------------------------------------------------------ spares
 */

/* As many blocks as two meshes have, and together at most so many bytes. Their pages are the system's wherever memory
 * is short. */
enum { SPARES_MOST = 8 };
static const size_t spare_bytes_most = (size_t)1 << 30;

struct host_spares {
    pthread_mutex_t lock;
    unsigned users;
    bool is_closed;
    size_t bytes;                   /* of all blocks */
    host_block blocks[SPARES_MOST]; /* the one released last comes last */
    unsigned count;
};

static void unmap(const host_block *block) { munmap(block->memory, block->bytes + margin_bytes); }

host_spares *host_spares_create(void) {
    host_spares *s = calloc(1, sizeof *s);
    if (s && pthread_mutex_init(&s->lock, NULL)) {
        free(s);
        s = NULL;
    }
    if (s) s->users = 1;
    return s;
}

host_spares *host_spares_share(host_spares *s) {
    if (!s) return NULL;
    pthread_mutex_lock(&s->lock);
    s->users++;
    pthread_mutex_unlock(&s->lock);
    return s;
}

/* Takes block n out of the list. */
static host_block spare_remove(host_spares *s, unsigned n) {
    const host_block block = s->blocks[n];
    s->bytes -= block.bytes;
    for (s->count--; n < s->count; n++) s->blocks[n] = s->blocks[n + 1];
    return block;
}

static void spares_empty(host_spares *s) {
    while (s->count) {
        const host_block block = spare_remove(s, s->count - 1);
        unmap(&block);
    }
}

void host_spares_close(host_spares *s) {
    if (!s) return;
    pthread_mutex_lock(&s->lock);
    spares_empty(s);
    s->is_closed = true;
    pthread_mutex_unlock(&s->lock);
}

void host_spares_leave(host_spares *s) {
    if (!s) return;
    pthread_mutex_lock(&s->lock);
    const unsigned left = --s->users;
    pthread_mutex_unlock(&s->lock);
    if (left) return;
    spares_empty(s);
    pthread_mutex_destroy(&s->lock);
    free(s);
}

/* Takes the smallest block that is large enough, and not much too large. */
static bool spare_take(host_spares *s, size_t bytes, host_block *block) {
    unsigned best = SPARES_MOST;
    pthread_mutex_lock(&s->lock);
    for (unsigned n = 0; n < s->count; n++)
        if (s->blocks[n].bytes >= bytes && s->blocks[n].bytes / 2 <= bytes &&
            (best == SPARES_MOST || s->blocks[n].bytes < s->blocks[best].bytes))
            best = n;
    if (best < SPARES_MOST) *block = spare_remove(s, best);
    pthread_mutex_unlock(&s->lock);
    return best < SPARES_MOST;
}

/* Gives a block back; the oldest ones make room for it. */
static bool spare_keep(host_spares *s, host_block *block) {
    pthread_mutex_lock(&s->lock);
    const bool is_kept = !s->is_closed && block->bytes <= spare_bytes_most;
    while (is_kept && (s->count == SPARES_MOST || s->bytes > spare_bytes_most - block->bytes)) {
        const host_block oldest = spare_remove(s, 0);
        unmap(&oldest);
    }
    if (is_kept) {
        host_block_idle(block);
        s->blocks[s->count++] = *block;
        s->bytes += block->bytes;
    }
    pthread_mutex_unlock(&s->lock);
    return is_kept;
}

/* ------------------------------------------------------------------------------------------------------------ blocks
 */

/* MAP_FAILED where neither the system nor the spares have so much. */
static void *map(host_spares *spares, size_t bytes) {
    void *start = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (start != MAP_FAILED || !spares) return start;
    pthread_mutex_lock(&spares->lock);
    const bool is_more = spares->count != 0;
    spares_empty(spares);
    pthread_mutex_unlock(&spares->lock);
    return is_more ? mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) : MAP_FAILED;
}

tc_status host_block_reserve(host_block *block, uint64_t bytes) {
    if (bytes <= block->bytes) return TC_OK;
    host_block_release(block);
    if (bytes > SIZE_MAX / 2)
        return (tc_status)fail(TC_ERROR_MEMORY, "%llu bytes do not fit the address space", (unsigned long long)bytes);
    size_t alignment = bytes < huge_from_bytes ? PAGE_BYTES : HUGE_PAGE_BYTES;
    size_t rounded = ((size_t)bytes + alignment - 1) & ~(alignment - 1);
    if (block->spares && spare_take(block->spares, rounded, block)) return TC_OK;
    size_t mapped = rounded + margin_bytes + alignment - PAGE_BYTES;
    char *start = map(block->spares, mapped);
    if (start == MAP_FAILED)
        return (tc_status)fail(TC_ERROR_MEMORY, "the host has no %llu bytes of memory more", (unsigned long long)bytes);
    char *aligned = start + (-(uintptr_t)start & (alignment - 1));
    if (aligned > start) munmap(start, (size_t)(aligned - start));
    char *end = aligned + rounded + margin_bytes;
    if (end < start + mapped) munmap(end, (size_t)(start + mapped - end));
    if (alignment == HUGE_PAGE_BYTES) madvise(aligned, rounded, MADV_HUGEPAGE);
    *block = (host_block){aligned, rounded, block->spares};
    return TC_OK;
}

void host_block_release(host_block *block) {
    const bool is_kept = block->spares && block->bytes >= huge_from_bytes && spare_keep(block->spares, block);
    if (block->memory && !is_kept) unmap(block);
    *block = (host_block){.spares = block->spares};
}

void host_block_idle(const host_block *block) {
    if (block->memory) madvise(block->memory, block->bytes, MADV_FREE);
}
