/*
 * The public calls that make grids.
 */
#include "opencl/context.h"
#include "failure.h"
#include "base/float_environment.h"
#include "surface/grids.h"
#include "base/structs.h"

void tc_tetrahedra_grid_options_init(tc_tetrahedra_grid_options *options) {
    if (!options) return;
    *options = (tc_tetrahedra_grid_options){.struct_size = sizeof *options};
}

tc_status tc_grid_create(tc_context *context, const tc_grid_options *options, tc_grid **out) {
    FLOAT_ENVIRONMENT_DEFAULT;
    tc_grid_options o;
    if (out) *out = NULL;
    if (!out || !context)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_grid_create needs a context and a place for the grid");
    tc_grid_options_init(&o);
    tc_status status = struct_copy_in(&o, sizeof o, options, "grid options");
    if (!status) status = context_check(context);
    return status ? status : grid_create(context, &o, context->launch.scan, out);
}

tc_status tc_tetrahedra_grid_create(tc_context *context, const tc_tetrahedra_grid_options *options, tc_grid **out) {
    FLOAT_ENVIRONMENT_DEFAULT;
    tc_tetrahedra_grid_options o;
    if (out) *out = NULL;
    if (!out || !context)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_tetrahedra_grid_create needs a context and a place for the grid");
    tc_tetrahedra_grid_options_init(&o);
    tc_status status = struct_copy_in(&o, sizeof o, options, "options of a grid of tetrahedra");
    if (!status) status = context_check(context);
    return status ? status : complex_create(context, &o, context->launch.scan, out);
}

void tc_grid_destroy(tc_grid *grid) {
    FLOAT_ENVIRONMENT_DEFAULT;
    grid_destroy(grid);
}
