#include "opencl/device.h"

#include "failure.h"
#include "base/float_environment.h"
#include "opencl/pocl_cache.h"
#include "base/structs.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { DEVICES_MAX = 256, PLATFORMS_MAX = 32 };

static const cl_int platform_not_found = -1001; /* CL_PLATFORM_NOT_FOUND_KHR: the loader has no driver */

typedef struct device_list {
    int count;
    cl_int error; /* of the last platform that did not tell its devices */
    device_choice devices[DEVICES_MAX];
} device_list;

typedef struct platform_list {
    cl_uint count;
    cl_platform_id platforms[PLATFORMS_MAX];
} platform_list;

static tc_status platform_list_make(platform_list *list) {
    list->count = 0;
    cl_int error = cl->GetPlatformIDs(PLATFORMS_MAX, list->platforms, &list->count);
    if (error && error != platform_not_found)
        return (tc_status)fail(TC_ERROR_DEVICE,
                               "OpenCL does not tell its platforms (%d); the reference engine needs none", (int)error);
    if (error || list->count == 0)
        return (tc_status)fail(
            TC_ERROR_DEVICE,
            "no OpenCL platform was found: none is installed, or what is installed does not load, as where memory or "
            "open "
            "files are limited (ulimit -v, -n) (for the CPU on Debian: apt install pocl-opencl-icd; for a GPU: its "
            "driver's OpenCL package); the reference engine needs none");
    if (list->count > PLATFORMS_MAX) list->count = PLATFORMS_MAX;
    opencl_awake();
    return TC_OK;
}

/* Appends the devices of platform p, which wakes its driver. A platform without devices is skipped. */
static void devices_append(device_list *list, const platform_list *platforms, cl_uint p) {
    cl_device_id devices[DEVICES_MAX];
    cl_uint device_count = 0, capacity = (cl_uint)(DEVICES_MAX - list->count);
    if (capacity == 0) return;
    cl_int error = cl->GetDeviceIDs(platforms->platforms[p], CL_DEVICE_TYPE_ALL, capacity, devices, &device_count);
    if (error && error != CL_DEVICE_NOT_FOUND) list->error = error;
    if (error) return;
    for (cl_uint d = 0; d < device_count && d < capacity; d++)
        list->devices[list->count++] = (device_choice){platforms->platforms[p], devices[d], (int)p, (int)d};
}

static bool has_pocl(const platform_list *list) {
    for (cl_uint p = 0; p < list->count; p++) {
        char name[128] = "";
        cl_int error = cl->GetPlatformInfo(list->platforms[p], CL_PLATFORM_NAME, sizeof name - 1, name, NULL);
        if (!error && strstr(name, "Portable Computing Language")) return true;
    }
    return false;
}

static tc_status no_device(const platform_list *platforms, const device_list *list) {
    if (list->error)
        return (tc_status)fail(
            TC_ERROR_DEVICE,
            "an OpenCL platform does not tell its devices (%d), and none of the %u installed has one; "
            "the reference engine needs none",
            (int)list->error, platforms->count);
    char folder[512];
    if (has_pocl(platforms) && pocl_cache_is_locked(folder, sizeof folder))
        return (tc_status)fail(TC_ERROR_DEVICE,
                               "PoCL, the OpenCL of the CPU, is installed and has no device, as it cannot write its "
                               "cache folder %s: set POCL_CACHE_DIR to a folder that this user may write, or HOME; the "
                               "reference engine needs none",
                               folder);
    return (tc_status)fail(
        TC_ERROR_DEVICE,
        "the %u OpenCL platform(s) installed have no device, or memory or open files are too limited for "
        "one (ulimit -v, -n) (for the CPU on Debian: apt install pocl-opencl-icd); the reference "
        "engine needs none",
        platforms->count);
}

static tc_status device_list_make(device_list *list) {
    platform_list platforms;
    list->count = 0;
    list->error = CL_SUCCESS;
    tc_status status = platform_list_make(&platforms);
    for (cl_uint p = 0; !status && p < platforms.count; p++) devices_append(list, &platforms, p);
    return status || list->count ? status : no_device(&platforms, list);
}

/* Queries to a device; error: the first failure. */
typedef struct questions {
    cl_device_id device;
    cl_int error;
} questions;

