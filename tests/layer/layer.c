/*
 * The layer's two entry points for the loader, its commands, and the order of its modes.
 */
#include "layer.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))

/* From the driver up: what a mode does to a call is seen by those above it. */
static const layer_mode *const modes[] = {&lacks_mode,  &corrupt_mode, &crash_mode, &late_mode,
                                          &memory_mode, &ledger_mode,  &fail_mode,  &count_mode};
enum { MODES = sizeof modes / sizeof *modes, COMMAND_BYTES = 1024, WORDS_MOST = 16 };

static bool one_command(char *text) {
    char *words[WORDS_MOST], *rest = NULL;
    int count = 0;
    for (char *word = strtok_r(text, " ", &rest); word && count < WORDS_MOST; word = strtok_r(NULL, " ", &rest))
        words[count++] = word;
    for (int n = 0; n < MODES && count; n++)
        if (!strcmp(modes[n]->name, words[0])) return modes[n]->command(words, count);
    return count == 0;
}

static bool commands_run(const char *commands) {
    char text[COMMAND_BYTES], *rest = NULL;
    if (snprintf(text, sizeof text, "%s", commands) >= (int)sizeof text) return false;
    for (char *one = strtok_r(text, ";", &rest); one; one = strtok_r(NULL, ";", &rest))
        if (!one_command(one)) return false;
    return true;
}

static atomic_ulong fault_count;

void fault(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    atomic_fetch_add(&fault_count, 1);
    fprintf(stderr, "layer: ");
    vfprintf(stderr, format, arguments);
    fprintf(stderr, "\n");
    va_end(arguments);
}

static unsigned long faults(void) { return atomic_load(&fault_count); }

EXPORT const layer_functions layer_control = {commands_run,      fail_calls,     fail_count,
                                              ledger_references, ledger_pending, faults};

EXPORT cl_int clGetLayerInfo(cl_layer_info what, size_t bytes, void *value, size_t *bytes_ret) {
    static const char name[] = "tetracubes test layer";
    const cl_layer_api_version version = CL_LAYER_API_VERSION_100;
    const void *from = what == CL_LAYER_NAME ? (const void *)name : &version;
    const size_t size = what == CL_LAYER_NAME ? sizeof name : sizeof version;
    if (what != CL_LAYER_NAME && what != CL_LAYER_API_VERSION) return CL_INVALID_VALUE;
    if (value && bytes < size) return CL_INVALID_VALUE;
    if (value) memcpy(value, from, size);
    if (bytes_ret) *bytes_ret = size;
    return CL_SUCCESS;
}

EXPORT cl_int clInitLayer(cl_uint entry_count, const cl_icd_dispatch *target, cl_uint *entry_count_ret,
                          const cl_icd_dispatch **layer) {
    static cl_icd_dispatch table;
    const size_t bytes = entry_count * sizeof(void *);
    if (!target || !entry_count_ret || !layer) return CL_INVALID_VALUE;
    memcpy(&table, target, bytes < sizeof table ? bytes : sizeof table);
    for (int n = 0; n < MODES; n++) modes[n]->install(&table);
    *entry_count_ret = sizeof table / sizeof(void *);
    *layer = &table;
    const char *command = getenv("TETRACUBES_LAYER");
    if (command && !commands_run(command)) {
        fprintf(stderr, "layer: TETRACUBES_LAYER is not understood: %s\n", command);
        abort();
    }
    return CL_SUCCESS;
}
