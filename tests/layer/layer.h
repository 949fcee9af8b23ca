/*
 * layer.h - an OpenCL layer that makes a working device fail: what tests set and read, and what its modes are made of
 *
 * The loader puts the layer, named in OPENCL_LAYERS, between a program and its drivers. A mode is a file that replaces
 * entries of the table of entry points and hands calls on to the table that it found; modes lie on top of each other,
 * in the order of `modes` in layer.c. Each is off until it is switched on: by a command in the environment's
 * TETRACUBES_LAYER when the layer is loaded, or at any time through the command function, which a test in the same
 * process gets by dlsym:
 *
 *     fail ENTRY N [ERROR [COUNT [later]]]
 *                                    call N (from 1, counted from here on) of the entry point returns ERROR, a number;
 *                                    so do the COUNT - 1 calls behind it (0: all of them). ENTRY as in clFinish; "off"
 *                                    switches it off. later: the next call that waits returns it, see fail.c
 *     corrupt drop KERNEL [FIRST]    launches of the kernel, from number FIRST on, are left out
 *     corrupt flip KERNEL ARGUMENT BYTE BIT    that bit of what the argument points to is wrong after each launch
 *     corrupt read BYTE BIT          that bit is wrong in whatever is read from a buffer
 *     corrupt build MISTAKE          programs are built wrongly: the table of corrupt.c; "corrupt off" ends either
 *     crash WHERE HOW [OPTION]       the process ends or hangs in a call: crash.c
 *     late hold | SLEEP | off        commands start as late as they may, or are put into queues slowly: late.c
 *     lacks fp64 | off               devices say that they have no double precision
 *     lacks fame                     devices say another version of their driver, one that nobody knows
 *     lacks name MOST                platforms have a name that nobody knows, and devices groups of at most so many
 *                                    work-items (0: as they are)
 *     lacks items KERNEL MOST MULTIPLE    the kernel (*: all) runs with at most so many work-items per group, and
 *                                    would like to have multiples of the other number
 *     memory PATTERN | off           new buffers are full of a byte, and have guards around them: memory.c
 *     count                          at the end of the process the calls of each entry point go to standard error
 *
 * Commands are separated by ';'.
 */
#ifndef LAYER_H
#define LAYER_H

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl_layer.h>

#include "entries.h"

#include <stdbool.h>

typedef enum layer_entry {
#define S(name, parameters, arguments)         ENTRY_##name,
#define O(type, name, parameters, arguments)   ENTRY_##name,
#define E(name, blocks, parameters, arguments) S(name, parameters, arguments)
    OPENCL_ENTRIES(S, O, E, O)
#undef S
#undef O
#undef E
        ENTRY_COUNT
} layer_entry;

extern const char *const entry_names[ENTRY_COUNT]; /* "clGetPlatformIDs", ... */

/* ----------------------------------------------------------------------------- what a test finds as `layer_control` */

typedef struct layer_functions {
    /* Carries commands out. False where one is not understood. */
    bool (*command)(const char *commands);
    /* Calls of an entry point, such as "clFinish", since the last `fail` command; NULL: of all. */
    unsigned long (*calls)(const char *entry_name);
    /* How many of them have been failed. */
    unsigned long (*failed)(void);
    /* References to objects that the program holds now: made and retained, not released. */
    long (*references)(void);
    /* Commands in queues that have not ended. */
    int (*pending)(void);
    /* What the program did that no driver has to bear, each told on standard error when it happened. */
    unsigned long (*faults)(void);
} layer_functions;

extern const layer_functions layer_control;

/* ------------------------------------------------------------------------------------------- what a mode is */

typedef struct layer_mode {
    const char *name; /* of its command */
    /* Replaces entries of the table; what they call is what was there before. */
    void (*install)(cl_icd_dispatch *table);
    /* words[0] is the name. False where the rest is not understood. */
    bool (*command)(char *const *words, int count);
} layer_mode;

extern const layer_mode corrupt_mode, crash_mode, fail_mode, count_mode, lacks_mode, ledger_mode, late_mode,
    memory_mode;

unsigned long fail_calls(const char *entry_name);
unsigned long fail_count(void);
long ledger_references(void);
int ledger_pending(void);

/* Counts a fault of the program's and tells it. */
void fault(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
