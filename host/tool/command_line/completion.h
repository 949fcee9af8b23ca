/*
 * completion.h - scripts by which bash and zsh complete the tool's command line, made of the table of options
 *
 * They know commands, options, the values of options that are a choice, and where a file or an analytic field is due.
 */
#ifndef COMPLETION_H
#define COMPLETION_H

#include "options.h"

typedef struct completion_command {
    const char *name, *summary;
    enum command_bit bit;
} completion_command;

/* Prints the script for a shell, "bash" or "zsh". Returns 0, or STATUS_USAGE with its text for another one. */
int completion_print(const char *shell, const completion_command *commands, size_t count, FILE *out);

#endif
