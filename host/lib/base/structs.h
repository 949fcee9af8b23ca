/*
 * structs.h - public structs that callers of older headers pass: their size, the first member, says what they have
 */
#ifndef STRUCTS_H
#define STRUCTS_H

#include "tetracubes.h"

/* Copies a struct of any older size over defaults already in *to; TC_ERROR_ARGUMENT, naming what, for NULL, for one
 * that was never initialised and for one of a newer library. */
tc_status options_take(void *to, size_t to_bytes, const void *from, const char *what);

/* The other way: zeroes a struct of the caller's, of any older size, but for its size; fails like options_take. */
tc_status result_begin(void *out, size_t known_bytes, const char *what);

/* Copies as much of *from as the struct of the caller's has, but for its size. */
void result_give(void *out, const void *from);

#endif