/* Queries; false where there is no answer. A query that the device's OpenCL version does not know is no failure. */
static bool ask(questions *q, cl_device_info what, size_t bytes, void *answer) {
    cl_int error = cl->GetDeviceInfo(q->device, what, bytes, answer, NULL);
    if (error && error != CL_INVALID_VALUE && !q->error) q->error = error;
    return !error;
}

static void text_get(questions *q, cl_device_info what, char *out, size_t bytes) {
    char text[512] = "";
    bool told = ask(q, what, sizeof text - 1, text);
    snprintf(out, bytes, "%.*s", (int)bytes - 1, told ? text : "");
}

static uint64_t number_get(questions *q, cl_device_info what, size_t bytes) {
    uint64_t value = 0;
    return ask(q, what, bytes, &value) ? value : 0; /* little-endian hosts only, as the sign words are */
}

static const char *type_name(questions *q) {
    uint64_t type = number_get(q, CL_DEVICE_TYPE, sizeof(cl_device_type));
    return type & CL_DEVICE_TYPE_GPU           ? "gpu"
           : type & CL_DEVICE_TYPE_ACCELERATOR ? "accelerator"
           : type & CL_DEVICE_TYPE_CPU         ? "cpu"
                                               : "other";
}

static void platform_get(questions *q, tc_device_info *info) {
    cl_platform_id platform = NULL;
    cl_int error = cl->GetDeviceInfo(q->device, CL_DEVICE_PLATFORM, sizeof platform, &platform, NULL);
    if (!error) error = cl->GetPlatformInfo(platform, CL_PLATFORM_NAME, sizeof info->platform, info->platform, NULL);
    if (error) info->platform[0] = 0;
    if (error && !q->error) q->error = error;
}

/* The limits that every extraction needs. */
static tc_status limits_check(const tc_device_info *info) {
    const char *none = !info->compute_units         ? "compute units"
                       : !info->max_work_group_size ? "work-groups"
                       : !info->global_memory_bytes ? "memory"
                       : !info->max_buffer_bytes    ? "buffers"
                                                    : NULL;
    return none ? (tc_status)fail(TC_ERROR_DEVICE, "%s says that it has no %s: its driver does not work", info->name,
                                  none)
                : TC_OK;
}

