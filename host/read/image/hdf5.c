/*
 * hdf5.c - datasets of HDF5 files: file.h5:/path/to/dataset, or the only one that may be a volume
 *
 * Source: "HDF5 Reference Manual", The HDF Group. Axes are those of numpy's arrays (array_axes.h). Samples that lie in
 * the file one behind the other are mapped; chunks are read through libhdf5, with its filters.
 */
#include "image/image.h"

#include "dataset/array_memory.h"
#include "dataset/world.h"
#include "exit_status.h"
#include "failure.h"
#include "file/unpack.h"
#include "image/hdf5_file.h"
#include "image/source.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RATIO_MOST = 50000 }; /* so many bytes of samples to a stored one, as chunks that were never written are zeros */

static int load(const read_request *request, const hdf5_file *h, const axes *stored, const layout *l, dataset *out) {
    const source from = {
        .header_path = h->path, .start = h->start, .goes_on = 1, .axes = stored, .axes_per_file = stored->count};
    if (h->layout == H5D_CONTIGUOUS) return source_load(request, &from, l, out);
    int status = unpack_ratio_check(h->path, h->stored_bytes, l->bytes, RATIO_MOST);
    if (status) return status;
    void *samples = samples_allocate(l->bytes);
    if (!samples)
        return fail(STATUS_FAILED, "%s: needs %" PRIu64 " bytes of memory, which are not to be had", h->path, l->bytes);
    if (!(status = hdf5_load(h, samples))) return source_take(request, &from, l, samples, out);
    samples_free(samples);
    return status;
}

int hdf5_read(const read_request *request, const mapping *file, dataset *out) {
    hdf5_file h;
    axes stored;
    layout l;
    int status = dataset_image_begin(out);
    if (status) return status;
    status = hdf5_open(&h, request->path, file, request->inside);
    if (!status) {
        array_axes_list(h.shape, h.dimension, 0, &stored);
        status = layout_make(h.path, &stored, h.element, request, &l);
    }
    if (!status) memcpy(out->blocks->matrix, h.matrix, sizeof h.matrix);
    if (!status) status = world_complete(request, h.path, out->blocks->matrix);
    if (!status) {
        l.swapped = h.is_swapped;
        snprintf(out->format, sizeof out->format, "HDF5");
        if (h.is_in_um && !request->has_spacing) dataset_set_units(out, "um");
        status = load(request, &h, &stored, &l, out);
    }
    hdf5_close(&h);
    return status;
}
