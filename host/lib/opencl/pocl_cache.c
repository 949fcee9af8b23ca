/*
 * pocl_cache.c - where PoCL keeps its kernels, and whether this user may
 *
 * PoCL takes the folder of POCL_CACHE_DIR, else XDG_CACHE_HOME/pocl/kcache, else HOME/.cache/pocl/kcache, else
 * /tmp/pocl/kcache (lib/CL/pocl_cache.c of PoCL 3.1). Where it cannot make that folder it has no device. Users without
 * a home, as those of containers, meet this.
 */
#include "opencl/pocl_cache.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void find_folder(char *folder, size_t bytes) {
    const char *own = getenv("POCL_CACHE_DIR"), *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    if (own && *own)
        snprintf(folder, bytes, "%s", own);
    else if (cache && *cache)
        snprintf(folder, bytes, "%s/pocl/kcache", cache);
    else if (home && *home)
        snprintf(folder, bytes, "%s/.cache/pocl/kcache", home);
    else
        snprintf(folder, bytes, "/tmp/pocl/kcache");
}

/* Whether a folder can be made in this one. It is tried, as permissions do not reveal /proc or a full disk. */
static bool has_space(const char *folder) {
    static const char probe[] = "/.tetracubes-XXXXXX";
    char path[PATH_MAX + sizeof probe];
    snprintf(path, sizeof path, "%s%s", folder, probe);
    return mkdtemp(path) && rmdir(path) == 0;
}

bool pocl_cache_is_locked(char *folder, size_t bytes) {
    char path[PATH_MAX];
    struct stat about;
    find_folder(path, sizeof path);
    snprintf(folder, bytes, "%s", path);
    while (lstat(path, &about) != 0) { /* the folder, or the first one above it that exists */
        char *slash = strrchr(path, '/');
        if (errno != ENOENT) return true;
        if (!slash) return !has_space(".");
        if (slash == path) return !has_space("");
        *slash = '\0';
    }
    return !has_space(path);
}
