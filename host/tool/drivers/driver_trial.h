/*
 * driver_trial.h - trials of kernels for the library (tc_child_trial of tetracubes.h), each in a child of this process
 */
#ifndef DRIVER_TRIAL_H
#define DRIVER_TRIAL_H

#include "tetracubes.h"

/* The command by which a child is started: not one that --help shows. */
#define TRIAL_COMMAND "--trial-of-a-driver"

/* The callback; user: not used. */
tc_verdict trial_in_child(void *user, const char *job, char *reason, size_t bytes);

/* For how long a driver is waited for: TETRACUBES_TRIAL_SECONDS of the environment, else three minutes. */
double trial_limit_ms(void);

/* The child's own part; returns the process's exit status. */
int trial_child(const char *job);

#endif
