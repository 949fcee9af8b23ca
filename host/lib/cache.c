#include "cache.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PATH_BYTES = 4096 };

static const off_t file_bytes_most = 1 << 28;

/* Programs that run with another user's rights take no machine code from a place that the environment names. */
static bool folder_name(char path[PATH_BYTES]) {
    const char *own = secure_getenv("TETRACUBES_CACHE_DIR"), *xdg = secure_getenv("XDG_CACHE_HOME");
    const char *home = secure_getenv("HOME");
    int length = 0;
    if (own)
        length = snprintf(path, PATH_BYTES, "%s", own);
    else if (xdg && *xdg == '/')
        length = snprintf(path, PATH_BYTES, "%s/tetracubes", xdg);
    else if (home && *home == '/')
        length = snprintf(path, PATH_BYTES, "%s/.cache/tetracubes", home);
    return length > 0 && length < PATH_BYTES;
}

bool cache_is_on(void) {
    char folder[PATH_BYTES];
    return folder_name(folder);
}

static bool file_name(const char *name, const char *ending, char path[PATH_BYTES]) {
    char folder[PATH_BYTES];
    if (!folder_name(folder)) return false;
    int length = snprintf(path, PATH_BYTES, "%s/%s%s", folder, name, ending);
    return length > 0 && length < PATH_BYTES;
}

/* The folder of the file, with those above it: its own user's alone, as the XDG base directories are. */
static void folders_make(char *path) {
    for (char *at = strchr(path + 1, '/'); at; at = strchr(at + 1, '/')) {
        *at = 0;
        mkdir(path, 0700); /* one that exists, or cannot be made, shows when the file is opened */
        *at = '/';
    }
}

static bool read_all(int file, char *bytes, size_t count) {
    while (count) {
        ssize_t got = read(file, bytes, count);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        bytes += got;
        count -= (size_t)got;
    }
    return true;
}

static bool write_all(int file, const char *bytes, size_t count) {
    while (count) {
        ssize_t put = write(file, bytes, count);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return false;
        bytes += put;
        count -= (size_t)put;
    }
    return true;
}

bool cache_read(const char *name, cache_text *out) {
    char path[PATH_BYTES];
    struct stat about;
    *out = (cache_text){0};
    if (!file_name(name, "", path)) return false;
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) return false;
    bool done = !fstat(file, &about) && S_ISREG(about.st_mode) && about.st_size <= file_bytes_most;
    if (done) out->count = (size_t)about.st_size;
    if (done) done = (out->bytes = calloc(1, out->count + 1)) && read_all(file, out->bytes, out->count);
    close(file);
    if (done) return true;
    free(out->bytes);
    *out = (cache_text){0};
    return false;
}

bool cache_write(const char *name, const void *bytes, size_t count) {
    char path[PATH_BYTES], beside[PATH_BYTES];
    if (!file_name(name, "", path) || !file_name(name, ".XXXXXX", beside)) return false;
    folders_make(beside);
    int file = mkostemp(beside, O_CLOEXEC);
    if (file < 0) return false;
    bool done = write_all(file, bytes, count);
    done = !close(file) && done && !rename(beside, path);
    if (!done) unlink(beside);
    return done;
}
