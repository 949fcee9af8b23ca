/*
 * options.c - one table of options and the parsing of their values
 *
 * An option is a row of the table: name, commands that know it, kind of value, place in struct options, help.
 * Values follow as the next argument or after '='. Every value is checked here, as far as it can be without the input.
 */
#include "options.h"

#include "exit_status.h"
#include "failure.h"
#include "mesh_write.h"
#include "request.h"
#include "sample_types.h"
#include "similar_name.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef enum value_kind {
    VALUE_NONE,      /* int, set to 1 */
    VALUE_TEXT,      /* const char * */
    VALUE_CHOICE,    /* int, the index in choices */
    VALUE_ISOVALUES, /* appended to isovalues */
    VALUE_NODATA,    /* double nodata, and has_nodata */
    VALUE_INDEX,     /* int, from 0 */
    VALUE_COMPONENT, /* the same, or COMPONENT_MAGNITUDE */
    VALUE_NUMBER,    /* uint64_t */
    VALUE_SIZE,      /* uint64_t bytes, K M G T */
    VALUE_BOUND,     /* the same, above 0 */
    VALUE_DIMS,      /* int64_t[3], from 1 */
    VALUE_SPACING,   /* double[3], above 0 */
    VALUE_POINT,     /* double[3] */
} value_kind;

typedef struct option {
    const char *name;
    const char *short_name; /* or NULL */
    const char *value;      /* as --help shows it */
    unsigned commands;
    value_kind kind;
    size_t place; /* in struct options */
    const char *const *choices;
    const char *help; /* lines split by \n */
} option;

#define TYPE_CHOICE(type, name, ...) [type] = #name,
static const char *const type_choices[SAMPLE_TYPE_COUNT + 1] = {SAMPLE_TYPES(TYPE_CHOICE)};
#define TYPE_BEHIND_BLANK(type, name, ...) " " #name
#define TYPE_BEFORE_BLANK(type, name, ...) #name " "

static const char *const endian_choices[] = {"little", "big", NULL};
static const char *const engine_choices[] = {"opencl", "reference", "auto", NULL};
static const char *const method_choices[] = {"tetra", "hybrid", NULL};
#define FORMAT_CHOICE(name, ...) #name,
static const char *const format_choices[] = {MESH_FORMATS(FORMAT_CHOICE) NULL};
static const char *const blocks_choices[] = {"joined", "separate", NULL};

#define READS   (COMMAND_EXTRACT | COMMAND_INFO | COMMAND_TETRAHEDRALIZE)
#define REPORTS (READS | COMMAND_DEVICES | COMMAND_SELFTEST)
#define ALL     (REPORTS | COMMAND_GENERATE)
#define IN(m)   offsetof(options, m)

