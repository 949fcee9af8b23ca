/*
 * strike_rank.c - misfortune of one rank at an exact moment: preloaded into tetracubes-mpi, by MPI's profiling
 * interface
 *
 *     RANK_STRIKE="RANK CALL N kill"        before its call N of CALL, from 1, the rank is killed
 *     RANK_STRIKE="RANK CALL N interrupt"   then mpirun, its parent, gets an interrupt, as from a terminal, and the
 * rank hangs for half a minute RANK_STRIKE="RANK CALL N full"        from then on there is no room (MPI_File_open,
 * MPI_File_write_at)
 *
 * CALL: MPI_Iallreduce, MPI_Iexscan, MPI_File_open, MPI_File_write_at, MPI_File_close, rename
 */
#include <dlfcn.h>
#include <errno.h>
#include <mpi.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))

static void interrupt(void) {
    struct timespec left = {30, 0};
    kill(getppid(), SIGINT);
    while (nanosleep(&left, &left) && errno == EINTR) continue;
}

/* Nonzero: no room is left. */
static int strike(const char *call) {
    static int count, is_full;
    char named[64], what[16];
    int rank = 0, wanted, at, is_there = 0;
    const char *text = getenv("RANK_STRIKE");
    if (!text || sscanf(text, "%d %63s %d %15s", &wanted, named, &at, what) != 4 || strcmp(named, call) != 0) return 0;
    PMPI_Initialized(&is_there);
    if (is_there) PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
    if (!is_there || rank != wanted) return 0;
    if (++count == at && strcmp(what, "kill") == 0) raise(SIGKILL);
    if (count == at && strcmp(what, "interrupt") == 0) interrupt();
    if (count == at && strcmp(what, "full") == 0) is_full = 1;
    return is_full;
}

EXPORT int MPI_Iallreduce(const void *from, void *to, int count, MPI_Datatype type, MPI_Op operation, MPI_Comm all,
                          MPI_Request *request) {
    (void)strike("MPI_Iallreduce");
    return PMPI_Iallreduce(from, to, count, type, operation, all, request);
}

EXPORT int MPI_Iexscan(const void *from, void *to, int count, MPI_Datatype type, MPI_Op operation, MPI_Comm all,
                       MPI_Request *request) {
    (void)strike("MPI_Iexscan");
    return PMPI_Iexscan(from, to, count, type, operation, all, request);
}

EXPORT int MPI_File_open(MPI_Comm all, const char *name, int mode, MPI_Info info, MPI_File *file) {
    const int has_room = !strike("MPI_File_open"), code = PMPI_File_open(all, name, mode, info, file);
    return has_room ? code : MPI_ERR_NO_SPACE;
}

EXPORT int MPI_File_write_at(MPI_File file, MPI_Offset at, const void *from, int count, MPI_Datatype type,
                             MPI_Status *status) {
    return strike("MPI_File_write_at") ? MPI_ERR_NO_SPACE : PMPI_File_write_at(file, at, from, count, type, status);
}

EXPORT int MPI_File_close(MPI_File *file) {
    (void)strike("MPI_File_close");
    return PMPI_File_close(file);
}

EXPORT int rename(const char *from, const char *to) {
    int (*next)(const char *, const char *) = (int (*)(const char *, const char *))(size_t)dlsym(RTLD_NEXT, "rename");
    (void)strike("rename");
    return next(from, to);
}
