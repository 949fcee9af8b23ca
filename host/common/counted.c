#include "counted.h"

#include <inttypes.h>
#include <stdio.h>

count_text counted(uint64_t count, const char *one, const char *several) {
    count_text t;
    snprintf(t.text, sizeof t.text, "%" PRIu64 " %s", count, count == 1 ? one : several);
    return t;
}
