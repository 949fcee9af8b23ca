/*
 * slab.h - what the host tells the kernels about a grid and one slab of it: read by both compilers
 *
 * A slab is the planes z0 <= z < z1, whole layers of bricks. Buffers may hold the whole grid or only what the slab
 * needs: samples from plane sample_z on; words, offsets and bricks from plane word_z on (a multiple of the brick's
 * depth).
 */
#ifndef SLAB_H
#define SLAB_H

#ifdef __OPENCL_VERSION__
typedef int slab_i32;
typedef uint slab_u32;
typedef ulong slab_u64;
typedef float slab_f32;
#else
#include <stdint.h>
typedef int32_t slab_i32;
typedef uint32_t slab_u32;
typedef uint64_t slab_u64;
typedef float slab_f32;
#endif

/* The unit of order: 64 x 8 x 4 samples. A row of 64 samples is one sign word. A brick has 32 rows, whose words are
 * consecutive: that of row (y, z) of the brick has index 8 z + y. */
enum { BRICK_ROWS = 8, BRICK_PLANES = 4, BRICK_WORDS = 32 };

/* On which side a brick's samples are. Words of uniform bricks are not stored: two bricks of constant words at the
 * start of the buffer stand for them. */
enum { SIGN_OUTSIDE, SIGN_INSIDE, SIGN_MIXED, UNIFORM_BRICKS = 2 };

/* What kernel 1 finds out about a brick. While samples are snapped, `rows` counts how often the brick was entered in
 * the list of bricks with violated samples: where it is not 0, the brick is there. */
typedef struct brick_state {
    slab_u32 vertices, triangles; /* before it in the slab */
    slab_u32 rows;                /* bit n: row n of the brick emits something */
    slab_u32 sign;
} brick_state;

/* Least and greatest sample of a brick, as keys that order like the samples; of 64-bit keys the upper half. Kept with a
 * grid, so that for later isovalues only some bricks are read. */
typedef struct brick_range {
    slab_u32 low, high;
} brick_range;

/* The table of cases for kernel 2, of 2 parities x CASE_COUNT patterns of a cube: the number of triangles, then three
 * vertices for each. A pattern of two signs has a bit per corner; where the surface can go through samples, a digit to
 * the base 3. Then 256 shorts follow the table, which turn bits into digits: entry n is the sum of 3^m over the bits m
 * of n. */
#define CASE_COUNT(method_types) ((method_types) > 6 ? 6561 : 256)
enum { CUBE_CASE_BYTES = 32 };

/* Of closed surfaces entries for faces on the border follow, from this one on: 2 parities x CAP_FACES x CAP_FACE_CASES
 * cases of a face, a digit to the base 3 for each of its corners. */
#define CAP_FIRST(method_types) (2 * CASE_COUNT(method_types) + 2 * 256 / CUBE_CASE_BYTES)
enum { CAP_FACES = 6, CAP_FACE_CASES = 81, CAP_ENTRIES = 2 * CAP_FACES * CAP_FACE_CASES };

/* Kernel 2 where a work-item has a brick to itself: its table of vertex numbers has NUMBER_ROWS x NUMBER_PLANES rows of
 * NUMBER_COLUMNS samples. A sample has NUMBER_TYPES entries: one for each type of vertex, and more up to a power of
 * two; of eight the last may be the vertex at the next sample in x (case_slots.h). The table of cases names a vertex by
 * its slot (case_slots.h). */
#define NUMBER_TYPES(vertex_types) ((vertex_types) > 4 ? 8 : 4)
enum {
    NUMBER_COLUMNS = 65,
    NUMBER_ROWS = 9,
    NUMBER_PLANES = 5,
    NUMBER_PADDING = 16 /* numbers behind the table that vectors may read and write */
};

/* The index of a sample in that table, in samples. */
#define NUMBER_INDEX(x, y, z) (((z)*NUMBER_ROWS + (y)) * NUMBER_COLUMNS + (x))

/* Local memory that a group takes for each brick that it works on, that is for every 32 work-items: at most kernel 2's
 * table of a brick's rows (emit_rows.cl). */
enum { LOCAL_BYTES_PER_BRICK = 3072 };

/* Where work-items share bricks, the table of cases names the sample that owns an edge, and the edge's type. */
#define EDGE_ITEM(x, y, z, type) ((type) + 8 * ((x) + 2 * (y) + 4 * (z)))

/* Kernels of method snap that take what they do by ticket; the passes over even samples have one each. */
enum {
    TICKET_SIGN,
    TICKET_WORDS,
    TICKET_VIOLATED,
    TICKET_JOIN,
    TICKET_ODD,
    TICKET_EVEN,
    SNAP_TICKETS = TICKET_EVEN + 4
};

/* Indices in a slab's head: STATE_WORDS words of the state buffer, cleared before kernel 1. */
enum {
    STATE_TICKET,      /* next tile of kernel 1 */
    STATE_EMIT_TICKET, /* next run of active bricks of kernel 2 */
    STATE_ACTIVE_BRICKS,
    STATE_ACTIVE_CELLS, /* cubes that the surface passes through: cells, in kernels of structured grids, are cubes */
    STATE_NONFINITE,    /* not 0: a sample is NaN or infinite, so the grid must be classified with missing cells */
    STATE_VERTICES,     /* totals of the slab */
    STATE_TRIANGLES,
    STATE_NEAR_BRICKS,     /* method snap: bricks near the surface */
    STATE_VIOLATED_BRICKS, /* and those of them with violated samples */
    STATE_SNAP_TICKET,     /* its kernels' next tile or brick of these: one each */
    STATE_WORDS = STATE_SNAP_TICKET + SNAP_TICKETS
};

