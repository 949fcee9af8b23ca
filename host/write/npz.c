/*
 * npz.c - arrays of numpy in an archive, as numpy.savez writes them and numpy.load reads them
 *
 *     vertices    float32 (n, 3), x y z; float64 where the mesh lies far from zero
 *     faces       uint32 (m, 3)
 *     normals     float32 (n, 3), where the mesh has them
 *     boundary_labels    uint32 (m, 2), of a label map
 *     fields      float32 (n) or (n, components), by their names of letters, digits and '_'
 *
 * Source: "The .npy format", numpy.lib.format: version 1.0, whose header ends at a multiple of 64 bytes.
 */
#include "value_names.h"
#include "zip.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

enum { HEADER_MOST = 256, ALIGNMENT = 64, BEFORE = 10 };

static const char *const own[] = {"vertices", "faces", "normals", "boundary_labels", NULL};

/* Magic, version, length, and the dictionary with what fills it up. */
static size_t make_header(unsigned char header[HEADER_MOST], const char *type, uint64_t rows, int columns) {
    char shape[64], text[HEADER_MOST];
    if (columns > 1)
        snprintf(shape, sizeof shape, "%llu, %d", (unsigned long long)rows, columns);
    else
        snprintf(shape, sizeof shape, "%llu,", (unsigned long long)rows);
    const size_t used = (size_t)snprintf(text, sizeof text, "{'descr': '<%s', 'fortran_order': False, 'shape': (%s), }",
                                         type, shape),
                 total = (BEFORE + used + ALIGNMENT) / ALIGNMENT * ALIGNMENT, length = total - BEFORE;
    memcpy(header, "\x93NUMPY\1", 8);
    header[BEFORE - 2] = (unsigned char)length;
    header[BEFORE - 1] = (unsigned char)(length >> 8);
    memset(header + BEFORE, ' ', length);
    memcpy(header + BEFORE, text, used);
    header[total - 1] = '\n';
    return total;
}

static void add_array(zip_file *z, const char *name, const char *type, int columns, const record_array *records) {
    unsigned char header[HEADER_MOST];
    char file_name[ZIP_NAME_MOST];
    snprintf(file_name, sizeof file_name, "%s.npy", name);
    const size_t length = make_header(header, type, records->span.count, columns);
    zip_add(z, file_name, header, length, records);
}

void npz_write(output *o, const shown_mesh *s) {
    zip_file z = {.o = o, .members = malloc(((size_t)s->array_count + 3) * sizeof *z.members)};
    value_name *names = malloc(((size_t)s->array_count + 1) * sizeof *names);
    size_t named = 0;
    if (z.members && names) {
        const record_array positions = records_of_positions(s, s->is_moved), triangles = records_of_triangles(s);
        add_array(&z, own[0], s->is_moved ? "f8" : "f4", 3, &positions);
        add_array(&z, own[1], "u4", 3, &triangles);
        for (int n = 0; n < s->array_count; n++) {
            const shown_array shown = {s, s->arrays[n]};
            const record_array records = records_of_values(&shown);
            const int is_normals = s->arrays[n].role == ROLE_NORMALS;
            if (!is_normals) value_name_make(s->arrays[n].name, "", own, names, named++);
            add_array(&z, is_normals ? own[2] : names[named - 1], "f4", s->arrays[n].components, &records);
        }
        if (s->labels) {
            const record_array labels = records_of_labels(s);
            add_array(&z, own[3], "u4", 2, &labels);
        }
        zip_finish(&z);
    } else {
        o->error = ENOMEM;
    }
    free(z.members);
    free(names);
}
