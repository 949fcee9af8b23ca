/*
 * truncation.h - files that become shorter while they are mapped into memory
 *
 * Reading a page that the file no longer has raises SIGBUS, in whatever thread it is. Such pages are made to read as
 * zeros from then on, and the loss is remembered: work goes on to the next place that asks, and fails there.
 */
#ifndef TRUNCATION_H
#define TRUNCATION_H

/* From here on the process survives such reads; again after what may have set another handler of the signal. */
void truncation_watch(void);

/* Nonzero where a page has been lost. */
int truncation_seen(void);

/* For system calls that have met such a page themselves (EFAULT). */
void truncation_note(void);

/* Where a page has been lost, fails with STATUS_INPUT, else returns 0. */
int truncation_status(void);

#endif
