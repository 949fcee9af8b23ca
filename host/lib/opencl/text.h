/*
 * text.h - the two texts of the kernels (kernels/common.cl), and which device gets which
 */
#ifndef TEXT_H
#define TEXT_H

#include "tetracubes.h"

#include <stdbool.h>

typedef enum kernel_text {
    TEXT_GROUPS, /* for groups of 32 work-items or a multiple of it: plain OpenCL C 1.2 */
    TEXT_ALONE   /* for one work-item per group, as CPUs want it, with what Clang has beyond OpenCL C */
} kernel_text;

/* What is known about the devices of a platform. */
typedef struct text_rule {
    const char *platform; /* part of its name; NULL: any */
    const char *type;     /* of the device, as in tc_device_info; NULL: any */
    kernel_text text;     /* the one it gets */
    bool takes_alone;     /* the other is tried where a caller asks for it by work_items = 1 */
    const char *tried;    /* versions of the driver that have been tried: what they begin with, separated by spaces */
    const char *why;
} text_rule;

/* The rule that a device falls under; there is always one. */
const text_rule *text_rule_of(const tc_device_info *device);

/* Whether the device's driver is among those that have been tried with the text it gets. */
bool text_tried(const tc_device_info *device);

kernel_text text_for(uint32_t work_items);

#endif
