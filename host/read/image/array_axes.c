/* array_axes.c - what the axes of arrays are; see array_axes.h */
#include "image/array_axes.h"

enum { COMPONENTS_MOST = 4 };

static enum axis_role role_of(const int64_t *shape, int count, int axis) {
    const int last = count - 1, has_components = count == 5 || (count == 4 && shape[last] <= COMPONENTS_MOST);
    if (axis == last && has_components) return AXIS_COMPONENT;
    return axis == 0 && count - has_components == 4 ? AXIS_FRAME : AXIS_SPACE;
}

void array_axes_list(const int64_t *shape, int count, int is_fortran, axes *stored) {
    *stored = (axes){.count = count};
    for (int n = 0; n < count; n++) {
        const int axis = is_fortran ? n : count - 1 - n;
        stored->size[n] = shape[axis];
        stored->role[n] = role_of(shape, count, axis);
    }
}

void array_axes_turn(const int64_t *shape, int count, layout *l) {
    int space = 0;
    for (int axis = 0; axis < count; axis++) space += role_of(shape, count, axis) == AXIS_SPACE;
    for (int low = 0, high = space - 1; low < high; low++, high--) {
        const int64_t size = l->dims[low];
        const uint64_t stride = l->stride[low];
        l->dims[low] = l->dims[high];
        l->stride[low] = l->stride[high];
        l->dims[high] = size;
        l->stride[high] = stride;
    }
}
