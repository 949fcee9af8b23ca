/*
 * The mode that lacks something: a device that says it has no double precision.
 */
#include "layer.h"

#include <string.h>

static cl_icd_dispatch below;
static bool lacks_fp64;

static cl_int CL_API_CALL device_info(cl_device_id device, cl_device_info what, size_t bytes, void *value,
                                      size_t *bytes_ret) {
    cl_int error = below.clGetDeviceInfo(device, what, bytes, value, bytes_ret);
    if (!error && lacks_fp64 && what == CL_DEVICE_DOUBLE_FP_CONFIG && value)
        memset(value, 0, sizeof(cl_device_fp_config));
    return error;
}

static void install(cl_icd_dispatch *table) {
    below = *table;
    table->clGetDeviceInfo = device_info;
}

static bool command(char *const *words, int count) {
    lacks_fp64 = count == 2 && !strcmp(words[1], "fp64");
    return lacks_fp64 || (count == 2 && !strcmp(words[1], "off"));
}

const layer_mode lacks_mode = {"lacks", install, command};
