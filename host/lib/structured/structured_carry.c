/*
 * Fields carried to the vertices of a surface that kernel 1 has classified. Its sign words give the crossed edges
 * again, and it has stored where the vertices of each row of 64 samples begin. So threads of the host process shares of
 * bricks, and no kernel runs.
 *
 * Where the workspace holds these results no longer, the surface is counted again first. Of grids in slabs they are
 * kept on the host from the first field that is carried on (device_grid: carries). The vertices of snapped samples are
 * those of words of zeros; on which edges they lie follows from the samples (snapped_edge.h).
 */
#include "structured/structured.h"

#include "failure.h"
#include "grid/carry.h"
#include "tables/method.h"
#include "parallel.h"
#include "structured/crossed_rows.h"
#include "structured/snapped_edge.h"
#include "structured/structured_run.h"

#include <stdatomic.h>
#include <string.h>

enum { SHARE_BRICKS = 32, STEP_BRICKS = 1 << 16 };

/* A slab's active bricks, [next, end) of the list. */
typedef struct carry_job {
    const tc_grid *grid;
    const slab_plan *plan;
    const carry *carry;
    double isovalue;
    classified_rows rows;
    const uint32_t *active; /* the list of active bricks */
    snapped_edges snapped;
    int64_t from[EDGES_PER_SAMPLE][2],
        to[EDGES_PER_SAMPLE][2]; /* samples from an edge's owner to its ends, by parity */
    uint64_t window_brick;       /* the first of the slab's window of words, from which its list counts */
    uint64_t slab_brick;         /* the slab's first, and those before its end */
    uint64_t brick_end;
    uint64_t slab_vertex;
    _Atomic uint64_t next;
    uint64_t end;
    _Atomic uint64_t vertices; /* met so far, in all slabs */
    atomic_bool wrong;         /* the results contradict each other */
} carry_job;

/* ---------------------------------------------------------------------------------------------------------- batches */

/* Stores the first edge of bits at index `at`, without a branch: where bits is 0 the next edge overwrites it. Most rows
 * have at most two edges of a type, so row_add stores two before it branches. */
static inline void edge_put(const carry_job *j, uint64_t bits, int type, int64_t owner, unsigned odd, uint32_t at,
                            edge_batch *batch) {
    const unsigned bit = (unsigned)__builtin_ctzll(bits | UINT64_C(1) << 63), parity = (odd ^ bit) & 1;
    batch->low[at] = owner + bit + j->from[type][parity];
    batch->high[at] = owner + bit + j->to[type][parity];
}

/* Adds the crossed edges of a row in the order of their vertices. */
static void row_add(const carry_job *j, const uint64_t crossed[EDGES_PER_SAMPLE], const int64_t p[3],
                    edge_batch *batch) {
    const int64_t owner = (p[2] * j->grid->dims[1] + p[1]) * j->grid->dims[0] + p[0];
    const unsigned odd = (grid_parity(j->grid) + (unsigned)(p[1] + p[2])) & 1;
    if (batch->count + VERTEX_TYPES_MOST * 64 > BATCH_EDGES) carry_batch(j->carry, j->grid, j->isovalue, batch);
    uint32_t count = batch->count;
    for (int type = 0; type < j->rows.edge_types; type++) {
        uint64_t rest = crossed[type];
        edge_put(j, rest, type, owner, odd, count, batch);
        count += rest != 0, rest &= rest - 1;
        edge_put(j, rest, type, owner, odd, count, batch);
        count += rest != 0, rest &= rest - 1;
        for (; rest; rest &= rest - 1) edge_put(j, rest, type, owner, odd, count++, batch);
    }
    batch->count = count;
}

/* Adds the samples of a row that are vertices: snapped ones with the edges on which they lie, others at themselves.
 */
static void at_samples_add(const carry_job *j, uint64_t zeros, uint64_t others, const int64_t p[3], edge_batch *batch) {
    const int64_t owner = (p[2] * j->grid->dims[1] + p[1]) * j->grid->dims[0] + p[0];
    for (uint64_t rest = zeros | others; rest; rest &= rest - 1, batch->count++) {
        const int bit = __builtin_ctzll(rest);
        int64_t *low = &batch->low[batch->count], *high = &batch->high[batch->count];
        *low = *high = owner + bit;
        if (zeros >> bit & 1) snapped_edge_find(&j->snapped, (int64_t[3]){p[0] + bit, p[1], p[2]}, low, high);
    }
}

