/* host_memory.c - from /proc, control groups (version 2) and limits of the process; see host_memory.h */
#include "host_memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

enum { GROUP_PATH_BYTES = 4096 };

static uint64_t least(uint64_t a, uint64_t b) { return a < b ? a : b; }

static uint64_t minus(uint64_t a, uint64_t b) { return a > b ? a - b : 0; }

/* The number behind a name in a file of lines, in units of `unit`; otherwise when it is not there. */
static uint64_t number_in(const char *path, const char *name, uint64_t unit, uint64_t otherwise) {
    char line[256];
    FILE *file = fopen(path, "r");
    while (file && fgets(line, sizeof line, file)) {
        char *digits = line + strlen(name), *end = digits;
        if (strncmp(line, name, strlen(name)) != 0) continue;
        const unsigned long long number = strtoull(digits, &end, 10);
        if (end == digits) continue;
        otherwise = unit * number;
        break;
    }
    if (file) fclose(file);
    return otherwise;
}

/* What the group in this folder may still use; pages of files, which the system takes back, count as free. */
static uint64_t group_left(const char *folder) {
    char path[GROUP_PATH_BYTES + 32];
    snprintf(path, sizeof path, "%s/memory.max", folder);
    const uint64_t most = number_in(path, "", 1, UINT64_MAX); /* none: "max" */
    if (most == UINT64_MAX) return UINT64_MAX;
    snprintf(path, sizeof path, "%s/memory.current", folder);
    const uint64_t used = number_in(path, "", 1, 0);
    snprintf(path, sizeof path, "%s/memory.stat", folder);
    const uint64_t files = number_in(path, "active_file ", 1, 0) + number_in(path, "inactive_file ", 1, 0);
    return minus(most, minus(used, files));
}

uint64_t group_memory_available(const char *membership, const char *hierarchy) {
    char line[GROUP_PATH_BYTES], folder[GROUP_PATH_BYTES];
    const char *group = NULL;
    uint64_t bytes = UINT64_MAX;
    FILE *file = fopen(membership, "r");
    while (file && !group && fgets(line, sizeof line, file))
        if (strncmp(line, "0::/", 4) == 0 && strchr(line, '\n')) group = line + 3;
    if (file) fclose(file);
    if (!group) return UINT64_MAX;
    const int length = snprintf(folder, sizeof folder, "%s%.*s", hierarchy, (int)strcspn(group, "\n"), group);
    if (length >= (int)sizeof folder) return UINT64_MAX;
    for (char *end; strlen(folder) >= strlen(hierarchy); *end = '\0') {
        bytes = least(bytes, group_left(folder));
        if (!(end = strrchr(folder, '/'))) break;
    }
    return bytes;
}

static uint64_t limit_left(int resource, const char *used) {
    struct rlimit limit;
    if (getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return UINT64_MAX;
    return minus(limit.rlim_cur, number_in("/proc/self/status", used, 1024, 0));
}

uint64_t host_memory_available(void) {
    uint64_t bytes = number_in("/proc/meminfo", "MemAvailable:", 1024, UINT64_MAX);
    bytes = least(bytes, group_memory_available("/proc/self/cgroup", "/sys/fs/cgroup"));
    bytes = least(bytes, limit_left(RLIMIT_DATA, "VmData:"));
    return least(bytes, limit_left(RLIMIT_AS, "VmSize:"));
}
