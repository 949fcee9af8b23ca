#include "child_process.h"

#include "progress.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

enum { REPORT_FILE = 3, ARGUMENTS_MOST = 8, LINE_BYTES = 1200, POLL_MS = 20 };

/* Text that comes in pieces, cut into lines. The end of a line that is too long is dropped. */
typedef struct line_reader {
    int file; /* -1: at its end */
    size_t count;
    char text[LINE_BYTES];
} line_reader;

typedef struct child {
    pid_t process;
    line_reader report, chatter;
    void (*line)(void *user, const char *text);
    void *user;
    child_end *end;
    double begin_ms, told_ms; /* when it began, and reported last */
    double told_cpu_ms;       /* processor time that it had used by then */
    double busy_ms, cpu_ms;   /* when it last used the processor; how much of it by then */
} child;

/* ------------------------------------------------------------------------------------------------------------ start */

/* The program's file: the link itself where its target has been replaced meanwhile. */
static const char *program_path(char *path, size_t bytes) {
    static const char link[] = "/proc/self/exe";
    const ssize_t length = readlink(link, path, bytes - 1);
    if (length <= 0) return link;
    path[length] = '\0';
    return access(path, X_OK) ? link : path;
}

/* Read ends in [0], both kept from other children. */
static int make_pipes(int report[2], int chatter[2]) {
    if (pipe2(report, O_CLOEXEC)) return -1;
    if (!pipe2(chatter, O_CLOEXEC)) return 0;
    close(report[0]);
    close(report[1]);
    return -1;
}

/* The child starts with default signals, as from a shell, whatever this process ignores or blocks. */
static int set_attributes(posix_spawnattr_t *attributes) {
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    return posix_spawnattr_setflags(attributes,
                                    POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK) ||
           posix_spawnattr_setpgroup(attributes, 0) || posix_spawnattr_setsigmask(attributes, &none) ||
           posix_spawnattr_setsigdefault(attributes, &all);
}

/* Standard input is empty; output and errors go to the chatter, the report to REPORT_FILE. */
static int set_files(posix_spawn_file_actions_t *files, int report, int chatter) {
    const int has_null = access("/dev/null", R_OK) == 0;
    return (has_null && posix_spawn_file_actions_addopen(files, STDIN_FILENO, "/dev/null", O_RDONLY, 0)) ||
           posix_spawn_file_actions_adddup2(files, chatter, STDOUT_FILENO) ||
           posix_spawn_file_actions_adddup2(files, chatter, STDERR_FILENO) ||
           posix_spawn_file_actions_adddup2(files, report, REPORT_FILE);
}

/* Moves a file away from the numbers that the child's own have; -1 where that fails. */
static int lift(int file) {
    if (file > REPORT_FILE) return file;
    int lifted = fcntl(file, F_DUPFD_CLOEXEC, REPORT_FILE + 1);
    close(file);
    return lifted;
}

static int spawn(const char *path, char *const arguments[], int report, int chatter, pid_t *process) {
    char *all[ARGUMENTS_MOST + 2] = {"tetracubes"};
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_t files;
    for (int n = 0; n < ARGUMENTS_MOST && arguments[n]; n++) all[n + 1] = arguments[n];
    if (posix_spawnattr_init(&attributes)) return -1;
    if (posix_spawn_file_actions_init(&files)) {
        posix_spawnattr_destroy(&attributes);
        return -1;
    }
    int error = set_attributes(&attributes) || set_files(&files, report, chatter);
    if (!error) error = posix_spawn(process, path, &files, &attributes, all, environ);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
    return error ? -1 : 0;
}

static int start(char *const arguments[], child *c) {
    int report[2], chatter[2];
    char path[PATH_MAX];
    if (make_pipes(report, chatter)) return -1;
    report[1] = lift(report[1]);
    chatter[1] = lift(chatter[1]);
    int error = report[1] < 0 || chatter[1] < 0 ||
                spawn(program_path(path, sizeof path), arguments, report[1], chatter[1], &c->process);
    if (report[1] >= 0) close(report[1]);
    if (chatter[1] >= 0) close(chatter[1]);
    c->report.file = report[0];
    c->chatter.file = chatter[0];
    fcntl(report[0], F_SETFL, O_NONBLOCK);
    fcntl(chatter[0], F_SETFL, O_NONBLOCK);
    return error ? -1 : 0;
}

/* ---------------------------------------------------------------------------------------------------------- reading */

static void keep_said(child_end *end, const char *text) {
    size_t count = 0;
    while (*text == ' ') text++;
    if (!*text) return;
    for (; *text && count < sizeof end->said - 1; text++)
        end->said[count++] = (char)((unsigned char)*text < ' ' || *text == 127 ? ' ' : *text);
    end->said[count] = '\0';
}

/* Processor time of all threads of a process. */
static double processor_ms(pid_t process) {
    clockid_t clock;
    struct timespec used;
    if (clock_getcpuclockid(process, &clock) || clock_gettime(clock, &used)) return 0;
    return 1e3 * (double)used.tv_sec + 1e-6 * (double)used.tv_nsec;
}

static void line_done(child *c, line_reader *r) {
    r->text[r->count] = '\0';
    r->count = 0;
    if (r == &c->report) {
        c->told_ms = now_ms();
        c->told_cpu_ms = processor_ms(c->process);
        c->line(c->user, r->text);
    } else {
        keep_said(c->end, r->text);
    }
}

