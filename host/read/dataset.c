#include "dataset.h"

#include "exit_status.h"
#include "failure.h"
#include "layout.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

typedef struct dataset_memory {
    struct dataset_memory *next;
    void *memory;
} dataset_memory;

void *dataset_allocate(dataset *d, uint64_t bytes) {
    dataset_memory *entry = malloc(sizeof *entry);
    void *memory = entry ? samples_allocate(bytes ? bytes : 1) : NULL;
    if (!memory) {
        free(entry);
        fail(STATUS_FAILED, "no memory for %llu bytes of the input", (unsigned long long)bytes);
        return NULL;
    }
    *entry = (dataset_memory){d->memory, memory};
    d->memory = entry;
    return memory;
}

char *dataset_text(dataset *d, const char *text) {
    size_t bytes = strlen(text) + 1;
    char *copy = dataset_allocate(d, bytes);
    return copy ? memcpy(copy, text, bytes) : NULL;
}

int dataset_block_add(dataset *d, dataset_block **out) {
    dataset_block *blocks = realloc(d->blocks, ((size_t)d->block_count + 1) * sizeof *blocks);
    if (!blocks) return fail(STATUS_FAILED, "no memory for block %d of the input", d->block_count);
    d->blocks = blocks;
    *out = &blocks[d->block_count++];
    **out = (dataset_block){0};
    return 0;
}

int dataset_field_add(dataset_block *block, dataset_field **out) {
    dataset_field *fields = realloc(block->fields, ((size_t)block->field_count + 1) * sizeof *fields);
    if (!fields) return fail(STATUS_FAILED, "no memory for field %d of the input", block->field_count);
    block->fields = fields;
    *out = &fields[block->field_count++];
    **out = (dataset_field){0};
    return 0;
}

void dataset_notice(dataset *d, const char *format, ...) {
    char text[sizeof d->notice];
    size_t used = strlen(d->notice);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (used + strlen(text) + 3 > sizeof d->notice) return;
    stpcpy(stpcpy(d->notice + used, used ? "; " : ""), text);
}

void dataset_release(dataset *d) {
    for (dataset_memory *entry = d->memory, *next; entry; entry = next) {
        next = entry->next;
        free(entry->memory);
        free(entry);
    }
    for (int n = 0; n < d->block_count; n++) free(d->blocks[n].fields);
    free(d->blocks);
    if (d->mapping) munmap(d->mapping, d->mapping_bytes);
    volume_release(&d->image);
    *d = (dataset){0};
}
