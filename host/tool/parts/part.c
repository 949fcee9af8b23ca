#include "part.h"

#include "exit_status.h"
#include "failure.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int part_open(const char *path, part *p) {
    *p = (part){.path = path};
    int status = mapping_open(path, &p->m);
    if (!status) status = part_header_read(path, p->m.bytes, p->m.size, &p->header, &p->header_bytes);
    if (!status) status = part_layout_make(path, &p->header, p->header_bytes, &p->layout);
    if (status || p->m.size == p->layout.file_bytes) return status;
    return fail(STATUS_INPUT, "%s: %s: it has %zu bytes, not the %llu of this part: make it anew", path,
                p->m.size < p->layout.file_bytes ? "cut short" : "too long", p->m.size,
                (unsigned long long)p->layout.file_bytes);
}

void part_close(part *p) {
    mapping_close(&p->m);
    part_layout_release(&p->layout);
    part_header_release(&p->header);
}

/* ------------------------------------------------------------------------------------------------------ one surface */

static int surfaces_differ(const part *p, const part *first, const char *key) {
    char *own = json_dumps(json_object_get(p->header.surface, key), JSON_ENCODE_ANY);
    char *other = json_dumps(json_object_get(first->header.surface, key), JSON_ENCODE_ANY);
    const int is_input = strcmp(key, "input") == 0;
    const int status = is_input ? fail(STATUS_INPUT, "%s is a part of another volume than %s: join parts of one volume",
                                       p->path, first->path)
                                : fail(STATUS_INPUT, "%s and %s are no parts of one surface: \"%s\" is %s and %s",
                                       p->path, first->path, key, own ? own : "missing", other ? other : "missing");
    free(own);
    free(other);
    return status;
}

/* All that the parts say of their surface is the same, each way round. */
static int check_surface(const part *p, const part *first) {
    const part *sides[2] = {first, p};
    for (int side = 0; side < 2; side++) {
        const char *key;
        json_t *value;
        json_object_foreach(sides[side]->header.surface, key, value) {
            if (!json_equal(value, json_object_get(sides[!side]->header.surface, key)))
                return surfaces_differ(p, first, key);
        }
    }
    return 0;
}

static int check_origin(const part *p, const part **known) {
    if (!p->header.has_origin) return 0;
    if (!*known) *known = p;
    const double *own = p->header.origin, *other = (*known)->header.origin;
    if (own[0] == other[0] && own[1] == other[1] && own[2] == other[2]) return 0;
    return fail(STATUS_INPUT, "%s is a part of another volume than %s: their origins differ", p->path, (*known)->path);
}

static int by_number(const void *a, const void *b) {
    const int64_t first = ((const part *)a)->header.number, second = ((const part *)b)->header.number;
    return first < second ? -1 : first > second;
}

/* Names numbers from `first` to before `end`, none of which is there. */
static int missing(const part *of, int64_t first, int64_t end) {
    char last[32] = "";
    if (end > first + 1) snprintf(last, sizeof last, " to %lld", (long long)end - 1);
    return fail(STATUS_INPUT, "of the %lld parts that %s is one of, number %lld%s is missing: name all of them",
                (long long)of->header.count, of->path, (long long)first, last);
}

static int check_numbers(const part *parts, size_t count) {
    int64_t next = 0;
    for (size_t n = 0; n < count; n++) {
        const int64_t number = parts[n].header.number;
        if (number > next) return missing(&parts[n], next, number);
        if (number < next)
            return fail(STATUS_INPUT, "part %lld of %lld is given twice: %s and %s", (long long)number,
                        (long long)parts[n].header.count, parts[n - 1].path, parts[n].path);
        next = number + 1;
    }
    return next < parts[0].header.count ? missing(&parts[0], next, parts[0].header.count) : 0;
}

/* Where one ends the next one begins. */
static int check_planes(const part *parts, size_t count) {
    for (size_t n = 1; n < count; n++) {
        const int64_t end = parts[n - 1].header.planes[1], begin = parts[n].header.planes[0];
        if (begin != end)
            return fail(STATUS_INPUT,
                        "%s begins at plane %lld, but %s ends at %lld: parts of one surface need one --cut",
                        parts[n].path, (long long)begin, parts[n - 1].path, (long long)end);
    }
    return 0;
}

int parts_sort(part *parts, size_t count) {
    const part *known = NULL;
    for (size_t n = 1; n < count; n++) {
        int status = check_surface(&parts[n], &parts[0]);
        if (!status && parts[n].header.count != parts[0].header.count)
            status =
                fail(STATUS_INPUT, "%s is one of %lld parts, %s one of %lld: join those of one number", parts[n].path,
                     (long long)parts[n].header.count, parts[0].path, (long long)parts[0].header.count);
        if (status) return status;
    }
    qsort(parts, count, sizeof *parts, by_number);
    for (size_t n = 0; n < count; n++) {
        const int status = check_origin(&parts[n], &known);
        if (status) return status;
    }
    const int status = check_numbers(parts, count);
    return status ? status : check_planes(parts, count);
}
