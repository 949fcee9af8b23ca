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

/* What is made for a range while its lists are found. */
typedef struct range_work {
    neighbour_range *r;
    uint64_t *sums;   /* per vertex: of its followers less that of those before it, mixed; 0: they are the same */
    uint32_t *places; /* per vertex: where its next entry goes; then where those of irregular ones begin */
    uint32_t *all;    /* of irregular vertices: followers, and those before */
} range_work;

static uint64_t mixed(uint32_t vertex) { return (vertex + 1) * UINT64_C(0x9e3779b97f4a7c15) ^ vertex; }

typedef void corner_visit(range_work *w, uint32_t vertex, uint32_t after, uint32_t before);

/* Calls visit for the corners of triangles that lie at vertices of the range; vertex: from its first on. */
static inline void corners_visit(const search *s, range_work *w, corner_visit *visit) {
    const uint32_t first = w->r->first, count = w->r->end - first;
    for (uint64_t b = 0; b < s->block_count; b++) {
        if (!is_beside(&s->blocks[b], w->r)) continue;
        for (const uint32_t *t = s->triangles + 3 * b * BLOCK_TRIANGLES; t < s->triangles + 3 * block_end(s, b);
             t += 3) {
            if (t[0] - first < count) visit(w, t[0] - first, t[1], t[2]);
            if (t[1] - first < count) visit(w, t[1] - first, t[2], t[0]);
            if (t[2] - first < count) visit(w, t[2] - first, t[0], t[1]);
        }
    }
}

static void corner_count(range_work *w, uint32_t vertex, uint32_t after, uint32_t before) {
    w->r->starts[vertex + 1]++;
    w->sums[vertex] += mixed(after) - mixed(before);
}

static void corner_fill(range_work *w, uint32_t vertex, uint32_t after, uint32_t before) {
    (void)before;
    w->r->vertices[w->places[vertex]++] = after;
}

static void corner_fill_all(range_work *w, uint32_t vertex, uint32_t after, uint32_t before) {
    if (!w->sums[vertex]) return;
    w->all[w->places[vertex]++] = after;
    w->all[w->places[vertex]++] = before;
}

static void sort(uint32_t *values, uint32_t count) {
    for (uint32_t n = 1; n < count; n++) {
        const uint32_t value = values[n];
        uint32_t m = n;
        for (; m && values[m - 1] > value; m--) values[m] = values[m - 1];
        values[m] = value;
    }
}

/* Entries of a vertex, sorted: a neighbour is there once for each triangle at the edge. Keeps those that pull, at most
 * `room`, at `to`; returns how many. */
static uint32_t neighbours_choose(const uint32_t *entries, uint32_t count, uint32_t *to, uint32_t room,
                                  uint8_t *on_border) {
    uint32_t kept = 0;
    bool has_border = false, has_junction = false;
    for (uint32_t n = 0, end; n < count; n = end) {
        for (end = n; end < count && entries[end] == entries[n];) end++;
        has_border |= end - n == 1;
        has_junction |= end - n > 2;
    }
    for (uint32_t n = 0, end; n < count && kept < room; n = end) {
        for (end = n; end < count && entries[end] == entries[n];) end++;
        if (has_border ? end - n == 1 : has_junction ? end - n > 2 : true) to[kept++] = entries[n];
    }
    *on_border = has_border;
    return kept;
}

/* A vertex whose followers are those before it lies within a surface: its neighbours are its followers. There is room
 * for one more, as a vertex with one triangle has two. False without memory, or numbers of 32 bits. */
static bool followers_find(const search *s, range_work *w) {
    neighbour_range *r = w->r;
    const uint32_t count = r->end - r->first;
    uint64_t sum = 0;
    corners_visit(s, w, corner_count);
    for (uint32_t n = 0; n < count; n++) {
        w->places[n] = (uint32_t)sum;
        sum += r->starts[n + 1] + 1u;
        if (sum > UINT32_MAX) return false;
        r->counts[n] = (uint8_t)(r->starts[n + 1] < UINT8_MAX ? r->starts[n + 1] : UINT8_MAX);
        r->starts[n + 1] = (uint32_t)sum;
    }
    r->vertices = malloc(((size_t)sum + 1) * sizeof *r->vertices);
    if (!r->vertices) return false;
    corners_visit(s, w, corner_fill);
    return true;
}

/* Other vertices lie on junctions or borders. */
static bool irregular_find(const search *s, range_work *w) {
    neighbour_range *r = w->r;
    const uint32_t count = r->end - r->first;
    uint32_t sum = 0;
    for (uint32_t n = 0; n < count; n++) {
        const uint32_t triangles = r->starts[n + 1] - r->starts[n] - 1;
        w->places[n] = sum;
        if (w->sums[n]) sum += 2 * triangles;
    }
    w->all = malloc(((size_t)sum + 1) * sizeof *w->all);
    if (!w->all) return false;
    corners_visit(s, w, corner_fill_all);
    for (uint32_t n = 0, begin = 0; n < count; n++) {
        if (!w->sums[n]) continue;
        const uint32_t room = r->starts[n + 1] - r->starts[n], end = w->places[n];
        sort(w->all + begin, end - begin);
        r->counts[n] = (uint8_t)neighbours_choose(w->all + begin, end - begin, r->vertices + r->starts[n],
                                                  room < UINT8_MAX ? room : UINT8_MAX, &r->on_border[n]);
        begin = end;
    }
    return true;
}

static bool range_find(const search *s, neighbour_range *r) {
    const size_t count = r->end - r->first;
    range_work w = {
        .r = r, .sums = calloc(count + 1, sizeof *w.sums), .places = malloc((count + 1) * sizeof *w.places)};
    r->starts = calloc(count + 1, sizeof *r->starts);
    r->counts = malloc(count + 1);
    r->on_border = calloc(count + 1, 1);
    bool is_found = w.sums && w.places && r->starts && r->counts && r->on_border;
    is_found = is_found && followers_find(s, &w) && irregular_find(s, &w);
    free(w.sums);
    free(w.places);
    free(w.all);
    return is_found;
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
        free(lists->ranges[n].counts);
        free(lists->ranges[n].on_border);
    }
    free(lists->ranges);
}
