#include "structured/slab_plan.h"

#include "failure.h"
#include "kernels/base/slab.h"
#include "tables/tables.h"

/* A cube of five tetrahedra emits ten triangles at most, a sample owns six edges; a scan
 * word counts to 2^30. Closed surfaces have four triangles at most in each face of a cube, of which planes have one
 * more layer than cubes: ten, and 3 1/4 times four, as a slab has at least four planes. */
uint64_t slab_samples_most(plan_needs needs) { return ((UINT64_C(1) << 30) - 1) / (needs.closed ? 23 : 10); }

static uint64_t min_u64(uint64_t a, uint64_t b) { return a < b ? a : b; }

uint32_t slab_first_layer(const slab_plan *plan, uint32_t slab_index) {
    return slab_index < plan->own_slabs ? plan->own_first + slab_index * plan->slab_layers : plan->own_end;
}

uint32_t slab_layer_count(const slab_plan *plan, uint32_t slab_index) {
    const uint32_t left = plan->own_end - slab_first_layer(plan, slab_index);
    if (slab_index >= plan->own_slabs) return 1;
    return left < plan->slab_layers ? left : plan->slab_layers;
}

uint32_t slab_begin(const slab_plan *plan, uint32_t slab_index) {
    return slab_first_layer(plan, slab_index) * BRICK_PLANES;
}

uint32_t slab_end(const slab_plan *plan, const tc_grid *grid, uint32_t slab_index) {
    const uint64_t end = slab_first_layer(plan, slab_index) + (uint64_t)slab_layer_count(plan, slab_index);
    return (uint32_t)min_u64(end * BRICK_PLANES, (uint64_t)grid->dims[2]);
}

/* Layers of bricks before a slab and after it in its window of words. */
static uint32_t layers_before(const slab_plan *plan) { return plan->needs.zeros ? 2 : 0; }

static uint32_t layers_after(const slab_plan *plan) { return plan->needs.zeros ? 2 : 1; }

uint32_t slab_words_begin(const slab_plan *plan, uint32_t slab_index) {
    const uint32_t z0 = slab_begin(plan, slab_index);
    return plan->words_whole ? 0 : z0 - (uint32_t)min_u64(layers_before(plan) * BRICK_PLANES, z0);
}

uint32_t slab_words_end(const slab_plan *plan, const tc_grid *grid, uint32_t slab_index) {
    const uint64_t nz = (uint64_t)grid->dims[2], end = slab_end(plan, grid, slab_index);
    return (uint32_t)(plan->words_whole ? nz : min_u64(end + layers_after(plan) * BRICK_PLANES, nz));
}

uint32_t slab_samples_begin(const slab_plan *plan, uint32_t slab_index) {
    const uint32_t z0 = slab_begin(plan, slab_index);
    if (plan->samples_whole || z0 == 0) return 0;
    return plan->needs.zeros ? slab_words_begin(plan, slab_index) : z0 - 1;
}

uint32_t slab_samples_end(const slab_plan *plan, const tc_grid *grid, uint32_t slab_index) {
    const uint64_t nz = (uint64_t)grid->dims[2];
    if (plan->samples_whole) return (uint32_t)nz;
    return plan->needs.zeros ? slab_words_end(plan, grid, slab_index)
                             : (uint32_t)min_u64(slab_end(plan, grid, slab_index) + 2ull, nz);
}

uint32_t plan_window_count(const slab_plan *plan) { return plan->overlaps && !plan->samples_whole ? 2 : 1; }

uint32_t plan_window_layers(const slab_plan *plan) {
    return plan->words_whole ? plan->layer_count
                             : (uint32_t)min_u64((uint64_t)plan->slab_layers + layers_before(plan) + layers_after(plan),
                                                 plan->layer_count);
}

uint64_t plan_words_per_plane(const slab_plan *plan, const tc_grid *grid) {
    return (uint64_t)plan->words_x * (uint64_t)grid->dims[1];
}

uint64_t plan_cell_planes(const slab_plan *plan, const tc_grid *grid) {
    if (plan->needs.zeros) return min_u64(plan_window_layers(plan) * (uint64_t)BRICK_PLANES, (uint64_t)grid->dims[2]);
    return plan->slab_layers * (uint64_t)BRICK_PLANES + 2;
}

