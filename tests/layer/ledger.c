/*
 * The mode that keeps the books: which objects the program holds, and which of its commands have not ended.
 *
 * Always on. Objects are counted by reference, as the program makes, retains and releases them; an object that is
 * released or used and is not there is a fault. Every command gets an event of the layer's own.
 */
#include "layer.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

static cl_icd_dispatch below;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

/* --------------------------------------------------------------------------------------------------------- objects */

enum { OBJECTS_MOST = 1 << 16 };

static struct {
    const void *object;
    long references;
} objects[OBJECTS_MOST];
static int object_count;

static int object_find(const void *object) {
    for (int n = object_count - 1; n >= 0; n--)
        if (objects[n].object == object) return n;
    return -1;
}

/* Changes the references that the program holds. */
static void object_count_add(const void *object, long references, const char *entry_name) {
    pthread_mutex_lock(&lock);
    int n = object_find(object);
    if (n < 0 && references > 0 && object_count < OBJECTS_MOST) {
        n = object_count++;
        objects[n].object = object;
        objects[n].references = 0;
    }
    if (n < 0)
        fault("%s of an object that the program does not hold", entry_name);
    else if ((objects[n].references += references) == 0)
        objects[n] = objects[--object_count];
    pthread_mutex_unlock(&lock);
}

static void object_use(const void *object, const char *entry_name) {
    pthread_mutex_lock(&lock);
    if (object_find(object) < 0) fault("%s uses an object that the program does not hold", entry_name);
    pthread_mutex_unlock(&lock);
}

long ledger_references(void) {
    long sum = 0;
    pthread_mutex_lock(&lock);
    for (int n = 0; n < object_count; n++) sum += objects[n].references;
    pthread_mutex_unlock(&lock);
    return sum;
}

/* -------------------------------------------------------------------------------------------------------- commands */

static cl_event *commands;
static int command_count, command_room;

static bool has_ended(cl_event command) {
    cl_int state = CL_QUEUED;
    return below.clGetEventInfo(command, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof state, &state, NULL) ||
           state <= CL_COMPLETE;
}

static void commands_prune(void) {
    int kept = 0;
    for (int n = 0; n < command_count; n++)
        if (has_ended(commands[n]))
            below.clReleaseEvent(commands[n]);
        else
            commands[kept++] = commands[n];
    command_count = kept;
}

/* The event of a command that has been put into a queue. The program gets it too where it asked for one. */
static void command_note(cl_int error, cl_event made, cl_event *theirs) {
    if (error) return;
    if (theirs) {
        *theirs = made;
        object_count_add(made, 1, "event");
        below.clRetainEvent(made);
    }
    pthread_mutex_lock(&lock);
    if (command_count == command_room) {
        commands_prune();
        command_room = 2 * command_count + 64;
        commands = realloc(commands, (size_t)command_room * sizeof *commands);
        if (!commands) abort();
    }
    commands[command_count++] = made;
    pthread_mutex_unlock(&lock);
}

int ledger_pending(void) {
    pthread_mutex_lock(&lock);
    commands_prune();
    const int count = command_count;
    pthread_mutex_unlock(&lock);
    return count;
}

/* --------------------------------------------------------------------------------------------------- entry points */

#define O(type, name, parameters, arguments)                                                                           \
    static type CL_API_CALL name parameters {                                                                          \
        type made = below.cl##name arguments;                                                                          \
        if (made) object_count_add(made, 1, "cl" #name);                                                               \
        return made;                                                                                                   \
    }
#define E(name, blocks, parameters, arguments)                                                                         \
    static cl_int CL_API_CALL name parameters {                                                                        \
        cl_event made = NULL, *theirs = event;                                                                         \
        object_use(queue, "cl" #name);                                                                                 \
        event = &made;                                                                                                 \
        const cl_int error = below.cl##name arguments;                                                                 \
        command_note(error, made, theirs);                                                                             \
        return error;                                                                                                  \
    }
#define M(type, name, parameters, arguments)                                                                           \
    static type CL_API_CALL name parameters {                                                                          \
        cl_event made = NULL, *theirs = event;                                                                         \
        object_use(queue, "cl" #name);                                                                                 \
        event = &made;                                                                                                 \
        type mapped = below.cl##name arguments;                                                                        \
        command_note(mapped ? CL_SUCCESS : CL_INVALID_VALUE, made, theirs);                                            \
        return mapped;                                                                                                 \
    }
#define S(name, parameters, arguments)
OPENCL_ENTRIES(S, O, E, M)
#undef O
#undef E
#undef M

#define REFERENCES(X)                                                                                                  \
    X(RetainContext, cl_context, 1)                                                                                    \
    X(RetainCommandQueue, cl_command_queue, 1)                                                                         \
    X(RetainMemObject, cl_mem, 1)                                                                                      \
    X(ReleaseContext, cl_context, -1)                                                                                  \
    X(ReleaseCommandQueue, cl_command_queue, -1)                                                                       \
    X(ReleaseProgram, cl_program, -1)                                                                                  \
    X(ReleaseKernel, cl_kernel, -1)                                                                                    \
    X(ReleaseMemObject, cl_mem, -1)                                                                                    \
    X(ReleaseEvent, cl_event, -1)

#define R(name, type, change)                                                                                          \
    static cl_int CL_API_CALL name(type object) {                                                                      \
        object_count_add(object, change, "cl" #name);                                                                  \
        return below.cl##name(object);                                                                                 \
    }
REFERENCES(R)
#undef R

static void install(cl_icd_dispatch *table) {
    below = *table;
#define O(type, name, parameters, arguments)   table->cl##name = name;
#define E(name, blocks, parameters, arguments) table->cl##name = name;
#define R(name, type, change)                  table->cl##name = name;
    OPENCL_ENTRIES(S, O, E, O)
    REFERENCES(R)
#undef S
#undef O
#undef E
#undef R
}

static bool command(char *const *words, int count) {
    (void)words;
    (void)count;
    return false;
}

const layer_mode ledger_mode = {"ledger", install, command};
