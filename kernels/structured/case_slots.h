/*
 * case_slots.h - how kernel 2, where a work-item has a brick to itself, finds the vertices of a cube: read by both
 * compilers
 *
 * The table of vertex numbers has NUMBER_TYPES numbers for each sample, by the type of vertex. A cube needs some of
 * those of its eight samples. They are brought together in 32 slots, elements of two vectors, from which shuffles take
 * the corners of triangles; what the table of cases has for a corner is a slot. The upper half of the second vector has
 * vertices at samples alone.
 */
#ifndef CASE_SLOTS_H
#define CASE_SLOTS_H

/* SLOT(slot, x, y, z, type): of the sample at this offset in the cube. A sample with eight numbers uses seven; the
 * eighth is once more the number of the vertex at the next sample in x, so that one load brings both: */
#define SLOTS_OF_EIGHT(SLOT)                                                                                           \
    SLOT(0, 0, 0, 0, 0)                                                                                                \
    SLOT(1, 0, 0, 0, 1)                                                                                                \
    SLOT(2, 0, 0, 0, 2)                                                                                                \
    SLOT(3, 0, 0, 0, 3)                                                                                                \
    SLOT(4, 0, 0, 0, 4)                                                                                                \
    SLOT(5, 0, 0, 0, 5)                                                                                                \
    SLOT(6, 0, 0, 0, 6)                                                                                                \
    SLOT(7, 1, 0, 0, 6)                                                                                                \
    SLOT(8, 0, 1, 1, 0)                                                                                                \
    SLOT(9, 1, 0, 0, 1)                                                                                                \
    SLOT(10, 1, 0, 0, 2)                                                                                               \
    SLOT(11, 1, 1, 0, 2)                                                                                               \
    SLOT(12, 1, 0, 1, 1)                                                                                               \
    SLOT(13, 1, 0, 0, 5)                                                                                               \
    SLOT(14, 0, 1, 1, 6)                                                                                               \
    SLOT(15, 1, 1, 1, 6)                                                                                               \
    SLOT(16, 0, 1, 0, 0)                                                                                               \
    SLOT(17, 0, 0, 1, 1)                                                                                               \
    SLOT(18, 0, 1, 0, 2)                                                                                               \
    SLOT(19, 0, 0, 1, 3)                                                                                               \
    SLOT(20, 0, 1, 0, 4)                                                                                               \
    SLOT(21, 0, 0, 1, 0)                                                                                               \
    SLOT(22, 0, 1, 0, 6)                                                                                               \
    SLOT(23, 1, 1, 0, 6)                                                                                               \
    SLOT(27, 0, 0, 1, 6)                                                                                               \
    SLOT(28, 1, 0, 1, 6)

/* Where it has four: */
#define SLOTS_OF_FOUR(SLOT)                                                                                            \
    SLOT(0, 0, 0, 0, 0)                                                                                                \
    SLOT(1, 0, 0, 0, 1)                                                                                                \
    SLOT(2, 0, 0, 0, 2)                                                                                                \
    SLOT(3, 0, 0, 0, 3)                                                                                                \
    SLOT(4, 0, 1, 1, 0)                                                                                                \
    SLOT(5, 1, 0, 0, 1)                                                                                                \
    SLOT(6, 1, 0, 0, 2)                                                                                                \
    SLOT(7, 1, 0, 0, 3)                                                                                                \
    SLOT(8, 0, 1, 0, 0)                                                                                                \
    SLOT(10, 0, 1, 0, 2)                                                                                               \
    SLOT(11, 0, 1, 0, 3)                                                                                               \
    SLOT(14, 1, 1, 0, 2)                                                                                               \
    SLOT(15, 1, 1, 0, 3)                                                                                               \
    SLOT(16, 0, 0, 1, 0)                                                                                               \
    SLOT(17, 0, 0, 1, 1)                                                                                               \
    SLOT(19, 0, 0, 1, 3)                                                                                               \
    SLOT(21, 1, 0, 1, 1)                                                                                               \
    SLOT(23, 1, 0, 1, 3)                                                                                               \
    SLOT(27, 0, 1, 1, 3)                                                                                               \
    SLOT(31, 1, 1, 1, 3)

enum { CASE_SLOTS = 32 };

#endif
