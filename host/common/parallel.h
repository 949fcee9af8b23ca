/*
 * parallel.h - one function on several threads
 *
 * The work is divided by its own function: every thread takes the next share, under a lock or by an atomic counter,
 * until none is left. So all of it is done with any number of threads, and the number never shows in a result. All
 * threads have the floating-point environment of the caller.
 */
#ifndef PARALLEL_H
#define PARALLEL_H

#include <stdint.h>

/* Runs work(shared) on the calling thread and on as many others as processors and shares allow, and waits for all.
 * Fewer run where the system refuses threads. */
void parallel_run(uint64_t share_count, void (*work)(void *shared), void *shared);

#endif
