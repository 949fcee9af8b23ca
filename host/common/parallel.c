/* parallel.c - one function on several POSIX threads; see parallel.h */
#include "parallel.h"

#include <fenv.h>
#include <pthread.h>
#include <sched.h>

enum { THREADS_MOST = 16 };

typedef struct task {
    void (*work)(void *shared);
    void *shared;
    fenv_t environment; /* floating-point: helpers compute as the calling thread does */
} task;

static void *task_run(void *argument) {
    const task *t = argument;
    fesetenv(&t->environment);
    t->work(t->shared);
    return NULL;
}

/* Processors that this process may use. */
static uint64_t processor_count(void) {
    cpu_set_t usable;
    return sched_getaffinity(0, sizeof usable, &usable) == 0 ? (uint64_t)CPU_COUNT(&usable) : 1;
}

void parallel_run(uint64_t share_count, void (*work)(void *shared), void *shared) {
    pthread_t helpers[THREADS_MOST - 1];
    task t = {.work = work, .shared = shared};
    uint64_t wanted = share_count > 1 ? processor_count() : 1, count = 0;
    if (wanted > share_count) wanted = share_count;
    if (wanted > THREADS_MOST) wanted = THREADS_MOST;
    fegetenv(&t.environment);
    while (count + 1 < wanted && pthread_create(&helpers[count], NULL, task_run, &t) == 0) count++;
    work(shared);
    for (uint64_t n = 0; n < count; n++) pthread_join(helpers[n], NULL);
}
