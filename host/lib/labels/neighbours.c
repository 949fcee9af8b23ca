#include "labels/neighbours.h"

#include "failure.h"
#include "parallel.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK_TRIANGLES = 4096, RANGE_LEAST = 1 << 14 };

/* The vertices that a block of triangles uses: a range of vertices looks only at blocks that may use some of it. */
typedef struct block_span {
    uint32_t low, high;
} block_span;

/* What is known of a vertex while its list is found. */
typedef struct vertex_state {
    uint64_t sum; /* of the hashes of vertices after it in its triangles, less those of the vertices before it; 0: both
                     are the same set, or collide, with a probability of 2^-64: then the vertex is smoothed as an
                     inner one, on every machine */
    uint32_t count; /* of its triangles */
    uint32_t next;  /* the index of its next entry */
} vertex_state;

_Static_assert(sizeof(vertex_state) == NEIGHBOUR_STATE_BYTES, "the caller has room for it");

typedef struct search {
    const uint32_t *triangles;
    uint64_t triangle_count, block_count;
    block_span *blocks;
    vertex_state *states; /* of all vertices */
    neighbour_lists *lists;
    _Atomic uint64_t next;
} search;

static uint64_t block_end(const search *s, uint64_t block) {
    const uint64_t end = (block + 1) * BLOCK_TRIANGLES;
    return end < s->triangle_count ? end : s->triangle_count;
}

static void blocks_span(void *shared) {
    search *s = shared;
    for (uint64_t n; (n = atomic_fetch_add(&s->next, 1)) < s->block_count;) {
        block_span span = {UINT32_MAX, 0};
        for (uint64_t c = 3 * n * BLOCK_TRIANGLES; c < 3 * block_end(s, n); c++) {
            const uint32_t v = s->triangles[c];
            span.low = v < span.low ? v : span.low;
            span.high = v > span.high ? v : span.high;
        }
        s->blocks[n] = span;
    }
}

static bool is_beside(const block_span *b, const neighbour_range *r) { return b->low < r->end && b->high >= r->first; }

static uint64_t mixed(uint32_t vertex) { return (vertex + 1) * UINT64_C(0x9e3779b97f4a7c15) ^ vertex; }

/* state: of the vertex; entries: the lists of its range. */
typedef void corner_visit(vertex_state *state, uint32_t *entries, uint32_t after, uint32_t before);

/* Calls visit for the corners of triangles that lie at vertices of the range. */
static inline void corners_visit(const search *s, const neighbour_range *r, corner_visit *visit) {
    const uint32_t first = r->first, count = r->end - first;
    vertex_state *states = s->states + first;
    for (uint64_t b = 0; b < s->block_count; b++) {
        if (!is_beside(&s->blocks[b], r)) continue;
        for (const uint32_t *t = s->triangles + 3 * b * BLOCK_TRIANGLES; t < s->triangles + 3 * block_end(s, b);
             t += 3) {
            if (t[0] - first < count) visit(&states[t[0] - first], r->vertices, t[1], t[2]);
            if (t[1] - first < count) visit(&states[t[1] - first], r->vertices, t[2], t[0]);
            if (t[2] - first < count) visit(&states[t[2] - first], r->vertices, t[0], t[1]);
        }
    }
}

static void corner_count(vertex_state *state, uint32_t *entries, uint32_t after, uint32_t before) {
    (void)entries;
    state->count++;
    state->sum += mixed(after) - mixed(before);
}

/* A vertex whose followers are those before it lies within a surface: its neighbours are its followers. Other vertices
 * lie on junctions or borders, and need both. */
static void corner_fill(vertex_state *state, uint32_t *entries, uint32_t after, uint32_t before) {
    entries[state->next++] = after;
    if (state->sum) entries[state->next++] = before;
}

static void sort(uint32_t *values, uint32_t count) {
    for (uint32_t n = 1; n < count; n++) {
        const uint32_t value = values[n];
        uint32_t m = n;
        for (; m && values[m - 1] > value; m--) values[m] = values[m - 1];
        values[m] = value;
    }
}

/* Entries of a vertex, sorted: a neighbour is there once for each triangle at the edge. Those that pull are kept, at
 * the beginning, at most UINT8_MAX; returns how many. */
static uint8_t neighbours_choose(uint32_t *entries, uint32_t count, uint8_t *on_border) {
    uint32_t kept = 0;
    bool has_border = false, has_junction = false;
    for (uint32_t n = 0, end; n < count; n = end) {
        for (end = n; end < count && entries[end] == entries[n];) end++;
        has_border |= end - n == 1;
        has_junction |= end - n > 2;
    }
    for (uint32_t n = 0, end; n < count && kept < UINT8_MAX; n = end) {
        for (end = n; end < count && entries[end] == entries[n];) end++;
        if (has_border ? end - n == 1 : has_junction ? end - n > 2 : true) entries[kept++] = entries[n];
    }
    *on_border = has_border;
    return (uint8_t)kept;
}

