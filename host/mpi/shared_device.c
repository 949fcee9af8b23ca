#include "shared_device.h"

#include "exit_status.h"
#include "failure.h"
#include "tetracubes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char mark[] = "%r";

/* Devices that "cpu:", "gpu:", "0:", a platform, or nothing, all of them, stands before the number of. */
static int devices_behind(const char *before, size_t length) {
    int all = 0, count = 0;
    if (tc_device_count(&all) != TC_OK) return 0; /* starting the device tells why */
    for (int n = 0; n < all; n++) {
        tc_device_info info = {.struct_size = sizeof info};
        char platform[16];
        if (tc_device_get(n, &info) != TC_OK) continue;
        snprintf(platform, sizeof platform, "%d:", info.platform_index);
        const size_t type = strlen(info.type);
        const int is_type = length == type + 1 && strncmp(before, info.type, type) == 0 && before[type] == ':';
        const int is_platform = length == strlen(platform) && strncmp(before, platform, length) == 0;
        count += !length || is_type || is_platform;
    }
    return count;
}

int shared_device_choose(const char *specification, int node_rank, int node_size, char out[DEVICE_BYTES],
                         int *device_count) {
    const char *at = strstr(specification, mark);
    *device_count = 0;
    if (!at) at = specification + strlen(specification);
    const size_t before = (size_t)(at - specification);
    const char *behind = *at ? at + sizeof mark - 1 : at;
    const int devices = *at ? devices_behind(specification, before) : 0;
    const int number = devices ? node_rank % devices : node_rank;
    if (devices && devices < node_size) *device_count = devices;
    const int length = *at ? snprintf(out, DEVICE_BYTES, "%.*s%d%s", (int)before, specification, number, behind)
                           : snprintf(out, DEVICE_BYTES, "%s", specification);
    return length < DEVICE_BYTES ? 0 : fail(STATUS_USAGE, "--device: '%.40s...' is too long", specification);
}
