#include "run_times.h"

#include "json_report.h"
#include "progress.h"

#include <stdio.h>

void run_times_end(run_times *t, double begin_ms, const tc_context *context) {
    t->total_ms = now_ms() - begin_ms;
    t->build_ms = tc_context_build_ms(context);
    t->device_start_ms += t->build_ms;
}

json_t *run_times_json(const run_times *t) {
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o}", "read", ms_json(t->read_ms), "device_start",
                     ms_json(t->device_start_ms), "build", ms_json(t->build_ms), "upload", ms_json(t->upload_ms),
                     "write", ms_json(t->write_ms), "total", ms_json(t->total_ms));
}

void run_times_text(const run_times *t) {
    printf("read %.2f ms, device start %.2f ms", t->read_ms, t->device_start_ms);
    if (t->build_ms > 0) printf(" (kernels %.2f ms)", t->build_ms);
    printf(", upload %.2f ms, write %.2f ms, total %.2f ms\n", t->upload_ms, t->write_ms, t->total_ms);
}
