/*
 * Programs of kernels: the .cl files, embedded as text, built for one sample type at a time or loaded from the cache of
 * built programs. Programs built here are stored there when the context ends, after their kernels have run.
 */
#include "opencl/program.h"

#include "failure.h"
#include "sample_types.h"
#include "opencl/kernel_sources.h"
#include "opencl/pocl_cache.h"
#include "opencl/program_cache.h"
#include "opencl/variant.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The kernels' names for a sample type (sample_types.h). */
typedef struct type_text {
    const char *bits, *value;
} type_text;

#define TYPE_TEXT(type, name, c_type, least, most, cl_bits, cl_value) [type] = {#cl_bits, #cl_value},
static const type_text type_texts[SAMPLE_TYPE_COUNT] = {SAMPLE_TYPES(TYPE_TEXT)};

/* The width in bits, as the kernels know types of floating point. */
static unsigned floating_bits(tc_type type) { return type_is_real(type) ? 8 * (unsigned)sample_bytes(type) : 0; }

/* What a program depends on, besides the bits of samples and the work-items of a group. */
enum {
    ON_MISSING = 1 << 0,
    ON_METHOD = 1 << 1,
    ON_CLOSED = 1 << 2,
    ON_VALUES = 1 << 3, /* else samples are bit patterns, so integer types of one width share the program */
    ON_DIVISION = 1 << 4,
    ON_CHANNELS = 1 << 5,
    ON_GRID = 1 << 6,
    ON_WHOLE = 1 << 7, /* cells are kept whole */
};

/* A program in both variants, its kernels in order, and the definitions that its text looks at. */
typedef struct program_sources {
    const char *kernels[KERNELS_MOST];
    const char *sources[2];
    unsigned on;
} program_sources;

