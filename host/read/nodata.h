/*
 * nodata.h - the missing value as it is typed, among values as they are stored
 *
 * A person types what a program prints, or what a standard says: -999.9, 1e20, -3.4028235e+38. Float values hold the
 * nearest float to such a number, so it is rounded to that before it is compared; other types compare it as it is.
 */
#ifndef NODATA_H
#define NODATA_H

#include "tetracubes.h"

/* What values of the type are compared with. 0 where none of them can be equal to it; *value is then as typed. */
int nodata_of_type(tc_type type, double typed, double *value);

/* The first of count values that equals it, as nodata_of_type gives it; count where none does. */
uint64_t nodata_find(tc_type type, const void *values, uint64_t count, double value);

#endif
