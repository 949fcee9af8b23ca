/*
 * notice.h - what the user should know although the run goes on
 *
 * A notice is one line on standard error, "tetracubes: ...", and an element of the array "notices" of a JSON report.
 * With --quiet it is not printed. Called by the main thread alone.
 */
#ifndef NOTICE_H
#define NOTICE_H

#include <jansson.h>

/* Forgets all, and says who will see what comes. */
void notice_begin(int quiet, int json);

/* Nonzero where somebody will see a notice: otherwise nobody need look for its reason. */
int notice_wanted(void);

void notice(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* All so far, an array of texts; NULL where there was no memory for one. */
json_t *notices_json(void);

/* Frees. */
void notice_end(void);

#endif
