#include "memory_fault.h"

#include <dlfcn.h>
#include <errno.h>
#include <link.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))

/* The C library's own, under the names by which it calls them. */
extern void *__libc_malloc(size_t bytes);
extern void *__libc_calloc(size_t count, size_t bytes);
extern void *__libc_realloc(void *memory, size_t bytes);
extern void *__libc_memalign(size_t alignment, size_t bytes);
extern void __libc_free(void *memory);

enum { RANGES_MOST = 16, PIECES_MOST = 1 << 16 };

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static unsigned long request_count, failing, failed_count;
static long piece_count, mapped;
static int filling = -1;
static const void *pieces[PIECES_MOST]; /* open addressing; NULL: free */

/* -------------------------------------------------------------------------------------------------- who is asking */

static struct { uintptr_t begin, end; } ranges[RANGES_MOST];
static int range_count;
static bool of_program; /* requests of the program count too, and those of the libraries for formats, but libtiff and
                           libhdf5, which crash where one fails */
static const char *const of_formats[] = {"libz.", "libbz2.", "libexpat.", "libjansson.", "libnifti2.", "libznz."};
static pthread_once_t once = PTHREAD_ONCE_INIT;

static int ranges_note(struct dl_phdr_info *object, size_t bytes, void *ignored) {
    (void)bytes, (void)ignored;
    bool wanted = strstr(object->dlpi_name, "libtetracubes") || (of_program && !object->dlpi_name[0]);
    for (size_t n = 0; of_program && n < sizeof of_formats / sizeof *of_formats; n++)
        wanted = wanted || strstr(object->dlpi_name, of_formats[n]);
    for (int n = 0; wanted && n < object->dlpi_phnum && range_count < RANGES_MOST; n++) {
        const ElfW(Phdr) *segment = &object->dlpi_phdr[n];
        if (segment->p_type != PT_LOAD || !(segment->p_flags & PF_X)) continue;
        ranges[range_count].begin = object->dlpi_addr + segment->p_vaddr;
        ranges[range_count].end = ranges[range_count].begin + segment->p_memsz;
        range_count++;
    }
    return 0;
}

static void report(void) {
    char line[128];
    const int bytes = snprintf(line, sizeof line, "memory_fault: %lu requests, %lu failed, %ld pieces left\n",
                               request_count, failed_count, piece_count);
    if (write(STDERR_FILENO, line, (size_t)bytes) < 0) return;
}

static void prepare(void) {
    const char *number = getenv("TETRACUBES_MEMORY_FAULT");
    of_program = number != NULL;
    dl_iterate_phdr(ranges_note, NULL);
    if (!number) return;
    failing = strtoul(number, NULL, 10);
    atexit(report);
}

static bool is_ours(const void *caller) {
    pthread_once(&once, prepare);
    for (int n = 0; n < range_count; n++)
        if ((uintptr_t)caller >= ranges[n].begin && (uintptr_t)caller < ranges[n].end) return true;
    return false;
}

/* Counts a request of ours; true where it is to fail. */
static bool request_fails(const void *caller) {
    if (!is_ours(caller)) return false;
    pthread_mutex_lock(&lock);
    const bool fails = ++request_count == failing;
    failed_count += fails;
    pthread_mutex_unlock(&lock);
    if (fails) errno = ENOMEM;
    return fails;
}

/* ---------------------------------------------------------------------------------------------------------- books */

static size_t place_of(const void *memory) { return (uintptr_t)memory * 0x9E3779B97F4A7C15u >> 48; }

static void *piece_add(void *memory, const void *caller) {
    if (!memory || !is_ours(caller)) return memory;
    pthread_mutex_lock(&lock);
    size_t n = place_of(memory);
    while (pieces[n]) n = (n + 1) % PIECES_MOST;
    pieces[n] = memory;
    piece_count++;
    if (piece_count > PIECES_MOST / 2) abort();
    pthread_mutex_unlock(&lock);
    return memory;
}

/* Memory of no promised content, with some. */
static void *filled(void *memory, size_t bytes, const void *caller) {
    if (memory && filling >= 0 && is_ours(caller)) memset(memory, filling, bytes);
    return memory;
}

/* Takes it from the table, and moves those behind it that would not be found any more. */
static void piece_remove(const void *memory) {
    if (!memory) return;
    pthread_mutex_lock(&lock);
    size_t n = place_of(memory);
    while (pieces[n] && pieces[n] != memory) n = (n + 1) % PIECES_MOST;
    if (pieces[n]) {
        piece_count--;
        pieces[n] = NULL;
        for (size_t m = (n + 1) % PIECES_MOST; pieces[m]; m = (m + 1) % PIECES_MOST) {
            const void *moved = pieces[m];
            size_t to = place_of(moved);
            pieces[m] = NULL;
            while (pieces[to]) to = (to + 1) % PIECES_MOST;
            pieces[to] = moved;
        }
    }
    pthread_mutex_unlock(&lock);
}

