#include "grid/method.h"

#include "tetracubes.h"

#include <stddef.h>

#define METHOD_ROW(name, types, most, usual) {#name, types, name##_cases_derive},
const method_row methods[METHOD_COUNT] = {METHODS(METHOD_ROW)};

const char *tc_method_name(tc_method method) { return (unsigned)method < METHOD_COUNT ? methods[method].name : NULL; }
