/*
 * test_failures.c - every call of OpenCL that the library makes fails once: the first of an entry point, the second,
 * and so on until the scenario has no more
 *
 * Each time: the call of the library that was under way fails, with the status of the failure and a text that names it,
 * or does without and makes the right bytes; nothing is under way when it returns, on a device that starts commands as
 * late as it may; the same call, made again with the same context and grid, succeeds; the surfaces are those of the
 * reference, byte for byte; and at the end nothing is left of what was made.
 *
 *     test_failures [some | all [SCENARIO]]      SCENARIO: part of the name of those wanted
 */
#include "engines.h"
#include "layer_find.h"
#include "results.h"
#include "scenarios.h"

#include <signal.h>
#include <string.h>
#include <unistd.h>

static const layer_functions *layer;
static char label[256]; /* of the trial under way */
static long trials, tolerated, scenarios_run, entries_failed[ENTRY_COUNT];

/* What an injected error is to be reported as. */
typedef struct failure_kind {
    cl_int error;
    const char *name;
    tc_status status;
} failure_kind;

static const failure_kind kinds[] = {{CL_OUT_OF_RESOURCES, "CL_OUT_OF_RESOURCES", TC_ERROR_MEMORY},
                                     {CL_INVALID_OPERATION, "CL_INVALID_OPERATION", TC_ERROR_DEVICE}};

typedef struct watch {
    const failure_kind *kind;
    const char *entry;
    int failures;
    unsigned long failed; /* calls of OpenCL, by the layer */
} watch;

static void trial_over(trial *t) {
    watch *w = t->user;
    w->failed = layer->failed();
    layer->command("fail off");
}

/* What a device cannot even say, or build, is its failure whatever error it gives. */
static bool status_is_right(const watch *w, tc_status status) {
    const bool of_device = !strncmp(w->entry, "clGet", 5) || !strcmp(w->entry, "clBuildProgram");
    return status == w->kind->status || (status == TC_ERROR_DEVICE && of_device);
}

static bool call_failed(trial *t, const char *call, tc_status status) {
    watch *w = t->user;
    char number[16];
    snprintf(number, sizeof number, "%d", (int)w->kind->error);
    EXPECT(w->failures++ == 0 && layer->failed(), "%s: %s fails by itself: %s", label, call, tc_message());
    EXPECT(status_is_right(w, status), "%s: %s returns %d: %s", label, call, (int)status, tc_message());
    EXPECT(strstr(tc_message(), w->kind->name) || strstr(tc_message(), number), "%s: %s says: %s", label, call,
           tc_message());
    EXPECT(layer->pending() == 0, "%s: %s leaves commands under way", label, call);
    return true;
}

/* False where the entry point was not called so often. later: the error is that of a call behind it, which waits. */
static bool trial_run(int index, const char *entry, unsigned long call, const failure_kind *kind, bool later) {
    char command[128];
    watch w = {.kind = kind, .entry = entry};
    trial t = {.failed = call_failed, .over = trial_over, .user = &w};
    const long references = layer->references();
    const unsigned long faults = layer->faults();
    snprintf(label, sizeof label, "%s: %s %lu gives %s%s", scenario_name(index), entry, call, kind->name,
             later ? " later" : "");
    snprintf(command, sizeof command, "fail %s %lu %d 1%s", entry, call, (int)kind->error, later ? " later" : "");
    EXPECT(layer->command(command), "the layer does not take: %s", command);
    const char *problem = scenario_run(index, &t);
    EXPECT(!problem, "%s: %s", label, problem);
    EXPECT(layer->references() == references, "%s: %ld references are left", label, layer->references() - references);
    EXPECT(layer->faults() == faults, "%s: faults", label);
    if (!w.failed) return false;
    trials++;
    EXPECT(!later || w.failures, "%s: no call tells of it", label);
    for (int e = 0; e < ENTRY_COUNT; e++) entries_failed[e] += !strcmp(entry, entry_names[e]);
    tolerated += w.failures == 0;
    return true;
}

/* Commands that the library only enqueues. What tc_emit has enqueued fails behind its back. */
static bool may_fail_later(int index, const char *entry) {
    return (!strcmp(entry, "clEnqueueNDRangeKernel") || !strcmp(entry, "clEnqueueFillBuffer")) &&
           !strstr(scenario_name(index), "emit");
}

