#include "dataset/dataset.h"

#include "control.h"
#include "dataset/array_memory.h"
#include "exit_status.h"
#include "failure.h"
#include "file/mapping.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NOTICES_MOST = 64 };

typedef struct dataset_memory {
    struct dataset_memory *next;
    void *memory;
    size_t mapped; /* bytes of a mapped file; 0: from samples_allocate */
} dataset_memory;

void *dataset_allocate(dataset *d, uint64_t bytes) {
    void *memory = samples_allocate(bytes ? bytes : 1);
    if (memory && !dataset_keep(d, memory)) return memory;
    fail(STATUS_FAILED, "no memory for %llu bytes of the input", (unsigned long long)bytes);
    return NULL;
}

int dataset_map(dataset *d, const char *path, mapping *m) {
    int status = mapping_open(path, m);
    if (!status) status = file_list_add(&d->files, m->identity);
    if (status) mapping_close(m);
    return status;
}

int dataset_keep(dataset *d, void *memory) {
    dataset_memory *entry = malloc(sizeof *entry);
    if (!entry) {
        samples_free(memory);
        return fail(STATUS_FAILED, "no memory for the list of the input's arrays");
    }
    *entry = (dataset_memory){d->memory, memory, 0};
    d->memory = entry;
    return 0;
}

/* All memory of the other one, its mapped file too. */
static int take_memory(dataset *to, dataset *from) {
    if (from->mapping) {
        dataset_memory *entry = malloc(sizeof *entry);
        if (!entry) return fail(STATUS_FAILED, "no memory for the list of the input's arrays");
        *entry = (dataset_memory){from->memory, from->mapping, from->mapping_bytes};
        from->memory = entry;
        from->mapping = NULL;
        from->mapping_bytes = 0;
    }
    dataset_memory **end = &from->memory;
    while (*end) end = &(*end)->next;
    *end = to->memory;
    to->memory = from->memory;
    from->memory = NULL;
    return 0;
}

void dataset_set_units(dataset *d, const char *text) {
    int is_plain = *text && strlen(text) < sizeof d->units;
    for (const char *at = text; *at; at++) is_plain &= *at > ' ' && *at < 127 && !strchr("\"'=<>&\\", *at);
    if (is_plain) snprintf(d->units, sizeof d->units, "%s", text);
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

int dataset_image_begin(dataset *d) {
    dataset_block *block = NULL;
    dataset_field *field = NULL;
    if (dataset_block_add(d, &block) || dataset_field_add(block, &field)) return STATUS_FAILED;
    block->kind = BLOCK_UNIFORM;
    field->name = "";
    d->frames = 1;
    return 0;
}

/* Takes the text over. 0 where memory runs out: then nothing has changed. */
static int add_notice(dataset *d, char *text) {
    const size_t used = strlen(d->notice);
    char **notices = realloc(d->notices, ((size_t)d->notice_count + 1) * sizeof *notices);
    if (!notices) return 0;
    d->notices = notices;
    notices[d->notice_count++] = text;
    if (used + strlen(text) + sizeof "; " <= sizeof d->notice) stpcpy(stpcpy(d->notice + used, used ? "; " : ""), text);
    return 1;
}

void dataset_notice(dataset *d, const char *format, ...) {
    char *text = NULL;
    va_list arguments;
    if (d->notice_count > NOTICES_MOST) return;
    va_start(arguments, format);
    int length = d->notice_count < NOTICES_MOST
                     ? vasprintf(&text, format, arguments)
                     : asprintf(&text, "more notices than these %d are left out", NOTICES_MOST);
    va_end(arguments);
    if (length >= 0) control_mask(text, 0);
    if (length < 0 || !add_notice(d, text)) {
        if (length >= 0) free(text);
        d->notice_lost = 1;
    }
}

int dataset_leave_out(dataset *d, const char *name, const char *format, ...) {
    char reason[160];
    va_list arguments;
    for (int n = 0; n < d->absent_count; n++)
        if (strcmp(d->absent[n].name, name) == 0) return 0;
    if (d->absent_count == NOTICES_MOST) return 0; /* as many can be told */
    va_start(arguments, format);
    vsnprintf(reason, sizeof reason, format, arguments);
    va_end(arguments);
    control_mask(reason, 0);
    dataset_absent *absent = realloc(d->absent, ((size_t)d->absent_count + 1) * sizeof *absent);
    if (absent) d->absent = absent;
    const dataset_absent added = {absent ? dataset_text(d, name) : NULL, absent ? dataset_text(d, reason) : NULL};
    if (!added.name || !added.reason) return fail(STATUS_FAILED, "no memory for what is left out of the input");
    absent[d->absent_count++] = added;
    dataset_notice(d, "the array '%.60s' is left out: %s", name, reason);
    return 0;
}

static int has_notice(const dataset *d, const char *text) {
    for (int n = 0; n < d->notice_count; n++)
        if (strcmp(d->notices[n], text) == 0) return 1;
    return 0;
}

/* The notices of arrays that are left out come with these. */
int dataset_notices_of(dataset *to, const dataset *from) {
    for (int n = 0; n < from->absent_count; n++)
        if (dataset_leave_out(to, from->absent[n].name, "%s", from->absent[n].reason)) return STATUS_FAILED;
    for (int n = 0; n < from->notice_count; n++)
        if (!has_notice(to, from->notices[n])) dataset_notice(to, "%s", from->notices[n]);
    return 0;
}

int dataset_absorb(dataset *to, dataset *from) {
    if (dataset_notices_of(to, from)) return STATUS_FAILED;
    for (size_t n = 0; n < from->files.count; n++)
        if (file_list_add(&to->files, from->files.files[n])) return STATUS_FAILED;
    for (int n = 0; n < from->block_count; n++) {
        dataset_block *added = NULL;
        if (dataset_block_add(to, &added)) return STATUS_FAILED;
        *added = from->blocks[n];
        from->blocks[n].fields = NULL; /* they are the other one's now */
        from->blocks[n].field_count = 0;
    }
    if (take_memory(to, from)) return STATUS_FAILED;
    dataset_release(from);
    return 0;
}

void dataset_release(dataset *d) {
    for (dataset_memory *entry = d->memory, *next; entry; entry = next) {
        next = entry->next;
        if (entry->mapped)
            mapping_close(&(mapping){.bytes = entry->memory, .size = entry->mapped});
        else
            samples_free(entry->memory);
        free(entry);
    }
    for (int n = 0; n < d->block_count; n++) free(d->blocks[n].fields);
    free(d->blocks);
    free(d->absent);
    mapping_close(&(mapping){.bytes = d->mapping, .size = d->mapping_bytes});
    file_list_release(&d->files);
    for (int n = 0; n < d->notice_count; n++) free(d->notices[n]);
    free(d->notices);
    *d = (dataset){0};
}
