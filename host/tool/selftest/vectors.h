/*
 * vectors.h - volumes with the hash of their surface, from a file: the device's mesh is compared with that hash
 */
#ifndef VECTORS_H
#define VECTORS_H

#include "tetracubes.h"

/* A line of the file: FIELD NX NY NZ TYPE ISOVALUE METHOD OPTIONS VERTICES TRIANGLES HASH, see vectors.txt. */
typedef struct vector {
    char field[32], options[64];
    int64_t dims[3];
    tc_type type;
    double isovalue;
    tc_method method;
    int is_complex; /* cut into tetrahedra, and extracted as an unstructured grid */
    int is_closed;
    int has_nodata;
    double nodata;
    uint64_t seed, vertices, triangles, hash;
} vector;

typedef struct vector_list {
    vector *vectors; /* from malloc */
    int count;
} vector_list;

/* Reads a file, or those that come with the tool where path is NULL. Returns 0, or a status with its text that names
 * file and line. To be released in any case. */
int vectors_read(const char *path, vector_list *list);
void vectors_release(vector_list *list);

/* Extracts the mesh of a vector; text: what is wrong with it, "" for nothing. Returns 0 or a status. */
int vector_try(const vector *v, tc_context *device, char *text, size_t bytes);

#endif
