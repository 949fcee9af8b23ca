/* command_run.h - one run of a command, from its arguments on */
#ifndef COMMAND_RUN_H
#define COMMAND_RUN_H

#include "command_list.h"

/* argv: what follows the command's name. parsed: NULL, or called with the options, which it may change, and the status
 * of parsing them; what it returns takes the place of that. Returns an exit status with its text (failure.h). */
int command_run(const command *c, int argc, char **argv, int (*parsed)(options *o, int status));

/* Makes known the writers that this build has beside those that all have; before anything else. */
void writers_add(void);

/* What COMMAND --help prints. */
void command_help(const command *c, FILE *out);

/* The version, and the file formats of this build. */
void version_print(const char *program, FILE *out);

#endif
