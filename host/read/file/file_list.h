/* file_list.h - files by what they are, device and inode, whatever their names */
#ifndef FILE_LIST_H
#define FILE_LIST_H

#include <stddef.h>
#include <sys/types.h>

typedef struct file_identity {
    dev_t device;
    ino_t inode;
} file_identity;

typedef struct file_list {
    file_identity *files; /* from malloc */
    size_t count, capacity;
} file_list;

/* 0 or STATUS_FAILED with its text. */
int file_list_add(file_list *list, file_identity file);

/* Whether the file that path names, if there is one, is in the list. */
int file_list_has(const file_list *list, const char *path);

/* Zeroes the list. */
void file_list_release(file_list *list);

#endif
