/*
 * progress.c - one line on standard error, rewritten at most ten times a second, and the signal flag
 *
 * A second SIGINT, SIGTERM or SIGQUIT ends the program at once; SIGHUP and SIGXCPU may be sent again by the system
 * itself, while the program still tidies up. What was ignored on entry stays so, as nohup wants it.
 */
#include "progress.h"

#include "exit_status.h"
#include "failure.h"
#include "truncation.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define PATIENCE_MS 1000.0
#define REDRAW_MS   100.0

static volatile sig_atomic_t cancelled;

static struct {
    int shown; /* print at all */
    int drawn; /* a line stands on the terminal */
    double begin_ms, last_ms;
} state;

static void cancel(int number) {
    (void)number;
    cancelled = 1;
}

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

void progress_begin(int quiet) {
    catch_signal(SIGINT, SA_RESETHAND);
    catch_signal(SIGTERM, SA_RESETHAND);
    catch_signal(SIGQUIT, SA_RESETHAND);
    catch_signal(SIGHUP, 0);
    catch_signal(SIGXCPU, 0);
    signal(SIGXFSZ, SIG_IGN); /* writing fails with EFBIG instead, and says so */
    state.shown = !quiet && isatty(STDERR_FILENO);
    state.begin_ms = state.last_ms = now_ms();
}

int progress_update(void *user, const char *stage, double fraction) {
    (void)user;
    truncation_watch(); /* what builds kernels may have put a handler of its own in front, which serves one fault only
                         */
    double now = now_ms();
    if (state.shown && now - state.begin_ms >= PATIENCE_MS && now - state.last_ms >= REDRAW_MS) {
        fprintf(stderr, "\r\033[K%s %3.0f%%", stage, 100.0 * fraction);
        fflush(stderr);
        state.drawn = 1;
        state.last_ms = now;
    }
    return cancelled;
}

void progress_clear(void) {
    if (!state.drawn) return;
    fprintf(stderr, "\r\033[K");
    fflush(stderr);
    state.drawn = 0;
}

int progress_cancelled(void) { return cancelled; }

int progress_status(void) {
    return cancelled ? fail(STATUS_FAILED, "cancelled; no file was left unfinished") : truncation_status();
}