/* clang-format off */
static const option table[] = {
    {"--iso", NULL, "V[,V...]", COMMAND_EXTRACT, VALUE_ISOVALUES, IN(isovalues), NULL,
     "isovalue, or several with commas between: samples >= V are inside"},
    {"--output", "-o", "FILE", COMMAND_EXTRACT, VALUE_TEXT, IN(output), NULL,
     "mesh to write: .ply, .vtp, .stl or .obj (left out: only the report); with\n"
     "several isovalues, % in FILE stands for the isovalue as typed; - is standard\n"
     "output (give --format): the report then goes to standard error"},
    {"--output", "-o", "FILE", COMMAND_GENERATE, VALUE_TEXT, IN(output), NULL,
     "volume to write: .nrrd, or .raw for samples without a header; - is NRRD on\n"
     "standard output"},
    {"--output", "-o", "FILE", COMMAND_TETRAHEDRALIZE, VALUE_TEXT, IN(output), NULL,
     "unstructured grid to write: .vtu; - is standard output"},
    {"--format", NULL, "F", COMMAND_EXTRACT, VALUE_TEXT, IN(format), format_choices,
     "ply, vtp, stl or obj, whatever FILE ends in"},
    {"--field", NULL, "NAME", READS, VALUE_TEXT, IN(field), NULL,
     "field to contour, of data with several, see 'tetracubes info'; values of\n"
     "cells are averaged to the points between them; point:NAME and cell:NAME\n"
     "choose where both have a field of that name (else that of the points)"},
    {"--carry", NULL, "NAME[,NAME...]", COMMAND_EXTRACT, VALUE_TEXT, IN(carry), NULL,
     "other fields, interpolated onto the vertices (PLY, VTP); a name that the\n"
     "file needs itself, as Normals, gets _ behind"},
    {"--blocks", NULL, "B", COMMAND_EXTRACT, VALUE_CHOICE, IN(separate_blocks), blocks_choices,
     "of data in several blocks: joined (default): one mesh; separate: one\n"
     "file per block, FILE with _b0, _b1, ... before its ending"},
    {"--normals", NULL, NULL, COMMAND_EXTRACT, VALUE_NONE, IN(normals), NULL,
     "write a unit normal per vertex, from the gradient of the samples (PLY, OBJ,\n"
     "VTP); structured grids only"},
    {"--soup", NULL, NULL, COMMAND_EXTRACT, VALUE_NONE, IN(soup), NULL,
     "write three vertices of its own for every triangle, none shared"},
    {"--origin-at", NULL, "X,Y,Z", COMMAND_EXTRACT, VALUE_POINT, IN(origin_at), NULL,
     "write coordinates relative to this point of the input's space (default: the\n"
     "input's own; STL, which holds float32 alone, of data far from zero relative\n"
     "to a point near it, which is told)"},
    {"--drop-degenerate", NULL, NULL, COMMAND_EXTRACT, VALUE_NONE, IN(drop_degenerate), NULL,
     "leave out triangles of zero area, as samples that equal the isovalue make:\n"
     "their edges without length are contracted, what was closed stays closed"},
    {"--count", NULL, NULL, COMMAND_EXTRACT, VALUE_NONE, IN(count), NULL,
     "classify only: count vertices, triangles and active cells, make no mesh"},
    {"--method", NULL, "M", COMMAND_EXTRACT, VALUE_CHOICE, IN(method), method_choices,
     "tetra (default): tetrahedra, five per cube; hybrid: marching cubes whose\n"
     "ambiguous cases the tetrahedra decide: fewer triangles, structured grids"},
    {"--engine", NULL, "E", COMMAND_EXTRACT, VALUE_CHOICE, IN(engine), engine_choices,
     "opencl (default), reference: scalar C, needs no OpenCL, same bytes; or auto:\n"
     "the reference where there is no device, or it fails or gives wrong results"},
    {"--device", NULL, "SPEC", COMMAND_EXTRACT | COMMAND_SELFTEST, VALUE_TEXT, IN(device), NULL,
     "an index, platform:device, cpu, gpu or part of a name, see\n"
     "'tetracubes devices'; default: $TETRACUBES_DEVICE, else the first CPU"},
    {"--max-memory", NULL, "SIZE", COMMAND_EXTRACT, VALUE_BOUND, IN(max_memory), NULL,
     "bound on device buffers, in bytes or with K, M, G, T (powers of 1024):\n"
     "less memory means smaller slabs, never another result"},
    {"--verify", NULL, NULL, COMMAND_EXTRACT, VALUE_NONE, IN(verify), NULL,
     "extract with the reference engine too and compare every byte"},
    {"--check", NULL, NULL, COMMAND_EXTRACT, VALUE_NONE, IN(check), NULL,
     "check the mesh itself: manifold, oriented; Euler characteristic, area, of\n"
     "closed surfaces volume (boundary edges are reported, they are no fault)"},
    {"--nodata", NULL, "V", READS, VALUE_NODATA, IN(nodata), NULL,
     "samples equal to V are missing, as are NaN and infinities: a cell with\n"
     "a missing corner is left out; of f32 samples and of scaled ones the float\n"
     "nearest to V counts; of vectors one component equal to V is enough"},
    {"--skip-unsupported", NULL, NULL, COMMAND_EXTRACT | COMMAND_TETRAHEDRALIZE, VALUE_NONE, IN(skip_unsupported), NULL,
     "leave out cells of types that are not cut, and polyhedra whose faces are\n"
     "not closed, with a notice, instead of refusing the input"},
    {"--component", NULL, "C", READS, VALUE_COMPONENT, IN(component), NULL,
     "which value, from 0, of data with several values per sample; or magnitude:\n"
     "their Euclidean length, as f32, of u32, i32 and f64 values as f64"},
    {"--frame", NULL, "N", READS, VALUE_INDEX, IN(frame), NULL,
     "which volume, from 0, of data with a fourth axis"},
    {"--dims", NULL, "NX,NY,NZ", READS, VALUE_DIMS, IN(dims), NULL,
     "raw input: samples along x, y and z, x fastest"},
    {"--dims", NULL, "NX,NY,NZ", COMMAND_GENERATE, VALUE_DIMS, IN(dims), NULL,
     "samples along x, y and z"},
    {"--type", NULL, "T", READS, VALUE_CHOICE, IN(type), type_choices,
     "raw input:" SAMPLE_TYPES(TYPE_BEHIND_BLANK)},
    {"--type", NULL, "T", COMMAND_GENERATE, VALUE_CHOICE, IN(type), type_choices,
     SAMPLE_TYPES(TYPE_BEFORE_BLANK) "(integers truncate and saturate)"},
    {"--endian", NULL, "E", READS, VALUE_CHOICE, IN(big_endian), endian_choices,
     "raw input: little (default) or big"},
    {"--skip", NULL, "BYTES", READS, VALUE_SIZE, IN(skip), NULL,
     "raw input: bytes before the first sample"},
    {"--spacing", NULL, "X,Y,Z", READS, VALUE_SPACING, IN(spacing), NULL,
     "distance of samples along the axes of a uniform grid, in place of what the\n"
     "file says, whose directions stay; raw input without it: 1,1,1"},
    {"--origin", NULL, "X,Y,Z", READS, VALUE_POINT, IN(origin), NULL,
     "position of the first sample of a uniform grid (of VTK's: of index 0,0,0),\n"
     "in place of what the file says; raw input without it: 0,0,0"},
    {"--seed", NULL, "S", COMMAND_GENERATE, VALUE_NUMBER, IN(seed), NULL,
     "of noise, a whole number, default 0"},
    {"--quick", NULL, NULL, COMMAND_SELFTEST, VALUE_NONE, IN(quick), NULL,
     "some trials of every group; of vectors those up to 128 x 128 x 128"},
    {"--vectors", NULL, NULL, COMMAND_SELFTEST, VALUE_NONE, IN(vectors), NULL,
     "compare with a list of hashes: that of a FILE behind, else the tool's own"},
    {"--timeout", NULL, "SECONDS", COMMAND_SELFTEST, VALUE_NUMBER, IN(timeout), NULL,
     "no trial goes on longer: those that are left then fail"},
    {"--junit", NULL, "FILE", COMMAND_SELFTEST, VALUE_TEXT, IN(junit), NULL,
     "write a JUnit file too: a suite per group, a case per trial"},
    {"--json", NULL, NULL, REPORTS, VALUE_NONE, IN(json), NULL,
     "print the results as one JSON object"},
    {"--quiet", NULL, NULL, READS | COMMAND_GENERATE, VALUE_NONE, IN(quiet), NULL,
     "no progress, no notices, no report but that of --json"},
    {"--help", "-h", NULL, ALL, VALUE_NONE, IN(help), NULL,
     "print this"},
};
/* clang-format on */

