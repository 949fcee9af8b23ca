#include "opencl/vetting.h"

#include "opencl/device.h"
#include "failure.h"
#include "base/float_environment.h"
#include "opencl/program.h"
#include "opencl/variant.h"
#include "opencl/verdicts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { OPENING = KERNEL_KINDS }; /* the number of the device itself, beside those of kernels */

/* ----------------------------------------------------------------------------------------------------------- driver */

/* Whether the driver counts as tried, with the variant that the context builds, or for opening the device. */
static bool driver_is_known(const tc_context *context, unsigned kind) {
    const bool usual = variant_for(context->launch.work_items) == variant_rule_of(&context->info)->variant;
    return variant_tried(&context->info) && (usual || kind == OPENING);
}

/* PoCL's devices on the host's processor run ld: without it they are not what they are known for. */
static bool driver_finds_linker(const tc_device_info *info) {
    const char *at = getenv("PATH");
    if (strcmp(info->platform, "Portable Computing Language") || strcmp(info->type, "cpu")) return true;
    while (at && *at) {
        char file[4096];
        const int length = (int)strcspn(at, ":");
        if (snprintf(file, sizeof file, "%.*s/ld", length, at) < (int)sizeof file && !access(file, X_OK)) return true;
        at += length + (at[length] == ':');
    }
    return false;
}

/* ------------------------------------------------------------------------------------------------------------ trial */

/* What tc_trial_run reads; false where the device is none of tc_device_get's. */
static bool job_write(const tc_context *context, unsigned kind, char *job, size_t bytes) {
    const launch_parameters *p = &context->launch;
    int platform = context->info.platform_index, index = context->info.device_index;
    if (platform < 0 && !device_find(context->device, &platform, &index)) return false;
    const bool opens = kind == OPENING;
    snprintf(job, bytes, "tetracubes-trial-1 %d:%d %u %u %d %d %s", platform, index, kind, opens ? 0u : p->work_items,
             opens ? 0 : (int)p->division, !opens && !context->in_place, context->info.name);
    return true;
}

/* Asks for a trial. A verdict that the next run may not reproduce is not kept; nor is one without a linker, as a good
 * one then depends on what PoCL's cache holds. */
static void trial_ask(const tc_context *context, unsigned kind, kept_verdict *out) {
    char job[256];
    *out = (kept_verdict){TC_VERDICT_NONE, ""};
    if (!context->expert.child_trial || !job_write(context, kind, job, sizeof job)) return;
    float_environment *lent = float_environment_lend();
    out->verdict = context->expert.child_trial(context->expert.child_trial_user, job, out->reason, sizeof out->reason);
    float_environment_resume(lent);
    if (out->verdict < TC_VERDICT_NONE || out->verdict > TC_VERDICT_CANCELLED) out->verdict = TC_VERDICT_NONE;
    if (out->verdict == TC_VERDICT_NONE || out->verdict >= TC_VERDICT_STOPPED) return;
    if (driver_finds_linker(&context->info)) verdict_write(context, kind, out);
}

static void verdict_find(const tc_context *context, unsigned kind, kept_verdict *out) {
    *out = (kept_verdict){TC_VERDICT_GOOD, ""};
    if (driver_is_known(context, kind) && driver_finds_linker(&context->info)) return;
    verdict_read(context, kind, out);
    if (out->verdict == TC_VERDICT_NONE) trial_ask(context, kind, out);
}

