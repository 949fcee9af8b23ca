/* magnitude.h - the Euclidean length of tuples of numbers */
#ifndef MAGNITUDE_H
#define MAGNITUDE_H

#include "tetracubes.h"

/* The type of lengths: f32 of u8, i8, u16, i16 and f32, which f32 holds exactly; f64 of the others. */
tc_type magnitude_type(tc_type type);

/* The lengths of `count` tuples, computed in double and rounded to magnitude_type; where f32 is too small for a length,
 * the greatest f32. Where a value of a tuple is not finite, neither is the length. */
void magnitude_of(tc_type type, const void *values, int components, uint64_t count, void *lengths);

#endif
