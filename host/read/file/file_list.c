#include "file/file_list.h"

#include "exit_status.h"
#include "failure.h"

#include <stdlib.h>
#include <sys/stat.h>

int file_list_add(file_list *list, file_identity file) {
    if (list->count == list->capacity) {
        const size_t capacity = 2 * list->capacity + 4;
        file_identity *grown = realloc(list->files, capacity * sizeof *grown);
        if (!grown) return fail(STATUS_FAILED, "no memory for the list of %zu files", list->count);
        list->files = grown;
        list->capacity = capacity;
    }
    list->files[list->count++] = file;
    return 0;
}

int file_list_has(const file_list *list, const char *path) {
    struct stat about;
    if (stat(path, &about) != 0) return 0;
    for (size_t n = 0; n < list->count; n++)
        if (list->files[n].device == about.st_dev && list->files[n].inode == about.st_ino) return 1;
    return 0;
}

void file_list_release(file_list *list) {
    free(list->files);
    *list = (file_list){0};
}
