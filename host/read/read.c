/*
 * read.c - finds the format of a volume file, by its content first, then by its ending, and reads it; see volume.h
 */
#include "volume.h"

#include "exit_status.h"
#include "failure.h"
#include "readers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>

typedef int (*reader)(const read_request *request, const mapping *file, volume *out);

void read_request_init(read_request *request, const char *path) {
    *request = (read_request){.path = path, .type = -1, .spacing = {1, 1, 1}, .component = -1, .frame = -1};
}

const char *volume_formats(void) {
    return "raw, NRRD"
#if defined(HAVE_ZLIB) && defined(HAVE_BZIP2)
           " (gzip, bzip2)"
#elif defined(HAVE_ZLIB)
           " (gzip)"
#elif defined(HAVE_BZIP2)
           " (bzip2)"
#endif
           ", MetaImage"
#ifdef HAVE_ZLIB
           " (zlib)"
#endif
#ifdef HAVE_NIFTI
           ", NIfTI"
#ifdef HAVE_ZLIB
           " (gzip)"
#endif
#endif
        ;
}

static int ends_with(const char *path, const char *ending) {
    size_t length = strlen(path), tail = strlen(ending);
    return length > tail && strcasecmp(path + length - tail, ending) == 0;
}

static int starts_with(const mapping *file, const char *text) {
    size_t length = strlen(text);
    return file->size >= length && memcmp(file->bytes, text, length) == 0;
}

/* The size of the header, which begins every NIfTI header, in either byte order. */
static int begins_as_nifti(const mapping *file) {
    static const char sizes[4][4] = {{92, 1, 0, 0}, {0, 0, 1, 92}, {28, 2, 0, 0}, {0, 0, 2, 28}};
    for (int i = 0; i < 4; i++)
        if (file->size >= 348 && memcmp(file->bytes, sizes[i], 4) == 0) return 1;
    return 0;
}

#ifndef HAVE_NIFTI
int nifti_read(const read_request *request, const mapping *file, volume *out) {
    (void)file;
    (void)out;
    return fail(STATUS_INPUT, "%s: is NIfTI, which this program was built without (TETRACUBES_NIFTI); it reads %s",
                request->path, volume_formats());
}
#endif

static reader find_reader(const read_request *request, const mapping *file) {
    static const struct {
        const char *ending;
        reader read;
    } endings[] = {{".nrrd", nrrd_read},    {".nhdr", nrrd_read},    {".mha", metaimage_read}, {".mhd", metaimage_read},
                   {".nii", nifti_read},    {".nii.gz", nifti_read}, {".hdr", nifti_read},     {".img", nifti_read},
                   {".hdr.gz", nifti_read}, {".img.gz", nifti_read}, {".raw", raw_read}};
    const int64_t *d = request->dims;
    if (d[0] || d[1] || d[2] || request->type >= 0) return raw_read;
    if (starts_with(file, "NRRD0")) return nrrd_read;
    if (starts_with(file, "ObjectType") || starts_with(file, "NDims")) return metaimage_read;
    if (begins_as_nifti(file)) return nifti_read;
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        if (ends_with(request->path, endings[i].ending)) return endings[i].read;
    return NULL;
}

int volume_read(const read_request *request, volume *out) {
    *out = (volume){0};
    mapping file;
    int status = mapping_open(request->path, &file);
    if (status) return status;
    reader read = find_reader(request, &file);
    if (read)
        status = read(request, &file, out);
    else
        status =
            fail(STATUS_INPUT,
                 "%s: its format is not known; this program reads %s; for samples without a header give --dims and "
                 "--type",
                 request->path, volume_formats());
    mapping_close(&file);
    if (status) volume_release(out);
    return status;
}

void volume_release(volume *v) {
    if (v->mapping) munmap(v->mapping, v->mapping_bytes);
    free(v->allocation);
    *v = (volume){0};
}
