/* vtk_xml_text.h - values that a VTK XML file has as text */
#ifndef VTK_XML_TEXT_H
#define VTK_XML_TEXT_H

#include "vtk_xml/vtk_xml_header.h"

/* Writes the first `count` values of an array that is text, in this machine's byte order; label: file and array, for
 * messages. *more: whether the array holds more than that. */
int vtk_xml_take_text(const xml_array *array, uint64_t count, const char *label, void *to, int *more);

#endif
