#include "complexes.h"

#include "exit_status.h"
#include "failure.h"
#include "library_status.h"
#include "measure.h"

#include <sys/mman.h>

/* The cubes of a grid as hexahedra in VTK's order of corners. */
static void hexahedra_list(const int64_t dims[3], uint8_t *types, int64_t *offsets, int64_t *connectivity) {
    static const int corners[8] = {0, 1, 3, 2, 4, 5, 7, 6}; /* bit n: a step along axis n */
    int64_t count = 0;
    for (int64_t z = 0; z + 1 < dims[2]; z++)
        for (int64_t y = 0; y + 1 < dims[1]; y++)
            for (int64_t x = 0; x + 1 < dims[0]; x++, count++) {
                types[count] = 12;
                offsets[count] = 8 * count;
                for (int c = 0; c < 8; c++)
                    *connectivity++ = ((z + (corners[c] >> 2)) * dims[1] + y + (corners[c] >> 1 & 1)) * dims[0] + x +
                                      (corners[c] & 1);
            }
    offsets[count] = 8 * count;
}

static int hexahedra_cut(samples *s) {
    const int64_t *dims = s->grid.dims;
    const uint64_t count = (uint64_t)((dims[0] - 1) * (dims[1] - 1) * (dims[2] - 1));
    void *types = NULL, *offsets = NULL, *connectivity = NULL;
    s->cells = (tc_cells){.struct_size = sizeof s->cells, .point_count = (uint64_t)(dims[0] * dims[1] * dims[2])};
    s->cells.points = s->coordinates, s->cells.cell_count = count;
    int status = memory_make(count, "hexahedra", &types);
    s->cells.types = types;
    if (!status) status = memory_make(8 * (count + 1), "hexahedra", &offsets);
    s->cells.offsets = offsets;
    if (!status) status = memory_make(64 * count, "hexahedra", &connectivity);
    s->cells.connectivity = connectivity;
    if (status) return status;
    hexahedra_list(dims, types, offsets, connectivity);
    return library_status(tc_tetrahedralize(&s->cells, &s->complex));
}

static void memory_release(const void *memory, uint64_t bytes) {
    if (memory) munmap((void *)(uintptr_t)memory, bytes);
}

void complex_release(samples *s) {
    tc_tetrahedra_release(&s->complex);
    memory_release(s->cells.types, s->cells.cell_count);
    memory_release(s->cells.offsets, 8 * (s->cells.cell_count + 1));
    memory_release(s->cells.connectivity, 64 * s->cells.cell_count);
}

int complex_make(samples *s) {
    s->complex = (tc_tetrahedra){.struct_size = sizeof s->complex};
    int status =
        s->placed == BENCH_HEXAHEDRA ? hexahedra_cut(s) : library_status(tc_tetrahedralize_grid(&s->grid, &s->complex));
    if (!status && !s->complex.tetrahedron_count) status = fail(STATUS_INPUT, "the grid has no tetrahedra");
    return status;
}

tc_status samples_open(const samples *s, tc_context *context, tc_grid **grid) {
    tc_tetrahedra_grid_options o;
    if (!s->complex.tetrahedra) return tc_grid_create(context, &s->grid, grid);
    tc_tetrahedra_grid_options_init(&o);
    o.point_count = (uint64_t)(s->grid.dims[0] * s->grid.dims[1] * s->grid.dims[2]);
    o.points = s->coordinates;
    o.type = s->grid.type;
    o.samples = s->grid.samples;
    o.tetrahedron_count = s->complex.tetrahedron_count;
    o.tetrahedra = s->complex.tetrahedra;
    if (s->keeps_cells) o.source = &s->cells, o.cells = s->complex.cells;
    return tc_tetrahedra_grid_create(context, &o, grid);
}
