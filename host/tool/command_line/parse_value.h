/* parse_value.h - the value of an option, from text */
#ifndef PARSE_VALUE_H
#define PARSE_VALUE_H

#include "option_table.h"
#include "option_values.h"

/* Puts the value into *o. Every value is checked here, as far as it can be without the input. Returns 0 or
 * a status with its text. */
int parse_value(const option *spec, const char *text, options *o);

#endif