#define BOTH_VARIANTS(name)                                                                                            \
    { [VARIANT_ALONE] = kernel_##name##_alone, [VARIANT_GROUPS] = kernel_##name##_groups }

static const program_sources programs[PROGRAM_COUNT] = {
    [PROGRAM_CLASSIFY] = {{"classify", "cells_mark"}, BOTH_VARIANTS(classify), ON_MISSING | ON_METHOD | ON_CLOSED},
    [PROGRAM_EMIT] = {{"emit"},
                      BOTH_VARIANTS(emit),
                      ON_MISSING | ON_METHOD | ON_CLOSED | ON_VALUES | ON_DIVISION | ON_CHANNELS | ON_GRID},
    [PROGRAM_SNAP] = {{"snap_sign", "snap_near", "snap_violated", "snap_words", "snap_even", "snap_odd", "snap_join"},
                      BOTH_VARIANTS(snap),
                      ON_MISSING | ON_METHOD | ON_VALUES},
    [PROGRAM_COMPLEX] = {{"complex_classify", "complex_list", "complex_join", "complex_number", "complex_emit"},
                         BOTH_VARIANTS(complex),
                         ON_VALUES | ON_DIVISION | ON_WHOLE},
    [PROGRAM_WHOLE] = {{"complex_classify", "whole_list", "complex_join", "complex_number", "complex_emit", "whole_cut",
                        "whole_clear"},
                       BOTH_VARIANTS(complex),
                       ON_VALUES | ON_DIVISION | ON_WHOLE},
    [PROGRAM_COMPLEX_CAPS] = {{"caps_count", "caps_emit"}, BOTH_VARIANTS(complex_caps), ON_WHOLE},
    [PROGRAM_COMPLEX_INTERVAL] = {{"complex_interval_count", "complex_interval_list", "complex_interval_join",
                                   "complex_interval_number", "complex_interval_crossings", "complex_interval_emit"},
                                  BOTH_VARIANTS(complex_interval),
                                  ON_VALUES | ON_DIVISION},
    [PROGRAM_LABELS] = {{"label_classify", "label_emit"}, BOTH_VARIANTS(labels), 0},
    [PROGRAM_INTERVAL] = {{"interval_count", "interval_emit"},
                          {[VARIANT_ALONE] = kernel_interval_groups, [VARIANT_GROUPS] = kernel_interval_groups},
                          ON_MISSING | ON_METHOD | ON_VALUES | ON_DIVISION | ON_GRID},
};

/* Options of the compiler, as they are put together. */
typedef struct options_text {
    char text[PROGRAM_OPTIONS_BYTES];
    size_t length;
} options_text;

__attribute__((format(printf, 2, 3))) static void options_add(options_text *o, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    o->length += (size_t)vsnprintf(o->text + o->length, sizeof o->text - o->length, format, arguments);
    va_end(arguments);
}

/* Samples as numbers. Without REAL no vertices are made. */
static void values_add(options_text *o, const tc_context *context, tc_type type) {
    const bool wide = type_is_wide(type);
    options_add(o, " -DWIDE=%d -DSAMPLE_VALUE(b)=%s%s", wide, type_texts[type].value,
                context->info.has_fp64 ? " -DFP64=1" : "");
    if (device_makes_vertices(context, type)) options_add(o, " -DREAL=%s", wide ? "double" : "float");
}

static void division_add(options_text *o, tc_division division) {
    options_add(o, " -DDIVISION=%d%s", (int)division,
                division == TC_DIVISION_BUILT_IN ? " -cl-fp32-correctly-rounded-divide-sqrt" : "");
}

/* Nothing is defined that the text does not look at, so that calls share programs as far as can be. */
static void options_write(const tc_context *context, program_name name, kernel_kind kind, options_text *o) {
    const unsigned on = programs[name].on;
    o->length = 0;
    options_add(o, "-cl-std=CL1.2 -DBITS=%s -DFLOATING=%u -DWORK_ITEMS=%u", type_texts[kind.type].bits,
                floating_bits(kind.type), context->launch.work_items);
    if (on & ON_MISSING) options_add(o, " -DMISSING=%d", kind.missing);
    if (on & ON_METHOD) options_add(o, " -DMETHOD=%s", tc_method_name(kind.method));
    if (on & ON_CLOSED && kind.closed) options_add(o, " -DCLOSED=1");
    if (on & ON_VALUES) values_add(o, context, kind.type);
    if (on & ON_DIVISION) division_add(o, context->launch.division);
    if (on & ON_CHANNELS) options_add(o, " -DNORMALS=%d", channel_in(kind.made, CHANNEL_NORMALS));
    if (on & ON_GRID) options_add(o, " -DGRID=%u", kind.grid);
    if (on & ON_WHOLE && kind.method == TC_METHOD_HYBRID) options_add(o, " -DWHOLE=1");
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
    char folder[512];
    if (strstr(context->info.platform, "Portable Computing Language") && pocl_cache_is_locked(folder, sizeof folder))
        return (tc_status)fail(TC_ERROR_DEVICE,
                               "%s does not build the kernels (%d), as PoCL cannot write its cache folder %s: set "
                               "POCL_CACHE_DIR to a folder that this user may write, or HOME",
                               context->info.name, (int)error, folder);
    return (tc_status)fail(TC_ERROR_DEVICE, "%s does not build the kernels (%d) with %s: %s", context->info.name,
                           (int)error, p->options, log);
}

uint64_t kernel_sources_hash(void) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (int variant = VARIANT_GROUPS; variant <= VARIANT_ALONE; variant++)
        for (int name = 0; name < PROGRAM_COUNT; name++)
            for (const char *c = programs[name].sources[variant]; *c; c++)
                hash = (hash ^ (unsigned char)*c) * 0x100000001b3u;
    return hash;
}

static tc_status source_build(const tc_context *context, program *p) {
    cl_int error;
    p->program = cl->CreateProgramWithSource(context->context, 1, &p->source, NULL, &error);
    if (error) return context_fail(context, "handing the kernels to the device", error);
    error = cl->BuildProgram(p->program, 1, &context->device, p->options, NULL, NULL);
    return error ? build_fail(context, p, error) : TC_OK;
}

static tc_status program_build(const tc_context *context, program *p) {
    const program_recipe recipe = {p->source, p->options};
    p->program = program_cache_load(context, &recipe);
    p->cached = p->program != NULL;
    return p->cached ? TC_OK : source_build(context, p);
}

static const uint32_t items_step = 32; /* kernels of groups take whole parts of a brick's 32 words */

/* The most work-items per group that kernels allow, and the multiple that the device prefers. */
typedef struct group_limit {
    const char *kernel; /* that allows the fewest */
    size_t most, multiple;
} group_limit;

static tc_status kernel_create(const tc_context *context, const program *p, const char *name, cl_kernel *kernel,
                               group_limit *limit) {
    cl_int error;
    size_t most = 0, multiple = 0;
    *kernel = cl->CreateKernel(p->program, name, &error);
    if (!error)
        error =
            cl->GetKernelWorkGroupInfo(*kernel, context->device, CL_KERNEL_WORK_GROUP_SIZE, sizeof most, &most, NULL);
    if (!error)
        error = cl->GetKernelWorkGroupInfo(*kernel, context->device, CL_KERNEL_PREFERRED_WORK_GROUP_SIZE_MULTIPLE,
                                           sizeof multiple, &multiple, NULL);
    if (error) return context_fail(context, name, error);
    if (most < limit->most) *limit = (group_limit){name, most, multiple};
    return TC_OK;
}

