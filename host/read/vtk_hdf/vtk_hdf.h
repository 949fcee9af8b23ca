/* vtk_hdf.h - the reader of HDF5 files: UnstructuredGrid of VTKHDF; all others are images, which image/hdf5.c reads */
#ifndef VTK_HDF_H
#define VTK_HDF_H

#include "dataset/dataset.h"
#include "dataset/request.h"
#include "file/mapping.h"

int vtk_hdf_read(const read_request *request, const mapping *file, dataset *out);

#endif
