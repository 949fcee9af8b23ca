/* vtk_hdf_array.h - rows of an array of a VTKHDF file, brought to where a dataset keeps their values */
#ifndef VTK_HDF_ARRAY_H
#define VTK_HDF_ARRAY_H

#include "dataset/dataset.h"
#include "file/mapping.h"
#include "image/hdf5_file.h"

typedef struct hdf_reader {
    hdf5_file h;
    mapping file;
    dataset *out;   /* whose memory values take */
    int uses_file;  /* whether any values are used in the mapped file */
    uint64_t taken; /* bytes of the file that arrays were made of so far */
} hdf_reader;

/* Rows of an array, from first on; count below 0: all. */
typedef struct hdf_rows {
    int64_t first, count;
} hdf_rows;

/* An array whose sizes have been compared with what the file holds. */
typedef struct hdf_values {
    const void *values; /* of the stored type, in this machine's byte order */
    int64_t rows;
    int components, element;
} hdf_values;

/* The rows of an array of that name, which has to have them. STATUS_INPUT where it has not, or is damaged. */
int hdf_load(hdf_reader *r, const char *name, hdf_rows rows, hdf_values *out);

/* The same of integers, as int64, one to a row. */
int hdf_load_integers(hdf_reader *r, const char *name, hdf_rows rows, const int64_t **values, int64_t *count);

#endif
