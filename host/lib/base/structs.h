/*
 * structs.h - public structs of callers with older headers: the first member, the size, tells which members exist
 */
#ifndef STRUCTS_H
#define STRUCTS_H

#include "tetracubes.h"

/* Copies a struct of any older size over defaults already in *to; TC_ERROR_ARGUMENT, naming what, for NULL, for one
 * that was never initialised and for one of a newer library. */
tc_status struct_copy_in(void *to, size_t to_bytes, const void *from, const char *what);

/* Zeroes a struct of the caller, of any older size, except for its size; fails like struct_copy_in. */
tc_status struct_clear(void *out, size_t known_bytes, const char *what);

/* Copies the members that the caller's struct has from *from, except for the size. */
void struct_copy_out(void *out, const void *from);

#endif
