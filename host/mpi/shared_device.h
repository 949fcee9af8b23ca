/* shared_device.h - %r in --device: each rank of a machine another device */
#ifndef SHARED_DEVICE_H
#define SHARED_DEVICE_H

#include <stddef.h>

enum { DEVICE_BYTES = 256 };

/* Writes the specification with the rank's number on its machine in place of %r. Where the machine has fewer devices of
 * that kind than ranks, they share them: *device_count is how many there are, else 0. Returns 0 or STATUS_USAGE. */
int shared_device_choose(const char *specification, int node_rank, int node_size, char out[DEVICE_BYTES],
                         int *device_count);

#endif
