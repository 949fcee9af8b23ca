/*
 * truncation.h - files that become shorter, or are written to, while they are mapped into memory
 *
 * Reading a page that the file no longer has raises SIGBUS in the reading thread. From then on such a page reads as
 * zeros, and the loss is remembered: work goes on until somebody asks truncation_status, and fails there.
 *
 * What another program writes into a mapped file shows in the mapping, so that a surface could be made of samples that
 * never were in the file together. The file's size and the time of its last change tell, as finely as the file system
 * keeps time.
 */
#ifndef TRUNCATION_H
#define TRUNCATION_H

/* Installs the handler of SIGBUS. To be called again after anything that may have installed another one. */
void truncation_watch(void);

/* Watches an open file for changes until its mapping is unwatched; the descriptor stays the caller's. Where descriptors
 * or memory run out, the file is not watched. */
void truncation_watch_file(int file, const void *mapping);
void truncation_unwatch_file(const void *mapping);

/* Nonzero where a page has been lost, or a watched file has changed. */
int truncation_seen(void);

/* Remembers a lost page that a system call has met, which then fails with EFAULT. */
void truncation_note(void);

/* STATUS_INPUT, with its message, where truncation_seen; else 0. */
int truncation_status(void);

#endif
