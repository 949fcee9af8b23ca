/*
 * The mode that lacks something: a device that says it has no double precision, or little local memory, or kernels that
 * run with few work-items.
 */
#include "layer.h"

#include <stdlib.h>
#include <string.h>

static cl_icd_dispatch below;
static bool lacks_fp64, lacks_fame, lacks_name;
static cl_ulong local_bytes;              /* 0: as it is */
static size_t group_most;                 /* of the device; 0: as it is */
static size_t items_most, items_multiple; /* 0: as they are */
static char kernel_name[64];              /* of those limits; "*": of all kernels */

static cl_int CL_API_CALL device_info(cl_device_id device, cl_device_info what, size_t bytes, void *value,
                                      size_t *bytes_ret) {
    cl_int error = below.clGetDeviceInfo(device, what, bytes, value, bytes_ret);
    if (!error && lacks_fp64 && what == CL_DEVICE_DOUBLE_FP_CONFIG && value)
        memset(value, 0, sizeof(cl_device_fp_config));
    if (!error && local_bytes && what == CL_DEVICE_LOCAL_MEM_SIZE && value)
        memcpy(value, &local_bytes, sizeof local_bytes);
    if (!error && lacks_fame && what == CL_DRIVER_VERSION && value && bytes) ((char *)value)[0] = '9'; /* 9.1 of 3.1 */
    if (!error && group_most && what == CL_DEVICE_MAX_WORK_GROUP_SIZE && value)
        memcpy(value, &group_most, sizeof group_most);
    return error;
}

static cl_int CL_API_CALL platform_info(cl_platform_id platform, cl_platform_info what, size_t bytes, void *value,
                                        size_t *bytes_ret) {
    cl_int error = below.clGetPlatformInfo(platform, what, bytes, value, bytes_ret);
    if (!error && lacks_name && what == CL_PLATFORM_NAME && value && bytes) memset(value, 'x', strlen(value));
    return error;
}

static bool is_limited(cl_kernel kernel) {
    char name[sizeof kernel_name] = "";
    if (!items_most) return false;
    below.clGetKernelInfo(kernel, CL_KERNEL_FUNCTION_NAME, sizeof name, name, NULL);
    return !strcmp(kernel_name, "*") || !strcmp(name, kernel_name);
}

static cl_int CL_API_CALL work_group_info(cl_kernel kernel, cl_device_id device, cl_kernel_work_group_info what,
                                          size_t bytes, void *value, size_t *bytes_ret) {
    cl_int error = below.clGetKernelWorkGroupInfo(kernel, device, what, bytes, value, bytes_ret);
    if (error || !value || !is_limited(kernel)) return error;
    if (what == CL_KERNEL_WORK_GROUP_SIZE) memcpy(value, &items_most, sizeof items_most);
    if (what == CL_KERNEL_PREFERRED_WORK_GROUP_SIZE_MULTIPLE) memcpy(value, &items_multiple, sizeof items_multiple);
    return CL_SUCCESS;
}

static cl_int CL_API_CALL launch(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t *first,
                                 const size_t *global, const size_t *local, ENTRY_WAITS) {
    if (is_limited(kernel) && (!local || *local > items_most || *local % items_multiple ||
                               items_most - *local >= items_multiple)) /* fewer than there could be */
        return CL_INVALID_WORK_GROUP_SIZE;
    return below.clEnqueueNDRangeKernel(queue, kernel, dimensions, first, global, local, wait_count, waits, event);
}

static void install(cl_icd_dispatch *table) {
    below = *table;
    table->clGetDeviceInfo = device_info;
    table->clGetPlatformInfo = platform_info;
    table->clGetKernelWorkGroupInfo = work_group_info;
    table->clEnqueueNDRangeKernel = launch;
}

static bool command(char *const *words, int count) {
    lacks_fp64 = count == 2 && !strcmp(words[1], "fp64");
    lacks_fame = count == 2 && !strcmp(words[1], "fame");
    local_bytes = count == 3 && !strcmp(words[1], "local") ? strtoul(words[2], NULL, 10) : 0;
    lacks_name = count == 3 && !strcmp(words[1], "name");
    group_most = lacks_name ? strtoul(words[2], NULL, 10) : 0;
    items_most = count == 5 && !strcmp(words[1], "items") ? strtoul(words[3], NULL, 10) : 0;
    items_multiple = items_most ? strtoul(words[4], NULL, 10) : 0;
    if (items_most && !items_multiple) return false;
    strncpy(kernel_name, count == 5 ? words[2] : "", sizeof kernel_name - 1);
    return lacks_fp64 || lacks_fame || lacks_name || local_bytes || items_most ||
           (count == 2 && !strcmp(words[1], "off"));
}

const layer_mode lacks_mode = {"lacks", install, command};
