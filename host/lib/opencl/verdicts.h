/*
 * verdicts.h - verdicts of trials, kept in the cache: a file of four lines per device, driver and kind of kernels
 *
 * The first three lines are the key, compared whole; the fourth is the verdict with its reason. What is not so in every
 * byte is as good as none. Files of drivers and versions that are gone are never read again.
 */
#ifndef VERDICTS_H
#define VERDICTS_H

#include "opencl/context.h"

typedef struct kept_verdict {
    tc_verdict verdict; /* TC_VERDICT_NONE: none is kept */
    char reason[600];
} kept_verdict;

/* Of the kernels that the context builds now, by the number of their kind. */
void verdict_read(const tc_context *context, unsigned kind, kept_verdict *out);
void verdict_write(const tc_context *context, unsigned kind, const kept_verdict *verdict);

/* The file that holds it, for a message; "" where there is no cache. */
void verdict_path(const tc_context *context, unsigned kind, char *path, size_t bytes);

#endif
