/* vtk_xml.h - the reader of serial VTK XML files (.vti .vtr .vts .vtu); read_formats.h says what a reader does */
#ifndef VTK_XML_H
#define VTK_XML_H

#include "dataset/dataset.h"
#include "dataset/request.h"
#include "file/mapping.h"

int vtk_xml_read(const read_request *request, const mapping *file, dataset *out);

/* The same of a file of several, mapped, which is taken over also after a failure; no block where it has no points. */
int vtk_xml_read_piece(const read_request *request, mapping *own, dataset *out);

/* The matrix of an image: of ImageData's attributes, as the request changes it. */
int vtk_xml_matrix(const read_request *request, const double origin[3], const double spacing[3],
                   const double direction[9], double matrix[3][4]);

#endif
