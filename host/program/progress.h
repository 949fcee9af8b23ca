/*
 * progress.h - time, progress on a terminal, and Ctrl-C
 *
 * Interrupt and termination signals, also those of limits on processor time, only set a flag, which stops the next step
 * that asks; a second one ends the process at once.
 */
#ifndef PROGRESS_H
#define PROGRESS_H

/* Milliseconds of a clock that never goes back. */
double now_ms(void);

/* To be called before any thread is started. From here on signals that end a program set the flag, a limit on file
 * sizes makes writes fail, and progress_update prints where standard error is a terminal and not quiet. */
void progress_begin(int quiet);

/* A tc_progress: prints stage and percentage once a second has passed. Nonzero: stop. */
int progress_update(void *user, const char *stage, double fraction);

/* Clears the line, where one was printed, so that other text may follow. */
void progress_clear(void);

/* Nonzero once a signal came; from any thread. */
int progress_cancelled(void);

/* 0, or a status with its text: STATUS_FAILED of a cancelled run, STATUS_INPUT where an input file became shorter. */
int progress_status(void);

#endif
