/*
 * device.h - the OpenCL devices of this machine, and which of them a specification means
 */
#ifndef DEVICE_H
#define DEVICE_H

#include "opencl/opencl.h"

#include <stdbool.h>

typedef struct device_choice {
    cl_platform_id platform;
    cl_device_id device;
    int platform_index, device_index;
} device_choice;

/* specification: as tc_context_options.device, NULL for the default. */
tc_status device_choose(const char *specification, device_choice *choice);

/* The indices of a device among all of this machine; false where it is none of them. */
bool device_find(cl_device_id device, int *platform_index, int *device_index);

/* Fills all but the indices, which stay -1 where the device is not one of a choice. */
tc_status device_describe(cl_device_id device, tc_device_info *info);

#endif
