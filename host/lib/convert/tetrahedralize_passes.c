/*
 * The two passes of tetrahedralize.h, and the memory of a complex.
 */
#include "base/host_block.h"
#include "base/structs.h"
#include "convert/tetrahedralize.h"

#include "failure.h"
#include "parallel.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

enum { BLOCK_CELLS = 1 << 15 };

typedef struct passes {
    block_function *block;
    const void *source;
    uint64_t cell_count, block_count;
    uint64_t next, bad_block; /* shared by the threads */
    cell_tally *tallies;      /* per block */
    uint64_t *starts;         /* of each block's tetrahedra */
    tc_tetrahedra *complex;
} passes;

static void block_run(passes *p, uint64_t n, tetrahedron_writer *writer) {
    uint64_t first = n * BLOCK_CELLS, end = first + BLOCK_CELLS;
    p->tallies[n] = (cell_tally){0};
    writer->tally = &p->tallies[n];
    if (p->block(p->source, first, end < p->cell_count ? end : p->cell_count, writer)) return;
    uint64_t bad = __atomic_load_n(&p->bad_block, __ATOMIC_RELAXED);
    while (n < bad && !__atomic_compare_exchange_n(&p->bad_block, &bad, n, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
    }
}

static void blocks_count(void *shared) {
    passes *p = shared;
    uint64_t n;
    while ((n = __atomic_fetch_add(&p->next, 1, __ATOMIC_RELAXED)) < p->block_count) {
        tetrahedron_writer writer = {0};
        block_run(p, n, &writer);
    }
}

static void blocks_write(void *shared) {
    passes *p = shared;
    uint64_t n;
    while ((n = __atomic_fetch_add(&p->next, 1, __ATOMIC_RELAXED)) < p->block_count) {
        uint32_t *tetrahedra = (uint32_t *)(uintptr_t)p->complex->tetrahedra + 4 * p->starts[n];
        uint32_t *cells = (uint32_t *)(uintptr_t)p->complex->cells + p->starts[n];
        tetrahedron_writer writer = {.tetrahedra = (uint32_t(*)[4])tetrahedra, .cells = cells};
        block_run(p, n, &writer);
    }
}

/* Allocates memory to be freed by free(), in huge pages where it is large. */
static void *pages_allocate(uint64_t bytes) {
    if (bytes < HUGE_PAGE_BYTES) return malloc(bytes ? (size_t)bytes : 1);
    uint64_t rounded = (bytes + HUGE_PAGE_BYTES - 1) & ~(uint64_t)(HUGE_PAGE_BYTES - 1);
    void *memory = aligned_alloc(HUGE_PAGE_BYTES, (size_t)rounded);
    if (memory) madvise(memory, (size_t)rounded, MADV_HUGEPAGE);
    return memory;
}

static tc_status complex_allocate(passes *p) {
    uint64_t count = 0;
    for (uint64_t n = 0; n < p->block_count; n++) {
        p->starts[n] = count;
        count += p->tallies[n].tetrahedra;
    }
    if (count > UINT32_MAX)
        return (tc_status)fail(TC_ERROR_LIMIT, "the cells make %llu tetrahedra, and numbers of 32 bits reach %lu",
                               (unsigned long long)count, (unsigned long)UINT32_MAX);
    p->complex->tetrahedron_count = count;
    p->complex->tetrahedra = pages_allocate(16 * count);
    p->complex->cells = pages_allocate(4 * count);
    if (p->complex->tetrahedra && p->complex->cells) return TC_OK;
    return (tc_status)fail(TC_ERROR_MEMORY, "the host has no memory for %llu tetrahedra", (unsigned long long)count);
}

static void tallies_add(passes *p) {
    for (uint64_t n = 0; n < p->block_count; n++) {
        const cell_tally *t = &p->tallies[n];
        p->complex->flat_cell_count += t->flat;
        p->complex->curved_cell_count += t->curved;
        p->complex->blanked_cell_count += t->blanked;
        p->complex->inverted_cell_count += t->inverted;
        p->complex->folded_cell_count += t->folded;
        p->complex->unsupported_cell_count += t->unsupported;
        p->complex->surplus_cell_count += t->surplus;
    }
}

tc_status complex_make(block_function *block, const void *source, uint64_t cell_count, tc_tetrahedra *complex,
                       uint64_t *bad_cell) {
    passes p = {.block = block, .source = source, .cell_count = cell_count, .complex = complex};
    p.block_count = (cell_count + BLOCK_CELLS - 1) / BLOCK_CELLS;
    p.bad_block = p.block_count;
    p.tallies = calloc((size_t)p.block_count + 1, sizeof *p.tallies);
    p.starts = calloc((size_t)p.block_count + 1, sizeof *p.starts);
    tc_status status = TC_OK;
    if (!p.tallies || !p.starts) status = (tc_status)fail(TC_ERROR_MEMORY, "no memory to count tetrahedra");
    if (!status) parallel_run(p.block_count, blocks_count, &p);
    *bad_cell = p.bad_block * BLOCK_CELLS;
    if (!status && p.bad_block < p.block_count) status = TC_ERROR_DATA;
    if (!status) status = complex_allocate(&p);
    if (!status) {
        p.next = 0;
        parallel_run(p.block_count, blocks_write, &p);
        tallies_add(&p);
        if (p.bad_block < p.block_count)
            status = (tc_status)fail(TC_ERROR_MEMORY, "the host has no memory to cut polyhedra");
    }
    if (status) tc_tetrahedra_release(complex);
    free(p.tallies);
    free(p.starts);
    return status;
}

void tetrahedra_put(tetrahedron_writer *writer, const uint32_t tetrahedra[][4], int count, uint64_t cell) {
    uint64_t first = writer->tally->tetrahedra;
    writer->tally->tetrahedra += (unsigned)count;
    if (!writer->tetrahedra) return;
    memcpy(writer->tetrahedra[first], tetrahedra, (size_t)count * sizeof *tetrahedra);
    for (int n = 0; n < count; n++) writer->cells[first + (unsigned)n] = (uint32_t)cell;
}

double tetrahedron_volume(coordinate_array points, const uint32_t tetrahedron[4]) {
    double e[3][3];
    const uint64_t first = 3 * (uint64_t)tetrahedron[0];
    for (int v = 1; v < 4; v++)
        for (unsigned axis = 0; axis < 3; axis++)
            e[v - 1][axis] =
                coordinate_get(points, 3 * (uint64_t)tetrahedron[v] + axis) - coordinate_get(points, first + axis);
    return (e[0][1] * e[1][2] - e[0][2] * e[1][1]) * e[2][0] + (e[0][2] * e[1][0] - e[0][0] * e[1][2]) * e[2][1] +
           (e[0][0] * e[1][1] - e[0][1] * e[1][0]) * e[2][2];
}

/* Whether a struct of this size is valid (struct_clear) and has room for the arrays. */
static bool size_fits(size_t bytes) {
    return bytes >= offsetof(tc_tetrahedra, flat_cell_count) && bytes <= sizeof(tc_tetrahedra) &&
           bytes % sizeof bytes == 0;
}

tc_status complex_begin(tc_tetrahedra *complex, const char *what) {
    tc_status status = struct_clear(complex, sizeof *complex, what);
    if (status || size_fits(complex->struct_size)) return status;
    return (tc_status)fail(TC_ERROR_ARGUMENT, "%s: of %llu bytes, and its arrays need more", what,
                           (unsigned long long)complex->struct_size);
}

void tc_tetrahedra_release(tc_tetrahedra *complex) {
    if (!complex || !size_fits(complex->struct_size)) return;
    free((void *)(uintptr_t)complex->tetrahedra);
    free((void *)(uintptr_t)complex->cells);
    struct_copy_out(complex, &(tc_tetrahedra){0});
}
