/*
 * Kernels: the .cl files of the source tree, embedded as text, built for one sample type at a time, and taken from the
 * cache of built programs where that has them. What was built here is put there at the end of the context, when the
 * kernels have run.
 */
#include "context.h"

#include "failure.h"
#include "pocl_cache.h"
#include "grid.h"
#include "kernel_sources.h"
#include "program_cache.h"
#include "text.h"
#include "vetting.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

/* Kernel 1 sees samples as bit patterns, so types of one width share it. */
static void classify_options_write(const tc_context *context, tc_type type, tc_method method, bool missing, char *out,
                                   size_t bytes) {
    snprintf(out, bytes, "-cl-std=CL1.2 -DBITS=%s -DFLOATING=%d -DMISSING=%d -DWORK_ITEMS=%u -DHYBRID=%d",
             type_texts[type].bits, type_texts[type].floating, missing, context->options.work_items,
             method == TC_METHOD_HYBRID);
}

static void emit_options_write(const tc_context *context, const tc_grid *grid, tc_method method, bool missing,
                               bool normals, char *out, size_t bytes) {
    char common[128];
    const tc_type type = grid->type;
    bool wide = type_is_wide(type), vertices = device_makes_vertices(context, type);
    classify_options_write(context, type, method, missing, common, sizeof common);
    snprintf(out, bytes, "%s %s-DWIDE=%d %s%s -DSAMPLE_VALUE(b)=%s -DNORMALS=%d -DDIVISION=%d -DGRID=%d%s", common,
             context->options.division == 1 ? "-cl-fp32-correctly-rounded-divide-sqrt " : "", wide,
             vertices ? "-DREAL=" : "",
             !vertices ? ""
             : wide    ? "double"
                       : "float",
             type_texts[type].value, normals, context->options.division, (int)grid->kind,
             context->info.has_fp64 ? " -DFP64=1" : "");
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

/* Sources of each text, in order; the rest of a list is NULL. */
enum { SOURCES_MOST = 24 };

static const char *const classify_sources[][SOURCES_MOST] = {
    [TEXT_ALONE] = {kernel_source_slab, kernel_source_common, kernel_source_extensions, kernel_source_lanes_alone,
                    kernel_source_words, kernel_source_words_alone, kernel_source_tetrahedra, kernel_source_cells,
                    kernel_source_ranges, kernel_source_ranges_alone, kernel_source_sign, kernel_source_sign_alone,
                    kernel_source_count, kernel_source_count_alone, kernel_source_scan, kernel_source_classify},
    [TEXT_GROUPS] = {kernel_source_slab, kernel_source_common, kernel_source_lanes_groups, kernel_source_words,
                     kernel_source_words_groups, kernel_source_tetrahedra, kernel_source_cells, kernel_source_ranges,
                     kernel_source_sign, kernel_source_sign_groups, kernel_source_count, kernel_source_count_groups,
                     kernel_source_scan, kernel_source_classify},
};
static const char *const emit_sources[][SOURCES_MOST] = {
    [TEXT_ALONE] = {kernel_source_slab, kernel_source_common, kernel_source_extensions, kernel_source_lanes_alone,
                    kernel_source_words, kernel_source_words_alone, kernel_source_tetrahedra, kernel_source_cells,
                    kernel_source_crossing, kernel_source_vertex, kernel_source_mesh, kernel_source_emit_numbers,
                    kernel_source_emit_brick, kernel_source_emit},
    [TEXT_GROUPS] = {kernel_source_slab, kernel_source_common, kernel_source_lanes_groups, kernel_source_words,
                     kernel_source_words_groups, kernel_source_tetrahedra, kernel_source_cells, kernel_source_crossing,
                     kernel_source_vertex, kernel_source_mesh, kernel_source_emit_rows, kernel_source_emit},
};
static const char *const complex_sources[][SOURCES_MOST] = {
    [TEXT_ALONE] = {kernel_source_slab,
                    kernel_source_common,
                    kernel_source_extensions,
                    kernel_source_lanes_alone,
                    kernel_source_words,
                    kernel_source_words_alone,
                    kernel_source_ranges,
                    kernel_source_ranges_alone,
                    kernel_source_scan,
                    kernel_source_crossing,
                    kernel_source_complex_job,
                    kernel_source_complex_cluster,
                    kernel_source_complex_cluster_alone,
                    kernel_source_complex_tile,
                    kernel_source_complex_count,
                    kernel_source_complex_count_alone,
                    kernel_source_complex_classify,
                    kernel_source_complex_join,
                    kernel_source_complex_join_alone,
                    kernel_source_complex_number,
                    kernel_source_complex_emit},
    [TEXT_GROUPS] = {kernel_source_slab, kernel_source_common, kernel_source_lanes_groups, kernel_source_words,
                     kernel_source_words_groups, kernel_source_ranges, kernel_source_scan, kernel_source_crossing,
                     kernel_source_complex_job, kernel_source_complex_cluster, kernel_source_complex_cluster_groups,
                     kernel_source_complex_tile, kernel_source_complex_count, kernel_source_complex_count_groups,
                     kernel_source_complex_classify, kernel_source_complex_join, kernel_source_complex_join_groups,
                     kernel_source_complex_number, kernel_source_complex_emit},
};

static kernel_text text_of(const tc_context *context) { return text_for(context->options.work_items); }

static program_recipe recipe_of(const program *p) {
    program_recipe recipe = {p->sources, 0, p->options};
    while (recipe.source_count < SOURCES_MOST && p->sources[recipe.source_count]) recipe.source_count++;
    return recipe;
}

uint64_t kernel_sources_hash(void) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (int text = TEXT_GROUPS; text <= TEXT_ALONE; text++) {
        const char *const *const lists[] = {classify_sources[text], emit_sources[text], complex_sources[text]};
        for (int n = 0; n < 3; n++)
            for (int s = 0; s < SOURCES_MOST && lists[n][s]; s++)
                for (const char *c = lists[n][s]; *c; c++) hash = (hash ^ (unsigned char)*c) * 0x100000001b3u;
    }
    return hash;
}

