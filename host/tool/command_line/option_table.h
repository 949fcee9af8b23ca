/*
 * option_table.h - the table of options, which parsing, --help, completion and the manual page are made of
 */
#ifndef OPTION_TABLE_H
#define OPTION_TABLE_H

#include "choice.h"

#include <stddef.h>

typedef enum value_kind {
    VALUE_NONE,      /* int, set to 1 */
    VALUE_TEXT,      /* const char * */
    VALUE_FORMAT,    /* const char *, which the writers check: they know why one does not suit */
    VALUE_CHOICE,    /* int, the index in choices */
    VALUE_ISOVALUES, /* appended to isovalues */
    VALUE_INTERVALS, /* one more of ranges */
    VALUE_NODATA,    /* double nodata, and has_nodata */
    VALUE_INDEX,     /* int, from 0 */
    VALUE_COMPONENT, /* the same, or COMPONENT_MAGNITUDE */
    VALUE_NUMBER,    /* uint64_t */
    VALUE_SIZE,      /* uint64_t bytes, K M G T */
    VALUE_BOUND,     /* the same, above 0 */
    VALUE_DIMS,      /* int64_t[3], from 1 */
    VALUE_SPACING,   /* double[3], above 0 */
    VALUE_POINT,     /* double[3] */
    VALUE_INDICES,   /* index_ranges */
    VALUE_RANGES,    /* world_ranges */
    VALUE_STEP,      /* int64_t[3], from 1; one number goes for all */
    VALUE_THRESHOLD, /* double, 0 to 0.5 */
    VALUE_SHARE,     /* double, above 0 and below 1 */
    VALUE_DISTANCE,  /* double, above 0 */
    VALUE_PIECE,     /* int64_t[2]: I/N */
    VALUE_CUT,       /* cut_request */
    VALUE_VIEW,      /* view_angles: one of the choices, or two numbers */
    VALUE_PIXELS,    /* int64_t[2] */
    VALUE_LABELS,    /* labels: none for all */
} value_kind;

typedef struct option {
    const char *name;
    const char *short_name; /* or NULL */
    const char *value;      /* as --help shows it */
    unsigned commands;
    value_kind kind;
    size_t offset;        /* in struct options */
    choice_name *choices; /* or NULL */
    const char *help;     /* lines split by \n */
} option;

extern const option option_table[];
extern const size_t option_table_count;

enum { OPTION_TABLE_MOST = 128 }; /* rows: a bit of options.given each */

#endif
