/*
 * notice.h - lines on standard error: what went wrong, and what the user should know although the run goes on
 *
 * Each line begins with "tetracubes: ". A notice is also an element of the array "notices" of a JSON report, and is not
 * printed with --quiet. Called by the main thread alone.
 */
#ifndef NOTICE_H
#define NOTICE_H

#include <jansson.h>

/* A line that is printed in any case. Not for a failure that ends the run: main prints that. */
void message(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Forgets all notices, and says who will see those that come. */
void notice_begin(int quiet, int json);

/* Nonzero where somebody will see a notice: otherwise nobody need look for its reason. */
int notice_wanted(void);

void notice(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* An array of all texts so far, for a JSON report. */
json_t *notices_json(void);

/* Frees. */
void notice_end(void);

#endif
