/*
 * failure.h - a status with a sentence: how every fallible function outside and inside the library reports
 *
 * Functions return 0 or a status; fail() records, for the calling thread, what was wrong and what to do, and hands the
 * status back, so that a failure is one line: return fail(STATUS, "%s: ...", path).
 */
#ifndef FAILURE_H
#define FAILURE_H

/* Records the text (cut at 1,023 bytes) for this thread and returns status. */
int fail(int status, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* A static analyzer sees one source at a time: this tells it which status comes back. */
#ifdef __clang_analyzer__
#define fail(status, ...) (fail(status, __VA_ARGS__), (status))
#endif

/* The last text recorded by this thread; "" where there is none. */
const char *failure_text(void);

#endif
