/*
 * complex_check.h - how the tetrahedra of a complex meet in faces, from the complex alone
 *
 * The check does not depend on cells or on how they were cut. In a conforming, oriented complex two tetrahedra pass
 * their common face in opposite directions. Where both pass it in the same direction, they lie on the same side of it:
 * they overlap, and the two triangles of a surface that meet in the face have opposite windings.
 */
#ifndef COMPLEX_CHECK_H
#define COMPLEX_CHECK_H

#include <stdint.h>

/* Invalid tetrahedra are counted as such and left out of every other figure. */
typedef struct complex_faces {
    uint64_t folded_faces;       /* of two tetrahedra that pass them in the same direction */
    uint64_t nonmanifold_faces;  /* of three tetrahedra or more */
    uint64_t invalid_tetrahedra; /* a point out of range, or the same twice */
} complex_faces;

/* On which side of a surface a point is. */
typedef enum point_side { SIDE_OUTSIDE, SIDE_INSIDE, SIDE_MISSING } point_side;

/* tetrahedra: 4 points each. sides: NULL, or a point_side for every point: tetrahedra with a missing point are then
 * left out, and only faces with points on both sides count. Returns 0, or STATUS_FAILED with its message (failure.h)
 * where memory runs out. Takes 32 bytes per tetrahedron and 8 per point. */
int complex_check(uint64_t point_count, const uint32_t *tetrahedra, uint64_t tetrahedron_count, const uint8_t *sides,
                  complex_faces *result);

#endif
