/*
 * label_job.h - what the host tells the kernels about a label map and one slab of it: read by both compilers
 *
 * A slab is whole layers of bricks that own what they emit. Kernel 1 counts one layer more behind them, as triangles of
 * the last plane use vertices there: their numbers go on from the slab's. Bricks are numbered from the slab's first.
 */
#ifndef LABEL_JOB_H
#define LABEL_JOB_H

#include "../base/slab.h"

/* Types of vertices that a sample owns; the first twelve are used by cubes of other rows too. */
enum { LABEL_ROW_TYPES = 21, LABEL_SHARED_TYPES = 12, LABEL_OFFSETS = 16, LABEL_WORDS = 6 };

/* Words of the tables, in this order:
 *
 *     for each of 64 patterns          the number of interfaces, then these
 *     LABEL_MAPS                       for each parity and tetrahedron: its eleven vertices, then its corners
 *     LABEL_POSITIONS                  for each parity and type: the vertex from its owner, three floats
 *     LABEL_CUBES                      for each parity and pattern of a cube with two labels (bits set: the inner one),
 *                                      in bytes: the number of triangles, then three slots each
 *
 * A slot is an edge of the row's cubes (label_words.cl), and LABEL_SLOT_NEXT more where the next sample along x owns
 * it. */
enum {
    LABEL_CASE_WORDS = 8,
    LABEL_MAP_WORDS = 16,
    LABEL_MAPS = 64 * LABEL_CASE_WORDS,
    LABEL_MAP_CORNERS = 11, /* of a map: its corners, 4 bits each */
    LABEL_POSITIONS = LABEL_MAPS + 2 * 5 * LABEL_MAP_WORDS,
    LABEL_CUBES = LABEL_POSITIONS + 2 * LABEL_ROW_TYPES * 3,
    LABEL_SLOT_NEXT = 16,
    LABEL_TABLE_WORDS = LABEL_CUBES + 2 * 256 * LABEL_CASE_WORDS
};

/* An interface: four vertices, 4 bits each; its corners, 2 bits each; how many triangles it has. */
#define LABEL_INTERFACE(vertices, inner, outer, triangles)                                                             \
    ((vertices) | (inner) << 16 | (outer) << 18 | (triangles) << 20)

/* Row words: the own row's by type; then those of the rows y + 1 and z + 1, by shared type; of the row y + 1, z + 1 the
 * edges along x. */
enum {
    LABEL_WORD_Y1 = LABEL_ROW_TYPES,
    LABEL_WORD_Z1 = LABEL_WORD_Y1 + LABEL_SHARED_TYPES,
    LABEL_WORD_YZ1 = LABEL_WORD_Z1 + LABEL_SHARED_TYPES,
    LABEL_ROW_WORDS
};

/* A vertex of a cube: the row word that it is in, and whether it belongs to the next sample along x. */
#define LABEL_VERTEX(word, next) ((word) | (next) << 6)
#define LABEL_VERTEX_WORD(v)     ((v)&63)
#define LABEL_VERTEX_NEXT(v)     ((v) >> 6)

/* Indices in the slab's head, before the words of tiles (TILE_WORDS each). */
enum {
    LABEL_TICKET,
    LABEL_EMIT_TICKET,
    LABEL_ACTIVE_BRICKS,
    LABEL_ACTIVE_CELLS,
    LABEL_VERTEX_UNITS, /* a unit is 64, and each tile's sum rounded up: the scan's 30 bits would be too few */
    LABEL_TRIANGLE_UNITS,
    LABEL_HEAD_WORDS
};

/* Of a row that emits something: vertices and triangles of the rows before it in its tile. */
typedef struct label_row_base {
    slab_u32 vertices, triangles;
} label_row_base;

typedef struct label_job {
    slab_u64 sample_offset; /* of plane sample_z, in samples */
    slab_u64 sample_count;  /* in the buffer from there on */
    slab_u32 sample_z;
    slab_u32 nx, ny, nz; /* samples of the whole grid */
    slab_u32 words_x, bricks_y;
    slab_u32 parity;   /* of the cube at the grid's first sample */
    slab_i32 first[3]; /* index of the grid's first sample */
    slab_u32 z0, z1;   /* planes of the bricks that are counted */
    slab_u32 brick_count, own_bricks;
    slab_u32 tile_bricks, tile_count, own_tiles; /* tiles of own bricks come first, then those behind */
    slab_u32 spin_limit;
    slab_u32 vertex_base;     /* number of the slab's first vertex */
    slab_u32 position_offset; /* floats in the buffer before it */
    slab_u32 triangle_offset; /* indices in the buffer before the slab's first triangle */
    slab_u32 label_offset;    /* labels in the buffer before it */
    slab_u32 mirrored;
    slab_f32 matrix[12];
    slab_u32 reserved;
} label_job;

#ifndef __OPENCL_VERSION__
_Static_assert(sizeof(label_job) == 2 * 8 + 36 * 4,
               "no padding: Mesa's rusticl 22.3 leaves it out of an argument's size");
#endif

#endif
