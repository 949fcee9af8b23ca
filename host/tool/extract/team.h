/*
 * team.h - several processes that make surfaces together: each has planes of its own, and all write one file
 *
 * A process by itself has no team. All members call each of these at the same places; what a member has to tell waits
 * there for the others. Functions that return a status return the same one on all members: 0, or that of the first
 * member that had another one, with its text.
 */
#ifndef TEAM_H
#define TEAM_H

#include "output.h"

typedef struct team team;
struct team {
    int rank, size;
    int node_size;  /* members on this machine */
    int has_failed; /* all know of a failure */
    int64_t
        *begins; /* where members 1, 2, ... begin, where that was measured (planes_cut.h); NULL: by the command line */

    /* status: of this member so far. */
    int (*agree)(team *t, int status);

    /* values: of this member; then sums over all. before: sums over those of lower rank. */
    void (*sum)(team *t, uint64_t *values, uint64_t *before, size_t count);

    /* values: of this member; then the largest of all. */
    void (*most)(team *t, double *values, size_t count);

    /* The file that the first member has made under that name, which the others need not know, for writing by all;
     * *file NULL after a failure. */
    int (*open)(team *t, const char *temporary, output_shared *file);
    int (*close)(team *t, output_shared *file);

    /* Bytes that this member has sent to others so far. */
    uint64_t (*sent_bytes)(const team *t);

    /* A failure that the others cannot wait for: tells it, removes what is unfinished, ends all members. */
    void (*leave)(team *t, int status); /* does not return */
};

#endif
