/*
 * The part of a structured grid between two isovalues. The surface of each bound is numbered as reference.c does it,
 * a layer of bricks ahead; so are the samples within. Then every tetrahedron of the layer is cut by its case. One run
 * counts, another emits.
 */
#include "reference/reference_interval.h"

#include "failure.h"
#include "tables/interval_cases.h"
#include "opencl/context.h"
#include "reference/carry_vertex.h"
#include "reference/reference_run.h"

#include <stdlib.h>

typedef struct interval_run {
    reference bounds[BOUND_COUNT]; /* the surfaces; their signs tell where a sample is */
    tc_mesh surfaces[BOUND_COUNT]; /* where their vertices are in the interval volume */
    uint32_t first[BOUND_COUNT];   /* number of the first vertex of each */
    uint32_t *sample_ids[2];       /* of samples within, for even and odd layers */
    interval_case cases[INTERVAL_CASES];
    ordered_tetrahedron tetrahedra[2][TETRAHEDRA_PER_CUBE];
    tc_interval_volume *interval; /* NULL: count only */
    const carry *carried;
    uint64_t sample_count, tetrahedron_count;
} interval_run;

static unsigned sample_where(const interval_run *v, const int64_t p[3]) {
    if (sample_is(&v->bounds[BOUND_HIGH], p, INSIDE)) return SAMPLE_ABOVE;
    return sample_is(&v->bounds[BOUND_LOW], p, INSIDE) ? SAMPLE_WITHIN : SAMPLE_BELOW;
}

/* -------------------------------------------------------------------------------------------------------- vertices */

static void sample_vertex(interval_run *v, const int64_t p[3]) {
    const reference *r = &v->bounds[BOUND_LOW];
    const uint64_t n = v->sample_count++;
    if (v->carried) carry_vertex(v->carried, n, sample_index(r, p), sample_index(r, p), 0);
    if (!v->interval || n >= v->interval->size.vertices[BLOCK_SAMPLES]) return;
    v->sample_ids[p[2] / BRICK_Z & 1][index_in_layer(r, p)] = (uint32_t)n;
    reference_position(r, p, p, 0, (float *)v->interval->positions.memory + 3 * n);
}

static void row_samples(interval_run *v, int64_t x0, int64_t x1, int64_t y, int64_t z) {
    const reference *r = &v->bounds[BOUND_LOW];
    for (int64_t x = x0; x < x1; x++) {
        const int64_t p[3] = {x, y, z};
        if (sample_where(v, p) == SAMPLE_WITHIN && (r->complete || cubes_present_around(r, p))) sample_vertex(v, p);
    }
}

/* ------------------------------------------------------------------------------------------------------- tetrahedra */

static uint32_t vertex_number(const interval_run *v, const int64_t cube[3], const uint8_t corners[4], unsigned vertex) {
    if (vertex < INTERVAL_LOW) {
        const unsigned c = corners[vertex];
        const int64_t p[3] = {cube[0] + (c & 1), cube[1] + (c >> 1 & 1), cube[2] + (c >> 2)};
        return v->sample_ids[p[2] / BRICK_Z & 1][index_in_layer(&v->bounds[BOUND_LOW], p)];
    }
    const int bound = vertex < INTERVAL_HIGH ? BOUND_LOW : BOUND_HIGH;
    const uint8_t *ends = tetrahedron_edges[vertex - (bound == BOUND_LOW ? INTERVAL_LOW : INTERVAL_HIGH)];
    const owned_vertex e = edge_between(corners[ends[0]], corners[ends[1]]);
    const int64_t owner[3] = {cube[0] + e.dx, cube[1] + e.dy, cube[2] + e.dz};
    return v->first[bound] + *vertex_id(&v->bounds[bound], owner, e.type);
}

/* One of the parts of a tetrahedron; turned over where its corners, in their order, have a negative volume. */
static void part_emit(interval_run *v, const int64_t cube[3], const ordered_tetrahedron *t, const uint8_t part[4],
                      bool is_odd) {
    const uint64_t n = v->tetrahedron_count++;
    if (!v->interval || n >= v->interval->size.tetrahedra) return;
    uint32_t *out = (uint32_t *)v->interval->tetrahedra.memory + 4 * n;
    for (unsigned m = 0; m < 4; m++) out[m] = vertex_number(v, cube, t->corners, part[is_odd && m > 1 ? 5 - m : m]);
}

