/*
 * number_text.h - numbers of text as Fortran writes them too
 *
 * Beyond C's: exponents marked by D or Q, or, of three digits behind a decimal point, by nothing ("0.1-101"); and
 * columns of fixed width that leave no blank between numbers: "-1.00000E+00-2.00000E+00" is two, as are
 * "1.0000E+002.0000E+00", since no exponent has a decimal point, "1-2" and "NaN-1.0". Without exponents
 * positive numbers that touch ("1.0002.000") cannot be told apart and are refused.
 */
#ifndef NUMBER_TEXT_H
#define NUMBER_TEXT_H

#include <stddef.h>

/* Copies the number that the `length` characters of a word begin with to c_word, in C's form, zero-ended, and returns
 * how many characters it has there: fewer than `length` where another number follows it in the word. 0 where the word
 * does not begin so, or the number takes `bytes` or more; c_word is then "". */
size_t number_copy(const char *word, size_t length, char *c_word, size_t bytes);

#endif