#define TABLE_COUNT (sizeof table / sizeof *table)

/* ---------------------------------------------------------------------------------------------------------- values */

static const char *skip_blanks(const char *at) { return at + strspn(at, " \t"); }

/* A finite number at *at, *at then behind it; 0 where there is none. Blanks are no part of a number. */
static int take_real(const char **at, double *value) {
    if (!**at || isspace((unsigned char)**at)) return 0;
    char *end;
    *value = strtod(*at, &end);
    if (end == *at || !isfinite(*value)) return 0;
    *at = end;
    return 1;
}

static int take_whole(const char **at, uint64_t *value) {
    if (!isdigit((unsigned char)**at)) return 0;
    char *end;
    errno = 0;
    *value = strtoull(*at, &end, 10);
    *at = end;
    return errno == 0;
}

/* Blanks around the number are left out. */
static int append_isovalue(const char *text, size_t length, options *o) {
    typed_isovalue fresh = {0};
    for (; length && strchr(" \t", *text); length--) text++;
    while (length && strchr(" \t", text[length - 1])) length--;
    if (length >= sizeof fresh.text)
        return fail(STATUS_USAGE, "--iso: '%.20s...' is longer than a number needs to be", text);
    memcpy(fresh.text, text, length);
    const char *at = fresh.text;
    if (!take_real(&at, &fresh.value) || *at)
        return fail(STATUS_USAGE, "--iso: '%s' is no finite number; give one, or several with commas, as in 30,127.5",
                    fresh.text);
    typed_isovalue *grown = realloc(o->isovalues, (o->isovalue_count + 1) * sizeof *grown);
    if (!grown) return fail(STATUS_FAILED, "out of memory for the isovalues");
    o->isovalues = grown;
    grown[o->isovalue_count++] = fresh;
    return 0;
}

