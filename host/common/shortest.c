/* shortest.c - see shortest.h */
#include "shortest.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Whole numbers of up to 15 digits are printed as such: 20, not 2e+01. */
static int is_plain(double value) { return value == floor(value) && fabs(value) < 1e15; }

number_text shortest_number(double value) {
    number_text number;
    snprintf(number.text, sizeof number.text, "%.0f", value);
    for (int digits = 1; digits <= 17 && !is_plain(value); digits++) {
        snprintf(number.text, sizeof number.text, "%.*g", digits, value);
        if (strtod(number.text, NULL) == value) break;
    }
    return number;
}

number_text shortest_coordinate(double value) {
    number_text number;
    if ((double)(float)value != value || is_plain(value)) return shortest_number(value);
    for (int digits = 1; digits <= 9; digits++) {
        snprintf(number.text, sizeof number.text, "%.*g", digits, value);
        if (strtof(number.text, NULL) == (float)value) break;
    }
    return number;
}
