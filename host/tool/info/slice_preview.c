#include "slice_preview.h"

#include "exit_status.h"
#include "failure.h"
#include "input/input.h"
#include "slice_picture.h"
#include "terminal/notice.h"

#include <math.h>
#include <stdlib.h>

#define CUT_SHARE 0.002 /* of the samples, at either end, that are darker than black and brighter than white */

int slice_preview_check(const options *o, const dataset *d) {
    int status = picture_check("--preview", o->preview);
    if (!status) status = input_overwrite_check(o, d, "--preview", o->preview);
    return status ? status : output_check(o->preview);
}

/* The number of the structured block with the most points. */
static int largest_block(const dataset *d) {
    int best = -1;
    for (int n = 0; n < d->block_count; n++)
        if (d->blocks[n].kind != BLOCK_UNSTRUCTURED &&
            (best < 0 || d->blocks[n].point_count > d->blocks[best].point_count))
            best = n;
    return best;
}

/* The bin in which the share of the samples is reached, counted from the first bin on, or from the last one down. */
static int bin_at(const statistics *s, double share, int is_from_end) {
    double sum = 0;
    int n = 0;
    for (; n < s->bin_count; n++) {
        sum += (double)s->bins[is_from_end ? s->bin_count - 1 - n : n];
        if (sum > share * (double)s->finite_count) break;
    }
    return is_from_end ? s->bin_count - 1 - n : n;
}

static void set_range(const statistics *s, sliced_volume *v) {
    v->black = fmax(s->minimum, s->low + bin_at(s, CUT_SHARE, 0) * s->width);
    v->white = fmin(s->maximum, s->low + (bin_at(s, CUT_SHARE, 1) + 1) * s->width);
}

/* ------------------------------------------------------------------------------------------------------------ axes */

/* The step of index space in world space, as a share of its length; without length none. */
static double along(const dataset_block *b, int axis, int world) {
    const double x = b->matrix[0][axis], y = b->matrix[1][axis], z = b->matrix[2][axis];
    const double length = sqrt(x * x + y * y + z * z);
    return length > 0 ? b->matrix[world][axis] / length : 0;
}

/* Which grid axis x, y and z of the picture are: those that lie closest, all different. */
static void choose_axes(const dataset_block *b, int axes[3]) {
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    double best = -1;
    for (int n = 0; n < 6; n++) {
        double sum = 0;
        for (int world = 0; world < 3; world++)
            sum += b->kind == BLOCK_UNIFORM ? fabs(along(b, orders[n][world], world)) : orders[n][world] == world;
        if (sum <= best) continue;
        best = sum;
        for (int world = 0; world < 3; world++) axes[world] = orders[n][world];
    }
}

static double position_at(const dataset_block *b, int axis, int64_t n) {
    const double *row = b->matrix[0];
    if (b->kind == BLOCK_RECTILINEAR) return coordinate_at(b->axes[axis], n);
    if (b->kind == BLOCK_CURVILINEAR) return (double)n;
    return (double)n * sqrt(row[axis] * row[axis] + b->matrix[1][axis] * b->matrix[1][axis] +
                            b->matrix[2][axis] * b->matrix[2][axis]);
}

/* Whether the axis runs against x, y or z of the picture. */
static int is_turned(const dataset_block *b, int axis, int world) {
    if (b->kind == BLOCK_RECTILINEAR) return position_at(b, axis, b->dims[axis] - 1) < position_at(b, axis, 0);
    return b->kind == BLOCK_UNIFORM && along(b, axis, world) < 0;
}

/* Fills positions, memory for all three axes, rising from 0. */
static void set_axes(const dataset_block *b, double *positions, sliced_volume *v) {
    const int64_t strides[3] = {1, b->dims[0], b->dims[0] * b->dims[1]};
    int axes[3] = {0, 1, 2};
    choose_axes(b, axes);
    for (int world = 0; world < 3; world++) {
        const int axis = axes[world], turned = is_turned(b, axis, world);
        const int64_t count = b->dims[axis];
        v->count[world] = count;
        v->stride[world] = turned ? -strides[axis] : strides[axis];
        v->first += turned ? (count - 1) * strides[axis] : 0;
        v->positions[world] = positions;
        for (int64_t n = 0; n < count; n++)
            *positions++ =
                fabs(position_at(b, axis, turned ? count - 1 - n : n) - position_at(b, axis, turned ? count - 1 : 0));
    }
}

/* --------------------------------------------------------------------------------------------------------- picture */

static void tell(const options *o, const dataset *d, int block) {
    if (d->block_count > 1)
        notice("%s: the preview shows block %d of %d, the largest structured one", o->operands[0], block,
               d->block_count);
    if (d->blocks[block].kind == BLOCK_CURVILINEAR)
        notice("%s: the preview shows the curvilinear grid by its indices, as a box", o->operands[0]);
}

static int draw(const options *o, const sliced_volume *v) {
    picture p;
    double *isovalues = calloc(o->isovalue_count + 1, sizeof *isovalues);
    if (!isovalues) return fail(STATUS_FAILED, "out of memory for the isolines");
    for (size_t n = 0; n < o->isovalue_count; n++) isovalues[n] = o->isovalues[n].value;
    int status = picture_make(&p, (int)o->preview_size[0], (int)o->preview_size[1]);
    if (!status) status = slice_picture(v, isovalues, o->isovalue_count, &p);
    if (!status) status = picture_write(&p, o->preview, NULL);
    picture_release(&p);
    free(isovalues);
    return status;
}

int slice_preview_write(const options *o, const dataset *d, const scalar *field, const statistics *s) {
    const int block = largest_block(d);
    if (block < 0 || !d->blocks[block].point_count)
        return fail(STATUS_INPUT, "%s: there is no structured block with points that --preview could show",
                    o->operands[0]);
    const dataset_block *b = &d->blocks[block];
    const scalar_block *samples = &field->blocks[block];
    double *positions = malloc((size_t)(b->dims[0] + b->dims[1] + b->dims[2]) * sizeof *positions);
    if (!positions) return fail(STATUS_FAILED, "out of memory for the positions of slices");
    sliced_volume v = {.type = samples->type,
                       .samples = samples->samples,
                       .blanked = samples->blanked_points,
                       .has_nodata = samples->has_nodata,
                       .nodata = samples->nodata};
    tell(o, d, block);
    set_range(s, &v);
    set_axes(b, positions, &v);
    const int status = draw(o, &v);
    free(positions);
    return status;
}
