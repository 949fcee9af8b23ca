/* data_names.c - the files that a detached header names; see data_names.h */
#include "dataset/data_names.h"

#include "exit_status.h"
#include "failure.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAMES_MAX = 1000000, NAME_BYTES = 4096, ALL_NAMES_BYTES = 16 << 20, NUMBER_MAX = 1000000000 };

/* Whether a part of the path between slashes is "..". */
static int has_parent(const char *name) {
    for (const char *part = name; part; part = strchr(part, '/'), part = part ? part + 1 : NULL)
        if (part[0] == '.' && part[1] == '.' && (part[2] == '/' || !part[2])) return 1;
    return 0;
}

int data_names_add(data_names *names, const char *header_path, const char *name) {
    if (mapping_is_stream(header_path))
        return fail(STATUS_INPUT,
                    "%s: names a data file, '%.200s', and nothing lies beside %s: give the header's own name",
                    header_path, name, mapping_is_standard_input(header_path) ? "standard input" : "a pipe");
    size_t length = strlen(name);
    if (!length || length >= NAME_BYTES)
        return fail(STATUS_INPUT, "%s: names a data file of %zu characters; 1 to %d are possible", header_path, length,
                    NAME_BYTES - 1);
    if (name[0] == '/' || has_parent(name))
        return fail(
            STATUS_INPUT,
            "%s: names the data file '%s'; only files in the header's own folder or below are read (no absolute "
            "path, no '..'): move the data and correct the name",
            header_path, name);
    if (names->count >= NAMES_MAX)
        return fail(STATUS_INPUT, "%s: names more than %d data files", header_path, NAMES_MAX);
    if ((names->bytes += length) > ALL_NAMES_BYTES)
        return fail(STATUS_INPUT, "%s: names data files by more than %d characters in all; name fewer, or shorter ones",
                    header_path, ALL_NAMES_BYTES);

    const char *slash = strrchr(header_path, '/');
    size_t folder = slash ? (size_t)(slash - header_path) + 1 : 0;
    if (names->count == names->capacity) {
        int64_t capacity = names->capacity ? 2 * names->capacity : 64;
        char **more = realloc(names->paths, (size_t)capacity * sizeof *more);
        if (!more) return fail(STATUS_FAILED, "%s: out of memory for the names of its data files", header_path);
        names->paths = more;
        names->capacity = capacity;
    }
    char *path = malloc(folder + length + 1);
    if (!path) return fail(STATUS_FAILED, "%s: out of memory for the names of its data files", header_path);
    memcpy(path, header_path, folder);
    memcpy(path + folder, name, length + 1);
    names->paths[names->count++] = path;
    return 0;
}

int data_names_list(data_names *names, header_text *header) {
    char line[HEADER_LINE_BYTES];
    int more, status;
    while ((status = header_line(header, line, &more)) == 0 && more)
        if (*line && (status = data_names_add(names, header->path, line))) return status;
    if (!status && !names->count)
        status = fail(STATUS_INPUT, "%s: announces a list of data files, but no name follows", header->path);
    return status;
}

/* Finds the one conversion %[0][width]d; returns its end, or NULL. */
static const char *find_conversion(const char *pattern, const char **start, int *zeros, int *width) {
    *start = strchr(pattern, '%');
    if (!*start) return NULL;
    const char *at = *start + 1;
    *zeros = *at == '0';
    while (*at == '0') at++;
    for (*width = 0; isdigit((unsigned char)*at) && *width <= 64; at++) *width = *width * 10 + (*at - '0');
    if (*width > 64 || (*at != 'd' && *at != 'i' && *at != 'u') || strchr(at, '%')) return NULL;
    return at + 1;
}

int data_names_is_pattern(const char *text) {
    const char *percent = strchr(text, '%'), *last = strrchr(text, ' '), *tab = strrchr(text, '\t');
    int64_t number;
    if (tab && (!last || tab > last)) last = tab;
    return percent && last && percent < last && parse_integers(last, &number, 1) == 1;
}

