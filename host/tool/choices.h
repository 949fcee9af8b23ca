/* choices.h - what an input leaves open, and the options that choose: fields, values per sample, frames */
#ifndef CHOICES_H
#define CHOICES_H

#include "dataset.h"
#include "options.h"

#include <jansson.h>

typedef struct choices {
    int64_t frames;      /* 0: none to choose */
    int components;      /* likewise */
    const char *meaning; /* of the components, "" where unknown */
    const char **fields; /* names, of which one is to be chosen; NULL: none */
    int field_count;
    int can_select; /* whether samples of one field can be had without more: frame 0 where frames are open */
} choices;

/* Returns 0, with *c to be released, or a status with its text: where --field names what is not there. */
int choices_find(const options *o, const dataset *d, choices *c);
void choices_release(choices *c);

/* An array: for each choice its option, and how many there are or their names. */
json_t *choices_json(const choices *c);

/* A line for each on standard output. */
void choices_text(const choices *c);

#endif
