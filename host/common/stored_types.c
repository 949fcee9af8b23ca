/* stored_types.c - see stored_types.h */
#include "stored_types.h"

#include <string.h>

#define NAMES(type, nrrd, metaimage, nifti, ply, vtk_legacy, vtk_xml)                                                  \
    [type] = {nrrd, metaimage, ply, vtk_legacy, vtk_xml},

const stored_names stored_types[ELEMENT_COUNT] = {STORED_NAMES(NAMES)};

int element_put_integer(int element, uint64_t absolute, int is_negative, void *to) {
    switch (element) {
#define PUT_CASE(type, name, c_type, least, most, ...)                                                                 \
    case type: {                                                                                                       \
        const c_type value = (c_type)(is_negative ? 0 - absolute : absolute);                                          \
        if (absolute > (is_negative ? 0 - (uint64_t)(least) : (uint64_t)(most))) return 0;                             \
        memcpy(to, &value, sizeof value);                                                                              \
        return 1;                                                                                                      \
    }
        STORED_INTEGERS(PUT_CASE)
#undef PUT_CASE
    default:
        return 0;
    }
}
