/*
 * The mode that ends the process, or keeps it from going on: what a driver does that crashes or hangs.
 *
 *     crash WHERE HOW [OPTION]    WHERE: open (a context is made), build (of a program), launch (of a kernel), read
 * (back from a buffer), end (of the process); HOW: abort, segv, hang, exit, kill, refuse (an error, of open, build and
 * launch); OPTION: only with programs that are built with this option, such as -DWORK_ITEMS=1
 *
 * It chatters on standard output and error before that, as drivers do.
 */
#include "layer.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static cl_icd_dispatch below;
static char place[16], manner[16], option[64];
static bool is_met; /* a program with the option has been built */

/* True where the call is to return an error. */
static bool strike(const char *where) {
    if (strcmp(place, where) || (!is_met && *option)) return false;
    if (!strcmp(manner, "refuse")) return true;
    printf("driver: this line is chatter\n");
    fflush(stdout);
    fprintf(stderr, "driver: assertion failed in %s\n", where);
    if (!strcmp(manner, "abort")) abort();
    if (!strcmp(manner, "segv")) raise(SIGSEGV);
    if (!strcmp(manner, "kill")) raise(SIGKILL);
    if (!strcmp(manner, "exit")) _exit(0);
    for (;;) pause();
}

static cl_context CL_API_CALL CreateContext(const cl_context_properties *properties, cl_uint count,
                                            const cl_device_id *devices,
                                            void(CL_CALLBACK *notify)(const char *, const void *, size_t, void *),
                                            void *user, cl_int *error) {
    if (!strike("open")) return below.clCreateContext(properties, count, devices, notify, user, error);
    *error = CL_OUT_OF_RESOURCES;
    return NULL;
}

static cl_int CL_API_CALL BuildProgram(cl_program program, cl_uint count, const cl_device_id *devices,
                                       const char *options, void(CL_CALLBACK *notify)(cl_program, void *), void *user) {
    const char *found = *option && options ? strstr(options, option) : NULL;
    const char behind = found ? found[strlen(option)] : 'x';
    is_met = behind == 0 || behind == ' '; /* the whole option */
    if (strike("build")) return CL_BUILD_PROGRAM_FAILURE;
    return below.clBuildProgram(program, count, devices, options, notify, user);
}

static cl_int CL_API_CALL EnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                                               const size_t *first, const size_t *global, const size_t *local,
                                               ENTRY_WAITS) {
    if (strike("launch")) return CL_INVALID_PROGRAM_EXECUTABLE;
    return below.clEnqueueNDRangeKernel(queue, kernel, dimensions, first, global, local, wait_count, waits, event);
}

static cl_int CL_API_CALL EnqueueReadBuffer(cl_command_queue queue, cl_mem memory, cl_bool blocking, size_t offset,
                                            size_t bytes, void *to, ENTRY_WAITS) {
    strike("read");
    return below.clEnqueueReadBuffer(queue, memory, blocking, offset, bytes, to, wait_count, waits, event);
}

static void end(void) { strike("end"); }

static void install(cl_icd_dispatch *table) {
    below = *table;
    table->clCreateContext = CreateContext;
    table->clBuildProgram = BuildProgram;
    table->clEnqueueNDRangeKernel = EnqueueNDRangeKernel;
    table->clEnqueueReadBuffer = EnqueueReadBuffer;
}

static bool command(char *const *words, int count) {
    place[0] = option[0] = '\0';
    is_met = false;
    if (count == 2) return !strcmp(words[1], "off");
    if (count < 3 || count > 4) return false;
    snprintf(place, sizeof place, "%s", words[1]);
    snprintf(manner, sizeof manner, "%s", words[2]);
    snprintf(option, sizeof option, "%s", count == 4 ? words[3] : "");
    return strcmp(place, "end") || !atexit(end);
}

const layer_mode crash_mode = {"crash", install, command};
