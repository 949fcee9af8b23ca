#include "carried_fields.h"

#include "exit_status.h"
#include "failure.h"
#include "input/input.h"
#include "library_status.h"
#include "sample_types.h"
#include "shortest.h"
#include "terminal/notice.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static size_t count_names(const char *text) {
    size_t count = 1;
    for (; *text; text++) count += *text == ',';
    return count;
}

/* The length of the next name. Names of fields may have commas: the longest field's name that fits is taken, also
 * behind point: or cell:. Where none fits, the name ends at the next comma. */
static size_t name_length(const char *text, const char *const *known, int known_count) {
    const size_t prefix = field_prefix(text);
    size_t longest = 0;
    for (int n = 0; n < known_count; n++) {
        const size_t name = strlen(known[n]), starts[2] = {0, prefix};
        for (int m = 0; m < 2; m++) {
            size_t end = starts[m] + name;
            int fits = strncmp(text + starts[m], known[n], name) == 0 && (text[end] == ',' || !text[end]);
            if (fits && end > longest) longest = end;
        }
    }
    return longest ? longest : strcspn(text, ",");
}

enum { STEPS_MOST = 4096 }; /* steps of float32 within the range of a field: where there are fewer, they show */

/* The rounding error of float32 among such values: half a step. */
static double step_between(double low, double high) { return fmax(fmax(fabs(low), fabs(high)) * 0x1p-24, 0x1p-150); }

/* Finds the least and the greatest finite value of a component in all blocks. Returns 0, and ends early, once the
 * values differ by so much that float32 does no harm. */
static int has_narrow_range(const dataset *d, const point_field *from, int component, double range[2]) {
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (int n = 0; n < d->block_count; n++) {
        const dataset_field *f = &from->blocks[n];
        const uint64_t count = (uint64_t)d->blocks[n].point_count * (uint64_t)from->components;
        for (uint64_t at = (uint64_t)component; at < count; at += (uint64_t)from->components) {
            const double value = value_at(f->type, f->values, at);
            if (!isfinite(value)) continue;
            range[0] = fmin(range[0], value);
            range[1] = fmax(range[1], value);
            if (range[1] - range[0] > step_between(range[0], range[1]) * STEPS_MOST) return 0;
        }
    }
    return range[0] <= range[1];
}

/* Whether float32 hardly tells apart the values of some component. Gives a notice of that, and of a field that is
 * constant, as such values are of no use. */
static int tell_narrow(const dataset *d, const point_field *from) {
    int constant_count = 0, is_narrow = 0;
    double value = 0;
    for (int c = 0; notice_wanted() && c < from->components; c++) {
        double range[2];
        if (!has_narrow_range(d, from, c, range)) continue;
        value = range[0];
        constant_count += range[0] == range[1];
        if (range[0] == range[1] || from->blocks->type == TC_F32) continue;
        is_narrow = 1;
        notice("field '%s'%s is carried as float32, which has steps of %.2g there, and its values, %s to %s, differ by "
               "%.2g",
               from->name, from->components > 1 ? ", a component of it," : "", step_between(range[0], range[1]),
               shortest_number(range[0]).text, shortest_number(range[1]).text, range[1] - range[0]);
    }
    if (constant_count == from->components && constant_count == 1)
        notice("field '%s' is constant: every value is %s", from->name, shortest_number(value).text);
    else if (constant_count == from->components && constant_count)
        notice("field '%s' is constant: every point has the same %d values", from->name, constant_count);
    return is_narrow;
}

static int select_one(const options *o, dataset *d, carried_fields *out, const char *name) {
    point_field *from = &out->from[out->count];
    int status = point_field_select(d, o->operands[0], name, from);
    if (status) return status;
    for (int n = 0; n < out->count; n++)
        if (strcmp(out->from[n].name, from->name) == 0) return fail(STATUS_USAGE, "--carry: '%s' is given twice", name);
    if (from->is_averaged) input_tell_average(d, from->name);
    out->is_narrow[out->count] = (uint8_t)tell_narrow(d, from);
    out->fields[out->count++] = (vertex_array){from->name, from->components, NULL, ROLE_DATA};
    return 0;
}

static int select_all(const options *o, dataset *d, carried_fields *out, char *names) {
    const char **known;
    int status = 0, known_count = common_field_names(d, &known);
    if (known_count < 0) return STATUS_FAILED;
    for (char *at = names, *end; !status; at = end + 1) {
        end = at + name_length(at, known, known_count);
        int is_last = !*end;
        *end = '\0';
        status = select_one(o, d, out, at);
        if (is_last) break;
    }
    free(known);
    return status;
}

