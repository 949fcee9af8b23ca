#include "notice.h"

#include "control.h"
#include "json_report.h"
#include "progress.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static struct {
    int quiet, json;
    json_t *texts; /* of a JSON report */
} state;

void message(const char *format, ...) {
    char text[8192]; /* no memory is asked for: there may be none */
    va_list arguments;
    progress_clear();
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    control_mask(text, 1);
    fprintf(stderr, "tetracubes: %s\n", text);
}

void notice_begin(int quiet, int json) {
    notice_end();
    state.quiet = quiet;
    state.json = json;
    if (json) state.texts = json_array();
}

int notice_wanted(void) { return !state.quiet || state.json; }

void notice(const char *format, ...) {
    char *text;
    va_list arguments;
    if (!notice_wanted()) return;
    va_start(arguments, format);
    int length = vasprintf(&text, format, arguments);
    va_end(arguments);
    if (length < 0) {
        json_report_spoil();
        return;
    }
    if (!state.quiet) message("%s", text);
    if (state.json) json_array_append_new(state.texts, string_json(text));
    free(text);
}

json_t *notices_json(void) { return json_incref(state.texts); }

void notice_end(void) {
    json_decref(state.texts);
    state.texts = NULL;
}
