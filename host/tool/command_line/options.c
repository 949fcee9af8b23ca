/*
 * options.c - the command line against the table of options
 *
 * Values follow as the next argument or after '='.
 */
#include "options.h"

#include "dataset/request.h"
#include "exit_status.h"
#include "failure.h"
#include "option_table.h"
#include "parse_value.h"
#include "similar_name.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The row of the table for the first `length` characters of the argument; NULL where the command has none. */
static const option *find(enum command_bit command, const char *argument, size_t length) {
    for (const option *spec = option_table; spec < option_table + option_table_count; spec++) {
        if (!(spec->commands & command)) continue;
        const char *names[] = {spec->name, spec->short_name};
        for (int n = 0; n < 2; n++)
            if (names[n] && strlen(names[n]) == length && strncmp(names[n], argument, length) == 0) return spec;
    }
    return NULL;
}

static int unknown_option(enum command_bit command, const char *name, const char *argument, size_t length) {
    const char *names[OPTION_TABLE_MOST] = {NULL};
    char typed[64];
    snprintf(typed, sizeof typed, "%.*s", (int)(length < sizeof typed ? length : sizeof typed - 1), argument);
    for (size_t n = 0; n < option_table_count; n++)
        names[n] = option_table[n].commands & command ? option_table[n].name : NULL;
    if (find(~(enum command_bit)0, typed, strlen(typed)))
        return fail(STATUS_USAGE, "%s has no option %s, as other commands have; see 'tetracubes %s --help'", name,
                    typed, name);
    if (typed[1] != '-' && find(command, typed, 2))
        return fail(STATUS_USAGE, "%s has no option %s; did you mean %.2s %s?", name, typed, typed, typed + 2);
    const char *meant = similar_name(typed, names, option_table_count);
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
    const size_t row = (size_t)(spec - option_table);
    const uint64_t bit = (uint64_t)1 << row % 64;
    if (o->given[row / 64] & bit && spec->kind != VALUE_NONE && spec->kind != VALUE_ISOVALUES &&
        spec->kind != VALUE_INTERVALS)
        return fail(STATUS_USAGE, "%s is given twice: leave one out", spec->name);
    o->given[row / 64] |= bit;
    return parse_value(spec, value, o);
}

int options_parse(enum command_bit command, const char *name, int argc, char **argv, options *o) {
    *o = (options){.command = name,
                   .bit = command,
                   .component = COMPONENT_OPEN,
                   .frame = -1,
                   .snap = -1,
                   .type = -1,
                   .view = VIEW_DEFAULT,
                   .preview_size = {1024, 768},
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
    free(o->cut.planes);
    free(o->labels);
    free(o->ranges);
    free(o->operands);
    *o = (options){0};
}

int options_given(const options *o, const char *name) {
    for (size_t n = 0; n < option_table_count; n++)
        if (o->given[n / 64] >> n % 64 & 1 && strcmp(option_table[n].name, name) == 0) return 1;
    return 0;
}

int options_view(enum command_bit command, size_t n, option_view *out) {
    for (const option *spec = option_table; spec < option_table + option_table_count; spec++) {
        if (!(spec->commands & command) || n--) continue;
        const int takes_file = spec->value && strcmp(spec->value, "FILE") == 0;
        *out = (option_view){spec->name, spec->short_name, spec->value, spec->help, spec->choices, takes_file};
        return 1;
    }
    return 0;
}

void options_print(enum command_bit command, FILE *out) {
    for (const option *spec = option_table; spec < option_table + option_table_count; spec++) {
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
