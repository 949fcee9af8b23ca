#include "name_pattern.h"

#include "exit_status.h"
#include "failure.h"

#include <stdlib.h>
#include <string.h>

static int is_sign(const char *at) { return at[0] == '%' && at[1] == '%'; }

int name_pattern_has_placeholder(const char *pattern) {
    for (const char *c = pattern; *c; c += 1 + is_sign(c))
        if (*c == '%' && !is_sign(c)) return 1;
    return 0;
}

int name_pattern_check(const char *option, const char *pattern, size_t value_count, const char *kind) {
    if (value_count < 2 || name_pattern_has_placeholder(pattern)) return 0;
    return fail(STATUS_USAGE, "%s %s: with several %ss the name needs a %%, which stands for the %s", option, pattern,
                kind, kind);
}

/* The last dot of the name's last part, or its end. */
static const char *ending_of(const char *path) {
    const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
    return dot ? dot : path + strlen(path);
}

char *name_pattern_fill(const char *pattern, const char *value, const char *behind) {
    const char *ending = ending_of(pattern);
    size_t bytes = strlen(behind) + 1;
    for (const char *c = pattern; *c; c++) bytes += *c == '%' ? strlen(value) + 1 : 1;
    char *path = malloc(bytes), *at = path;
    for (const char *c = pattern; path; c++) {
        if (c == ending) at = stpcpy(at, behind);
        if (!*c) break;
        if (*c != '%' || is_sign(c))
            *at++ = *c;
        else
            at = stpcpy(at, value);
        c += is_sign(c);
    }
    if (path)
        *at = '\0';
    else
        fail(STATUS_FAILED, "out of memory for the name of the output");
    return path;
}
