/*
 * options.h - the command line as values
 *
 * One table (options.c) drives parsing, --help and suggestions; a command sees only this struct.
 */
#ifndef OPTIONS_H
#define OPTIONS_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Bits: which commands know an option. */
enum command_bit {
    COMMAND_EXTRACT = 1,
    COMMAND_INFO = 2,
    COMMAND_DEVICES = 4,
    COMMAND_GENERATE = 8,
    COMMAND_SELFTEST = 16,
    COMMAND_TETRAHEDRALIZE = 32,
};

/* Of --engine: the device, and the reference where there is none or it fails. */
enum { ENGINE_AUTO = 2 };

typedef struct typed_isovalue {
    double value;  /* finite */
    char text[48]; /* as typed */
} typed_isovalue;

typedef struct options {
    const char *command;
    enum command_bit bit;
    char **operands; /* what is no option: input files, the field of generate */
    int operand_count;

    typed_isovalue *isovalues;
    size_t isovalue_count;
    const char *output; /* NULL where not given, as all texts */
    const char *format;
    const char *device;
    int engine; /* a tc_engine, or ENGINE_AUTO */
    int method; /* a tc_method */
    const char *field;
    const char *carry;   /* names with commas between */
    int separate_blocks; /* a file for each */
    int skip_unsupported;
    int has_nodata;
    double nodata;
    int component, frame; /* -1 where not given; component may be COMPONENT_MAGNITUDE */
    uint64_t max_memory;  /* 0 where not given */
    uint64_t seed;

    int64_t dims[3]; /* zeros where not given */
    int type;        /* a tc_type, -1 where not given */
    int big_endian;
    uint64_t skip;
    double spacing[3], origin[3];
    double origin_at[3]; /* where given: coordinates of the output are relative to it */

    uint64_t given;    /* bit n: row n of the table stood on the command line */
    uint64_t timeout;  /* seconds; 0 where not given */
    const char *junit; /* NULL where not given */
    int quick, vectors;
    int verify, check, json, count, soup, normals, drop_degenerate, quiet, help;
} options;

/* Parses what follows the command's name into *o, to be released. Returns 0 or STATUS_USAGE with its text. */
int options_parse(enum command_bit command, const char *name, int argc, char **argv, options *o);
void options_release(options *o);

/* Nonzero where the option, e.g. "--dims", stood on the command line. */
int options_given(const options *o, const char *name);

/* What a completion has to know of an option. */
typedef struct option_view {
    const char *name, *short_name; /* short_name: or NULL */
    const char *value, *help;      /* value: as --help shows it; NULL: takes none */
    const char *const *choices;    /* the values there are, NULL behind them; or NULL */
    int takes_file;
} option_view;

/* Option n of a command, from 0; returns 0 behind the last. */
int options_view(enum command_bit command, size_t n, option_view *out);

/* The options of a command, one per line or more, as --help shows them. */
void options_print(enum command_bit command, FILE *out);

#endif
