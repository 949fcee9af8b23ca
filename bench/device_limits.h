/* device_limits.h - the bandwidth of a device's memory: the physical limit that the benchmark compares with */
#ifndef DEVICE_LIMITS_H
#define DEVICE_LIMITS_H

#include "tetracubes.h"

/* In 10^9 bytes per second. */
typedef struct device_limits {
    double read_gbps, write_gbps;
} device_limits;

/* Measures on the context's own queue, about a second. Returns 0 or STATUS_FAILED with its message (failure.h). */
int device_limits_measure(tc_context *context, device_limits *out);

#endif
