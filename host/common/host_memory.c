/* host_memory.c - from /proc, control groups (version 2) and limits of the process; see host_memory.h */
#include "host_memory.h"

#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

static uint64_t least(uint64_t a, uint64_t b) { return a < b ? a : b; }

static uint64_t minus(uint64_t a, uint64_t b) { return a > b ? a - b : 0; }

/* The number behind a name in a file of lines, in units of `unit`; otherwise when it is not there. */
static uint64_t number_in(const char *path, const char *name, uint64_t unit, uint64_t otherwise) {
    char line[256];
    unsigned long long number;
    FILE *file = fopen(path, "r");
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, name, strlen(name)) == 0 && sscanf(line + strlen(name), "%llu", &number) == 1) {
            otherwise = unit * number;
            break;
        }
    if (file) fclose(file);
    return otherwise;
}

/* Its group may use so much more; pages of files, which the system takes back, count as free. */
static uint64_t group_available(void) {
    char line[512], path[600];
    FILE *file = fopen("/proc/self/cgroup", "r");
    char *group = NULL;
    while (file && !group && fgets(line, sizeof line, file))
        if (strncmp(line, "0::", 3) == 0) group = line + 3;
    if (file) fclose(file);
    if (!group) return UINT64_MAX;
    group[strcspn(group, "\n")] = '\0';
    snprintf(path, sizeof path, "/sys/fs/cgroup%s/memory.max", group);
    const uint64_t most = number_in(path, "", 1, UINT64_MAX);
    if (most == UINT64_MAX) return UINT64_MAX;
    snprintf(path, sizeof path, "/sys/fs/cgroup%s/memory.stat", group);
    return minus(most, number_in(path, "anon ", 1, 0));
}

static uint64_t limit_left(int resource, const char *used) {
    struct rlimit limit;
    if (getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return UINT64_MAX;
    return minus(limit.rlim_cur, number_in("/proc/self/status", used, 1024, 0));
}

uint64_t host_memory_available(void) {
    uint64_t bytes = number_in("/proc/meminfo", "MemAvailable:", 1024, UINT64_MAX);
    bytes = least(bytes, group_available());
    bytes = least(bytes, limit_left(RLIMIT_DATA, "VmData:"));
    return least(bytes, limit_left(RLIMIT_AS, "VmSize:"));
}
