/* bench_options.c - one table of options for parsing and --help */
#include "bench_options.h"

#include "choice.h"
#include "exit_status.h"
#include "failure.h"
#include "sample_types.h"
#include "similar_name.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AXIS_LIMIT ((int64_t)1 << 24) /* the library's */

const char *const bench_grid_names[BENCH_GRIDS] = {"uniform", "rectilinear", "curvilinear", "tetrahedra", "hexahedra"};

/* ---------------------------------------------------------------------------------------------------------- values */

static int list_full(const char *name) {
    return fail(STATUS_USAGE, "%s: at most %d in one run; run the benchmark once more", name, LIST_MAX);
}

static int take_field(const char *text, bench_options *o) {
    const char *names[32];
    size_t count = 0;
    if (o->field_count == LIST_MAX) return list_full("--field");
    const field *f = field_find(text);
    o->fields[o->field_count++] = f;
    if (f) return 0;
    for (const field *other = fields; other->name; other++) names[count++] = other->name;
    const char *meant = similar_name(text, names, count);
    return fail(STATUS_USAGE, "--field: there is no field '%s'%s%s; see 'tetracubes-bench --help'", text,
                meant ? "; did you mean " : "", meant ? meant : "");
}

/* How many numbers the text holds, 0 where it is not 1 or 3 valid ones. */
static int parse_dims(const char *text, int64_t dims[3]) {
    int count = 0;
    for (const char *at = text; count < 3; at++) {
        char *end;
        dims[count++] = strtoll(at, &end, 10);
        if (end == at || dims[count - 1] < 2 || dims[count - 1] > AXIS_LIMIT) return 0;
        at = end;
        if (!*at) return count == 2 ? 0 : count;
        if (*at != ',') return 0;
    }
    return 0;
}

static int take_dims(const char *text, bench_options *o) {
    if (o->dims_count == LIST_MAX) return list_full("--dims");
    int64_t *dims = o->dims[o->dims_count++];
    int count = parse_dims(text, dims);
    if (!count)
        return fail(STATUS_USAGE,
                    "--dims: '%s' is neither one nor three whole numbers from 2 to %" PRId64
                    ", as in 256 or 256,256,128",
                    text, AXIS_LIMIT);
    if (count == 1) dims[1] = dims[2] = dims[0];
    return 0;
}

#define TYPE_BEHIND_BLANK(type, name, ...) " " #name

static const char *type_choices(int n) { return tc_type_name((tc_type)n); }

static const char *method_choices(int n) { return tc_method_name((tc_method)n); }

static const char *grid_choices(int n) { return n < BENCH_GRIDS ? bench_grid_names[n] : NULL; }

static int take_type(const char *text, bench_options *o) {
    if (o->type_count == LIST_MAX) return list_full("--type");
    int type, status = choice_find("--type", text, type_choices, &type);
    if (!status) o->types[o->type_count++] = (tc_type)type;
    return status;
}

static int parse_isovalue(const char *name, const char *text, double *value) {
    char *end;
    *value = strtod(text, &end);
    if (end == text || *end || !isfinite(*value))
        return fail(STATUS_USAGE, "%s: '%s' is no finite number; the benchmark takes one, as in 127.5", name, text);
    return 0;
}

static int take_iso(const char *text, bench_options *o) {
    o->has_iso = 1;
    return parse_isovalue("--iso", text, &o->iso);
}

static int take_second(const char *text, bench_options *o) {
    o->has_second = 1;
    return parse_isovalue("--second", text, &o->second);
}

static int take_method(const char *text, bench_options *o) {
    int method, status = choice_find("--method", text, method_choices, &method);
    if (!status) o->method = (tc_method)method;
    return status;
}

static int take_grid(const char *text, bench_options *o) {
    int grid, status = choice_find("--grid", text, grid_choices, &grid);
    if (!status) o->grid = (bench_grid)grid;
    return status;
}

static int take_repeat(const char *text, bench_options *o) {
    char *end;
    long repeat = strtol(text, &end, 10);
    o->repeat = (int)repeat;
    o->has_repeat = 1;
    if (end == text || *end || repeat < 1 || repeat > 100000)
        return fail(STATUS_USAGE, "--repeat: '%s' is no whole number from 1 to 100000", text);
    return 0;
}

static int take_device(const char *text, bench_options *o) { return o->device = text, 0; }

static int take_input(const char *text, bench_options *o) { return o->input = text, 0; }

static int take_dump(const char *text, bench_options *o) { return o->dump = text, 0; }

static int take_sweep(const char *text, bench_options *o) { return (void)text, o->sweep = 1, 0; }

static int take_json(const char *text, bench_options *o) { return (void)text, o->json = 1, 0; }

static int take_turns(const char *text, bench_options *o) { return (void)text, o->turns = 1, 0; }

static int take_tune(const char *text, bench_options *o) { return (void)text, o->tune = 1, 0; }

