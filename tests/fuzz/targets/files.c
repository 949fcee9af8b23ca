/* files.c - files in memory in the place of mapped ones; see files.h */
#include "files.h"

#include "check.h"
#include "exit_status.h"
#include "failure.h"
#include "file/mapping.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static const char marker[] = "\n=FILE=\n";

static struct {
    const char *path;
    const uint8_t *bytes[FILES_MOST];
    size_t sizes[FILES_MOST];
    int count;
    uint8_t *replaced[FILES_MOST]; /* from malloc */
    const void *mapped[FILES_MOST * 4];
    int mapped_count;
} files;

void files_open(const char *path, const uint8_t *input, size_t size, uint8_t options[OPTION_BYTES]) {
    memset(&files, 0, sizeof files);
    memset(options, 0, OPTION_BYTES);
    files.path = path;
    size_t taken = size < OPTION_BYTES ? size : OPTION_BYTES;
    size -= taken;
    if (taken) memcpy(options, input + size, taken);
    for (size_t at = 0; files.count < FILES_MOST;) {
        const uint8_t *begin = input + at;
        const uint8_t *end = memmem(begin, size - at, marker, sizeof marker - 1);
        files.bytes[files.count] = begin;
        files.sizes[files.count++] = end ? (size_t)(end - begin) : size - at;
        if (!end) break;
        at = (size_t)(end - input) + sizeof marker - 1;
    }
}

void files_close(void) {
    CHECK(files.mapped_count == 0);
    for (int n = 0; n < FILES_MOST; n++) free(files.replaced[n]);
}

/* Which file a name stands for; -1 where there is none. Readers must have refused names outside of the folder. */
static int find(const char *path) {
    CHECK(strncmp(path, FILES_FOLDER, strlen(FILES_FOLDER)) == 0);
    const char *name = path + strlen(FILES_FOLDER), *digit = NULL;
    CHECK(*name != '/' && strcmp(name, "..") != 0 && strncmp(name, "../", 3) != 0 && !strstr(name, "/../"));
    if (strcmp(path, files.path) == 0) return 0;
    for (const char *at = name; *at; at++)
        if (*at >= '0' && *at <= '9') digit = at;
    int number = digit ? *digit - '0' : 1;
    return number < files.count ? number : -1;
}

int mapping_open(const char *path, mapping *m) {
    *m = (mapping){0};
    int n = find(path);
    if (n < 0) return fail(STATUS_INPUT, "%s: cannot be opened: no such file", path);
    if (!files.sizes[n]) return 0;
    CHECK(files.mapped_count < FILES_MOST * 4);
    unsigned char *copy = malloc(files.sizes[n]);
    memcpy(copy, files.bytes[n], files.sizes[n]);
    files.mapped[files.mapped_count++] = copy;
    *m = (mapping){.bytes = copy, .size = files.sizes[n], .identity = {.inode = (ino_t)n + 1}};
    return 0;
}

/* The bytes of the descriptor in place of the file's, until all files are closed. */
int mapping_replace(const char *path, int instead) {
    int n = find(path);
    CHECK(n >= 0 && !files.replaced[n]);
    off_t size = lseek(instead, 0, SEEK_END);
    files.replaced[n] = malloc((size_t)size + 1);
    CHECK(size >= 0 && files.replaced[n] && pread(instead, files.replaced[n], (size_t)size, 0) == size);
    files.bytes[n] = files.replaced[n];
    files.sizes[n] = (size_t)size;
    close(instead);
    return 0;
}

void mapping_restore(const char *path) { (void)path; }

int mapping_is_replaced(const char *path) { return files.replaced[find(path)] != NULL; }

int mapping_is_standard_input(const char *path) {
    (void)path;
    return 0;
}

int mapping_is_stream(const char *path) {
    (void)path;
    return 0;
}

void mapping_close(mapping *m) {
    if (m->bytes) munmap((void *)(uintptr_t)m->bytes, m->size);
    *m = (mapping){0};
}

int __real_munmap(void *memory, size_t bytes);
int __wrap_munmap(void *memory, size_t bytes);
int __real_access(const char *path, int mode);
int __wrap_access(const char *path, int mode);
char *__real_realpath(const char *path, char *resolved);
char *__wrap_realpath(const char *path, char *resolved);
void *__wrap_samples_allocate(uint64_t bytes);

void *__wrap_samples_allocate(uint64_t bytes) { return malloc(bytes); }

int __wrap_munmap(void *memory, size_t bytes) {
    for (int n = 0; n < files.mapped_count; n++)
        if (files.mapped[n] == memory) {
            files.mapped[n] = files.mapped[--files.mapped_count];
            free(memory);
            return 0;
        }
    return __real_munmap(memory, bytes);
}

int __wrap_access(const char *path, int mode) {
    if (strncmp(path, FILES_FOLDER, strlen(FILES_FOLDER)) != 0) return __real_access(path, mode);
    return find(path) < 0 ? -1 : 0;
}

/* No file here is a link. */
char *__wrap_realpath(const char *path, char *resolved) {
    if (strncmp(path, FILES_FOLDER, strlen(FILES_FOLDER)) != 0) return __real_realpath(path, resolved);
    CHECK(!resolved);
    char *copy = strdup(path);
    CHECK(copy);
    size_t length = strlen(copy);
    if (copy[length - 1] == '/') copy[length - 1] = '\0';
    return copy;
}
