#include "dataset/cell_types.h"

#include <stddef.h>

static const struct {
    const char *name;
    int dimension, points;
} types[256] = {
    [0] = {"empty cell", 0, 0},
    [1] = {"vertex", 0, 0},
    [2] = {"poly-vertex", 0, 0},
    [3] = {"line", 1, 0},
    [4] = {"poly-line", 1, 0},
    [5] = {"triangle", 2, 0},
    [6] = {"triangle strip", 2, 0},
    [7] = {"polygon", 2, 0},
    [8] = {"pixel", 2, 0},
    [9] = {"quadrilateral", 2, 0},
    [10] = {"tetrahedron", 3, 4},
    [11] = {"voxel", 3, 8},
    [12] = {"hexahedron", 3, 8},
    [13] = {"wedge", 3, 6},
    [14] = {"pyramid", 3, 5},
    [15] = {"pentagonal prism", 3, 10},
    [16] = {"hexagonal prism", 3, 12},
    [21] = {"quadratic edge", 1, 0},
    [22] = {"quadratic triangle", 2, 0},
    [23] = {"quadratic quadrilateral", 2, 0},
    [24] = {"quadratic tetrahedron", 3, 10},
    [25] = {"quadratic hexahedron", 3, 20},
    [26] = {"quadratic wedge", 3, 15},
    [27] = {"quadratic pyramid", 3, 13},
    [28] = {"biquadratic quadrilateral", 2, 0},
    [29] = {"triquadratic hexahedron", 3, 27},
    [30] = {"quadratic-linear quadrilateral", 2, 0},
    [31] = {"quadratic-linear wedge", 3, 12},
    [32] = {"biquadratic-quadratic wedge", 3, 18},
    [33] = {"biquadratic-quadratic hexahedron", 3, 24},
    [34] = {"biquadratic triangle", 2, 0},
    [35] = {"cubic line", 1, 0},
    [36] = {"quadratic polygon", 2, 0},
    [37] = {"triquadratic pyramid", 3, 19},
    [41] = {"convex point set", 3, 0},
    [42] = {"polyhedron", 3, 0},
    [51] = {"parametric curve", 1, 0},
    [52] = {"parametric surface", 2, 0},
    [53] = {"parametric triangular surface", 2, 0},
    [54] = {"parametric quadrilateral surface", 2, 0},
    [55] = {"parametric tetrahedral region", 3, 0},
    [56] = {"parametric hexahedral region", 3, 0},
    [60] = {"higher-order edge", 1, 0},
    [61] = {"higher-order triangle", 2, 0},
    [62] = {"higher-order quadrilateral", 2, 0},
    [63] = {"higher-order polygon", 2, 0},
    [64] = {"higher-order tetrahedron", 3, 0},
    [65] = {"higher-order wedge", 3, 0},
    [66] = {"higher-order pyramid", 3, 0},
    [67] = {"higher-order hexahedron", 3, 0},
    [68] = {"Lagrange curve", 1, 0},
    [69] = {"Lagrange triangle", 2, 0},
    [70] = {"Lagrange quadrilateral", 2, 0},
    [71] = {"Lagrange tetrahedron", 3, 0},
    [72] = {"Lagrange hexahedron", 3, 0},
    [73] = {"Lagrange wedge", 3, 0},
    [74] = {"Lagrange pyramid", 3, 0},
    [75] = {"Bezier curve", 1, 0},
    [76] = {"Bezier triangle", 2, 0},
    [77] = {"Bezier quadrilateral", 2, 0},
    [78] = {"Bezier tetrahedron", 3, 0},
    [79] = {"Bezier hexahedron", 3, 0},
    [80] = {"Bezier wedge", 3, 0},
    [81] = {"Bezier pyramid", 3, 0},
};

const char *cell_type_name(uint8_t type) { return types[type].name; }

int cell_type_dimension(uint8_t type) { return types[type].dimension; }

int cell_type_points(uint8_t type) { return types[type].points; }

int cell_type_corners(uint8_t type) {
    switch (type) {
    case 24: /* quadratic: points on the edges and faces follow */
        return 4;
    case 25:
    case 29:
    case 33:
        return 8;
    case 26:
    case 31:
    case 32:
        return 6;
    case 27:
    case 37:
        return 5;
    default:
        return cell_type_points(type);
    }
}
