/*
 * main.c - finds the command, hands it its options, prints what went wrong
 *
 * Results go to standard output, everything else to standard error; exit statuses are those of exit_status.h.
 */
#include "commands.h"
#include "exit_status.h"
#include "failure.h"
#include "nearest.h"
#include "progress.h"
#include "volume.h"

#include <errno.h>
#include <stdarg.h>
#include <string.h>

typedef struct command {
    const char *name;
    enum command_bit bit;
    int (*run)(const options *o);
    void (*help)(FILE *out); /* after the options, or NULL */
    const char *summary;
    const char *usage;
    const char *text;
} command;

static const command commands[] = {
    {"extract", COMMAND_EXTRACT, extract_run, NULL, "isosurface of a volume, as a triangle mesh",
     "tetracubes extract INPUT --iso V[,V...] [-o FILE] [options]",
     "Extracts the surface that separates samples >= V from samples below it, by marching\n"
     "tetrahedra. Vertices are shared, triangles face the lower values, and the same input gives\n"
     "the same bytes on every device.\n"
     "\n"
     "  tetracubes extract head.nii.gz --iso 500 -o skin.ply\n"
     "  tetracubes extract head.nhdr --iso 500,1150 -o head-%.stl --check\n"
     "  tetracubes extract ct.raw --dims 512,512,300 --type i16 --spacing 0.7,0.7,1 --iso 300 -o ct.ply\n"
     "  tetracubes extract dem.mha --iso 0 --nodata -9999 --verify --json"},
    {"info", COMMAND_INFO, info_run, NULL, "what a volume holds, and isovalues worth trying",
     "tetracubes info INPUT [options]",
     "Prints dimensions, type, spacing, the matrix from index space to world space, the range and\n"
     "histogram of the finite samples, and isovalues worth trying.\n"
     "\n"
     "  tetracubes info head.nii.gz\n"
     "  tetracubes info ct.raw --dims 512,512,300 --type i16 --json"},
    {"devices", COMMAND_DEVICES, devices_run, NULL, "every OpenCL device, with the limits that matter",
     "tetracubes devices [--json]",
     "Lists the devices of all OpenCL platforms. --device takes the index in front, the\n"
     "platform:device pair behind it, a type (cpu, gpu) or part of a name."},
    {"generate", COMMAND_GENERATE, generate_run, generate_help, "a volume of an analytic field, to try things on",
     "tetracubes generate FIELD --dims NX,NY,NZ --type T -o FILE [options]",
     "Writes a NRRD file (samples raw, native byte order, aligned so that they can be mapped) or,\n"
     "for an ending of .raw, the samples alone. Coordinate i of n is 2 i / (n - 1) - 1; integer types\n"
     "truncate toward zero and saturate, so that i8 holds no more than 127.\n"
     "\n"
     "  tetracubes generate gyroid --dims 256,256,256 --type u8 -o gyroid.nrrd\n"
     "  tetracubes generate noise --dims 65,33,17 --type f32 --seed 7 -o noise.nrrd"},
    {"selftest", COMMAND_SELFTEST, selftest_run, NULL, "known answers and the reference, on a device",
     "tetracubes selftest [--device SPEC] [--json]",
     "Extracts small volumes on the device, compares counts with known answers and every byte with\n"
     "the scalar reference: sample types, sizes, ties, missing data, normals, launch sizes, slabs.\n"
     "Prints a line per group and PASS or FAIL."},
};

#define COMMAND_COUNT (sizeof commands / sizeof *commands)

static void print_overview(FILE *out) {
    fprintf(out, "tetracubes %s: isosurfaces of sampled volumes by marching tetrahedra, on OpenCL devices\n\n",
            tc_version());
    for (size_t n = 0; n < COMMAND_COUNT; n++)
        fprintf(out, "  tetracubes %-9s %s\n", commands[n].name, commands[n].summary);
    fprintf(out, "\n"
                 "  tetracubes COMMAND --help   options and examples\n"
                 "  tetracubes --version        version and file formats\n"
                 "\n"
                 "A surface in three steps:\n"
                 "  tetracubes info volume.nrrd\n"
                 "  tetracubes extract volume.nrrd --iso 127.5 -o surface.ply\n"
                 "  tetracubes extract volume.nrrd --iso 127.5 --verify --check\n"
                 "\n"
                 "Exit status: 0 done; 1 could not (device, memory, output); 2 wrong usage; 3 verification or\n"
                 "check failed; 4 bad input file.\n");
}

