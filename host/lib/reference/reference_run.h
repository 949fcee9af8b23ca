/*
 * reference_run.h - one extraction by the scalar reference: what its stages share
 */
#ifndef REFERENCE_RUN_H
#define REFERENCE_RUN_H

#include "base/channels.h"
#include "grid/carry.h"
#include "grid/grid.h"
#include "grid/mesh.h"
#include "tables/method.h"

/* Of a sample. SNAPPED: the surface goes through it (method snap); INSIDE is then what it was before. */
enum { INSIDE = 1, PRESENT = 2, SNAPPED = 4 };

enum { BRICK_X = 64, BRICK_Y = 8, BRICK_Z = 4 };

typedef struct reference {
    const tc_grid *grid;
    double isovalue;
    int64_t dims[3];
    uint8_t *signs;   /* per sample: INSIDE | PRESENT | SNAPPED */
    bool complete;    /* no sample is missing */
    uint32_t *ids[2]; /* of each vertex, for even and odd layers: [(sample in layer)][type] */
    int id_types;     /* vertices that a sample may own */
    tc_mesh *mesh;    /* NULL: count only */
    const carry *carried;
    channel_set made;
    tc_method method;
    float threshold;         /* of method snap */
    cube_case cases[2][256]; /* of the hybrid method */
    bool closed;
    cap_case caps[2][CUBE_FACES][CAP_CASES]; /* of closed surfaces */
    uint64_t vertex_count, triangle_count, active_cell_count;
    int64_t halo_layer; /* of a piece: the layer behind it, whose vertices its triangles use; else no layer */
} reference;

static inline int64_t sample_index(const reference *r, const int64_t p[3]) {
    return (p[2] * r->dims[1] + p[1]) * r->dims[0] + p[0];
}

static inline double sample_value(const reference *r, const int64_t p[3]) {
    return grid_value_at(r->grid, sample_index(r, p));
}

static inline bool sample_is(const reference *r, const int64_t p[3], int flag) {
    return r->signs[sample_index(r, p)] & flag;
}

/* Of the cube whose first sample is p; a sample is called odd where its cube is, also at the grid's border. */
static inline unsigned cube_parity(const reference *r, const int64_t p[3]) {
    return (grid_parity(r->grid) ^ (unsigned)(p[0] + p[1] + p[2])) & 1;
}

static inline bool cube_in_grid(const reference *r, const int64_t p[3]) {
    for (int axis = 0; axis < 3; axis++)
        if (p[axis] < 0 || p[axis] + 1 >= r->dims[axis]) return false;
    return true;
}

static inline bool cube_present(const reference *r, const int64_t p[3]) {
    if (!cube_in_grid(r, p)) return false;
    int64_t number = (p[2] * (r->dims[1] - 1) + p[1]) * (r->dims[0] - 1) + p[0];
    if (r->grid->blanked_cells && r->grid->blanked_cells[number]) return false;
    for (int c = 0; c < 8 && !r->complete; c++)
        if (!sample_is(r, (int64_t[3]){p[0] + (c & 1), p[1] + (c >> 1 & 1), p[2] + (c >> 2)}, PRESENT)) return false;
    return true;
}

/* How many of the eight cubes around a sample are present. */
static inline int cubes_present_around(const reference *r, const int64_t p[3]) {
    int present = 0;
    for (int c = 0; c < 8; c++)
        present += cube_present(r, (int64_t[3]){p[0] - (c & 1), p[1] - (c >> 1 & 1), p[2] - (c >> 2)});
    return present;
}

/* A sample's index among those of its layer. */
static inline int64_t index_in_layer(const reference *r, const int64_t p[3]) {
    return (p[2] % BRICK_Z * r->dims[1] + p[1]) * r->dims[0] + p[0];
}

static inline uint32_t *vertex_id(const reference *r, const int64_t owner[3], int type) {
    return r->ids[owner[2] / BRICK_Z & 1] + index_in_layer(r, owner) * r->id_types + type;
}

/* Signs of the samples; to be ended in any case. */
tc_status reference_begin(reference *r, const tc_grid *grid, const tc_extract_options *options);
void reference_end(reference *r);

/* Room for the numbers of vertices, before any are made. */
tc_status reference_ids_allocate(reference *r);

/* Numbers the vertices of a layer, and makes them where there is a mesh. The first layer of a piece also
 * fills the piece's seam. Vertices of the layer behind it get their numbers from the next piece's seam, and are not
 * the piece's own. */
void reference_layer_vertices(reference *r, int64_t layer);

/* Whether as much was emitted as was counted: not where the caller has changed its arrays in between. */
tc_status reference_complete(const reference *r, bool triangles);

/* The position at t on the edge from a to b, which may be one sample. */
void reference_position(const reference *r, const int64_t a[3], const int64_t b[3], float t, float out[3]);

/* Method snap: marks the samples that the surface is made to go through (reference_snap.c). */
void samples_snap(reference *r);

/* The edge on which such a sample's vertex lies, its ends in the order of their indices. */
void snapped_edge(const reference *r, const int64_t p[3], int64_t a[3], int64_t b[3]);

#endif
