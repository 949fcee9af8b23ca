#include "sweep.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* The largest size along an axis; fields and types that are not here have no limit. */
static const struct {
    const char *field;
    int64_t u8, other, f32;
} largest[] = {
    {"sphere", 1024, 512, 1024}, {"gyroid", 1024, 512, 512},        {"empty", 1024, 512, 512},
    {"full", 512, 512, 512},     {"marschner-lobb", 512, 512, 512}, {"noise", 256, 256, 256},
};

int sweep_takes(const field *f, const int64_t dims[3], tc_type type) {
    for (size_t n = 0; n < sizeof largest / sizeof *largest; n++) {
        if (strcmp(largest[n].field, f->name) != 0) continue;
        int64_t limit = type == TC_U8 ? largest[n].u8 : type == TC_F32 ? largest[n].f32 : largest[n].other;
        return dims[0] <= limit && dims[1] <= limit && dims[2] <= limit;
    }
    return 1;
}

/* The number after the key in a file of lines "key number"; UINT64_MAX where there is none. */
static uint64_t file_number(const char *path, const char *key) {
    char line[256];
    uint64_t number = UINT64_MAX;
    FILE *file = fopen(path, "r");
    if (!file) return number;
    while (number == UINT64_MAX && fgets(line, sizeof line, file))
        if (strncmp(line, key, strlen(key)) == 0 && sscanf(line + strlen(key), "%" SCNu64, &number) != 1)
            number = UINT64_MAX;
    fclose(file);
    return number;
}

/* The memory that is left in the control group which the process sees as its root. Its page cache counts as free. */
static uint64_t group_memory(void) {
    uint64_t limit = file_number("/sys/fs/cgroup/memory.max", "");
    uint64_t used = file_number("/sys/fs/cgroup/memory.current", "");
    uint64_t cache = file_number("/sys/fs/cgroup/memory.stat", "inactive_file ");
    if (limit == UINT64_MAX || used == UINT64_MAX) return UINT64_MAX;
    if (cache <= used) used -= cache;
    return used < limit ? limit - used : 0;
}

uint64_t sweep_memory(void) {
    uint64_t kilobytes = file_number("/proc/meminfo", "MemAvailable:"), group = group_memory();
    uint64_t bytes = kilobytes == UINT64_MAX ? UINT64_MAX : kilobytes << 10;
    uint64_t least = bytes < group ? bytes : group;
    return least == UINT64_MAX ? least : least / 4 * 3;
}
