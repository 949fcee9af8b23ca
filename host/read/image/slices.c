/* slices.c - volumes in files of slices; see slices.h */
#include "image/slices.h"

#include "exit_status.h"
#include "failure.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

enum { DIGITS_MOST = 9, SLICES_MOST = 1000000 };

/* A name with a number: what stands before and behind it, and its least digits. */
typedef struct numbered {
    const char *before, *behind; /* of the last part of the path */
    size_t before_length;
    int digits;
} numbered;

static const char *name_of(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* Finds %d, or %3d and %03d, in the last part of the path. Returns 0 where there is none. */
static int find_number(const char *path, numbered *n) {
    const char *name = name_of(path);
    for (const char *at = strchr(name, '%'); at; at = strchr(at + 1, '%')) {
        const size_t length = strspn(at + 1, "0123456789");
        if (at[1 + length] != 'd' || length > 2) continue;
        *n = (numbered){name, at + length + 2, (size_t)(at - name), length ? (int)strtol(at + 1, NULL, 10) : 1};
        return n->digits <= DIGITS_MOST;
    }
    return 0;
}

int slices_are_named(const char *path) {
    struct stat about;
    numbered n;
    if (stat(path, &about) == 0) return S_ISDIR(about.st_mode);
    return find_number(path, &n);
}

/* The number in a file's name; -1 where the name is another. */
static int64_t number_in(const numbered *n, const char *name) {
    if (strncmp(name, n->before, n->before_length) != 0) return -1;
    const char *at = name + n->before_length;
    const size_t length = strspn(at, "0123456789");
    if (length < (size_t)n->digits || length > DIGITS_MOST || strcmp(at + length, n->behind) != 0) return -1;
    return strtoll(at, NULL, 10);
}

static int has_ending(const char *name, const char *ending) {
    const size_t length = strlen(name), tail = strlen(ending);
    return length > tail && strcasecmp(name + length - tail, ending) == 0;
}

static int is_tiff_name(const char *name) {
    return name[0] != '.' && (has_ending(name, ".tif") || has_ending(name, ".tiff"));
}

static int no_memory(const char *path) {
    return fail(STATUS_FAILED, "%s: no memory for the names of its slices", path);
}

/* Adds folder/name. */
static int add(const char *path, const char *folder, const char *name, slice_list *list) {
    if (list->count == SLICES_MOST)
        return fail(STATUS_INPUT, "%s: has more than %d slices; name a part of them", path, SLICES_MOST);
    if (list->count == list->capacity) {
        const size_t capacity = list->capacity ? 2 * list->capacity : 64;
        char **paths = realloc(list->paths, capacity * sizeof *paths);
        if (!paths) return no_memory(path);
        list->paths = paths;
        list->capacity = capacity;
    }
    if (asprintf(&list->paths[list->count], "%s%s", folder, name) < 0) return no_memory(path);
    list->count++;
    return 0;
}

/* Runs of digits by their numbers, which may have any number of digits, else by characters. */
static int compare_names(const void *first, const void *second) {
    const char *a = *(char *const *)first, *b = *(char *const *)second;
    while (*a && *b) {
        if (isdigit((unsigned char)*a) && isdigit((unsigned char)*b)) {
            while (*a == '0') a++;
            while (*b == '0') b++;
            const size_t digits = strspn(a, "0123456789"), other = strspn(b, "0123456789");
            const int order = digits != other ? (digits > other) - (digits < other) : strncmp(a, b, digits);
            if (order) return order;
            a += digits;
            b += other;
        } else {
            if (*a != *b) return (unsigned char)*a - (unsigned char)*b;
            a++;
            b++;
        }
    }
    return *a || *b ? (unsigned char)*a - (unsigned char)*b : strcmp(*(char *const *)first, *(char *const *)second);
}

/* The numbers of sorted names have to follow each other. */
static int check_numbers(const char *path, const numbered *n, const slice_list *list) {
    for (size_t s = 1; s < list->count; s++) {
        const int64_t before = number_in(n, name_of(list->paths[s - 1])), own = number_in(n, name_of(list->paths[s]));
        if (own != before + 1)
            return fail(STATUS_INPUT, "%s: has slices %" PRId64 " and %" PRId64 ", but none between them", path, before,
                        own);
    }
    return 0;
}

int slices_list(const char *path, slice_list *list) {
    numbered n = {NULL, NULL, 0, 0};
    struct stat about;
    char folder[4096];
    const int is_folder = stat(path, &about) == 0 && S_ISDIR(about.st_mode);
    *list = (slice_list){NULL, 0, 0};
    if (!is_folder && !find_number(path, &n)) return fail(STATUS_INPUT, "%s: names no slices", path);
    const size_t length = is_folder ? strlen(path) : (size_t)(name_of(path) - path);
    const int ends_open = is_folder && path[length - 1] != '/';
    if (length + 2 > sizeof folder) return fail(STATUS_INPUT, "%.100s...: is too long a name", path);
    snprintf(folder, sizeof folder, "%.*s%s", (int)length, path, ends_open ? "/" : "");
    DIR *open = opendir(*folder ? folder : ".");
    if (!open) return fail(STATUS_INPUT, "%s: its folder cannot be read: %s", path, strerror(errno));
    int status = 0;
    for (struct dirent *entry; !status && (entry = readdir(open));)
        if (is_folder ? is_tiff_name(entry->d_name) : number_in(&n, entry->d_name) >= 0)
            status = add(path, folder, entry->d_name, list);
    closedir(open);
    if (status) return status;
    if (!list->count)
        return fail(STATUS_INPUT,
                    is_folder ? "%s: is a folder without slices, files that end in .tif or .tiff"
                              : "%s: cannot be opened: there is no file of such a name, with a number for %%d",
                    path);
    qsort(list->paths, list->count, sizeof *list->paths, compare_names);
    return is_folder ? 0 : check_numbers(path, &n, list);
}

/* Where the last number of a name begins and ends; 0: it has none, or too long a one. */
static int last_number(const char *name, numbered *n) {
    size_t end = strlen(name);
    while (end && !isdigit((unsigned char)name[end - 1])) end--;
    size_t begin = end;
    while (begin && isdigit((unsigned char)name[begin - 1])) begin--;
    *n = (numbered){name, name + end, begin, 1};
    return end > begin && end - begin <= DIGITS_MOST;
}

int slices_have_gap(const slice_list *list, int64_t gap[2]) {
    numbered n;
    int64_t least = INT64_MAX;
    if (list->count < 3 || !last_number(name_of(list->paths[0]), &n)) return 0;
    for (size_t s = 1; s < list->count; s++) {
        const int64_t before = number_in(&n, name_of(list->paths[s - 1])), own = number_in(&n, name_of(list->paths[s]));
        if (before < 0 || own <= before) return 0;
        if (own - before < least) least = own - before;
    }
    for (size_t s = 1; s < list->count; s++) {
        gap[0] = number_in(&n, name_of(list->paths[s - 1])), gap[1] = number_in(&n, name_of(list->paths[s]));
        if (gap[1] - gap[0] != least) return 1;
    }
    return 0;
}

void slices_release(slice_list *list) {
    for (size_t s = 0; s < list->count; s++) free(list->paths[s]);
    free(list->paths);
    *list = (slice_list){NULL, 0, 0};
}
