#include "grid/interval.h"

#include "base/structs.h"
#include "failure.h"
#include "host_memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool interval_bounds_find(tc_type type, const tc_interval_volume_options *options, inside_range inside[BOUND_COUNT],
                          bool exists[BOUND_COUNT]) {
    const bool has_low = !isinf(options->low), has_high = !isinf(options->high);
    if (has_low) inside[BOUND_LOW] = inside_range_of(type, options->low);
    if (has_high) inside[BOUND_HIGH] = inside_range_of(type, options->high);
    exists[BOUND_LOW] = has_low && !inside[BOUND_LOW].uniform;
    exists[BOUND_HIGH] = has_high && !inside[BOUND_HIGH].uniform;
    return !(has_low && inside[BOUND_LOW].uniform && !inside[BOUND_LOW].inside) &&
           !(has_high && inside[BOUND_HIGH].uniform && inside[BOUND_HIGH].inside);
}

uint64_t interval_first(const interval_size *size, int block) {
    uint64_t first = 0;
    for (int n = 0; n < block; n++) first += size->vertices[n];
    return first;
}

uint64_t interval_bytes(const interval_size *size) {
    return 3 * sizeof(float) * interval_first(size, BLOCK_COUNT) + TETRAHEDRON_BYTES * size->tetrahedra;
}

tc_interval_volume *interval_create(spare_blocks *spare) {
    tc_interval_volume *interval = calloc(1, sizeof *interval);
    if (!interval) {
        fail(TC_ERROR_MEMORY, "no memory for an interval volume");
        return NULL;
    }
    interval->spare = spare_blocks_join(spare);
    interval_clear(interval);
    return interval;
}

tc_status interval_allocate(tc_interval_volume *interval, const interval_size *size) {
    const uint64_t vertices = interval_first(size, BLOCK_COUNT);
    if (vertices > UINT32_MAX)
        return (tc_status)fail(
            TC_ERROR_LIMIT,
            "the interval volume has %llu vertices, and indices of 32 bits reach %lu: take a narrower "
            "interval, or parts of the grid",
            (unsigned long long)vertices, (unsigned long)UINT32_MAX);
    const uint64_t held = interval->positions.bytes + interval->tetrahedra.bytes + spare_blocks_bytes(interval->spare);
    const uint64_t available = host_memory_available();
    if (interval_bytes(size) > held && interval_bytes(size) - held > available)
        return (tc_status)fail(
            TC_ERROR_MEMORY,
            "the interval volume takes %llu bytes, and %llu are available: take a narrower interval, or "
            "parts of the grid",
            (unsigned long long)interval_bytes(size), (unsigned long long)(available + held));
    const uint64_t pages = (uint64_t)BLOCK_COUNT * PAGE_BYTES; /* each block may begin with a page of its own */
    tc_status status = spare_block_take(interval->spare, &interval->positions, vertices * 3 * sizeof(float) + pages);
    if (!status)
        status = spare_block_take(interval->spare, &interval->tetrahedra, size->tetrahedra * TETRAHEDRON_BYTES);
    if (!status) interval->size = *size;
    return status;
}

void interval_clear(tc_interval_volume *interval) {
    interval->size = (interval_size){0};
    memset(interval->origin, 0, sizeof interval->origin);
    interval->slab_count = 1;
    interval->timings = (tc_timings){0};
}

tc_status tc_interval_volume_get(const tc_interval_volume *interval, tc_interval_volume_data *data) {
    tc_status status = struct_clear(data, sizeof *data, "tc_interval_volume_get: data");
    if (status) return status;
    if (!interval) return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_interval_volume_get needs an interval volume");
    const interval_size *size = &interval->size;
    const uint64_t vertices = interval_first(size, BLOCK_COUNT);
    const tc_interval_volume_data found = {.struct_size = sizeof found,
                                           .vertex_count = vertices,
                                           .sample_count = size->vertices[BLOCK_SAMPLES],
                                           .low_count = size->vertices[BLOCK_LOW],
                                           .high_count = size->vertices[BLOCK_HIGH],
                                           .tetrahedron_count = size->tetrahedra,
                                           .positions = vertices ? interval->positions.memory : NULL,
                                           .tetrahedra = size->tetrahedra ? interval->tetrahedra.memory : NULL,
                                           .slab_count = interval->slab_count,
                                           .timings = interval->timings,
                                           .origin = {interval->origin[0], interval->origin[1], interval->origin[2]}};
    struct_copy_out(data, &found);
    return TC_OK;
}

void tc_interval_volume_destroy(tc_interval_volume *interval) {
    if (!interval) return;
    spare_block_give(interval->spare, &interval->positions);
    spare_block_give(interval->spare, &interval->tetrahedra);
    spare_blocks_leave(interval->spare);
    free(interval);
}
