/* plot3d.h - the reader of Plot3D files; read_formats.h says what a reader does */
#ifndef PLOT3D_H
#define PLOT3D_H

#include "dataset/dataset.h"
#include "dataset/request.h"
#include "file/mapping.h"

/* Opens request->path2 itself. */
int plot3d_read(const read_request *request, const mapping *grid, dataset *out);

#endif
