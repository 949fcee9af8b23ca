/*
 * The public call that interpolates a field at the vertices of a surface. It checks arguments, counts the surface again
 * unless it is the one counted or extracted last, then visits its vertices.
 */
#include "opencl/context.h"
#include "failure.h"
#include "base/float_environment.h"
#include "base/structs.h"
#include "extract.h"
#include "surface/surface.h"

tc_status field_check(const tc_grid *grid, const tc_field *field, const float *out, uint64_t value_count) {
    if (!grid || (!out && value_count))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "a field needs a grid to be carried on, and a place for the values");
    if (!tc_type_bytes(field->type) || field->components < 1 || !field->values)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the field has no values, or their type or number is not valid");
    if ((uintptr_t)field->values % tc_type_bytes(field->type) || (uintptr_t)out % sizeof *out)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the field's values, or the place for them, are not aligned");
    if (!grid->samples)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "fields are carried where samples are in the host's memory: this "
                                                  "grid has cl_samples");
    return TC_OK;
}

/* Counts the surface, unless the results that carrying needs are still there. */
static tc_status surface_find(tc_grid *grid, const tc_extract_options *options) {
    tc_counts counts;
    surface_keep_results(grid);
    return surface_is_classified(grid, options) ? TC_OK : surface_count_vetted(grid, options, 0.5, &counts);
}

tc_status tc_interpolate_field(tc_grid *grid, const tc_extract_options *options, const tc_field *field, float *out,
                               uint64_t value_count) {
    FLOAT_ENVIRONMENT_DEFAULT;
    tc_extract_options o;
    tc_field f = {0};
    uint64_t vertex_count = 0;
    tc_status status = struct_copy_in(&f, sizeof f, field, "tc_interpolate_field: field");
    if (!status) status = field_check(grid, &f, out, value_count);
    if (status) return status;
    const uint64_t components = (uint64_t)f.components;
    const carry c = {&f, out, value_count / components};
    status = extract_options_take(&o, options);
    if (!status) status = context_check(grid->context);
    if (!status) status = surface_find(grid, &o);
    if (!status) status = surface_carry(grid, &o, &c, &vertex_count);
    if (!status && (vertex_count != c.capacity || value_count % components))
        status = (tc_status)fail(TC_ERROR_ARGUMENT, "room for %llu values, but %llu vertices of %llu each",
                                 (unsigned long long)value_count, (unsigned long long)vertex_count,
                                 (unsigned long long)components);
    return status;
}