static void tetrahedron_emit(interval_run *v, const int64_t cube[3], const ordered_tetrahedron *t) {
    unsigned digits = 0;
    for (unsigned n = 4; n-- > 0;) {
        const unsigned c = t->corners[n];
        digits =
            3 * digits + sample_where(v, (int64_t[3]){cube[0] + (c & 1), cube[1] + (c >> 1 & 1), cube[2] + (c >> 2)});
    }
    const interval_case *found = &v->cases[digits];
    const bool is_odd = t->is_odd != v->bounds[BOUND_LOW].grid->mirrored;
    for (unsigned n = 0; n < found->count; n++) part_emit(v, cube, t, found->parts[n], is_odd);
}

static void row_tetrahedra(interval_run *v, int64_t x0, int64_t x1, int64_t y, int64_t z) {
    const reference *r = &v->bounds[BOUND_LOW];
    for (int64_t x = x0; x < x1; x++) {
        const int64_t cube[3] = {x, y, z};
        if (!cube_present(r, cube)) continue;
        for (unsigned n = 0; n < TETRAHEDRA_PER_CUBE; n++)
            tetrahedron_emit(v, cube, &v->tetrahedra[cube_parity(r, cube)][n]);
    }
}

/* ---------------------------------------------------------------------------------------------------------- layers */

typedef void interval_stage(interval_run *v, int64_t x0, int64_t x1, int64_t y, int64_t z);

static int64_t least(int64_t a, int64_t b) { return a < b ? a : b; }

static void layer_run(interval_run *v, int64_t layer, interval_stage *stage) {
    const int64_t *dims = v->bounds[BOUND_LOW].dims, z0 = layer * BRICK_Z;
    for (int64_t y0 = 0; y0 < dims[1]; y0 += BRICK_Y)
        for (int64_t x0 = 0; x0 < dims[0]; x0 += BRICK_X)
            for (int64_t z = z0; z < least(z0 + BRICK_Z, dims[2]); z++)
                for (int64_t y = y0; y < least(y0 + BRICK_Y, dims[1]); y++)
                    stage(v, x0, least(x0 + BRICK_X, dims[0]), y, z);
}

static void layer_vertices(interval_run *v, int64_t layer) {
    for (int n = 0; n < BOUND_COUNT; n++) reference_layer_vertices(&v->bounds[n], layer);
    layer_run(v, layer, row_samples);
}

/* before, share: where this stage begins in the whole call and its share of it, for progress. */
static tc_status layers_run(interval_run *v, const char *stage, double before, double share) {
    const int64_t count = (v->bounds[BOUND_LOW].dims[2] + BRICK_Z - 1) / BRICK_Z;
    tc_status status = TC_OK;
    v->sample_count = v->tetrahedron_count = 0;
    for (int n = 0; n < BOUND_COUNT; n++) v->bounds[n].vertex_count = 0;
    layer_vertices(v, 0);
    for (int64_t layer = 0; layer < count && !status; layer++) {
        if (layer + 1 < count) layer_vertices(v, layer + 1);
        layer_run(v, layer, row_tetrahedra);
        status = context_progress(v->bounds[BOUND_LOW].grid->context, stage,
                                  before + share * (double)(layer + 1) / (double)count);
    }
    return status;
}

static tc_status run_begin(interval_run *v, const tc_grid *grid, const tc_interval_volume_options *options) {
    tc_status status = TC_OK;
    *v = (interval_run){0};
    interval_cases_derive(v->cases);
    for (unsigned n = 0; n < 2 * TETRAHEDRA_PER_CUBE; n++)
        v->tetrahedra[n / TETRAHEDRA_PER_CUBE][n % TETRAHEDRA_PER_CUBE] =
            tetrahedron_order(n / TETRAHEDRA_PER_CUBE, n % TETRAHEDRA_PER_CUBE);
    for (int n = 0; n < BOUND_COUNT && !status; n++) {
        tc_extract_options surface;
        tc_extract_options_init(&surface);
        surface.isovalue = n == BOUND_LOW ? options->low : options->high;
        status = reference_begin(&v->bounds[n], grid, &surface);
    }
    return status;
}