/* Prefetches a row of `count` items, each of `bytes`. */
static void row_prefetch(const void *values, size_t bytes, int64_t first, int64_t count) {
    const char *at = (const char *)values + bytes * (size_t)first, *end = at + bytes * (size_t)count;
    for (; at < end; at += 64) __builtin_prefetch(at);
}

/* Prefetches the samples and values at the edges of a brick, as hardware prefetch stops at page ends. */
static void brick_prefetch(const carry_job *j, uint64_t brick) {
    const tc_grid *grid = j->grid;
    const tc_field *f = j->carry->field;
    const slab_plan *plan = j->plan;
    const int64_t *dims = grid->dims, x = 64 * (int64_t)(brick % plan->words_x);
    const int64_t y = BRICK_ROWS * (int64_t)(brick / plan->words_x % plan->bricks_y);
    const int64_t z = BRICK_PLANES * (int64_t)(brick / plan->words_x / plan->bricks_y);
    const int64_t count = dims[0] - x < 64 ? dims[0] - x : 64;
    const size_t sample_bytes = tc_type_bytes(grid->type), field_bytes = tc_type_bytes(f->type) * (size_t)f->components;
    uint32_t before = 0, rest = j->rows.bricks[brick].rows;
    for (int plane = 0; plane <= BRICK_PLANES && z + plane < dims[2]; plane++, rest >>= BRICK_ROWS) {
        const uint32_t here = rest & ((1u << BRICK_ROWS) - 1), both = here | before;
        before = here;
        for (uint32_t rows = both | both << 1; rows; rows &= rows - 1) {
            const int64_t row = y + __builtin_ctz(rows);
            if (row >= dims[1]) break;
            row_prefetch(grid->samples, sample_bytes, ((z + plane) * dims[1] + row) * dims[0] + x, count);
            row_prefetch(f->values, field_bytes, ((z + plane) * dims[1] + row) * dims[0] + x, count);
        }
    }
}

static void brick_carry(carry_job *j, uint64_t brick, brick_words *words, edge_batch *batch) {
    const slab_plan *plan = j->plan;
    const int64_t *dims = j->grid->dims;
    const brick_state *state = &j->rows.bricks[brick];
    const uint32_t at[3] = {(uint32_t)(brick % plan->words_x), (uint32_t)(brick / plan->words_x % plan->bricks_y),
                            (uint32_t)(brick / plan->words_x / plan->bricks_y)};
    const uint32_t first[3] = {64 * at[0], BRICK_ROWS * at[1], BRICK_PLANES * at[2]};
    const uint64_t vertex = j->slab_vertex + state->vertices;
    if (batch->vertex + batch->count != vertex) {
        carry_batch(j->carry, j->grid, j->isovalue, batch);
        batch->vertex = vertex;
    }
    brick_words_load(&j->rows, brick, at, words);
    for (uint32_t rows = state->rows; rows; rows &= rows - 1) {
        const int brick_row = __builtin_ctz(rows), row = brick_row % BRICK_ROWS, plane = brick_row / BRICK_ROWS;
        const int64_t p[3] = {first[0], first[1] + (uint32_t)row, first[2] + (uint32_t)plane};
        const uint64_t packed = j->rows.offsets[BRICK_WORDS * brick + (uint64_t)brick_row];
        if (p[1] >= dims[1] || p[2] >= dims[2] || batch->vertex + batch->count != vertex + (packed & 0x3fff)) {
            j->wrong = true;
            return;
        }
        const crossed_row found = crossed_row_of(&j->rows, words, row, plane, p, packed);
        row_add(j, found.crossed, p, batch);
        at_samples_add(j, found.zeros, found.border, p, batch);
    }
    j->vertices += batch->vertex + batch->count - vertex;
}

