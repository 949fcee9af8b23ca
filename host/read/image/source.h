/*
 * source.h - where a header's samples lie: attached or in files of their own, raw, text, hexadecimal or compressed
 *
 * source_load compares what the header declares with what the files hold, then brings the samples: used in place in
 * the mapped file where they are one native, aligned, raw volume; else gathered into memory.
 */
#ifndef SOURCE_H
#define SOURCE_H

#include "dataset/dataset.h"
#include "dataset/layout.h"
#include "file/unpack.h"
#include "dataset/data_names.h"

enum { SKIP_FROM_END = -1 }; /* SKIP_FROM_END - n: n bytes follow the data */

typedef struct source {
    const char *header_path;
    encoding encoding;
    data_names files;  /* none: the data follows the header in the same file */
    uint64_t start;    /* in that file: where it follows */
    int goes_on;       /* the file has other data behind these, as it should */
    int64_t line_skip; /* lines to skip in each file */
    int64_t byte_skip; /* bytes to skip after these lines; SKIP_FROM_END and below: the data ends the file (raw only) */
    int64_t stream_skip; /* the same of the bytes that a compressed stream unpacks to */
    const axes *axes;    /* with several files: each holds the first axes_per_file axes, or a part of the last */
    int64_t axes_per_file;
} source;

/* Fills an image that dataset_image_begin has made and that has its matrix: samples and their memory, type, sizes,
 * frames; of the part that the request asks for (region.h). A notice says where files hold more than is used. */
int source_load(const read_request *request, const source *from, const layout *stored, dataset *out);

/* The same of an array that its format's library has brought into memory from samples_allocate, which is taken over. */
int source_take(const read_request *request, const source *from, const layout *stored, void *array, dataset *out);

#endif
