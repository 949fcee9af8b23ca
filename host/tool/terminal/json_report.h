/*
 * json_report.h - a command's report as one JSON object, built with jansson
 *
 * Numbers are printed so that they can be typed back: the object has one number of digits, 15, or as many more as one
 * of its numbers needs for that. Numbers that JSON cannot hold (NaN, infinities) become null.
 *
 * Steps of building need not be checked: where one fails for lack of memory, printing fails.
 */
#ifndef JSON_REPORT_H
#define JSON_REPORT_H

#include <jansson.h>
#include <stdint.h>

/* To be called before anything is built. */
void json_report_begin(void);

/* A part of the report could not be made for lack of memory. */
void json_report_spoil(void);

/* A path or name; bytes that are no UTF-8 become ?. */
json_t *string_json(const char *text);

/* A number, or null where it is not finite. */
json_t *real_json(double value);

/* Milliseconds to the microsecond. */
json_t *ms_json(double ms);

/* An array of count numbers. */
json_t *reals_json(const double *values, int count);

json_t *count_json(uint64_t count);

/* An array of three integers. */
json_t *integers_json(const int64_t values[3]);

/* Prints and releases the object, NULL where building it failed. Returns 0 or STATUS_FAILED. */
int json_report_print(json_t *object);

#endif
