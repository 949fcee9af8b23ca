/* results.h - what the trials of the self-test came to, and a file of it for continuous integration */
#ifndef RESULTS_H
#define RESULTS_H

#include "tetracubes.h"

/* TRIAL_LATE: not finished, or not begun, when the time of --timeout was over. */
typedef enum trial_end { TRIAL_OK, TRIAL_FAILED, TRIAL_CRASHED, TRIAL_HUNG, TRIAL_LATE, TRIAL_SKIPPED } trial_end;

typedef struct trial_result {
    int group; /* index in trial_groups, or VECTORS */
    char *name, *text;
    trial_end end;
    double ms;
} trial_result;

/* What all groups came to. */
typedef struct selftest_results {
    trial_result *results;
    size_t count, capacity;
    int out_of_memory;
} selftest_results;

/* text: why it did not end well. */
void results_add(selftest_results *all, int group, const char *name, trial_end end, const char *text, double ms);
void results_release(selftest_results *all);

/* Writes a JUnit file: a suite per group, a case per trial. Returns 0 or a status with its text. */
int junit_write(const char *path, const selftest_results *all, const tc_device_info *device);

#endif