static tc_status verdict_fail(const tc_context *context, unsigned kind, const kept_verdict *v) {
    const tc_device_info *d = &context->info;
    kept_verdict kept;
    char file[400] = "", kept_in[480] = "";
    verdict_read(context, kind, &kept);
    if (kept.verdict == v->verdict) verdict_path(context, kind, file, sizeof file);
    if (*file) snprintf(kept_in, sizeof kept_in, "; to have it tried again remove %s", file);
    if (v->verdict == TC_VERDICT_CANCELLED) return (tc_status)fail(TC_ERROR_CANCELLED, "cancelled");
    if (v->verdict == TC_VERDICT_STOPPED)
        return (tc_status)fail(TC_ERROR_DEVICE, "the trial of driver %s of %s was stopped, %s: try again", d->driver,
                               d->name, v->reason);
    if (v->verdict == TC_VERDICT_WRONG_RESULT || v->verdict == TC_VERDICT_REFUSED)
        return (tc_status)fail(v->verdict == TC_VERDICT_WRONG_RESULT ? TC_ERROR_WRONG_RESULT : TC_ERROR_DEVICE, "%s%s",
                               v->reason, kept_in);
    return (tc_status)fail(
        TC_ERROR_DEVICE,
        "driver %s of %s (%s) %s%s%s%s; update the driver, use another device or the reference engine%s", d->driver,
        d->name, d->platform, v->verdict == TC_VERDICT_HUNG ? "hangs" : "crashes", *v->reason ? ": " : "", v->reason,
        driver_finds_linker(d) ? "" : ". It links kernels with ld, which no folder of PATH has: set PATH", kept_in);
}

/* --------------------------------------------------------------------------------------------------------- variants */

/* Switches to the other variant and drops all that was built from the first. */
static void variant_exchange(tc_context *context) {
    cl->Finish(context->queue);
    workspace_release(context);
    programs_release(context);
    context->launch.work_items = context->launch.other_items;
    context->launch.other_items = 0;
    memset(context->vetted, 0, sizeof context->vetted);
    memset(context->trial_passed, 0, sizeof context->trial_passed);
}

static void vetted_note(tc_context *context, kernel_kind kind) {
    context->vetted[kind_number(kind)] = true;
    context->vetted[kind_number(kind_of_classify(kind))] = true; /* its trial has built kernel 1 too */
}

static tc_status kind_vet(tc_context *context, kernel_kind kind, bool *exchanged) {
    const unsigned number = kind_number(kind);
    *exchanged = false;
    while (!context->for_trial && !context->vetted[number]) {
        kept_verdict v;
        const double start = clock_ms();
        verdict_find(context, number, &v);
        context->build_ms += clock_ms() - start;
        if (v.verdict == TC_VERDICT_GOOD || v.verdict == TC_VERDICT_NONE) {
            vetted_note(context, kind);
        } else if (v.verdict != TC_VERDICT_CANCELLED && context->launch.other_items &&
                   driver_finds_linker(&context->info)) {
            variant_exchange(context);
            *exchanged = true;
        } else {
            return verdict_fail(context, number, &v);
        }
    }
    return TC_OK;
}

tc_status device_vet(tc_context *context) {
    const tc_device_info *d = &context->info;
    const char *fault = variant_fault(d);
    kept_verdict v;
    if (context->for_trial) return TC_OK;
    if (fault && (context->expert.child_trial || context->options.check_device))
        return (tc_status)fail(TC_ERROR_WRONG_RESULT,
                               "driver %s of %s (%s) %s, so that results are wrong: update the driver, use another "
                               "device or the reference engine",
                               d->driver, d->name, d->platform, fault);
    verdict_find(context, OPENING, &v);
    return v.verdict == TC_VERDICT_GOOD || v.verdict == TC_VERDICT_NONE ? TC_OK : verdict_fail(context, OPENING, &v);
}

tc_status call_vet(tc_context *context, kernel_kind kind) {
    bool exchanged;
    return kind_vet(context, kind, &exchanged);
}

tc_status kernels_vet(tc_context *context, kernel_kind kind) {
    tc_status status = kind_vet(context, kind, &context->variant_changed);
    if (status || !context->variant_changed) return status;
    return (tc_status)fail(TC_ERROR_DEVICE, "other kernels have been taken, as the driver fails with those before: "
                                            "count again");
}

bool vetting_restarts(tc_context *context) {
    const bool restarts = context->variant_changed;
    context->variant_changed = false;
    return restarts;
}
