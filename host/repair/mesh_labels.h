/*
 * mesh_labels.h - the mesh of a label map taken apart: the surface of each label as a mesh of its own
 */
#ifndef MESH_LABELS_H
#define MESH_LABELS_H

#include "tetracubes.h"

/* The labels of a mesh but the background, rising, with their triangles, in the order of the mesh. */
typedef struct mesh_labels {
    const tc_mesh_data *mesh;
    size_t count;
    uint32_t *labels;
    uint64_t *starts;    /* count + 1: where the triangles of each label begin in `triangles` */
    uint64_t *triangles; /* their numbers in the mesh */
    uint32_t *numbers;   /* for mesh_label_take: of each vertex of the mesh, 0 */
} mesh_labels;

/* One label's surface: triangles wind counter-clockwise seen from outside the label, which is the first of the two that
 * each has. Vertices are in the order of their first triangle. Memory is used again by the next. */
typedef struct label_mesh {
    tc_mesh_data mesh;
    float *positions;
    uint32_t *triangles, *labels;
    uint64_t triangle_capacity;
} label_mesh;

/* Returns 0, or STATUS_FAILED with its message (failure.h) where memory runs out; to be released in any case. The mesh
 * outlives it. */
int mesh_labels_find(const tc_mesh_data *mesh, mesh_labels *out);
void mesh_labels_release(mesh_labels *l);

int mesh_labels_has(const mesh_labels *l, uint32_t label);

/* Makes the surface of label n of the list; *out is zeroed before the first. Returns as above. */
int mesh_label_take(mesh_labels *l, size_t n, label_mesh *out);
void label_mesh_release(label_mesh *m);

#endif
