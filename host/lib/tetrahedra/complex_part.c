/*
 * A part of a complex on the device: the caller's arrays, or a slab's own points gathered from them.
 */
#include "tetrahedra/complex_run.h"

#include "failure.h"

#include <stdlib.h>
#include <string.h>

tc_status part_tetrahedra_provide(tc_grid *grid, const uint32_t *tetrahedra, uint32_t count) {
    complex_part *part = &grid->complex->part;
    part->tetrahedron_count = count;
    tc_status status = buffer_provide(grid->context, &part->tetrahedra, tetrahedra, 16ull * count, 4,
                                      &part->tetrahedron_offset, "tetrahedra");
    const uint64_t range_bytes = sizeof(brick_range) * (uint64_t)complex_cluster_count(count);
    return status ? status : buffer_reserve(grid->context, &part->ranges, range_bytes, "ranges");
}

tc_status part_points_provide(tc_grid *grid, const float *points, const void *samples, uint32_t count) {
    complex_part *part = &grid->complex->part;
    const size_t sample_bytes = tc_type_bytes(grid->type);
    part->point_count = count;
    tc_status status =
        buffer_provide(grid->context, &part->points, points, 12ull * count, 4, &part->point_offset, "points");
    if (!status)
        status = buffer_provide(grid->context, &part->samples, samples, sample_bytes * (uint64_t)count, sample_bytes,
                                &part->sample_offset, "samples");
    if (status) part_points_release(grid);
    return status;
}

void part_tetrahedra_release(tc_grid *grid) {
    buffer_release(grid->context, &grid->complex->part.tetrahedra);
    buffer_release(grid->context, &grid->complex->part.ranges);
    border_buffers_release(grid->context, grid->complex->borders[0]);
}

void part_points_release(tc_grid *grid) {
    buffer_release(grid->context, &grid->complex->part.points);
    buffer_release(grid->context, &grid->complex->part.samples);
}

/* ---------------------------------------------------------------------------------------------------- local points */

tc_status local_points_allocate(const tc_grid *grid, uint32_t tetrahedron_count, local_points *local) {
    const size_t words = grid->complex->point_count / 64 + (size_t)1;
    uint64_t points = 4ull * tetrahedron_count;
    if (points > grid->complex->point_count) points = grid->complex->point_count;
    local->used = calloc(words, sizeof *local->used);
    local->before = malloc(words * sizeof *local->before);
    local->numbers = malloc((size_t)points * sizeof *local->numbers);
    local->points = malloc((size_t)points * 3 * sizeof *local->points);
    local->samples = malloc((size_t)points * tc_type_bytes(grid->type));
    local->tetrahedra = malloc(16 * (size_t)tetrahedron_count);
    if (local->used && local->before && local->numbers && local->points && local->samples && local->tetrahedra)
        return TC_OK;
    return (tc_status)fail(TC_ERROR_MEMORY, "the host has no memory to gather the points of a slab");
}

void local_points_release(local_points *local) {
    free(local->used);
    free(local->before);
    free(local->numbers);
    free(local->points);
    free(local->samples);
    free(local->tetrahedra);
    *local = (local_points){0};
}

static void point_gather(const tc_grid *grid, uint32_t point, uint32_t local_point, local_points *local) {
    const size_t bytes = tc_type_bytes(grid->type);
    local->numbers[local_point] = point;
    memcpy(local->points + 3 * (size_t)local_point, grid->complex->points + 3 * (size_t)point, 3 * sizeof(float));
    memcpy((char *)local->samples + bytes * local_point, (const char *)grid->samples + bytes * point, bytes);
}

tc_status local_points_gather(const tc_grid *grid, const uint32_t *tetrahedra, uint32_t tetrahedron_count,
                              local_points *local, uint32_t *count) {
    const uint32_t point_count = grid->complex->point_count;
    uint32_t least = UINT32_MAX, most = 0;
    *count = 0;
    for (uint64_t n = 0; n < 4ull * tetrahedron_count; n++) {
        if (tetrahedra[n] < least) least = tetrahedra[n];
        if (tetrahedra[n] > most) most = tetrahedra[n];
    }
    if (most >= point_count) return complex_point_fail(grid->complex);
    for (uint64_t n = 0; n < 4ull * tetrahedron_count; n++)
        local->used[tetrahedra[n] / 64] |= UINT64_C(1) << tetrahedra[n] % 64;
    for (uint32_t word = least / 64; word <= most / 64; word++) {
        local->before[word] = *count;
        for (uint64_t rest = local->used[word]; rest; rest &= rest - 1)
            point_gather(grid, 64 * word + (uint32_t)__builtin_ctzll(rest), (*count)++, local);
    }
    for (uint64_t n = 0; n < 4ull * tetrahedron_count; n++) {
        const uint32_t word = tetrahedra[n] / 64;
        const uint64_t lower = local->used[word] & ((UINT64_C(1) << tetrahedra[n] % 64) - 1);
        local->tetrahedra[n] = local->before[word] + (uint32_t)__builtin_popcountll(lower);
    }
    memset(local->used + least / 64, 0, (most / 64 - least / 64 + (size_t)1) * sizeof *local->used);
    return TC_OK;
}
