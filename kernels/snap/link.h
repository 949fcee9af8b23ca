/*
 * link.h - the samples that an edge of the split joins to a sample, its link: read by both compilers
 *
 * A sample whose i + j + k is odd has the six along the axes; an even one has the twelve across faces besides. With the
 * triangles between them they make a sphere around the sample, an octahedron or one with 32 faces.
 */
#ifndef LINK_H
#define LINK_H

/* SAMPLE(x, y, z): the steps from a sample to one of its link. First along the axes, index 2 * axis + upwards; then
 * across the faces xy, xz and yz, index 6 + 4 * face + upwards along the first axis + 2 * upwards along the second. */
#define LINK_SAMPLES(SAMPLE)                                                                                           \
    SAMPLE(-1, 0, 0)                                                                                                   \
    SAMPLE(1, 0, 0)                                                                                                    \
    SAMPLE(0, -1, 0)                                                                                                   \
    SAMPLE(0, 1, 0)                                                                                                    \
    SAMPLE(0, 0, -1)                                                                                                   \
    SAMPLE(0, 0, 1)                                                                                                    \
    SAMPLE(-1, -1, 0)                                                                                                  \
    SAMPLE(1, -1, 0)                                                                                                   \
    SAMPLE(-1, 1, 0)                                                                                                   \
    SAMPLE(1, 1, 0)                                                                                                    \
    SAMPLE(-1, 0, -1)                                                                                                  \
    SAMPLE(1, 0, -1)                                                                                                   \
    SAMPLE(-1, 0, 1)                                                                                                   \
    SAMPLE(1, 0, 1)                                                                                                    \
    SAMPLE(0, -1, -1)                                                                                                  \
    SAMPLE(0, 1, -1)                                                                                                   \
    SAMPLE(0, -1, 1)                                                                                                   \
    SAMPLE(0, 1, 1)

enum { LINK_ODD = 6, LINK_EVEN = 18 }; /* samples of a link */

/* Samples of one colour are in no link of each other, so they may be snapped at once. Even samples have colours 0 to 3,
 * by whether j and k are odd; odd samples have colour 4 and come last. */
enum { COLOUR_ODD = 4, COLOURS = 5 };
#define COLOUR_EVEN(odd_j, odd_k) (2 * (odd_j) + ((odd_j) ^ (odd_k)))

#endif
