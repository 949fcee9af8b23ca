/*
 * truncation.h - files that become shorter, or other ones, while they are mapped into memory
 *
 * Reading a page that the file no longer has raises SIGBUS, in whatever thread it is. Such pages are made to read as
 * zeros from then on, and the loss is remembered: work goes on to the next place that asks, and fails there.
 *
 * What is written into a mapped file shows in its mapping, so that a surface may be made of samples that were never
 * there together. The size and the time of the last change tell it, as finely as the file system keeps time.
 */
#ifndef TRUNCATION_H
#define TRUNCATION_H

/* From here on the process survives such reads; again after what may have set another handler of the signal. */
void truncation_watch(void);

/* From here on the open file is asked whether it has changed, until truncation_unwatch of its mapping; the descriptor
 * stays the caller's. A file that cannot be watched for want of descriptors is not. */
void truncation_watch_file(int file, const void *mapping);
void truncation_unwatch_file(const void *mapping);

/* Nonzero where a page has been lost, or a watched file has changed. */
int truncation_seen(void);

/* For system calls that have met such a page themselves (EFAULT). */
void truncation_note(void);

/* Where either is so, fails with STATUS_INPUT, else returns 0. */
int truncation_status(void);

#endif