static void print_command_help(const command *c, FILE *out) {
    fprintf(out, "%s\n\n%s\n\nOptions:\n", c->usage, c->text);
    options_print(c->bit, out);
    if (c->bit & (COMMAND_EXTRACT | COMMAND_INFO)) fprintf(out, "\nInput formats: %s\n", volume_formats());
    if (c->help) c->help(out);
}

static void print_version(FILE *out) {
    fprintf(out, "tetracubes %s\nreads: %s\nwrites: PLY, STL, OBJ, VTP\n", tc_version(), volume_formats());
}

void message(const char *format, ...) {
    va_list arguments;
    progress_clear();
    fputs("tetracubes: ", stderr);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

int library_status(tc_status status) {
    switch (status) {
    case TC_OK:
        return 0;
    case TC_ERROR_ARGUMENT:
        return fail(STATUS_USAGE, "%s", tc_message());
    case TC_ERROR_DATA:
        return fail(STATUS_INPUT, "%s", tc_message());
    case TC_ERROR_CANCELLED:
        return progress_cancelled() ? progress_status() : fail(STATUS_FAILED, "%s", tc_message());
    default:
        return fail(STATUS_FAILED, "%s", tc_message());
    }
}

int input_request(const options *o, read_request *request) {
    static const char *const raw[] = {"--type", "--endian", "--skip", "--spacing", "--origin"};
    if (o->operand_count != 1)
        return fail(STATUS_USAGE,
                    o->operand_count ? "%s: one input at a time; '%s' is a second one"
                                     : "%s needs an input file; see 'tetracubes %s --help'",
                    o->command, o->operand_count ? o->operands[1] : o->command);
    int is_raw = options_given(o, "--dims");
    for (size_t n = 0; n < sizeof raw / sizeof *raw; n++)
        if (!is_raw && options_given(o, raw[n]))
            return fail(STATUS_USAGE, "%s describes raw input: give --dims NX,NY,NZ too, or leave it out", raw[n]);
    if (is_raw && o->type < 0) return fail(STATUS_USAGE, "raw input needs --type beside --dims, as in --type u8");
    read_request_init(request, o->operands[0]);
    for (int axis = 0; axis < 3; axis++) {
        request->dims[axis] = o->dims[axis];
        request->spacing[axis] = o->spacing[axis];
        request->origin[axis] = o->origin[axis];
    }
    request->type = o->type;
    request->big_endian = o->big_endian;
    request->skip = o->skip;
    request->component = o->component;
    request->frame = o->frame;
    return 0;
}

static const command *find_command(const char *name) {
    for (size_t n = 0; n < COMMAND_COUNT; n++)
        if (strcmp(commands[n].name, name) == 0) return &commands[n];
    return NULL;
}

static int unknown_command(const char *name) {
    const char *names[COMMAND_COUNT];
    for (size_t n = 0; n < COMMAND_COUNT; n++) names[n] = commands[n].name;
    const char *meant = nearest_name(name, names, COMMAND_COUNT);
    if (meant) return fail(STATUS_USAGE, "there is no command '%s'; did you mean %s?", name, meant);
    return fail(STATUS_USAGE, "there is no command '%s'; see 'tetracubes --help'", name);
}

static int run_command(const command *c, int argc, char **argv) {
    options o;
    int status = options_parse(c->bit, c->name, argc, argv, &o);
    if (!status && o.help) {
        print_command_help(c, stdout);
    } else if (!status) {
        progress_begin(o.quiet);
        status = c->run(&o);
        progress_clear();
    }
    options_release(&o);
    return status;
}

static int dispatch(int argc, char **argv) {
    if (argc < 2) {
        print_overview(stderr);
        return fail(STATUS_USAGE, "which command?");
    }
    const char *name = argv[1];
    int wants_help = strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0;
    if (wants_help && argc == 2) {
        print_overview(stdout);
        return 0;
    }
    if (strcmp(name, "--version") == 0) {
        print_version(stdout);
        return 0;
    }
    const command *c = find_command(wants_help ? argv[2] : name);
    if (!c) return unknown_command(wants_help ? argv[2] : name);
    if (!wants_help) return run_command(c, argc - 2, argv + 2);
    print_command_help(c, stdout);
    return 0;
}

int main(int argc, char **argv) {
    int status = dispatch(argc, argv);
    if (status) message("%s", failure_text());
    if (fflush(stdout) || ferror(stdout)) {
        message("could not write the results to standard output: %s", strerror(errno));
        return status ? status : STATUS_FAILED;
    }
    return status;
}
