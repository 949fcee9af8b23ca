/*
 * test_host_memory.c - every request of the library for memory fails once: the first, the second, and so on until a
 * scenario has no more
 *
 * Each time: the call that was under way returns TC_ERROR_MEMORY, or does without and makes the right bytes; the same
 * call, made again with the same context and grid, succeeds; and at the end no memory and no OpenCL object is left.
 *
 *     test_host_memory [some | all]
 */
#include "engines.h"
#include "layer_find.h"
#include "memory_fault.h"
#include "results.h"
#include "scenarios.h"

#include <stdbool.h>
#include <string.h>

enum { SOME = 12, SOME_QUICK = 4 }; /* requests of a scenario */

static const memory_fault_functions *memory;
static const layer_functions *layer; /* NULL where there is none */
static char label[256];
static long trials, tolerated;

typedef struct watch {
    int failures;
    unsigned long failed, requests;
} watch;

static void trial_over(trial *t) {
    watch *w = t->user;
    w->failed = memory->failed();
    w->requests = memory->requests();
    memory->fail(0);
}

static bool call_failed(trial *t, const char *call, tc_status status) {
    watch *w = t->user;
    EXPECT(w->failures++ == 0 && memory->failed(), "%s: %s fails by itself: %s", label, call, tc_message());
    EXPECT(status == TC_ERROR_MEMORY && strstr(tc_message(), "memory"), "%s: %s returns %d: %s", label, call,
           (int)status, tc_message());
    return true;
}

/* Runs a scenario with request n failing; the number of requests. */
static unsigned long trial_run(int index, unsigned long n) {
    watch w = {0};
    trial t = {.failed = call_failed, .over = trial_over, .user = &w};
    const long references = layer ? layer->references() : 0;
    const long pieces = memory->pieces(), mapped = memory->mapped_bytes();
    snprintf(label, sizeof label, "%s: request %lu", scenario_name(index), n);
    memory->fail(n);
    const char *problem = scenario_run(index, &t);
    EXPECT(!problem, "%s: %s", label, problem);
    EXPECT(memory->pieces() == pieces, "%s: %ld pieces of memory are left", label, memory->pieces() - pieces);
    EXPECT(memory->mapped_bytes() == mapped, "%s: %ld bytes are left mapped", label, memory->mapped_bytes() - mapped);
    EXPECT(!layer || layer->references() == references, "%s: OpenCL objects are left", label);
    EXPECT((n != 0) == (w.failed != 0) && (!w.failures || w.failed), "%s: failed %lu times", label, w.failed);
    trials += n != 0;
    tolerated += n != 0 && w.failures == 0;
    return w.requests;
}

static void scenario_sweep(int index, bool all) {
    const long before = trials;
    trial_run(index, 0); /* puts programs into their cache */
    const unsigned long some = tier_is_quick() ? SOME_QUICK : SOME;
    const unsigned long requests = trial_run(index, 0), step = all || requests < some ? 1 : requests / some;
    for (unsigned long n = 1 + (unsigned long)index % step; n <= requests; n += step) trial_run(index, n);
    printf("%-36s %5ld of %lu requests failed\n", scenario_name(index), trials - before, requests);
    fflush(stdout);
}

int main(int argc, char **argv) {
    int devices;
    const double start = results_seconds();
    const bool all = argc > 1 && !strcmp(argv[1], "all"), has_device = tc_device_count(&devices) == TC_OK;
    memory = dlsym(RTLD_DEFAULT, "memory_fault_control");
    layer = layer_find();
    if (!memory) {
        printf("memory_fault is not preloaded\n");
        return EXIT_FAILURE;
    }
    if (!has_device || !scenarios_prepare()) {
        printf("skipped: no device\n");
        return SKIPPED;
    }
    for (int index = 0; index < scenario_count(); index++) scenario_sweep(index, all);
    scenarios_release();
    EXPECT(memory->pieces() == 0, "%ld pieces of memory are left at the end", memory->pieces());
    printf("%ld failures, %ld of them done without\n", trials, tolerated);
    if (all)
        results_write("host_memory", start,
                      (result[]){{"requests of the library for memory failed", trials},
                                 {"of them done without", tolerated},
                                 {"of them not survived, or leaking", expect_failures}},
                      3);
    return EXPECT_DONE();
}
