/*
 * program_cache.h - built programs, kept between processes in the cache folder (cache.h)
 */
#ifndef PROGRAM_CACHE_H
#define PROGRAM_CACHE_H

#include "opencl/context.h"

/* What a program is made from. */
typedef struct program_recipe {
    const char *source, *options;
} program_recipe;

/* The program, built for the context's device; NULL where the cache has none that the device takes. */
cl_program program_cache_load(const tc_context *context, const program_recipe *recipe);

/* Keeps the binary of a program built from source. After its kernels have run: implementations that specialise a kernel
 * for its launch (PoCL) put that code into the binary, too. */
void program_cache_store(const tc_context *context, const program_recipe *recipe, cl_program built);

#endif
