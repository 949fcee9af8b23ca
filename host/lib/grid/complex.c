#include "grid/complex.h"

#include "failure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static tc_status options_check(const tc_tetrahedra_grid_options *o) {
    if (tc_type_bytes(o->type) == 0) return (tc_status)fail(TC_ERROR_ARGUMENT, "%d is no sample type", (int)o->type);
    if (o->point_count > UINT32_MAX || o->tetrahedron_count > UINT32_MAX)
        return (tc_status)fail(
            TC_ERROR_LIMIT, "%llu points and %llu tetrahedra: a grid may have %lu of each; cut it into parts",
            (unsigned long long)o->point_count, (unsigned long long)o->tetrahedron_count, (unsigned long)UINT32_MAX);
    if (o->points && o->points_f64)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the grid of tetrahedra has points and points_f64; give one of them");
    if (o->point_count && ((!o->points && !o->points_f64) || !o->samples))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the grid of tetrahedra has no points, or no samples at them");
    if (o->tetrahedron_count && !o->tetrahedra)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the grid of tetrahedra has no tetrahedra");
    if (o->tetrahedron_count && !o->point_count)
        return (tc_status)fail(TC_ERROR_DATA, "the grid of tetrahedra has tetrahedra and no points");
    if ((uintptr_t)o->points % sizeof(float) || (uintptr_t)o->points_f64 % sizeof(double) ||
        (uintptr_t)o->tetrahedra % sizeof(uint32_t))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "points or tetrahedra are not aligned to their type");
    if ((uintptr_t)o->samples % tc_type_bytes(o->type))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the samples are not aligned to their type, %s",
                               tc_type_name(o->type));
    return origin_check(o->has_origin, o->origin);
}

static int tetrahedron_corners(const void *source, uint64_t tetrahedron, double corners[][3]) {
    const tc_tetrahedra_grid_options *o = source;
    const coordinate_array points = {o->points, o->points_f64};
    const uint32_t *v = o->tetrahedra + 4 * tetrahedron;
    for (int n = 0; n < 4; n++) {
        if (v[n] >= o->point_count) return 0; /* found when the tetrahedra are first read */
        if (!isfinite(value_at(o->type, o->samples, v[n]))) return 0;
        for (unsigned axis = 0; axis < 3; axis++) corners[n][axis] = coordinate_get(points, 3 * (uint64_t)v[n] + axis);
    }
    return 4;
}

/* Makes points relative to the origin. Uses the caller's array where that is so already. */
static tc_status points_take(tc_grid *grid, const tc_tetrahedra_grid_options *o) {
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

tc_status complex_describe(const tc_tetrahedra_grid_options *o, tc_grid *grid) {
    tc_status status = options_check(o);
    if (status) return status;
    complex_grid *c = calloc(1, sizeof *c);
    if (!c) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for a grid of tetrahedra");
    grid->complex = c;
    grid->type = o->type;
    grid->samples = o->samples;
    grid->dims[0] = (int64_t)o->point_count;
    grid->dims[1] = grid->dims[2] = 1;
    c->point_count = (uint32_t)o->point_count;
    c->tetrahedron_count = (uint32_t)o->tetrahedron_count;
    c->tetrahedra = o->tetrahedra;
    status = complex_cells_take(o, c);
    return status ? status : points_take(grid, o);
}

void complex_release(tc_grid *grid) {
    complex_grid *c = grid->complex;
    if (!c) return;
    free(c->own_points);
    free(c->used_points);
    free(c);
}

bool complex_has_gaps(const tc_grid *grid) {
    uint32_t gaps = 0;
    for (uint32_t n = 0; n < grid->complex->point_count && type_is_real(grid->type); n++)
        gaps |= complex_point_missing(grid, n);
    return gaps;
}

tc_status complex_point_fail(const complex_grid *c) {
    for (uint64_t n = 0; n < 4ull * c->tetrahedron_count; n++)
        if (c->tetrahedra[n] >= c->point_count)
            return (tc_status)fail(TC_ERROR_DATA, "tetrahedron %llu has point %lu, and the grid has %lu points",
                                   (unsigned long long)(n / 4), (unsigned long)c->tetrahedra[n],
                                   (unsigned long)c->point_count);
    return (tc_status)fail(TC_ERROR_DATA, "a tetrahedron has changed since the grid was made");
}

kernel_kind complex_kind(const tc_grid *grid, const tc_extract_options *options, bool emits) {
    return (kernel_kind){
        .grid = KIND_COMPLEX, .type = grid->type, .method = options->method, .emits = emits, .closed = options->closed};
}

kernel_kind complex_interval_kind(const tc_grid *grid) {
    return (kernel_kind){.grid = KIND_COMPLEX, .type = grid->type, .emits = true, .interval = true};
}
