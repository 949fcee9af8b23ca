#include "opencl/cache.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PATH_BYTES = 4096, NAME_BYTES = 96 };

static const off_t file_bytes_most = 1 << 28;

/* A program that runs with another user's rights must not load machine code from a folder that the environment names.
 */
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

/* Whether a file is owned by this user or root, and nobody else may write to it. */
static bool is_trusted(int file) {
    struct stat about;
    return !fstat(file, &about) && (about.st_uid == geteuid() || about.st_uid == 0) &&
           !(about.st_mode & (S_IWGRP | S_IWOTH));
}

/* The folder, opened; -1 where there is none that is trusted. Files in it are opened through it, so that nobody can put
 * another in its place meanwhile. */
static int folder_open(const char *path) {
    int folder = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0 || is_trusted(folder)) return folder;
    close(folder);
    return -1;
}

bool cache_path(const char *name, char *path, size_t bytes) {
    char folder[PATH_BYTES];
    return folder_name(folder) && snprintf(path, bytes, "%s/%s", folder, name) < (int)bytes;
}

/* Makes the folder and those above it, accessible to this user only, as XDG base directories are. */
static void folders_make(char *path) {
    for (char *at = strchr(path + 1, '/'); at; at = strchr(at + 1, '/')) {
        *at = 0;
        mkdir(path, 0700); /* one that exists, or cannot be made, shows when the folder is opened */
        *at = '/';
    }
    mkdir(path, 0700);
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

static bool file_read(int file, cache_text *out) {
    struct stat about;
    bool done = !fstat(file, &about) && S_ISREG(about.st_mode) && about.st_size <= file_bytes_most && is_trusted(file);
    if (done) out->count = (size_t)about.st_size;
    if (done) done = (out->bytes = calloc(1, out->count + 1)) && read_all(file, out->bytes, out->count);
    if (done) return true;
    free(out->bytes);
    *out = (cache_text){0};
    return false;
}

bool cache_read(const char *name, cache_text *out) {
    char path[PATH_BYTES];
    *out = (cache_text){0};
    int folder = folder_name(path) ? folder_open(path) : -1;
    if (folder < 0) return false;
    int file = openat(folder, name, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    bool done = file >= 0 && file_read(file, out);
    if (file >= 0) close(file);
    close(folder);
    return done;
}

/* Creates a temporary file with a name that no other process uses. */
static int beside_make(int folder, const char *name, char beside[NAME_BYTES]) {
    int file = -1;
    for (unsigned n = 0; n < 100 && file < 0 && (n == 0 || errno == EEXIST); n++) {
        int length = snprintf(beside, NAME_BYTES, "%s.%ld-%u", name, (long)getpid(), n);
        if (length < 0 || length >= NAME_BYTES) return -1;
        file = openat(folder, beside, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    }
    return file;
}

bool cache_write(const char *name, const void *bytes, size_t count) {
    char path[PATH_BYTES], beside[NAME_BYTES];
    if (!folder_name(path)) return false;
    folders_make(path);
    int folder = folder_open(path);
    if (folder < 0) return false;
    int file = beside_make(folder, name, beside);
    bool done = file >= 0 && write_all(file, bytes, count);
    if (file >= 0) done = !close(file) && done && !renameat(folder, beside, folder, name);
    if (file >= 0 && !done) unlinkat(folder, beside, 0);
    close(folder);
    return done;
}
