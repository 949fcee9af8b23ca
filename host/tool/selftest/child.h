/*
 * child.h - the part of the self-test that a driver may end: a group of trials, or the vectors, in a process of its own
 *
 * A driver that crashes or hangs fails one trial, and another child goes on behind it. The child numbers the trials
 * that it comes to, from 0, and reports
 *
 *     trial NUMBER NAME      it begins
 *     ok | failed TEXT | skipped TEXT    how it ended
 *     end STATUS TEXT        no more of them; STATUS not 0: they could not be run
 */
#ifndef CHILD_H
#define CHILD_H

/* The command by which a child is started: not one that --help shows; arguments: group, device, quick, first, vectors.
 */
#define SELFTEST_COMMAND "--group-of-selftest"

/* The child's part; returns the process's exit status. */
int selftest_child(int argc, char **argv);

#endif
