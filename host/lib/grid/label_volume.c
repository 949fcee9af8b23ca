#include "grid/label_volume.h"

#include "failure.h"
#include "parallel.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* What the threads that copy share: they take planes of the grid, one by one. */
typedef struct copying {
    label_volume *v;
    const uint32_t *labels; /* sorted; NULL: all are wanted */
    uint64_t label_count;
    _Atomic int64_t next;
} copying;

static int compare_labels(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static bool is_wanted(const copying *c, uint32_t label) {
    return !c->labels || bsearch(&label, c->labels, (size_t)c->label_count, sizeof label, compare_labels);
}

/* The label of sample n; 0 where it is missing or not wanted. Runs of one label are looked up once. */
static uint32_t label_of(const copying *c, int64_t n, double last[2]) {
    const tc_grid *grid = c->v->grid;
    const double value = grid_value_at(grid, n);
    if (grid->blanked_samples && grid->blanked_samples[n]) return 0;
    if (value == last[0]) return (uint32_t)last[1];
    const bool is_label = value > 0 && !(grid->has_nodata && value == grid->nodata) && is_wanted(c, (uint32_t)value);
    last[0] = value;
    last[1] = is_label ? value : 0;
    return (uint32_t)last[1];
}

static void put_label(const label_volume *v, int64_t n, uint32_t label) {
    if (v->type == TC_U8)
        ((uint8_t *)v->own)[n] = (uint8_t)label;
    else if (v->type == TC_U16)
        ((uint16_t *)v->own)[n] = (uint16_t)label;
    else
        ((uint32_t *)v->own)[n] = label;
}

static void copy_plane(const copying *c, int64_t z) {
    const label_volume *v = c->v;
    const int64_t *from = v->grid->dims, pad = v->before;
    double last[2] = {0, 0};
    for (int64_t y = 0; y < from[1]; y++) {
        const int64_t source = (z * from[1] + y) * from[0];
        const int64_t to = ((z + pad) * v->dims[1] + y + pad) * v->dims[0] + pad;
        for (int64_t x = 0; x < from[0]; x++) put_label(v, to + x, label_of(c, source + x, last));
    }
}

static void copy_planes(void *shared) {
    copying *c = shared;
    for (int64_t z; (z = atomic_fetch_add(&c->next, 1)) < c->v->grid->dims[2];) copy_plane(c, z);
}

static tc_type unsigned_type(tc_type type) {
    return sample_bytes(type) == 1 ? TC_U8 : sample_bytes(type) == 2 ? TC_U16 : TC_U32;
}

static tc_status copy(label_volume *v, const tc_labels_options *options) {
    copying c = {.v = v, .label_count = options->label_count};
    uint32_t *sorted = NULL;
    const uint64_t count = (uint64_t)v->dims[0] * (uint64_t)v->dims[1] * (uint64_t)v->dims[2];
    if (options->labels && !(sorted = malloc((size_t)options->label_count * sizeof *sorted)))
        return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the labels that are wanted");
    if (sorted) memcpy(sorted, options->labels, (size_t)options->label_count * sizeof *sorted);
    if (sorted) qsort(sorted, (size_t)options->label_count, sizeof *sorted, compare_labels);
    c.labels = sorted;
    v->own = calloc((size_t)count, sample_bytes(v->type));
    v->samples = v->own;
    if (v->own) parallel_run((uint64_t)v->grid->dims[2], copy_planes, &c);
    free(sorted);
    return v->own ? TC_OK : (tc_status)fail(TC_ERROR_MEMORY, "no memory for the labels of the samples");
}

static tc_status check(const tc_grid *grid, const tc_labels_options *options) {
    const char *reason = NULL;
    if (grid->complex)
        reason = "label maps are structured grids: there is a grid of tetrahedra";
    else if (grid->type == TC_F32 || grid->type == TC_F64)
        reason = "labels are integers: the samples are not";
    else if (!grid->samples)
        reason = "label maps are read from the host's memory, not from cl_samples";
    else if (grid->cut[0] || grid->cut[1])
        reason = "label maps are not taken in pieces";
    else if (grid->blanked_cells)
        reason = "label maps have samples that are blanked, not cells";
    if (!reason && (uintptr_t)options->labels % sizeof(uint32_t)) reason = "labels are not aligned";
    if (!reason && !options->labels != !options->label_count) reason = "labels and label_count do not fit together";
    for (uint64_t n = 0; n < options->label_count && !reason; n++)
        if (!options->labels[n]) reason = "0 is the background, and no label to be wanted";
    return reason ? (tc_status)fail(TC_ERROR_ARGUMENT, "%s", reason) : TC_OK;
}

tc_status label_volume_make(const tc_grid *grid, const tc_labels_options *options, label_volume *out) {
    *out = (label_volume){.grid = grid, .samples = grid->samples, .before = options->closed ? 1 : 0};
    const tc_status status = check(grid, options);
    if (status) return status;
    out->type = unsigned_type(grid->type);
    for (int axis = 0; axis < 3; axis++) out->dims[axis] = grid->dims[axis] + 2 * out->before;
    const bool is_plain =
        out->type == grid->type && !out->before && !options->labels && !grid->has_nodata && !grid->blanked_samples;
    return is_plain ? TC_OK : copy(out, options);
}

void label_volume_release(label_volume *v) { free(v->own); }
