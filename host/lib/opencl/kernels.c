#include "opencl/kernels.h"

#include "opencl/program.h"
#include "opencl/vetting.h"

static tc_status vetted_program_get(tc_context *context, program_name name, kernel_kind kind, const program **out) {
    tc_status status = kernels_vet(context, kind);
    return status ? status : program_get(context, name, kind, out);
}

static sized_kernel kernel_of(const program *p, int n) { return (sized_kernel){p->kernels[n], p->work_items}; }

tc_status kernels_get(tc_context *context, kernel_kind kind, kernels *out) {
    const program *p;
    tc_status status = vetted_program_get(context, PROGRAM_CLASSIFY, kind_of_classify(kind), &p);
    if (status) return status;
    out->classify = kernel_of(p, 0);
    out->cells = kernel_of(p, KERNEL_CELLS);
    if (kind.method == TC_METHOD_SNAP) {
        status = vetted_program_get(context, PROGRAM_SNAP, kind_of_classify(kind), &p);
        if (status) return status;
        for (int n = 0; n < SNAP_KERNELS; n++) out->snap[n] = kernel_of(p, n);
    }
    if (!kind.emits) return TC_OK;
    if (kind.interval) {
        status = vetted_program_get(context, PROGRAM_INTERVAL, kind, &p);
        if (!status) out->interval_count = kernel_of(p, 0), out->interval_emit = kernel_of(p, 1);
        return status;
    }
    status = vetted_program_get(context, PROGRAM_EMIT, kind, &p);
    if (!status) out->emit = kernel_of(p, 0);
    return status;
}

static tc_status volume_kernels_get(tc_context *context, kernel_kind kind, sized_kernel *out) {
    const program *p;
    tc_status status = vetted_program_get(context, PROGRAM_COMPLEX_INTERVAL, kind, &p);
    for (int n = 0; n < VOLUME_KERNELS && !status; n++) out[n] = kernel_of(p, n);
    return status;
}

tc_status complex_kernels_get(tc_context *context, kernel_kind kind, sized_kernel out[ALL_COMPLEX_KERNELS]) {
    const bool whole = kind.method == TC_METHOD_HYBRID;
    const program *p;
    if (kind.interval) return volume_kernels_get(context, kind, out);
    tc_status status = vetted_program_get(context, whole ? PROGRAM_WHOLE : PROGRAM_COMPLEX, kind, &p);
    for (int n = 0; n < (whole ? WHOLE_KERNELS : COMPLEX_KERNELS) && !status; n++) out[n] = kernel_of(p, n);
    if (status || !kind.closed) return status;
    status = vetted_program_get(context, PROGRAM_COMPLEX_CAPS, kind, &p);
    for (int n = KERNEL_CAPS_COUNT; n <= KERNEL_CAPS_EMIT && !status; n++) out[n] = kernel_of(p, n - KERNEL_CAPS_COUNT);
    return status;
}

tc_status label_kernels_get(tc_context *context, kernel_kind kind, sized_kernel out[LABEL_KERNELS]) {
    const program *p;
    tc_status status = vetted_program_get(context, PROGRAM_LABELS, kind, &p);
    for (int n = 0; n < LABEL_KERNELS && !status; n++) out[n] = kernel_of(p, n);
    return status;
}

tc_status kernel_launch(const tc_context *context, sized_kernel kernel, const char *name,
                        const kernel_argument *arguments, cl_uint argument_count) {
    const size_t local = kernel.work_items, global = local * context->launch.work_groups;
    cl_int error = CL_SUCCESS;
    for (cl_uint n = 0; n < argument_count && !error; n++)
        error = cl->SetKernelArg(kernel.kernel, n, arguments[n].bytes, arguments[n].value);
    if (!error)
        error = cl->EnqueueNDRangeKernel(context->queue, kernel.kernel, 1, NULL, &global, &local, 0, NULL, NULL);
    return error ? context_fail(context, name, error) : TC_OK;
}
