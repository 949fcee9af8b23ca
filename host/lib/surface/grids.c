#include "surface/grids.h"

#include "grid/complex.h"
#include "opencl/context.h"
#include "failure.h"
#include "structured/structured.h"

#include <stdlib.h>

static tc_grid *grid_allocate(tc_context *context, scan_parameters scan) {
    tc_grid *grid = calloc(1, sizeof *grid);
    if (!grid) {
        fail(TC_ERROR_MEMORY, "no memory for a grid");
        return NULL;
    }
    grid->context = context;
    grid->scan = scan;
    return grid;
}

/* The grid, where it has been made. */
static tc_status grid_give(tc_grid *grid, tc_status status, tc_grid **out) {
    if (!status)
        *out = grid;
    else
        grid_destroy(grid);
    return status;
}

tc_status grid_create(tc_context *context, const tc_grid_options *o, scan_parameters scan, tc_grid **out) {
    const bool has_device = context->options.engine == TC_ENGINE_OPENCL;
    *out = NULL;
    tc_grid *grid = grid_allocate(context, scan);
    if (!grid) return TC_ERROR_MEMORY;
    tc_status status = grid_describe(o, grid);
    if (!status && o->cl_samples && !has_device)
        status = (tc_status)fail(TC_ERROR_ARGUMENT, "the reference engine takes samples, not cl_samples");
    if (!status && has_device) status = structured_grid_create(grid);
    return grid_give(grid, status, out);
}

tc_status complex_create(tc_context *context, const tc_tetrahedra_grid_options *o, scan_parameters scan,
                         tc_grid **out) {
    *out = NULL;
    tc_grid *grid = grid_allocate(context, scan);
    if (!grid) return TC_ERROR_MEMORY;
    tc_status status = complex_describe(o, grid);
    if (!status && context->options.engine == TC_ENGINE_OPENCL && o->tetrahedron_count && o->point_count)
        status = complex_device_create(grid);
    return grid_give(grid, status, out);
}

void grid_destroy(tc_grid *grid) {
    if (!grid) return;
    if (grid->complex) complex_device_destroy(grid);
    complex_release(grid);
    structured_grid_destroy(grid);
    grid_release(grid);
    free(grid);
}
