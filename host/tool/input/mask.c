#include "mask.h"

#include "dataset/region.h"
#include "exit_status.h"
#include "failure.h"
#include "read.h"
#include "sample_types.h"
#include "terminal/notice.h"

#include <inttypes.h>
#include <math.h>

static const dataset_block *whole_of(const dataset_block *b) { return b->whole ? b->whole : b; }

/* All that the mask has is read, so that several values per sample are seen here. */
static int read_mask(const read_request *request, const dataset *d, dataset *mask) {
    read_request of_mask;
    read_request_init(&of_mask, request->mask);
    of_mask.like = d;
    of_mask.describe = 1;
    if (d->block_count == 1) {
        of_mask.raw_else = 1;
        of_mask.type = TC_U8;
        for (int axis = 0; axis < 3; axis++) of_mask.dims[axis] = whole_of(d->blocks)->dims[axis];
    }
    return dataset_read(&of_mask, mask);
}

/* The mask's values for a block of the input; NULL where it has none. */
static const dataset_block *block_of(const dataset *mask, const dataset_block *b) {
    for (int n = 0; n < mask->block_count; n++)
        if (mask->blocks[n].number == b->number && mask->blocks[n].kind != BLOCK_UNSTRUCTURED) return &mask->blocks[n];
    return NULL;
}

static int check_values(const char *path, const dataset *mask, const dataset_block *b) {
    if (b->field_count != 1)
        return fail(STATUS_USAGE, "--mask %s: holds %d fields; a mask has one", path, b->field_count);
    if (b->fields->on_cells)
        return fail(STATUS_USAGE, "--mask %s: its values are those of cells; a mask has one for each sample", path);
    if (b->fields->components > 1 || mask->frames > 1)
        return fail(STATUS_USAGE, "--mask %s: has %" PRId64 " values per sample; a mask has one", path,
                    b->fields->components > 1 ? (int64_t)b->fields->components : mask->frames);
    return 0;
}

/* Writes 1 where a point is blanked already, or the value is 0 or none. Returns how many have no such value. */
static uint64_t leave_out(const dataset_field *f, const uint8_t *blanked, uint64_t count, uint8_t *to) {
    uint64_t left_out = 0;
    switch (f->type) {
#define LEAVE_OUT_CASE(type, name, c_type, ...)                                                                        \
    case type: {                                                                                                       \
        const c_type *at = f->values;                                                                                  \
        for (uint64_t n = 0; n < count; n++) {                                                                         \
            const uint8_t is_out = at[n] == 0 || isnan((double)at[n]);                                                 \
            left_out += is_out;                                                                                        \
            to[n] = is_out || (blanked && blanked[n]);                                                                 \
        }                                                                                                              \
        break;                                                                                                         \
    }
        SAMPLE_TYPES(LEAVE_OUT_CASE)
#undef LEAVE_OUT_CASE
    }
    return left_out;
}

static int apply_to_block(const char *path, dataset *mask, dataset *d, int n, scalar_block *s, uint64_t *left_out) {
    const dataset_block *b = &d->blocks[n], *from = block_of(mask, b);
    const uint64_t count = (uint64_t)b->point_count;
    dataset_field values;
    if (!from)
        return fail(STATUS_USAGE, "--mask %s: has no structured grid for block %d of the input", path, b->number);
    int status = check_values(path, mask, from);
    if (!status) status = region_field(mask, from, from->fields, &values);
    uint8_t *blanked = status ? NULL : dataset_allocate(d, count);
    if (!blanked) return status ? status : STATUS_FAILED;
    *left_out += leave_out(&values, s->blanked_points, count, blanked);
    s->blanked_points = blanked;
    return 0;
}

int mask_apply(const read_request *request, dataset *d, scalar *field) {
    dataset mask;
    uint64_t left_out = 0, points = 0;
    int status = read_mask(request, d, &mask);
    if (status) return status;
    for (int n = 0; n < d->block_count && !status; n++) {
        status = apply_to_block(request->mask, &mask, d, n, &field->blocks[n], &left_out);
        points += (uint64_t)d->blocks[n].point_count;
    }
    if (!status && left_out)
        notice("--mask: %" PRIu64 " of %" PRIu64 " samples are missing", left_out, points);
    else if (!status)
        notice("--mask: no sample of '%s' is 0: nothing is left out", request->mask);
    dataset_release(&mask);
    return status;
}
