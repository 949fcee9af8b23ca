#include "driver_trial.h"

#include "child_process.h"
#include "exit_status.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A compiler may take a minute on a busy machine; a driver that hangs does so for good. */
static const double trial_most_ms = 180e3;

/* What the child has reported. */
typedef struct trial_report {
    int is_running; /* kernels are built */
    int has_ended;
    tc_status status;
    char text[600];
} trial_report;

static void take_line(void *user, const char *text) {
    trial_report *r = user;
    int status, at = 0;
    if (!strcmp(text, "run")) r->is_running = 1;
    if (sscanf(text, "end %d %n", &status, &at) != 1 || !at) return;
    r->has_ended = 1;
    r->status = (tc_status)status;
    snprintf(r->text, sizeof r->text, "%s", text + at);
}

double trial_limit_ms(void) {
    const char *text = getenv("TETRACUBES_TRIAL_SECONDS");
    double seconds = text ? strtod(text, NULL) : 0;
    return seconds > 0 && seconds < 1e6 ? 1e3 * seconds : trial_most_ms;
}

static void describe_end(const trial_report *r, const child_end *end, char *reason, size_t bytes) {
    char how[80];
    child_end_text(end, how, sizeof how);
    snprintf(reason, bytes, "%s %s%s%s%s", how,
             r->has_ended    ? "at its end"
             : r->is_running ? "where kernels first ran"
                             : "before kernels were built",
             *end->said ? ", last words \"" : "", end->said, *end->said ? "\"" : "");
}

tc_verdict trial_in_child(void *user, const char *job, char *reason, size_t bytes) {
    char command[] = TRIAL_COMMAND, text[300];
    trial_report report = {0};
    child_end end;
    (void)user;
    snprintf(text, sizeof text, "%s", job);
    child_run((char *[]){command, text, NULL}, 10 * trial_limit_ms(), trial_limit_ms(), take_line, &report, &end);
    if (end.kind == CHILD_CANCELLED) return TC_VERDICT_CANCELLED;
    if (end.kind == CHILD_NOT_STARTED) return TC_VERDICT_NONE;
    if (end.kind == CHILD_EXITED && end.number == 0 && report.has_ended) {
        snprintf(reason, bytes, "%s", report.text);
        return report.status == TC_OK                   ? TC_VERDICT_GOOD
               : report.status == TC_ERROR_WRONG_RESULT ? TC_VERDICT_WRONG_RESULT
               : report.status == TC_ERROR_MEMORY       ? TC_VERDICT_STOPPED
               : report.status == TC_ERROR_CANCELLED    ? TC_VERDICT_CANCELLED
                                                        : TC_VERDICT_REFUSED;
    }
    describe_end(&report, &end, reason, bytes);
    if (child_was_ended(&end)) return TC_VERDICT_STOPPED;
    return end.kind == CHILD_TIMED_OUT ? TC_VERDICT_HUNG : TC_VERDICT_CRASHED;
}

/* ----------------------------------------------------------------------------------------------------- in the child */

static int report_stage(void *user, const char *stage, double fraction) {
    (void)user;
    (void)fraction;
    if (!strcmp(stage, "run")) child_report("run");
    return 0;
}

int trial_child(const char *job) {
    child_begin();
    tc_status status = tc_trial_run(job, report_stage, NULL);
    child_report("end %d %s", (int)status, status ? tc_message() : "");
    return 0;
}