/* Counts, and sets where the entries of each begin. */
static void ranges_count(void *shared) {
    search *s = shared;
    for (uint64_t n; (n = atomic_fetch_add(&s->next, 1)) < s->lists->range_count;) {
        neighbour_range *r = &s->lists->ranges[n];
        vertex_state *states = s->states + r->first;
        memset(states, 0, (size_t)(r->end - r->first) * sizeof *states);
        corners_visit(s, r, corner_count);
        for (uint32_t v = 0; v < r->end - r->first; v++) {
            r->starts[v] = states[v].next = (uint32_t)r->capacity;
            r->capacity += states[v].sum ? UINT64_C(2) * states[v].count : states[v].count;
        }
    }
}

static void ranges_fill(void *shared) {
    search *s = shared;
    for (uint64_t n; (n = atomic_fetch_add(&s->next, 1)) < s->lists->range_count;) {
        neighbour_range *r = &s->lists->ranges[n];
        corners_visit(s, r, corner_fill);
        for (uint32_t v = 0; v < r->end - r->first; v++) {
            const vertex_state *state = &s->states[r->first + v];
            uint32_t *entries = r->vertices + r->starts[v];
            r->on_border[v] = 0;
            r->counts[v] = (uint8_t)(state->count < UINT8_MAX ? state->count : UINT8_MAX);
            if (!state->sum) continue;
            sort(entries, 2 * state->count);
            r->counts[v] = neighbours_choose(entries, 2 * state->count, &r->on_border[v]);
        }
    }
}

static void on_shares(search *s, uint64_t share_count, void (*work)(void *shared)) {
    atomic_store(&s->next, 0);
    parallel_run(share_count, work, s);
}

static void ranges_make(uint64_t vertices, void *arrays, neighbour_lists *out) {
    const uint64_t wanted = vertices / RANGE_LEAST + 1;
    uint32_t *starts = arrays;
    uint8_t *counts = (uint8_t *)(starts + vertices), *on_border = counts + vertices;
    out->range_count = wanted < NEIGHBOUR_RANGES ? (uint32_t)wanted : NEIGHBOUR_RANGES;
    for (uint64_t n = 0; n < out->range_count; n++) {
        const uint64_t first = n * vertices / out->range_count, end = (n + 1) * vertices / out->range_count;
        out->ranges[n] = (neighbour_range){.first = (uint32_t)first,
                                           .end = (uint32_t)end,
                                           .starts = starts + first,
                                           .counts = counts + first,
                                           .on_border = on_border + first};
    }
}

/* False without memory, or numbers of 32 bits. */
static bool lists_reserve(neighbour_lists *lists, host_block *block) {
    uint64_t capacity = 0;
    for (uint32_t n = 0; n < lists->range_count; n++) {
        if (lists->ranges[n].capacity > UINT32_MAX) return false;
        capacity += lists->ranges[n].capacity;
    }
    if (host_block_reserve(block, (capacity + NEIGHBOURS_AHEAD + UINT8_MAX) * sizeof(uint32_t))) return false;
    uint32_t *vertices = block->memory;
    for (uint32_t n = 0; n < lists->range_count; n++) {
        lists->ranges[n].vertices = vertices;
        vertices += lists->ranges[n].capacity;
    }
    return true;
}

tc_status neighbours_find(const tc_mesh *mesh, void *states, host_block *arrays, host_block *lists,
                          neighbour_lists *out) {
    search s = {.triangles = mesh->triangles.memory,
                .triangle_count = mesh->triangle_count,
                .block_count = (mesh->triangle_count + BLOCK_TRIANGLES - 1) / BLOCK_TRIANGLES,
                .states = states,
                .lists = out};
    s.blocks = malloc((size_t)(s.block_count + 1) * sizeof *s.blocks);
    bool is_found = s.blocks && !host_block_reserve(arrays, mesh->vertex_count * (sizeof(uint32_t) + 2));
    if (is_found) {
        ranges_make(mesh->vertex_count, arrays->memory, out);
        on_shares(&s, s.block_count, blocks_span);
        on_shares(&s, out->range_count, ranges_count);
        is_found = lists_reserve(out, lists);
    }
    if (is_found) on_shares(&s, out->range_count, ranges_fill);
    free(s.blocks);
    return is_found ? TC_OK
                    : (tc_status)fail(TC_ERROR_MEMORY, "no memory to smooth the surfaces: ask for no smoothing");
}
