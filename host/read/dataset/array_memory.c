#include "dataset/array_memory.h"

#include "temporary_file.h"

#include <pthread.h>
#include <stddef.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

/* Arrays in files: few, so a list will do. */
typedef struct file_array {
    struct file_array *next;
    char *memory;
    size_t bytes;
} file_array;

static file_array *file_arrays;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static void *allocate_in_file(size_t bytes) {
    file_array *entry = malloc(sizeof *entry);
    const int file = entry ? temporary_file(bytes) : -1;
    void *memory = file < 0 ? MAP_FAILED : mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (file >= 0) close(file);
    if (!entry || memory == MAP_FAILED) {
        free(entry);
        return NULL;
    }
    pthread_mutex_lock(&lock);
    *entry = (file_array){file_arrays, memory, bytes};
    file_arrays = entry;
    pthread_mutex_unlock(&lock);
    return memory;
}

void *samples_allocate(uint64_t bytes) {
    enum { SMALL_PAGE = 4096, HUGE_PAGE = 2 << 20, HUGE_FROM = 256 << 10 };
    size_t page = bytes < HUGE_FROM ? SMALL_PAGE : HUGE_PAGE;
    void *memory = NULL;
    if (bytes > SIZE_MAX / 2) return NULL;
    size_t whole_pages = ((size_t)bytes + page - 1) & ~(page - 1);
    if (temporary_file_is_better(bytes)) return allocate_in_file(whole_pages);
    if (posix_memalign(&memory, page, whole_pages ? whole_pages : page)) return NULL;
    if (page == HUGE_PAGE) madvise(memory, whole_pages, MADV_HUGEPAGE);
    return memory;
}

void samples_free(void *samples) {
    pthread_mutex_lock(&lock);
    file_array **at = &file_arrays, *entry;
    while (*at && (*at)->memory != samples) at = &(*at)->next;
    entry = *at;
    if (entry) *at = entry->next;
    pthread_mutex_unlock(&lock);
    if (entry)
        munmap(entry->memory, entry->bytes);
    else
        free(samples);
    free(entry);
}

uint64_t samples_in_file(const void *address) {
    const char *at = address;
    uint64_t bytes = 0;
    pthread_mutex_lock(&lock);
    for (const file_array *entry = file_arrays; entry; entry = entry->next)
        if (at >= entry->memory && at < entry->memory + entry->bytes)
            bytes = (uint64_t)(entry->memory + entry->bytes - at);
    pthread_mutex_unlock(&lock);
    return bytes;
}
