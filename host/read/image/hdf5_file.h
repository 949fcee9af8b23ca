/*
 * hdf5_file.h - one dataset of an HDF5 file, through libhdf5
 *
 * Links to other files and samples that lie in other files are refused, as a file may come from anywhere.
 */
#ifndef HDF5_FILE_H
#define HDF5_FILE_H

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
} hdf5_file;

/* Opens the dataset of that name, or, where it is NULL, the only one that may be a volume. 0, or a status with its
 * message; to be closed in any case. */
int hdf5_open(hdf5_file *h, const char *path, const char *name);

/* Reads all samples, as they are stored, of a dataset in chunks, or one that is a part of its description. */
int hdf5_load(const hdf5_file *h, void *to);
int hdf5_load_chunks(const hdf5_file *h, unsigned char *to);

void hdf5_close(hdf5_file *h);

#endif
