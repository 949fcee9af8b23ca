/*
 * Steps of a slab: runs of bricks whose vertices and tetrahedra fit the memory that is left. Where the device works in
 * the host's memory they are made where they stay, else they are read back from windows.
 */
#include "failure.h"
#include "structured/structured_interval.h"

#include <stdlib.h>
#include <string.h>

enum { PARTS = BLOCK_COUNT + 1 }; /* vertices in their blocks, tetrahedra */

static const char *const part_names[PARTS] = {"samples within", "low crossings", "high crossings", "tetrahedra"};
static const uint64_t item_bytes[PARTS] = {12, 12, 12, TETRAHEDRON_BYTES};

/* Of each part, what comes before a brick in the slab. */
typedef struct brick_sums {
    uint64_t at[PARTS];
} brick_sums;

/* Vertices of a bound before each brick. Kernel 1 tells it of bricks that emit something, and of the first in a
 * layer. */
static void bound_sums(const interval_run *r, int bound, brick_sums *sums) {
    uint64_t next = r->size.vertices[BLOCK_LOW + bound];
    for (uint32_t n = r->job.own_bricks; n-- > 0;) {
        if (r->exists[bound] && r->states[bound][n].rows) next = r->states[bound][n].vertices;
        sums[n].at[BLOCK_LOW + bound] = next;
    }
}

static brick_sums *sums_make(const interval_run *r) {
    const uint32_t bricks = r->job.own_bricks;
    brick_sums *sums = malloc((bricks + (size_t)1) * sizeof *sums);
    if (!sums) return NULL;
    for (uint32_t n = 0; n < bricks; n++) sums[n] = (brick_sums){{r->bricks[n].samples, 0, 0, r->bricks[n].tetrahedra}};
    sums[bricks] = (brick_sums){{r->size.vertices[0], r->size.vertices[1], r->size.vertices[2], r->size.tetrahedra}};
    for (int bound = 0; bound < BOUND_COUNT; bound++) bound_sums(r, bound, sums);
    return sums;
}

/* Whether bricks first to end - 1 can be emitted at once; *all: what they take. */
static bool step_fits(const interval_run *r, const brick_sums *first, const brick_sums *end, uint64_t *all) {
    uint64_t bytes = 0;
    *all = 0;
    for (int n = 0; n < PARTS; n++) {
        const uint64_t one = (end->at[n] - first->at[n]) * item_bytes[n] + 2ull * 4096;
        if (one > r->context->info.max_buffer_bytes) return false;
        bytes += one;
    }
    *all = bytes;
    return bytes <= r->plan.mesh_bytes;
}

