#include "dataset/region.h"

#include "dataset/world.h"
#include "exit_status.h"
#include "failure.h"
#include "sample_types.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int64_t step_of(const read_request *request, int axis) {
    return request->region.step[axis] > 1 ? request->region.step[axis] : 1;
}

static int64_t floor_div(int64_t a, int64_t b) { return a / b - (a % b < 0); }

static int64_t least(int64_t a, int64_t b) { return a < b ? a : b; }

static int64_t most(int64_t a, int64_t b) { return a > b ? a : b; }

static index_ranges indices_of(const dataset_block *b) {
    index_ranges e;
    for (int axis = 0; axis < 3; axis++) {
        e.begin[axis] = b->first[axis];
        e.end[axis] = b->first[axis] + b->dims[axis];
    }
    return e;
}

int region_is_asked(const read_request *request) {
    int is_thinned = 0;
    for (int axis = 0; axis < 3; axis++) is_thinned |= step_of(request, axis) > 1;
    return request->region.has_indices || request->region.has_world || is_thinned || request->like;
}

/* ---------------------------------------------------------------------------------------------------------- values */

/* Values of the box, of an array with so many along each axis and `components` each. What can be used in place is. */
static int take_box(dataset *d, const dataset_field *as, const int64_t dims[3], const sample_box *box,
                    const void **values) {
    const uint64_t components = (uint64_t)as->components;
    layout l = {.element = (int)as->type,
                .swapped = as->is_swapped,
                .components = as->components,
                .component_stride = 1,
                .slope = 1};
    l.stride[0] = components;
    l.stride[1] = l.stride[0] * (uint64_t)dims[0];
    l.stride[2] = l.stride[1] * (uint64_t)dims[1];
    layout_cut(&l, box);
    const unsigned char *from = *values;
    const size_t bytes = sample_bytes(as->type);
    if (layout_is_plain(&l, from)) {
        *values = from + l.offset * bytes;
        return 0;
    }
    const uint64_t count = (uint64_t)(box->count[0] * box->count[1] * box->count[2]) * components;
    void *to = dataset_allocate(d, count * bytes);
    if (!to) return STATUS_FAILED;
    *values = to;
    return layout_gather("", &l, from, to);
}

int region_points(dataset *d, const int64_t dims[3], tc_type type, int components, const sample_box *box,
                  const void **values) {
    const dataset_field as = {.type = type, .components = components};
    return *values ? take_box(d, &as, dims, box, values) : 0;
}

/* The cells that have a corner at a sample of the box and lie in it, each whole cell by itself. */
static sample_box cells_of(const sample_box *box) {
    sample_box cells = *box;
    for (int axis = 0; axis < 3; axis++) cells.count[axis]--;
    return cells;
}

static void cell_dims(const int64_t dims[3], int64_t cells[3]) {
    for (int axis = 0; axis < 3; axis++) cells[axis] = dims[axis] - 1;
}

static int is_thinned(const sample_box *box) { return box->step[0] > 1 || box->step[1] > 1 || box->step[2] > 1; }

/* Whether one of the cells is blanked that a cell of the box consists of. */
static uint8_t has_blanked(const int64_t dims[3], const sample_box *box, const uint8_t *cells, const int64_t at[3]) {
    int64_t begin[3];
    uint8_t any = 0;
    for (int axis = 0; axis < 3; axis++) begin[axis] = box->first[axis] + at[axis] * box->step[axis];
    for (int64_t z = begin[2]; z < begin[2] + box->step[2]; z++)
        for (int64_t y = begin[1]; y < begin[1] + box->step[1]; y++)
            for (int64_t x = begin[0]; x < begin[0] + box->step[0]; x++)
                any |= cells[x + (dims[0] - 1) * (y + (dims[1] - 1) * z)] != 0;
    return any;
}

int region_blanked_cells(dataset *d, const int64_t dims[3], const sample_box *box, const uint8_t **cells) {
    const sample_box own = cells_of(box);
    int64_t all[3], at[3];
    cell_dims(dims, all);
    if (!*cells || !is_thinned(box)) return region_points(d, all, TC_U8, 1, &own, (const void **)cells);
    uint8_t *merged = dataset_allocate(d, (uint64_t)(own.count[0] * own.count[1] * own.count[2])), *to = merged;
    if (!merged) return STATUS_FAILED;
    for (at[2] = 0; at[2] < own.count[2]; at[2]++)
        for (at[1] = 0; at[1] < own.count[1]; at[1]++)
            for (at[0] = 0; at[0] < own.count[0]; at[0]++) *to++ = has_blanked(dims, box, *cells, at);
    *cells = merged;
    return 0;
}

