#include "ranks.h"

#include "exit_status.h"
#include "failure.h"
#include "progress.h"
#include "terminal/notice.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { WRITE_MOST = 1 << 30, PATH_BYTES = 4096 };

/* A status with its text, as it goes from rank to rank. */
typedef struct told_status {
    int status;
    char text[1024];
} told_status;

static ranks *ranks_of(team *t) { return (ranks *)(void *)t; }

/* ----------------------------------------------------------------------------------------------------------- ending */

static pthread_mutex_t files_lock = PTHREAD_MUTEX_INITIALIZER;

static void remove_unfinished(ranks *r) {
    pthread_mutex_lock(&files_lock);
    for (int n = 0; n < r->file_count; n++) unlink(r->files[n]->temporary);
    r->file_count = 0;
    pthread_mutex_unlock(&files_lock);
}

static atomic_flag is_told = ATOMIC_FLAG_INIT;

void ranks_ending(void) { atomic_flag_test_and_set(&is_told); }

/* Of a run that is ended from outside, or by another rank, two ranks tell it, as one of them may hang. */
static void tell_cancelled(const ranks *r) {
    if (r->team.rank <= 1 && !atomic_flag_test_and_set(&is_told))
        message("ended by a signal, or with another rank; no file was left unfinished");
}

static __attribute__((noreturn)) void leave(team *t, int status) {
    ranks *r = ranks_of(t);
    remove_unfinished(r);
    if (!progress_cancelled())
        message("rank %d: %s", t->rank, failure_text());
    else
        tell_cancelled(r);
    fflush(NULL);
    MPI_Abort(r->all, status ? status : STATUS_FAILED);
    _exit(status ? status : STATUS_FAILED);
}

/* A rank within a call that does not return, as others have ended, is ended by a thread of its own: mpirun sends
 * SIGTERM to all, and kills them a second later. */
static void *watch(void *user) {
    const struct timespec often = {0, 10000000}, patience = {0, 50000000};
    ranks *r = user;
    while (!progress_cancelled()) nanosleep(&often, NULL);
    nanosleep(&patience, NULL);
    remove_unfinished(r);
    tell_cancelled(r);
    _exit(STATUS_FAILED);
}

