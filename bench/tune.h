/* tune.h - the launch parameters that are fastest on a device, found by trying them */
#ifndef TUNE_H
#define TUNE_H

#include "bench_options.h"

/* Tries them over the cases of the options, prints what it finds and has the library keep the best. Returns 0 or an
 * exit status with its message (failure.h); STATUS_CHECK where a mesh differs from the reference's. */
int tune_run(const bench_options *o);

#endif
