/*
 * Kernels: the .cl files of the source tree, embedded as text, built for one sample type at a time.
 */
#include "context.h"

#include "failure.h"
#include "kernel_sources.h"

#include <stdio.h>
#include <stdlib.h>

/* The kernels' names for a sample type: unsigned type of its width, width in bits where floating, value of a sample. */
typedef struct type_text {
    const char *bits;
    int floating;
    const char *value;
} type_text;

static const type_text type_texts[] = {
    [TC_U8] = {"uchar", 0, "(float)(b)"},   [TC_I8] = {"uchar", 0, "(float)as_char(b)"},
    [TC_U16] = {"ushort", 0, "(float)(b)"}, [TC_I16] = {"ushort", 0, "(float)as_short(b)"},
    [TC_U32] = {"uint", 0, "(double)(b)"},  [TC_I32] = {"uint", 0, "(double)as_int(b)"},
    [TC_F32] = {"uint", 32, "as_float(b)"}, [TC_F64] = {"ulong", 64, "as_double(b)"},
};

static int options_write(const tc_context *context, const program *p, char *out, size_t bytes) {
    const type_text *t = &type_texts[p->type];
    bool wide = type_is_wide(p->type), vertices = device_makes_vertices(context, p->type);
    return snprintf(out, bytes,
                    "-cl-std=CL1.2 %s-DBITS=%s -DFLOATING=%d -DWIDE=%d %s%s -DSAMPLE_VALUE(b)=%s -DMISSING=%d "
                    "-DNORMALS=%d -DWORK_ITEMS=%u -DDIVISION=%d %s",
                    context->options.division == 1 ? "-cl-fp32-correctly-rounded-divide-sqrt " : "", t->bits,
                    t->floating, wide, vertices ? "-DREAL=" : "",
                    !vertices ? ""
                    : wide    ? "double"
                              : "float",
                    t->value, p->missing, p->normals, context->options.work_items, context->options.division,
                    context->info.has_fp64 ? "-DFP64=1" : "");
}

static tc_status build_fail(const tc_context *context, const program *p, cl_int error) {
    char log[700] = "";
    size_t bytes = 0;
    char *whole = NULL;
    cl->GetProgramBuildInfo(p->program, context->device, CL_PROGRAM_BUILD_LOG, 0, NULL, &bytes);
    if (bytes && (whole = calloc(1, bytes + 1)) &&
        !cl->GetProgramBuildInfo(p->program, context->device, CL_PROGRAM_BUILD_LOG, bytes, whole, NULL))
        snprintf(log, sizeof log, "%s", whole);
    free(whole);
    return (tc_status)fail(TC_ERROR_DEVICE, "%s does not build the kernels for %s samples (%d): %s", context->info.name,
                           tc_type_name(p->type), (int)error, log);
}

static tc_status kernel_create(const program *p, const char *name, cl_kernel *kernel) {
    cl_int error;
    *kernel = cl->CreateKernel(p->program, name, &error);
    return error ? opencl_fail(name, error) : TC_OK;
}

static tc_status program_build(const tc_context *context, program *p) {
    char options[512];
    cl_int error;
    options_write(context, p, options, sizeof options);
    p->program = cl->CreateProgramWithSource(context->context, kernel_source_count,
                                             (const char **)(size_t)kernel_sources, NULL, &error);
    if (error) return opencl_fail("handing the kernels to the device", error);
    error = cl->BuildProgram(p->program, 1, &context->device, options, NULL, NULL);
    if (error) return build_fail(context, p, error);
    tc_status status = kernel_create(p, "classify", &p->classify);
    if (!status) status = kernel_create(p, "emit", &p->emit);
    if (!status && p->missing) status = kernel_create(p, "cells_mark", &p->cells);
    return status;
}

static void program_release(program *p) {
    if (p->classify) cl->ReleaseKernel(p->classify);
    if (p->emit) cl->ReleaseKernel(p->emit);
    if (p->cells) cl->ReleaseKernel(p->cells);
    if (p->program) cl->ReleaseProgram(p->program);
    free(p);
}

tc_status program_get(tc_context *context, tc_type type, bool missing, bool normals, const program **out) {
    for (program *p = context->programs; p; p = p->next)
        if (p->type == type && p->missing == missing && p->normals == normals) {
            *out = p;
            return TC_OK;
        }
    program *p = calloc(1, sizeof *p);
    if (!p) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for a program");
    p->type = type;
    p->missing = missing;
    p->normals = normals;
    tc_status status = program_build(context, p);
    if (status) {
        program_release(p);
        return status;
    }
    p->next = context->programs;
    *out = context->programs = p;
    return TC_OK;
}

void programs_release(tc_context *context) {
    while (context->programs) {
        program *next = context->programs->next;
        program_release(context->programs);
        context->programs = next;
    }
}
