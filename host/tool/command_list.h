/* command_list.h - the commands of the tool */
#ifndef COMMAND_LIST_H
#define COMMAND_LIST_H

#include "command_line/options.h"

typedef struct command {
    const char *name;
    enum command_bit bit;
    int (*run)(const options *o);
    void (*help)(FILE *out); /* after the options, or NULL */
    const char *summary;
    const char *usage;
    const char *text;
} command;

extern const command command_list[];
extern const size_t command_count;

/* NULL: there is none of that name. */
const command *command_find(const char *name);

#endif
