#include "command_run.h"

#include "command_line/option_effects.h"
#include "edge_contraction.h"
#include "exit_status.h"
#include "failure.h"
#include "mesh_write.h"
#include "output.h"
#include "progress.h"
#include "read_formats.h"
#include "terminal/json_report.h"
#include "terminal/notice.h"
#include "terminal/standard_streams.h"
#include "truncation.h"

#include <string.h>

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

void command_help(const command *c, FILE *out) {
    fprintf(out, "%s\n\n%s\n\nOptions:\n", c->usage, c->text);
    options_print(c->bit, out);
    if (c->bit & READS) print_formats("\nInput formats:", out);
    if (c->help) c->help(out);
}

#ifdef HAVE_MESH_WRITE_HDF5
enum { has_hdf5 = 1 };
void writers_add(void) { mesh_write_add_hdf5(); }
#else
enum { has_hdf5 = 0 };
void writers_add(void) {}
#endif

void version_print(const char *program, FILE *out) {
    fprintf(out, "%s %s\n", program, tc_version());
    print_formats("reads:", out);
#define MESH_LABEL(name, label, ...) ", " label
#define COMPLEX_LABEL(name, label)   ", " label
    const char *labels = &MESH_FORMATS(MESH_LABEL)[2];
    const size_t left_out = has_hdf5 ? 0 : sizeof ", VTKHDF" - 1; /* the last */
    fprintf(out, "writes: %.*s; %s (tetrahedra)\n", (int)(strlen(labels) - left_out), labels,
            &COMPLEX_FORMATS(COMPLEX_LABEL)[2]);
    fprintf(out, "pictures: %s\n", HAVE_PNG ? "PNG" : "none, as it was built without libpng");
#if HAVE_MESHOPTIMIZER
    fprintf(out, "simplifies: meshoptimizer %s\n", edge_contraction_version());
#else
    fprintf(out, "simplifies: no, as it was built without meshoptimizer\n");
#endif
}

int command_run(const command *c, int argc, char **argv, int (*parsed)(options *o, int status)) {
    options o;
    int status = options_parse(c->bit, c->name, argc, argv, &o);
    if (parsed) status = parsed(&o, status);
    if (!status && o.help) {
        command_help(c, stdout);
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
