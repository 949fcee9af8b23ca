/*
 * tuning.h - launch parameters: the caller's, else those kept for the device, else defaults for its type
 *
 * Kept ones lie in the file "tuning" of the cache folder (cache.h), text, a line per device:
 *
 *     work_items=1 work_groups=2 tile_bricks=0 device=NAME, 2 units, PLATFORM, VERSION, driver DRIVER
 *
 * A line of another form, or with values that no device allows, is ignored.
 */
#ifndef TUNING_H
#define TUNING_H

#include "tetracubes.h"

/* How kernel 1 scans, as in tc_expert_options. */
typedef struct scan_parameters {
    uint32_t tile_bricks; /* 0: as suits the grid */
    uint32_t spin_limit;
} scan_parameters;

/* How kernels are built and launched, as in tc_expert_options. */
typedef struct launch_parameters {
    uint32_t work_items, work_groups;
    scan_parameters scan;
    tc_division division;
    uint32_t other_items; /* work-items of the other variant of the kernels; 0: there is none to take (vetting.c) */
} launch_parameters;

/* Chooses the parameters that the options leave at 0. TC_ERROR_ARGUMENT for values beyond the device's limits. */
tc_status tuning_choose(const tc_expert_options *options, const tc_device_info *device, launch_parameters *out);

/* Puts the parameters into the file, in place of what it has for the device. */
tc_status tuning_keep(const tc_device_info *device, const tc_tuning *tuning);

#endif
