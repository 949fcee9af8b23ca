/*
 * scenarios.h - what programs do with the library, from the first call to the last, and a question to the test where a
 * call fails
 *
 * A scenario makes a context, a grid and surfaces or interval volumes of two isovalues, gives everything back, and
 * compares all that it got with what the reference engine made beforehand, byte for byte. A call that fails is told to
 * the trial, which decides whether it is made once more: it then has to succeed, with the same context and grid.
 */
#ifndef SCENARIOS_H
#define SCENARIOS_H

#include "tetracubes.h"

#include <stdbool.h>

typedef struct trial {
    /* True: the call is to be made again. */
    bool (*failed)(struct trial *trial, const char *call, tc_status status);
    /* The library has been given all back; what follows is the scenario's own business. May be NULL. */
    void (*over)(struct trial *trial);
    void *user;
} trial;

typedef struct scenario scenario;

/* Makes what scenarios work on and compare with; false, with tc_message, where that fails. The cache of programs is a
 * folder made for it, gone after scenarios_release. */
bool scenarios_prepare(void);
void scenarios_release(void);

int scenario_count(void);
const char *scenario_name(int index);
bool scenario_is_rare(int index);
bool scenario_uses_device(int index);

/* NULL, or what went wrong: valid until the next call. */
const char *scenario_run(int index, trial *t);

#endif