/* ------------------------------------------------------------------------------------------------------- functions */

#define CALLER __builtin_return_address(0)

EXPORT void *malloc(size_t bytes) {
    return request_fails(CALLER) ? NULL : piece_add(filled(__libc_malloc(bytes), bytes, CALLER), CALLER);
}

EXPORT void *calloc(size_t count, size_t bytes) {
    return request_fails(CALLER) ? NULL : piece_add(__libc_calloc(count, bytes), CALLER);
}

EXPORT void *realloc(void *memory, size_t bytes) {
    if (request_fails(CALLER)) return NULL;
    void *moved = __libc_realloc(memory, bytes);
    if (moved || bytes == 0) piece_remove(memory);
    return piece_add(moved, CALLER);
}

EXPORT void *aligned_alloc(size_t alignment, size_t bytes) {
    return request_fails(CALLER) ? NULL : piece_add(filled(__libc_memalign(alignment, bytes), bytes, CALLER), CALLER);
}

EXPORT int posix_memalign(void **memory, size_t alignment, size_t bytes) {
    if (request_fails(CALLER)) return ENOMEM;
    void *made = piece_add(filled(__libc_memalign(alignment, bytes), bytes, CALLER), CALLER);
    if (made) *memory = made;
    return made ? 0 : ENOMEM;
}

EXPORT void free(void *memory) {
    piece_remove(memory);
    __libc_free(memory);
}

EXPORT char *strdup(const char *text) {
    const size_t bytes = strlen(text) + 1;
    char *copy = request_fails(CALLER) ? NULL : piece_add(__libc_malloc(bytes), CALLER);
    return copy ? memcpy(copy, text, bytes) : NULL;
}

EXPORT char *strndup(const char *text, size_t most) {
    const size_t length = strnlen(text, most);
    char *copy = request_fails(CALLER) ? NULL : piece_add(__libc_malloc(length + 1), CALLER);
    if (!copy) return NULL;
    copy[length] = '\0';
    return memcpy(copy, text, length);
}

EXPORT char *realpath(const char *path, char *resolved) {
    char *(*of_library)(const char *, char *);
    if (request_fails(CALLER)) return NULL;
    *(void **)&of_library = dlsym(RTLD_NEXT, "realpath");
    char *real = of_library(path, resolved);
    return resolved ? real : piece_add(real, CALLER);
}

/* The text at its end is given to the caller; what it grows by is the C library's own. */
EXPORT FILE *open_memstream(char **text, size_t *bytes) {
    FILE *(*of_library)(char **, size_t *);
    if (request_fails(CALLER)) return NULL;
    *(void **)&of_library = dlsym(RTLD_NEXT, "open_memstream");
    return of_library(text, bytes);
}

static int text_make(char **text, const char *format, va_list arguments) {
    va_list again;
    va_copy(again, arguments);
    const int length = vsnprintf(NULL, 0, format, again);
    va_end(again);
    *text = length < 0 ? NULL : __libc_malloc((size_t)length + 1);
    return *text ? vsnprintf(*text, (size_t)length + 1, format, arguments) : -1;
}

EXPORT int asprintf(char **text, const char *format, ...) {
    va_list arguments;
    if (request_fails(CALLER)) return -1;
    va_start(arguments, format);
    const int length = text_make(text, format, arguments);
    va_end(arguments);
    piece_add(*text, CALLER);
    return length;
}

EXPORT void *mmap(void *address, size_t bytes, int protection, int flags, int file, off_t offset) {
    if (request_fails(CALLER)) return MAP_FAILED;
    void *made = (void *)syscall(SYS_mmap, address, bytes, protection, flags, file, offset); // NOLINT
    if (made != MAP_FAILED && is_ours(CALLER)) __atomic_add_fetch(&mapped, (long)bytes, __ATOMIC_RELAXED);
    return made != MAP_FAILED && flags & MAP_ANONYMOUS ? filled(made, bytes, CALLER) : made;
}

EXPORT int munmap(void *address, size_t bytes) {
    if (is_ours(CALLER)) __atomic_sub_fetch(&mapped, (long)bytes, __ATOMIC_RELAXED);
    return (int)syscall(SYS_munmap, address, bytes);
}

/* --------------------------------------------------------------------------------------------------------- control */

static void fail_at(unsigned long n) {
    pthread_mutex_lock(&lock);
    request_count = failed_count = 0;
    failing = n;
    pthread_mutex_unlock(&lock);
}

static void fill(int byte) { filling = byte; }

static unsigned long requests(void) { return request_count; }
static unsigned long failed(void) { return failed_count; }
static long pieces_left(void) { return piece_count; }
static long mapped_bytes(void) { return mapped; }

EXPORT const memory_fault_functions memory_fault_control = {fail_at, fill, requests, failed, pieces_left, mapped_bytes};
