/*
 * name_pattern.h - names of files in which every % stands for a value: an isovalue, a range, a label; %% stands for the
 * percent sign itself
 */
#ifndef NAME_PATTERN_H
#define NAME_PATTERN_H

#include <stddef.h>

/* Whether the value has a placeholder in it. */
int name_pattern_has_placeholder(const char *pattern);

/* 0 where each of so many values gets a name of its own, else STATUS_USAGE; option and kind ("isovalue") are for its
 * text. */
int name_pattern_check(const char *option, const char *pattern, size_t value_count, const char *kind);

/* The name with the value in its placeholders, and behind, as "_b0", before its ending; from malloc, NULL with its
 * failure's text without memory. */
char *name_pattern_fill(const char *pattern, const char *value, const char *behind);

#endif