/* Words of the state buffer per tile: two sums as scan.cl keeps them, one more word, and the next tile of the same
 * group. Kernel 1 sums up vertices and triangles, and keeps how many bricks emit something. Others sum up something
 * else, as active items and triangles (complex_count.cl), or vertices at points and tetrahedra
 * (complex_interval_count.cl). */
enum {
    TILE_SUM_X,
    TILE_SUM_Y,
    TILE_EXTRA,
    TILE_NEXT,
    TILE_WORDS,
    TILE_VERTICES = TILE_SUM_X,
    TILE_TRIANGLES = TILE_SUM_Y,
    TILE_BRICKS = TILE_EXTRA
};

/* A sum has the lower bits of its word: the host bounds a slab so that none passes them. */
#define SCAN_VALUE 0x3fffffffu

/* The side of the isovalue that a sample is on, by its bits. */
typedef struct isovalue_test {
    slab_u64 inside_low; /* inside: (bits - inside_low) <= inside_span, unsigned, in the width of the type */
    slab_u64 inside_span;
    slab_u64 key_flip;       /* integers: key = bits ^ key_flip */
    slab_u64 nodata_bits[2]; /* bits of the missing value: two patterns, equal where it has only one */
    slab_u64 isovalue64;     /* bits of the double */
    slab_f32 isovalue32;
    slab_u32 key_inside;  /* all keys from here on are inside */
    slab_u32 key_outside; /* all keys below are outside; in between, the upper half of a 64-bit key is not enough */
    slab_u32 has_nodata;
} isovalue_test;

/* Where the slab's part of each of the grid's arrays begins in its buffer. */
typedef struct slab_arrays {
    slab_u64 sample_offset;       /* of plane sample_z, in samples */
    slab_u64 sample_count;        /* samples in the buffer from there on */
    slab_u64 point_offset;        /* in floats: sample n has its point at 3 n + point_offset, modulo 2^64 */
    slab_u64 blanked_offset;      /* sample n has its byte of blanked samples at n + blanked_offset */
    slab_u64 blanked_cell_offset; /* of plane sample_z */
    slab_u64 blanked_cell_count;  /* in that buffer from there on */
    slab_u32 sample_z;
    slab_u32 cell_z; /* first plane of the cells (grids with missing samples) */
    slab_u32 has_blanked_samples, has_blanked_cells;
} slab_arrays;

/* Where the results of kernel 1 are in their buffers. */
typedef struct slab_results {
    slab_u32 word_z;        /* first plane of the sign words */
    slab_u32 head_offset;   /* of the slab's head in the state buffer, in words */
    slab_u32 tiles_offset;  /* of its tiles, TILE_WORDS words each */
    slab_u32 active_offset; /* of its list of active bricks */
    slab_u32 range_offset;  /* of brick 0 of the slab's window in the buffer of ranges */
    slab_u32 ranges_known;
} slab_results;

/* How kernel 1 cuts the slab into tiles. */
typedef struct slab_tiling {
    slab_u32 tile_rows;   /* rows of bricks per tile and layer */
    slab_u32 tile_layers; /* more than 1 only where tile_rows covers a layer */
    slab_u32 tile_count;
    slab_u32 spin_limit; /* of the scan */
} slab_tiling;

/* What a launch of kernel 2 emits, and where that goes. */
typedef struct slab_mesh {
    slab_u32 vertex_base;             /* number of the slab's first vertex */
    slab_u32 vertex_base_next;        /* of the next slab's first vertex */
    slab_u32 vertex_window;           /* number of the vertex that the buffers of channels start with */
    slab_u32 triangle_window;         /* the same of triangles, from the slab's first on; modulo 2^32 */
    slab_u32 vertex_offset;           /* floats in the buffers of channels before that vertex */
    slab_u32 triangle_offset;         /* indices in the triangle buffer before that triangle */
    slab_u32 brick_first, brick_last; /* the active bricks among these are emitted */
} slab_mesh;

/* From the indices of a uniform grid to positions, and from gradients to normals: rows of matrices. */
typedef struct slab_space {
    slab_f32 matrix[12];
    slab_f32 normal_matrix[9];
} slab_space;

/* Method snap: samples that are vertices, the third sign, have words of their own behind the others. */
typedef struct slab_snapping {
    slab_f32 threshold;
    slab_u32 zero_bricks; /* from a brick's sign words to its words of zeros, in bricks */
} slab_snapping;

typedef struct slab {
    isovalue_test test;
    slab_arrays arrays;
    slab_u32 nx, ny, nz; /* samples of the whole grid */
    slab_u32 words_x;    /* sign words per row of the grid = bricks per row */
    slab_u32 bricks_y;
    slab_u32 parity;   /* of the cube at the grid's first sample */
    slab_i32 first[3]; /* index of the grid's first sample */
    slab_u32 z0, z1;
    slab_results results;
    slab_tiling tiling;
    slab_mesh mesh;
    slab_space space;
    slab_snapping snapping;
} slab;

#ifndef __OPENCL_VERSION__
_Static_assert(sizeof(slab) == 12 * 8 + 60 * 4, "no padding: Mesa's rusticl 22.3 leaves it out of an argument's size");
#endif

#endif
