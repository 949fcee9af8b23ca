/*
 * engine.h - one engine with the grids of all blocks, and the surface of all of them as one mesh
 *
 * Vertices and triangles of several blocks follow each other in the order of the blocks; nothing is merged.
 */
#ifndef ENGINE_H
#define ENGINE_H

#include "input/blocks.h"
#include "mesh_write.h"
#include "vertex_values.h"

/* Memory that several blocks' meshes are joined in. */
typedef struct joined_mesh {
    float *values[CHANNEL_COUNT];
    uint32_t *triangles;
    uint64_t vertex_capacity, triangle_capacity;
} joined_mesh;

/* Blocks `first` to first + count - 1: those whose surfaces become one mesh. */
typedef struct block_range {
    int first, count;
} block_range;

typedef struct engine {
    tc_context *context;
    tc_grid **grids;  /* one per block; NULL of a block with nothing to contour */
    int suits_world;  /* float32 coordinates may count from 0, 0, 0 (cell_sizes.h) */
    mesh_part *parts; /* what each block gave to the last mesh that it is in, and its origin */
    int block_count;
    tc_mesh *mesh; /* of one block, used for each in turn */
    joined_mesh joined;
    int fails_alike; /* what failed last would fail in any engine: a limit of meshes, or the host's memory */
} engine;

/* Picks the device of the options, for the OpenCL engine. To be closed in any case. */
int engine_open(const options *o, tc_engine kind, engine *e);
void engine_close(engine *e);

/* Whether the reference engine is to take over from this one, which is of the kind and has failed with the status: with
 * --engine auto, unless the reference would fail alike or the user has ended the run. Then it is told, and the engine
 * closed. */
int engine_gives_way(const options *o, tc_engine kind, engine *e, int status);

/* How the surface of an isovalue is to be made. */
void engine_options(const options *o, const typed_isovalue *iso, tc_extract_options *how);

/* Makes a grid of every block for the device. Blocks that lie near each other share an origin, so that vertices are the
 * same where their surfaces meet. */
int engine_upload(const options *o, const block_list *blocks, engine *e);

/* Whether positions of some of the blocks are relative to another origin than those of others. */
int engine_origins_differ(const engine *e, block_range blocks);

/* Sums of tc_count over the blocks. */
int engine_count(engine *e, const tc_extract_options *how, tc_counts *counts);

/* The surface of these blocks; *data stays valid until the next call. Positions are relative to each part's origin,
 * data->origin is the first one's. Times are summed, slabs those of the block with the most. */
int engine_extract(engine *e, block_range blocks, const tc_extract_options *how, tc_mesh_data *data);

/* Carries a field of the blocks' points onto the vertices of the mesh just made of them. */
int engine_carry(engine *e, block_range blocks, const tc_extract_options *how, const point_field *field, float *values);

#endif
