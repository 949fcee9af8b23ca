/*
 * How a grid is cut into slabs for an interval volume, so that counts and buffers fit the device.
 */
#include "failure.h"
#include "structured/structured.h"
#include "structured/structured_interval.h"

static uint64_t least_u64(uint64_t a, uint64_t b) { return a < b ? a : b; }

uint32_t interval_slab_first(const interval_plan *plan, uint32_t n) { return n * plan->slab_layers; }

uint32_t interval_slab_own(const interval_plan *plan, uint32_t n) {
    return (uint32_t)least_u64(plan->slab_layers, plan->tiles.layer_count - interval_slab_first(plan, n));
}

uint32_t interval_slab_window(const interval_plan *plan, uint32_t n) {
    return (uint32_t)least_u64(interval_slab_own(plan, n) + 1ull,
                               plan->tiles.layer_count - interval_slab_first(plan, n));
}

/* What one brick can give at the most: 30 tetrahedra a cube, six vertices on each surface or itself a sample. */
static uint64_t brick_bytes_most(void) {
    const uint64_t samples = 64ull * BRICK_ROWS * BRICK_PLANES;
    return samples * (30ull * TETRAHEDRON_BYTES + (2ull * EDGES_PER_SAMPLE + 1) * 12) + 4ull * 2 * 4096;
}

/* A budget that is enough, whatever the samples are: half of what is left is the volume's. */
static uint64_t budget_enough(uint64_t window, uint64_t taken) {
    return 2 * (window > brick_bytes_most() ? window : brick_bytes_most()) + taken;
}

/* Bytes of everything but the volume, with windows of so many layers; *largest: of the largest buffer. */
static uint64_t window_bytes(const tc_context *context, const tc_grid *grid, interval_plan *plan, uint32_t layers,
                             uint64_t *largest) {
    slab_plan *tiles = &plan->tiles;
    tiles->slab_layers = layers;
    slab_plan_tiles(context, grid, tiles);
    const uint64_t bricks = layers * plan_bricks_per_layer(tiles),
                   words = 8ull * BRICK_WORDS * (bricks + UNIFORM_BRICKS);
    const uint64_t planes = least_u64(layers * (uint64_t)BRICK_PLANES + 3, (uint64_t)grid->dims[2]);
    const uint64_t cells = grid_can_miss_samples(grid) ? 8 * (planes + 2) * plan_words_per_plane(tiles, grid) : 0;
    uint64_t bytes = BOUND_COUNT * (2 * words + words / 4 + (sizeof(brick_state) + 4) * bricks) + cells;
    bytes += bricks * (4ull * BRICK_WORDS + sizeof(interval_brick)) + INTERVAL_TABLE_BYTES;
    bytes += BOUND_COUNT * 4ull * (STATE_WORDS + (uint64_t)TILE_WORDS * tiles->slab_tiles);
    bytes += 8ull * tiles->scratch_words * context->launch.work_groups + 24ull * 4096;
    *largest = words;
    for (int array = 0; array < ARRAY_COUNT && !plan->samples_whole; array++) {
        const uint64_t one = grid_array_data(grid, array) ? planes * grid_array_plane_bytes(grid, array) + 4096 : 0;
        bytes += one;
        if (one > *largest) *largest = one;
    }
    return bytes;
}

static bool window_fits(const tc_context *context, const tc_grid *grid, interval_plan *plan, uint32_t layers,
                        uint64_t budget) {
    uint64_t largest;
    const uint64_t bytes = window_bytes(context, grid, plan, layers, &largest);
    return bytes <= budget / 2 && largest <= context->info.max_buffer_bytes;
}

static tc_status plan_refuse(const tc_context *context, const tc_grid *grid, interval_plan *plan, uint32_t layers,
                             uint64_t taken) {
    uint64_t largest;
    const uint64_t bytes = window_bytes(context, grid, plan, layers, &largest);
    if (largest > context->info.max_buffer_bytes)
        return (tc_status)fail(TC_ERROR_MEMORY,
                               "two layers of this grid need larger buffers than %s has, %llu bytes each: use the "
                               "reference engine, or parts of the grid",
                               context->info.name, (unsigned long long)context->info.max_buffer_bytes);
    return (tc_status)fail(TC_ERROR_MEMORY,
                           "two layers of this grid need %llu bytes of device memory beside what they emit; allow %llu "
                           "or more",
                           (unsigned long long)bytes, (unsigned long long)budget_enough(bytes, taken));
}

tc_status interval_brick_refuse(const interval_run *r, uint64_t bytes) {
    const interval_plan *plan = &r->plan;
    return (tc_status)fail(TC_ERROR_MEMORY,
                           "a brick of 64 x 8 x 4 samples emits %llu bytes, and device memory is left for %llu; allow "
                           "%llu or more",
                           (unsigned long long)bytes, (unsigned long long)plan->mesh_bytes,
                           (unsigned long long)budget_enough(plan->least_bytes, plan->taken));
}

/* The most layers in a window, by bisection; 0 where not even `least` fit. */
static uint32_t layers_fit(const tc_context *context, const tc_grid *grid, interval_plan *plan, uint32_t least,
                           uint32_t most, uint64_t budget) {
    uint32_t low = least - 1, high = most;
    while (low < high) {
        const uint32_t middle = high - (high - low) / 2;
        if (window_fits(context, grid, plan, middle, budget))
            low = middle;
        else
            high = middle - 1;
    }
    return low < least ? 0 : low;
}

tc_status interval_plan_make(const tc_context *context, const tc_grid *grid, interval_plan *plan) {
    const uint64_t layer_samples = (uint64_t)(grid->dims[0] * grid->dims[1]) * BRICK_PLANES;
    const uint64_t limit = slab_samples_most((plan_needs){0}) / layer_samples, budget = context_budget(context);
    const uint64_t taken = context->device_bytes, left = budget > taken ? budget - taken : 0;
    uint64_t largest;
    *plan =
        (interval_plan){.tiles = grid->device->plans[0][0], .samples_whole = grid->device->plans[0][0].samples_whole};
    const uint32_t layers = plan->tiles.layer_count, least = layers > 1 ? 2 : 1;
    if (limit < least)
        return (tc_status)fail(
            TC_ERROR_LIMIT, "a plane of %lld x %lld samples is too large: eight planes may have %llu samples",
            (long long)grid->dims[0], (long long)grid->dims[1], (unsigned long long)slab_samples_most((plan_needs){0}));
    const uint32_t window = layers_fit(context, grid, plan, least, (uint32_t)least_u64(limit, layers), left);
    if (!window) return plan_refuse(context, grid, plan, least, taken);
    plan->slab_layers = window == layers ? layers : window - 1;
    plan->slab_count = (layers + plan->slab_layers - 1) / plan->slab_layers;
    plan->taken = taken;
    plan->least_bytes = window_bytes(context, grid, plan, least, &largest);
    plan->mesh_bytes = left - window_bytes(context, grid, plan, window, &largest);
    return TC_OK;
}
