/* selftest.c - runs the groups of trials on a device, each in a child of this process; says PASS or FAIL */
#include "commands.h"
#include "counted.h"
#include "drivers/child_process.h"
#include "drivers/driver_trial.h"
#include "exit_status.h"
#include "failure.h"
#include "library_status.h"
#include "progress.h"
#include "selftest/child.h"
#include "selftest/results.h"
#include "selftest/trials.h"
#include "selftest/vectors.h"
#include "terminal/json_report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A child ends with its driver's first fault, and another one goes on with the next trial: so many times in a group. */
enum { FAULTS_MOST = 8 };

/* A group while it runs. */
typedef struct group_progress {
    int group, number; /* of the trial at hand; -1: none yet */
    char name[400];    /* of the trial at hand; "": none is */
    double begin_ms;
    selftest_results *all;
    int has_ended, status;
    char text[700]; /* with a status */
} group_progress;

/* What a group came to. */
typedef struct verdict {
    int trial_count, failed_count, skipped_count, crashed_count;
    const char *text; /* the first failure */
} verdict;

/* --------------------------------------------------------------------------------------------------------- children */

static void end_trial(group_progress *p, trial_end end, const char *text) {
    if (*p->name) results_add(p->all, p->group, p->name, end, text, now_ms() - p->begin_ms);
    p->name[0] = '\0';
}

/* Of a line "WORD NUMBER TEXT" the text, and its number; NULL of another line. */
static const char *text_of(const char *line, const char *word, int *number) {
    const size_t length = strlen(word);
    char *end;
    if (strncmp(line, word, length) != 0) return NULL;
    const long value = strtol(line + length, &end, 10);
    if (end == line + length || (*end && *end != ' ')) return NULL;
    *number = (int)value;
    return *end ? end + 1 : end;
}

static void take_line(void *user, const char *line) {
    group_progress *p = user;
    const char *text;
    if ((text = text_of(line, "trial ", &p->number))) {
        p->begin_ms = now_ms();
        snprintf(p->name, sizeof p->name, "%s", text);
    } else if (strcmp(line, "ok") == 0) {
        end_trial(p, TRIAL_OK, "");
    } else if (strncmp(line, "failed ", 7) == 0) {
        end_trial(p, TRIAL_FAILED, line + 7);
    } else if (strncmp(line, "skipped ", 8) == 0) {
        end_trial(p, TRIAL_SKIPPED, line + 8);
    } else if ((text = text_of(line, "end ", &p->status))) {
        p->has_ended = 1;
        snprintf(p->text, sizeof p->text, "%s", text);
    }
}

static void start_child(const options *o, group_progress *p, double most_ms, child_end *end) {
    char command[] = SELFTEST_COMMAND, group[16], quick[4], first[16], device[300], vectors[4096];
    snprintf(group, sizeof group, "%d", p->group);
    snprintf(quick, sizeof quick, "%d", o->quick);
    snprintf(first, sizeof first, "%d", p->number + 1);
    snprintf(device, sizeof device, "%s", o->device ? o->device : "");
    snprintf(vectors, sizeof vectors, "%s", o->operand_count ? o->operands[0] : "");
    child_run((char *[]){command, group, device, quick, first, vectors, NULL}, most_ms, trial_limit_ms(), take_line, p,
              end);
}

/* The driver has ended the child, or kept it from going on: a failure of the trial at hand. */
static void note_fault(group_progress *p, const child_end *end) {
    char how[100], text[600];
    const int hung = end->kind == CHILD_TIMED_OUT;
    child_end_text(end, how, sizeof how);
    snprintf(text, sizeof text, "the driver %s: %s%s%s%s", hung ? "hangs" : "crashes", how,
             *end->said ? ", last words \"" : "", end->said, *end->said ? "\"" : "");
    if (!*p->name) { /* between trials: when the device was opened or given back */
        snprintf(p->name, sizeof p->name, "beginning or end");
        p->begin_ms = now_ms();
        p->number++;
    }
    end_trial(p, hung ? TRIAL_HUNG : TRIAL_CRASHED, text);
    driver_distrust();
}

/* Runs a group, or the vectors, to its end or until end_ms. Returns 0 or a status with its text. */
static int run_group(const options *o, int group, double end_ms, selftest_results *all) {
    group_progress p = {.group = group, .number = -1, .all = all};
    for (int faults = 0; faults < FAULTS_MOST; faults++) {
        child_end end;
        const double left = end_ms - now_ms();
        p.has_ended = 0;
        if (left <= 0) break;
        start_child(o, &p, left, &end);
        if (end.kind == CHILD_CANCELLED) return progress_status();
        if (end.kind == CHILD_NOT_STARTED)
            return fail(STATUS_FAILED, "no process can be started for the trials: is /proc there, and memory left?");
        if (p.has_ended && p.status) return fail(p.status, "%s", p.text);
        if (p.has_ended && end.kind == CHILD_EXITED && end.number == 0) return 0;
        if (child_was_ended(&end)) return fail(STATUS_FAILED, "the self-test's process was ended from outside");
        if (end.kind == CHILD_TIMED_OUT && now_ms() >= end_ms) break;
        note_fault(&p, &end);
        if (p.has_ended) return 0; /* after its last trial */
    }
    if (now_ms() < end_ms) return 0;
    end_trial(&p, TRIAL_LATE, "not finished when the time of --timeout was over");
    snprintf(p.name, sizeof p.name, "the rest of the group");
    p.begin_ms = now_ms();
    end_trial(&p, TRIAL_LATE, "not begun when the time of --timeout was over");
    return 0;
}

/* --------------------------------------------------------------------------------------------------------- results */