/* ---------------------------------------------------------------------------------------------------------- fields */

static int take_field(dataset *d, const dataset_field *f, const int64_t dims[3], const sample_box *points,
                      dataset_field *out) {
    int64_t cells[3];
    const sample_box of_cells = cells_of(points);
    cell_dims(dims, cells);
    const dataset_field from = *f; /* which *out may be */
    *out = from;
    out->is_whole = out->is_swapped = 0;
    return take_box(d, &from, f->on_cells ? cells : dims, f->on_cells ? &of_cells : points, &out->values);
}

int region_field(dataset *d, const dataset_block *b, const dataset_field *f, dataset_field *out) {
    *out = *f;
    return f->is_whole ? take_field(d, f, b->whole->dims, &b->region, out) : 0;
}

int region_around(dataset *d, const dataset_block *b, const dataset_field *f, dataset_block *around, dataset_field *out,
                  sample_box *inner) {
    const dataset_block *whole = b->whole;
    sample_box wide;
    *inner = b->region;
    *around = (dataset_block){.kind = whole->kind, .point_count = 1, .cell_count = 1};
    for (int axis = 0; axis < 3; axis++) {
        const int64_t last = b->region.first[axis] + (b->region.count[axis] - 1) * b->region.step[axis];
        wide.first[axis] = most(b->region.first[axis] - 1, 0);
        wide.count[axis] = least(last + 2, whole->dims[axis]) - wide.first[axis];
        wide.step[axis] = 1;
        inner->first[axis] -= wide.first[axis];
        around->dims[axis] = wide.count[axis];
        around->point_count *= wide.count[axis];
        around->cell_count *= wide.count[axis] - 1;
    }
    around->blanked_points = whole->blanked_points;
    around->blanked_cells = whole->blanked_cells;
    int status = region_points(d, whole->dims, TC_U8, 1, &wide, (const void **)&around->blanked_points);
    if (!status) status = region_blanked_cells(d, whole->dims, &wide, &around->blanked_cells);
    return status ? status : take_field(d, f, whole->dims, &wide, out);
}

/* ------------------------------------------------------------------------------------------------------ index space */

void region_range(const dataset_block *b, int axis, int64_t *begin, int64_t *end) {
    *begin = b->whole ? b->whole->first[axis] + b->region.first[axis] : b->first[axis];
    *end = *begin + (b->whole ? (b->region.count[axis] - 1) * b->region.step[axis] : b->dims[axis] - 1) + 1;
}

void region_whole_extent(const dataset_block *b, int64_t first[3], int64_t dims[3]) {
    for (int axis = 0; axis < 3; axis++) {
        const int64_t step = b->region.step[axis], before = b->region.first[axis] / step;
        const int64_t behind = (b->whole->dims[axis] - 1 - b->region.first[axis]) / step;
        first[axis] = b->first[axis] - before;
        dims[axis] = before + behind + 1;
    }
}

/* Sample i of the whole gets the index floor(i / step); the matrix puts the part's first sample where it was. */
static void thin_indices(dataset_block *b, int axis) {
    const int64_t step = b->region.step[axis], at = b->first[axis] + b->region.first[axis];
    b->first[axis] = floor_div(at, step);
    for (int r = 0; r < 3 && step > 1; r++) {
        b->matrix[r][3] += b->matrix[r][axis] * (double)(at - b->first[axis] * step);
        b->matrix[r][axis] *= (double)step;
    }
}

static int take_coordinates(dataset *d, dataset_block *b) {
    static const int64_t single[3] = {1, 1, 1};
    const sample_box *box = &b->region;
    int status = 0;
    if (b->kind == BLOCK_CURVILINEAR)
        status = b->points.f64 ? region_points(d, b->whole->dims, TC_F64, 3, box, (const void **)&b->points.f64)
                               : region_points(d, b->whole->dims, TC_F32, 3, box, (const void **)&b->points.f32);
    for (int axis = 0; axis < 3 && b->kind == BLOCK_RECTILINEAR && !status; axis++) {
        const sample_box of_axis = {
            .first = {box->first[axis]}, .count = {box->count[axis], 1, 1}, .step = {box->step[axis], 1, 1}};
        coordinates *at = &b->axes[axis];
        status = at->f64 ? region_points(d, single, TC_F64, 1, &of_axis, (const void **)&at->f64)
                         : region_points(d, single, TC_F32, 1, &of_axis, (const void **)&at->f32);
    }
    return status;
}

