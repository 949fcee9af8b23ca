/*
 * stream.h - a stream under way (stream.c): the grid, its surfaces, and the units that the grid is cut into
 */
#ifndef STREAM_H
#define STREAM_H

#include "base/float_environment.h"
#include "base/host_block.h"
#include "grid/grid.h"
#include "opencl/context.h"

/* What a unit gives to a surface. */
typedef struct unit_surface {
    uint64_t vertex_count, triangle_count;
    uint32_t *seam; /* NULL: no vertex has a number */
} unit_surface;

/* A piece (tc_extract_piece) whose samples are in memory together. It owns planes first to end - 1 of the whole. */
typedef struct unit {
    int64_t first, end;
    unit_surface *surfaces;
} unit;

typedef struct stream {
    tc_context *context;
    tc_stream_options o;
    tc_grid_options whole;
    tc_extract_options *surfaces;
    tc_counts *totals;
    uint32_t *no_vertices; /* a seam */
    uint64_t seam_size;
    unit *units;
    size_t unit_count, unit_capacity;
    size_t own_units; /* all but the unit behind what the stream owns, which gives its seam */
    int64_t halo[2];
    uint64_t plane_bytes[ARRAY_COUNT];
    host_block held[ARRAY_COUNT]; /* for what the source does not have in memory */
    uint64_t mesh_bytes;          /* of a piece, at most, where that can be had */
    tc_grid *grid;                /* of the unit in memory */
    bool mirrored;                /* of a curvilinear grid: the whole */
    int64_t own_first, own_end;   /* the planes that it owns, of the whole */
    int64_t grid_first, grid_end; /* those that it has */
} stream;

/* Calls back with the caller's floating-point environment. */
#define CALL_BACK(call)                                                                                                \
    do {                                                                                                               \
        float_environment *lent = float_environment_lend();                                                            \
        const int ended = (call);                                                                                      \
        float_environment_resume(lent);                                                                                \
        if (ended) return (tc_status)fail(TC_ERROR_CANCELLED, "a callback of the stream has ended it");                \
    } while (0)

/* Makes a grid of the unit, unless it is there (stream_units.c). */
tc_status stream_grid_open(stream *s, const unit *u);
void stream_grid_close(stream *s);

/* Counts all that the stream owns, in units of so many planes or fewer; then totals are known. */
tc_status stream_count(stream *s, int64_t window);
void stream_units_release(stream *s);

/* Progress of a part of the stream is that share of the whole. */
void stream_progress(stream *s, double begin, double share);

#endif
