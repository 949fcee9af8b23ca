/*
 * pieces.h - the pieces of a mesh: what hangs together, and the topology of each
 */
#ifndef PIECES_H
#define PIECES_H

#include "tetracubes.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

/* Zeroed, and never NULL; without memory the test ends. */
static inline void *memory_get(size_t count, size_t bytes) {
    void *got = calloc(count + 1, bytes);
    if (!got) exit(EXIT_FAILURE);
    return got;
}

/* A piece of a surface that hangs together across edges. */
typedef struct piece {
    int64_t euler, borders;
} piece;

typedef struct pieces {
    uint32_t count;
    piece *list;         /* sorted */
    uint64_t pinches;    /* fans of triangles above one per vertex */
    const char *fault;   /* why it is no oriented surface of all its vertices, or NULL */
    uint32_t side_count; /* with one triangle, by their vertices */
    uint32_t (*sides)[2];
} pieces;

/* Memory is the caller's to free. */
pieces pieces_of(const tc_mesh_data *mesh);
void pieces_free(pieces *p);

/* What differs between the pieces of two meshes, by tetra and by another method; NULL where nothing does. */
const char *pieces_differ(const pieces *tetra, const pieces *other);

#endif
