/*
 * progress.c - one line on standard error, rewritten at most ten times a second, and the signal flag
 *
 * A second SIGINT, SIGTERM or SIGQUIT ends the program at once; SIGHUP and SIGXCPU may be sent again by the system
 * itself, while the program still tidies up. What was ignored on entry stays so, as nohup wants it.
 *
 * Compilers of kernels (LLVM) put handlers of their own in the place of others'. Those of SIGINT, SIGTERM and SIGHUP
 * hand the signal on; those of SIGQUIT and SIGXCPU swallow the first. So these two have no handler that could be
 * replaced: all threads block them, and one waits for them. What is sent to a single thread waits there until it asks.
 */
#include "progress.h"

#include "exit_status.h"
#include "failure.h"
#include "truncation.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define PATIENCE_MS 1000.0
#define REDRAW_MS   100.0

static atomic_int cancelled; /* the signal; 0: none came */
static sigset_t waited_for;  /* blocked in all threads: SIGQUIT, SIGXCPU */

static struct {
    int shown; /* print at all */
    int drawn; /* a line stands on the terminal */
    double begin_ms, last_ms;
    double job_ms; /* when the job began; 0: there is none */
    uint64_t job_bytes;
} state;

static void cancel(int number) { cancelled = number; }

double now_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

static void catch_signal(int number, unsigned flags) {
    struct sigaction action, before;
    memset(&action, 0, sizeof action);
    action.sa_handler = cancel;
    action.sa_flags = (int)(flags | SA_RESTART);
    if (sigaction(number, NULL, &before) == 0 && before.sa_handler != SIG_IGN) sigaction(number, &action, NULL);
}

/* A signal that was blocked has been taken. */
static void receive(int number) {
    if (number == SIGQUIT && cancelled) {
        sigset_t one;
        sigemptyset(&one);
        sigaddset(&one, number);
        signal(number, SIG_DFL);
        pthread_sigmask(SIG_UNBLOCK, &one, NULL);
        raise(number);
    }
    cancelled = number;
}

static void *wait_for_signals(void *unused) {
    int number;
    while (sigwait(&waited_for, &number) == 0) receive(number);
    return unused;
}

/* Before any other thread is started: all inherit what is blocked. */
static void start_waiting(void) {
    static const int numbers[] = {SIGQUIT, SIGXCPU};
    struct sigaction before;
    pthread_t waiting;
    sigset_t all, old;
    sigemptyset(&waited_for);
    for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++)
        if (sigaction(numbers[n], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            sigaddset(&waited_for, numbers[n]);
    pthread_sigmask(SIG_BLOCK, &waited_for, NULL);
    sigfillset(&all); /* other threads run the handlers, which are to interrupt those threads' system calls */
    pthread_sigmask(SIG_SETMASK, &all, &old);
    int is_there = pthread_create(&waiting, NULL, wait_for_signals, NULL) == 0;
    pthread_sigmask(SIG_SETMASK, &old, NULL);
    if (is_there) {
        pthread_detach(waiting);
        return;
    }
    pthread_sigmask(SIG_UNBLOCK, &waited_for, NULL);
    sigemptyset(&waited_for);
    catch_signal(SIGQUIT, SA_RESETHAND);
    catch_signal(SIGXCPU, 0);
}

void progress_begin(int quiet) {
    catch_signal(SIGINT, SA_RESETHAND);
    catch_signal(SIGTERM, SA_RESETHAND);
    catch_signal(SIGHUP, 0);
    start_waiting();
    signal(SIGXFSZ, SIG_IGN); /* writing fails with EFBIG instead, and says so */
    state.shown = !quiet && isatty(fileno(stderr));
    state.begin_ms = state.last_ms = now_ms();
}

void progress_job_begin(void) {
    state.job_ms = now_ms();
    state.job_bytes = 0;
}

void progress_bytes(uint64_t bytes) { state.job_bytes += bytes; }

/* ", 1.9 GB/s, 0:12 left" */
static void print_job(double now, double fraction) {
    const double seconds = (now - state.job_ms) / 1e3;
    if (state.job_ms == 0 || seconds < 1 || fraction < 0.01) return;
    const unsigned left = (unsigned)(seconds * (1 - fraction) / fraction + 0.5);
    fprintf(stderr, ", %.3g GB/s, %u:%02u left", (double)state.job_bytes / seconds * 1e-9, left / 60, left % 60);
}

int progress_update(void *user, const char *stage, double fraction) {
    (void)user;
    truncation_watch(); /* compilers of kernels may have installed a handler of their own, which serves one fault only
                         */
    double now = now_ms();
    if (state.shown && now - state.begin_ms >= PATIENCE_MS && now - state.last_ms >= REDRAW_MS) {
        fprintf(stderr, "\r\033[K%s %3.0f%%", stage, 100.0 * fraction);
        print_job(now, fraction);
        fflush(stderr);
        state.drawn = 1;
        state.last_ms = now;
    }
    return progress_cancelled();
}

void progress_clear(void) {
    if (!state.drawn) return;
    fprintf(stderr, "\r\033[K");
    fflush(stderr);
    state.drawn = 0;
}

int progress_cancelled(void) {
    static const struct timespec no_time = {0};
    int error = errno, number = sigtimedwait(&waited_for, NULL, &no_time);
    if (number > 0) receive(number);
    errno = error; /* writers ask between a call that failed and its error */
    return cancelled;
}

int progress_status(void) {
    return progress_cancelled() ? fail(STATUS_FAILED, "cancelled; no file was left unfinished") : truncation_status();
}
