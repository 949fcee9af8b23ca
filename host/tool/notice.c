#include "notice.h"

#include "commands.h"
#include "report.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static struct {
    int quiet, json;
    char **texts;
    size_t count;
    int lost; /* there was no memory for one */
} state;

void notice_begin(int quiet, int json) {
    notice_end();
    state.quiet = quiet;
    state.json = json;
}

int notice_wanted(void) { return !state.quiet || state.json; }

/* Takes the text over. */
static void keep(char *text) {
    char **grown = realloc(state.texts, (state.count + 1) * sizeof *grown);
    if (grown) {
        state.texts = grown;
        state.texts[state.count++] = text;
    } else {
        state.lost = 1;
        free(text);
    }
}

void notice(const char *format, ...) {
    char *text;
    va_list arguments;
    if (!notice_wanted()) return;
    va_start(arguments, format);
    int length = vasprintf(&text, format, arguments);
    va_end(arguments);
    if (length < 0) {
        state.lost = 1;
        return;
    }
    if (!state.quiet) message("%s", text);
    if (state.json)
        keep(text);
    else
        free(text);
}

json_t *notices_json(void) {
    json_t *array = state.lost ? NULL : json_array();
    for (size_t n = 0; array && n < state.count; n++) json_array_append_new(array, report_string(state.texts[n]));
    return array;
}

void notice_end(void) {
    for (size_t n = 0; n < state.count; n++) free(state.texts[n]);
    free(state.texts);
    state.texts = NULL;
    state.count = 0;
    state.lost = 0;
}
