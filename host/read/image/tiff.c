/*
 * tiff.c - stacks of images in TIFF files: pages of one, or of several that lie beside each other (slices.h)
 *
 * Columns are x, rows y, pages z; several values of a pixel are components. Of files of ImageJ and OME-TIFF channels
 * are components, too, frames (times) frames, and their distances are the spacing. Pages are counted in a first pass,
 * so that memory is taken once.
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

/* A series in time without slices is taken for slices. */
static int list_axes(stack *s, axes *stored, dataset *out) {
    static const enum axis_role roles[TIFF_DIMENSIONS] = {AXIS_COMPONENT, AXIS_SPACE, AXIS_FRAME};
    const tiff_notes *n = &s->notes;
    *stored = (axes){.count = 3,
                     .size = {s->shape.samples, s->shape.width, s->shape.height},
                     .role = {AXIS_COMPONENT, AXIS_SPACE, AXIS_SPACE}};
    if (n->writer == TIFF_IMAGEJ && s->files.count == 0 && n->images > s->all_pages)
        return fail(STATUS_INPUT,
                    "%s: holds %" PRId64 " images, but describes %" PRId64
                    " of them, as ImageJ does beyond 4 GiB; save it as raw data, or in parts",
                    s->request->path, n->images, s->all_pages);
    const int64_t channels = n->sizes[TIFF_CHANNELS], slices = n->sizes[TIFF_SLICES], frames = n->sizes[TIFF_FRAMES];
    const int is_series = n->writer != TIFF_PLAIN && s->files.count == 0 && s->shape.samples == 1 &&
                          channels * slices * frames == s->all_pages && channels * slices > 1;
    const int takes_frames = is_series && slices == 1;
    if (n->writer == TIFF_OME && s->files.count == 0 && !is_series && n->images != s->all_pages * s->shape.samples)
        dataset_notice(out,
                       "OME-TIFF of %" PRId64 " channels, %" PRId64 " slices and %" PRId64 " times, but %" PRId64
                       " pages: these are taken as slices, as they come",
                       channels, slices, frames, s->all_pages);
    if (!is_series) {
        stored->size[stored->count] = s->all_pages;
        stored->role[stored->count++] = AXIS_SPACE;
    }
    for (int axis = 0; axis < TIFF_DIMENSIONS && is_series; axis++) {
        const int dimension = n->order[axis];
        if (takes_frames && dimension == TIFF_SLICES) continue;
        stored->size[stored->count] = n->sizes[dimension];
        stored->role[stored->count++] = takes_frames && dimension == TIFF_FRAMES ? AXIS_SPACE : roles[dimension];
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
    if (!status) status = list_axes(s, &stored, out);
    if (!status) status = layout_make(request->path, &stored, s->shape.element, request, &l);
    for (int axis = 0; axis < 3; axis++) out->blocks->matrix[axis][axis] = s->notes.spacing[axis];
    if (s->notes.units && !request->has_spacing) dataset_set_units(out, s->notes.units);
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
    int64_t gap[2];
    if (!status && slices_have_gap(&s.files, gap))
        dataset_notice(out,
                       "has slices %" PRId64 " and %" PRId64 ", but none between them: slices are taken as equally "
                       "far apart",
                       gap[0], gap[1]);
    if (!status) status = read_stack(&s, out);
    slices_release(&s.files);
    free(s.pages);
    return status;
}
