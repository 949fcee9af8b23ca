/*
 * The public calls that make interval volumes: arguments are checked, then an engine takes over.
 */
#include "base/float_environment.h"
#include "base/structs.h"
#include "extract.h"
#include "failure.h"
#include "grid/complex.h"
#include "grid/interval.h"
#include "opencl/context.h"
#include "opencl/vetting.h"
#include "reference/reference_interval.h"
#include "structured/structured.h"
#include "structured/structured_interval.h"
#include "trial/trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void tc_interval_volume_options_init(tc_interval_volume_options *options) {
    if (!options) return;
    *options = (tc_interval_volume_options){.struct_size = sizeof *options, .low = -INFINITY, .high = INFINITY};
}

static tc_status bounds_check(const tc_interval_volume_options *o) {
    if (isnan(o->low) || isnan(o->high) || o->low == INFINITY || o->high == -INFINITY)
        return (tc_status)fail(TC_ERROR_ARGUMENT,
                               "interval %g to %g: bounds are numbers, low may be -infinity and high "
                               "infinity",
                               o->low, o->high);
    if (isinf(o->low) && isinf(o->high))
        return (tc_status)fail(TC_ERROR_ARGUMENT,
                               "an interval without bounds is the whole grid: set low, high or both");
    if (o->low < o->high) return TC_OK;
    return (tc_status)fail(TC_ERROR_ARGUMENT, "interval %g to %g: low has to be less than high", o->low, o->high);
}

/* The caller's options, complete and checked, and the grid. */
static tc_status interval_begin(const tc_grid *grid, const tc_interval_volume_options *options,
                                tc_interval_volume_options *o, const char *call) {
    tc_interval_volume_options_init(o);
    if (!grid) return (tc_status)fail(TC_ERROR_ARGUMENT, "%s needs a grid", call);
    tc_status status = struct_copy_in(o, sizeof *o, options, "interval options");
    if (!status) status = bounds_check(o);
    if (!status) status = context_check(grid->context);
    if (status || grid->complex || (!grid->cut[0] && !grid->cut[1])) return status;
    return (tc_status)fail(TC_ERROR_ARGUMENT, "%s takes no pieces of a grid", call);
}

static bool has_kernels(const tc_grid *grid) { return grid->context->options.engine != TC_ENGINE_REFERENCE; }

static tc_status engine_check(const tc_grid *grid) {
    const tc_context *context = grid->context;
    if (!has_kernels(grid) || device_makes_vertices(context, grid->type)) return TC_OK;
    return (tc_status)fail(TC_ERROR_DEVICE,
                           "%s has no fp64: interval volumes of %s samples are made by the reference "
                           "engine",
                           context->info.name, tc_type_name(grid->type));
}

static kernel_kind interval_kind(const tc_grid *grid) {
    return grid->complex ? complex_interval_kind(grid) : structured_interval_kind(grid);
}

static tc_status kernels_run(tc_grid *grid, const tc_interval_volume_options *options, interval_size *size,
                             double *classify_ms, tc_interval_volume *interval) {
    if (grid->complex)
        return interval ? complex_interval_extract(grid, options, interval)
                        : complex_interval_count(grid, options, size, classify_ms);
    return interval ? structured_interval_extract(grid, options, interval)
                    : structured_interval_count(grid, options, size, classify_ms);
}

/* By kernels that are vetted and tried first; again if vetting has switched to the other variant. interval NULL:
 * counts. */
static tc_status device_make(tc_grid *grid, const tc_interval_volume_options *options, interval_size *size,
                             double *classify_ms, tc_interval_volume *interval) {
    tc_status status;
    do {
        status = call_vet(grid->context, interval_kind(grid));
        if (!status && !grid->complex) structured_reshape(grid);
        if (!status) status = trial_once(grid->context, interval_kind(grid));
        if (!status) status = kernels_run(grid, options, size, classify_ms, interval);
        /* Of other kernels, where missing samples were met. */
        if (!status) status = trial_once(grid->context, interval_kind(grid));
    } while (vetting_restarts(grid->context));
    return status;
}

/* Without tetrahedra there is nothing within. */
static bool grid_is_empty(const tc_grid *grid) { return grid->complex && !grid->complex->tetrahedron_count; }

static tc_status size_find(tc_grid *grid, const tc_interval_volume_options *options, interval_size *size,
                           double *classify_ms) {
    const double start = clock_ms();
    tc_status status = engine_check(grid);
    *size = (interval_size){{0}, 0};
    *classify_ms = 0;
    if (status || grid_is_empty(grid)) return status;
    if (has_kernels(grid)) return device_make(grid, options, size, classify_ms, NULL);
    status = grid->complex ? reference_complex_interval_count(grid, options, size)
                           : reference_interval_count(grid, options, size);
    *classify_ms = clock_ms() - start;
    return status;
}

