/* file_names.h - the names of the files of one surface, in the order of its blocks where each has one of its own */
#ifndef FILE_NAMES_H
#define FILE_NAMES_H

/* Zeroed at first; count 0: no file. */
typedef struct file_names {
    char **names; /* from malloc, as each of them is */
    int count;
} file_names;

/* Room for so many names, all NULL. Returns 0, or STATUS_FAILED without memory. */
int file_names_make(file_names *f, int count);
void file_names_release(file_names *f);

#endif
