#include "tetrahedra/whole_cases.h"

#include "tables/cell_cases.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Shapes of the index, with their quadrilaterals. */
typedef struct indexed_shape {
    uint32_t first; /* in the index */
    uint8_t corners, quadrilateral_count, quadrilaterals[6][4];
} indexed_shape;

enum {
    INDEX_TETRAHEDRON = 0,
    INDEX_HEXAHEDRON = INDEX_TETRAHEDRON + (2 << 4),
    INDEX_WEDGE = INDEX_HEXAHEDRON + (2 << 6 << 8),
    INDEX_PYRAMID = INDEX_WEDGE + (2 << 3 << 6),
    INDEX_SIZE = INDEX_PYRAMID + (2 << 1 << 5)
};

/* In any order, as long as it is one; from any corner on. */
static const indexed_shape indexed[CELL_PENTAGONAL_PRISM] = {
    [CELL_TETRAHEDRON] = {INDEX_TETRAHEDRON, 4, 0, {{0}}},
    [CELL_HEXAHEDRON] = {INDEX_HEXAHEDRON,
                         8,
                         6,
                         {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}},
    [CELL_WEDGE] = {INDEX_WEDGE, 6, 3, {{0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}},
    [CELL_PYRAMID] = {INDEX_PYRAMID, 5, 1, {{0, 3, 2, 1}}}};

enum { KEY_BYTES = 64, CASE_MOST = WHOLE_ENDS + CELL_EDGES_MAX + 3 * CELL_TRIANGLES_MAX };

typedef struct hashed_case {
    uint8_t key[KEY_BYTES];
    uint32_t answer; /* 0: free */
} hashed_case;

/* An answer has the case's number, one more, and the number of edges in its lower five bits. */
struct whole_cases {
    pthread_mutex_t lock; /* of all but the index */
    uint8_t *bytes;
    uint64_t units, unit_capacity;
    hashed_case *hashed; /* open addressing, half full at most */
    uint64_t hashed_count, hashed_capacity;
    _Atomic uint32_t index[INDEX_SIZE];
};

whole_cases *whole_cases_make(void) {
    whole_cases *c = calloc(1, sizeof *c);
    if (!c) return NULL;
    if (pthread_mutex_init(&c->lock, NULL)) {
        free(c);
        return NULL;
    }
    return c;
}

void whole_cases_release(whole_cases *c) {
    if (!c) return;
    pthread_mutex_destroy(&c->lock);
    free(c->bytes);
    free(c->hashed);
    free(c);
}

const uint8_t *whole_cases_bytes(const whole_cases *c, uint64_t *bytes) {
    *bytes = CASE_UNIT * c->units;
    return c->bytes;
}

/* -------------------------------------------------------------------------------------------------- what a case has */

/* Candidates of a cell: its crossed edges, and crossed diagonals of faces that are not cut; by the lower corner a bit
 * for the other. */
typedef struct candidates {
    uint16_t edges[CELL_CORNERS_MAX], diagonals[CELL_CORNERS_MAX];
} candidates;

static bool is_crossed(unsigned pattern, unsigned a, unsigned b) { return (pattern >> a & 1) != (pattern >> b & 1); }

static void pair_add(uint16_t pairs[CELL_CORNERS_MAX], uint8_t a, uint8_t b) {
    pairs[a < b ? a : b] |= (uint16_t)(1u << (a < b ? b : a));
}

static bool is_crossed_quadrilateral(const cell_frame *f, int face, unsigned pattern) {
    const uint8_t *corners = f->faces[face].corners;
    return f->faces[face].corner_count == 4 && is_crossed(pattern, corners[0], corners[2]);
}

/* The frame's edges are listed. */
static candidates candidates_of(const cell_frame *f, unsigned pattern) {
    candidates c = {{0}, {0}};
    for (int e = 0; e < f->edge_count; e++)
        if (is_crossed(pattern, f->edges[e][0], f->edges[e][1])) pair_add(c.edges, f->edges[e][0], f->edges[e][1]);
    for (int n = 0; n < f->face_count; n++)
        if (is_crossed_quadrilateral(f, n, pattern))
            pair_add(c.diagonals, f->faces[n].corners[0], f->faces[n].corners[2]);
    for (int n = 0; n < CELL_CORNERS_MAX; n++) c.diagonals[n] &= (uint16_t)~c.edges[n];
    return c;
}

/* The number of a pair among the candidates. */
static int candidate_number(const candidates *c, uint8_t a, uint8_t b) {
    const uint8_t low = a < b ? a : b, high = a < b ? b : a;
    int number = 0;
    for (int n = 0; n < low; n++) number += __builtin_popcount(c->edges[n] | c->diagonals[n]);
    return number + __builtin_popcount((unsigned)(c->edges[low] | c->diagonals[low]) & ((1u << high) - 1));
}

/* Cuts the quadrilaterals whose diagonal was found to be an edge: of another cell, or of the cell itself where corners
 * are one. */
static void frame_make(const case_question *q, cell_frame *frame) {
    cell_frame whole;
    cell_frame_begin(q->shape, q->points, q->mirrored, frame);
    whole = *frame;
    cell_frame_end(&whole);
    const candidates c = candidates_of(&whole, q->pattern);
    for (int n = 0; n < frame->face_count; n++) {
        if (!is_crossed_quadrilateral(frame, n, q->pattern)) continue;
        const uint8_t a = frame->faces[n].corners[0], b = frame->faces[n].corners[2];
        const uint8_t low = a < b ? a : b, high = a < b ? b : a;
        frame->is_cut[n] = c.edges[low] >> high & 1 || q->found >> candidate_number(&c, a, b) & 1;
    }
}

/* Writes the case of a frame whose edges are listed; returns its bytes. */
static uint32_t case_write(const cell_frame *f, const case_question *q, uint8_t out[CASE_MOST]) {
    const unsigned pattern = q->pattern;
    const candidates c = candidates_of(f, pattern);
    cell_case derived;
    uint8_t *ends = out + WHOLE_ENDS;
    memset(out, 0, WHOLE_ENDS);
    out[WHOLE_PATTERN] = (uint8_t)pattern;
    out[WHOLE_PATTERN + 1] = (uint8_t)(pattern >> 8);
    out[WHOLE_SHAPE] = (uint8_t)(q->shape | (q->mirrored ? CODE_MIRRORED : 0));
    cell_case_derive(f, pattern, &derived);
    for (uint8_t a = 0; a < CELL_CORNERS_MAX; a++)
        for (uint8_t b = a; b < CELL_CORNERS_MAX; b++) {
            if (!((c.edges[a] | c.diagonals[a]) >> b & 1)) continue;
            const int n = out[WHOLE_CANDIDATES]++;
            if (c.diagonals[a] >> b & 1) out[WHOLE_DIAGONALS + n / 8] |= (uint8_t)(1 << n % 8);
            *ends++ = (uint8_t)(a | b << 4);
        }
    out[WHOLE_TRIANGLES] = (uint8_t)derived.triangle_count;
    for (int n = 0; n < 3 * derived.triangle_count; n++) {
        const uint8_t *edge = f->edges[derived.triangles[n / 3][n % 3]];
        *ends++ = (uint8_t)candidate_number(&c, edge[0], edge[1]);
    }
    return (uint32_t)(ends - out);
}

/* -------------------------------------------------------------------------------------------------------- the table */

/* Appends a case; 0 where there is no memory, else the answer. */
static uint32_t case_append(whole_cases *c, const cell_frame *frame, const case_question *q) {
    uint8_t made[CASE_MOST];
    const uint32_t bytes = case_write(frame, q, made);
    const uint64_t units = (bytes + CASE_UNIT - 1) / CASE_UNIT, number = c->units;
    if (number + units > UINT32_MAX >> 6) return 0;
    if (number + units > c->unit_capacity) {
        const uint64_t capacity = 2 * (number + units) + 256;
        uint8_t *grown = realloc(c->bytes, CASE_UNIT * (size_t)capacity);
        if (!grown) return 0;
        c->bytes = grown;
        c->unit_capacity = capacity;
    }
    memset(c->bytes + CASE_UNIT * number, 0, CASE_UNIT * (size_t)units);
    memcpy(c->bytes + CASE_UNIT * number, made, bytes);
    c->units += units;
    return (uint32_t)(number + 1) << 5 | (uint32_t)__builtin_popcount(whole_case_edges(made));
}

/* All that a case follows from. */
static void key_make(const cell_frame *f, unsigned pattern, uint8_t key[KEY_BYTES]) {
    uint8_t *out = key;
    memset(key, 0, KEY_BYTES);
    *out++ = (uint8_t)f->shape;
    *out++ = (uint8_t)pattern;
    *out++ = (uint8_t)(pattern >> 8);
    for (int n = 0; n < f->face_count; n++) {
        *out++ = (uint8_t)(f->faces[n].corner_count | f->is_cut[n] << 4);
        memcpy(out, f->faces[n].corners, f->faces[n].corner_count);
        out += f->faces[n].corner_count;
    }
}

static hashed_case *hashed_find(const whole_cases *c, const uint8_t key[KEY_BYTES]) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (int n = 0; n < KEY_BYTES; n++) hash = (hash ^ key[n]) * 0x100000001b3u;
    uint64_t n = (hash ^ hash >> 29) & (c->hashed_capacity - 1);
    while (c->hashed[n].answer && memcmp(c->hashed[n].key, key, KEY_BYTES) != 0) n = (n + 1) & (c->hashed_capacity - 1);
    return &c->hashed[n];
}

