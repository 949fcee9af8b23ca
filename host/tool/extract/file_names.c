#include "file_names.h"

#include "exit_status.h"
#include "failure.h"

#include <stdlib.h>

int file_names_make(file_names *f, int count) {
    f->names = calloc((size_t)count, sizeof *f->names);
    if (!f->names) return fail(STATUS_FAILED, "out of memory for the names of the output");
    f->count = count;
    return 0;
}

void file_names_release(file_names *f) {
    for (int n = 0; n < f->count; n++) free(f->names[n]);
    free(f->names);
    *f = (file_names){0};
}
