/* array_memory.h - memory for samples and other arrays; what does not fit is in a temporary file */
#ifndef ARRAY_MEMORY_H
#define ARRAY_MEMORY_H

#include <stdint.h>

/* To be freed by samples_free: page-aligned, so that devices can use it in place, and in huge pages where large, since
 * new small ones cost more than reading a file. Arrays larger than the memory that is available lie in a file without a
 * name (temporary_file.h). NULL where there is no room, with the message of STATUS_FAILED where that file has none. */
void *samples_allocate(uint64_t bytes);
void samples_free(void *samples);

/* Of an address in an array that lies in a file: the bytes from there to the array's end; else 0. Pages of it may be
 * given back (MADV_DONTNEED) and are read again when they are needed. */
uint64_t samples_in_file(const void *address);

#endif
