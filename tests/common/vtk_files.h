/*
 * vtk_files.h - arrays of written VTK XML files, found by a search that shares nothing with the writers and reader
 *
 * What is not as it should be is an EXPECT that fails, and the array is then empty.
 */
#ifndef VTK_FILES_H
#define VTK_FILES_H

#include "expect.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct vtk_values {
    char type[16];
    int components;
    uint64_t bytes;
    const char *data; /* NULL: there is no such array */
} vtk_values;

static inline vtk_values vtk_find(const char *text, size_t size, const char *name) {
    static const char marker[] = "<AppendedData encoding=\"raw\">\n", end[] = "\n  </AppendedData>\n</VTKFile>\n";
    vtk_values found = {.components = 0};
    char wanted[256], format[64];
    snprintf(wanted, sizeof wanted, "Name=\"%s\" ", name);
    const char *appended = strstr(text, marker), *at = strstr(text, wanted);
    if (!appended || !at || at > appended) return found;
    while (strncmp(at, "<DataArray ", 11) != 0) at--;
    unsigned long long offset;
    int good = sscanf(at, "<DataArray type=\"%15[A-Za-z0-9]\"", found.type) == 1;
    at = strstr(at, wanted) + strlen(wanted);
    good = good && sscanf(at, "NumberOfComponents=\"%d\" format=\"%15[a-z]\" offset=\"%llu\"/>", &found.components,
                          format, &offset) == 3;
    EXPECT(good && strcmp(format, "appended") == 0, "element of array %s: %.100s", name, at);
    if (!good) return found;

    for (appended += strlen(marker); *appended == ' '; appended++) continue;
    size_t begin = (size_t)(appended - text) + 1 + (size_t)offset, tail = strlen(end);
    uint64_t bytes = 0;
    good = *appended == '_' && begin + 8 <= size;
    if (good) memcpy(&bytes, text + begin, 8);
    good = good && size > tail && bytes <= size - tail - begin - 8 && memcmp(text + size - tail, end, tail) == 0;
    EXPECT(good, "appended data of array %s at %llu: %llu bytes", name, offset, (unsigned long long)bytes);
    if (!good) return found;
    found.bytes = bytes;
    found.data = text + begin + 8;
    return found;
}

/* Index i of an array of Int32 or Int64. */
static inline int64_t vtk_index(const vtk_values *v, uint64_t i) {
    int32_t narrow;
    int64_t wide;
    if (strcmp(v->type, "Int64") == 0) {
        memcpy(&wide, v->data + 8 * i, 8);
        return wide;
    }
    memcpy(&narrow, v->data + 4 * i, 4);
    return narrow;
}

static inline size_t vtk_index_bytes(const vtk_values *v) { return strcmp(v->type, "Int64") == 0 ? 8 : 4; }

/* Whether the array has the type, and as many values of these bytes. */
static inline int vtk_holds(const vtk_values *v, const char *type, int components, const void *values, uint64_t bytes) {
    return v->data && strcmp(v->type, type) == 0 && v->components == components && v->bytes == bytes &&
           (bytes == 0 || memcmp(v->data, values, bytes) == 0);
}

/* The number in front of `name` in the file's Piece. */
static inline uint64_t vtk_count(const char *text, const char *name) {
    const char *at = strstr(text, name);
    return at ? strtoull(at + strlen(name) + 2, NULL, 10) : UINT64_MAX;
}

#endif
