/*
 * variant.h - the two variants of the kernels (kernels/base/common.cl), and which device gets which
 */
#ifndef VARIANT_H
#define VARIANT_H

#include "tetracubes.h"

#include <stdbool.h>

typedef enum kernel_variant {
    VARIANT_GROUPS, /* for groups of 32 work-items or a multiple of it: plain OpenCL C 1.2 */
    VARIANT_ALONE   /* for one work-item per group, as CPUs want it, with what Clang has beyond OpenCL C */
} kernel_variant;

/* What is known about the devices of a platform. */
typedef struct variant_rule {
    const char *platform;   /* part of its name; NULL: any */
    const char *type;       /* of the device, as in tc_device_info; NULL: any */
    kernel_variant variant; /* the one it gets */
    bool takes_alone;       /* the other is tried where a caller asks for it by work_items = 1 */
    const char *tried;      /* versions of the driver that have been tried: what they begin with, separated by spaces */
    const char *why;
} variant_rule;

/* The rule that a device falls under; there is always one. */
const variant_rule *variant_rule_of(const tc_device_info *device);

/* Whether the device's driver is among those that have been tried with the text it gets. */
bool variant_tried(const tc_device_info *device);

/* What the device's driver is known to do wrong and no trial is large enough to show; NULL where nothing is. */
const char *variant_fault(const tc_device_info *device);

kernel_variant variant_for(uint32_t work_items);

#endif
