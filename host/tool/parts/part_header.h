/*
 * part_header.h - what the file of a part begins with, and how it goes on
 *
 * A part, extract --part I/N, is what the planes that it owns give to a surface. Its file, all of it little-endian:
 *
 *     header      one line of JSON, with blanks at its end up to a multiple of 64 bytes
 *     channels    of the vertices: positions, normals; 3 float32 each
 *     fields      that are carried, float32
 *     triangles   3 uint32 each: vertices of the part, counted from 0; from vertex_count on those of the next part
 *     digest      of all before, one line of text
 *
 * What all parts of one surface have in common is one object of the header, "surface": how it was made, and of what.
 */
#ifndef PART_HEADER_H
#define PART_HEADER_H

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

/* LAYER_PLANES: of a layer of bricks, which planes are owned by. */
enum { LAYER_PLANES = 4, PART_VERSION = 1, PART_ALIGNMENT = 64, PART_DIGEST_BYTES = 64 };

typedef struct part_header {
    json_t *surface;
    int64_t number, count; /* part number, from 0, of so many */
    int64_t planes[2];     /* of the whole: those from planes[0] to before planes[1] are its own */
    uint64_t vertex_count, triangle_count;
    int has_origin;   /* a part without vertices may not know it */
    double origin[3]; /* that positions are relative to */
} part_header;

/* The planes of part `number` of a grid with nz of them: whole layers of bricks, as even as that can be. */
void part_planes(int64_t nz, int64_t number, int64_t count, int64_t planes[2]);

/* The header's line, from malloc. 0 or STATUS_FAILED. */
int part_header_text(const part_header *h, char **text, size_t *bytes);

/* Reads the line that the file's bytes begin with. *h is to be released in any case. 0, STATUS_INPUT or STATUS_FAILED;
 * path is for messages. */
int part_header_read(const char *path, const unsigned char *bytes, size_t size, part_header *h, size_t *header_bytes);
void part_header_release(part_header *h);

/* An array of the file. */
typedef struct part_array {
    const char *name; /* borrowed from the header */
    int channel;      /* of CHANNELS; -1: a field, or triangles */
    int components;
    uint64_t count; /* of records */
    size_t record_bytes;
    uint64_t offset;
} part_array;

/* All arrays in their order; triangles are the last. */
typedef struct part_layout {
    part_array *arrays; /* from malloc */
    int array_count, channel_count;
    uint64_t digest_offset, file_bytes;
} part_layout;

/* 0; STATUS_INPUT where the header names arrays that there cannot be; or STATUS_FAILED. */
int part_layout_make(const char *path, const part_header *h, size_t header_bytes, part_layout *layout);
void part_layout_release(part_layout *layout);

static inline const part_array *part_triangles(const part_layout *l) { return &l->arrays[l->array_count - 1]; }

#endif
