/*
 * How much of the device's memory a complex takes, and slabs of it.
 *
 * Beside the caller's arrays: about two bytes per tetrahedron before the surface is known; then up to 190 bytes per
 * active tetrahedron, mesh included, for four crossed edges, each with a vertex of its own, and two triangles. For
 * slabs every tetrahedron counts as active; for those of interval volumes by both bounds, with six tetrahedra of the
 * volume.
 */
#include "kernels/tetrahedra/complex_interval_job.h"
#include "tetrahedra/complex_run.h"

#include "failure.h"

#include <stdlib.h>

/* Sums of the scan, four slots per tetrahedron or six tetrahedra of an interval volume among them, take 30 bits. */
static const uint64_t slab_tetrahedra_most = UINT64_C(1) << 27, whole_tetrahedra_most = UINT64_C(1) << 28;

typedef struct device_need {
    uint64_t bytes, largest; /* of all buffers, of one */
} device_need;

static void need_add(device_need *need, uint64_t bytes) {
    need->bytes += bytes;
    if (bytes > need->largest) need->largest = bytes;
}

uint32_t complex_cluster_count(uint64_t tetrahedron_count) {
    return (uint32_t)((tetrahedron_count + CLUSTER_TETRAHEDRA - 1) / CLUSTER_TETRAHEDRA);
}

uint32_t complex_tile_clusters(const tc_grid *grid) {
    const uint32_t work_items = grid->context->launch.work_items, given = grid->scan.tile_bricks;
    const uint32_t tile = given ? given : work_items == 1 ? 1024 : 64;
    return work_items > tile ? work_items : tile;
}

uint32_t complex_tile_actives(const tc_grid *grid) {
    return grid->context->launch.work_items == 1 && !grid->scan.tile_bricks ? 1024 : complex_tile_clusters(grid);
}

uint32_t complex_interval_tile_shift(const tc_grid *grid) {
    const uint32_t clusters = complex_tile_clusters(grid);
    const uint32_t most = grid->context->launch.work_items == 1 ? VOLUME_TILE_MOST : UINT32_MAX;
    uint32_t shift = 0;
    while (UINT32_C(1) << shift < (clusters < most ? clusters : most)) shift++;
    return shift;
}

/* A part's arrays, ranges of its clusters, and the 16 cases. */
static device_need arrays_need(const tc_grid *grid, uint64_t points, uint64_t tetrahedra) {
    const uint64_t clusters = complex_cluster_count(tetrahedra), page = grid->context->in_place ? PAGE_BYTES : 0;
    device_need need = {0, 0};
    need_add(&need, page + 16 * tetrahedra);
    need_add(&need, page + 12 * points);
    need_add(&need, page + tc_type_bytes(grid->type) * points);
    need_add(&need, sizeof(brick_range) * clusters);
    need_add(&need, 16 * CASE_BYTES);
    return need;
}

/* What kernel 1 works on beside them. */
static void classify_add(const tc_grid *grid, uint64_t tetrahedra, device_need *need) {
    const uint64_t clusters = complex_cluster_count(tetrahedra), tiles = clusters / complex_tile_clusters(grid) + 1;
    need_add(need, sizeof(cluster_state) * clusters);
    need_add(need, 4 * clusters); /* those that are active */
    need_add(need, 4 * (HEAD_WORDS + TILE_WORDS * tiles));
}

/* The table of so many crossed edges. */
static void table_add(uint64_t crossed, device_need *need) {
    uint64_t entries = 64;
    while (entries < 2 * crossed) entries *= 2;
    need_add(need, 4 * entries);
}

/* The largest surface. */
static void surface_add(const tc_grid *grid, uint64_t tetrahedra, device_need *need) {
    classify_add(grid, tetrahedra, need);
    need_add(need, sizeof(active_tetrahedron) * tetrahedra);
    need_add(need, 16 * tetrahedra); /* entries of its edges */
    need_add(need, 4 * TILE_WORDS * (tetrahedra / complex_tile_actives(grid) + 1));
    table_add(4 * tetrahedra, need);
    need_add(need, 4 * CHANNEL_BYTES * tetrahedra);
    need_add(need, 2 * TRIANGLE_BYTES * tetrahedra);
}

