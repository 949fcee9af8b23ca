/*
 * standard_streams.h - where results and messages go when a file is written to standard output, or to standard error,
 * itself
 *
 * A report behind a mesh would spoil it. Results then go to standard error, messages of a file on standard error to
 * standard output, and nowhere where both are the file's.
 */
#ifndef STANDARD_STREAMS_H
#define STANDARD_STREAMS_H

/* Sets stdout and stderr for a command that writes the output: "-", or a name, which may lead to what one of them is
 * (/dev/stdout, a FIFO, the file that the shell has opened). NULL: none. */
void streams_choose(const char *output);

/* Sets them back: failures are told in any case, as the file is then not whole. */
void streams_restore(void);

/* STATUS_FAILED with the text that standard output does not take the results, for this errno. */
int streams_fail(int error);

/* Whether that was the last failure. */
int streams_has_failed(void);

#endif