static tc_status source_build(const tc_context *context, program *p) {
    cl_int error;
    p->program = cl->CreateProgramWithSource(context->context, recipe_of(p).source_count,
                                             (const char **)(size_t)p->sources, NULL, &error);
    if (error) return context_fail(context, "handing the kernels to the device", error);
    error = cl->BuildProgram(p->program, 1, &context->device, p->options, NULL, NULL);
    return error ? build_fail(context, p, error) : TC_OK;
}

static tc_status program_build(const tc_context *context, program *p) {
    program_recipe recipe = recipe_of(p);
    p->program = program_cache_load(context, &recipe);
    p->cached = p->program != NULL;
    return p->cached ? TC_OK : source_build(context, p);
}

static const uint32_t items_step = 32; /* kernels of groups take whole parts of a brick's 32 words */

/* What a kernel allows per group, and the multiple of work-items that suits the device. */
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

static tc_status kernels_create(const tc_context *context, program *p, const char *name, bool cells,
                                group_limit *limit) {
    static const char *const of_complexes[COMPLEX_KERNELS] = {"complex_classify", "complex_list", "complex_join",
                                                              "complex_number", "complex_emit"};
    tc_status status = TC_OK;
    *limit = (group_limit){NULL, SIZE_MAX, 0};
    if (name) status = kernel_create(context, p, name, &p->kernel, limit);
    if (!status && cells) status = kernel_create(context, p, "cells_mark", &p->cells, limit);
    for (int n = 0; n < COMPLEX_KERNELS && !name && !status; n++)
        status = kernel_create(context, p, of_complexes[n], &p->complex[n], limit);
    return status;
}

