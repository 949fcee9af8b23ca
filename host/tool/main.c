/*
 * main.c - finds the command, hands it its options, prints what went wrong
 *
 * Results go to standard output, everything else to standard error; exit statuses are those of exit_status.h.
 */
#include "command_line/completion.h"
#include "command_line/option_effects.h"
#include "commands.h"
#include "drivers/driver_trial.h"
#include "exit_status.h"
#include "failure.h"
#include "library_status.h"
#include "mesh_write.h"
#include "output.h"
#include "progress.h"
#include "read_formats.h"
#include "selftest/child.h"
#include "similar_name.h"
#include "terminal/json_report.h"
#include "terminal/notice.h"
#include "terminal/standard_streams.h"
#include "truncation.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

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
    {"extract", COMMAND_EXTRACT, extract_run, NULL, "isosurface of a grid, as a triangle mesh",
     "tetracubes extract INPUT... --iso V[,V...] [-o FILE] [options]",
     "Extracts the surface that separates samples >= V from samples below it, by marching\n"
     "tetrahedra, from uniform, rectilinear, curvilinear and unstructured grids. Vertices are\n"
     "shared, triangles face the lower values, and the same input gives the same bytes on every\n"
     "device. Two INPUTs are a Plot3D grid and its solution or function file; - is standard input.\n"
     "What gzip has packed is unpacked into memory.\n"
     "\n"
     "  tetracubes extract head.nii.gz --iso 500 -o skin.ply\n"
     "  tetracubes extract head.nii.gz --iso 500 --preview skin.png\n"
     "  tetracubes extract slices/%04d.tif --spacing 0.2,0.2,1 --iso 90 -o cells.glb\n"
     "  tetracubes extract head.nhdr --iso 500,1150 -o head-%.stl --check\n"
     "  tetracubes extract ct.raw --dims 512,512,300 --type i16 --spacing 0.7,0.7,1 --iso 300 -o ct.ply\n"
     "  tetracubes extract ct.nrrd --iso 300 --roi 100:228,:,40: --step 2,2,1 -o part.ply\n"
     "  tetracubes extract dem.mha --iso 0 --nodata -9999 --verify --json\n"
     "  xz -dc ct.nrrd.xz | tetracubes extract - --iso 300 -o ct.ply\n"
     "  tetracubes extract grid.xyz flow.q --field density --iso 2 --carry energy -o shock.vtp\n"
     "  tetracubes extract engine.vtu --field temperature --iso 400 -o hot.ply"},
    {"info", COMMAND_INFO, info_run, NULL, "what a file holds, and isovalues worth trying",
     "tetracubes info INPUT... [options]",
     "Prints the kind of grid, its sizes and place, cells by type and fields with their ranges, for\n"
     "every block; then, of the one field or the one that --field names, the histogram of the finite\n"
     "samples and isovalues worth trying. Two INPUTs are a Plot3D grid and its solution; - is standard\n"
     "input.\n"
     "\n"
     "  tetracubes info head.nii.gz\n"
     "  tetracubes info head.nii.gz --iso 500 --preview slices.png\n"
     "  tetracubes info engine.vtu --field temperature\n"
     "  tetracubes info ct.raw --dims 512,512,300 --type i16 --json"},
    {"tetrahedralize", COMMAND_TETRAHEDRALIZE, tetrahedralize_run, NULL, "a grid cut into tetrahedra that fit together",
     "tetracubes tetrahedralize INPUT... -o FILE.vtu [options]",
     "Cuts the cells of a grid, structured or not, into a conforming complex of tetrahedra: the one\n"
     "that surfaces are extracted from. All fields at points are written, those of cells averaged;\n"
     "several blocks follow each other in one grid. Cells with a corner where the only field, or the\n"
     "one that --field names, has no value are left out. An INPUT of - is standard input.\n"
     "\n"
     "  tetracubes tetrahedralize engine.vtk -o engine-tetrahedra.vtu\n"
     "  tetracubes tetrahedralize grid.xyz flow.q -o flow.vtu"},
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
     "tetracubes selftest [--device SPEC] [--quick] [--vectors [FILE]] [--json] [--junit FILE]",
     "Extracts small volumes on the device, compares counts with known answers and every byte with\n"
     "the scalar reference: types, sizes, ties, missing data, normals, grids, methods, scan, launches,\n"
     "slabs. With --vectors, compares the meshes of volumes up to 512 x 512 x 512 with hashes instead.\n"
     "A driver that crashes or hangs fails the trial at hand; the others go on.\n"
     "Prints a line per group and PASS or FAIL.\n"
     "\n"
     "  tetracubes selftest --device gpu\n"
     "  tetracubes selftest --quick --timeout 300 --junit selftest.xml\n"
     "  tetracubes selftest --vectors"},
};

#define COMMAND_COUNT (sizeof commands / sizeof *commands)

static void print_overview(FILE *out) {
    fprintf(out, "tetracubes %s: isosurfaces of sampled volumes by marching tetrahedra, on OpenCL devices\n\n",
            tc_version());
    for (size_t n = 0; n < COMMAND_COUNT; n++)
        fprintf(out, "  tetracubes %-14s %s\n", commands[n].name, commands[n].summary);
    fprintf(out, "\n"
                 "  tetracubes COMMAND --help   options and examples\n"
                 "  tetracubes --version        version and file formats\n"
                 "  tetracubes --completion S   completion for the shell S, bash or zsh\n"
                 "\n"
                 "A surface in three steps:\n"
                 "  tetracubes info volume.nrrd\n"
                 "  tetracubes extract volume.nrrd --iso 127.5 -o surface.ply\n"
                 "  tetracubes extract volume.nrrd --iso 127.5 --verify --check\n"
                 "\n"
                 "Environment: TETRACUBES_DEVICE, the device where --device is not given; TETRACUBES_CACHE_DIR,\n"
                 "the folder of built kernels (else $XDG_CACHE_HOME/tetracubes or ~/.cache/tetracubes; empty:\n"
                 "none); POCL_CACHE_DIR, that of PoCL itself.\n"
                 "\n"
                 "Exit status: 0 done; 1 could not (device, memory, output); 2 wrong usage; 3 verification or\n"
                 "check failed; 4 bad input file.\n");
}

