/*
 * tuning.h - launch parameters: the caller's, else those kept for the device, else defaults for its type
 *
 * Kept ones lie in the file "tuning" of the cache folder (cache.h), text, a line per device:
 *
 *     work_items=1 work_groups=2 tile_bricks=0 device=NAME, 2 units, PLATFORM, VERSION, driver DRIVER
 *
 * A line that is not of this form, or has values that no device can do with, is passed over.
 */
#ifndef TUNING_H
#define TUNING_H

#include "context.h"

/* Fills in what context->options leave at 0. TC_ERROR_ARGUMENT for what the device cannot do. */
tc_status tuning_choose(tc_context *context);

#endif
