#include "complex.h"

#include "failure.h"

#include <stdlib.h>

void tc_complex_options_init(tc_complex_options *options) {
    if (!options) return;
    *options = (tc_complex_options){.struct_size = sizeof *options};
}

static tc_status options_check(const tc_complex_options *o) {
    if (tc_type_bytes(o->type) == 0) return (tc_status)fail(TC_ERROR_ARGUMENT, "%d is no sample type", (int)o->type);
    if (o->point_count > UINT32_MAX || o->tetrahedron_count > UINT32_MAX)
        return (tc_status)fail(
            TC_ERROR_LIMIT, "%llu points and %llu tetrahedra: a complex may have %lu of each; cut it into parts",
            (unsigned long long)o->point_count, (unsigned long long)o->tetrahedron_count, (unsigned long)UINT32_MAX);
    if (o->point_count && (!o->points || !o->samples))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the complex has no points, or no samples at them");
    if (o->tetrahedron_count && !o->tetrahedra)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the complex has no tetrahedra");
    if (o->tetrahedron_count && !o->point_count)
        return (tc_status)fail(TC_ERROR_DATA, "the complex has tetrahedra and no points");
    if ((uintptr_t)o->points % sizeof(float) || (uintptr_t)o->tetrahedra % sizeof(uint32_t))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "points or tetrahedra are not aligned to their type");
    if ((uintptr_t)o->samples % tc_type_bytes(o->type))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the samples are not aligned to their type, %s",
                               tc_type_name(o->type));
    return TC_OK;
}

static tc_status complex_describe(tc_grid *grid, const tc_complex_options *o) {
    complex_grid *c = calloc(1, sizeof *c);
    if (!c) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for a complex");
    grid->complex = c;
    grid->type = o->type;
    grid->samples = o->samples;
    grid->dims[0] = (int64_t)o->point_count;
    grid->dims[1] = grid->dims[2] = 1;
    c->point_count = (uint32_t)o->point_count;
    c->tetrahedron_count = (uint32_t)o->tetrahedron_count;
    c->points = o->points;
    c->tetrahedra = o->tetrahedra;
    return TC_OK;
}

tc_status tc_complex_create(tc_context *context, const tc_complex_options *options, tc_grid **out) {
    tc_complex_options o;
    if (out) *out = NULL;
    if (!out || !context)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_complex_create needs a context and a place for the grid");
    tc_complex_options_init(&o);
    tc_status status = options_take(&o, sizeof o, options, "complex options");
    if (!status) status = options_check(&o);
    if (status) return status;
    tc_grid *grid = calloc(1, sizeof *grid);
    if (!grid) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for a grid");
    grid->context = context;
    status = complex_describe(grid, &o);
    if (!status && context->options.engine == TC_ENGINE_OPENCL && o.tetrahedron_count && o.point_count)
        status = complex_device_create(grid);
    if (status) {
        tc_grid_destroy(grid);
        return status;
    }
    *out = grid;
    return TC_OK;
}

void complex_grid_destroy(tc_grid *grid) {
    complex_grid *c = grid->complex;
    if (!c) return;
    complex_device_destroy(grid);
    free(c);
}

tc_status complex_point_fail(const complex_grid *c) {
    for (uint64_t n = 0; n < 4ull * c->tetrahedron_count; n++)
        if (c->tetrahedra[n] >= c->point_count)
            return (tc_status)fail(TC_ERROR_DATA, "tetrahedron %llu has point %lu, and the complex has %lu points",
                                   (unsigned long long)(n / 4), (unsigned long)c->tetrahedra[n],
                                   (unsigned long)c->point_count);
    return (tc_status)fail(TC_ERROR_DATA, "a tetrahedron has changed since the complex was made");
}

/* TC_ERROR_ARGUMENT for what complexes cannot do. */
static tc_status complex_request_check(const tc_extract_options *options) {
    if (options->normals)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "normals are made on structured grids only, not on complexes");
    if (options->method != TC_METHOD_TETRA)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "complexes have no cubes: use TC_METHOD_TETRA");
    return TC_OK;
}

static bool surface_possible(const tc_grid *grid, double isovalue) {
    return grid->complex->tetrahedron_count && !inside_range_of(grid->type, isovalue).uniform;
}

/* What the workspace holds after a failure may not be what it is taken for. */
static tc_status device_end(tc_context *context, tc_status status) {
    if (!status) return TC_OK;
    cl->Finish(context->queue);
    workspace_release(context);
    return status;
}

tc_status complex_count(tc_grid *grid, const tc_extract_options *options, tc_counts *counts) {
    tc_status status = complex_request_check(options);
    if (status || !surface_possible(grid, options->isovalue)) return status;
    if (grid->context->options.engine == TC_ENGINE_REFERENCE)
        return reference_complex_count(grid, options->isovalue, counts);
    return device_end(grid->context, complex_device_count(grid, options->isovalue, counts));
}

tc_status complex_extract(tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh) {
    tc_status status = complex_request_check(options);
    if (status || !surface_possible(grid, options->isovalue)) return status;
    if (grid->context->options.engine == TC_ENGINE_REFERENCE)
        return reference_complex_extract(grid, options->isovalue, mesh);
    return device_end(grid->context, complex_device_extract(grid, options->isovalue, mesh));
}

tc_status complex_carry(tc_grid *grid, const tc_extract_options *options, const carry *c, uint64_t *vertex_count) {
    tc_status status = complex_request_check(options);
    if (status || !surface_possible(grid, options->isovalue)) return status;
    return reference_complex_carry(grid, options->isovalue, c, vertex_count);
}