static int parse_isovalues(const char *text, options *o) {
    for (;;) {
        size_t length = strcspn(text, ",");
        int status = append_isovalue(text, length, o);
        if (status || !text[length]) return status;
        text += length + 1;
    }
}

static int parse_reals(const option *spec, const char *text, double out[3]) {
    const char *at = text;
    for (int axis = 0; axis < 3; axis++) {
        at = skip_blanks(at);
        int good = take_real(&at, &out[axis]) && (spec->kind != VALUE_SPACING || out[axis] > 0.0);
        at = skip_blanks(at);
        if (!good || *at != (axis < 2 ? ',' : '\0'))
            return fail(STATUS_USAGE, "%s: '%s' is not three finite numbers%s, as in 1,1,2.5", spec->name, text,
                        spec->kind == VALUE_SPACING ? " above 0" : "");
        at++;
    }
    return 0;
}

static int parse_dims(const option *spec, const char *text, int64_t out[3]) {
    const char *at = text;
    for (int axis = 0; axis < 3; axis++) {
        uint64_t count = 0;
        at = skip_blanks(at);
        int good = take_whole(&at, &count) && count > 0 && count <= INT64_MAX;
        at = skip_blanks(at);
        if (!good || *at != (axis < 2 ? ',' : '\0'))
            return fail(STATUS_USAGE, "%s: '%s' is not three whole numbers above 0, as in 256,256,128", spec->name,
                        text);
        out[axis] = (int64_t)count;
        at++;
    }
    return 0;
}

/* Bytes: a whole number, then K, M, G or T, with iB or B after it if one likes. */
static int parse_size(const option *spec, const char *text, uint64_t *out) {
    static const char units[] = "KMGT";
    const char *at = text;
    uint64_t bytes;
    int good = take_whole(&at, &bytes), shift = 0;
    const char *unit = *at ? strchr(units, toupper((unsigned char)*at)) : NULL;
    if (unit) {
        shift = 10 * (int)(unit - units + 1);
        at++;
        if (strcmp(at, "B") == 0 || strcmp(at, "iB") == 0) at = "";
    }
    if (!good || *at || bytes > UINT64_MAX >> shift)
        return fail(STATUS_USAGE, "%s: '%s' is no size; give bytes, or K, M, G, T behind a whole number, as in 512M",
                    spec->name, text);
    if (!bytes && spec->kind == VALUE_BOUND)
        return fail(STATUS_USAGE, "%s: '%s' leaves nothing; leave the option out for no bound", spec->name, text);
    *out = bytes << shift;
    return 0;
}

