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
#include "structured/snapped_edge.h"
#include "structured/structured_run.h"

#include <stdatomic.h>
#include <string.h>

enum { SHARE_BRICKS = 32, STEP_BRICKS = 1 << 16 };

/* Results of kernel 1 for all slabs, in the host's memory. */
typedef struct results {
    const uint64_t *words, *zeros, *offsets; /* zeros: NULL where the method has none */
    const brick_state *bricks;
    const uint32_t *active;
} results;

/* A slab's active bricks, [next, end) of the list. */
typedef struct carry_job {
    const tc_grid *grid;
    const slab_plan *plan;
    const carry *carry;
    double isovalue;
    results k1;
    bool is_closed;
    snapped_edges snapped;
    int edge_types;
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

/* ------------------------------------------------------------------------------------------------------- sign words */

/* Words of the brick [0] and of the brick at higher x [1]: in the brick's planes and the plane after, of its rows and
 * the row after. */
typedef struct brick_words {
    uint64_t word[2][BRICK_PLANES + 1][BRICK_ROWS + 1];
    uint64_t zero[2][BRICK_PLANES + 1][BRICK_ROWS + 1];
} brick_words;

static const uint64_t outside[BRICK_WORDS];

static const uint64_t *words_of(const carry_job *j, uint64_t brick) {
    static const uint64_t inside[BRICK_WORDS] = {
        [0 ... BRICK_WORDS - 1] = UINT64_MAX,
    };
    const uint32_t sign = j->k1.bricks[brick].sign;
    return sign == SIGN_MIXED ? j->k1.words + BRICK_WORDS * brick : sign == SIGN_INSIDE ? inside : outside;
}

static const uint64_t *zeros_of(const carry_job *j, uint64_t brick) {
    return j->k1.zeros && j->k1.bricks[brick].sign == SIGN_MIXED ? j->k1.zeros + BRICK_WORDS * brick : outside;
}

/* Words of rows and planes outside the grid are undefined. */
static void brick_words_load(const carry_job *j, uint64_t brick, const uint32_t at[3], brick_words *w) {
    const uint64_t beside[3] = {1, j->plan->words_x, plan_bricks_per_layer(j->plan)};
    const uint32_t count[3] = {j->plan->words_x, j->plan->bricks_y, j->plan->layer_count};
    for (int n = 0; n < 8; n++) {
        const int side[3] = {n & 1, n >> 1 & 1, n >> 2};
        const int rows = side[1] ? 1 : BRICK_ROWS, planes = side[2] ? 1 : BRICK_PLANES;
        const uint64_t *words = outside, *zeros = outside;
        uint64_t other = brick;
        bool exists = true;
        for (int axis = 0; axis < 3; axis++) {
            exists = exists && at[axis] + (uint32_t)side[axis] < count[axis];
            other += side[axis] ? beside[axis] : 0;
        }
        if (exists) words = words_of(j, other), zeros = zeros_of(j, other);
        for (int z = 0; z < planes; z++) {
            const int plane = side[2] ? BRICK_PLANES : z, row = side[1] ? BRICK_ROWS : 0;
            const size_t bytes = (size_t)rows * sizeof *words;
            memcpy(&w->word[side[0]][plane][row], words + BRICK_ROWS * z, bytes);
            memcpy(&w->zero[side[0]][plane][row], zeros + BRICK_ROWS * z, bytes);
        }
    }
}

/* ------------------------------------------------------------------------------------------------------------ edges */

/* Rows of samples of a cube, and the same shifted to x + 1. */
typedef struct row_pair {
    uint64_t at, next, zero_at, zero_next;
} row_pair;

static row_pair row_of(const brick_words *w, int y, int z, uint64_t valid) {
    const uint64_t at = w->word[0][z][y] & valid, zero = w->zero[0][z][y];
    return (row_pair){at, at >> 1 | w->word[1][z][y] << 63, zero, zero >> 1 | w->zero[1][z][y] << 63};
}

/* Where the samples at the ends of an edge are on different sides. */
static uint64_t crossed_at(uint64_t p, uint64_t q, uint64_t zero_p, uint64_t zero_q) {
    return (p ^ q) & ~(zero_p | zero_q);
}

/* Samples of a word that exist. */
static uint64_t row_valid(const carry_job *j, uint32_t x) {
    const uint32_t left = (uint32_t)j->grid->dims[0] - x;
    return left >= 64 ? UINT64_MAX : (UINT64_C(1) << left) - 1;
}

/* As crossings_owned in kernels/structured/tetrahedra.cl: crossed edges that the samples of a row own. */
static void crossings_of(const carry_job *j, const brick_words *w, int row, int plane, const uint32_t first[3],
                         uint64_t crossed[EDGES_PER_SAMPLE]) {
    const int64_t *dims = j->grid->dims;
    const uint32_t left = (uint32_t)dims[0] - first[0], y = first[1] + (uint32_t)row, z = first[2] + (uint32_t)plane;
    const uint64_t valid = row_valid(j, first[0]), has_x = left > 64 ? valid : valid >> 1;
    const uint64_t has_y = y + 1 < dims[1] ? UINT64_MAX : 0, has_z = z + 1 < dims[2] ? UINT64_MAX : 0;
    const uint64_t even =
        (grid_parity(j->grid) + y + z) & 1 ? UINT64_C(0xaaaaaaaaaaaaaaaa) : UINT64_C(0x5555555555555555);
    const row_pair a = row_of(w, row, plane, valid), b = row_of(w, row + 1, plane, valid);
    const row_pair c = row_of(w, row, plane + 1, valid), d = row_of(w, row + 1, plane + 1, valid);
    const uint64_t xy = crossed_at(a.at, b.next, a.zero_at, b.zero_next),
                   yx = crossed_at(a.next, b.at, a.zero_next, b.zero_at);
    const uint64_t xz = crossed_at(a.at, c.next, a.zero_at, c.zero_next),
                   zx = crossed_at(a.next, c.at, a.zero_next, c.zero_at);
    const uint64_t yz = crossed_at(a.at, d.at, a.zero_at, d.zero_at), zy = crossed_at(b.at, c.at, b.zero_at, c.zero_at);
    crossed[EDGE_X] = crossed_at(a.at, a.next, a.zero_at, a.zero_next) & has_x;
    crossed[EDGE_Y] = crossed_at(a.at, b.at, a.zero_at, b.zero_at) & valid & has_y;
    crossed[EDGE_Z] = crossed_at(a.at, c.at, a.zero_at, c.zero_at) & valid & has_z;
    crossed[EDGE_XY] = ((even & xy) | (~even & yx)) & has_x & has_y;
    crossed[EDGE_XZ] = ((even & xz) | (~even & zx)) & has_x & has_z;
    crossed[EDGE_YZ] = ((even & yz) | (~even & zy)) & valid & has_y & has_z;
}

static bool cube_present(const tc_grid *grid, const int64_t p[3]) {
    const int64_t *dims = grid->dims;
    for (int axis = 0; axis < 3; axis++)
        if (p[axis] < 0 || p[axis] + 1 >= dims[axis]) return false;
    if (grid->blanked_cells && grid->blanked_cells[(p[2] * (dims[1] - 1) + p[1]) * (dims[0] - 1) + p[0]]) return false;
    for (int c = 0; c < 8; c++)
        if (grid_sample_missing(grid, ((p[2] + (c >> 2)) * dims[1] + p[1] + (c >> 1 & 1)) * dims[0] + p[0] + (c & 1)))
            return false;
    return true;
}

static const uint8_t edge_axes[EDGES_PER_SAMPLE] = {1, 2, 4, 3, 5, 6}; /* bit n: the edge spans axis n */

/* Those of the crossed edges of a type that a present cube contains. */
static uint64_t present_only(const carry_job *j, uint64_t crossed, int type, const int64_t first[3]) {
    uint64_t kept = 0;
    for (uint64_t rest = crossed; rest; rest &= rest - 1) {
        bool present = false;
        for (int back = 0; back < 8 && !present; back++) {
            const int64_t cube[3] = {first[0] + __builtin_ctzll(rest) - (back & 1), first[1] - (back >> 1 & 1),
                                     first[2] - (back >> 2)};
            present = !(back & edge_axes[type]) && cube_present(j->grid, cube);
        }
        if (present) kept |= rest & -rest;
    }
    return kept;
}

static bool at_border_of_cubes(const tc_grid *grid, const int64_t p[3]) {
    int present = 0;
    for (int c = 0; c < 8; c++)
        present += cube_present(grid, (int64_t[3]){p[0] - (c & 1), p[1] - (c >> 1 & 1), p[2] - (c >> 2)});
    return present > 0 && present < 8;
}

/* As border_samples in kernels/structured/border.cl: those of the samples of a row, from `first` on. */
static uint64_t border_only(const carry_job *j, uint64_t samples, const int64_t first[3]) {
    const int64_t *dims = j->grid->dims, last = dims[0] - 1 - first[0];
    uint64_t kept = first[0] == 0 ? 1 : 0;
    if (!j->grid->device->missing) {
        const bool all = first[1] == 0 || first[1] + 1 == dims[1] || first[2] == 0 || first[2] + 1 == dims[2];
        if (last < 64) kept |= UINT64_C(1) << last;
        return all ? samples : samples & kept;
    }
    kept = 0;
    for (uint64_t rest = samples; rest; rest &= rest - 1)
        if (at_border_of_cubes(j->grid, (int64_t[3]){first[0] + __builtin_ctzll(rest), first[1], first[2]}))
            kept |= rest & -rest;
    return kept;
}

/* Where a row's vertices of a type end, counted from its first, as kernel 1 has packed it
 * (kernels/structured/tetrahedra.cl: offsets_pack). The end of the last type is not packed. */
static uint32_t type_end(uint64_t packed, int type) {
    static const uint8_t shift[] = {14, 21, 29, 37, 46}, width[] = {7, 8, 8, 9, 9};
    return (uint32_t)(packed >> shift[type]) & ((1u << width[type]) - 1);
}

/* Cells are looked at only where kernel 1 has counted fewer vertices than edges are crossed, and for the last type. */
static void crossings_keep(const carry_job *j, uint64_t packed, const int64_t first[3],
                           uint64_t crossed[EDGES_PER_SAMPLE]) {
    uint32_t begin = 0;
    for (int type = 0; type < j->edge_types; type++) {
        const uint32_t end = type == EDGE_YZ ? begin : type_end(packed, type);
        if (begin + (uint32_t)__builtin_popcountll(crossed[type]) != end)
            crossed[type] = present_only(j, crossed[type], type, first);
        begin = end;
    }
}

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
    for (int type = 0; type < j->edge_types; type++) {
        uint64_t rest = crossed[type];
        edge_put(j, rest, type, owner, odd, count, batch);
        count += rest != 0, rest &= rest - 1;
        edge_put(j, rest, type, owner, odd, count, batch);
        count += rest != 0, rest &= rest - 1;
        for (; rest; rest &= rest - 1) edge_put(j, rest, type, owner, odd, count++, batch);
    }
    batch->count = count;
}

