/*
 * in_situ.c - a simulation that contours its own slab in each step, and so an example of pieces of a grid under MPI
 *
 * Heat spreads from a source that moves. Each rank owns whole layers of four planes, and the halo that the library asks
 * for: four planes before its own, two behind. In each step
 *
 *     halos are exchanged with both neighbours                   MPI_Sendrecv, planes of samples
 *     each rank counts what it owns                              tc_count_piece
 *     seams go to the rank before                                MPI_Sendrecv, 4 bytes for 64 x 8 samples of a plane
 *     sums over lower ranks are the first numbers of each        MPI_Exscan
 *     each rank extracts what it owns                            tc_extract_piece
 *
 * and all that a code would do with the mesh is done on the spot: no rank has more than its slab. Here, as this is a
 * test, rank 0 gathers meshes and samples, and compares every byte with the surface of the whole by one process.
 *
 * Exit status 0: all the same.
 */
#include "tetracubes.h"

#include <math.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NX = 70, NY = 21, LAYER = 4, BEFORE = 4, BEHIND = 2, STEPS = 6, PLANE = NX * NY };

/* A rank's part of the planes of the whole: its own from first to before end, and with the halo low to before high. */
typedef struct slab {
    int rank, size;
    int64_t nz, first, end, low, high;
    float *heat, *next;
    uint64_t sent_bytes; /* to neighbours, in this step */
} slab;

static void stop(const char *what) {
    fprintf(stderr, "in_situ: %s: %s\n", what, tc_message());
    MPI_Abort(MPI_COMM_WORLD, 1);
    exit(1);
}

static void *room(size_t count, size_t bytes) {
    void *memory = calloc(count + 1, bytes);
    if (!memory) stop("no memory");
    return memory;
}

static void check(tc_status status, const char *what) {
    if (status != TC_OK) stop(what);
}

/* ------------------------------------------------------------------------------------------------------- simulation */

static slab slab_make(void) {
    slab s = {0};
    MPI_Comm_rank(MPI_COMM_WORLD, &s.rank);
    MPI_Comm_size(MPI_COMM_WORLD, &s.size);
    const int64_t layers = 3 * (int64_t)s.size + 1;
    s.nz = LAYER * layers - 1;
    s.first = LAYER * (s.rank * layers / s.size);
    s.end = s.rank + 1 == s.size ? s.nz : LAYER * ((s.rank + 1) * layers / s.size);
    s.low = s.rank ? s.first - BEFORE : 0;
    s.high = s.rank + 1 < s.size ? s.end + BEHIND : s.nz;
    s.heat = room((size_t)(s.high - s.low) * PLANE, sizeof *s.heat);
    s.next = room((size_t)(s.high - s.low) * PLANE, sizeof *s.next);
    return s;
}

static float *plane_of(const slab *s, int64_t z) { return s->heat + (z - s->low) * PLANE; }