/* The formats, in lines that fit a terminal. */
static void print_formats(const char *before, FILE *out) {
    enum { COLUMNS = 92 };
    char text[FORMATS_TEXT];
    const char *word = read_formats_text(text);
    int column = fprintf(out, "%s", before);
    while (*word) {
        int length = (int)strcspn(word, " ");
        if (column + 1 + length > COLUMNS) column = fprintf(out, "\n ") - 1;
        column += fprintf(out, " %.*s", length, word);
        word += length + (word[length] == ' ');
    }
    fputc('\n', out);
}

static void print_command_help(const command *c, FILE *out) {
    fprintf(out, "%s\n\n%s\n\nOptions:\n", c->usage, c->text);
    options_print(c->bit, out);
    if (c->bit & READS) print_formats("\nInput formats:", out);
    if (c->help) c->help(out);
}

#ifdef HAVE_MESH_WRITE_HDF5
enum { has_hdf5 = 1 };
static void add_writers(void) { mesh_write_add_hdf5(); }
#else
enum { has_hdf5 = 0 };
static void add_writers(void) {}
#endif

static void print_version(FILE *out) {
    fprintf(out, "tetracubes %s\n", tc_version());
    print_formats("reads:", out);
#define MESH_LABEL(name, label, ...) ", " label
#define COMPLEX_LABEL(name, label)   ", " label
    const char *labels = &MESH_FORMATS(MESH_LABEL)[2];
    const size_t left_out = has_hdf5 ? 0 : sizeof ", VTKHDF" - 1; /* the last */
    fprintf(out, "writes: %.*s; %s (tetrahedra)\n", (int)(strlen(labels) - left_out), labels,
            &COMPLEX_FORMATS(COMPLEX_LABEL)[2]);
    fprintf(out, "pictures: %s\n", HAVE_PNG ? "PNG" : "none, as it was built without libpng");
}

static const command *find_command(const char *name) {
    for (size_t n = 0; n < COMMAND_COUNT; n++)
        if (strcmp(commands[n].name, name) == 0) return &commands[n];
    return NULL;
}

static int unknown_command(const char *name) {
    const char *names[COMMAND_COUNT];
    for (size_t n = 0; n < COMMAND_COUNT; n++) names[n] = commands[n].name;
    const char *meant = similar_name(name, names, COMMAND_COUNT);
    if (meant) return fail(STATUS_USAGE, "there is no command '%s'; did you mean %s?", name, meant);
    return fail(STATUS_USAGE, "there is no command '%s'; see 'tetracubes --help'", name);
}

static int run_command(const command *c, int argc, char **argv) {
    options o;
    int status = options_parse(c->bit, c->name, argc, argv, &o);
    if (!status && o.help) {
        print_command_help(c, stdout);
    } else if (!status) {
        streams_choose(o.output, o.preview);
        progress_begin(o.quiet);
        json_report_begin();
        notice_begin(o.quiet, o.json);
        output_stop_when(progress_cancelled);
        status = option_effects_check(&o);
        if (!status) status = c->run(&o);
        if (status == STATUS_FAILED && progress_cancelled()) status = progress_status();
        if (status && truncation_seen()) status = truncation_status(); /* whatever came of it */
        progress_clear();
        notice_end();
    }
    options_release(&o);
    return status;
}

static int complete(const char *shell) {
    completion_command known[COMMAND_COUNT];
    for (size_t n = 0; n < COMMAND_COUNT; n++)
        known[n] = (completion_command){commands[n].name, commands[n].summary, commands[n].bit};
    return completion_print(shell, known, COMMAND_COUNT, stdout);
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
    if (strcmp(name, "--completion") == 0)
        return argc == 3 ? complete(argv[2]) : fail(STATUS_USAGE, "--completion needs a shell: bash or zsh");
    if (strcmp(name, TRIAL_COMMAND) == 0 && argc == 3) return trial_child(argv[2]);
    if (strcmp(name, SELFTEST_COMMAND) == 0) return selftest_child(argc - 2, argv + 2);
    const command *c = find_command(wants_help ? argv[2] : name);
    if (!c) return unknown_command(wants_help ? argv[2] : name);
    if (!wants_help) return run_command(c, argc - 2, argv + 2);
    print_command_help(c, stdout);
    return 0;
}

int main(int argc, char **argv) {
    truncation_watch(); /* before drivers start threads and put handlers of their own in front */
    add_writers();
    int status = dispatch(argc, argv);
    int is_written = fflush(stdout) == 0 && !ferror(stdout), error = errno;
    streams_restore();
    const int is_told = status && streams_has_failed();
    if (status) message("%s", failure_text());
    if (!is_written && !is_told) {
        const int lost = streams_fail(error);
        message("%s", failure_text());
        if (!status) status = lost;
    }
    if (driver_is_distrusted()) _exit(status); /* it may crash or hang once more where it tidies up */
    return status;
}
