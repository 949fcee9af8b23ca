/* context_create.h - what context_create.c has for trial_job.c beside the public calls: contexts for trials */
#ifndef CONTEXT_CREATE_H
#define CONTEXT_CREATE_H

#include "opencl/context.h"

/* As tc_context_create, but kernels are built without vetting (vetting.h). */
tc_status context_create_for_trial(const tc_context_options *options, tc_context **context);

#endif
