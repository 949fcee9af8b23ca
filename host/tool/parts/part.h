/* part.h - the files of parts as join reads them: mapped, so that their samples need no memory of their own */
#ifndef PART_H
#define PART_H

#include "file/mapping.h"
#include "part_header.h"

typedef struct part {
    const char *path;
    mapping m;
    part_header header;
    size_t header_bytes;
    part_layout layout;
} part;

/* Maps the file and reads its header; a file that is too short, too long or no part is refused. To be closed in any
 * case. 0 or a status. */
int part_open(const char *path, part *p);
void part_close(part *p);

/* Puts parts in their order. STATUS_INPUT where they are not all parts of one surface, each once. */
int parts_sort(part *parts, size_t count);

/* The record of an array. */
static inline const void *part_record(const part *p, const part_array *a, uint64_t n) {
    return p->m.bytes + a->offset + n * a->record_bytes;
}

#endif
