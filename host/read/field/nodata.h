/*
 * nodata.h - the missing value as it is typed, among values as they are stored
 *
 * A person types what a program prints, or what a standard says: -999.9, 1e20, -3.4028235e+38. Float values hold the
 * nearest float to such a number, so it is rounded to that before it is compared; other types compare it as it is.
 * Files that scale their values give slope and intercept as floats: -32768 by a slope of 0.1 is -3276.800048828125 in
 * double. Such values and the number are both rounded to float.
 */
#ifndef NODATA_H
#define NODATA_H

#include "tetracubes.h"

#include <math.h>

/* What values of the type are compared with. 0 where none of them can be equal to it; *value is then as typed. */
int nodata_of_type(tc_type type, double typed, double *value);

/* Whether values that were scaled in the precision of float are that number as it is typed. */
static inline int nodata_is_scaled(double value, double typed) {
    return value == typed || (isfinite((float)typed) && (float)value == (float)typed);
}

/* The first of count values that equals it, as nodata_of_type gives it; count where none does. */
uint64_t nodata_find(tc_type type, const void *values, uint64_t count, double value);

#endif