static void read_lines(child *c, line_reader *r) {
    char bytes[4096];
    ssize_t got;
    while (r->file >= 0 && (got = read(r->file, bytes, sizeof bytes)) != 0) {
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return; /* nothing to read yet */
        for (ssize_t n = 0; n < got; n++)
            if (bytes[n] == '\n')
                line_done(c, r);
            else if (r->count < sizeof r->text - 1)
                r->text[r->count++] = bytes[n];
    }
    if (r->file < 0) return;
    if (r->count) line_done(c, r);
    close(r->file);
    r->file = -1;
}

/* ---------------------------------------------------------------------------------------------------------- waiting */

/* Where somebody has set SIGCHLD to be ignored, the system forgets how children end: then it is as if they had exited
 * well, and what they have reported counts. */
static int has_ended(child *c) {
    int status = 0;
    pid_t ended;
    do ended = waitpid(c->process, &status, WNOHANG);
    while (ended < 0 && errno == EINTR);
    if (!ended) return 0;
    const int died = ended > 0 && WIFSIGNALED(status);
    c->end->kind = died ? CHILD_DIED : CHILD_EXITED;
    c->end->number = died ? WTERMSIG(status) : ended > 0 ? WEXITSTATUS(status) : 0;
    return 1;
}

static void stop(child *c, child_end_kind kind) {
    int status;
    kill(-c->process, SIGKILL);
    kill(c->process, SIGKILL); /* before it has become a group */
    while (waitpid(c->process, &status, 0) < 0 && errno == EINTR) status = 0;
    c->end->kind = kind;
}

/* Hangs: without a line for so long, and meanwhile it has used the processor for as long, or has not used it for half
 * of that. What is merely slow on a busy machine does neither. */
static int is_hanging(child *c, double silent_ms) {
    enum { USED_MS = 20 };
    const double now = now_ms(), used = processor_ms(c->process);
    if (used - c->cpu_ms > USED_MS) c->busy_ms = now;
    if (used - c->cpu_ms > USED_MS) c->cpu_ms = used;
    if (now - c->told_ms < silent_ms) return 0;
    return now - c->busy_ms > silent_ms / 2 || used - c->told_cpu_ms > silent_ms;
}

/* The pipes may stay open longer than the process: what a driver has started may hold them. */
static void wait_for(child *c, double most_ms, double silent_ms) {
    c->begin_ms = c->told_ms = c->busy_ms = now_ms();
    for (;;) {
        struct pollfd files[2] = {{c->report.file, POLLIN, 0}, {c->chatter.file, POLLIN, 0}};
        const int is_open = c->report.file >= 0 || c->chatter.file >= 0;
        poll(files, 2, is_open ? POLL_MS : 1);
        read_lines(c, &c->report);
        read_lines(c, &c->chatter);
        if (has_ended(c)) break;
        if (progress_cancelled()) {
            stop(c, CHILD_CANCELLED);
            break;
        }
        if (now_ms() - c->begin_ms > most_ms || is_hanging(c, silent_ms)) {
            stop(c, CHILD_TIMED_OUT);
            break;
        }
    }
    read_lines(c, &c->report);
    read_lines(c, &c->chatter);
    kill(-c->process, SIGKILL); /* what it has left running */
}

void child_run(char *const arguments[], double most_ms, double silent_ms, void (*line)(void *user, const char *text),
               void *user, child_end *end) {
    child c = {.report.file = -1, .chatter.file = -1, .line = line, .user = user, .end = end};
    *end = (child_end){CHILD_NOT_STARTED, 0, ""};
    if (!start(arguments, &c)) wait_for(&c, most_ms, silent_ms);
    if (c.report.file >= 0) close(c.report.file);
    if (c.chatter.file >= 0) close(c.chatter.file);
}

int child_was_ended(const child_end *end) {
    static const int others[] = {SIGKILL, SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGXCPU};
    for (size_t n = 0; n < sizeof others / sizeof *others; n++)
        if (end->kind == CHILD_DIED && end->number == others[n]) return 1;
    return 0;
}

void child_end_text(const child_end *end, char *text, size_t bytes) {
    if (end->kind == CHILD_EXITED)
        snprintf(text, bytes, "exit status %d", end->number);
    else if (end->kind == CHILD_DIED)
        snprintf(text, bytes, "signal %d (%s)", end->number, strsignal(end->number));
    else
        snprintf(text, bytes, "%s",
                 end->kind == CHILD_TIMED_OUT   ? "time ran out"
                 : end->kind == CHILD_CANCELLED ? "cancelled"
                                                : "no process");
}

/* ----------------------------------------------------------------------------------------------------- in the child */

void child_begin(void) {
    const struct rlimit none = {0, 0};
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() == 1) _exit(1); /* the parent went before that was said */
    setrlimit(RLIMIT_CORE, &none);
    fcntl(REPORT_FILE, F_SETFD, FD_CLOEXEC); /* not for what a driver starts */
}

void child_report(const char *format, ...) {
    char text[LINE_BYTES];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(text, sizeof text - 1, format, arguments);
    va_end(arguments);
    if (length < 0) return;
    if (length > (int)sizeof text - 2) length = (int)sizeof text - 2;
    for (int n = 0; n < length; n++)
        if (text[n] == '\n') text[n] = ' ';
    text[length] = '\n';
    for (ssize_t done = 0, put; done <= length; done += put) {
        put = write(REPORT_FILE, text + done, (size_t)(length + 1 - done));
        if (put < 0 && errno == EINTR) put = 0;
        if (put < 0) return;
    }
}
