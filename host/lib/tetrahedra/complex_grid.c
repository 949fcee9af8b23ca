/*
 * An isovalue's surface of a complex, by the engine of its context.
 */
#include "grid/complex.h"

#include "failure.h"

/* TC_ERROR_ARGUMENT for what complexes cannot do. */
static tc_status complex_request_check(const tc_grid *grid, const tc_extract_options *options) {
    if (channels_asked(options) != POSITIONS_ALONE)
        return (tc_status)fail(TC_ERROR_ARGUMENT,
                               "normals are made on structured grids only, not on grids of tetrahedra");
    if (options->method == TC_METHOD_TETRA) return TC_OK;
    if (options->method != TC_METHOD_HYBRID)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "method %s is for structured grids only, not for grids of tetrahedra",
                               tc_method_name(options->method));
    if (!grid->complex->has_cells)
        return (tc_status)fail(TC_ERROR_ARGUMENT,
                               "the grid of tetrahedra was made without cells, which method hybrid keeps whole: give "
                               "source and cells, or use TC_METHOD_TETRA");
    return TC_OK;
}

bool complex_has_kernels(const tc_grid *grid, const tc_extract_options *options) {
    return options->method == TC_METHOD_TETRA || (options->method == TC_METHOD_HYBRID && grid->complex->has_cells);
}

static bool surface_possible(const tc_grid *grid, const tc_extract_options *options) {
    return grid->complex->tetrahedron_count &&
           inside_has_surface(inside_range_of(grid->type, options->isovalue), options->closed);
}

/* Ends a call on the device. After a failure the state of the workspace is undefined. */
static tc_status device_end(tc_context *context, tc_status status) {
    if (!status) return TC_OK;
    cl->Finish(context->queue);
    workspace_release(context);
    return status;
}

tc_status complex_count(tc_grid *grid, const tc_extract_options *options, double share, tc_counts *counts) {
    tc_status status = complex_request_check(grid, options);
    if (status || !surface_possible(grid, options)) return status;
    if (grid->context->options.engine == TC_ENGINE_REFERENCE) return reference_complex_count(grid, options, counts);
    return device_end(grid->context, complex_device_count(grid, options, share, counts));
}

tc_status complex_extract(tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh) {
    tc_status status = complex_request_check(grid, options);
    if (status || !surface_possible(grid, options)) return status;
    if (grid->context->options.engine == TC_ENGINE_REFERENCE) return reference_complex_extract(grid, options, mesh);
    return device_end(grid->context, complex_device_extract(grid, options, mesh));
}

tc_status complex_carry(tc_grid *grid, const tc_extract_options *options, const carry *c, uint64_t *vertex_count) {
    tc_status status = complex_request_check(grid, options);
    if (status || !surface_possible(grid, options)) return status;
    if (grid->context->options.engine == TC_ENGINE_REFERENCE)
        return reference_complex_carry(grid, options, c, vertex_count);
    return options->method == TC_METHOD_HYBRID ? whole_device_carry(grid, options, c, vertex_count)
                                               : complex_device_carry(grid, options, c, vertex_count);
}
