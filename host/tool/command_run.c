#include "command_run.h"

#include "command_line/option_effects.h"
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

void version_print(const char *program, FILE *out) {
    fprintf(out, "%s %s\n", program, tc_version());
    print_formats("reads:", out);
#define MESH_LABEL(name, label, ...) ", " label
#define COMPLEX_LABEL(name, label)   ", " label
    fprintf(out, "writes: %s; %s (tetrahedra)\n", &MESH_FORMATS(MESH_LABEL)[2], &COMPLEX_FORMATS(COMPLEX_LABEL)[2]);
}

int command_run(const command *c, int argc, char **argv, int (*parsed)(options *o, int status)) {
    options o;
    int status = options_parse(c->bit, c->name, argc, argv, &o);
    if (parsed) status = parsed(&o, status);
    if (!status && o.help) {
        command_help(c, stdout);
    } else if (!status) {
        streams_choose(o.output);
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
