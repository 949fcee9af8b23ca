/*
 * commands.h - the commands of the tool, one file each
 *
 * A command prints its results on standard output and returns an exit status (exit_status.h); for any but 0 the text
 * to print is in failure.h.
 */
#ifndef COMMANDS_H
#define COMMANDS_H

#include "options.h"
#include "tetracubes.h"

int extract_run(const options *o);
int info_run(const options *o);
int tetrahedralize_run(const options *o);
int devices_run(const options *o);
int generate_run(const options *o);
int selftest_run(const options *o);

/* What follows the options in 'generate --help': the fields. */
void generate_help(FILE *out);

/* The library's failure as the tool's: records tc_message() and returns the exit status that it means. */
int library_status(tc_status status);

/* A driver has failed: this process then ends without giving it occasion to tidy up. */
void driver_distrust(void);

/* One line on standard error, "tetracubes: ..."; not for failures, which main prints. */
void message(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
