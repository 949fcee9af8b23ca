/* The names of the entry points, for the layer and the tests that use it. */
#include "layer.h"

const char *const entry_names[ENTRY_COUNT] = {
#define S(name, parameters, arguments)         "cl" #name,
#define O(type, name, parameters, arguments)   "cl" #name,
#define E(name, blocks, parameters, arguments) S(name, parameters, arguments)
    OPENCL_ENTRIES(S, O, E, O)
#undef S
#undef O
#undef E
};