/* Gives back what was built, not the program's place. */
static void program_clear(program *p) {
    if (p->kernel) cl->ReleaseKernel(p->kernel);
    if (p->cells) cl->ReleaseKernel(p->cells);
    for (int n = 0; n < COMPLEX_KERNELS; n++)
        if (p->complex[n]) cl->ReleaseKernel(p->complex[n]);
    if (p->program) cl->ReleaseProgram(p->program);
    p->kernel = p->cells = NULL;
    memset(p->complex, 0, sizeof p->complex);
    p->program = NULL;
}

static void program_release(program *p) {
    program_clear(p);
    free(p);
}

/* Keeps what was built here in the cache. */
static void program_keep(const tc_context *context, const program *p) {
    program_recipe recipe = recipe_of(p);
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
static tc_status program_make(const tc_context *context, program *p, const char *name, bool cells) {
    group_limit limit;
    for (p->work_items = context->options.work_items;; p->work_items = work_items_below(&limit)) {
        program_options_write(p);
        tc_status status = program_build(context, p);
        if (!status) status = kernels_create(context, p, name, cells, &limit);
        if (status || p->work_items <= limit.most) return status;
        if (!work_items_below(&limit))
            return (tc_status)fail(TC_ERROR_DEVICE, "%s runs kernel %s with at most %zu work-items per group, not %u",
                                   context->info.name, limit.kernel, limit.most, items_step);
        program_keep(context, p); /* later contexts then learn its limits without a compiler */
        program_clear(p);
    }
}

/* The program with these options, built, and progress told, when first asked for. name: of its main kernel; NULL: those
 * of complexes. */
static tc_status program_get(tc_context *context, const char *options, const char *const sources[SOURCES_MOST],
                             const char *name, bool cells, program **out) {
    for (program *p = context->programs; p; p = p->next)
        if (!strcmp(p->asked, options)) {
            *out = p;
            return TC_OK;
        }
    program *p = calloc(1, sizeof *p);
    if (!p) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for a program");
    snprintf(p->asked, sizeof p->asked, "%s", options);
    p->sources = sources;
    tc_status status = program_make(context, p, name, cells);
    if (status) {
        program_release(p);
        return status;
    }
    p->next = context->programs;
    *out = context->programs = p;
    return context_progress(context, "build", 0);
}

tc_status classify_kernels_get(tc_context *context, tc_type type, tc_method method, bool missing, kernels *out) {
    char options[sizeof context->programs->options];
    program *p;
    const kernel_kind kind = {.type = type, .hybrid = method == TC_METHOD_HYBRID, .missing = missing};
    tc_status status = kernels_vet(context, kind);
    if (status) return status;
    classify_options_write(context, type, method, missing, options, sizeof options);
    status = program_get(context, options, classify_sources[text_of(context)], "classify", missing, &p);
    if (status) return status;
    out->classify = (sized_kernel){p->kernel, p->work_items};
    out->cells = (sized_kernel){p->cells, p->work_items};
    return TC_OK;
}

tc_status emit_kernel_get(tc_context *context, const tc_grid *grid, tc_method method, bool missing, bool normals,
                          kernels *out) {
    char options[sizeof context->programs->options];
    program *p;
    const kernel_kind kind = {grid->kind, grid->type, method == TC_METHOD_HYBRID, missing, normals, true};
    tc_status status = kernels_vet(context, kind);
    if (status) return status;
    emit_options_write(context, grid, method, missing, normals, options, sizeof options);
    status = program_get(context, options, emit_sources[text_of(context)], "emit", false, &p);
    if (!status) out->emit = (sized_kernel){p->kernel, p->work_items};
    return status;
}

tc_status complex_kernels_get(tc_context *context, const tc_grid *grid, const program **out) {
    char options[sizeof context->programs->options];
    program *p = NULL;
    tc_status status = kernels_vet(context, (kernel_kind){.grid = KIND_COMPLEX, .type = grid->type});
    if (status) return status;
    emit_options_write(context, grid, TC_METHOD_TETRA, true, false, options, sizeof options);
    strncat(options, " -DCOMPLEX=1", sizeof options - strlen(options) - 1);
    status = program_get(context, options, complex_sources[text_of(context)], NULL, false, &p);
    if (!status) *out = p;
    return status;
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
