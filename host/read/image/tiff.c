/*
 * tiff.c - stacks of images in TIFF files: pages of one, or of several that lie beside each other (slices.h)
 *
 * Columns are x, rows y, pages z; several values of a pixel are components. Where ImageJ has written the file, its
 * channels are components, too, its frames frames, and its distances are the spacing. Pages are counted in a first
 * pass, so that memory is taken once.
 */
#include "image/image.h"

#include "dataset/array_memory.h"
#include "dataset/world.h"
#include "exit_status.h"
#include "failure.h"
#include "image/slices.h"
#include "image/source.h"
#include "image/tiff_pages.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct stack {
    const read_request *request;
    slice_list files;  /* none: the one that the request names */
    int64_t *pages;    /* of each file */
    int64_t all_pages; /* of all files */
    int64_t passed;    /* pages of lower resolution */
    tiff_shape shape;
    tiff_notes notes;
} stack;

static size_t file_count(const stack *s) { return s->files.count ? s->files.count : 1; }

static const char *file_path(const stack *s, size_t n) { return s->files.count ? s->files.paths[n] : s->request->path; }

static int measure(stack *s, dataset *out) {
    s->pages = calloc(file_count(s), sizeof *s->pages);
    if (!s->pages) return fail(STATUS_FAILED, "%s: no memory for its slices", s->request->path);
    for (size_t n = 0; n < file_count(s); n++) {
        mapping m;
        int status = dataset_map(out, file_path(s, n), &m);
        if (status) return status;
        status = tiff_measure(file_path(s, n), &m, &s->shape, &s->notes, &s->pages[n], &s->passed);
        mapping_close(&m);
        if (status) return status;
        s->all_pages += s->pages[n];
    }
    if (!s->all_pages) return fail(STATUS_INPUT, "%s: has no page that can be read", s->request->path);
    if (s->passed) dataset_notice(out, "%" PRId64 " pages of lower resolution are passed over", s->passed);
    return 0;
}

/* ImageJ writes channels, slices and frames in this order; a series in time without slices is taken for slices. */
static int list_axes(stack *s, axes *stored) {
    const tiff_notes *n = &s->notes;
    *stored = (axes){.count = 3,
                     .size = {s->shape.samples, s->shape.width, s->shape.height},
                     .role = {AXIS_COMPONENT, AXIS_SPACE, AXIS_SPACE}};
    if (n->is_imagej && s->files.count == 0 && n->images > s->all_pages)
        return fail(STATUS_INPUT,
                    "%s: holds %" PRId64 " images, but describes %" PRId64
                    " of them, as ImageJ does beyond 4 GiB; save it as raw data, or in parts",
                    s->request->path, n->images, s->all_pages);
    const int is_series = n->is_imagej && s->files.count == 0 && s->shape.samples == 1 &&
                          n->channels * n->slices * n->frames == s->all_pages && n->channels * n->slices > 1;
    const int64_t sizes[3] = {is_series ? n->channels : 1, is_series ? n->slices : s->all_pages,
                              is_series ? n->frames : 1};
    static const enum axis_role roles[3] = {AXIS_COMPONENT, AXIS_SPACE, AXIS_FRAME};
    const int takes_frames = is_series && n->slices == 1;
    for (int axis = 0; axis < 3; axis++) {
        if (takes_frames && axis == 1) continue;
        stored->size[stored->count] = sizes[axis];
        stored->role[stored->count++] = takes_frames && axis == 2 ? AXIS_SPACE : roles[axis];
    }
    return 0;
}

static int load(const stack *s, dataset *out, unsigned char *to) {
    for (size_t n = 0; n < file_count(s); n++) {
        mapping m;
        int status = dataset_map(out, file_path(s, n), &m);
        if (status) return status;
        status = tiff_load(file_path(s, n), &m, &s->shape, s->pages[n], to);
        mapping_close(&m);
        if (status) return status;
        to += (uint64_t)s->pages[n] * tiff_page_bytes(&s->shape);
    }
    return 0;
}

static int read_stack(stack *s, dataset *out) {
    const read_request *request = s->request;
    axes stored;
    layout l;
    int status = measure(s, out);
    if (!status) status = list_axes(s, &stored);
    if (!status) status = layout_make(request->path, &stored, s->shape.element, request, &l);
    for (int axis = 0; axis < 3; axis++)
        out->blocks->matrix[axis][axis] = s->notes.is_imagej ? s->notes.spacing[axis] : 1;
    if (!status) status = world_complete(request, request->path, out->blocks->matrix);
    if (status) return status;
    unsigned char *samples = samples_allocate(l.bytes);
    if (!samples)
        return fail(STATUS_FAILED, "%s: needs %" PRIu64 " bytes of memory, which are not to be had", request->path,
                    l.bytes);
    if ((status = load(s, out, samples))) {
        samples_free(samples);
        return status;
    }
    const source from = {.header_path = request->path, .axes = &stored};
    snprintf(out->format, sizeof out->format, "TIFF");
    return source_take(request, &from, &l, samples, out);
}

int tiff_read(const read_request *request, const mapping *file, dataset *out) {
    stack s = {.request = request};
    int status = dataset_image_begin(out);
    if (!status && !file->bytes && slices_are_named(request->path)) status = slices_list(request->path, &s.files);
    if (!status) status = read_stack(&s, out);
    slices_release(&s.files);
    free(s.pages);
    return status;
}
