/* sweep.h - which cases --sweep leaves out: those that take too long, and those too large for the free memory */
#ifndef SWEEP_H
#define SWEEP_H

#include "field.h"

/* Nonzero where the case is part of a sweep. Left out is what would take the reference, which verifies it, too long. */
int sweep_takes(const field *f, const int64_t dims[3], tc_type type);

/* Bytes of memory that can be had without taking them from others: three quarters of what Linux, and the control group
 * where there is one, say is available. UINT64_MAX where they do not say. */
uint64_t sweep_memory(void);

#endif
