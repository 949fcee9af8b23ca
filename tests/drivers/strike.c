/*
 * strike.c - misfortune at an exact moment: preloaded into the tool, between it and the system's calls on files
 *
 * The environment says what happens, each when it has been counted to on temporary files of output (names in .tmp):
 *     STRIKE_WRITE="N signal S"   before write N, from 1, the process gets signal S
 *     STRIKE_WRITE="N error E"    write N, and those after it, fail with error number E, having written half of it
 *     STRIKE_CLOSE=E              closing fails with error number E
 *     STRIKE_RENAME=E             renaming fails so
 *     STRIKE_OPEN=E               making one fails so
 * and to the input, when PATH has been opened and mapped and is closed for the Nth time:
 *     STRIKE_TRUNCATE="N BYTES PATH"    it is cut to BYTES
 *     STRIKE_UNLINK="N 0 PATH"          it is removed
 *     STRIKE_ALTER="N AT PATH"          a byte of it, AT that place, becomes another
 */
#undef _FILE_OFFSET_BITS /* else open is another name of open64 */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define EXPORT     __attribute__((visibility("default")))
#define NEXT(name) ((__typeof__(&name))(size_t)dlsym(RTLD_NEXT, #name))

static int path_of(int file, char path[PATH_MAX]) {
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t length = readlink(link, path, PATH_MAX - 1);
    path[length > 0 ? length : 0] = '\0';
    return length > 0;
}

static int is_temporary(const char *path) {
    size_t length = strlen(path);
    return length > 4 && !strcmp(path + length - 4, ".tmp");
}

static int error_of(const char *variable) {
    const char *text = getenv(variable);
    return text ? atoi(text) : 0;
}

EXPORT ssize_t write(int file, const void *from, size_t bytes) {
    static int count;
    char path[PATH_MAX], what[16] = "";
    int at = 0, number = 0;
    const char *strike = getenv("STRIKE_WRITE");
    if (!strike || sscanf(strike, "%d %15s %d", &at, what, &number) != 3 || !path_of(file, path) || !is_temporary(path))
        return NEXT(write)(file, from, bytes);
    count++;
    if (!strcmp(what, "signal") && count == at) raise(number);
    if (!strcmp(what, "error") && count == at && bytes > 1) return NEXT(write)(file, from, bytes / 2);
    if (strcmp(what, "error") || count < at) return NEXT(write)(file, from, bytes);
    errno = number;
    return -1;
}

EXPORT int open(const char *path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    mode_t mode = flags & O_CREAT ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    int error = is_temporary(path) ? error_of("STRIKE_OPEN") : 0;
    if (!error) return NEXT(open)(path, flags, mode);
    errno = error;
    return -1;
}

EXPORT int open64(const char *path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    mode_t mode = flags & O_CREAT ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    return open(path, flags, mode);
}

EXPORT int rename(const char *from, const char *to) {
    int error = is_temporary(from) ? error_of("STRIKE_RENAME") : 0;
    if (!error) return NEXT(rename)(from, to);
    errno = error;
    return -1;
}

/* True where the variable strikes this file now. */
static int is_struck(const char *variable, const char *path, int closing, long *bytes) {
    char name[PATH_MAX] = "";
    int at = 0;
    const char *strike = getenv(variable);
    return strike && sscanf(strike, "%d %ld %4095s", &at, bytes, name) == 3 && at == closing && !strcmp(name, path);
}

static void byte_alter(const char *path, long at) {
    unsigned char byte = 0;
    int file = open(path, O_RDWR | O_CLOEXEC);
    if (file < 0 || pread(file, &byte, 1, at) != 1) return;
    byte ^= 0x40;
    if (pwrite(file, &byte, 1, at) != 1) perror("strike: pwrite");
    NEXT(close)(file);
}

static void strike_input(const char *path) {
    static int closing;
    const char *strike = getenv("STRIKE_TRUNCATE");
    long bytes;
    if (!strike) strike = getenv("STRIKE_UNLINK");
    if (!strike) strike = getenv("STRIKE_ALTER");
    if (!strike || !strstr(strike, path)) return;
    closing++;
    if (is_struck("STRIKE_TRUNCATE", path, closing, &bytes) && truncate(path, bytes)) perror("strike: truncate");
    if (is_struck("STRIKE_UNLINK", path, closing, &bytes)) unlink(path);
    if (is_struck("STRIKE_ALTER", path, closing, &bytes)) byte_alter(path, bytes);
}

EXPORT int close(int file) {
    char path[PATH_MAX];
    int known = path_of(file, path), error = known && is_temporary(path) ? error_of("STRIKE_CLOSE") : 0;
    if (known) strike_input(path);
    int result = NEXT(close)(file);
    if (!error) return result;
    errno = error;
    return -1;
}
