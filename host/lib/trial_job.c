/*
 * A trial by its job: the line of text that a context has handed to its callback (vetting.c).
 */
#include "context_create.h"
#include "failure.h"
#include "base/float_environment.h"
#include "trial/trial.h"

#include <stdio.h>
#include <string.h>

typedef struct job {
    unsigned kind; /* KERNEL_KINDS: the device is opened, no more */
    tc_context_options options;
    tc_expert_options expert;
    char device[32], name[128];
} job;

static bool job_read(const char *text, job *j) {
    int platform, index, division, name = 0;
    tc_context_options_init(&j->options);
    tc_expert_options_init(&j->expert);
    tc_expert_options *e = &j->expert;
    if (!text ||
        sscanf(text, "tetracubes-trial-1 %d:%d %u %u %d %d %n", &platform, &index, &j->kind, &e->work_items, &division,
               &e->always_copy, &name) != 6 ||
        !name || j->kind > KERNEL_KINDS)
        return false;
    snprintf(j->name, sizeof j->name, "%s", text + name);
    snprintf(j->device, sizeof j->device, "%d:%d", platform, index);
    e->division = (tc_division)division;
    j->options.device = j->device;
    j->options.expert = e;
    return true;
}

static tc_status job_do(const job *j, tc_context *context) {
    if (strcmp(context->info.name, j->name))
        return (tc_status)fail(TC_ERROR_DEVICE, "device %s is %s in the process of the trial, not %s", j->device,
                               context->info.name, j->name);
    return j->kind == KERNEL_KINDS ? TC_OK : trial_of_kind(context, kind_of_number(j->kind));
}

/* Keeps programs that have not passed out of the cache; storing them would make PoCL compile kernels that have not run.
 */
static void programs_forget(tc_context *context) {
    for (program *p = context ? context->programs : NULL; p; p = p->next) p->cached = true;
}

tc_status tc_trial_run(const char *text, tc_progress progress, void *progress_user) {
    FLOAT_ENVIRONMENT_DEFAULT;
    job j;
    tc_context *context = NULL;
    if (!job_read(text, &j)) return (tc_status)fail(TC_ERROR_ARGUMENT, "no job of a trial: %s", text ? text : "NULL");
    j.options.progress = progress;
    j.options.progress_user = progress_user;
    tc_status status = context_create_for_trial(&j.options, &context);
    if (!status) status = job_do(&j, context);
    if (status) programs_forget(context);
    tc_context_destroy(context);
    return status;
}
