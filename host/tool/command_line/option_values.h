/*
 * option_values.h - the command line as values: a command sees only this
 *
 * option_table.c has the options, and says where in the struct each value goes.
 */
#ifndef OPTION_VALUES_H
#define OPTION_VALUES_H

#include "dataset/request.h"
#include "view.h"

#include <stddef.h>
#include <stdint.h>

/* Bits: which commands know an option. */
enum command_bit {
    COMMAND_EXTRACT = 1,
    COMMAND_INFO = 2,
    COMMAND_DEVICES = 4,
    COMMAND_GENERATE = 8,
    COMMAND_SELFTEST = 16,
    COMMAND_TETRAHEDRALIZE = 32,
    COMMAND_JOIN = 64,
    COMMAND_ISOVOLUME = 128,
    COMMAND_LABELS = 256,
};

/* Commands that make something of a grid; that take parts of one; that read an input. */
enum {
    MAKES = COMMAND_EXTRACT | COMMAND_ISOVOLUME | COMMAND_LABELS,
    TAKES_PARTS = MAKES | COMMAND_INFO,
    READS = TAKES_PARTS | COMMAND_TETRAHEDRALIZE
};

/* Of --engine: the device, and the reference where there is none or it fails. */
enum { ENGINE_AUTO = 2 };

/* Of --cut: where the members of a team, or parts, begin. */
enum { CUT_EVEN, CUT_COST, CUT_PLANES };

typedef struct cut_request {
    int kind;
    int64_t *planes; /* of CUT_PLANES: where the second one begins, and those after it; from malloc */
    size_t count;
} cut_request;

typedef struct typed_isovalue {
    double value;  /* finite */
    char text[48]; /* as typed */
} typed_isovalue;

/* low < high; an end that was left out is infinite. */
typedef struct typed_range {
    double low, high;
    char text[96]; /* as typed */
} typed_range;

typedef struct options {
    const char *command;
    enum command_bit bit;
    char **operands; /* what is no option: input files, the field of generate */
    int operand_count;

    typed_isovalue *isovalues;
    size_t isovalue_count;
    typed_range *ranges;
    size_t range_count;
    const char *output; /* NULL where not given, as all texts */
    const char *format;
    const char *preview;     /* a picture */
    view_angles view;        /* of the surface in it */
    int64_t preview_size[2]; /* pixels */
    const char *device;
    int engine;            /* a tc_engine, or ENGINE_AUTO */
    int method;            /* a tc_method */
    double snap;           /* -1 where not given */
    double simplify;       /* share of the triangles that is to remain; 0 where not given, as the next */
    double simplify_error; /* distance of surfaces at most */
    const char *field;
    const char *carry;   /* names with commas between */
    int separate_blocks; /* a file for each */
    int skip_unsupported;
    int has_nodata;
    double nodata;
    int component, frame; /* -1 where not given; component may be COMPONENT_MAGNITUDE */
    region_request region;
    int64_t part[2]; /* --part: which, from 0, of how many; 0 of 0 where not given */
    cut_request cut;
    const char *mask;
    uint32_t *labels; /* those that are wanted; NULL: all */
    size_t label_count;
    uint64_t smooth; /* sweeps */
    int separate_labels;
    uint64_t max_memory; /* 0 where not given */
    uint64_t seed;

    int64_t dims[3]; /* zeros where not given */
    int type;        /* a tc_type, -1 where not given */
    int big_endian;
    uint64_t skip;
    double spacing[3], origin[3];
    double origin_at[3]; /* where given: coordinates of the output are relative to it */

    uint64_t given[2]; /* bit n: row n of the table stood on the command line */
    uint64_t timeout;  /* seconds; 0 where not given */
    const char *junit; /* NULL where not given */
    int quick, vectors;
    int verify, check, json, count, soup, closed, stream, normals, drop_degenerate, quiet, help;
} options;

#endif