int data_names_pattern(data_names *names, const char *header_path, const char *text, int64_t *axes_per_file) {
    char copy[HEADER_LINE_BYTES];
    snprintf(copy, sizeof copy, "%s", text);
    char *rest = copy, *pattern = next_word(&rest);
    const char *start = NULL, *end = NULL;
    int zeros = 0, width = 0;
    int64_t range[4] = {0, 0, 1, 0};
    int given = pattern ? parse_integers(rest, range, 4) : -1;
    if (pattern) end = find_conversion(pattern, &start, &zeros, &width);
    if (!end || given < 2)
        return fail(STATUS_INPUT,
                    "%s: data file '%s' is no pattern that can be read; write NAME.%%d FIRST LAST STEP with one %%d, "
                    "which may have a 0 and a width",
                    header_path, text);
    if (given == 4) *axes_per_file = range[3];
    int is_sane = range[2] != 0;
    for (int i = 0; i < 3; i++) is_sane &= range[i] > -NUMBER_MAX && range[i] < NUMBER_MAX;
    int64_t span = is_sane ? range[1] - range[0] : 0;
    if (!is_sane || (span && (span > 0) != (range[2] > 0)) || span / range[2] >= NAMES_MAX)
        return fail(STATUS_INPUT, "%s: data files %" PRId64 " to %" PRId64 " by %" PRId64 " are none or too many",
                    header_path, range[0], range[1], range[2]);
    int64_t count = span / range[2] + 1;
    for (int64_t i = 0; i < count; i++) {
        char name[HEADER_LINE_BYTES + 96];
        int64_t value = range[0] + i * range[2];
        int length = (int)(start - pattern);
        snprintf(name, sizeof name, zeros ? "%.*s%0*" PRId64 "%s" : "%.*s%*" PRId64 "%s", length, pattern, width, value,
                 end);
        int status = data_names_add(names, header_path, name);
        if (status) return status;
    }
    return 0;
}

/* The folder of a path, no links left in it, to be freed; NULL, with errno, where there is none. */
static char *real_folder(const char *path) {
    const char *slash = strrchr(path, '/');
    char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
    char *real = folder ? realpath(folder, NULL) : NULL;
    int error = errno;
    free(folder);
    errno = error;
    return real;
}

static int lies_in(const char *file, const char *folder) {
    size_t length = strlen(folder);
    return strncmp(file, folder, length) == 0 && (!file[length] || file[length] == '/' || length == 1);
}

/* 0 where the name leads into the folder that the header is named in, or into the one that it lies in. */
static int check_links(const char *header_path, const char *path) {
    char *file = NULL, *header = NULL, *named = NULL, *real = NULL;
    errno = 0;
    int is_found = (file = realpath(path, NULL)) && (header = realpath(header_path, NULL)) &&
                   (named = real_folder(header_path)) && (real = real_folder(header));
    int status = 0;
    if (!is_found && errno == ENOMEM)
        status = fail(STATUS_FAILED, "%s: no memory to find out where it lies", path);
    else if (!is_found)
        status = fail(STATUS_INPUT, "%s: cannot be opened: %s", path, strerror(errno));
    else if (!lies_in(file, named) && !lies_in(file, real))
        status = fail(STATUS_INPUT,
                      "%s: a symbolic link leads it to %s, out of the folder of its header %s; only files in the "
                      "header's own folder or below are read: put the data itself there",
                      path, file, header_path);
    free(file);
    free(header);
    free(named);
    free(real);
    return status;
}

int data_names_open(const char *header_path, const char *path, dataset *out, mapping *m) {
    *m = (mapping){0};
    int status = check_links(header_path, path);
    if (!status && mapping_is_stream(path)) /* a pipe could be waited for without end */
        status = fail(STATUS_INPUT, "%s: is not a regular file, as data files have to be", path);
    return status ? status : dataset_map(out, path, m);
}

void data_names_cut(data_names *names, int64_t count) {
    while (names->count > count) free(names->paths[--names->count]);
}

void data_names_release(data_names *names) {
    data_names_cut(names, 0);
    free(names->paths);
    *names = (data_names){0};
}
