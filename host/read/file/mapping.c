/* mapping.c - whole files mapped into memory; see mapping.h */
#include "file/mapping.h"

#include "exit_status.h"
#include "failure.h"
#include "truncation.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/magic.h>
#include <poll.h>
#include <pthread.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/statfs.h>
#include <unistd.h>

int mapping_is_standard_input(const char *path) {
    static const char *const names[] = {"-", "/dev/stdin", "/dev/fd/0", "/proc/self/fd/0"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
        if (strcmp(path, names[n]) == 0) return 1;
    return 0;
}

static int is_pipe(const char *path) {
    struct stat about;
    return stat(path, &about) == 0 && S_ISFIFO(about.st_mode);
}

int mapping_is_stream(const char *path) {
    static const char *const folders[] = {"/dev/fd/", "/proc/self/fd/"};
    for (size_t n = 0; n < sizeof folders / sizeof *folders; n++)
        if (strncmp(path, folders[n], strlen(folders[n])) == 0) return 1;
    return mapping_is_standard_input(path) || is_pipe(path);
}

/* Standard input and pipes as files in memory; and files that others stand for, for a while. */
enum { STREAMS_KEPT = 8 };

static struct {
    pthread_mutex_t lock;
    struct stream {
        file_identity of;
        int is_standard_input, is_replaced, file;
    } kept[STREAMS_KEPT];
    int count;
} streams = {.lock = PTHREAD_MUTEX_INITIALIZER};

/* Whether to wait for a first writer: a named pipe may not have one yet. An unnamed pipe without a writer will not get
 * one any more. */
static int waits_for_writers(int from) {
    struct statfs about;
    struct stat kind;
    return fstat(from, &kind) == 0 && S_ISFIFO(kind.st_mode) && fstatfs(from, &about) == 0 &&
           about.f_type != PIPEFS_MAGIC;
}

/* Waits until there is something to read. A signal that ends the program ends this wait, too, but not that of read. */
static int wait_for_bytes(const char *path, int from) {
    struct pollfd ready = {.fd = from, .events = POLLIN};
    if (poll(&ready, 1, -1) >= 0 || errno != EINTR) return 0;
    return fail(STATUS_FAILED, "%s: interrupted while it was read", path);
}

/* Pipes opened by name do not block. They are read before they are waited for, as their end may have come already. */
static int copy_stream(const char *path, int from, int to) {
    enum { CHUNK = 1 << 16 };
    char chunk[CHUNK];
    const int is_standard = from == STDIN_FILENO;
    int status = is_standard || waits_for_writers(from) ? wait_for_bytes(path, from) : 0;
    while (!status) {
        const ssize_t count = read(from, chunk, sizeof chunk);
        if (count == 0) return 0;
        if (count < 0 && errno != EINTR && errno != EAGAIN)
            return fail(STATUS_INPUT, "%s: cannot be read: %s", path, strerror(errno));
        for (ssize_t done = 0, written; done < count; done += written)
            if ((written = write(to, chunk + done, (size_t)(count - done))) < 0)
                return fail(STATUS_FAILED, "%s: no memory for what comes from it: %s; give a file", path,
                            strerror(errno));
        if (count < 0 || is_standard) status = wait_for_bytes(path, from);
    }
    return status;
}

/* Takes a regular file, from its beginning, as it is; copies all else. */
static int take_stream(const char *path, int from, int *file) {
    struct stat about;
    int status = 0;
    if (fstat(from, &about) == 0 && S_ISREG(about.st_mode) && lseek(from, 0, SEEK_CUR) == 0)
        *file = fcntl(from, F_DUPFD_CLOEXEC, 0);
    else if ((*file = memfd_create("input", MFD_CLOEXEC)) >= 0)
        status = copy_stream(path, from, *file);
    if (status) close(*file);
    if (status || *file >= 0) return status;
    return fail(STATUS_FAILED, "%s: cannot be taken into memory: %s; give a file", path, strerror(errno));
}

static struct stream *find_stream(const char *path) {
    const int is_standard = mapping_is_standard_input(path);
    struct stat about = {0};
    if (!is_standard && stat(path, &about)) return NULL;
    for (int n = 0; n < streams.count; n++) {
        struct stream *s = &streams.kept[n];
        if (is_standard ? s->is_standard_input : s->of.device == about.st_dev && s->of.inode == about.st_ino) return s;
    }
    return NULL;
}

static int read_stream(const char *path, struct stream **out) {
    const int is_standard = mapping_is_standard_input(path);
    if (streams.count == STREAMS_KEPT) return fail(STATUS_USAGE, "%s: is one pipe too many; give a file", path);
    if (is_standard && isatty(STDIN_FILENO))
        return fail(STATUS_USAGE, "%s: standard input is a terminal: send a file to it by < or |", path);
    /* without O_NONBLOCK, opening a pipe would wait for its writer, whatever signals come */
    const int from = is_standard ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (from < 0) return fail(STATUS_INPUT, "%s: cannot be opened: %s", path, strerror(errno));
    struct stat about = {0};
    struct stream s = {.is_standard_input = is_standard};
    fstat(from, &about);
    s.of = (file_identity){about.st_dev, about.st_ino};
    int status = take_stream(path, from, &s.file);
    if (!is_standard) close(from);
    if (status) return status;
    *out = &streams.kept[streams.count++];
    **out = s;
    return 0;
}

/* *file: a descriptor that the caller closes. 0 or a status with its message. */
static int open_stream(const char *path, int *file) {
    pthread_mutex_lock(&streams.lock);
    struct stream *s = find_stream(path);
    int status = s ? 0 : read_stream(path, &s);
    if (!status && (*file = fcntl(s->file, F_DUPFD_CLOEXEC, 0)) < 0)
        status = fail(STATUS_FAILED, "%s: cannot be opened: %s", path, strerror(errno));
    pthread_mutex_unlock(&streams.lock);
    return status;
}

int mapping_is_replaced(const char *path) {
    pthread_mutex_lock(&streams.lock);
    const struct stream *s = streams.count ? find_stream(path) : NULL;
    pthread_mutex_unlock(&streams.lock);
    return s != NULL;
}

int mapping_replace(const char *path, int instead) {
    struct stat about = {0};
    pthread_mutex_lock(&streams.lock);
    struct stream *s = find_stream(path);
    if (s) {
        close(s->file);
    } else if (streams.count < STREAMS_KEPT && stat(path, &about) == 0) {
        s = &streams.kept[streams.count++];
        *s = (struct stream){.of = {about.st_dev, about.st_ino}, .is_replaced = 1};
    }
    if (s) s->file = instead;
    pthread_mutex_unlock(&streams.lock);
    if (s) return 0;
    close(instead);
    return fail(STATUS_FAILED, "%s: is one file too many that has to be taken into memory; unpack it", path);
}

void mapping_restore(const char *path) {
    pthread_mutex_lock(&streams.lock);
    struct stream *s = streams.count ? find_stream(path) : NULL;
    if (s && s->is_replaced) {
        close(s->file);
        *s = streams.kept[--streams.count];
    }
    pthread_mutex_unlock(&streams.lock);
}

static int open_file(const char *path, int *file) {
    if (mapping_is_standard_input(path) || is_pipe(path) || mapping_is_replaced(path)) return open_stream(path, file);
    /* without O_NONBLOCK, opening a device may wait */
    *file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    return *file < 0 ? fail(STATUS_INPUT, "%s: cannot be opened: %s", path, strerror(errno)) : 0;
}

int mapping_open(const char *path, mapping *m) {
    int file;
    *m = (mapping){0};
    truncation_watch();
    int opened_status = open_file(path, &file);
    if (opened_status) return opened_status;

    int status = 0;
    struct stat about;
    if (fstat(file, &about)) {
        status = fail(STATUS_INPUT, "%s: cannot be read: %s", path, strerror(errno));
    } else if (!S_ISREG(about.st_mode)) {
        status = fail(STATUS_INPUT, "%s: is not a regular file; name a volume file", path);
    } else if ((uintmax_t)about.st_size > SIZE_MAX / 2) {
        status = fail(STATUS_INPUT, "%s: is larger than this machine can address", path);
    } else if (about.st_size > 0) {
        void *bytes = mmap(NULL, (size_t)about.st_size, PROT_READ, MAP_PRIVATE, file, 0);
        if (bytes == MAP_FAILED)
            status = fail(errno == ENOMEM ? STATUS_FAILED : STATUS_INPUT, "%s: cannot be mapped into memory: %s", path,
                          strerror(errno));
        else
            *m = (mapping){.bytes = bytes, .size = (size_t)about.st_size};
        if (m->bytes) truncation_watch_file(file, m->bytes);
    }
    if (!status) m->identity = (file_identity){about.st_dev, about.st_ino};
    close(file);
    return status;
}

void mapping_close(mapping *m) {
    if (m->bytes) truncation_unwatch_file(m->bytes);
    if (m->bytes) munmap((void *)(uintptr_t)m->bytes, m->size);
    *m = (mapping){0};
}