static int parse_choice(const option *spec, const char *text, int *out) {
    size_t count = 0;
    char all[128] = "";
    for (; spec->choices[count]; count++) {
        if (strcmp(text, spec->choices[count]) == 0) {
            *out = (int)count;
            return 0;
        }
        size_t used = strlen(all);
        snprintf(all + used, sizeof all - used, "%s%s", count ? ", " : "", spec->choices[count]);
    }
    const char *meant = similar_name(text, spec->choices, count);
    return fail(STATUS_USAGE, "%s: '%s' is none of %s%s%s%s", spec->name, text, all, meant ? "; did you mean " : "",
                meant ? meant : "", meant ? "?" : "");
}

static int parse_number(const option *spec, const char *text, uint64_t most, uint64_t *out) {
    const char *at = text;
    if (!take_whole(&at, out) || *at || *out > most)
        return fail(STATUS_USAGE, "%s: '%s' is no whole number from 0 to %llu", spec->name, text,
                    (unsigned long long)most);
    return 0;
}

static int parse_value(const option *spec, const char *text, options *o) {
    void *place = (char *)o + spec->place;
    uint64_t number = 0;
    int status;
    switch (spec->kind) {
    case VALUE_NONE:
        *(int *)place = 1;
        return 0;
    case VALUE_TEXT:
        if (!*text) return fail(STATUS_USAGE, "%s: the value is empty", spec->name);
        *(const char **)place = text;
        if (!spec->choices) return 0;
        int unused;
        return parse_choice(spec, text, &unused);
    case VALUE_CHOICE:
        return parse_choice(spec, text, place);
    case VALUE_ISOVALUES:
        return parse_isovalues(text, o);
    case VALUE_NODATA:
        o->has_nodata = 1;
        if (take_real(&text, &o->nodata) && !*text) return 0;
        return fail(STATUS_USAGE, "--nodata: give one finite number (NaN and infinities are missing in any case)");
    case VALUE_INDEX:
        status = parse_number(spec, text, INT_MAX, &number);
        *(int *)place = (int)number;
        return status;
    case VALUE_COMPONENT:
        *(int *)place = COMPONENT_MAGNITUDE;
        if (strcmp(text, "magnitude") == 0) return 0;
        status = parse_number(spec, text, INT_MAX, &number);
        *(int *)place = (int)number;
        return status ? fail(status, "%s: '%s' is neither a whole number from 0 on nor magnitude", spec->name, text)
                      : 0;
    case VALUE_NUMBER:
        return parse_number(spec, text, UINT64_MAX, place);
    case VALUE_SIZE:
    case VALUE_BOUND:
        return parse_size(spec, text, place);
    case VALUE_DIMS:
        return parse_dims(spec, text, place);
    case VALUE_SPACING:
    case VALUE_POINT:
        return parse_reals(spec, text, place);
    }
    return fail(STATUS_USAGE, "%s: not understood", spec->name);
}

/* --------------------------------------------------------------------------------------------------------- parsing */

/* The row of the table for the first `length` characters of the argument; NULL where the command has none. */
static const option *find(enum command_bit command, const char *argument, size_t length) {
    for (const option *spec = table; spec < table + TABLE_COUNT; spec++) {
        if (!(spec->commands & command)) continue;
        const char *names[] = {spec->name, spec->short_name};
        for (int n = 0; n < 2; n++)
            if (names[n] && strlen(names[n]) == length && strncmp(names[n], argument, length) == 0) return spec;
    }
    return NULL;
}

