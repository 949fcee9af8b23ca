/*
 * kernel_texts.c - writes the exact text and options of every program that the library builds for a device
 *
 * The library's own objects meet a stand-in for OpenCL with one device, which keeps what it is given to build. So what
 * offline.py compiles is what ships.
 *
 * Usage: kernel_texts DEVICE WORK_ITEMS FOLDER: FOLDER/NAME.cl and FOLDER/NAME.options for every program. WORK_ITEMS 0:
 * what the library takes by itself.
 */
#include "opencl/context.h"
#include "grid/grid.h"
#include "opencl/opencl.h"
#include "opencl/program.h"
#include "tetracubes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct device_kind {
    const char *kind, *platform, *name;
    cl_device_fp_config single, twice; /* what it can do in float and in double */
    cl_device_type type;               /* 0: GPU */
} device_kind;

static const device_kind device_kinds[] = {
    {"nvidia", "NVIDIA CUDA", "NVIDIA H100", CL_FP_FMA | CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT, CL_FP_FMA, 0},
    {"amd", "AMD Accelerated Parallel Processing", "gfx90a", CL_FP_FMA | CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT, CL_FP_FMA,
     0},
    {"plain", "rusticl", "llvmpipe", CL_FP_ROUND_TO_NEAREST, 0, 0}, /* no double, divides not quite */
    {"pocl", "Portable Computing Language", "pthread", CL_FP_FMA | CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT, CL_FP_FMA,
     CL_DEVICE_TYPE_CPU},
};

static const device_kind *device = device_kinds;
static const char *folder;
static char name[128]; /* of the program that is asked for */
static int written;

/* ---------------------------------------------------------------------------------------------- stand-in for OpenCL */

/* Any address does for an object: the library looks into none. */
#define OBJECT(type) ((type)(void *)name)

static FILE *file_open(const char *ending) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s.%s", folder, name, ending);
    FILE *file = fopen(path, "w");
    if (file) return file;
    fprintf(stderr, "kernel_texts: cannot write %s\n", path);
    exit(1);
}

static void text_give(const char *text, size_t room, void *value, size_t *bytes) {
    if (value) snprintf(value, room, "%s", text);
    if (bytes) *bytes = strlen(text) + 1;
}

static cl_int platforms_get(cl_uint room, cl_platform_id *platforms, cl_uint *count) {
    if (room) *platforms = OBJECT(cl_platform_id);
    if (count) *count = 1;
    return CL_SUCCESS;
}

static cl_int platform_tell(cl_platform_id platform, cl_platform_info what, size_t room, void *value, size_t *bytes) {
    (void)platform;
    text_give(what == CL_PLATFORM_NAME ? device->platform : "", room, value, bytes);
    return CL_SUCCESS;
}

static cl_int devices_get(cl_platform_id platform, cl_device_type type, cl_uint room, cl_device_id *devices,
                          cl_uint *count) {
    (void)platform, (void)type;
    if (room) *devices = OBJECT(cl_device_id);
    if (count) *count = 1;
    return CL_SUCCESS;
}

static cl_int number_give(cl_ulong number, size_t room, void *value) {
    memcpy(value, &number, room < sizeof number ? room : sizeof number); /* little-endian hosts only, as the library */
    return CL_SUCCESS;
}

