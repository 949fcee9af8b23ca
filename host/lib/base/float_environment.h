/*
 * float_environment.h - the floating-point environment of public calls: the default one, whatever the caller's is
 *
 * A caller may round upwards, trap exceptions, or flush subnormal numbers to zero (programs linked with -ffast-math or
 * -Ofast do so from their start). That would change results, also those of threads started meanwhile, among them
 * threads of OpenCL drivers, as threads inherit the environment. So every public call that computes, or that reaches a
 * driver, begins with FLOAT_ENVIRONMENT_DEFAULT: from there to its end, wherever that is, rounding is to nearest,
 * subnormal numbers are kept and nothing traps; then the caller has its environment back, flags included. Such calls
 * nest. Both switches together take some 10 ns, or half a microsecond where the caller's environment is another.
 */
#ifndef FLOAT_ENVIRONMENT_H
#define FLOAT_ENVIRONMENT_H

#include <fenv.h>
#include <stdbool.h>

typedef struct float_environment {
    bool is_default; /* the caller has the default environment except for flags, which are in sse */
    unsigned sse;
    fenv_t callers;
    struct float_environment *outer; /* of the enclosing call */
} float_environment;

void float_environment_enter(float_environment *e);
void float_environment_leave(float_environment *e);

/* Around a callback, the thread gets the environment of the outermost call's caller. Resume takes what lend has
 * returned, and keeps what the callback has changed for the caller. */
float_environment *float_environment_lend(void);
void float_environment_resume(float_environment *lent);

#define FLOAT_ENVIRONMENT_DEFAULT                                                                                      \
    float_environment environment __attribute__((cleanup(float_environment_leave)));                                   \
    float_environment_enter(&environment)

#endif
