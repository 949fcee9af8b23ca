/*
 * The mode that is late: what a driver may put off is put off as long as it may.
 *
 *     late hold      commands do not start before their queue is flushed or waited for
 *     late SLEEP     every command, before it is put into its queue, costs up to SLEEP microseconds, at random
 *     late off
 *
 * Holding makes each command wait for a user event, the gate of its queue, which opens with clFlush, clFinish and every
 * call that blocks, as OpenCL says of an implicit flush. Queues in order stay in order.
 */
#include "layer.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { QUEUES_MOST = 64, WAITS_MOST = 16 };

static cl_icd_dispatch below;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static bool holds;
static unsigned long sleep_most;
static struct {
    cl_command_queue queue;
    cl_event gate;
} gates[QUEUES_MOST]; /* gate NULL: the place is free */

static void sleep_at_random(void) {
    static unsigned long state = 1;
    if (!sleep_most) return;
    state = state * 6364136223846793005u + 1442695040888963407u;
    nanosleep(&(struct timespec){.tv_nsec = (long)(1000 * (state >> 33) % (1000 * sleep_most))}, NULL);
}

static cl_event gate_make(cl_command_queue queue) {
    cl_context context = NULL;
    cl_int error = below.clGetCommandQueueInfo(queue, CL_QUEUE_CONTEXT, sizeof context, &context, NULL);
    cl_event gate = error ? NULL : below.clCreateUserEvent(context, &error);
    if (error) abort();
    return gate;
}

/* The closed gate of a queue. */
static cl_event gate_of(cl_command_queue queue) {
    int place = -1;
    pthread_mutex_lock(&lock);
    for (int n = 0; n < QUEUES_MOST; n++) {
        if (gates[n].gate && gates[n].queue == queue) place = n;
        if (place < 0 && !gates[n].gate) place = n;
    }
    if (place < 0) abort();
    if (!gates[place].gate) gates[place].gate = gate_make(queue);
    gates[place].queue = queue;
    pthread_mutex_unlock(&lock);
    return gates[place].gate;
}

static void gate_open(cl_command_queue queue) {
    cl_event gate = NULL;
    pthread_mutex_lock(&lock);
    for (int n = 0; n < QUEUES_MOST; n++)
        if (gates[n].gate && gates[n].queue == queue) {
            gate = gates[n].gate;
            gates[n].gate = NULL;
        }
    pthread_mutex_unlock(&lock);
    if (!gate) return;
    below.clSetUserEventStatus(gate, CL_COMPLETE);
    below.clReleaseEvent(gate);
}

/* Puts the gate into the list of events that a command waits for; opens it where the call blocks. */
static const cl_event *waits_extend(cl_command_queue queue, bool blocks, cl_uint *count, const cl_event *waits,
                                    cl_event extended[WAITS_MOST]) {
    sleep_at_random();
    if (blocks) gate_open(queue);
    if (blocks || !holds || *count + 1 > WAITS_MOST) return waits;
    if (*count) memcpy(extended, waits, *count * sizeof *extended);
    extended[(*count)++] = gate_of(queue);
    return extended;
}

#define S(name, parameters, arguments)
#define O(type, name, parameters, arguments)
#define E(name, blocks, parameters, arguments)                                                                         \
    static cl_int CL_API_CALL name parameters {                                                                        \
        cl_event extended[WAITS_MOST];                                                                                 \
        waits = waits_extend(queue, blocks, &wait_count, waits, extended);                                             \
        return below.cl##name arguments;                                                                               \
    }
#define M(type, name, parameters, arguments)                                                                           \
    static type CL_API_CALL name parameters {                                                                          \
        cl_event extended[WAITS_MOST];                                                                                 \
        waits = waits_extend(queue, blocking, &wait_count, waits, extended);                                           \
        return below.cl##name arguments;                                                                               \
    }
OPENCL_ENTRIES(S, O, E, M)

#define OPENING(X) X(Flush) X(Finish) X(ReleaseCommandQueue)
#define Q(name)                                                                                                        \
    static cl_int CL_API_CALL name(cl_command_queue queue) {                                                           \
        gate_open(queue);                                                                                              \
        return below.cl##name(queue);                                                                                  \
    }
OPENING(Q)
#undef Q
#undef E
#undef M

static void install(cl_icd_dispatch *table) {
    below = *table;
#define E(name, blocks, parameters, arguments) table->cl##name = name;
#define M(type, name, parameters, arguments)   table->cl##name = name;
#define Q(name)                                table->cl##name = name;
    OPENCL_ENTRIES(S, O, E, M)
    OPENING(Q)
}

static bool command(char *const *words, int count) {
    holds = false;
    sleep_most = 0;
    if (count != 2) return false;
    if (!strcmp(words[1], "off")) return true;
    holds = !strcmp(words[1], "hold");
    if (!holds) sleep_most = strtoul(words[1], NULL, 10);
    return holds || sleep_most;
}

const layer_mode late_mode = {"late", install, command};