static int take_help(const char *text, bench_options *o) { return (void)text, o->help = 1, 0; }

/* ----------------------------------------------------------------------------------------------------------- table */

typedef struct option {
    const char *name, *value; /* value NULL: takes none */
    int (*take)(const char *text, bench_options *o);
    const char *help;
} option;

/* clang-format off */
static const option table[] = {
    {"--field", "F", take_field,
     "an analytic field (list: below); default sphere, then gyroid *"},
    {"--dims", "N", take_dims,
     "N samples along each axis, or NX,NY,NZ; default 64, 128, 256, 512 *"},
    {"--type", "T", take_type,
     "one of" SAMPLE_TYPES(TYPE_BEHIND_BLANK) "; default u8, then f32 *"},
    {"--iso", "V", take_iso,
     "isovalue; default 127.5; needed with --input"},
    {"--second", "V", take_second,
     "the isovalue that follows on the same grid; default 5% above --iso,\n"
     "or 1 where that is 0"},
    {"--sweep", NULL, take_sweep,
     "other defaults: 64 to 1024; u8, u16, f32; sphere, gyroid,\n"
     "marschner-lobb, noise, empty, full. Of these noise ends at 256, all\n"
     "others at 512 but sphere (u8, f32), gyroid and empty (u8). What does\n"
     "not fit the free memory is left out, with a notice"},
    {"--method", "M", take_method,
     "tetra, five tetrahedra per cell (the default); hybrid, marching cubes\n"
     "with the same topology; or snap, tetrahedra with samples moved onto\n"
     "the surface"},
    {"--grid", "G", take_grid,
     "uniform (the default), rectilinear or curvilinear: the last two move\n"
     "each sample a small step off its uniform position.\n"
     "tetrahedra, hexahedra: the curvilinear one as an unstructured grid, whose\n"
     "hexahedra method hybrid keeps whole"},
    {"--input", "FILE", take_input,
     "a volume file instead of fields; raw ones need --dims and --type"},
    {"--device", "SPEC", take_device,
     "an index, platform:device, cpu, gpu or part of a name;\n"
     "default: $TETRACUBES_DEVICE, else the first"},
    {"--repeat", "R", take_repeat,
     "timed extractions of each kind per case; default 11, or fewer, but 3\n"
     "at least, where these take over 4 seconds"},
    {"--json", NULL, take_json,
     "print one JSON object instead of the table"},
    {"--tune", NULL, take_tune,
     "try launch parameters over the cases (default sizes: 128 and 256), have\n"
     "the library keep the fastest for this device, and measure nothing else"},
    {"--turns", NULL, take_turns,
     "of one case: print 'ready' when it is verified, then make one timed\n"
     "extraction with a new mesh for every line on standard input and print\n"
     "its milliseconds (line 'second': of --second); at the end of\n"
     "input, print the JSON object, whose extract_ms is of the others"},
    {"--dump", "FILE", take_dump,
     "of one case: write its samples, raw, in native byte order, print their\n"
     "dims and type as a JSON object, and measure nothing"},
    {"--help", NULL, take_help,
     "print this"},
};
/* clang-format on */

#define TABLE_COUNT (sizeof table / sizeof *table)

static int unknown_option(const char *typed) {
    const char *names[TABLE_COUNT];
    for (size_t n = 0; n < TABLE_COUNT; n++) names[n] = table[n].name;
    const char *meant = similar_name(typed, names, TABLE_COUNT);
    return fail(STATUS_USAGE, "there is no option %s; %s%s", typed,
                meant ? "did you mean " : "see 'tetracubes-bench --help'", meant ? meant : "");
}

/* Parses the option at argv[*at] with its value; *at becomes the last argument used. */
static int parse_option(int argc, char **argv, int *at, bench_options *o) {
    char name[64];
    const char *argument = argv[*at], *value = strchr(argument, '=');
    size_t length = value ? (size_t)(value - argument) : strlen(argument);
    snprintf(name, sizeof name, "%.*s", (int)(length < sizeof name ? length : sizeof name - 1), argument);
    for (const option *spec = table; spec < table + TABLE_COUNT; spec++) {
        if (strcmp(spec->name, name) != 0) continue;
        if (!spec->value && value) return fail(STATUS_USAGE, "%s takes no value", spec->name);
        if (!spec->value) return spec->take(NULL, o);
        if (!value && *at + 1 == argc)
            return fail(STATUS_USAGE, "%s needs a value: %s %s", spec->name, spec->name, spec->value);
        return spec->take(value ? value + 1 : argv[++*at], o);
    }
    return unknown_option(name);
}

