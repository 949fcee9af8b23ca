#include "surface/surface.h"

#include "grid/complex.h"
#include "grid/inside.h"
#include "reference/reference.h"
#include "structured/structured.h"

kernel_kind surface_kind(const tc_grid *grid, const tc_extract_options *options, bool emits) {
    return grid->complex ? complex_kind(grid, options, emits) : structured_kind(grid, options, emits);
}

bool surface_needs_kernels(const tc_grid *grid, const tc_extract_options *options) {
    if (grid->context->options.engine != TC_ENGINE_OPENCL) return false;
    if (grid->complex && !grid->complex->tetrahedron_count) return false;
    if (grid->complex && !complex_has_kernels(grid, options)) return false; /* refused later */
    return inside_has_surface(inside_range_of(grid->type, options->isovalue), options->closed);
}

tc_status surface_count(tc_grid *grid, const tc_extract_options *options, double share, tc_counts *counts) {
    if (grid->complex) return complex_count(grid, options, share, counts);
    return grid->device ? structured_count(grid, options, share, counts) : reference_count(grid, options, counts);
}

tc_status surface_extract(tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh) {
    if (grid->complex) return complex_extract(grid, options, mesh);
    return grid->device ? structured_extract(grid, options, mesh) : reference_extract(grid, options, mesh);
}

bool surface_is_classified(const tc_grid *grid, const tc_extract_options *options) {
    if (!surface_needs_kernels(grid, options)) return true;
    return grid->complex ? complex_is_classified(grid, options) : structured_is_classified(grid, options);
}

void surface_keep_results(tc_grid *grid) {
    if (grid->complex) grid->complex->carries = true;
    if (grid->device) structured_keep_results(grid);
}

tc_status surface_carry(tc_grid *grid, const tc_extract_options *options, const carry *c, uint64_t *vertex_count) {
    if (grid->complex) return complex_carry(grid, options, c, vertex_count);
    return grid->device ? structured_carry(grid, options, c, vertex_count)
                        : reference_carry(grid, options, c, vertex_count);
}
