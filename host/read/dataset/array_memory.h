/* array_memory.h - memory for samples and other arrays */
#ifndef ARRAY_MEMORY_H
#define ARRAY_MEMORY_H

#include <stdint.h>

/* To be freed: page-aligned, so that devices can use it in place, and in huge pages where large, since new small ones
 * cost more than reading a file. NULL where there is none. */
void *samples_allocate(uint64_t bytes);

#endif