uint64_t plan_bricks_per_layer(const slab_plan *plan) { return (uint64_t)plan->words_x * plan->bricks_y; }

uint32_t plan_zero_bricks(const slab_plan *plan) {
    return plan->needs.zeros ? (uint32_t)(UNIFORM_BRICKS + plan_window_layers(plan) * plan_bricks_per_layer(plan)) : 0;
}

/* Tiles are larger on CPUs, where one work-item sweeps whole layers and their halo is read twice; elsewhere they have
 * about 16 K samples; tile_bricks of the scan decides instead of both. Never so large that groups run out of tiles. */
void slab_plan_tiles(const tc_context *context, const tc_grid *grid, slab_plan *plan) {
    uint64_t rows = (uint64_t)plan->bricks_y * plan->slab_layers;
    uint64_t wanted = (grid->scan.tile_bricks + plan->words_x - 1ull) / plan->words_x;
    if (!grid->scan.tile_bricks)
        wanted = context->launch.work_items == 1 ? rows / (16ull * context->launch.work_groups) : 8 / plan->words_x;
    if (wanted == 0) wanted = 1;
    plan->tile_rows = (uint32_t)min_u64(wanted, plan->bricks_y);
    /* A grid has rows of bricks. NOLINTNEXTLINE(clang-analyzer-core.DivideZero) */
    plan->tile_layers = (uint32_t)min_u64(wanted / plan->bricks_y, plan->slab_layers);
    if (plan->tile_layers == 0) plan->tile_layers = 1;
    plan->slab_tiles = ((plan->bricks_y + plan->tile_rows - 1) / plan->tile_rows) *
                       ((plan->slab_layers + plan->tile_layers - 1) / plan->tile_layers);
    plan->scratch_words = (BRICK_ROWS * (plan->tile_rows + 1) + BRICK_PLANES * plan->tile_layers) * plan->words_x;
}

uint64_t plan_array_bytes(const slab_plan *plan, const tc_grid *grid, int array) {
    uint64_t planes =
        plan->samples_whole
            ? (uint64_t)grid->dims[2]
            : min_u64((plan->slab_layers + (plan->needs.zeros ? 4ull : 0)) * BRICK_PLANES + 3, (uint64_t)grid->dims[2]);
    return grid_array_data(grid, array) ? planes * grid_array_plane_bytes(grid, array) : 0;
}

static uint64_t axes_bytes(const tc_grid *grid) {
    return grid->kind == GRID_RECTILINEAR ? 4 * (uint64_t)(grid->dims[0] + grid->dims[1] + grid->dims[2]) + 4096 : 0;
}

bool grid_can_miss_samples(const tc_grid *grid) {
    return grid->has_nodata || grid->blanked_samples || grid->blanked_cells || type_is_real(grid->type);
}

/* Bytes of everything but the mesh; *largest: of the largest buffer. */
static uint64_t plan_bytes(const tc_context *context, const tc_grid *grid, const slab_plan *plan, uint64_t *largest) {
    uint64_t layers = plan_window_layers(plan);
    uint64_t bricks = layers * plan_bricks_per_layer(plan), words = 8 * BRICK_WORDS * bricks;
    uint64_t signs = plan->needs.zeros ? 2 * words : words, arrays = 0, windows = plan_window_count(plan);
    uint64_t state = 4ull * plan->slab_count * (STATE_WORDS + (uint64_t)TILE_WORDS * plan->slab_tiles);
    uint64_t scratch = 8ull * plan->scratch_words * context->launch.work_groups;
    uint64_t ranges = sizeof(brick_range) * plan->layer_count * plan_bricks_per_layer(plan);
    uint64_t cases = 8 * CASES_TWO_SIGNS + (plan->needs.zeros ? 4 * CASES_THREE_SIGNS : 0),
             constant = plan->needs.zeros ? 4 : 2;
    if (plan->needs.closed) cases += (plan->needs.zeros ? 6ull : 4) * CAP_ENTRIES;
    uint64_t fixed =
        cases * CUBE_CASE_BYTES + constant * 8 * BRICK_WORDS + 12 * 4096; /* and buffers from page to page */
    *largest = signs;
    for (int array = 0; array < ARRAY_COUNT; array++) {
        uint64_t bytes = plan_array_bytes(plan, grid, array);
        arrays += bytes && array != ARRAY_SAMPLES ? bytes + 4096 : bytes;
        if (bytes > *largest) *largest = bytes;
    }
    uint64_t cells =
        grid_can_miss_samples(grid) ? 8 * plan_cell_planes(plan, grid) * plan_words_per_plane(plan, grid) : 0;
    uint64_t word_window = signs + words + words / 4 + (sizeof(brick_state) + 4) * bricks;
    return arrays * windows + axes_bytes(grid) + word_window * (plan->words_whole ? 1 : windows) + cells + ranges +
           state + scratch + fixed * windows;
}