/* Makes the block that part of itself. */
static int become_part(dataset *d, dataset_block *b, const sample_box *box) {
    dataset_block *whole = dataset_allocate(d, sizeof *whole);
    if (!whole) return STATUS_FAILED;
    *whole = *b;
    whole->fields = NULL;
    whole->field_count = 0;
    b->whole = whole;
    b->region = *box;
    b->point_count = b->cell_count = 1;
    for (int axis = 0; axis < 3; axis++) {
        b->dims[axis] = box->count[axis];
        b->point_count *= box->count[axis];
        b->cell_count *= box->count[axis] - 1;
        thin_indices(b, axis);
    }
    int status = take_coordinates(d, b);
    if (!status) status = region_points(d, whole->dims, TC_U8, 1, box, (const void **)&b->blanked_points);
    return status ? status : region_blanked_cells(d, whole->dims, box, &b->blanked_cells);
}

/* ----------------------------------------------------------------------------------------------------- world space */

/* Within a millionth of the distance between samples, a border lies at the sample. */
static const double tolerance = 1e-6;

static void range_add(index_ranges *e, int axis, int64_t begin, int64_t end) {
    e->begin[axis] = least(e->begin[axis], begin);
    e->end[axis] = most(e->end[axis], end);
}

/* Of an affine map: the indices of the box's corners, as far as it overlaps with the grid's. Ranges without an end are
 * those of the grid. */
static void find_in_matrix(dataset_block *b, const world_ranges *world, index_ranges *e) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double least_index[3] = {INFINITY, INFINITY, INFINITY}, most_index[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int n = 0; n < 24; n++) {
        double at = b->matrix[n % 3][3];
        for (int a = 0; a < 3; a++)
            at += b->matrix[n % 3][a] * (double)(b->first[a] + (n / 3 >> a & 1 ? b->dims[a] - 1 : 0));
        low[n % 3] = fmin(low[n % 3], at);
        high[n % 3] = fmax(high[n % 3], at);
    }
    for (int r = 0; r < 3; r++) {
        low[r] = fmax(low[r], world->low[r]);
        high[r] = fmin(high[r], world->high[r]);
        if (low[r] > high[r]) return;
    }
    for (int corner = 0; corner < 8; corner++) {
        double point[3], index[3];
        for (int r = 0; r < 3; r++) point[r] = corner >> r & 1 ? high[r] : low[r];
        world_index(b->matrix, point, index);
        for (int axis = 0; axis < 3; axis++) {
            least_index[axis] = fmin(least_index[axis], index[axis]);
            most_index[axis] = fmax(most_index[axis], index[axis]);
        }
    }
    for (int axis = 0; axis < 3; axis++) {
        const double first = (double)b->first[axis], last = (double)(b->first[axis] + b->dims[axis] - 1);
        if (least_index[axis] > last + tolerance || most_index[axis] < first - tolerance) return;
        range_add(e, axis, (int64_t)fmax(first, floor(least_index[axis] + tolerance)),
                  (int64_t)fmin(last, ceil(most_index[axis] - tolerance)) + 1);
    }
}

/* Of axes: the intervals between samples that the ranges overlap with. */
static void find_in_axes(const dataset_block *b, const world_ranges *world, index_ranges *e) {
    for (int axis = 0; axis < 3; axis++) {
        if (b->dims[axis] == 1) range_add(e, axis, b->first[axis], b->first[axis] + 1);
        for (int64_t n = 0; n + 1 < b->dims[axis]; n++) {
            const double p = coordinate_at(b->axes[axis], n), q = coordinate_at(b->axes[axis], n + 1);
            if (fmin(p, q) < world->high[axis] && fmax(p, q) > world->low[axis])
                range_add(e, axis, b->first[axis] + n, b->first[axis] + n + 2);
        }
    }
}

/* Of points: those in the box, and one sample more on each side. Blanked points may lie anywhere. */
static void find_in_points(const dataset_block *b, const world_ranges *world, index_ranges *e) {
    int64_t n = 0, at[3];
    for (at[2] = 0; at[2] < b->dims[2]; at[2]++)
        for (at[1] = 0; at[1] < b->dims[1]; at[1]++)
            for (at[0] = 0; at[0] < b->dims[0]; at[0]++, n++) {
                int is_within = !b->blanked_points || !b->blanked_points[n];
                for (int axis = 0; axis < 3 && is_within; axis++) {
                    const double p = coordinate_at(b->points, 3 * n + axis);
                    is_within = p >= world->low[axis] && p <= world->high[axis];
                }
                for (int axis = 0; axis < 3 && is_within; axis++)
                    range_add(e, axis, most(b->first[axis] + at[axis] - 1, b->first[axis]),
                              least(b->first[axis] + at[axis] + 2, b->first[axis] + b->dims[axis]));
            }
}

