/*
 * results.h - what a long test has found, as figures in a file PART.json of the folder TETRACUBES_RESULTS
 */
#ifndef RESULTS_H
#define RESULTS_H

#include "tetracubes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct result {
    const char *what;
    long value;
} result;

static inline double results_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Nothing where the environment names no folder. start: of results_seconds, when the test began. */
static inline void results_write(const char *part, double start, const result *figures, int count) {
    const char *folder = getenv("TETRACUBES_RESULTS");
    char path[4096], date[16];
    const time_t now = time(NULL);
    tc_device_info info = {.struct_size = sizeof info};
    if (!folder) return;
    snprintf(path, sizeof path, "%s/%s.json", folder, part);
    FILE *out = fopen(path, "w");
    if (!out) return;
    strftime(date, sizeof date, "%Y-%m-%d", gmtime(&now));
    if (tc_device_get(0, &info)) strcpy(info.version, "none");
    fprintf(out, "{\"part\": \"%s\", \"date\": \"%s\", \"versions\": {\"tetracubes\": \"%s\", \"OpenCL\": \"%s\"},\n",
            part, date, tc_version(), info.version);
    fprintf(out, " \"seconds\": %.0f, \"figures\": [", results_seconds() - start);
    for (int n = 0; n < count; n++)
        fprintf(out, "%s\n  {\"what\": \"%s\", \"value\": %ld}", n ? "," : "", figures[n].what, figures[n].value);
    fprintf(out, "]}\n");
    fclose(out);
}

#endif