/* Brick n of the list; UINT64_MAX where the entry is no brick of the slab. */
static uint64_t active_brick(const carry_job *j, uint64_t n) {
    const uint64_t brick = j->active[n] + j->window_brick;
    return brick >= j->slab_brick && brick < j->brick_end ? brick : UINT64_MAX;
}

static void bricks_carry(void *shared) {
    carry_job *j = shared;
    edge_batch batch = {.has_at_samples = j->rows.is_closed};
    brick_words words = {.zero = {{{0}}}};
    uint64_t n;
    while ((n = atomic_fetch_add(&j->next, SHARE_BRICKS)) < j->end && !j->wrong) {
        const uint64_t end = n + SHARE_BRICKS < j->end ? n + SHARE_BRICKS : j->end;
        for (uint64_t brick = active_brick(j, n), next; n < end; n++, brick = next) {
            next = n + 1 < end ? active_brick(j, n + 1) : UINT64_MAX;
            if (next != UINT64_MAX) brick_prefetch(j, next);
            if (brick != UINT64_MAX)
                brick_carry(j, brick, &words, &batch);
            else
                j->wrong = true;
        }
    }
    carry_batch(j->carry, j->grid, j->isovalue, &batch);
}

/* ------------------------------------------------------------------------------------------------------------ slabs */

static tc_status slab_carry(carry_job *j, uint32_t slab_index, uint32_t brick_count) {
    const slab_plan *plan = j->plan;
    const uint64_t layer = plan_bricks_per_layer(plan);
    j->window_brick = slab_words_begin(plan, slab_index) / BRICK_PLANES * layer;
    j->slab_brick = slab_begin(plan, slab_index) / BRICK_PLANES * layer;
    j->brick_end = (slab_end(plan, j->grid, slab_index) + BRICK_PLANES - 1ull) / BRICK_PLANES * layer;
    const uint64_t end = j->slab_brick + brick_count; /* of its part of the list */
    tc_status status = TC_OK;
    if (end > j->brick_end) j->wrong = true;
    for (uint64_t n = j->slab_brick; n < end && !j->wrong && !status; n += STEP_BRICKS) {
        j->next = n;
        j->end = end - n < STEP_BRICKS ? end : n + STEP_BRICKS;
        parallel_run((j->end - n + SHARE_BRICKS - 1) / SHARE_BRICKS, bricks_carry, j);
        status = context_progress(j->grid->context, "carry",
                                  0.5 + 0.5 * (double)j->vertices / (double)(j->carry->capacity + 1));
    }
    return status;
}

static tc_status slabs_carry(carry_job *j) {
    const uint32_t *heads = j->grid->device->heads;
    tc_status status = TC_OK;
    for (uint32_t n = 0; n < j->plan->own_slabs && !status; n++, heads += STATE_WORDS) {
        status = slab_carry(j, n, heads[STATE_ACTIVE_BRICKS]);
        j->slab_vertex += heads[STATE_VERTICES];
    }
    if (!status && (j->wrong || j->vertices != j->slab_vertex))
        status = (tc_status)fail(TC_ERROR_DATA, "samples, or what is blanked, have changed while a field was carried, "
                                                "or the device computes wrongly");
    return status;
}

/* Distances in samples from the owner of an edge to its ends. Diagonals depend on the parity of the cube. */
static void ends_fill(carry_job *j) {
    const int64_t strides[3] = {1, j->grid->dims[0], j->grid->dims[0] * j->grid->dims[1]};
    for (int type = 0; type < EDGES_PER_SAMPLE; type++)
        for (int parity = 0; parity < 2; parity++) {
            const int64_t turned = parity && type >= EDGE_XY ? strides[type == EDGE_YZ] : 0;
            int64_t across = 0;
            for (int axis = 0; axis < 3; axis++) across += edge_type_axes[type] >> axis & 1 ? strides[axis] : 0;
            j->from[type][parity] = turned;
            j->to[type][parity] = across - turned;
        }
}

/* Buffers of the workspace, mapped while threads read them. */
typedef struct mapping {
    const device_buffer *buffers[4];
    const void *memory[4];
} mapping;

/* Of several failures the last is reported. */
static tc_status mapping_close(tc_context *context, mapping *m, tc_status status) {
    for (int n = 0; n < 4; n++) {
        tc_status ended = buffer_unmap(context, m->buffers[n], m->memory[n]);
        if (ended) status = ended;
    }
    cl->Finish(context->queue);
    return status;
}