static tc_status kernels_create(const tc_context *context, program *p, const char *const *names, group_limit *limit) {
    tc_status status = TC_OK;
    *limit = (group_limit){NULL, SIZE_MAX, 0};
    for (int n = 0; n < KERNELS_MOST && names[n] && !status; n++)
        status = kernel_create(context, p, names[n], &p->kernels[n], limit);
    return status;
}

/* Releases what was built; the program stays in the list. */
static void program_clear(program *p) {
    for (int n = 0; n < KERNELS_MOST; n++)
        if (p->kernels[n]) cl->ReleaseKernel(p->kernels[n]);
    if (p->program) cl->ReleaseProgram(p->program);
    memset(p->kernels, 0, sizeof p->kernels);
    p->program = NULL;
}

static void program_release(program *p) {
    program_clear(p);
    free(p);
}

/* Keeps what was built here in the cache. */
static void program_keep(const tc_context *context, const program *p) {
    const program_recipe recipe = {p->source, p->options};
    if (!p->cached) program_cache_store(context, &recipe, p->program);
}

/* The most work-items up to the limit that kernels of groups can have: a multiple of 32, and of what suits the device
 * where there is one; 0: none. */
static uint32_t work_items_below(const group_limit *limit) {
    const size_t step = limit->multiple % items_step == 0 && limit->multiple <= limit->most && limit->multiple
                            ? limit->multiple
                            : items_step;
    return (uint32_t)(limit->most / step * step);
}

/* The options asked for, with the program's own number of work-items. */
static void program_options_write(program *p) {
    static const char define[] = "-DWORK_ITEMS=";
    const char *at = strstr(p->asked, define) + sizeof define - 1;
    snprintf(p->options, sizeof p->options, "%.*s%u%s", (int)(at - p->asked), p->asked, p->work_items,
             at + strspn(at, "0123456789"));
}

/* Builds the program, and again, smaller, where one of its kernels allows fewer work-items. */
static tc_status program_make(const tc_context *context, program *p, const char *const *names) {
    group_limit limit;
    for (p->work_items = context->launch.work_items;; p->work_items = work_items_below(&limit)) {
        program_options_write(p);
        tc_status status = program_build(context, p);
        if (!status) status = kernels_create(context, p, names, &limit);
        if (status || p->work_items <= limit.most) return status;
        if (!work_items_below(&limit))
            return (tc_status)fail(TC_ERROR_DEVICE, "%s runs kernel %s with at most %zu work-items per group, not %u",
                                   context->info.name, limit.kernel, limit.most, items_step);
        program_keep(context, p); /* later contexts then learn its limits without a compiler */
        program_clear(p);
    }
}

tc_status program_get(tc_context *context, program_name name, kernel_kind kind, const program **out) {
    const program_sources *from = &programs[name];
    const char *kernels[KERNELS_MOST];
    const char *source = from->sources[variant_for(context->launch.work_items)];
    options_text options;
    options_write(context, name, kind, &options);
    for (program *p = context->programs; p; p = p->next)
        if (p->source == source && !strcmp(p->asked, options.text)) {
            *out = p;
            return TC_OK;
        }
    program *p = calloc(1, sizeof *p);
    if (!p) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for a program");
    snprintf(p->asked, sizeof p->asked, "%s", options.text);
    p->source = source;
    memcpy(kernels, from->kernels, sizeof kernels);
    if (name == PROGRAM_CLASSIFY && !kind.missing) kernels[KERNEL_CELLS] = NULL;
    const double start = clock_ms();
    tc_status status = program_make(context, p, kernels);
    if (!context->trial_runs) context->build_ms += clock_ms() - start; /* else the trial's time has it */
    if (status) {
        program_release(p);
        return status;
    }
    p->next = context->programs;
    *out = context->programs = p;
    return context_progress(context, "build", 0);
}

void programs_release(tc_context *context) {
    while (context->programs) {
        program *p = context->programs, *next = p->next;
        const bool inherited = context_is_inherited(context);
        if (!inherited) program_keep(context, p);
        if (inherited)
            free(p);
        else
            program_release(p);
        context->programs = next;
    }
}
