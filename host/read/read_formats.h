/*
 * read_formats.h - the table of formats that are read (host/README.md says what a new one needs)
 */
#ifndef READ_FORMATS_H
#define READ_FORMATS_H

#include "dataset/dataset.h"
#include "dataset/request.h"
#include "file/libraries.h"
#include "file/mapping.h"

enum { FORMAT_NOTES = 5, FORMATS_TEXT = 512 };

typedef struct read_format {
    const char *name;     /* for lists and messages */
    enum library library; /* without which there is no reader */
    struct {
        const char *text;
        enum library library;
    } notes[FORMAT_NOTES]; /* shown in parentheses where their library was found; ends with one without text */
    const char *endings;   /* of its files, with a bar before, between and after them */

    /* Whether the file begins as the format does; NULL: the format has no certain beginning. */
    int (*begins)(const mapping *file);

    /* Given the mapped file, fills a zeroed dataset; on failure the caller releases it. NULL: without the library. */
    int (*read)(const read_request *request, const mapping *file, dataset *out);
    const char *instead; /* what helps where that is NULL */
    int has_frames;      /* request->frame is the reader's; grids have one frame */
    int unpacks;         /* the reader unpacks files that are packed as a whole */
    int may_be_half;     /* of two inputs, Plot3D's grid and solution, the first may look like this */
} read_format;

extern const read_format read_formats[];
extern const int read_format_count;

/* The rows that are chosen without looking at the table. */
extern const read_format *const raw_format, *const plot3d_format, *const tiff_format, *const hdf5_format;

/* The format by the first bytes, or by the ending, .gz behind it or not; NULL where that tells none. */
const read_format *read_format_of_content(const mapping *file);
const read_format *read_format_of_ending(const char *path);

/* The formats this program was built with, one line: "raw, NRRD (gzip, bzip2), MetaImage, NIfTI". Returns text. */
const char *read_formats_text(char text[FORMATS_TEXT]);

int path_ends_with(const char *path, const char *ending);
int file_starts_with(const mapping *file, const char *text);

#endif