static verdict judge(const selftest_results *all, int group) {
    verdict v = {.text = ""};
    for (size_t n = 0; n < all->count; n++) {
        const trial_result *r = &all->results[n];
        if (r->group != group) continue;
        v.trial_count += r->end != TRIAL_SKIPPED;
        v.skipped_count += r->end == TRIAL_SKIPPED;
        v.crashed_count += r->end == TRIAL_CRASHED || r->end == TRIAL_HUNG;
        if (r->end == TRIAL_OK || r->end == TRIAL_SKIPPED) continue;
        if (v.failed_count++ == 0) v.text = r->text;
    }
    return v;
}

static const char *first_failed(const selftest_results *all, int group) {
    for (size_t n = 0; n < all->count; n++)
        if (all->results[n].group == group && all->results[n].end != TRIAL_OK && all->results[n].end != TRIAL_SKIPPED)
            return all->results[n].name;
    return "";
}

static void print_group(const selftest_results *all, int group) {
    const verdict v = judge(all, group);
    progress_clear();
    printf("%-30s %3d %-6s  %s\n", group == VECTORS ? "vectors" : trial_groups[group].title, v.trial_count,
           v.trial_count == 1 ? "trial" : "trials", v.failed_count ? "FAILED" : "ok");
    if (v.failed_count) printf("  %d failed; the first: %s: %s\n", v.failed_count, first_failed(all, group), v.text);
    fflush(stdout);
}

static json_t *group_json(const selftest_results *all, int group) {
    const verdict v = judge(all, group);
    char text[1200] = "";
    double ms = 0;
    if (v.failed_count) snprintf(text, sizeof text, "%s: %s", first_failed(all, group), v.text);
    for (size_t n = 0; n < all->count; n++) ms += all->results[n].group == group ? all->results[n].ms : 0;
    return json_pack("{s:s, s:i, s:i, s:s, s:i, s:i, s:o}", "name", group_name(group), "trials", v.trial_count,
                     "failed", v.failed_count, "message", text, "crashed", v.crashed_count, "skipped", v.skipped_count,
                     "seconds", real_json(round(ms) / 1000));
}

/* The device is first opened in a child process, as the driver could end this one. */
static int describe_device(const char *spec, tc_device_info *info) {
    tc_context_options how;
    tc_expert_options expert;
    tc_context *context = NULL;
    *info = (tc_device_info){.struct_size = sizeof *info};
    tc_context_options_init(&how);
    tc_expert_options_init(&expert);
    how.expert = &expert;
    how.device = spec;
    expert.child_trial = trial_in_child;
    int status = library_status(tc_context_create(&how, &context));
    if (!status) status = library_status(tc_context_device(context, info));
    tc_context_destroy(context);
    return status;
}

/* Runs all groups, or the vectors; prints them, or collects them in *groups. */
static int run_groups(const options *o, selftest_results *all, json_t *groups) {
    const double end_ms = now_ms() + (o->timeout ? 1e3 * (double)o->timeout : 1e12);
    const int first = o->vectors ? VECTORS : 0, end = o->vectors ? VECTORS + 1 : trial_group_count;
    for (int n = first; n < end; n++) {
        int status = run_group(o, n, end_ms, all);
        if (status) return status;
        if (o->json)
            json_array_append_new(groups, group_json(all, n));
        else
            print_group(all, n);
    }
    return all->out_of_memory ? fail(STATUS_FAILED, "out of memory for the results of the self-test") : 0;
}

static int print_json(const tc_device_info *info, json_t *groups, int failed_count) {
    return json_report_print(json_pack("{s:o, s:O, s:b, s:o, s:o, s:o, s:s}", "device", string_json(info->name),
                                       "groups", groups, "pass", !failed_count, "platform", string_json(info->platform),
                                       "driver", string_json(info->driver), "version", string_json(info->version),
                                       "tetracubes", tc_version()));
}

static int check_usage(const options *o) {
    if (o->operand_count > (o->vectors ? 1 : 0))
        return fail(STATUS_USAGE, "selftest takes no '%s'; name a device with --device%s",
                    o->operands[o->vectors ? 1 : 0], o->vectors ? "" : ", a file of vectors behind --vectors");
    return 0;
}

/* A file of vectors is looked at here, before any device is. */
static int check_vectors(const options *o) {
    vector_list list = {0};
    int status = o->vectors ? vectors_read(o->operand_count ? o->operands[0] : NULL, &list) : 0;
    vectors_release(&list);
    return status;
}

int selftest_run(const options *o) {
    tc_device_info info;
    selftest_results all = {0};
    json_t *groups = NULL;
    int failed_count = 0;
    int status = check_usage(o);
    if (!status) status = check_vectors(o);
    if (!status) status = describe_device(o->device, &info);
    if (status) goto cleanup;
    if (o->json)
        groups = json_array();
    else
        printf("%s\n", info.name);
    if ((status = run_groups(o, &all, groups))) goto cleanup;
    for (size_t n = 0; n < all.count; n++)
        failed_count += all.results[n].end != TRIAL_OK && all.results[n].end != TRIAL_SKIPPED;
    if (o->json)
        status = print_json(&info, groups, failed_count);
    else
        printf("%s\n", failed_count ? "FAIL" : "PASS");
    if (!status && o->junit) status = junit_write(o->junit, &all, &info);
    if (!status && failed_count)
        status = fail(STATUS_CHECK, "%s failed: do not trust results of %s",
                      counted((uint64_t)failed_count, "trial", "trials").text, info.name);
cleanup:
    json_decref(groups);
    results_release(&all);
    return status;
}