static bool hashed_grow(whole_cases *c) {
    const uint64_t old_capacity = c->hashed_capacity;
    hashed_case *old = c->hashed, *grown = NULL;
    if (2 * c->hashed_count < old_capacity) return true;
    const uint64_t capacity = old_capacity ? 2 * old_capacity : 256;
    grown = calloc((size_t)capacity, sizeof *grown);
    if (!grown) return false;
    c->hashed = grown;
    c->hashed_capacity = capacity;
    for (uint64_t n = 0; n < old_capacity; n++)
        if (old[n].answer) *hashed_find(c, old[n].key) = old[n];
    free(old);
    return true;
}

/* By the hash; the lock is held. */
static uint32_t hashed_answer(whole_cases *c, const case_question *q) {
    cell_frame frame;
    uint8_t key[KEY_BYTES];
    frame_make(q, &frame);
    key_make(&frame, q->pattern, key);
    if (!hashed_grow(c)) return 0;
    hashed_case *h = hashed_find(c, key);
    if (h->answer) return h->answer;
    cell_frame_end(&frame);
    const uint32_t answer = case_append(c, &frame, q);
    if (!answer) return 0;
    memcpy(h->key, key, KEY_BYTES);
    h->answer = answer;
    c->hashed_count++;
    return answer;
}