/* Adds the samples of a row that are vertices: snapped ones with the edges on which they lie, others in their places.
 */
static void places_add(const carry_job *j, uint64_t zeros, uint64_t others, const int64_t p[3], edge_batch *batch) {
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
    uint32_t before = 0, rest = j->k1.bricks[brick].rows;
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

static void brick_carry(carry_job *j, uint64_t brick, edge_batch *batch) {
    const slab_plan *plan = j->plan;
    const int64_t *dims = j->grid->dims;
    const brick_state *state = &j->k1.bricks[brick];
    const uint32_t at[3] = {(uint32_t)(brick % plan->words_x), (uint32_t)(brick / plan->words_x % plan->bricks_y),
                            (uint32_t)(brick / plan->words_x / plan->bricks_y)};
    const uint32_t first[3] = {64 * at[0], BRICK_ROWS * at[1], BRICK_PLANES * at[2]};
    const uint64_t vertex = j->slab_vertex + state->vertices;
    brick_words words;
    if (batch->vertex + batch->count != vertex) {
        carry_batch(j->carry, j->grid, j->isovalue, batch);
        batch->vertex = vertex;
    }
    brick_words_load(j, brick, at, &words);
    for (uint32_t rows = state->rows; rows; rows &= rows - 1) {
        const int brick_row = __builtin_ctz(rows), row = brick_row % BRICK_ROWS, plane = brick_row / BRICK_ROWS;
        const int64_t p[3] = {first[0], first[1] + (uint32_t)row, first[2] + (uint32_t)plane};
        const uint64_t packed = j->k1.offsets[BRICK_WORDS * brick + (uint64_t)brick_row];
        uint64_t crossed[EDGES_PER_SAMPLE];
        if (p[1] >= dims[1] || p[2] >= dims[2] || batch->vertex + batch->count != vertex + (packed & 0x3fff)) {
            j->wrong = true;
            return;
        }
        crossings_of(j, &words, row, plane, first, crossed);
        if (j->grid->device->missing) crossings_keep(j, packed, p, crossed);
        row_add(j, crossed, p, batch);
        const row_pair own = row_of(&words, row, plane, row_valid(j, first[0]));
        places_add(j, own.zero_at, j->is_closed ? border_only(j, own.at, p) : 0, p, batch);
    }
    j->vertices += batch->vertex + batch->count - vertex;
}

/* Brick n of the list; UINT64_MAX where the entry is no brick of the slab. */
static uint64_t active_brick(const carry_job *j, uint64_t n) {
    const uint64_t brick = j->k1.active[n] + j->window_brick;
    return brick >= j->slab_brick && brick < j->brick_end ? brick : UINT64_MAX;
}

static void bricks_carry(void *shared) {
    carry_job *j = shared;
    edge_batch batch = {.has_places = j->is_closed};
    uint64_t n;
    while ((n = atomic_fetch_add(&j->next, SHARE_BRICKS)) < j->end && !j->wrong) {
        const uint64_t end = n + SHARE_BRICKS < j->end ? n + SHARE_BRICKS : j->end;
        for (uint64_t brick = active_brick(j, n), next; n < end; n++, brick = next) {
            next = n + 1 < end ? active_brick(j, n + 1) : UINT64_MAX;
            if (next != UINT64_MAX) brick_prefetch(j, next);
            if (brick != UINT64_MAX)
                brick_carry(j, brick, &batch);
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
        status =
            context_progress(j->grid->context, "carry", 0.5 + 0.5 * (double)j->vertices / (double)(j->carry->room + 1));
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
            for (int axis = 0; axis < 3; axis++) across += edge_axes[type] >> axis & 1 ? strides[axis] : 0;
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

tc_status structured_carry(const tc_grid *grid, const tc_extract_options *options, const carry *c,
                           uint64_t *vertex_count) {
    struct device_grid *device = grid->device;
    carry_job j = {.grid = grid,
                   .plan = plan_of(device, options),
                   .carry = c,
                   .isovalue = options->isovalue,
                   .is_closed = options->closed,
                   .snapped = snapped_edges_of(grid, options)};
    const bool zeros = method_has_zeros(options->method);
    mapping m;
    *vertex_count = 0;
    if (!device->heads || !inside_has_surface(inside_range_of(grid->type, options->isovalue), options->closed))
        return TC_OK;
    for (uint32_t n = 0; n < j.plan->own_slabs; n++) *vertex_count += device->heads[n * STATE_WORDS + STATE_VERTICES];
    if (*vertex_count != c->room) return TC_OK; /* the caller compares the two */
    j.edge_types = methods[options->method].vertex_types - (zeros ? 1 : 0);
    ends_fill(&j);
    if (!j.plan->words_whole) {
        const slab_store *s = &device->store;
        j.k1 = (results){(const uint64_t *)s->words, (const uint64_t *)s->zeros, (const uint64_t *)s->offsets,
                         (const brick_state *)s->bricks, (const uint32_t *)s->active};
        return slabs_carry(&j);
    }
    tc_status status = mapping_open(grid->context, j.plan, &m);
    if (status) return status;
    const uint64_t *words = (const uint64_t *)m.memory[0] + UNIFORM_BRICKS * BRICK_WORDS;
    j.k1 = (results){words, zeros ? words + BRICK_WORDS * (uint64_t)plan_zero_bricks(j.plan) : NULL, m.memory[1],
                     m.memory[2], m.memory[3]};
    return mapping_close(grid->context, &m, slabs_carry(&j));
}
