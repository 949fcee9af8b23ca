#include "tetrahedra/edge_numbers.h"

#include "failure.h"

#include <stdlib.h>
#include <string.h>

#define SLOT_FREE UINT32_MAX

/* The slot of the edge's number, or the free slot for it. */
static uint32_t *slot_find(const edge_numbers *n, uint64_t edge) {
    const uint64_t hash = edge * 0x9e3779b97f4a7c15u, mask = n->slot_count - 1;
    uint64_t slot = (hash ^ hash >> 29) & mask;
    while (n->slots[slot] != SLOT_FREE && n->edges[n->slots[slot]] != edge) slot = (slot + 1) & mask;
    return &n->slots[slot];
}

static tc_status numbers_grow(edge_numbers *n) {
    const uint64_t slot_count = n->slot_count ? 2 * n->slot_count : 1024;
    uint64_t *edges = realloc(n->edges, (size_t)(slot_count / 2) * sizeof *edges);
    if (edges) n->edges = edges;
    uint32_t *slots = edges ? malloc((size_t)slot_count * sizeof *slots) : NULL;
    if (!slots) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the crossed edges");
    memset(slots, 0xff, (size_t)slot_count * sizeof *slots);
    free(n->slots);
    n->slots = slots;
    n->slot_count = slot_count;
    for (uint64_t number = 0; number < n->count; number++) *slot_find(n, edges[number]) = (uint32_t)number;
    return TC_OK;
}

tc_status edge_numbers_find(edge_numbers *n, uint32_t low, uint32_t high, uint32_t *number) {
    const uint64_t edge = (uint64_t)low << 32 | high;
    tc_status status = 2 * n->count == n->slot_count ? numbers_grow(n) : TC_OK;
    if (status) return status;
    uint32_t *slot = slot_find(n, edge);
    if (*slot == SLOT_FREE) {
        if (n->count == UINT32_MAX)
            return (tc_status)fail(TC_ERROR_LIMIT,
                                   "the surface has more than %lu vertices, which indices of 32 bits do not reach: cut "
                                   "the tetrahedra into parts",
                                   (unsigned long)UINT32_MAX);
        n->edges[n->count] = edge;
        *slot = (uint32_t)n->count++;
    }
    *number = *slot;
    return TC_OK;
}

uint32_t edge_numbers_get(const edge_numbers *n, uint32_t low, uint32_t high) {
    return n->slot_count ? *slot_find(n, (uint64_t)low << 32 | high) : SLOT_FREE;
}

void edge_numbers_release(edge_numbers *n) {
    free(n->edges);
    free(n->slots);
    *n = (edge_numbers){0};
}