static void add_defaults(bench_options *o) {
    static const char *const names[] = {"sphere", "gyroid", "marschner-lobb", "noise", "empty", "full"};
    static const int64_t all_sizes[] = {64, 128, 256, 512, 1024};
    static const tc_type types[] = {TC_U8, TC_F32}, sweep_types[] = {TC_U8, TC_U16, TC_F32};
    const int64_t *sizes = o->tune ? all_sizes + 1 : all_sizes;
    if (!o->field_count)
        for (; o->field_count < (o->sweep ? 6 : 2); o->field_count++)
            o->fields[o->field_count] = field_find(names[o->field_count]);
    if (!o->dims_count)
        for (; o->dims_count < (o->sweep ? 5 : o->tune ? 2 : 4); o->dims_count++)
            for (int axis = 0; axis < 3; axis++) o->dims[o->dims_count][axis] = sizes[o->dims_count];
    if (!o->type_count)
        for (; o->type_count < (o->sweep ? 3 : 2); o->type_count++)
            o->types[o->type_count] = o->sweep ? sweep_types[o->type_count] : types[o->type_count];
}

static int check_together(const bench_options *o) {
    if (o->input && o->field_count) return fail(STATUS_USAGE, "--field and --input: give one of them");
    if (o->input && (o->dims_count != o->type_count || o->dims_count > 1))
        return fail(STATUS_USAGE, "--input: raw files need one --dims and one --type, others neither");
    if (o->input && !o->has_iso && !o->dump) return fail(STATUS_USAGE, "--input needs an isovalue, as in --iso 127.5");
    if (o->tune && (o->turns || o->dump))
        return fail(STATUS_USAGE, "--tune and %s: give one of them", o->turns ? "--turns" : "--dump");
    if ((o->turns || o->dump) && !o->input && (o->field_count != 1 || o->dims_count != 1 || o->type_count != 1))
        return fail(STATUS_USAGE, "%s is for one case: give one --field, --dims and --type, or --input",
                    o->turns ? "--turns" : "--dump");
    if (o->sweep && (o->input || o->turns || o->dump))
        return fail(STATUS_USAGE, "--sweep is of fields: it goes with neither --input, --turns nor --dump");
    if (o->has_second && o->second == o->iso)
        return fail(STATUS_USAGE, "--second: %g is the first isovalue, too; give another", o->second);
    return 0;
}

int bench_options_parse(int argc, char **argv, bench_options *o) {
    *o = (bench_options){.repeat = 11, .iso = 127.5};
    for (int at = 1; at < argc; at++) {
        if (argv[at][0] != '-') return fail(STATUS_USAGE, "'%s' is no option; a volume is given by --input", argv[at]);
        int status = parse_option(argc, argv, &at, o);
        if (status) return status;
    }
    int status = o->help ? 0 : check_together(o);
    if (!status && !o->input) add_defaults(o);
    if (!o->has_second) o->second = o->iso == 0.0 ? 1.0 : o->iso + 0.05 * fabs(o->iso);
    return status;
}

void bench_options_help(FILE *out) {
    fprintf(out, "tetracubes-bench [options]: how fast isosurfaces are, beside what the device's memory allows\n"
                 "\n"
                 "Every case is verified first, bit for bit, against the scalar reference. Times are medians;\n"
                 "each is of the first visit of a new grid, whose making is not counted, but for the second:\n"
                 "  new mesh   first launch to mesh complete; the mesh before was destroyed, and the context\n"
                 "             kept its memory (extract_ms)\n"
                 "  kept mesh  the same into the memory of the mesh before (extract_warm_ms); classify and\n"
                 "             emit are its two halves\n"
                 "  second     another isovalue right after that on the same grid, into the same memory\n"
                 "             (second_warm_ms)\n"
                 "  limit      bytes of samples at the device's read bandwidth, plus bytes of the mesh at its\n"
                 "             write bandwidth; the ratio is that of the kept mesh\n"
                 "\n"
                 "  tetracubes-bench\n"
                 "  tetracubes-bench --field gyroid --dims 256 --type u8 --json\n"
                 "  tetracubes-bench --input head.nii.gz --iso 500\n"
                 "  tetracubes-bench --sweep --json --device gpu\n"
                 "  tetracubes-bench --tune --device gpu\n"
                 "\nOptions (* may be given several times; every combination is a case):\n");
    for (const option *spec = table; spec < table + TABLE_COUNT; spec++) {
        char head[32];
        snprintf(head, sizeof head, "%s%s%s", spec->name, spec->value ? " " : "", spec->value ? spec->value : "");
        const char *line = spec->help;
        for (int first = 1; line; first = 0) {
            int length = (int)strcspn(line, "\n");
            fprintf(out, "  %-14s %.*s\n", first ? head : "", length, line);
            line = line[length] ? line + length + 1 : NULL;
        }
    }
    fprintf(out, "\nFields, with x, y, z from -1 to 1:\n");
    for (const field *f = fields; f->name; f++) fprintf(out, "  %-14s %s\n", f->name, f->definition);
    fprintf(out, "\nExit status: 0 done; 1 could not (device, memory); 2 wrong usage; 3 verification failed; 4 bad\n"
                 "input file.\n");
}
