#include "complexes.h"

#include "exit_status.h"
#include "failure.h"
#include "library_status.h"
#include "measure.h"

#include <stdlib.h>
#include <string.h>

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
    uint8_t *types = malloc(count);
    int64_t *offsets = malloc(8 * (count + 1)), *connectivity = malloc(64 * count);
    int status = types && offsets && connectivity ? 0 : fail(STATUS_FAILED, "no memory for the hexahedra");
    if (!status) {
        hexahedra_list(dims, types, offsets, connectivity);
        tc_cells cells = {.struct_size = sizeof cells,
                          .point_count = (uint64_t)(dims[0] * dims[1] * dims[2]),
                          .points = s->coordinates,
                          .cell_count = count,
                          .types = types,
                          .offsets = offsets,
                          .connectivity = connectivity};
        status = library_status(tc_tetrahedralize(&cells, &s->complex));
    }
    free(types);
    free(offsets);
    free(connectivity);
    return status;
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
    return tc_tetrahedra_grid_create(context, &o, grid);
}