static tc_status mapping_open(tc_context *context, const slab_plan *plan, mapping *m) {
    const word_buffers *w = &context->work.words[0];
    const uint64_t bricks = plan->layer_count * plan_bricks_per_layer(plan), words = BRICK_WORDS * bricks;
    const uint64_t zeros = BRICK_WORDS * (uint64_t)plan_zero_bricks(plan);
    const uint64_t bytes[4] = {8 * (UNIFORM_BRICKS * BRICK_WORDS + words + zeros), 8 * words,
                               sizeof(brick_state) * bricks, 4 * bricks};
    *m = (mapping){.buffers = {&w->words, &w->offsets, &w->bricks, &w->active}};
    tc_status status = TC_OK;
    for (int n = 0; n < 4 && !status; n++) status = buffer_map(context, m->buffers[n], bytes[n], &m->memory[n]);
    return status ? mapping_close(context, m, status) : TC_OK;
}

void structured_keep_results(tc_grid *grid) { grid->device->carries = true; }

bool structured_is_classified(const tc_grid *grid, const tc_extract_options *options) {
    struct device_grid *device = grid->device;
    const inside_range inside = inside_range_of(grid->type, options->isovalue);
    if (!inside_has_surface(inside, options->closed)) return true;
    return grid->context->classified_grid == grid && device->classified_options.isovalue == options->isovalue &&
           device->classified_options.method == options->method &&
           (!method_has_zeros(options->method) || device->classified_options.snap == options->snap) &&
           !device->classified_options.closed == !options->closed &&
           (plan_of(device, options)->words_whole || device->store.words != NULL);
}

static classified_rows rows_of(const tc_grid *grid, const slab_plan *plan, const tc_extract_options *options) {
    const int zeros = method_has_zeros(options->method) ? 1 : 0;
    return (classified_rows){.grid = grid,
                             .plan = plan,
                             .edge_types = methods[options->method].vertex_types - zeros,
                             .is_closed = options->closed};
}

/* Kernel 1's results are kept on the host, or mapped from the workspace. */
static tc_status results_carry(carry_job *j, bool zeros) {
    classified_rows *r = &j->rows;
    if (!j->plan->words_whole) {
        const slab_store *s = &j->grid->device->store;
        r->words = (const uint64_t *)s->words, r->zeros = (const uint64_t *)s->zeros;
        r->offsets = (const uint64_t *)s->offsets, r->bricks = (const brick_state *)s->bricks;
        j->active = (const uint32_t *)s->active;
        return slabs_carry(j);
    }
    mapping m;
    tc_status status = mapping_open(j->grid->context, j->plan, &m);
    if (status) return status;
    r->words = (const uint64_t *)m.memory[0] + UNIFORM_BRICKS * BRICK_WORDS;
    r->zeros = zeros ? r->words + BRICK_WORDS * (uint64_t)plan_zero_bricks(j->plan) : NULL;
    r->offsets = m.memory[1], r->bricks = m.memory[2], j->active = m.memory[3];
    return mapping_close(j->grid->context, &m, slabs_carry(j));
}

tc_status structured_carry(const tc_grid *grid, const tc_extract_options *options, const carry *c,
                           uint64_t *vertex_count) {
    struct device_grid *device = grid->device;
    const slab_plan *plan = plan_of(device, options);
    carry_job j = {.grid = grid,
                   .plan = plan,
                   .carry = c,
                   .isovalue = options->isovalue,
                   .rows = rows_of(grid, plan, options),
                   .snapped = snapped_edges_of(grid, options)};
    *vertex_count = 0;
    if (!device->heads || !inside_has_surface(inside_range_of(grid->type, options->isovalue), options->closed))
        return TC_OK;
    for (uint32_t n = 0; n < plan->own_slabs; n++) *vertex_count += device->heads[n * STATE_WORDS + STATE_VERTICES];
    if (*vertex_count != c->capacity) return TC_OK; /* the caller compares the two */
    ends_fill(&j);
    return results_carry(&j, method_has_zeros(options->method));
}