static bool plan_fits(const tc_context *context, const tc_grid *grid, slab_plan *plan, uint32_t slab_layers,
                      uint64_t budget, uint64_t *bytes) {
    uint64_t largest;
    plan->slab_layers = slab_layers;
    plan->work_items = context->launch.work_items;
    plan->own_slabs = (plan->own_end - plan->own_first + slab_layers - 1) / slab_layers;
    plan->slab_count = plan->own_slabs + (plan->own_end < plan->layer_count);
    slab_plan_tiles(context, grid, plan);
    *bytes = plan_bytes(context, grid, plan, &largest);
    uint64_t words =
        (plan->needs.zeros ? 2ull : 1) * BRICK_WORDS * plan_window_layers(plan) * plan_bricks_per_layer(plan);
    return *bytes <= budget && largest <= context->info.max_buffer_bytes && words <= UINT32_MAX;
}

void slab_plan_reshape(const tc_context *context, const tc_grid *grid, slab_plan *plan) {
    uint64_t bytes;
    if (plan->work_items != context->launch.work_items) plan_fits(context, grid, plan, plan->slab_layers, 0, &bytes);
}

/* Most layers per slab that fit, by bisection; 0 where not even one does. */
static uint32_t layers_fit(const tc_context *context, const tc_grid *grid, slab_plan *plan, uint32_t most,
                           uint64_t budget) {
    uint64_t bytes;
    uint32_t low = 0, high = most;
    while (low < high) {
        uint32_t middle = high - (high - low) / 2;
        if (plan_fits(context, grid, plan, middle, budget, &bytes))
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

/* As layers_fit. Keeps all sign words on the device where at least one layer per slab fits beside them, else windows.
 */
static uint32_t windows_fit(const tc_context *context, const tc_grid *grid, slab_plan *plan, uint32_t most,
                            uint64_t budget) {
    uint64_t bytes;
    plan->words_whole = !plan->needs.zeros; /* which go with all samples or with windows of them */
    if (plan->words_whole) plan->words_whole = plan_fits(context, grid, plan, 1, budget, &bytes);
    if (plan->samples_whole && !plan->words_whole) plan->overlaps = false; /* slabs share the window of words */
    return layers_fit(context, grid, plan, most, budget);
}

static uint32_t layers_most(const tc_grid *grid, const slab_plan *plan) {
    const uint64_t layer_samples = (uint64_t)(grid->dims[0] * grid->dims[1]) * BRICK_PLANES;
    return (uint32_t)min_u64(slab_samples_most(plan->needs) / layer_samples, plan->own_end - plan->own_first);
}

static uint32_t layers_of(int64_t planes) { return (uint32_t)((planes + BRICK_PLANES - 1) / BRICK_PLANES); }

static slab_plan plan_begin(const tc_grid *grid, plan_needs needs) {
    return (slab_plan){.needs = needs,
                       .words_x = (uint32_t)((grid->dims[0] + 63) / 64),
                       .bricks_y = (uint32_t)((grid->dims[1] + BRICK_ROWS - 1) / BRICK_ROWS),
                       .layer_count = layers_of(grid->dims[2]),
                       .own_first = layers_of(grid->own[0]),
                       .own_end = layers_of(grid->own[1])};
}

/* The least bytes of everything but the mesh, and the bytes with all arrays whole; false where a buffer is too large.
 */
static bool plan_least(const tc_context *context, const tc_grid *grid, plan_needs needs, uint64_t *bytes) {
    slab_plan plan = plan_begin(grid, needs);
    plan.samples_whole = grid->cl_samples != NULL;
    return plan_fits(context, grid, &plan, 1, UINT64_MAX, bytes);
}

static bool plan_whole(const tc_context *context, const tc_grid *grid, plan_needs needs, uint64_t *bytes) {
    slab_plan plan = plan_begin(grid, needs);
    plan.samples_whole = plan.words_whole = true;
    plan.overlaps = !context->in_place;
    return plan_fits(context, grid, &plan, layers_most(grid, &plan), UINT64_MAX, bytes);
}

uint64_t plan_budget_whole(const tc_context *context, const tc_grid *grid, plan_needs needs) {
    uint64_t bytes;
    plan_whole(context, grid, needs, &bytes);
    return (bytes + 2) / 3 * 4; /* the mesh has a quarter */
}

/* The mesh has half of the budget where the grid is not whole, a quarter or more where it is; emission goes on with a
 * row of bricks in it at a time: six vertices per sample, with normals, and ten triangles per cube at most; where it is
 * closed, one vertex more, and four triangles for each of the faces of its cubes (3.4 a cube). */
uint64_t plan_budget(const tc_context *context, const tc_grid *grid, plan_needs needs) {
    const uint64_t closing = needs.closed ? 2 * 12 + 14 * 12 : 0;
    const uint64_t sample_bytes = 2 * EDGES_PER_SAMPLE * 12 + CUBE_TRIANGLES_MAX * 12 + closing;
    const uint64_t row = plan_begin(grid, needs).words_x * 64ull * BRICK_ROWS * BRICK_PLANES * sample_bytes;
    uint64_t least, whole, budget;
    plan_least(context, grid, needs, &least);
    budget = 2 * (least > row ? least : row);
    if (!plan_whole(context, grid, needs, &whole)) return budget;
    const uint64_t from = plan_budget_whole(context, grid, needs);
    return whole + row > (from > budget ? from : budget) ? whole + row : budget;
}

static tc_status plan_refuse(const tc_context *context, const tc_grid *grid, plan_needs needs) {
    uint64_t bytes;
    if (!plan_least(context, grid, needs, &bytes))
        return (tc_status)fail(TC_ERROR_MEMORY,
                               "a layer of this grid needs larger buffers than %s has, %llu bytes each: use the "
                               "reference engine, or parts of the grid",
                               context->info.name, (unsigned long long)context->info.max_buffer_bytes);
    return (tc_status)fail(TC_ERROR_MEMORY,
                           "a layer of this grid needs %llu bytes of device memory beside its mesh; allow %llu or more",
                           (unsigned long long)bytes, (unsigned long long)plan_budget(context, grid, needs));
}

tc_status slab_plan_make(const tc_context *context, const tc_grid *grid, plan_needs needs, sample_storage samples,
                         slab_plan *plan) {
    uint64_t layer_samples = (uint64_t)(grid->dims[0] * grid->dims[1]) * BRICK_PLANES, bytes;
    const uint64_t budget = context_budget(context);
    *plan = plan_begin(grid, needs);
    if (layer_samples > slab_samples_most(needs))
        return (tc_status)fail(TC_ERROR_LIMIT, "a plane of %lld x %lld samples is too large: four planes may have %llu",
                               (long long)grid->dims[0], (long long)grid->dims[1],
                               (unsigned long long)slab_samples_most(needs));
    const uint32_t most = layers_most(grid, plan);
    plan->samples_whole = plan->words_whole = true;
    plan->overlaps = !context->in_place;
    if (samples == SAMPLES_IN_WINDOWS || !plan_fits(context, grid, plan, most, budget / 4 * 3, &bytes)) {
        plan->samples_whole = samples == SAMPLES_WHOLE || grid->cl_samples != NULL;
        const uint64_t part = samples == SAMPLES_WHOLE ? budget / 4 * 3 : budget / 2;
        uint32_t layers = windows_fit(context, grid, plan, most, part);
        if (layers == 0 && plan->overlaps) {
            plan->overlaps = false;
            layers = windows_fit(context, grid, plan, most, part);
        }
        if (layers == 0) return plan_refuse(context, grid, needs);
        plan_fits(context, grid, plan, layers, budget, &bytes);
    }
    plan->mesh_bytes = budget - bytes;
    return TC_OK;
}
