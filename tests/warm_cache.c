/*
 * warm_cache.c - builds the kernels once, so that tests find them in the cache of the OpenCL implementation
 *
 * Every type, with and without missing samples and normals, for the default work-group size; some for others.
 */
#include "engines.h"
#include "samples.h"

#include <stdlib.h>

static void variants_build(uint32_t work_items, tc_type type) {
    static double memory[27]; /* aligned for every type */
    tc_context_options options;
    tc_mesh *mesh = NULL;
    tc_mesh_data data;
    tc_context_options_init(&options);
    options.work_items = work_items;
    tc_context *context = context_open(&options);
    for (int variant = 0; variant < 4; variant++) {
        tc_grid_options grid;
        tc_extract_options how;
        tc_grid_options_init(&grid);
        tc_extract_options_init(&how);
        for (int axis = 0; axis < 3; axis++) grid.dims[axis] = 3;
        grid.type = type;
        grid.samples = memory;
        grid.has_nodata = variant & 1;
        grid.nodata = 100;
        how.isovalue = 1;
        how.normals = variant >> 1;
        for (int n = 0; n < 27; n++) sample_set(memory, type, n, n == 13 ? 2 : 0);
        extract(context, &grid, &how, &mesh, &data);
    }
    tc_mesh_destroy(mesh);
    tc_context_destroy(context);
}

int main(void) {
    static const tc_type some[] = {TC_U8, TC_I16, TC_F32, TC_F64};
    static const uint32_t sizes[] = {32, 64, 256};
    if (!device_exists()) return SKIPPED;
    for (tc_type type = TC_U8; type <= TC_F64; type++) variants_build(0, type);
    for (size_t n = 0; n < sizeof some / sizeof *some; n++)
        for (size_t m = 0; m < sizeof sizes / sizeof *sizes; m++) variants_build(sizes[m], some[n]);
    return EXPECT_DONE();
}