static int unknown_option(enum command_bit command, const char *name, const char *argument, size_t length) {
    const char *names[TABLE_COUNT];
    char typed[64];
    snprintf(typed, sizeof typed, "%.*s", (int)(length < sizeof typed ? length : sizeof typed - 1), argument);
    for (size_t n = 0; n < TABLE_COUNT; n++) names[n] = table[n].commands & command ? table[n].name : NULL;
    const char *meant = similar_name(typed, names, TABLE_COUNT);
    if (meant) return fail(STATUS_USAGE, "%s has no option %s; did you mean %s?", name, typed, meant);
    return fail(STATUS_USAGE, "%s has no option %s; see 'tetracubes %s --help'", name, typed, name);
}

/* One option at argv[*at], with its value; *at is left on the last argument used. */
static int parse_option(enum command_bit command, int argc, char **argv, int *at, options *o) {
    const char *argument = argv[*at], *value = strchr(argument, '=');
    size_t length = value ? (size_t)(value - argument) : strlen(argument);
    const option *spec = find(command, argument, length);
    if (!spec) return unknown_option(command, o->command, argument, length);
    if (spec->kind == VALUE_NONE) {
        if (value) return fail(STATUS_USAGE, "%s takes no value", spec->name);
    } else if (value) {
        value++;
    } else if (*at + 1 == argc) {
        return fail(STATUS_USAGE, "%s needs a value: %s %s", spec->name, spec->name, spec->value);
    } else {
        value = argv[++*at];
    }
    const uint64_t bit = (uint64_t)1 << (spec - table);
    if (o->given & bit && spec->kind != VALUE_NONE && spec->kind != VALUE_ISOVALUES)
        return fail(STATUS_USAGE, "%s is given twice: leave one out", spec->name);
    o->given |= bit;
    return parse_value(spec, value, o);
}

int options_parse(enum command_bit command, const char *name, int argc, char **argv, options *o) {
    *o = (options){.command = name,
                   .bit = command,
                   .component = COMPONENT_OPEN,
                   .frame = -1,
                   .type = -1,
                   .spacing = {1.0, 1.0, 1.0}};
    int only_operands = 0;
    o->operands = calloc((size_t)argc + 1, sizeof *o->operands);
    if (!o->operands) return fail(STATUS_FAILED, "out of memory for the command line");
    for (int at = 0; at < argc; at++) {
        if (only_operands || argv[at][0] != '-' || !argv[at][1]) {
            o->operands[o->operand_count++] = argv[at];
        } else if (strcmp(argv[at], "--") == 0) {
            only_operands = 1;
        } else {
            int status = parse_option(command, argc, argv, &at, o);
            if (status) return status;
        }
    }
    return 0;
}

void options_release(options *o) {
    free(o->isovalues);
    free(o->operands);
    *o = (options){0};
}

int options_given(const options *o, const char *name) {
    for (size_t n = 0; n < TABLE_COUNT; n++)
        if (o->given >> n & 1 && strcmp(table[n].name, name) == 0) return 1;
    return 0;
}

int options_view(enum command_bit command, size_t n, option_view *out) {
    for (const option *spec = table; spec < table + TABLE_COUNT; spec++) {
        if (!(spec->commands & command) || n--) continue;
        const int takes_file = spec->value && strcmp(spec->value, "FILE") == 0;
        *out = (option_view){spec->name, spec->short_name, spec->value, spec->help, spec->choices, takes_file};
        return 1;
    }
    return 0;
}

void options_print(enum command_bit command, FILE *out) {
    for (const option *spec = table; spec < table + TABLE_COUNT; spec++) {
        if (!(spec->commands & command)) continue;
        char head[64];
        snprintf(head, sizeof head, "%s%s%s%s%s", spec->short_name ? spec->short_name : "",
                 spec->short_name ? ", " : "", spec->name, spec->value ? " " : "", spec->value ? spec->value : "");
        const char *line = spec->help;
        for (int first = 1; line; first = 0) {
            int length = (int)strcspn(line, "\n");
            fprintf(out, "  %-21s %.*s\n", first ? head : "", length, line);
            line = line[length] ? line + length + 1 : NULL;
        }
    }
}
