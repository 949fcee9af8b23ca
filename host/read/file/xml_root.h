/* xml_root.h - what kind of VTK XML a file is, told by its first element, before it is parsed */
#ifndef XML_ROOT_H
#define XML_ROOT_H

#include "file/mapping.h"

enum { XML_TYPE_BYTES = 48 };

/* The attribute type of the element VTKFile, after a prolog and comments if there are any: "PImageData". "" where it
 * has none. Returns 0 where the file does not begin so. */
int xml_root_type(const mapping *file, char type[XML_TYPE_BYTES]);

/* Whether such a file names others: pieces of one grid, or blocks. */
int xml_type_is_index(const char *type);

#endif
