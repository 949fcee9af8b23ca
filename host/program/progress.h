/*
 * progress.h - time, progress on a terminal, and Ctrl-C
 *
 * Interrupt and termination signals, also those of limits on processor time, only set a flag, which stops the next step
 * that asks; a second one ends the process at once.
 */
#ifndef PROGRESS_H
#define PROGRESS_H

#include <stdint.h>

/* Milliseconds of a clock that never goes back. */
double now_ms(void);

/* To be called before any thread is started. From here on signals that end a program set the flag, a limit on file
 * sizes makes writes fail, and progress_update prints where standard error is a terminal and not quiet. */
void progress_begin(int quiet);

/* From now on a long job counts: its percentage runs from 0 to 100 once, so that the time left can be told. */
void progress_job_begin(void);

/* So many bytes more are being read or written: their rate is told of a job. */
void progress_bytes(uint64_t bytes);

/* A tc_progress: prints stage and percentage once a second has passed, of a job also bytes per second and the time that
 * is left. Nonzero: stop. */
int progress_update(void *user, const char *stage, double fraction);

/* Clears the line, where one was printed, so that other text may follow. */
void progress_clear(void);

/* The signal, once one came, else 0; from any thread. */
int progress_cancelled(void);

/* 0, or a status with its text: STATUS_FAILED of a cancelled run, STATUS_INPUT where an input file became shorter. */
int progress_status(void);

#endif
