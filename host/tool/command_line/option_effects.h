/*
 * option_effects.h - options that have no effect beside the other options, or on the input that was read
 *
 * One table (option_effects.c) has them all: options that can only be a mistake are refused, the rest give a notice.
 * What only readers and writers of files know (fields that are not there, formats that hold no fields), they refuse
 * themselves.
 */
#ifndef OPTION_EFFECTS_H
#define OPTION_EFFECTS_H

#include "dataset/dataset.h"
#include "options.h"

/* By the command line alone, before any work: 0, or STATUS_USAGE with its text. */
int option_effects_check(const options *o);

/* Likewise of what depends on the input. is_open: no field is chosen, as there are several, or several values. */
int option_effects_check_input(const options *o, const dataset *d, int is_open);

#endif
