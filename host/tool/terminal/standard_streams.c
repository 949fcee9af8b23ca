#include "standard_streams.h"

#include "exit_status.h"
#include "failure.h"
#include "output.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

static struct { FILE *out, *err, *null; } original;

static int is_null_device(const struct stat *s) { return S_ISCHR(s->st_mode) && s->st_rdev == makedev(1, 3); }

/* Whether the output leads to the same file as the descriptor. */
static int is_written_to(const char *path, int fd) {
    struct stat named, standard;
    if (output_is_dash(path)) {
        if (fd == STDOUT_FILENO) return 1;
        if (fstat(STDOUT_FILENO, &named) != 0) return 0;
    } else if (stat(path, &named) != 0) {
        return 0;
    }
    return fstat(fd, &standard) == 0 && named.st_dev == standard.st_dev && named.st_ino == standard.st_ino &&
           !is_null_device(&named);
}

static int is_one_written_to(const char *path, const char *other, int fd) {
    return (path && is_written_to(path, fd)) || (other && is_written_to(other, fd));
}

void streams_choose(const char *path, const char *other) {
    const int takes_out = is_one_written_to(path, other, STDOUT_FILENO);
    const int takes_err = is_one_written_to(path, other, STDERR_FILENO);
    original.out = stdout;
    original.err = stderr;
    if (takes_out && takes_err) original.null = fopen("/dev/null", "w");
    if (takes_out) stdout = takes_err ? original.null : original.err;
    if (takes_err) stderr = takes_out ? original.null : original.out;
    if (!stdout) stdout = original.out; /* a system without /dev/null */
    if (!stderr) stderr = original.err;
}

void streams_restore(void) {
    if (!original.out) return;
    stdout = original.out;
    stderr = original.err;
    if (original.null) fclose(original.null);
    original.null = NULL;
}

#define NOT_WRITTEN "could not write the results to standard output: "

int streams_fail(int error) { return fail(STATUS_FAILED, NOT_WRITTEN "%s", strerror(error)); }

int streams_has_failed(void) { return strncmp(failure_text(), NOT_WRITTEN, strlen(NOT_WRITTEN)) == 0; }
