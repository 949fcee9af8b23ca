/*
 * output_target.c - where an output goes: a stream, a file written in place, or a temporary file to be renamed
 *
 * Which way a target is written:
 *   "-", what standard output is       through that descriptor: its offset and append mode hold
 *   exists, not a regular file         opened and written directly
 *   regular file, or nothing yet       temporary file in the same folder, renamed over it at the end; an existing
 *                                      file's permission bits are kept; where the name is a symbolic link, its target
 *                                      is replaced or made
 * The temporary file is made by open(O_EXCL), not mkstemp, so that the kernel applies the umask. It is locked (flock)
 * until it has been renamed or removed. So one that nobody locks was left by a killed process; it is removed when the
 * same name is written again.
 */
#include "output_target.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { NAME_KEPT = 200, ATTEMPTS = 100, LINKS_MOST = 40 };

static int is_standard_output(const struct stat *target) {
    struct stat standard;
    return fstat(STDOUT_FILENO, &standard) == 0 && standard.st_dev == target->st_dev &&
           standard.st_ino == target->st_ino;
}

/* The length of the folder in the path, with its slash. */
static size_t folder_length(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

static int is_same_file(const struct stat *a, const struct stat *b) {
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

/* Removes the file if it is ours and nobody has locked it, since its writer is gone then. */
static void remove_left(const char *path) {
    struct stat opened, named;
    int fd = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (fd < 0) return;
    if (fstat(fd, &opened) == 0 && S_ISREG(opened.st_mode) && opened.st_uid == geteuid() &&
        flock(fd, LOCK_EX | LOCK_NB) == 0 && lstat(path, &named) == 0 && is_same_file(&opened, &named))
        unlink(path);
    close(fd);
}

/* Whether it is the name of a temporary file of the file of that name: ".NAME.XXXXXX.tmp". */
static int is_temporary_of(const char *entry, const char *name) {
    size_t kept = strnlen(name, NAME_KEPT);
    return entry[0] == '.' && strncmp(entry + 1, name, kept) == 0 && entry[1 + kept] == '.' &&
           strspn(entry + 2 + kept, "0123456789abcdef") == 6 && strcmp(entry + 8 + kept, ".tmp") == 0;
}

/* Temporary files of the same name that killed processes have left. */
static void remove_all_left(const char *path) {
    size_t folder = folder_length(path);
    char *name = malloc(folder + NAME_MAX + 2);
    if (name) snprintf(name, folder + 2, "%.*s", (int)folder, folder ? path : "");
    DIR *entries = name ? opendir(folder ? name : ".") : NULL;
    for (struct dirent *entry; entries && (entry = readdir(entries));) {
        if (!is_temporary_of(entry->d_name, path + folder)) continue;
        snprintf(name + folder, NAME_MAX + 1, "%s", entry->d_name);
        remove_left(name);
    }
    if (entries) closedir(entries);
    free(name);
}

/* Locks the fresh file. Returns 0 where another process has taken it for one that was left, and removes it. On a file
 * system without locks nothing is removed, as remove_left needs the lock. */
static int lock_temporary(output *o) {
    struct stat opened, named;
    if (flock(o->fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return 0;
    if (fstat(o->fd, &opened) != 0 || lstat(o->temporary, &named) != 0 || !is_same_file(&opened, &named)) return 0;
    o->lock = fcntl(o->fd, F_DUPFD_CLOEXEC, 0);
    return 1;
}

/* Opens a fresh file beside o->path. Returns errno. */
static int open_temporary(output *o) {
    remove_all_left(o->path);
    size_t folder = folder_length(o->path), size = strlen(o->path) + sizeof "..XXXXXX.tmp";
    o->temporary = malloc(size);
    if (!o->temporary) return ENOMEM;
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    uint32_t suffix = (uint32_t)now.tv_nsec ^ (uint32_t)getpid() << 8;
    for (int attempt = 0; attempt < ATTEMPTS; attempt++, suffix = suffix * 1664525 + 1013904223) {
        snprintf(o->temporary, size, "%.*s.%.*s.%06x.tmp", (int)folder, o->path, NAME_KEPT, o->path + folder,
                 (unsigned)(suffix >> 8));
        o->fd = open(o->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (o->fd >= 0 && lock_temporary(o)) break;
        if (o->fd < 0 && errno != EEXIST) break;
        if (o->fd >= 0) close(o->fd);
        o->fd = -1;
        errno = EEXIST;
    }
    if (o->fd >= 0) return o->lock >= 0 ? 0 : errno;
    int error = errno;
    free(o->temporary); /* not ours to unlink */
    o->temporary = NULL;
    return error;
}

/* Opens the file that replaces the existing one. Returns errno. */
static int open_replacement(output *o, const struct stat *existing) {
    char *resolved = realpath(o->name, NULL);
    if (!resolved) return errno;
    free(o->path);
    o->path = resolved;
    if (access(o->path, W_OK) != 0) return errno;
    int error = open_temporary(o);
    if (!error) (void)fchmod(o->fd, existing->st_mode & 0777); /* file systems without permissions refuse: no matter */
    return error;
}

/* Follows symbolic links that lead to nothing yet: *path becomes the name that is to be made. Returns errno. */
static int follow_links(char **path) {
    char target[PATH_MAX];
    for (int n = 0; n < LINKS_MOST; n++) {
        ssize_t length = readlink(*path, target, sizeof target - 1);
        if (length < 0) return errno == EINVAL || errno == ENOENT ? 0 : errno;
        size_t folder = target[0] == '/' ? 0 : folder_length(*path);
        char *followed = malloc(folder + (size_t)length + 1);
        if (!followed) return ENOMEM;
        memcpy(followed, *path, folder);
        memcpy(followed + folder, target, (size_t)length);
        followed[folder + (size_t)length] = '\0';
        free(*path);
        *path = followed;
    }
    return ELOOP;
}

int output_target_open(output *o) {
    struct stat existing;
    if (output_is_dash(o->path)) return (o->fd = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0)) >= 0 ? 0 : errno;
    if (o->path[folder_length(o->path)] == '\0') return o->path[0] ? EISDIR : ENOENT;
    if (stat(o->path, &existing) != 0) {
        int error = errno == ENOENT ? follow_links(&o->path) : errno;
        return error ? error : open_temporary(o);
    }
    if (S_ISDIR(existing.st_mode)) return EISDIR;
    if (is_standard_output(&existing))
        o->fd = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
    else if (S_ISREG(existing.st_mode))
        return open_replacement(o, &existing);
    else
        o->fd = open(o->path, O_WRONLY | O_NOCTTY | O_CLOEXEC);
    return o->fd >= 0 ? 0 : errno;
}

int output_is_dash(const char *path) { return strcmp(path, "-") == 0; }

int output_target_obstacle(char **path) {
    struct stat existing;
    if (output_is_dash(*path)) return 0;
    size_t folder = folder_length(*path);
    if ((*path)[folder] == '\0') return **path ? EISDIR : ENOENT;
    if (stat(*path, &existing) == 0) {
        if (S_ISDIR(existing.st_mode)) return EISDIR;
        return is_standard_output(&existing) || access(*path, W_OK) == 0 ? 0 : errno;
    }
    int error = errno == ENOENT ? follow_links(path) : errno;
    if (error) return error;
    folder = folder_length(*path);
    (*path)[folder] = '\0';
    return access(folder ? *path : ".", W_OK | X_OK) == 0 ? 0 : errno;
}