/* Of planes that this rank owns those next to a neighbour go there, into its halo. */
static void halo_exchange(slab *s) {
    const int before = s->rank ? s->rank - 1 : MPI_PROC_NULL,
              behind = s->rank + 1 < s->size ? s->rank + 1 : MPI_PROC_NULL;
    MPI_Sendrecv(plane_of(s, s->first), BEHIND * PLANE, MPI_FLOAT, before, 0, plane_of(s, s->end), BEHIND * PLANE,
                 MPI_FLOAT, behind, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    MPI_Sendrecv(plane_of(s, s->end - BEFORE), BEFORE * PLANE, MPI_FLOAT, behind, 1, plane_of(s, s->low),
                 BEFORE * PLANE, MPI_FLOAT, before, 1, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    s->sent_bytes = sizeof(float) * PLANE * (size_t)((before >= 0 ? BEHIND : 0) + (behind >= 0 ? BEFORE : 0));
}

static float at(const slab *s, int64_t x, int64_t y, int64_t z) {
    return x < 0 || y < 0 || z < 0 || x >= NX || y >= NY || z >= s->nz ? 0 : plane_of(s, z)[y * NX + x];
}

static void simulate(slab *s, int step) {
    for (int64_t z = s->first; z < s->end; z++)
        for (int64_t y = 0; y < NY; y++)
            for (int64_t x = 0; x < NX; x++) {
                const float own = at(s, x, y, z);
                const float around = at(s, x - 1, y, z) + at(s, x + 1, y, z) + at(s, x, y - 1, z) + at(s, x, y + 1, z) +
                                     at(s, x, y, z - 1) + at(s, x, y, z + 1);
                const float source = x == 9 * step + 8 && (y + 5 * z) % 11 == step % 3 ? 40.0f : 0.0f;
                s->next[(z - s->low) * PLANE + y * NX + x] = own + 0.15f * (around - 6 * own) + source;
            }
    memcpy(plane_of(s, s->first), s->next + (s->first - s->low) * PLANE,
           (size_t)(s->end - s->first) * PLANE * sizeof(float));
}

/* ------------------------------------------------------------------------------------------------------- contouring */

static tc_grid_options whole_grid(const slab *s) {
    tc_grid_options whole;
    tc_grid_options_init(&whole);
    whole.dims[0] = NX;
    whole.dims[1] = NY;
    whole.dims[2] = s->nz;
    whole.type = TC_F32;
    for (int axis = 0; axis < 3; axis++) whole.matrix[axis][axis] = 0.5;
    return whole;
}

/* A piece of the surface, and where it lies in the whole one. */
typedef struct piece {
    tc_mesh *mesh;
    tc_mesh_data data;
    uint64_t before[2], all[2]; /* vertices and triangles */
} piece;

static piece piece_make(slab *s, tc_context *context, const tc_extract_options *how) {
    const tc_grid_options whole = whole_grid(s);
    tc_grid_options own = whole;
    piece p = {.data = {.struct_size = sizeof p.data}};
    tc_counts counts = {.struct_size = sizeof counts};
    tc_grid *grid = NULL;
    own.whole = &whole;
    own.dims[2] = s->high - s->low;
    own.first_index[2] = s->low;
    own.owned[0] = s->first - s->low;
    own.owned[1] = s->end - s->low;
    own.samples = s->heat;
    check(tc_grid_create(context, &own, &grid), "the grid of a rank");
    const uint64_t seam_size = tc_seam_size(grid);
    uint32_t *seam = room(seam_size, sizeof *seam), *behind = room(seam_size, sizeof *behind);
    check(tc_count_piece(grid, how, &counts, seam, seam_size), "counting");
    const int last = s->rank + 1 == s->size;
    MPI_Sendrecv(seam, (int)seam_size, MPI_UINT32_T, s->rank ? s->rank - 1 : MPI_PROC_NULL, 2, behind, (int)seam_size,
                 MPI_UINT32_T, last ? MPI_PROC_NULL : s->rank + 1, 2, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (s->rank) s->sent_bytes += seam_size * sizeof *seam;
    const uint64_t counted[2] = {counts.vertex_count, counts.triangle_count};
    MPI_Exscan(counted, p.before, 2, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
    MPI_Allreduce(counted, p.all, 2, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
    if (!s->rank) p.before[0] = p.before[1] = 0;
    check(tc_extract_piece(grid, how, last ? NULL : behind, last ? 0 : seam_size, &p.mesh), "extracting");
    check(tc_mesh_get(p.mesh, &p.data), "the mesh of a rank");
    free(seam);
    free(behind);
    tc_grid_destroy(grid);
    return p;
}

/* ------------------------------------------------------------------------------------------------------- comparison */

/* Puts values of all ranks, one behind the other, into *out of rank 0, from malloc. */
static void gather(const slab *s, const void *own, uint64_t bytes, void **out) {
    int *counts = room((size_t)s->size, sizeof *counts), *places = room((size_t)s->size, sizeof *places);
    const int count = (int)bytes;
    size_t all = 0;
    MPI_Gather(&count, 1, MPI_INT, counts, 1, MPI_INT, 0, MPI_COMM_WORLD);
    for (int n = 0; n < s->size; n++) {
        places[n] = (int)all;
        all += (size_t)counts[n];
    }
    *out = room(all, 1);
    MPI_Gatherv(own, count, MPI_BYTE, *out, counts, places, MPI_BYTE, 0, MPI_COMM_WORLD);
    free(counts);
    free(places);
}

static int is_whole(const slab *s, tc_context *context, const tc_extract_options *how, const void *samples,
                    const float *positions, const float *normals, const uint32_t *triangles, const piece *p) {
    tc_grid_options whole = whole_grid(s);
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data m = {.struct_size = sizeof m};
    whole.samples = samples;
    check(tc_grid_create(context, &whole, &grid), "the whole grid");
    check(tc_extract(grid, how, &mesh), "the whole surface");
    check(tc_mesh_get(mesh, &m), "the whole mesh");
    const size_t vertex_bytes = 3 * sizeof(float) * (size_t)m.vertex_count;
    const int same = m.vertex_count == p->all[0] && m.triangle_count == p->all[1] && m.triangle_count > 100 &&
                     !memcmp(m.positions, positions, vertex_bytes) && !memcmp(m.normals, normals, vertex_bytes) &&
                     !memcmp(m.triangles, triangles, 3 * sizeof(uint32_t) * (size_t)m.triangle_count);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    return same;
}

static int compare(const slab *s, tc_context *context, const tc_extract_options *how, const piece *p) {
    const uint64_t corners = 3 * p->data.triangle_count, vertex_bytes = 3 * sizeof(float) * p->data.vertex_count;
    uint32_t *own = room((size_t)corners, sizeof *own);
    void *samples, *positions, *normals, *triangles;
    for (uint64_t c = 0; c < corners; c++) own[c] = (uint32_t)p->before[0] + p->data.triangles[c];
    gather(s, plane_of(s, s->first), (uint64_t)(s->end - s->first) * PLANE * sizeof(float), &samples);
    gather(s, p->data.positions, vertex_bytes, &positions);
    gather(s, p->data.normals, vertex_bytes, &normals);
    gather(s, own, corners * sizeof *own, &triangles);
    int same = s->rank || is_whole(s, context, how, samples, positions, normals, triangles, p);
    MPI_Bcast(&same, 1, MPI_INT, 0, MPI_COMM_WORLD);
    free(own);
    free(samples);
    free(positions);
    free(normals);
    free(triangles);
    return same;
}

int main(int argc, char **argv) {
    MPI_Init(&argc, &argv);
    slab s = slab_make();
    tc_context *context = NULL;
    tc_context_options options;
    int same = 1;
    tc_context_options_init(&options);
    options.engine = TC_ENGINE_REFERENCE; /* a code with devices leaves this out */
    check(tc_context_create(&options, &context), "the context");
    for (int step = 0; step < STEPS && same; step++) {
        tc_extract_options how;
        tc_extract_options_init(&how);
        how.isovalue = 2.5;
        how.normals = 1;
        how.method = step % 2 ? TC_METHOD_HYBRID : TC_METHOD_TETRA;
        halo_exchange(&s);
        simulate(&s, step);
        halo_exchange(&s);
        piece p = piece_make(&s, context, &how);
        same = compare(&s, context, &how, &p);
        uint64_t most = 0;
        MPI_Reduce(&s.sent_bytes, &most, 1, MPI_UINT64_T, MPI_MAX, 0, MPI_COMM_WORLD);
        if (!s.rank)
            printf("step %d: %llu vertices, %llu triangles of %d ranks, at most %llu bytes to neighbours: %s\n", step,
                   (unsigned long long)p.all[0], (unsigned long long)p.all[1], s.size, (unsigned long long)most,
                   same ? "as by one process" : "OTHER BYTES than by one process");
        tc_mesh_destroy(p.mesh);
    }
    tc_context_destroy(context);
    free(s.heat);
    free(s.next);
    MPI_Finalize();
    return !same;
}
