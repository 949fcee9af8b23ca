/* choice.h - a value that is one of several names */
#ifndef CHOICE_H
#define CHOICE_H

/* Name n, from 0 on; NULL behind the last. */
typedef const char *choice_name(int n);

/* Finds the index of the name that was typed. Returns 0, or STATUS_USAGE with a text that lists all names and the one
 * that was probably meant. */
int choice_find(const char *option, const char *typed, choice_name *names, int *index);

#endif