int carried_fields_select(const options *o, dataset *d, carried_fields *out) {
    *out = (carried_fields){0};
    if (!o->carry) return 0;
    size_t count = count_names(o->carry);
    char *names = strdup(o->carry);
    out->from = calloc(count, sizeof *out->from);
    out->fields = calloc(count, sizeof *out->fields);
    out->values = calloc(count, sizeof *out->values);
    out->is_narrow = calloc(count, sizeof *out->is_narrow);
    out->ranges = calloc(count, sizeof *out->ranges);
    int is_there = names && out->from && out->fields && out->values && out->is_narrow && out->ranges;
    int status = is_there ? select_all(o, d, out, names) : fail(STATUS_FAILED, "out of memory for the fields to carry");
    free(names);
    return status;
}

void carried_fields_release(carried_fields *c) {
    for (int n = 0; n < c->count; n++) free(c->values[n]);
    free(c->from);
    free(c->fields);
    free(c->values);
    free(c->is_narrow);
    free(c->ranges);
    *c = (carried_fields){0};
}

void carried_fields_begin(carried_fields *c) {
    for (int n = 0; n < c->count; n++) c->ranges[n] = (carried_range){INFINITY, -INFINITY, 0};
}

/* Whether float32 can be too coarse for values of the type. */
static int may_be_rounded(tc_type type) { return tc_type_bytes(type) >= sizeof(float) && type != TC_F32; }

static void extend_range(carried_range *range, const float *values, uint64_t count) {
    for (uint64_t n = 0; n < count; n++) {
        range->is_beyond = range->is_beyond || isinf(values[n]);
        if (!isfinite(values[n])) continue;
        range->low = fmin(range->low, (double)values[n]);
        range->high = fmax(range->high, (double)values[n]);
    }
}

static int reserve_memory(carried_fields *c, int n, uint64_t count) {
    free(c->values[n]);
    c->values[n] = malloc(count ? (size_t)count * sizeof **c->values : 1);
    c->fields[n].values = c->values[n];
    return c->values[n] ? 0 : fail(STATUS_FAILED, "out of memory for field '%s' on the surface", c->from[n].name);
}

static void note_range(carried_fields *c, int n, uint64_t count) {
    if (notice_wanted() && may_be_rounded(c->from[n].blocks->type)) extend_range(&c->ranges[n], c->values[n], count);
}

int carried_fields_interpolate(carried_fields *c, engine *e, block_range blocks, const tc_extract_options *how,
                               const tc_mesh_data *mesh) {
    int status = 0;
    for (int n = 0; n < c->count && !status; n++) {
        const uint64_t count = mesh->vertex_count * (uint64_t)c->from[n].components;
        status = reserve_memory(c, n, count);
        if (!status) status = engine_carry(e, blocks, how, &c->from[n], c->values[n]);
        if (!status) note_range(c, n, count);
    }
    return status;
}

int carried_fields_of_piece(carried_fields *c, const tc_mesh_piece *piece, uint64_t plane_points,
                            const tc_extract_options *how) {
    int status = 0;
    for (int n = 0; n < c->count && !status; n++) {
        const dataset_field *from = c->from[n].blocks;
        const uint64_t count = piece->mesh->vertex_count * (uint64_t)from->components;
        const size_t plane = (size_t)plane_points * (size_t)from->components * tc_type_bytes(from->type);
        const tc_field field = {sizeof field, from->type, from->components,
                                (const char *)from->values + (size_t)piece->first_plane * plane};
        status = reserve_memory(c, n, count);
        if (!status && count)
            status = library_status(tc_interpolate_field(piece->grid, how, &field, c->values[n], count));
        if (!status) note_range(c, n, count);
    }
    return status;
}

/* Float32 shows as more than 1/4096 of the range of the values, or as infinity. The first is not told again where it
 * has been told of the whole field. */
void carried_fields_tell(const carried_fields *c) {
    for (int n = 0; n < c->count; n++) {
        const carried_range *range = &c->ranges[n];
        const double step = step_between(range->low, range->high), width = range->high - range->low;
        if (range->is_beyond)
            notice("field '%s': values beyond float32, as which fields are carried, are infinite", c->from[n].name);
        else if (!c->is_narrow[n] && width > 0 && step * STEPS_MOST > width)
            notice("field '%s' is carried as float32, which has steps of %.2g there, and its values differ by %.2g",
                   c->from[n].name, step, width);
    }
}
