/*
 * child_process.h - this program once more, in a process that may crash or hang without harm
 *
 * The child is the same file, started with a command of its own: nothing is inherited but the environment, so that
 * threads and drivers of this process do not matter. What it reports comes line by line through a pipe; what it, or a
 * driver in it, writes to standard output and standard error is swallowed but for the last lines. It is a process group
 * of its own, ends with its parent, and leaves no core file.
 */
#ifndef CHILD_PROCESS_H
#define CHILD_PROCESS_H

#include <stddef.h>

typedef enum child_end_kind {
    CHILD_NOT_STARTED,
    CHILD_EXITED,    /* with exit status `number` */
    CHILD_DIED,      /* by signal `number` */
    CHILD_TIMED_OUT, /* ended here */
    CHILD_CANCELLED, /* ended here, as this process was told to stop */
} child_end_kind;

typedef struct child_end {
    child_end_kind kind;
    int number;
    char said[400]; /* the last line that it wrote to standard output or error; "" for none */
} child_end;

/* Runs the program with these arguments (the first is a command; NULL ends them), and hands every line that it reports
 * to `line`. Waits until it ends. Ends it after most_ms, or when it hangs: no line for silent_ms, in which it used the
 * processor all the time or, in the second half, not at all. */
void child_run(char *const arguments[], double most_ms, double silent_ms, void (*line)(void *user, const char *text),
               void *user, child_end *end);

/* By a signal that a person or the system sends, not one that a fault raises. */
int child_was_ended(const child_end *end);

/* How it ended: "signal 6 (Aborted)", "exit status 1", "time ran out". */
void child_end_text(const child_end *end, char *text, size_t bytes);

/* In the child: the first call ties it to its parent, the second reports a line. */
void child_begin(void);
void child_report(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
