/*
 * options.h - the command line: parsed into values, and what there is in it, for --help and completion
 */
#ifndef OPTIONS_H
#define OPTIONS_H

#include "choice.h"
#include "option_values.h"

#include <stdio.h>

/* Parses what follows the command's name into *o, to be released. Returns 0 or STATUS_USAGE with its text. */
int options_parse(enum command_bit command, const char *name, int argc, char **argv, options *o);
void options_release(options *o);

/* Nonzero where the option, e.g. "--dims", stood on the command line. */
int options_given(const options *o, const char *name);

/* What a completion has to know of an option. */
typedef struct option_view {
    const char *name, *short_name; /* short_name: or NULL */
    const char *value, *help;      /* value: as --help shows it; NULL: takes none */
    choice_name *choices;          /* the values there are; or NULL */
    int takes_file;
} option_view;

/* Option n of a command, from 0; returns 0 behind the last. */
int options_view(enum command_bit command, size_t n, option_view *out);

/* The options of a command, one per line or more, as --help shows them. */
void options_print(enum command_bit command, FILE *out);

#endif
