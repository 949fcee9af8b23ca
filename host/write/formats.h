/*
 * formats.h - one writer per format, as the dispatcher in write.c calls them
 *
 * A writer puts the whole file into the output, whose errors are sticky: it checks nothing. Counts have been checked
 * against FORMAT_LIMIT before.
 */
#ifndef FORMATS_H
#define FORMATS_H

#include "mesh_write.h"
#include "output.h"
#include "tetracubes.h"

#include <string.h>

#define FORMAT_LIMIT UINT32_MAX /* vertices in a file, or triangles where they are what the format counts */

/* Consecutive vertices whose coordinates in the file differ from those of the mesh by the same offset. */
typedef struct shown_part {
    uint64_t vertex_end; /* the first vertex behind them */
    double offset[3];    /* coordinates of the file minus those of the mesh */
} shown_part;

/* A mesh as the file shows it: what encoders make their records of. */
typedef struct shown_mesh {
    const tc_mesh_data *mesh;              /* or a piece of it, whose indices count from its own first vertex */
    uint64_t vertex_count, triangle_count; /* of the whole mesh */
    uint64_t first_vertex, first_triangle; /* of the piece in it */
    int soup; /* every triangle has vertices of its own: vertex v of the file is corner v of the triangles */
    const vertex_array *arrays; /* beside the positions: those that the format takes */
    int array_count;
    const shown_part *parts;
    int part_count;            /* at least 1 */
    const uint32_t *labels;    /* two per triangle of s->mesh; NULL: none, or none that the format has */
    int is_moved;              /* some offset is not 0: coordinates are doubles where the format has them */
    const char *world, *units; /* of coordinates: texts of letters and digits, or "" */
} shown_mesh;

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "binary formats are written as numbers lie in memory");

#define WRITER(name, ...) void name##_write(output *o, const shown_mesh *s);
MESH_FORMATS(WRITER)
#undef WRITER

/* Whether the file's size, beside its counts, can be told in the format. */
int glb_fits(const shown_mesh *s);
int html_fits(const shown_mesh *s);

/* Whether some of the arrays has that role. */
static inline int shows_role(const shown_mesh *s, vertex_role role) {
    int n = 0;
    while (n < s->array_count && s->arrays[n].role != role) n++;
    return n < s->array_count;
}

/* The vertex of s->mesh that vertex v of the file shows. */
static inline uint64_t source_vertex(const shown_mesh *s, uint64_t v) {
    return s->soup ? s->mesh->triangles[v] : v - s->first_vertex;
}

/* The vertex of the file at corner c (3 per triangle). */
static inline uint64_t corner_vertex(const shown_mesh *s, uint64_t c) {
    return s->soup ? c : s->first_vertex + s->mesh->triangles[c - 3 * s->first_triangle];
}

static inline uint64_t file_vertex_count(const shown_mesh *s) {
    return s->soup ? 3 * s->triangle_count : s->vertex_count;
}

/* Those vertices and triangles of the file that s->mesh has. */
static inline record_span vertex_span(const shown_mesh *s) {
    const uint64_t count = file_vertex_count(s), first = s->first_vertex;
    return (record_span){count, first, s->soup ? count : first + s->mesh->vertex_count};
}

static inline record_span triangle_span(const shown_mesh *s) {
    return (record_span){s->triangle_count, s->first_triangle, s->first_triangle + s->mesh->triangle_count};
}

static inline const double *shown_offset(const shown_mesh *s, uint64_t vertex) {
    int low = 0, high = s->part_count - 1;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (vertex < s->parts[middle].vertex_end)
            high = middle;
        else
            low = middle + 1;
    }
    return s->parts[low].offset;
}

/* The coordinates of a vertex of the mesh in the file. */
static inline void shown_position(const shown_mesh *s, uint64_t vertex, double out[3]) {
    const double *offset = shown_offset(s, vertex);
    for (uint64_t axis = 0; axis < 3; axis++) out[axis] = offset[axis] + (double)s->mesh->positions[3 * vertex + axis];
}

/* The same rounded to float32, which they are where the mesh is not moved. */
static inline void shown_position_f32(const shown_mesh *s, uint64_t vertex, float out[3]) {
    double position[3] = {0};
    if (s->is_moved) shown_position(s, vertex, position);
    for (uint64_t axis = 0; axis < 3; axis++)
        out[axis] = s->is_moved ? (float)position[axis] : s->mesh->positions[3 * vertex + axis];
}

/* What the file says of its coordinates, "SPACE=LPS" and "UNITS=mm", as 3D Slicer writes and reads the first, in so
 * many lines as there are: name(n) and value(n), n from 0; the name is NULL behind the last. */
typedef struct shown_note {
    const char *name, *value;
} shown_note;

static inline shown_note shown_notes(const shown_mesh *s, int n) {
    const shown_note world = {"SPACE", s->world}, units = {"UNITS", s->units}, none = {NULL, NULL};
    if (*s->world && n == 0) return world;
    return *s->units && n == (*s->world != 0) ? units : none;
}

/* Copies to an address of any alignment; returns the address behind. */
static inline unsigned char *put_bytes(unsigned char *to, const void *from, size_t bytes) {
    memcpy(to, from, bytes);
    return to + bytes;
}

#endif
