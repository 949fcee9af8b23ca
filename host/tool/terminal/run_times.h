/* run_times.h - how long the stages of a run took that makes something of a grid: the last line of its report */
#ifndef RUN_TIMES_H
#define RUN_TIMES_H

#include "tetracubes.h"

#include <jansson.h>

/* Milliseconds. build: until kernels were ready, a part of device_start, which is partly while the input is read. */
typedef struct run_times {
    double read_ms, device_start_ms, build_ms, upload_ms, write_ms, total_ms;
} run_times;

/* To be called once, where the report is printed; context: NULL where there is none. */
void run_times_end(run_times *t, double begin_ms, const tc_context *context);

json_t *run_times_json(const run_times *t);
void run_times_text(const run_times *t);

#endif