/* Returns 0 where nothing of the block lies there. */
static int find_in_world(dataset_block *b, const world_ranges *world, index_ranges *e) {
    *e = (index_ranges){{INT64_MAX, INT64_MAX, INT64_MAX}, {INT64_MIN, INT64_MIN, INT64_MIN}};
    if (b->kind == BLOCK_UNIFORM) find_in_matrix(b, world, e);
    if (b->kind == BLOCK_RECTILINEAR) find_in_axes(b, world, e);
    if (b->kind == BLOCK_CURVILINEAR) find_in_points(b, world, e);
    return e->begin[0] < e->end[0] && e->begin[1] < e->end[1] && e->begin[2] < e->end[2];
}

/* ----------------------------------------------------------------------------------------------------------- boxes */

enum { SIZE_TEXT = 256 };

/* "the grid has 64 x 48 x 32 samples", with its indices where they do not begin at 0. */
static const char *size_text(const dataset *d, const index_ranges *all, char text[SIZE_TEXT]) {
    int used = 0, begins_at_0 = 1;
    for (int axis = 0; axis < 3; axis++) begins_at_0 &= all->begin[axis] == 0;
    if (d->block_count == 1)
        used = snprintf(text, SIZE_TEXT, "the grid has %" PRId64 " x %" PRId64 " x %" PRId64 " samples",
                        all->end[0] - all->begin[0], all->end[1] - all->begin[1], all->end[2] - all->begin[2]);
    else
        used = snprintf(text, SIZE_TEXT, "the grid has %d blocks", d->block_count);
    if (d->block_count > 1 || !begins_at_0)
        snprintf(text + used, (size_t)(SIZE_TEXT - used),
                 ", with indices from %" PRId64 ", %" PRId64 ", %" PRId64 " to %" PRId64 ", %" PRId64 ", %" PRId64,
                 all->begin[0], all->begin[1], all->begin[2], all->end[0] - 1, all->end[1] - 1, all->end[2] - 1);
    return text;
}

/* The ranges of indices that are asked for, with open ends filled in. */
static int find_ranges(const read_request *request, const dataset *d, const index_ranges *all, index_ranges *asked) {
    char size[SIZE_TEXT];
    *asked = *all;
    for (int axis = 0; axis < 3 && request->region.has_indices; axis++) {
        const int64_t begin = request->region.indices.begin[axis], end = request->region.indices.end[axis];
        if (begin != INT64_MIN) asked->begin[axis] = begin;
        if (end != INT64_MAX) asked->end[axis] = end;
        const int is_empty = asked->begin[axis] >= asked->end[axis];
        if (is_empty && begin != INT64_MIN && end != INT64_MAX)
            return fail(STATUS_USAGE,
                        "%s: --roi %" PRId64 ":%" PRId64 " along %c holds nothing, as a range goes from its first "
                        "index to before its second: %s",
                        request->path, begin, end, 'x' + axis, size_text(d, all, size));
        if (is_empty || asked->begin[axis] < all->begin[axis] || asked->end[axis] > all->end[axis])
            return fail(STATUS_USAGE,
                        "%s: --roi %" PRId64 ":%" PRId64 " along %c reaches outside %" PRId64 ":%" PRId64 ": %s",
                        request->path, asked->begin[axis], asked->end[axis], 'x' + axis, all->begin[axis],
                        all->end[axis], size_text(d, all, size));
    }
    return 0;
}

static const char *options_of(const read_request *request, int axis) {
    const int is_cut = request->region.has_indices || request->region.has_world;
    const char *roi = request->region.has_world ? "--roi-world" : "--roi";
    if (step_of(request, axis) == 1) return roi;
    if (!is_cut) return "--step";
    return request->region.has_world ? "--roi-world and --step" : "--roi and --step";
}

/* The block's samples that are asked for. *is_there: whether it has two or more along each axis; a lone block has to.
 */
