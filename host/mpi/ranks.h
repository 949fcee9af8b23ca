/*
 * ranks.h - the processes of an MPI job as a team (extract/team.h)
 *
 * Waiting looks for signals, as mpirun ends all ranks by one where a rank was killed; a thread ends a rank that hangs
 * in a call by then. Unfinished files are removed by whoever ends. What a rank sends is counted. Files are written by
 * MPI-IO: opened and closed by all ranks together, written in large blocks by each at its offsets.
 */
#ifndef RANKS_H
#define RANKS_H

#include "extract/team.h"

#include <mpi.h>

enum { RANK_FILES_MOST = 4096 }; /* open at a time: one per isovalue */

/* A file that all ranks write. */
typedef struct rank_file {
    struct ranks *ranks;
    MPI_File file;
    char *temporary;
} rank_file;

typedef struct ranks {
    team team; /* first: a team is converted to ranks */
    MPI_Comm all;
    int node_rank; /* of this rank among those of its machine */
    uint64_t sent_bytes;
    rank_file *files[RANK_FILES_MOST];
    int file_count;
} ranks;

/* After MPI_Init_thread. */
void ranks_begin(ranks *r);

/* All ranks have come to their end, and know how. mpirun ends the last ones with a signal where the first has failed:
 * that is not told. */
void ranks_ending(void);

/* The largest of all ranks' values. */
int ranks_largest(ranks *r, int value);

#endif