/* Where a step from brick `first` on ends: at most all bricks, at least one, which may not fit. */
static uint32_t step_end(const interval_run *r, const brick_sums *sums, uint32_t first) {
    uint32_t low = first + 1, high = r->job.own_bricks;
    uint64_t bytes;
    while (low < high) {
        const uint32_t middle = high - (high - low) / 2;
        if (step_fits(r, &sums[first], &sums[middle], &bytes))
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

/* The number of the slab's first vertex in a block. */
static uint64_t block_first(const interval_run *r, const tc_interval_volume *interval, int block) {
    return interval_first(&interval->size, block) + r->before.vertices[block];
}

/* Where a part lies in its block of memory while it is made, in bytes. On a device that works in the host's memory no
 * page is in two buffers, which would be undefined, so each block of vertices then begins with a page of its own. */
static uint64_t part_start(const interval_run *r, const tc_interval_volume *interval, int part) {
    uint64_t start = 0;
    if (part == BLOCK_COUNT) return 0;
    if (!r->context->in_place) return interval_first(&interval->size, part) * item_bytes[part];
    for (int n = 0; n < part; n++)
        start += (interval->size.vertices[n] * item_bytes[n] + PAGE_BYTES - 1) & ~(uint64_t)(PAGE_BYTES - 1);
    return start;
}

/* Of the slab's item n. */
static uint64_t part_byte(const interval_run *r, const tc_interval_volume *interval, int part, uint64_t n) {
    const uint64_t before = part == BLOCK_COUNT ? r->before.tetrahedra : r->before.vertices[part];
    return part_start(r, interval, part) + (before + n) * item_bytes[part];
}

void interval_blocks_join(const interval_run *r, tc_interval_volume *interval) {
    for (int n = BLOCK_LOW; n < BLOCK_COUNT && r->context->in_place; n++)
        memmove((char *)interval->positions.memory + interval_first(&interval->size, n) * item_bytes[n],
                (char *)interval->positions.memory + part_start(r, interval, n),
                (size_t)(interval->size.vertices[n] * item_bytes[n]));
}

static const host_block *part_block(const tc_interval_volume *interval, int part) {
    return part == BLOCK_COUNT ? &interval->tetrahedra : &interval->positions;
}

static tc_status step_open(interval_run *r, const tc_interval_volume *interval, const brick_sums *first,
                           const brick_sums *end) {
    interval_job *job = &r->job;
    tc_status status = TC_OK;
    for (int n = 0; n < PARTS && !status; n++) {
        uint32_t offset = 0;
        status = mesh_part_open(r->context, &r->buffers->parts[n], part_block(interval, n),
                                part_byte(r, interval, n, first->at[n]), part_byte(r, interval, n, end->at[n]), &offset,
                                part_names[n]);
        if (n == BLOCK_COUNT) {
            job->tetrahedron_window = (uint32_t)first->at[n], job->tetrahedron_offset = offset;
            continue;
        }
        job->first[n] = (uint32_t)block_first(r, interval, n);
        job->window[n] = job->first[n] + (uint32_t)first->at[n];
        job->offset[n] = offset;
    }
    return status;
}

static tc_status step_launch(interval_run *r) {
    interval_buffers *b = r->buffers;
    const word_buffers *low = interval_words(r, BOUND_LOW), *high = interval_words(r, BOUND_HIGH);
    const device_buffer *arrays = r->plan.samples_whole ? r->grid->device->arrays : b->arrays;
    const device_buffer *coordinates =
        r->grid->kind == GRID_RECTILINEAR ? &r->grid->device->axes : &arrays[ARRAY_POINTS];
    const cl_uint zero = 0;
    cl_int error =
        cl->EnqueueFillBuffer(r->context->queue, b->ticket.memory, &zero, sizeof zero, 0, sizeof zero, 0, NULL, NULL);
    if (error) return context_fail(r->context, "clearing a ticket", error);
    const kernel_argument arguments[] = {ARGUMENT(r->window),
                                         ARGUMENT(r->job),
                                         ARGUMENT(arrays[ARRAY_SAMPLES].memory),
                                         ARGUMENT(b->cells.memory),
                                         ARGUMENT(low->words.memory),
                                         ARGUMENT(low->offsets.memory),
                                         ARGUMENT(low->bricks.memory),
                                         ARGUMENT(high->words.memory),
                                         ARGUMENT(high->offsets.memory),
                                         ARGUMENT(high->bricks.memory),
                                         ARGUMENT(b->rows.memory),
                                         ARGUMENT(b->bricks.memory),
                                         ARGUMENT(b->ticket.memory),
                                         ARGUMENT(b->cases.memory),
                                         ARGUMENT(coordinates->memory),
                                         ARGUMENT(b->parts[0].memory),
                                         ARGUMENT(b->parts[1].memory),
                                         ARGUMENT(b->parts[2].memory),
                                         ARGUMENT(b->parts[3].memory)};
    return kernel_launch(r->context, r->kernels.interval_emit, "kernel interval_emit", arguments,
                         sizeof arguments / sizeof *arguments);
}

/* What the step has made is in the host's memory, when it returns. */
static tc_status step_close(interval_run *r, tc_interval_volume *interval, const brick_sums *first,
                            const brick_sums *end) {
    cl_int error = cl->Finish(r->context->queue);
    const double begin = clock_ms();
    tc_status status = error ? context_fail(r->context, "kernel interval_emit", error) : TC_OK;
    for (int n = 0; n < PARTS && !status; n++) {
        status = mesh_part_close(r->context, &r->buffers->parts[n], part_block(interval, n),
                                 part_byte(r, interval, n, first->at[n]), part_byte(r, interval, n, end->at[n]));
    }
    if (!r->context->in_place) interval->timings.readback_ms += clock_ms() - begin;
    return status;
}

tc_status interval_slab_emit(interval_run *r, tc_interval_volume *interval) {
    brick_sums *sums = sums_make(r);
    tc_status status = sums ? TC_OK : (tc_status)fail(TC_ERROR_MEMORY, "no memory for the sums of bricks");
    for (uint32_t first = 0, end; first < r->job.own_bricks && !status; first = end) {
        uint64_t bytes;
        end = step_end(r, sums, first);
        if (end == first + 1 && !step_fits(r, &sums[first], &sums[end], &bytes)) {
            status = interval_brick_refuse(r, bytes);
            break;
        }
        r->job.brick_first = first, r->job.brick_last = end;
        status = step_open(r, interval, &sums[first], &sums[end]);
        if (!status) status = step_launch(r);
        if (!status) status = step_close(r, interval, &sums[first], &sums[end]);
    }
    free(sums);
    return status;
}
