/* vtk_legacy.h - the reader of VTK legacy files (.vtk); read_formats.h says what a reader does */
#ifndef VTK_LEGACY_H
#define VTK_LEGACY_H

#include "dataset/dataset.h"
#include "dataset/request.h"
#include "file/mapping.h"

int vtk_legacy_read(const read_request *request, const mapping *file, dataset *out);

#endif
