#include "labels/neighbours.h"

#include "failure.h"
#include "parallel.h"

#include <stdatomic.h>
#include <stdlib.h>

enum { BLOCK_TRIANGLES = 4096, RANGES_MOST = 64, RANGE_LEAST = 1 << 14 };

/* The vertices that a block of triangles uses: a range of vertices looks only at blocks that may use some of it. */
typedef struct block_span {
    uint32_t low, high;
} block_span;

typedef struct search {
    const uint32_t *triangles;
    uint64_t triangle_count, block_count;
    block_span *blocks;
    neighbour_lists *lists;
    _Atomic uint64_t next;
    atomic_bool has_failed;
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

/* starts[n + 1] becomes the number of entries of vertex n: two for each of its triangles. False where they have no
 * numbers of 32 bits. */
static bool entries_count(const search *s, const neighbour_range *r) {
    uint64_t sum = 0;
    for (uint64_t b = 0; b < s->block_count; b++)
        for (uint64_t c = 3 * b * BLOCK_TRIANGLES; is_beside(&s->blocks[b], r) && c < 3 * block_end(s, b); c++)
            if (s->triangles[c] >= r->first && s->triangles[c] < r->end) r->starts[s->triangles[c] - r->first + 1] += 2;
    for (uint32_t n = 0; n < r->end - r->first; n++) {
        sum += r->starts[n + 1];
        if (sum > UINT32_MAX) return false;
        r->starts[n + 1] = (uint32_t)sum;
    }
    return true;
}

/* Uses starts[n] as the place of the next entry: afterwards it is where those of n + 1 begin. */
static void entries_fill(const search *s, const neighbour_range *r) {
    for (uint64_t b = 0; b < s->block_count; b++)
        for (uint64_t t = b * BLOCK_TRIANGLES; is_beside(&s->blocks[b], r) && t < block_end(s, b); t++)
            for (unsigned c = 0; c < 3; c++) {
                const uint32_t *triangle = s->triangles + 3 * t, v = triangle[c];
                if (v < r->first || v >= r->end) continue;
                uint32_t *to = &r->starts[v - r->first];
                r->vertices[(*to)++] = triangle[(c + 1) % 3];
                r->vertices[(*to)++] = triangle[(c + 2) % 3];
            }
}

static void sort(uint32_t *values, uint32_t count) {
    for (uint32_t n = 1; n < count; n++) {
        const uint32_t value = values[n];
        uint32_t m = n;
        for (; m && values[m - 1] > value; m--) values[m] = values[m - 1];
        values[m] = value;
    }
}

/* Entries of a vertex, sorted: a neighbour is there once for each triangle at the edge. Keeps those that pull, at `to`;
 * returns how many. */
static uint32_t neighbours_choose(const uint32_t *entries, uint32_t count, uint32_t *to, uint8_t *on_border) {
    uint32_t kept = 0;
    bool has_border = false, has_junction = false;
    for (uint32_t n = 0, end; n < count; n = end) {
        for (end = n; end < count && entries[end] == entries[n];) end++;
        has_border |= end - n == 1;
        has_junction |= end - n > 2;
    }
    for (uint32_t n = 0, end; n < count; n = end) {
        for (end = n; end < count && entries[end] == entries[n];) end++;
        const uint32_t vertex = entries[n]; /* to may lie before the entries, not behind */
        if (has_border ? end - n == 1 : has_junction ? end - n > 2 : true) to[kept++] = vertex;
    }
    *on_border = has_border;
    return kept;
}

/* Sorts the entries of each vertex, and closes up what is kept of them. */
static void entries_reduce(const neighbour_range *r) {
    uint32_t begin = 0, kept = 0;
    for (uint32_t n = 0; n < r->end - r->first; n++) {
        const uint32_t end = r->starts[n];
        sort(r->vertices + begin, end - begin);
        r->starts[n] = kept;
        kept += neighbours_choose(r->vertices + begin, end - begin, r->vertices + kept, &r->on_border[n]);
        begin = end;
    }
    r->starts[r->end - r->first] = kept;
}

static bool range_find(const search *s, neighbour_range *r) {
    const size_t count = r->end - r->first;
    r->starts = calloc(count + 1, sizeof *r->starts);
    r->on_border = malloc(count + 1);
    if (!r->starts || !r->on_border || !entries_count(s, r)) return false;
    r->vertices = malloc(((size_t)r->starts[count] + 1) * sizeof *r->vertices);
    if (!r->vertices) return false;
    entries_fill(s, r);
    entries_reduce(r);
    return true;
}

static void ranges_find(void *shared) {
    search *s = shared;
    for (uint64_t n; (n = atomic_fetch_add(&s->next, 1)) < s->lists->range_count;)
        if (!range_find(s, &s->lists->ranges[n])) atomic_store(&s->has_failed, true);
}

tc_status neighbours_find(const tc_mesh *mesh, neighbour_lists *out) {
    const uint64_t vertices = mesh->vertex_count, wanted = vertices / RANGE_LEAST + 1;
    const uint32_t ranges = wanted < RANGES_MOST ? (uint32_t)wanted : RANGES_MOST;
    search s = {.triangles = mesh->triangles.memory, .triangle_count = mesh->triangle_count, .lists = out};
    *out = (neighbour_lists){calloc(ranges, sizeof *out->ranges), ranges};
    s.block_count = (s.triangle_count + BLOCK_TRIANGLES - 1) / BLOCK_TRIANGLES;
    s.blocks = malloc((size_t)(s.block_count + 1) * sizeof *s.blocks);
    if (!out->ranges || !s.blocks) atomic_store(&s.has_failed, true);
    for (uint64_t n = 0; n < ranges && out->ranges; n++) {
        out->ranges[n].first = (uint32_t)(n * vertices / ranges);
        out->ranges[n].end = (uint32_t)((n + 1) * vertices / ranges);
    }
    if (!s.has_failed) {
        parallel_run(s.block_count, blocks_span, &s);
        atomic_store(&s.next, 0);
        parallel_run(ranges, ranges_find, &s);
    }
    free(s.blocks);
    return s.has_failed ? (tc_status)fail(TC_ERROR_MEMORY, "no memory to smooth the surfaces: ask for no smoothing")
                        : TC_OK;
}

void neighbours_release(neighbour_lists *lists) {
    for (uint32_t n = 0; n < lists->range_count && lists->ranges; n++) {
        free(lists->ranges[n].starts);
        free(lists->ranges[n].vertices);
        free(lists->ranges[n].on_border);
    }
    free(lists->ranges);
}