/* The thread takes no signals. */
static void watch_begin(ranks *r) {
    pthread_t watching;
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    if (pthread_create(&watching, NULL, watch, r) == 0) pthread_detach(watching);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

/* ---------------------------------------------------------------------------------------------------------- waiting */

/* Waits without using the processor, which other ranks may need, and ends with a signal. */
static void wait_for(ranks *r, MPI_Request *request) {
    struct timespec pause = {0, 20000};
    int is_done = 0;
    for (;;) {
        MPI_Test(request, &is_done, MPI_STATUS_IGNORE);
        if (is_done) return;
        if (progress_cancelled()) leave(&r->team, STATUS_FAILED);
        nanosleep(&pause, NULL);
        if (pause.tv_nsec < 2000000) pause.tv_nsec *= 2;
    }
}

static void reduce(ranks *r, void *values, int count, MPI_Datatype type, MPI_Op operation) {
    MPI_Request request;
    int bytes = 0;
    MPI_Type_size(type, &bytes);
    MPI_Iallreduce(MPI_IN_PLACE, values, count, type, operation, r->all, &request);
    wait_for(r, &request);
    r->sent_bytes += (uint64_t)bytes * (uint64_t)count;
}

static void broadcast(ranks *r, void *bytes, int count, int from) {
    MPI_Request request;
    MPI_Ibcast(bytes, count, MPI_BYTE, from, r->all, &request);
    wait_for(r, &request);
    if (r->team.rank == from) r->sent_bytes += (uint64_t)count;
}

/* --------------------------------------------------------------------------------------------------------- agreeing */

static int agree(team *t, int status) {
    ranks *r = ranks_of(t);
    int first = status ? t->rank : t->size;
    told_status told = {.status = status};
    reduce(r, &first, 1, MPI_INT, MPI_MIN);
    if (first == t->size) return 0;
    if (status) snprintf(told.text, sizeof told.text, "%s", failure_text());
    broadcast(r, &told, sizeof told, first);
    t->has_failed = 1;
    return first ? fail(told.status, "rank %d: %s", first, told.text) : fail(told.status, "%s", told.text);
}

static void sum(team *t, uint64_t *values, uint64_t *before, size_t count) {
    ranks *r = ranks_of(t);
    MPI_Request request;
    memset(before, 0, count * sizeof *before);
    MPI_Iexscan(values, before, (int)count, MPI_UINT64_T, MPI_SUM, r->all, &request);
    wait_for(r, &request);
    if (t->rank == 0) memset(before, 0, count * sizeof *before);
    r->sent_bytes += count * sizeof *values;
    reduce(r, values, (int)count, MPI_UINT64_T, MPI_SUM);
}

static void most(team *t, double *values, size_t count) {
    reduce(ranks_of(t), values, (int)count, MPI_DOUBLE, MPI_MAX);
}

int ranks_largest(ranks *r, int value) {
    reduce(r, &value, 1, MPI_INT, MPI_MAX);
    return value;
}

static uint64_t sent_bytes(const team *t) { return ((const ranks *)(const void *)t)->sent_bytes; }

/* ------------------------------------------------------------------------------------------------------------ files */

/* What the system said last, where MPI's own class says less. */
static int errno_of(int code, int system) {
    int class = MPI_ERR_OTHER;
    MPI_Error_class(code, &class);
    switch (class) {
    case MPI_ERR_NO_SPACE:
        return ENOSPC;
    case MPI_ERR_QUOTA:
        return EDQUOT;
    case MPI_ERR_READ_ONLY:
        return EROFS;
    case MPI_ERR_ACCESS:
        return EACCES;
    default:
        return system ? system : EIO;
    }
}

static int write_at(void *user, const void *data, uint64_t bytes, uint64_t position) {
    const rank_file *f = user;
    const unsigned char *from = data;
    while (bytes) {
        const int count = bytes < WRITE_MOST ? (int)bytes : WRITE_MOST;
        int written = 0;
        MPI_Status status;
        errno = 0;
        const int code = MPI_File_write_at(f->file, (MPI_Offset)position, from, count, MPI_BYTE, &status);
        if (code != MPI_SUCCESS) return errno_of(code, errno);
        MPI_Get_count(&status, MPI_BYTE, &written);
        if (written != count) return errno ? errno : ENOSPC;
        from += count;
        bytes -= (uint64_t)count;
        position += (uint64_t)count;
    }
    return 0;
}

/* As output_expect of a file that is no one else's: what the file system lacks is no error, but room is. */
static int expect(void *user, uint64_t bytes) {
    const rank_file *f = user;
    const int file = open(f->temporary, O_WRONLY | O_CLOEXEC);
    if (file < 0) return 0;
    const int error = fallocate(file, FALLOC_FL_KEEP_SIZE, 0, (off_t)bytes) ? errno : 0;
    close(file);
    return error == ENOSPC ? error : 0;
}

static int open_all(ranks *r, rank_file *f) {
    errno = 0;
    const int code = MPI_File_open(r->all, f->temporary, MPI_MODE_WRONLY, MPI_INFO_NULL, &f->file);
    if (code == MPI_SUCCESS) return 0;
    f->file = MPI_FILE_NULL;
    return fail(STATUS_FAILED, "%s: cannot be written by this rank: %s; name a file that all ranks share", f->temporary,
                strerror(errno_of(code, errno)));
}

static int open_file(team *t, const char *temporary, output_shared *shared) {
    ranks *r = ranks_of(t);
    char path[PATH_BYTES] = "";
    rank_file *f = calloc(1, sizeof *f);
    int status = f && r->file_count < RANK_FILES_MOST ? 0 : fail(STATUS_FAILED, "no memory, or too many isovalues");
    if (!status && temporary && strlen(temporary) >= sizeof path)
        status = fail(STATUS_FAILED, "%s: the name is too long", temporary);
    if (!status && !t->rank && !temporary) /* a pipe, a device */
        status = fail(STATUS_USAGE, "several ranks write at many places of a file: name a file");
    if (!status && temporary) snprintf(path, sizeof path, "%s", temporary);
    status = agree(t, status);
    if (!status) broadcast(r, path, ranks_largest(r, (int)strlen(path) + 1), 0);
    if (!status && !(f->temporary = strdup(path))) status = fail(STATUS_FAILED, "out of memory for a file");
    status = agree(t, status);
    if (status) {
        if (f) free(f->temporary);
        free(f);
        return status;
    }
    f->ranks = r;
    pthread_mutex_lock(&files_lock);
    r->files[r->file_count++] = f;
    pthread_mutex_unlock(&files_lock);
    shared->write_at = write_at;
    shared->expect = expect;
    shared->user = f;
    return agree(t, open_all(r, f));
}

static int close_file(team *t, output_shared *shared) {
    rank_file *f = shared->user;
    int status = agree(t, 0); /* a rank that is not there any more is waited for here, not within the call */
    errno = 0;
    const int code = MPI_File_close(&f->file);
    status = code == MPI_SUCCESS
                 ? 0
                 : fail(STATUS_FAILED, "%s: cannot be written: %s", f->temporary, strerror(errno_of(code, errno)));
    return agree(t, status);
}

/* ------------------------------------------------------------------------------------------------------------ begin */

void ranks_begin(ranks *r) {
    MPI_Comm node;
    *r = (ranks){.all = MPI_COMM_WORLD};
    r->team = (team){.node_size = 1,
                     .agree = agree,
                     .sum = sum,
                     .most = most,
                     .open = open_file,
                     .close = close_file,
                     .sent_bytes = sent_bytes,
                     .leave = leave};
    MPI_Comm_rank(r->all, &r->team.rank);
    MPI_Comm_size(r->all, &r->team.size);
    MPI_Comm_split_type(r->all, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
    MPI_Comm_rank(node, &r->node_rank);
    MPI_Comm_size(node, &r->team.node_size);
    MPI_Comm_free(&node);
    watch_begin(r);
}
