/*
 * Crossed edges of an interval volume's slab joined with those of the slabs before: the host reads the list of edges
 * back, and which of them own their vertices.
 */
#include "tetrahedra/complex_interval.h"

#include "failure.h"

#include <stdlib.h>

typedef struct edge_list {
    uint32_t *edges, *entries, *state; /* in the host's memory */
} edge_list;

static void list_release(edge_list *l) {
    free(l->edges);
    free(l->entries);
    free(l->state);
}

static uint32_t *buffer_read(const volume_run *v, const device_buffer *buffer, uint64_t words, tc_status *status) {
    uint32_t *memory = *status ? NULL : malloc(4 * (size_t)words);
    if (!*status && !memory) *status = (tc_status)fail(TC_ERROR_MEMORY, "no memory for the crossed edges of a slab");
    if (*status) return NULL;
    cl_int error =
        cl->EnqueueReadBuffer(v->context->queue, buffer->memory, CL_TRUE, 0, 4 * (size_t)words, memory, 0, NULL, NULL);
    if (error) *status = context_fail(v->context, "reading the crossed edges back", error);
    return memory;
}

static tc_status list_read(const volume_run *v, edge_list *out) {
    const uint64_t slots = 4ull * v->head[VOLUME_CUTS];
    const uint64_t words = VOLUME_HEAD_WORDS + (uint64_t)VOLUME_SCANS * TILE_WORDS * v->job.tile_count;
    tc_status status = TC_OK;
    *out = (edge_list){0};
    out->state = buffer_read(v, &v->work->state, words, &status);
    out->edges = buffer_read(v, &v->work->edges, VOLUME_EDGE_BYTES / 4 * slots, &status);
    out->entries = buffer_read(v, &v->work->entries, slots, &status);
    return status;
}

/* A word of a tile, of one of the scans. */
static uint32_t tile_word(const volume_run *v, const edge_list *l, int scan, uint32_t tile, int word) {
    return l->state[VOLUME_HEAD_WORDS + TILE_WORDS * ((size_t)scan * v->job.tile_count + tile) + (size_t)word];
}

static tc_status tile_join(const volume_run *v, const edge_list *l, uint32_t tile, const uint32_t *names,
                           joined_edges joined[BOUND_COUNT]) {
    const uint32_t cuts = tile ? tile_word(v, l, SCAN_CUTS, tile - 1, TILE_SUM_X) & SCAN_VALUE : 0;
    const uint32_t first = 4 * cuts, end = first + tile_word(v, l, SCAN_CROSSINGS, tile, TILE_EDGES);
    tc_status status = TC_OK;
    for (uint32_t n = first; n < end && !status; n++) {
        const uint32_t *edge = l->edges + 2 * (size_t)n;
        if (edge[0] != edge[1] && l->entries[n] == (n | EDGE_RESOLVED))
            status = joined_edges_add(&joined[edge[0] > edge[1] ? BOUND_HIGH : BOUND_LOW], names, edge[0], edge[1]);
    }
    return status;
}

tc_status volume_slab_join(const volume_run *v, const uint32_t *names, joined_edges joined[BOUND_COUNT]) {
    edge_list list;
    tc_status status = list_read(v, &list);
    if (!status) status = joined_edges_reserve(&joined[BOUND_LOW], v->head[VOLUME_LOW]);
    if (!status) status = joined_edges_reserve(&joined[BOUND_HIGH], v->head[VOLUME_HIGH]);
    for (uint32_t n = 0; n < v->job.tile_count && !status; n++) status = tile_join(v, &list, n, names, joined);
    list_release(&list);
    return status;
}