static void run_end(interval_run *v) {
    for (int n = 0; n < BOUND_COUNT; n++) reference_end(&v->bounds[n]);
    free(v->sample_ids[0]);
    free(v->sample_ids[1]);
}

static interval_size run_size(const interval_run *v) {
    return (interval_size){{v->sample_count, v->bounds[BOUND_LOW].vertex_count, v->bounds[BOUND_HIGH].vertex_count},
                           v->tetrahedron_count};
}

/* Room for numbers, and where vertices go. */
static tc_status run_prepare(interval_run *v, tc_interval_volume *interval) {
    tc_status status = TC_OK;
    v->interval = interval;
    for (int n = 0; n < BOUND_COUNT && !status; n++) {
        const uint64_t first = interval_first(&interval->size, BLOCK_LOW + n);
        v->first[n] = (uint32_t)first;
        v->surfaces[n].channels[CHANNEL_POSITIONS].memory = (float *)interval->positions.memory + 3 * first;
        v->surfaces[n].vertex_count = interval->size.vertices[BLOCK_LOW + n];
        v->bounds[n].mesh = &v->surfaces[n];
        status = reference_ids_allocate(&v->bounds[n]);
    }
    const reference *r = &v->bounds[BOUND_LOW];
    for (int n = 0; n < 2 && !status; n++)
        if (!(v->sample_ids[n] = calloc((size_t)(r->dims[0] * r->dims[1]) * BRICK_Z, sizeof *v->sample_ids[n])))
            status = (tc_status)fail(TC_ERROR_MEMORY, "no memory for vertex numbers");
    return status;
}

/* Whether as much was emitted as was counted: not where the caller has changed its arrays in between. */
static tc_status run_complete(const interval_run *v) {
    const interval_size *size = &v->interval->size;
    tc_status status = TC_OK;
    for (int n = 0; n < BOUND_COUNT && !status; n++) status = reference_complete(&v->bounds[n], false);
    if (status || (v->sample_count == size->vertices[BLOCK_SAMPLES] && v->tetrahedron_count == size->tetrahedra))
        return status;
    return (tc_status)fail(TC_ERROR_DATA, "samples have changed while an interval volume was made of them");
}

tc_status reference_interval_count(const tc_grid *grid, const tc_interval_volume_options *options,
                                   interval_size *size) {
    interval_run v;
    tc_status status = run_begin(&v, grid, options);
    if (!status) status = layers_run(&v, "classify", 0, 1);
    *size = run_size(&v);
    run_end(&v);
    return status;
}

tc_status reference_interval_extract(const tc_grid *grid, const tc_interval_volume_options *options,
                                     tc_interval_volume *interval) {
    interval_run v;
    const double start = clock_ms();
    tc_status status = run_begin(&v, grid, options);
    if (!status) status = layers_run(&v, "classify", 0, 0.5);
    const double classified = clock_ms();
    const interval_size size = run_size(&v);
    if (!status) status = interval_allocate(interval, &size);
    if (!status) status = run_prepare(&v, interval);
    if (!status) status = layers_run(&v, "emit", 0.5, 0.5);
    if (!status) status = run_complete(&v);
    interval->timings.classify_ms = classified - start;
    interval->timings.emit_ms = clock_ms() - classified;
    interval->timings.total_ms = clock_ms() - start;
    run_end(&v);
    return status;
}

tc_status reference_interval_carry(const tc_grid *grid, const tc_interval_volume_options *options, const carry *c,
                                   uint64_t *count) {
    interval_run v;
    tc_status status = run_begin(&v, grid, options);
    v.carried = c;
    const int64_t layers = (grid->dims[2] + BRICK_Z - 1) / BRICK_Z;
    for (int64_t layer = 0; layer < layers && !status; layer++) {
        layer_run(&v, layer, row_samples);
        status = context_progress(grid->context, "carry", (double)(layer + 1) / (double)layers);
    }
    *count = v.sample_count;
    run_end(&v);
    return status;
}
