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

#define FORMAT_LIMIT UINT32_MAX /* vertices in a PLY, OBJ or VTP file, triangles in an STL file */

/* A mesh as the file shows it; what encoders take their records from. */
typedef struct shown_mesh {
    const tc_mesh_data *mesh;
    int soup; /* vertices of the file are the triangles' corners, one after the other */
    const mesh_field *fields;
    int field_count;  /* 0 where the format takes none */
    double offset[3]; /* coordinates of the file minus those of the mesh */
    int is_moved;     /* the offset is not 0: coordinates are doubles where the format has them */
} shown_mesh;

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "PLY, STL and VTP are written as numbers lie in memory");

void ply_write(output *o, const shown_mesh *s);
void obj_write(output *o, const shown_mesh *s);
void stl_write(output *o, const shown_mesh *s);
void vtp_write(output *o, const shown_mesh *s);

/* The vertex of the mesh that vertex v of the file shows. */
static inline uint64_t source_vertex(const shown_mesh *s, uint64_t v) { return s->soup ? s->mesh->triangles[v] : v; }

/* The vertex of the file at corner c (3 per triangle). */
static inline uint32_t corner_vertex(const shown_mesh *s, uint64_t c) {
    return s->soup ? (uint32_t)c : s->mesh->triangles[c];
}

static inline uint64_t file_vertex_count(const shown_mesh *s) {
    return s->soup ? 3 * s->mesh->triangle_count : s->mesh->vertex_count;
}

/* The coordinates of a vertex of the mesh in the file. */
static inline void shown_position(const shown_mesh *s, uint64_t vertex, double out[3]) {
    for (uint64_t axis = 0; axis < 3; axis++)
        out[axis] = s->offset[axis] + (double)s->mesh->positions[3 * vertex + axis];
}

/* Copies to an address of any alignment; returns the address behind. */
static inline unsigned char *put_bytes(unsigned char *to, const void *from, size_t bytes) {
    memcpy(to, from, bytes);
    return to + bytes;
}

#endif
