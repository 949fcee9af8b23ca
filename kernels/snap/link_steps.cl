/*
 * link_steps.cl - the steps to the samples of a link, as a table
 */
#ifndef LINK_STEPS_CL
#define LINK_STEPS_CL

#include "link.h"
#include "../base/common.cl"

#define LINK_STEP(x, y, z) {x, y, z},
constant const char link_steps[LINK_EVEN][3] = {LINK_SAMPLES(LINK_STEP)};

#endif