static int find_box(const read_request *request, const dataset *d, dataset_block *b, const index_ranges *all,
                    sample_box *box, int *is_there) {
    char size[SIZE_TEXT];
    index_ranges asked;
    int status = find_ranges(request, d, all, &asked);
    if (status) return status;
    *is_there = !request->region.has_world || find_in_world(b, &request->region.world, &asked);
    if (!*is_there && d->block_count == 1)
        return fail(STATUS_USAGE, "%s: --roi-world: %s there: %s; 'tetracubes info' tells where they lie",
                    request->path, b->kind == BLOCK_CURVILINEAR ? "no sample lies" : "the grid does not lie",
                    size_text(d, all, size));
    for (int axis = 0; axis < 3 && *is_there; axis++) {
        const int64_t step = step_of(request, axis), begin = most(asked.begin[axis], b->first[axis]);
        const int64_t end = least(asked.end[axis], b->first[axis] + b->dims[axis]);
        const int64_t first = begin + (step - (begin - asked.begin[axis]) % step) % step;
        box->first[axis] = first - b->first[axis];
        box->count[axis] = first < end ? (end - 1 - first) / step + 1 : 0;
        box->step[axis] = step;
        if (box->count[axis] >= 2 || b->dims[axis] < 2) continue;
        *is_there = 0;
        if (d->block_count == 1)
            return fail(STATUS_USAGE, "%s: %s %s %" PRId64 " sample along %c, and a surface needs two or more: %s",
                        request->path, options_of(request, axis),
                        strchr(options_of(request, axis), ' ') ? "leave" : "leaves", box->count[axis], 'x' + axis,
                        size_text(d, all, size));
    }
    return 0;
}

/* The part that the block of the same number has in the other dataset; its size there has to be this one. */
static int find_likewise(const read_request *request, const dataset_block *b, sample_box *box, int *is_there) {
    *is_there = 0;
    for (int n = 0; n < request->like->block_count; n++) {
        const dataset_block *other = &request->like->blocks[n], *whole = other->whole ? other->whole : other;
        if (other->number != b->number) continue;
        if (memcmp(whole->dims, b->dims, sizeof b->dims) != 0)
            return fail(STATUS_USAGE,
                        "--mask %s: has %" PRId64 " x %" PRId64 " x %" PRId64 " samples, and the input %" PRId64
                        " x %" PRId64 " x %" PRId64 ": a mask has one for each",
                        request->path, b->dims[0], b->dims[1], b->dims[2], whole->dims[0], whole->dims[1],
                        whole->dims[2]);
        *is_there = 1;
        *box = other->region;
        if (other->whole) return 0;
        *box = (sample_box){.step = {1, 1, 1}};
        memcpy(box->count, b->dims, sizeof b->dims);
    }
    return 0;
}

static int find_part(const read_request *request, const dataset *d, dataset_block *b, const index_ranges *all,
                     sample_box *box, int *is_there) {
    return request->like ? find_likewise(request, b, box, is_there) : find_box(request, d, b, all, box, is_there);
}

/* ----------------------------------------------------------------------------------------------------------- calls */

int region_cut_image(const read_request *request, dataset *d, layout *l) {
    dataset_block *b = d->blocks;
    const index_ranges all = indices_of(b);
    sample_box box;
    int is_there, status;
    if (!region_is_asked(request)) return 0;
    if ((status = find_part(request, d, b, &all, &box, &is_there)) || !is_there) return status;
    layout_cut(l, &box);
    return become_part(d, b, &box);
}

/* The indices that some structured block has; empty where there is none. */
static index_ranges indices_of_all(const dataset *d) {
    index_ranges all = {{INT64_MAX, INT64_MAX, INT64_MAX}, {INT64_MIN, INT64_MIN, INT64_MIN}};
    for (int n = 0; n < d->block_count; n++) {
        const index_ranges one = indices_of(&d->blocks[n]);
        for (int axis = 0; axis < 3 && d->blocks[n].kind != BLOCK_UNSTRUCTURED; axis++)
            range_add(&all, axis, one.begin[axis], one.end[axis]);
    }
    return all;
}

int region_cut_blocks(const read_request *request, dataset *d) {
    const index_ranges all = indices_of_all(d);
    char size[SIZE_TEXT];
    int kept = 0;
    for (int n = 0; n < d->block_count; n++) d->blocks[n].number = n;
    if (!region_is_asked(request) || all.begin[0] >= all.end[0]) return 0;
    for (int n = 0; n < d->block_count; n++) {
        dataset_block *b = &d->blocks[n];
        sample_box box;
        int is_there = 1, status = 0;
        if (b->kind != BLOCK_UNSTRUCTURED) {
            status = find_part(request, d, b, &all, &box, &is_there);
            if (!status && is_there) status = become_part(d, b, &box);
        }
        for (int f = 0; f < b->field_count; f++) b->fields[f].is_whole = b->whole != NULL;
        if (status) return status;
        const dataset_block done = *b;
        if (!is_there) free(b->fields);
        b->fields = NULL; /* each is freed once, also where a later block fails */
        if (is_there) d->blocks[kept++] = done;
    }
    if (!kept && d->block_count)
        return fail(STATUS_USAGE, "%s: none of its blocks has two samples along each axis there: %s", request->path,
                    size_text(d, &all, size));
    d->block_count = kept;
    return 0;
}
