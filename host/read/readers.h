/*
 * readers.h - one function per format, given the mapped file
 *
 * They fill a zeroed dataset; on failure the caller releases it.
 */
#ifndef READERS_H
#define READERS_H

#include "dataset.h"
#include "mapping.h"
#include "request.h"

int raw_read(const read_request *request, const mapping *file, dataset *out);
int nrrd_read(const read_request *request, const mapping *file, dataset *out);
int metaimage_read(const read_request *request, const mapping *file, dataset *out);
int nifti_read(const read_request *request, const mapping *file, dataset *out);

int vtk_legacy_read(const read_request *request, const mapping *file, dataset *out); /* "# vtk DataFile Version" */
int vtk_xml_read(const read_request *request, const mapping *file, dataset *out);    /* .vti .vtr .vts .vtu */
int plot3d_read(const read_request *request, const mapping *grid, dataset *out);     /* opens request->path2 itself */

#endif
