/*
 * method.h - what the host knows of the methods of structured grids (methods.h in kernels is their list)
 */
#ifndef METHOD_H
#define METHOD_H

#include "grid/tables.h"
#include "methods.h"

typedef struct method_row {
    const char *name;
    int vertex_types; /* the first so many of enum vertex_type */
    cases_derive *derive;
} method_row;

extern const method_row methods[METHOD_COUNT]; /* by tc_method */

#endif
