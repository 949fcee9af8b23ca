#include "complex.h"

#include "failure.h"
#include "float_environment.h"
#include "structs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    if (o->points && o->points_f64)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the complex has points and points_f64; give one of them");
    if (o->point_count && ((!o->points && !o->points_f64) || !o->samples))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the complex has no points, or no samples at them");
    if (o->tetrahedron_count && !o->tetrahedra)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the complex has no tetrahedra");
    if (o->tetrahedron_count && !o->point_count)
        return (tc_status)fail(TC_ERROR_DATA, "the complex has tetrahedra and no points");
    if ((uintptr_t)o->points % sizeof(float) || (uintptr_t)o->points_f64 % sizeof(double) ||
        (uintptr_t)o->tetrahedra % sizeof(uint32_t))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "points or tetrahedra are not aligned to their type");
    if ((uintptr_t)o->samples % tc_type_bytes(o->type))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the samples are not aligned to their type, %s",
                               tc_type_name(o->type));
    return origin_check(o->has_origin, o->origin);
}

static int tetrahedron_corners(const void *source, uint64_t tetrahedron, double corners[][3]) {
    const tc_complex_options *o = source;
    const coordinate_array points = {o->points, o->points_f64};
    const uint32_t *v = o->tetrahedra + 4 * tetrahedron;
    for (int n = 0; n < 4; n++) {
        if (v[n] >= o->point_count) return 0; /* found when the tetrahedra are first read */
        if (!isfinite(value_at(o->type, o->samples, v[n]))) return 0;
        for (unsigned axis = 0; axis < 3; axis++) corners[n][axis] = coordinate_get(points, 3 * (uint64_t)v[n] + axis);
    }
    return 4;
}

/* Points relative to the origin: the caller's own where they are that already. */
static tc_status points_take(tc_grid *grid, const tc_complex_options *o) {
    complex_grid *c = grid->complex;
    double *origin = grid->origin;
    if (o->has_origin)
        memcpy(origin, o->origin, sizeof o->origin);
    else
        origin_find(tetrahedron_corners, o, o->tetrahedron_count, origin);
    c->points = o->points;
    if (!o->points_f64 && origin[0] == 0 && origin[1] == 0 && origin[2] == 0) return TC_OK;
    c->points = c->own_points = malloc(3 * sizeof *c->own_points * (size_t)o->point_count + 1);
    if (!c->own_points)
        return (tc_status)fail(TC_ERROR_MEMORY, "no memory for %llu points in float32",
                               (unsigned long long)o->point_count);
    coordinates_move((coordinate_array){o->points, o->points_f64}, o->point_count, 3, origin, c->own_points);
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
    c->tetrahedra = o->tetrahedra;
    return points_take(grid, o);
}

tc_status complex_create(tc_context *context, const tc_complex_options *o, scan_parameters scan, tc_grid **out) {
    *out = NULL;
    tc_status status = options_check(o);
    if (status) return status;
    tc_grid *grid = calloc(1, sizeof *grid);
    if (!grid) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for a grid");
    grid->context = context;
    grid->scan = scan;
    status = complex_describe(grid, o);
    if (!status && context->options.engine == TC_ENGINE_OPENCL && o->tetrahedron_count && o->point_count)
        status = complex_device_create(grid);
    if (!status)
        *out = grid;
    else
        tc_grid_destroy(grid);
    return status;
}

tc_status tc_complex_create(tc_context *context, const tc_complex_options *options, tc_grid **out) {
    FLOAT_ENVIRONMENT_DEFAULT;
    tc_complex_options o;
    if (out) *out = NULL;
    if (!out || !context)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_complex_create needs a context and a place for the grid");
    tc_complex_options_init(&o);
    tc_status status = options_take(&o, sizeof o, options, "complex options");
    if (!status) status = context_check(context);
    return status ? status : complex_create(context, &o, context->launch.scan, out);
}

void complex_grid_destroy(tc_grid *grid) {
    complex_grid *c = grid->complex;
    if (!c) return;
    complex_device_destroy(grid);
    free(c->own_points);
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

kernel_kind complex_kind(const tc_grid *grid, bool emits) {
    return (kernel_kind){.grid = KIND_COMPLEX, .type = grid->type, .emits = emits};
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
