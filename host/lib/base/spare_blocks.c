#include "base/spare_blocks.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>

enum { SPARE_COUNT = 4 }; /* positions, normals, triangles, labels */

struct spare_blocks {
    pthread_mutex_t lock;
    uint64_t users; /* results, and the context */
    bool is_closed;
    host_block blocks[SPARE_COUNT];
};

static void blocks_release(spare_blocks *spare) {
    for (int n = 0; n < SPARE_COUNT; n++) host_block_release(&spare->blocks[n]);
}

spare_blocks *spare_blocks_create(void) {
    spare_blocks *spare = calloc(1, sizeof *spare);
    if (!spare) return NULL;
    pthread_mutex_init(&spare->lock, NULL);
    spare->users = 1;
    return spare;
}

void spare_blocks_close(spare_blocks *spare) {
    if (!spare) return;
    pthread_mutex_lock(&spare->lock);
    spare->is_closed = true;
    blocks_release(spare);
    pthread_mutex_unlock(&spare->lock);
    spare_blocks_leave(spare);
}

spare_blocks *spare_blocks_join(spare_blocks *spare) {
    if (!spare) return NULL;
    pthread_mutex_lock(&spare->lock);
    spare->users++;
    pthread_mutex_unlock(&spare->lock);
    return spare;
}

void spare_blocks_leave(spare_blocks *spare) {
    if (!spare) return;
    pthread_mutex_lock(&spare->lock);
    const bool is_last = --spare->users == 0;
    pthread_mutex_unlock(&spare->lock);
    if (!is_last) return;
    pthread_mutex_destroy(&spare->lock);
    free(spare);
}

/* The block that is taken, or NULL; the largest is released then. */
static host_block *block_find(spare_blocks *spare, uint64_t bytes) {
    host_block *fit = NULL, *largest = spare->blocks;
    for (host_block *b = spare->blocks; b < spare->blocks + SPARE_COUNT; b++) {
        if (b->bytes >= bytes && (!fit || b->bytes < fit->bytes)) fit = b;
        if (b->bytes > largest->bytes) largest = b;
    }
    if (!fit) host_block_release(largest);
    return fit;
}

tc_status spare_block_take(spare_blocks *spare, host_block *block, uint64_t bytes) {
    if (bytes <= block->bytes) return TC_OK;
    if (!spare) return host_block_reserve(block, bytes);
    host_block_release(block);
    pthread_mutex_lock(&spare->lock);
    host_block *fit = block_find(spare, bytes);
    if (fit) *block = *fit, *fit = (host_block){0};
    pthread_mutex_unlock(&spare->lock);
    if (fit || !host_block_reserve(block, bytes)) return TC_OK;
    pthread_mutex_lock(&spare->lock); /* without the address space of the others there may be room */
    blocks_release(spare);
    pthread_mutex_unlock(&spare->lock);
    return host_block_reserve(block, bytes);
}

void spare_block_give(spare_blocks *spare, host_block *block) {
    if (spare && block->memory) {
        host_block_idle(block);
        pthread_mutex_lock(&spare->lock);
        host_block *smallest = spare->blocks;
        for (host_block *b = spare->blocks; b < spare->blocks + SPARE_COUNT; b++)
            if (b->bytes < smallest->bytes) smallest = b;
        if (!spare->is_closed && smallest->bytes < block->bytes) {
            const host_block given = *block;
            *block = *smallest, *smallest = given;
        }
        pthread_mutex_unlock(&spare->lock);
    }
    host_block_release(block);
}

uint64_t spare_blocks_bytes(spare_blocks *spare) {
    uint64_t bytes = 0;
    if (!spare) return 0;
    pthread_mutex_lock(&spare->lock);
    for (int n = 0; n < SPARE_COUNT; n++) bytes += spare->blocks[n].bytes;
    pthread_mutex_unlock(&spare->lock);
    return bytes;
}
