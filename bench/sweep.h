/* sweep.h - the cases that --sweep leaves out: too slow by rule, or too large for the memory that is free */
#ifndef SWEEP_H
#define SWEEP_H

#include "field.h"

/* Nonzero where the case is part of a sweep; the reference, which verifies it, decides what would take too long. */
int sweep_takes(const field *f, const int64_t dims[3], tc_type type);

/* Bytes of memory that can be had without taking them from others: three quarters of what Linux, and the control group
 * where there is one, say is available. UINT64_MAX where they do not say. */
uint64_t sweep_memory(void);

#endif