/* All calls of an entry point, or one of them, which differs with scenarios. Either error in turn. */
static void entry_sweep(int index, int entry, unsigned long calls, bool all) {
    const char *name = entry_names[entry];
    const unsigned long first = all || !calls ? 1 : 1 + (unsigned long)(7 * index + entry) % calls;
    for (unsigned long n = first; n <= (all ? calls : calls ? first : 0); n++) {
        const failure_kind *kind = &kinds[(n + (unsigned long)index) % 2];
        EXPECT(trial_run(index, name, n, kind, false), "%s: not called so often as before", label);
        if (may_fail_later(index, name)) trial_run(index, name, n, kind, true);
    }
    if (all) EXPECT(!trial_run(index, name, calls + 1, &kinds[0], false), "%s: called more often than before", label);
}

static bool no_failure(trial *t, const char *call, tc_status status) {
    (void)t;
    EXPECT(false, "%s: %s fails with nothing injected, status %d: %s", label, call, (int)status, tc_message());
    return false;
}

static void calls_note(trial *t) {
    unsigned long *calls = t->user;
    for (int e = 0; e < ENTRY_COUNT; e++) calls[e] = layer->calls(entry_names[e]);
}

/* How often each entry point is called, with the programs in their cache. */
static void calls_count(int index, unsigned long calls[ENTRY_COUNT]) {
    trial plain = {.failed = no_failure, .over = calls_note, .user = calls};
    snprintf(label, sizeof label, "%s", scenario_name(index));
    for (int n = 0; n < 2; n++) {
        layer->command("fail off");
        const char *problem = scenario_run(index, &plain);
        EXPECT(!problem, "%s: %s", label, problem);
    }
}

/* The quick tier: of a scenario every third entry point, of the next ones the others; and those that have not failed
 * before. */
static bool entry_wanted(int index, int entry) {
    return !tier_is_quick() || (index + entry) % 3 == 0 || !entries_failed[entry];
}

static void scenario_sweep(int index, bool all) {
    unsigned long calls[ENTRY_COUNT];
    const double start = results_seconds();
    const long before = trials;
    calls_count(index, calls);
    scenarios_run++;
    for (int e = 0; e < ENTRY_COUNT; e++)
        if (all || entry_wanted(index, e)) entry_sweep(index, e, calls[e], all);
    printf("%-36s %5ld failures, %.1f s\n", scenario_name(index), trials - before, results_seconds() - start);
    fflush(stdout);
}

static void crash_report(int signal_number) {
    static const char words[] = "crashed: ";
    ssize_t ignored = write(2, words, sizeof words - 1);
    ignored += write(2, label, strlen(label));
    ignored += write(2, "\n", 1);
    (void)ignored;
    signal(signal_number, SIG_DFL);
    raise(signal_number);
}

int main(int argc, char **argv) {
    int devices;
    const double start = results_seconds();
    const bool all = argc > 1 && !strcmp(argv[1], "all");
    if (tc_device_count(&devices) != TC_OK || !(layer = layer_find())) {
        printf("skipped: no device, or a loader without layers\n");
        return SKIPPED;
    }
    signal(SIGSEGV, crash_report);
    signal(SIGABRT, crash_report);
    if (!scenarios_prepare()) {
        printf("nothing to fail: %s\n", tc_message());
        return EXIT_FAILURE;
    }
    layer->command("late hold");
    for (int index = 0; index < scenario_count(); index++)
        if (scenario_uses_device(index) && (all || !scenario_is_rare(index)) &&
            (argc < 3 || strstr(scenario_name(index), argv[2])))
            scenario_sweep(index, all);
    scenarios_release();
    EXPECT(layer->references() == 0, "%ld references are left at the end", layer->references());
    long entries = 0;
    for (int e = 0; e < ENTRY_COUNT; e++) {
        entries += entries_failed[e] > 0;
        if (!entries_failed[e]) printf("%s was not called\n", entry_names[e]);
    }
    printf("%ld failures of %ld entry points, %ld of them done without\n", trials, entries, tolerated);
    if (all)
        results_write("failures", start,
                      (result[]){{"calls of OpenCL failed", trials},
                                 {"entry points", entries},
                                 {"scenarios", scenarios_run},
                                 {"failures done without, with the same bytes", tolerated},
                                 {"wrong statuses or bytes, leaks, crashes", expect_failures}},
                      5);
    return EXPECT_DONE();
}