static bool has_twins(const uint32_t *points, int count) {
    bool twins = false;
    for (int n = 1; n < count; n++)
        for (int m = 0; m < n; m++) twins |= points[n] == points[m];
    return twins;
}

/* Where the smallest of four numbers is. */
static uint32_t smallest_of_four(const uint32_t *points, const uint8_t corners[4]) {
    const uint32_t low = points[corners[1]] < points[corners[0]], high = 2u + (points[corners[3]] < points[corners[2]]);
    return points[corners[high]] < points[corners[low]] ? high : low;
}

uint32_t whole_order(cell_shape shape, const uint32_t *points) {
    if (shape >= CELL_PENTAGONAL_PRISM || has_twins(points, indexed[shape].corners)) return NO_ORDER;
    const indexed_shape *s = &indexed[shape];
    uint32_t order = 0, smallest = 0;
    for (int n = 0; n < s->quadrilateral_count; n++)
        order = order << 2 | smallest_of_four(points, s->quadrilaterals[n]);
    for (uint32_t n = 1; n < s->corners; n++) smallest = points[n] < points[smallest] ? n : smallest;
    return order << ORDER_CORNER_BITS | smallest;
}

/* Where in the index the case is; INDEX_SIZE: nowhere. */
static uint32_t index_of(const case_question *q) {
    uint32_t bits = q->mirrored;
    if (q->order == NO_ORDER || q->found) return INDEX_SIZE;
    const indexed_shape *s = &indexed[q->shape];
    for (int n = s->quadrilateral_count - 1; n >= 0; n--)
        bits = bits << 1 | (q->order >> (ORDER_CORNER_BITS + 2 * n) & 1);
    return s->first + (bits << s->corners | q->pattern);
}

bool whole_case_cut(whole_cases *c, const uint32_t *points, uint32_t found, uint32_t *number) {
    pthread_mutex_lock(&c->lock);
    const uint8_t *now = whole_case_at(c->bytes, *number);
    const case_question q = {.shape = (cell_shape)(now[WHOLE_SHAPE] & ~CODE_MIRRORED),
                             .mirrored = now[WHOLE_SHAPE] & CODE_MIRRORED,
                             .points = points,
                             .order = NO_ORDER,
                             .pattern = now[WHOLE_PATTERN] | (unsigned)now[WHOLE_PATTERN + 1] << 8,
                             .found = found};
    const uint32_t answer = hashed_answer(c, &q);
    pthread_mutex_unlock(&c->lock);
    *number = (answer >> 5) - 1;
    return answer != 0;
}

bool whole_case_find(whole_cases *c, const case_question *q, uint32_t *number, uint32_t *edges) {
    const uint32_t at = index_of(q);
    uint32_t answer = at < INDEX_SIZE ? atomic_load_explicit(&c->index[at], memory_order_acquire) : 0;
    if (!answer) {
        pthread_mutex_lock(&c->lock);
        if (at < INDEX_SIZE) answer = c->index[at];
        if (!answer) answer = hashed_answer(c, q);
        if (at < INDEX_SIZE) atomic_store_explicit(&c->index[at], answer, memory_order_release);
        pthread_mutex_unlock(&c->lock);
    }
    *number = (answer >> 5) - 1;
    *edges = answer & 31;
    return answer != 0;
}
