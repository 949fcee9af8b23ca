/* mapping.c - whole files mapped into memory; see mapping.h */
#include "mapping.h"

#include "exit_status.h"
#include "failure.h"
#include "truncation.h"

#include <errno.h>
#include <fcntl.h>
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

int mapping_open(const char *path, mapping *m) {
    *m = (mapping){0};
    truncation_watch();
    /* without O_NONBLOCK, opening a pipe would wait for its writer */
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) return fail(STATUS_INPUT, "%s: cannot be opened: %s", path, strerror(errno));

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
