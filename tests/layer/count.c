/*
 * The mode that counts: at the end of the process, a line per entry point that was called, to standard error.
 */
#include "layer.h"

#include <stdio.h>
#include <stdlib.h>

static void install(cl_icd_dispatch *table) { (void)table; }

static void print(void) {
    for (int e = 0; e < ENTRY_COUNT; e++)
        if (fail_calls(entry_names[e])) fprintf(stderr, "layer: %s %lu\n", entry_names[e], fail_calls(entry_names[e]));
}

static bool command(char *const *words, int count) {
    (void)words;
    return count == 1 && !atexit(print);
}

const layer_mode count_mode = {"count", install, command};
