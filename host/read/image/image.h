/* image.h - the readers of images, one function per format; read_formats.h says what a reader does */
#ifndef IMAGE_H
#define IMAGE_H

#include "dataset/dataset.h"
#include "dataset/request.h"
#include "file/mapping.h"

int raw_read(const read_request *request, const mapping *file, dataset *out);
int nrrd_read(const read_request *request, const mapping *file, dataset *out);
int metaimage_read(const read_request *request, const mapping *file, dataset *out);
int npy_read(const read_request *request, const mapping *file, dataset *out);
int tiff_read(const read_request *request, const mapping *file, dataset *out);
int hdf5_read(const read_request *request, const mapping *file, dataset *out);
int nifti_read(const read_request *request, const mapping *file, dataset *out);

#endif
