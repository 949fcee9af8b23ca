/* vtk_xml.h - the reader of VTK XML files (.vti .vtr .vts .vtu); read_formats.h says what a reader does */
#ifndef VTK_XML_H
#define VTK_XML_H

#include "dataset/dataset.h"
#include "dataset/request.h"
#include "file/mapping.h"

int vtk_xml_read(const read_request *request, const mapping *file, dataset *out);

#endif
