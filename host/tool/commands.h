/*
 * commands.h - the commands of the tool, one file each
 *
 * A command prints its results on standard output and returns an exit status (exit_status.h). Where that is not 0, main
 * prints failure_text() (failure.h).
 */
#ifndef COMMANDS_H
#define COMMANDS_H

#include "command_line/options.h"
#include "extract/team.h"

int extract_run(const options *o);
int extract_run_together(const options *o, team *t); /* as one of a team; all of it return the same status */
int labels_run(const options *o);
int join_run(const options *o);
int isovolume_run(const options *o);
int info_run(const options *o);
int tetrahedralize_run(const options *o);
int devices_run(const options *o);
int generate_run(const options *o);
int selftest_run(const options *o);

/* What follows the options in 'generate --help': the fields. */
void generate_help(FILE *out);

#endif
