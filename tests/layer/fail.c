/*
 * The mode that fails calls: call N of one entry point, and as many behind it as are wanted, return an error.
 *
 * A call that fails is not made, but for two kinds. What releases an object does release it and then reports the error,
 * so that what is left at the end is the program's own doing; and clFinish waits before it reports, as it does where a
 * device is lost: then no command is under way any more.
 *
 * Commands can also fail after they have been accepted: the call succeeds, nothing is done, and the error comes from
 * the next call that waits, clFinish or one that blocks, of whatever queue.
 */
#include "layer.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

static cl_icd_dispatch below;

static atomic_ulong calls[ENTRY_COUNT], failed;
static atomic_int failing = -1; /* the entry; -1: none */
static atomic_int owed;         /* the error of a command that was accepted */
static unsigned long first_call, end_call;
static cl_int failure;
static bool later;

/* The error that a call returns. waits: it returns when commands have ended, and tells of one that has failed. */
static cl_int failure_of(layer_entry e, bool waits) {
    const unsigned long call = atomic_fetch_add(&calls[e], 1) + 1;
    if (waits && atomic_load(&owed)) return atomic_exchange(&owed, 0);
    if (atomic_load(&failing) != (int)e || call < first_call || call >= end_call) return CL_SUCCESS;
    atomic_fetch_add(&failed, 1);
    return failure;
}

static bool is_made_first(layer_entry e) { return e == ENTRY_Finish || !strncmp(entry_names[e], "clRelease", 9); }

#define S(name, parameters, arguments)                                                                                 \
    static cl_int CL_API_CALL name parameters {                                                                        \
        const cl_int injected = failure_of(ENTRY_##name, ENTRY_##name == ENTRY_Finish);                                \
        if (injected && is_made_first(ENTRY_##name)) below.cl##name arguments;                                         \
        return injected ? injected : below.cl##name arguments;                                                         \
    }
#define O(type, name, parameters, arguments)                                                                           \
    static type CL_API_CALL name parameters {                                                                          \
        const cl_int injected = failure_of(ENTRY_##name, ENTRY_##name == ENTRY_EnqueueMapBuffer);                      \
        if (!injected) return below.cl##name arguments;                                                                \
        if (error) *error = injected;                                                                                  \
        return NULL;                                                                                                   \
    }
#define E(name, blocks, parameters, arguments)                                                                         \
    static cl_int CL_API_CALL name parameters {                                                                        \
        const cl_int injected = failure_of(ENTRY_##name, blocks);                                                      \
        const bool accepted = !blocks && !event;                                                                       \
        if (injected && !(later && accepted)) return injected;                                                         \
        if (injected) atomic_store(&owed, injected);                                                                   \
        return accepted && atomic_load(&owed) ? CL_SUCCESS : below.cl##name arguments;                                 \
    }
OPENCL_ENTRIES(S, O, E, O)
#undef S
#undef O
#undef E

static void install(cl_icd_dispatch *table) {
    below = *table;
#define S(name, parameters, arguments)         table->cl##name = name;
#define O(type, name, parameters, arguments)   table->cl##name = name;
#define E(name, blocks, parameters, arguments) table->cl##name = name;
    OPENCL_ENTRIES(S, O, E, O)
#undef S
#undef O
#undef E
}

static int entry_find(const char *name) {
    for (int e = 0; e < ENTRY_COUNT; e++)
        if (!strcmp(entry_names[e], name)) return e;
    return -1;
}

static bool command(char *const *words, int count) {
    atomic_store(&failing, -1);
    atomic_store(&owed, 0);
    for (int e = 0; e < ENTRY_COUNT; e++) atomic_store(&calls[e], 0);
    atomic_store(&failed, 0);
    if (count == 2 && !strcmp(words[1], "off")) return true;
    const int e = count >= 3 ? entry_find(words[1]) : -1;
    if (e < 0) return false;
    first_call = strtoul(words[2], NULL, 10);
    failure = count >= 4 ? (cl_int)strtol(words[3], NULL, 10) : CL_OUT_OF_RESOURCES;
    later = count >= 6 && !strcmp(words[5], "later");
    const unsigned long many = count >= 5 ? strtoul(words[4], NULL, 10) : 1;
    end_call = many ? first_call + many : (unsigned long)-1;
    atomic_store(&failing, e);
    return first_call > 0 && failure < 0;
}

unsigned long fail_calls(const char *entry_name) {
    unsigned long sum = 0;
    for (int e = 0; e < ENTRY_COUNT; e++)
        if (!entry_name || !strcmp(entry_names[e], entry_name)) sum += atomic_load(&calls[e]);
    return sum;
}

unsigned long fail_count(void) { return atomic_load(&failed); }

const layer_mode fail_mode = {"fail", install, command};
