#include "tables/method.h"

#include "tetracubes.h"

#include <stddef.h>

#define METHOD_ROW(name, types, most, usual) {#name, types, name##_cases_derive, name##_caps_derive},
const method_row methods[METHOD_COUNT] = {METHODS(METHOD_ROW)};

#define METHOD_FITS(name, types, most, usual)                                                                          \
    _Static_assert((types) <= VERTEX_TYPES_MOST && (usual) <= (most) && (most) <= CUBE_TRIANGLES_MAX, #name);
METHODS(METHOD_FITS)

const char *tc_method_name(tc_method method) { return (unsigned)method < METHOD_COUNT ? methods[method].name : NULL; }