static cl_int device_tell(cl_device_id of, cl_device_info what, size_t room, void *value, size_t *bytes) {
    cl_platform_id platform = OBJECT(cl_platform_id);
    (void)of;
    switch (what) {
    case CL_DEVICE_PLATFORM:
        memcpy(value, &platform, sizeof platform);
        return CL_SUCCESS;
    case CL_DEVICE_NAME:
        text_give(device->name, room, value, bytes);
        return CL_SUCCESS;
    case CL_DEVICE_VERSION:
        text_give("OpenCL 3.0", room, value, bytes);
        return CL_SUCCESS;
    case CL_DRIVER_VERSION:
    case CL_DEVICE_EXTENSIONS:
    case CL_DEVICE_VENDOR:
        text_give("", room, value, bytes);
        return CL_SUCCESS;
    case CL_DEVICE_TYPE:
        return number_give(device->type ? device->type : CL_DEVICE_TYPE_GPU, room, value);
    case CL_DEVICE_MAX_COMPUTE_UNITS:
        return number_give(128, room, value);
    case CL_DEVICE_MAX_WORK_GROUP_SIZE:
        return number_give(1024, room, value);
    case CL_DEVICE_GLOBAL_MEM_SIZE:
    case CL_DEVICE_MAX_MEM_ALLOC_SIZE:
        return number_give((cl_ulong)64 << 30, room, value);
    case CL_DEVICE_LOCAL_MEM_SIZE:
        return number_give(48 << 10, room, value);
    case CL_DEVICE_SINGLE_FP_CONFIG:
        return number_give(device->single, room, value);
    case CL_DEVICE_DOUBLE_FP_CONFIG:
        return number_give(device->twice, room, value);
    default:
        return number_give(0, room, value);
    }
}

static cl_context context_create(const cl_context_properties *properties, cl_uint count, const cl_device_id *devices,
                                 void(CL_CALLBACK *notify)(const char *, const void *, size_t, void *), void *user,
                                 cl_int *error) {
    (void)properties, (void)count, (void)devices, (void)notify, (void)user;
    if (error) *error = CL_SUCCESS;
    return OBJECT(cl_context);
}

static cl_command_queue queue_create(cl_context context, cl_device_id of, cl_command_queue_properties properties,
                                     cl_int *error) {
    (void)context, (void)of, (void)properties;
    if (error) *error = CL_SUCCESS;
    return OBJECT(cl_command_queue);
}

static cl_program program_create(cl_context context, cl_uint count, const char **texts, const size_t *lengths,
                                 cl_int *error) {
    FILE *file = file_open("cl");
    (void)context;
    for (cl_uint n = 0; n < count; n++)
        if (lengths && lengths[n])
            fwrite(texts[n], 1, lengths[n], file);
        else
            fputs(texts[n], file);
    fclose(file);
    if (error) *error = CL_SUCCESS;
    return OBJECT(cl_program);
}

static cl_int program_build(cl_program built, cl_uint count, const cl_device_id *devices, const char *options,
                            void(CL_CALLBACK *notify)(cl_program, void *), void *user) {
    FILE *file = file_open("options");
    (void)built, (void)count, (void)devices, (void)notify, (void)user;
    fprintf(file, "%s\n", options);
    fclose(file);
    written++;
    return CL_SUCCESS;
}

static cl_kernel kernel_create(cl_program built, const char *kernel, cl_int *error) {
    (void)built, (void)kernel;
    if (error) *error = CL_SUCCESS;
    return OBJECT(cl_kernel);
}

static cl_int kernel_tell(cl_kernel kernel, cl_device_id of, cl_kernel_work_group_info what, size_t room, void *value,
                          size_t *bytes) {
    (void)kernel, (void)of, (void)bytes;
    return number_give(what == CL_KERNEL_PREFERRED_WORK_GROUP_SIZE_MULTIPLE ? 32 : 1024, room, value);
}

static cl_int program_tell(cl_program built, cl_program_info what, size_t room, void *value, size_t *bytes) {
    (void)built, (void)what, (void)room, (void)value, (void)bytes;
    return CL_INVALID_VALUE;
}

static cl_int queue_done(cl_command_queue queue) { return queue ? CL_SUCCESS : CL_INVALID_COMMAND_QUEUE; }
static cl_int context_done(cl_context context) { return context ? CL_SUCCESS : CL_INVALID_CONTEXT; }
static cl_int program_done(cl_program built) { return built ? CL_SUCCESS : CL_INVALID_PROGRAM; }
static cl_int kernel_done(cl_kernel kernel) { return kernel ? CL_SUCCESS : CL_INVALID_KERNEL; }