/* The largest interval volume of a slab: both bounds cut all tetrahedra. */
static void interval_add(const tc_grid *grid, uint64_t tetrahedra, device_need *need) {
    const uint64_t clusters = complex_cluster_count(tetrahedra), slots = 2 * 4 * tetrahedra;
    const uint64_t tiles = (clusters >> complex_interval_tile_shift(grid)) + 1;
    need_add(need, sizeof(volume_cluster) * clusters);
    need_add(need, 4 * (VOLUME_HEAD_WORDS + VOLUME_SCANS * TILE_WORDS * tiles));
    need_add(need, VOLUME_TABLE_BYTES);
    need_add(need, VOLUME_EDGE_BYTES * slots);
    need_add(need, 4 * slots); /* entries */
    if (grid->context->launch.work_items == 1) need_add(need, VOLUME_SLOT_BYTES * slots);
    table_add(slots, need);
    need_add(need, CHANNEL_BYTES * slots);
    need_add(need, 6 * TETRAHEDRON_BYTES * tetrahedra);
}

static bool need_fits(const tc_context *context, device_need need) {
    return need.bytes <= context_budget(context) && need.largest <= context->info.max_buffer_bytes;
}

bool complex_fits(const tc_grid *grid) {
    const complex_grid *c = grid->complex;
    device_need need = arrays_need(grid, c->point_count, c->tetrahedron_count);
    classify_add(grid, c->tetrahedron_count, &need);
    return c->tetrahedron_count <= whole_tetrahedra_most && need_fits(grid->context, need);
}

bool complex_interval_sums_fit(const tc_grid *grid) { return grid->complex->tetrahedron_count <= slab_tetrahedra_most; }

static device_need slab_need(const tc_grid *grid, uint64_t clusters, bool points_whole, bool interval) {
    const complex_grid *c = grid->complex;
    uint64_t tetrahedra = CLUSTER_TETRAHEDRA * clusters, points = c->point_count;
    if (tetrahedra > c->tetrahedron_count) tetrahedra = c->tetrahedron_count;
    if (!points_whole && 4 * tetrahedra < points) points = 4 * tetrahedra;
    device_need need = arrays_need(grid, points, tetrahedra);
    if (interval)
        interval_add(grid, tetrahedra, &need);
    else
        surface_add(grid, tetrahedra, &need);
    return need;
}

/* Most clusters per slab that fit, by bisection; 0 where not even one does. */
static uint32_t clusters_fit(const tc_grid *grid, bool points_whole, bool interval) {
    uint32_t low = 0, high = complex_cluster_count(grid->complex->tetrahedron_count);
    if (high > slab_tetrahedra_most / CLUSTER_TETRAHEDRA) high = (uint32_t)(slab_tetrahedra_most / CLUSTER_TETRAHEDRA);
    while (low < high) {
        const uint32_t middle = high - (high - low) / 2;
        if (need_fits(grid->context, slab_need(grid, middle, points_whole, interval)))
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

static tc_status cut_refuse(const tc_grid *grid, bool interval) {
    const device_need need = slab_need(grid, 1, false, interval);
    return (tc_status)fail(TC_ERROR_MEMORY,
                           "the smallest slab of these tetrahedra needs %llu bytes of device memory, and the budget is "
                           "%llu: allow %llu or, to be faster, much more",
                           (unsigned long long)need.bytes, (unsigned long long)context_budget(grid->context),
                           (unsigned long long)need.bytes);
}

static tc_status slabs_make(const tc_grid *grid, bool interval, struct complex_slabs **out) {
    const uint32_t clusters = complex_cluster_count(grid->complex->tetrahedron_count);
    const uint32_t local = clusters_fit(grid, false, interval), whole = clusters_fit(grid, true, interval);
    if (!local) return cut_refuse(grid, interval);
    struct complex_slabs *slabs = calloc(1, sizeof *slabs);
    if (slabs) slabs->ranges = malloc(sizeof *slabs->ranges * (size_t)clusters);
    if (!slabs || !slabs->ranges) {
        free(slabs);
        return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the ranges of clusters");
    }
    /* Points of their own cost more than smaller slabs do. Of interval volumes, points share their numbers with
     * vertices. */
    slabs->points_whole =
        whole > 0 && whole >= local / 4 && (!interval || grid->complex->point_count <= UINT32_MAX / 2);
    slabs->slab_clusters = slabs->points_whole ? whole : local;
    slabs->slab_count = (clusters + slabs->slab_clusters - 1) / slabs->slab_clusters;
    *out = slabs;
    return TC_OK;
}

void complex_slabs_release(struct complex_slabs *slabs) {
    if (slabs) free(slabs->ranges);
    free(slabs);
}

tc_status complex_cut(tc_grid *grid) { return slabs_make(grid, false, &grid->complex->slabs); }

tc_status complex_interval_cut(tc_grid *grid) { return slabs_make(grid, true, &grid->complex->interval_slabs); }