static tc_status interval_make(tc_grid *grid, const tc_interval_volume_options *options, tc_interval_volume *interval) {
    tc_status status = engine_check(grid);
    if (status || grid_is_empty(grid)) return status;
    if (has_kernels(grid)) return device_make(grid, options, NULL, NULL, interval);
    return grid->complex ? reference_complex_interval_extract(grid, options, interval)
                         : reference_interval_extract(grid, options, interval);
}

tc_status tc_count_interval_volume(tc_grid *grid, const tc_interval_volume_options *options,
                                   tc_interval_volume_counts *counts) {
    FLOAT_ENVIRONMENT_DEFAULT;
    tc_interval_volume_options o;
    interval_size size = {{0}, 0};
    tc_status status = struct_clear(counts, sizeof *counts, "tc_count_interval_volume: counts");
    double classify_ms = 0;
    if (!status) status = interval_begin(grid, options, &o, "tc_count_interval_volume");
    if (!status) status = size_find(grid, &o, &size, &classify_ms);
    if (status) return status;
    const tc_interval_volume_counts found = {.struct_size = sizeof found,
                                             .sample_count = size.vertices[BLOCK_SAMPLES],
                                             .low_count = size.vertices[BLOCK_LOW],
                                             .high_count = size.vertices[BLOCK_HIGH],
                                             .tetrahedron_count = size.tetrahedra,
                                             .interval_bytes = interval_bytes(&size),
                                             .classify_ms = classify_ms};
    struct_copy_out(counts, &found);
    return TC_OK;
}

tc_status tc_extract_interval_volume(tc_grid *grid, const tc_interval_volume_options *options,
                                     tc_interval_volume **out) {
    FLOAT_ENVIRONMENT_DEFAULT;
    tc_interval_volume_options o;
    if (out && *out) interval_clear(*out);
    if (!grid || !out)
        return (tc_status)fail(TC_ERROR_ARGUMENT,
                               "tc_extract_interval_volume needs a grid and a place for the interval volume");
    tc_interval_volume *interval = *out ? *out : interval_create(grid->context->spare);
    if (!interval) return TC_ERROR_MEMORY;
    tc_status status = interval_begin(grid, options, &o, "tc_extract_interval_volume");
    if (!status) status = interval_make(grid, &o, interval);
    if (!status) memcpy(interval->origin, grid->origin, sizeof interval->origin);
    if (status) interval_clear(interval);
    if (status && !*out) {
        tc_interval_volume_destroy(interval);
        interval = NULL;
    }
    *out = interval;
    return status;
}

/* ----------------------------------------------------------------------------------------------------------- fields */

/* Vertices on the surface of a bound. */
static tc_status surface_carry_count(tc_grid *grid, double isovalue, uint64_t *count) {
    tc_counts counts = {.struct_size = sizeof counts};
    tc_extract_options surface;
    tc_extract_options_init(&surface);
    surface.isovalue = isovalue;
    *count = 0;
    if (isinf(isovalue)) return TC_OK;
    tc_status status = tc_count(grid, &surface, &counts);
    *count = counts.vertex_count;
    return status;
}

/* The field on the surface of a bound, behind the vertices before it; there is room for `left` values. */
static tc_status surface_interpolate(tc_grid *grid, double isovalue, const tc_field *field, float *values,
                                     uint64_t left, uint64_t *taken) {
    tc_extract_options surface;
    tc_extract_options_init(&surface);
    surface.isovalue = isovalue;
    tc_status status = surface_carry_count(grid, isovalue, taken);
    *taken *= (uint64_t)field->components;
    if (status || !*taken || *taken > left) return status;
    return tc_interpolate_field(grid, &surface, field, values, *taken);
}

tc_status tc_interpolate_interval_volume(tc_grid *grid, const tc_interval_volume_options *options,
                                         const tc_field *field, float *values, uint64_t value_count) {
    FLOAT_ENVIRONMENT_DEFAULT;
    tc_interval_volume_options o;
    tc_field f = {0};
    uint64_t samples = 0, taken = 0, used = 0;
    tc_status status = struct_copy_in(&f, sizeof f, field, "tc_interpolate_interval_volume: field");
    if (!status) status = interval_begin(grid, options, &o, "tc_interpolate_interval_volume");
    if (!status) status = field_check(grid, &f, values, value_count);
    if (status) return status;
    const carry c = {&f, values, value_count / (uint64_t)f.components};
    if (!grid_is_empty(grid))
        status = !grid->complex      ? reference_interval_carry(grid, &o, &c, &samples)
                 : has_kernels(grid) ? complex_interval_carry(grid, &o, &c, &samples)
                                     : reference_complex_interval_carry(grid, &o, &c, &samples);
    used = samples * (uint64_t)f.components;
    for (int n = 0; n < 2 && !status; n++) {
        const uint64_t left = used < value_count ? value_count - used : 0;
        status = surface_interpolate(grid, n ? o.high : o.low, &f, values ? values + (value_count - left) : NULL, left,
                                     &taken);
        used += taken;
    }
    if (status || used == value_count) return status;
    return (tc_status)fail(TC_ERROR_ARGUMENT, "room for %llu values, but the interval volume has %llu",
                           (unsigned long long)value_count, (unsigned long long)used);
}
