/*
 * raw.c - samples without a header: dims, type, byte order and spacing come from the command line
 *
 * The file must be exactly as long as that makes it, so that a wrong option is noticed. Large files are not read: they
 * are mapped, and used in place where the samples are native and aligned.
 */
#include "image/image.h"

#include "exit_status.h"
#include "failure.h"
#include "image/source.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#define TYPE_BEHIND_BAR(type, name, ...) "|" #name

static int check_options(const read_request *request) {
    const int64_t *d = request->dims;
    if (!d[0] && !d[1] && !d[2])
        return fail(STATUS_USAGE, "%s: raw data needs its dimensions; give --dims NX,NY,NZ", request->path);
    if (d[0] < 1 || d[1] < 1 || d[2] < 1)
        return fail(STATUS_USAGE, "--dims %" PRId64 ",%" PRId64 ",%" PRId64 ": each must be at least 1", d[0], d[1],
                    d[2]);
    if (request->type < 0 || request->type >= SAMPLE_TYPE_COUNT)
        return fail(STATUS_USAGE, "%s: raw data needs its type; give --type %s", request->path,
                    &SAMPLE_TYPES(TYPE_BEHIND_BAR)[1]);
    for (int i = 0; i < 3; i++) {
        if (!isfinite(request->spacing[i]) || request->spacing[i] == 0)
            return fail(STATUS_USAGE, "--spacing: %g is no distance; give three finite numbers other than 0",
                        request->spacing[i]);
        if (!isfinite(request->origin[i]))
            return fail(STATUS_USAGE, "--origin: %g is no coordinate; give three finite numbers", request->origin[i]);
    }
    return 0;
}

int raw_read(const read_request *request, const mapping *file, dataset *out) {
    int status = check_options(request);
    if (status || (status = dataset_image_begin(out))) return status;

    axes stored = {.count = 3};
    for (int i = 0; i < 3; i++) stored.size[i] = request->dims[i];
    layout l;
    if ((status = layout_make(request->path, &stored, request->type, request, &l))) return status;
    l.swapped = request->big_endian == (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);

    uint64_t expected;
    if (request->raw_else && l.bytes != file->size)
        return fail(STATUS_INPUT,
                    "%s: its format is not known, and it is no raw volume of %" PRId64 " x %" PRId64 " x %" PRId64
                    " samples of one byte, as it is %zu bytes long",
                    request->path, request->dims[0], request->dims[1], request->dims[2], file->size);
    if (request->skip > INT64_MAX || __builtin_add_overflow(request->skip, l.bytes, &expected) ||
        expected != file->size)
        return fail(STATUS_INPUT,
                    "%s: is %zu bytes long, but --skip, --dims and --type make %" PRIu64 " + %" PRIu64
                    " bytes; correct the options",
                    request->path, file->size, request->skip, l.bytes);
    source from = {.header_path = request->path, .start = request->skip, .axes = &stored, .axes_per_file = 3};
    snprintf(out->format, sizeof out->format, "raw");
    for (int i = 0; i < 3; i++) {
        out->blocks->matrix[i][i] = request->spacing[i];
        out->blocks->matrix[i][3] = request->origin[i];
    }
    return source_load(request, &from, &l, out);
}
