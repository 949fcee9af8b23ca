/* vtk_parallel.h - the reader of VTK XML files that name others: pieces of one grid (.pvti .pvtr .pvts .pvtu), blocks
 * (.vtm .vtmb); read_formats.h says what a reader does */
#ifndef VTK_PARALLEL_H
#define VTK_PARALLEL_H

#include "dataset/dataset.h"
#include "dataset/request.h"
#include "file/mapping.h"

int vtk_parallel_read(const read_request *request, const mapping *file, dataset *out);

#endif