tc_status device_describe(cl_device_id device, tc_device_info *info) {
    questions q = {device, CL_SUCCESS};
    memset(info, 0, sizeof *info);
    info->struct_size = sizeof *info;
    info->platform_index = info->device_index = -1;
    platform_get(&q, info);
    text_get(&q, CL_DEVICE_NAME, info->name, sizeof info->name);
    text_get(&q, CL_DEVICE_VERSION, info->version, sizeof info->version);
    text_get(&q, CL_DRIVER_VERSION, info->driver, sizeof info->driver);
    snprintf(info->type, sizeof info->type, "%s", type_name(&q));
    info->compute_units = (uint32_t)number_get(&q, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof(cl_uint));
    info->max_work_group_size = number_get(&q, CL_DEVICE_MAX_WORK_GROUP_SIZE, sizeof(size_t));
    info->global_memory_bytes = number_get(&q, CL_DEVICE_GLOBAL_MEM_SIZE, sizeof(cl_ulong));
    info->max_buffer_bytes = number_get(&q, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof(cl_ulong));
    info->local_memory_bytes = number_get(&q, CL_DEVICE_LOCAL_MEM_SIZE, sizeof(cl_ulong));
    info->shares_host_memory = number_get(&q, CL_DEVICE_HOST_UNIFIED_MEMORY, sizeof(cl_bool)) != 0;
    info->has_fp64 = number_get(&q, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof(cl_device_fp_config)) != 0;
    info->rounds_division = (number_get(&q, CL_DEVICE_SINGLE_FP_CONFIG, sizeof(cl_device_fp_config)) &
                             CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
    if (q.error)
        return (tc_status)fail(TC_ERROR_DEVICE, "device %s does not tell what it can do (%d): its driver does not work",
                               *info->name ? info->name : "without a name", (int)q.error);
    return limits_check(info);
}

static bool text_contains(const char *text, const char *part) {
    size_t length = strlen(part);
    for (; *text; text++)
        if (!strncasecmp(text, part, length)) return true;
    return false;
}

/* "3" or "1:0". */
static bool indices_match(const char *specification, int index, const device_choice *d, bool *is_index) {
    char *end;
    long first = strtol(specification, &end, 10);
    *is_index = end > specification && (*end == 0 || *end == ':');
    if (!*is_index) return false;
    if (*end == 0) return first == index;
    const char *second = end + 1;
    long device = strtol(second, &end, 10);
    *is_index = end > second && *end == 0;
    return *is_index && first == d->platform_index && device == d->device_index;
}

/* The length of the type that "gpu" or "gpu:1" begins with, 0 where there is none; *number: 1, or 0 of "gpu". */
static size_t type_length(const char *specification, long *number) {
    static const char *const types[] = {"cpu", "gpu", "accelerator"};
    *number = 0;
    for (size_t n = 0; n < sizeof types / sizeof *types; n++) {
        const size_t length = strlen(types[n]);
        if (strncasecmp(specification, types[n], length) != 0) continue;
        if (!specification[length]) return length;
        char *end = NULL;
        if (specification[length] == ':') *number = strtol(specification + length + 1, &end, 10);
        if (end > specification + length + 1 && !*end && *number >= 0) return length;
    }
    *number = 0;
    return 0;
}

static bool device_matches(const char *specification, int index, const device_choice *d) {
    bool is_index;
    long number;
    tc_device_info info;
    bool same = indices_match(specification, index, d, &is_index);
    const size_t type = type_length(specification, &number);
    if (is_index) return same;
    if (type) {
        const char *own = type_name(&(questions){d->device, CL_SUCCESS});
        return strlen(own) == type && !strncasecmp(specification, own, type);
    }
    if (device_describe(d->device, &info)) return false;
    return text_contains(info.name, specification) || text_contains(info.platform, specification);
}

/* Stops at the platform of the device: waking the drivers of further platforms may take long. */
tc_status device_choose(const char *specification, device_choice *choice) {
    platform_list platforms;
    device_list list = {0};
    tc_status status = platform_list_make(&platforms);
    if (status) return status;
    const char *origin = specification ? "" : " (from TETRACUBES_DEVICE)";
    if (!specification) specification = getenv("TETRACUBES_DEVICE");
    const char *wanted = specification && *specification ? specification : "cpu";
    long number; /* of those that match; beyond 0 where it is one of a type */
    (void)type_length(wanted, &number);
    for (cl_uint p = 0; p < platforms.count; p++) {
        int n = list.count;
        devices_append(&list, &platforms, p);
        for (; n < list.count; n++)
            if (device_matches(wanted, n, &list.devices[n]) && number-- == 0) {
                *choice = list.devices[n];
                return TC_OK;
            }
    }
    if (!list.count) return no_device(&platforms, &list);
    if (specification && *specification)
        return (tc_status)fail(TC_ERROR_DEVICE,
                               "no device \"%s\"%s among the %d of this machine: give an index, "
                               "platform:device, cpu, gpu, gpu:1 (the second) or part of a name",
                               specification, origin, list.count);
    *choice = list.devices[0];
    return TC_OK;
}

bool device_find(cl_device_id device, int *platform_index, int *device_index) {
    device_list list;
    tc_status status = opencl_lock();
    if (status) return false;
    status = device_list_make(&list);
    opencl_unlock();
    for (int n = 0; n < list.count && !status; n++) {
        *platform_index = list.devices[n].platform_index;
        *device_index = list.devices[n].device_index;
        if (list.devices[n].device == device) return true;
    }
    return false;
}

tc_status tc_device_count(int *count) {
    FLOAT_ENVIRONMENT_DEFAULT;
    device_list list;
    if (!count) return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_device_count needs a place for the count");
    *count = 0;
    tc_status status = opencl_lock();
    if (status) return status;
    status = device_list_make(&list);
    opencl_unlock();
    if (!status) *count = list.count;
    return status;
}

tc_status tc_device_get(int index, tc_device_info *info) {
    FLOAT_ENVIRONMENT_DEFAULT;
    device_list list;
    tc_device_info found;
    tc_status status = struct_clear(info, sizeof *info, "tc_device_get: info");
    if (!status) status = opencl_lock();
    if (status) return status;
    status = device_list_make(&list);
    if (!status && (index < 0 || index >= list.count))
        status =
            (tc_status)fail(TC_ERROR_ARGUMENT, "device %d: this machine has devices 0 to %d", index, list.count - 1);
    if (!status) status = device_describe(list.devices[index].device, &found);
    opencl_unlock();
    if (status) return status;
    found.platform_index = list.devices[index].platform_index;
    found.device_index = list.devices[index].device_index;
    struct_copy_out(info, &found);
    return TC_OK;
}
