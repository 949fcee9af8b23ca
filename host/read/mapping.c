/* mapping.c - whole files mapped into memory; see mapping.h */
#include "mapping.h"

#include "exit_status.h"
#include "failure.h"
#include "truncation.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FILES_KEPT = 1 << 20 }; /* as many as a header can name; pages of it that are not used take no memory */

/* The files mapped last. */
static struct {
    pthread_mutex_t lock;
    struct file_identity {
        dev_t device;
        ino_t number;
    } files[FILES_KEPT];
    uint64_t count; /* of all; file n is in place n modulo FILES_KEPT */
} opened = {.lock = PTHREAD_MUTEX_INITIALIZER};

static void remember(const struct stat *about) {
    pthread_mutex_lock(&opened.lock);
    opened.files[opened.count++ % FILES_KEPT] = (struct file_identity){about->st_dev, about->st_ino};
    pthread_mutex_unlock(&opened.lock);
}

int mapping_was_opened(const char *path) {
    struct stat about;
    int found = 0;
    if (stat(path, &about)) return 0;
    pthread_mutex_lock(&opened.lock);
    for (uint64_t n = 0; n < opened.count && n < FILES_KEPT && !found; n++)
        found = opened.files[n].device == about.st_dev && opened.files[n].number == about.st_ino;
    pthread_mutex_unlock(&opened.lock);
    return found;
}

int mapping_is_standard_input(const char *path) { return strcmp(path, "-") == 0; }

/* Standard input as a file in memory. */
static struct {
    pthread_mutex_t lock;
    int is_read, file; /* file: once it is read */
} standard_input = {.lock = PTHREAD_MUTEX_INITIALIZER};

static int copy_standard_input(int to) {
    enum { CHUNK = 1 << 16 };
    char chunk[CHUNK];
    for (;;) {
        struct pollfd ready = {.fd = STDIN_FILENO, .events = POLLIN};
        if (poll(&ready, 1, -1) < 0 && errno == EINTR) /* a signal that ends the program; read would go on waiting */
            return fail(STATUS_FAILED, "-: interrupted while standard input was read");
        const ssize_t count = read(STDIN_FILENO, chunk, sizeof chunk);
        if (count == 0) return 0;
        if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
        if (count < 0) return fail(STATUS_INPUT, "-: standard input cannot be read: %s", strerror(errno));
        for (ssize_t done = 0, written; done < count; done += written)
            if ((written = write(to, chunk + done, (size_t)(count - done))) < 0)
                return fail(STATUS_FAILED, "-: no memory for standard input: %s; give a file", strerror(errno));
    }
}

/* Takes a regular file, from its beginning, as it is; copies all else. */
static int read_standard_input(void) {
    struct stat about;
    int status = 0;
    if (isatty(STDIN_FILENO)) return fail(STATUS_USAGE, "-: standard input is a terminal: send a file to it by < or |");
    if (fstat(STDIN_FILENO, &about) == 0 && S_ISREG(about.st_mode) && lseek(STDIN_FILENO, 0, SEEK_CUR) == 0) {
        standard_input.file = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0);
        standard_input.is_read = standard_input.file >= 0;
    } else {
        standard_input.file = memfd_create("standard input", MFD_CLOEXEC);
        if (standard_input.file >= 0) status = copy_standard_input(standard_input.file);
        if (status) close(standard_input.file);
        standard_input.is_read = !status && standard_input.file >= 0;
    }
    if (!status && !standard_input.is_read)
        status = fail(STATUS_FAILED, "-: standard input cannot be taken into memory: %s; give a file", strerror(errno));
    return status;
}

/* A descriptor of the caller's. 0 or a status with text. */
static int open_standard_input(int *file) {
    pthread_mutex_lock(&standard_input.lock);
    int status = standard_input.is_read ? 0 : read_standard_input();
    if (!status && (*file = fcntl(standard_input.file, F_DUPFD_CLOEXEC, 0)) < 0)
        status = fail(STATUS_FAILED, "-: cannot be opened: %s", strerror(errno));
    pthread_mutex_unlock(&standard_input.lock);
    return status;
}

static int open_file(const char *path, int *file) {
    if (mapping_is_standard_input(path)) return open_standard_input(file);
    /* without O_NONBLOCK, opening a pipe would wait for its writer */
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
        remember(&about);
        void *bytes = mmap(NULL, (size_t)about.st_size, PROT_READ, MAP_PRIVATE, file, 0);
        if (bytes == MAP_FAILED)
            status = fail(errno == ENOMEM ? STATUS_FAILED : STATUS_INPUT, "%s: cannot be mapped into memory: %s", path,
                          strerror(errno));
        else
            *m = (mapping){bytes, (size_t)about.st_size};
        if (m->bytes) truncation_watch_file(file, m->bytes);
    }
    close(file);
    return status;
}

void mapping_close(mapping *m) {
    if (m->bytes) truncation_unwatch_file(m->bytes);
    if (m->bytes) munmap((void *)(uintptr_t)m->bytes, m->size);
    *m = (mapping){0};
}
