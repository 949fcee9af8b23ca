/* open_choices.h - what an input leaves open, and the options that choose: fields, values per sample, frames */
#ifndef OPEN_CHOICES_H
#define OPEN_CHOICES_H

#include "dataset/dataset.h"
#include "dataset/request.h"

#include <jansson.h>

typedef struct open_choices {
    int64_t frames;      /* 0: none to choose */
    int components;      /* likewise */
    const char *meaning; /* of the components, "" where unknown */
    const char **fields; /* names, of which one is to be chosen; NULL: none */
    int field_count;
    const char *taken; /* of several, where none is chosen: the file's active scalars; NULL: one has to be chosen */
    int can_select;    /* whether the samples of one field can be had as it is: of frame 0 where frames are open */
} open_choices;

/* Returns 0, with *c to be released, or a status with its text: where --field names what is not there. */
int open_choices_find(const read_request *request, const dataset *d, open_choices *c);
void open_choices_release(open_choices *c);

/* An array: for each choice its option, and how many there are or their names. */
json_t *open_choices_json(const open_choices *c);

/* A line for each on standard output. */
void open_choices_text(const open_choices *c);

#endif
