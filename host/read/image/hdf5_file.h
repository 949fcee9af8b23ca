/*
 * hdf5_file.h - one dataset of an HDF5 file, through libhdf5, which reads the file where it is mapped
 *
 * Links to other files and samples that lie in other files are refused, as a file may come from anywhere.
 */
#ifndef HDF5_FILE_H
#define HDF5_FILE_H

#include "file/mapping.h"
#include "image/array_axes.h"

#include <hdf5.h>

typedef struct hdf5_file {
    const char *path; /* for messages */
    hid_t file, dataset;
    H5E_auto2_t report; /* the program's way to report errors, while ours is none */
    void *report_data;

    int dimension;
    int64_t shape[ARRAY_AXES_MOST];
    int element;
    int is_swapped; /* the other byte order than this machine's */
    H5D_layout_t layout;
    uint64_t start;        /* of samples that lie in the file one behind the other */
    uint64_t stored_bytes; /* of the file, that hold them */
    double matrix[3][4];   /* by the attribute element_size_um, or as an image of VTKHDF; else the identity */
    int is_in_um;          /* by that attribute */
} hdf5_file;

/* Opens the dataset of that name, or, where it is NULL, the only one that may be a volume. The
 * mapping, of the file of that path, has to outlive it. 0, or a status with its
 * message; to be closed in any case. */
int hdf5_open(hdf5_file *h, const char *path, const mapping *file, const char *name);

/* Reads all samples, as they are stored, of a dataset in chunks, or one that is a part of its description. */
int hdf5_load(const hdf5_file *h, void *to);
int hdf5_load_chunks(const hdf5_file *h, unsigned char *to);

void hdf5_close(hdf5_file *h);

/* For files of several arrays: the file alone, and one array of it, which takes the place of the one before. An array
 * without a value has stored_bytes 0. */
int hdf5_open_file(hdf5_file *h, const char *path, const mapping *file);
int hdf5_open_array(hdf5_file *h, const char *name);

/* Opens a group, links to other files not followed; below 0 where there is none. To be closed by H5Gclose. */
hid_t hdf5_open_group(const hdf5_file *h, const char *name);

/* Whether the group has a link of that name. */
int hdf5_has(hid_t group, const char *name);

/* An attribute that is text of a fixed length; "" where there is none. */
enum { HDF5_TEXT_BYTES = 256 };
void hdf5_read_text(hid_t object, const char *name, char text[HDF5_TEXT_BYTES]);

/* An attribute of so many numbers. Returns 0, and leaves the values, where there is none. */
int hdf5_read_numbers(hid_t object, const char *name, double *values, int count);

/* STATUS_INPUT with what libhdf5 says of its last failure. */
int hdf5_fail(const hdf5_file *h, const char *what);

#endif
