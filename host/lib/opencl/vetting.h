/*
 * vetting.h - before a driver builds kernels in this process: is it known to be good, or can the caller try it apart?
 *
 * What is known comes from the table of drivers, from verdicts kept in the cache, and else from the trial that the
 * context's options name (tetracubes.h). Where a variant of the kernels is bad the other one is taken, if work_items is
 * the library's to choose; if none is left, that is an error that says what the driver did.
 */
#ifndef VETTING_H
#define VETTING_H

#include "opencl/context.h"

/* Before the context of the device is made. */
tc_status device_vet(tc_context *context);

/* At the start of a call: TC_OK where the kernels may be built, perhaps with the other variant. */
tc_status call_vet(tc_context *context, kernel_kind kind);

/* Within a call, where kernels are built: another variant than at its start ends the call, which then starts again. */
tc_status kernels_vet(tc_context *context, kernel_kind kind);

/* True where the call that failed has to start again. */
bool vetting_restarts(tc_context *context);

#endif
