/*
 * data_names.h - the files that a detached header names: one, a list, or a numbered pattern
 *
 * Only names in the header's own folder or below are accepted: no absolute path, no "..", no symbolic link that leads
 * elsewhere.
 */
#ifndef DATA_NAMES_H
#define DATA_NAMES_H

#include "dataset/dataset.h"
#include "file/header_text.h"
#include "file/mapping.h"

typedef struct data_names {
    char **paths; /* the header's folder put before each */
    int64_t count, capacity;
    size_t bytes; /* of the names, without the folder */
} data_names;

/* Adds one name. 0, STATUS_INPUT for a name that leaves the folder, STATUS_FAILED without memory. */
int data_names_add(data_names *names, const char *header_path, const char *name);

/* Adds every further line of the header. */
int data_names_list(data_names *names, header_text *header);

/* Whether the text is a numbered pattern, "slice.%03d 1 93 1", rather than a name: a % and, at the end, a number. */
int data_names_is_pattern(const char *text);

/* Adds the names of "PATTERN FIRST LAST [STEP [AXES]]"; one %d in the pattern, with optional 0 and width.
 * *axes_per_file is left alone where not given. */
int data_names_pattern(data_names *names, const char *header_path, const char *text, int64_t *axes_per_file);

/* Maps one of the files for the dataset. STATUS_INPUT where it cannot be opened, or where symbolic links lead out of
 * both the folder that the header's path names and the one that the header really lies in. */
int data_names_open(const char *header_path, const char *path, dataset *out, mapping *m);

/* Keeps the first `count` names. */
void data_names_cut(data_names *names, int64_t count);

/* Frees and zeroes. */
void data_names_release(data_names *names);

#endif
