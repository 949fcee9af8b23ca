/*
 * verdicts.h - verdicts of trials, kept in the cache: a file of four lines per device, driver and kind of kernels
 *
 * The first three lines are the key, compared whole; the fourth is the verdict with its reason. A file that differs
 * from this in any byte is ignored. Files of drivers and versions that are gone are never read again.
 */
#ifndef VERDICTS_H
#define VERDICTS_H

#include "opencl/context.h"

typedef struct kept_verdict {
    tc_verdict verdict; /* TC_VERDICT_NONE: none is kept */
    char reason[600];
} kept_verdict;

/* Reads the verdict on the kernels of a kind, by its number, in the variant that the context builds now. */
void verdict_read(const tc_context *context, unsigned kind, kept_verdict *out);
void verdict_write(const tc_context *context, unsigned kind, const kept_verdict *verdict);

/* The file that holds it, for a message; "" where there is no cache. */
void verdict_path(const tc_context *context, unsigned kind, char *path, size_t bytes);

#endif