static const struct opencl_functions stand_in = {
    .GetPlatformIDs = platforms_get,
    .GetPlatformInfo = platform_tell,
    .GetDeviceIDs = devices_get,
    .GetDeviceInfo = device_tell,
    .CreateContext = context_create,
    .ReleaseContext = context_done,
    .CreateCommandQueue = queue_create,
    .ReleaseCommandQueue = queue_done,
    .Finish = queue_done,
    .CreateProgramWithSource = program_create,
    .BuildProgram = program_build,
    .GetProgramInfo = program_tell,
    .ReleaseProgram = program_done,
    .CreateKernel = kernel_create,
    .ReleaseKernel = kernel_done,
    .GetKernelWorkGroupInfo = kernel_tell,
};

/* ----------------------------------------------------------------------------------------------------- all programs */

static void status_check(tc_status status) {
    if (!status) return;
    fprintf(stderr, "kernel_texts: %s: %s\n", name, tc_message());
    exit(1);
}

static const char *const type_names[] = {"u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64"};
static const char *const kind_names[] = {"uniform", "rectilinear", "curvilinear"};

/* Of types whose programs are the same, the first gives its name. */
static void classify_programs(tc_context *context) {
    const program *found;
    for (int type = TC_U8; type <= TC_F64; type++)
        for (int method = 0; tc_method_name((tc_method)method); method++)
            for (int more = 0; more < 4; more++) {
                const kernel_kind kind = {
                    .type = (tc_type)type, .method = (tc_method)method, .missing = more & 1, .closed = more & 2};
                snprintf(name, sizeof name, "classify-%s-%s%s%s", type_names[type], tc_method_name((tc_method)method),
                         more & 1 ? "-missing" : "", more & 2 ? "-closed" : "");
                status_check(program_get(context, PROGRAM_CLASSIFY, kind, &found));
            }
}

static void emit_programs(tc_context *context) {
    const program *found;
    for (int type = TC_U8; type <= TC_F64; type++)
        for (int method = 0; tc_method_name((tc_method)method); method++)
            for (int grid = GRID_UNIFORM; grid <= GRID_CURVILINEAR; grid++)
                for (int more = 0; more < 8; more++) {
                    const kernel_kind kind = {.grid = (unsigned)grid,
                                              .type = (tc_type)type,
                                              .method = (tc_method)method,
                                              .made = POSITIONS_ALONE | (more & 2 ? 1u << CHANNEL_NORMALS : 0),
                                              .missing = more & 1,
                                              .emits = true,
                                              .closed = more & 4};
                    snprintf(name, sizeof name, "emit-%s-%s-%s%s%s%s", type_names[type],
                             tc_method_name((tc_method)method), kind_names[grid], more & 1 ? "-missing" : "",
                             more & 2 ? "-normals" : "", more & 4 ? "-closed" : "");
                    status_check(program_get(context, PROGRAM_EMIT, kind, &found));
                }
}

static void snap_programs(tc_context *context) {
    const program *found;
    for (int type = TC_U8; type <= TC_F64; type++)
        for (int missing = 0; missing < 2; missing++) {
            const kernel_kind kind = {.type = (tc_type)type, .method = TC_METHOD_SNAP, .missing = missing};
            snprintf(name, sizeof name, "snap-%s%s", type_names[type], missing ? "-missing" : "");
            if (device_makes_vertices(context, kind.type))
                status_check(program_get(context, PROGRAM_SNAP, kind, &found));
        }
}

