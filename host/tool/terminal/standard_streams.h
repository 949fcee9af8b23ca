/*
 * standard_streams.h - where results and messages go while the mesh itself is written to standard output or standard
 * error
 *
 * A report behind a mesh would spoil the file. Where the file takes standard output, results go to standard error.
 * Where it takes standard error, messages go to standard output. Where it takes both, neither is printed.
 */
#ifndef STANDARD_STREAMS_H
#define STANDARD_STREAMS_H

/* Sets stdout and stderr for a command that writes these two outputs: "-", or a name, which may lead to what one of
 * them is (/dev/stdout, a FIFO, the file that the shell has opened). NULL: none. */
void streams_choose(const char *output, const char *other);

/* Sets them back. Failures are then told on standard error in any case: the file is not whole. */
void streams_restore(void);

/* STATUS_FAILED with the text that standard output does not take the results, for this errno. */
int streams_fail(int error);

/* Whether that was the last failure. */
int streams_has_failed(void);

#endif