static void interval_programs(tc_context *context) {
    const program *found;
    for (int type = TC_U8; type <= TC_F64; type++)
        for (int grid = GRID_UNIFORM; grid <= GRID_CURVILINEAR; grid++)
            for (int missing = 0; missing < 2; missing++) {
                const kernel_kind kind = {.grid = (unsigned)grid,
                                          .type = (tc_type)type,
                                          .made = POSITIONS_ALONE,
                                          .missing = missing,
                                          .emits = true,
                                          .interval = true};
                snprintf(name, sizeof name, "interval-%s-%s%s", type_names[type], kind_names[grid],
                         missing ? "-missing" : "");
                if (device_makes_vertices(context, kind.type))
                    status_check(program_get(context, PROGRAM_INTERVAL, kind, &found));
            }
}

static void complex_programs(tc_context *context) {
    const program *found;
    for (int type = TC_U8; type <= TC_F64; type++) {
        const kernel_kind kind = {.grid = KIND_COMPLEX, .type = (tc_type)type};
        if (!device_makes_vertices(context, kind.type)) continue;
        snprintf(name, sizeof name, "complex-%s", type_names[type]);
        status_check(program_get(context, PROGRAM_COMPLEX, kind, &found));
        const kernel_kind interval = {.grid = KIND_COMPLEX, .type = (tc_type)type, .emits = true, .interval = true};
        snprintf(name, sizeof name, "complex-%s-interval", type_names[type]);
        status_check(program_get(context, PROGRAM_COMPLEX_INTERVAL, interval, &found));
        const kernel_kind cells = {.grid = KIND_COMPLEX, .type = (tc_type)type, .method = TC_METHOD_HYBRID};
        snprintf(name, sizeof name, "whole-%s", type_names[type]);
        status_check(program_get(context, PROGRAM_WHOLE, cells, &found));
        for (int whole = 0; whole < 2; whole++) {
            const kernel_kind closed = {.grid = KIND_COMPLEX,
                                        .type = (tc_type)type,
                                        .method = whole ? TC_METHOD_HYBRID : TC_METHOD_TETRA,
                                        .closed = true};
            snprintf(name, sizeof name, "%s-%s-closed", whole ? "whole" : "complex", type_names[type]);
            status_check(program_get(context, PROGRAM_COMPLEX_CAPS, closed, &found));
        }
    }
}

static void label_programs(tc_context *context) {
    static const tc_type types[] = {TC_U8, TC_U16, TC_U32};
    const program *found;
    for (size_t n = 0; n < sizeof types / sizeof *types; n++) {
        const kernel_kind kind = {.grid = KIND_LABELS, .type = types[n], .made = POSITIONS_ALONE, .emits = true};
        snprintf(name, sizeof name, "labels-%s", type_names[types[n]]);
        status_check(program_get(context, PROGRAM_LABELS, kind, &found));
    }
}

int main(int count, char **arguments) {
    const size_t kinds = sizeof device_kinds / sizeof device_kinds[0];
    tc_context_options options;
    tc_expert_options expert;
    tc_context *context = NULL;
    if (count == 4)
        while (device < device_kinds + kinds && strcmp(device->kind, arguments[1])) device++;
    if (count != 4 || device == device_kinds + kinds) {
        fprintf(stderr, "usage: kernel_texts nvidia|amd|plain|pocl WORK_ITEMS FOLDER\n");
        return 2;
    }
    folder = arguments[3];
    setenv("TETRACUBES_CACHE_DIR", "", 1); /* neither programs nor tuning of the user's */
    if (!opencl_lock()) opencl_unlock();   /* where there is a loader it is not asked again */
    cl = &stand_in;
    tc_context_options_init(&options);
    tc_expert_options_init(&expert);
    options.expert = &expert;
    options.device = "0";
    expert.work_items = (uint32_t)strtoul(arguments[2], NULL, 10);
    status_check(tc_context_create(&options, &context));
    classify_programs(context);
    emit_programs(context);
    snap_programs(context);
    interval_programs(context);
    complex_programs(context);
    label_programs(context);
    printf("%d programs, %u work-items\n", written, context->launch.work_items);
    tc_context_destroy(context);
    return 0;
}
