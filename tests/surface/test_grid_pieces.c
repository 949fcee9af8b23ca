/*
 * test_grid_pieces.c - surfaces of pieces of a grid, one after the other, are the surface of the whole: every byte
 *
 * Random grids of all kinds, methods, missing data, normals and carried fields, cut anywhere that pieces may be cut,
 * with halos of any allowed size; by the reference and on the device, where all fits and in windows. The same as a
 * stream with little memory, of two surfaces at once. Then what is refused, and streams that their callbacks end.
 *
 * Usage: test_grid_pieces [SEED [COUNT]]. A failure names the seed of its grid: `test_grid_pieces SEED 1` repeats it.
 */
#include "engines.h"
#include "random.h"
#include "random_field.h"
#include "samples.h"

#include <inttypes.h>
#include <math.h>

enum { SAMPLES_MAX = 60000, LAYER = 4, SNAP_HALO = 8, ENGINES = 3, AXIS_MAX = 200 };

static tc_context *contexts[ENGINES]; /* reference; device; device whose memory holds windows. NULL: there is none */
static double samples[SAMPLES_MAX], field[SAMPLES_MAX];
static float points[3 * SAMPLES_MAX], axes[3][AXIS_MAX];
static uint8_t blanked[SAMPLES_MAX], blanked_cells[SAMPLES_MAX];
static uint32_t *seams[2];

/* ------------------------------------------------------------------------------------------------------------ grids */

typedef enum grid_kind { UNIFORM, RECTILINEAR, CURVILINEAR, KINDS } grid_kind;

static void places_choose(tc_grid_options *grid, grid_kind kind) {
    const int64_t *d = grid->dims;
    for (int r = 0; r < 3; r++) {
        grid->matrix[r][r] = random_between(0.3, 3) * (random_below(2) ? 1 : -1);
        grid->matrix[r][3] = random_below(3) ? random_between(-100, 100) : 1e7;
        for (int64_t n = 0; n < d[r]; n++) axes[r][n] = (float)n * 1.5f + (float)random_between(0, 1);
    }
    for (int64_t n = 0; n < d[0] * d[1] * d[2]; n++) {
        points[3 * n] = (float)(n % d[0]) + (float)random_between(0, 0.3);
        points[3 * n + 1] = (float)(n / d[0] % d[1]) + (float)random_between(0, 0.3);
        points[3 * n + 2] = (float)(n / d[0] / d[1]) + (float)random_between(0, 0.3);
    }
    for (int r = 0; r < 3 && kind == RECTILINEAR; r++) grid->axes[r] = axes[r];
    if (kind == CURVILINEAR) grid->points = points;
}

static void samples_choose(tc_grid_options *grid) {
    const int64_t *d = grid->dims, count = d[0] * d[1] * d[2];
    const int kind = (int)random_below(RANDOM_FIELDS), rarity = 1 << random_below(8);
    double wave[4];
    wave_choose(wave);
    for (int64_t n = 0; n < count; n++) {
        const double x = (double)(n % d[0]), y = (double)(n / d[0] % d[1]), z = (double)(n / d[0] / d[1]);
        sample_set(samples, grid->type, n, field_value(kind, wave, x, y, z));
        field[n] = random_between(-1, 1);
        blanked[n] = blanked_cells[n] = 0;
    }
    const uint32_t missing = random_below(5);
    for (int64_t n = 0; n < count; n++) {
        if (random_below((uint32_t)rarity + 3)) continue;
        if (missing == 0 && type_is_floating(grid->type)) sample_set(samples, grid->type, n, (double)NAN);
        if (missing == 1) blanked[n] = 1;
        if (missing == 2) blanked_cells[n] = 1;
    }
    if (missing == 1) grid->blanked_samples = blanked;
    if (missing == 2) grid->blanked_cells = blanked_cells;
}

static void grid_choose(tc_grid_options *grid, tc_extract_options *how, grid_kind kind) {
    tc_grid_options_init(grid);
    tc_extract_options_init(how);
    do {
        grid->dims[0] = 2 + random_below(random_below(3) ? 20 : 130);
        grid->dims[1] = 2 + random_below(25);
        grid->dims[2] = 2 + random_below(60);
    } while (grid->dims[0] * grid->dims[1] * grid->dims[2] > SAMPLES_MAX);
    for (int axis = 0; axis < 3; axis++) grid->first_index[axis] = (int64_t)random_below(41) - 20;
    grid->type = random_below(2) ? TC_U8 : TC_F32;
    grid->samples = samples;
    places_choose(grid, kind);
    samples_choose(grid);
    how->isovalue = random_below(3) ? 60.25 : 60;
    how->method = (tc_method)random_below(3);
    how->normals = random_below(2) == 0;
}

/* ----------------------------------------------------------------------------------------------------------- pieces */

/* Planes of the whole: those that are owned, and those with the halo. */
typedef struct range {
    int64_t first, end, low, high;
} range;

/* The piece from a plane on. */
static range range_choose(const tc_grid_options *whole, int64_t first, bool snap) {
    const int64_t nz = whole->dims[2], before = snap ? SNAP_HALO : LAYER, behind = snap ? SNAP_HALO : 2;
    range r = {.first = first, .end = first + LAYER * (1 + random_below(5))};
    if (r.end >= nz - 1) r.end = nz; /* a last piece has cells */
    r.low = first - before - LAYER * random_below(2);
    r.high = r.end + behind + random_below(3);
    if (r.low < 0) r.low = 0;
    if (r.high > nz || r.end == nz) r.high = nz;
    return r;
}

static tc_grid_options piece_of(const tc_grid_options *whole, const range *r) {
    const int64_t *d = whole->dims, plane = d[0] * d[1], cells = (d[0] - 1) * (d[1] - 1);
    tc_grid_options g = *whole;
    g.whole = whole;
    g.dims[2] = r->high - r->low;
    g.first_index[2] += r->low;
    g.owned[0] = r->first - r->low;
    g.owned[1] = r->end - r->low;
    g.samples = (const char *)whole->samples + tc_type_bytes(whole->type) * (size_t)(r->low * plane);
    if (whole->points) g.points = whole->points + 3 * r->low * plane;
    if (whole->axes[2]) g.axes[2] = whole->axes[2] + r->low;
    if (whole->blanked_samples) g.blanked_samples = whole->blanked_samples + r->low * plane;
    if (whole->blanked_cells) g.blanked_cells = whole->blanked_cells + r->low * cells;
    return g;
}

/* A mesh that grows piece by piece. */
typedef struct joined {
    float *positions, *normals, *values;
    uint32_t *triangles;
    uint64_t vertex_count, triangle_count, active_cell_count;
} joined;

static void *grown(void *memory, uint64_t count, size_t bytes) {
    void *more = realloc(memory, (size_t)(count + 1) * bytes);
    if (!more) abort();
    return more;
}

static void join(joined *j, const tc_mesh_data *piece, const float *values) {
    const uint64_t v = j->vertex_count, t = j->triangle_count;
    const uint64_t vertices = v + piece->vertex_count, triangles = t + piece->triangle_count;
    const size_t bytes = 3 * sizeof(float) * (size_t)piece->vertex_count;
    j->positions = grown(j->positions, 3 * vertices, sizeof(float));
    j->normals = grown(j->normals, 3 * vertices, sizeof(float));
    j->values = grown(j->values, vertices, sizeof(float));
    j->triangles = grown(j->triangles, 3 * triangles, sizeof(uint32_t));
    if (bytes) memcpy(j->positions + 3 * v, piece->positions, bytes);
    if (bytes && piece->normals) memcpy(j->normals + 3 * v, piece->normals, bytes);
    if (bytes) memcpy(j->values + v, values, bytes / 3);
    for (uint64_t n = 0; n < 3 * piece->triangle_count; n++)
        j->triangles[3 * t + n] = piece->triangles[n] + (uint32_t)v;
    j->vertex_count = vertices;
    j->triangle_count = triangles;
    j->active_cell_count += piece->active_cell_count;
}

static float *values_carried(tc_grid *grid, const tc_extract_options *how, const double *from, uint64_t count) {
    const tc_field f = {sizeof f, TC_F64, 1, from};
    float *values = grown(NULL, count, sizeof *values);
    EXPECT(tc_interpolate_field(grid, how, &f, values, count) == TC_OK, "carrying: %s", tc_message());
    return values;
}

/* Extracts a piece with the seam of the one behind, then adds it. */
static bool piece_add(tc_context *context, const tc_grid_options *whole, const range *r, const tc_extract_options *how,
                      const uint32_t *seam, const tc_counts *counts, joined *j) {
    const tc_grid_options options = piece_of(whole, r);
    tc_mesh_data data = {.struct_size = sizeof data};
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_status status = tc_grid_create(context, &options, &grid);
    if (!status) status = tc_extract_piece(grid, how, seam, seam ? tc_seam_size(grid) : 0, &mesh);
    if (!status) status = tc_mesh_get(mesh, &data);
    EXPECT(status == TC_OK, "a piece: %s", tc_message());
    EXPECT(status || (counts->vertex_count == data.vertex_count && counts->triangle_count == data.triangle_count &&
                      counts->active_cell_count == data.active_cell_count),
           "a piece is counted otherwise than extracted");
    if (!status) {
        float *values = values_carried(grid, how, field + r->low * whole->dims[0] * whole->dims[1], data.vertex_count);
        join(j, &data, values);
        free(values);
    }
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    return status == TC_OK;
}

static bool piece_count(tc_context *context, const tc_grid_options *whole, const range *r,
                        const tc_extract_options *how, uint32_t *seam, tc_counts *counts) {
    const tc_grid_options options = piece_of(whole, r);
    tc_grid *grid = NULL;
    *counts = (tc_counts){.struct_size = sizeof *counts};
    tc_status status = tc_grid_create(context, &options, &grid);
    if (!status) status = tc_count_piece(grid, how, counts, seam, tc_seam_size(grid));
    EXPECT(status == TC_OK, "counting a piece: %s", tc_message());
    tc_grid_destroy(grid);
    return status == TC_OK;
}

/* Piece n is extracted when piece n + 1 has been counted. */
static bool pieces_join(tc_context *context, const tc_grid_options *whole, const tc_extract_options *how, joined *j) {
    const bool snap = how->method == TC_METHOD_SNAP;
    range r = range_choose(whole, 0, snap);
    tc_counts counts, next_counts;
    bool good = piece_count(context, whole, &r, how, seams[0], &counts);
    for (int n = 0; good; n++) {
        const bool is_last = r.end == whole->dims[2];
        range next = r;
        if (!is_last) next = range_choose(whole, r.end, snap);
        if (!is_last) good = piece_count(context, whole, &next, how, seams[(n + 1) & 1], &next_counts);
        if (good) good = piece_add(context, whole, &r, how, is_last ? NULL : seams[(n + 1) & 1], &counts, j);
        if (is_last) break;
        r = next;
        counts = next_counts;
    }
    return good;
}

/* ---------------------------------------------------------------------------------------------------------- streams */

enum { SURFACES = 2 };

typedef struct flow {
    const tc_grid_options *whole;
    const tc_extract_options *surfaces;
    bool in_place; /* the source has its planes in memory */
    tc_counts counts[SURFACES];
    joined meshes[SURFACES];
    uint64_t before[SURFACES][2]; /* vertices and triangles of earlier streams, where each has a part of the planes */
    int64_t owned[2];
    int64_t last[2];   /* planes asked for last */
    bool backwards;    /* planes were asked for that neither follow these nor are among them */
    int calls, end_at; /* the callback that ends the stream; 0: none */
} flow;

static int flow_call(flow *f) { return ++f->calls == f->end_at; }

static int planes_give(void *user, tc_planes *planes) {
    flow *f = user;
    const int64_t *d = f->whole->dims, plane = d[0] * d[1], cells = (d[0] - 1) * (d[1] - 1), first = planes->first;
    const int64_t cell_planes = planes->count - (first + planes->count == d[2]);
    const size_t bytes = tc_type_bytes(f->whole->type) * (size_t)plane;
    const bool is_within = first >= f->last[0] && first + planes->count <= f->last[1];
    if (f->calls && !is_within && (first < f->last[0] || first + planes->count < f->last[1]) &&
        f->counts[0].struct_size == 0)
        f->backwards = true;
    if (!is_within) f->last[0] = first, f->last[1] = first + planes->count;
    if (f->in_place) {
        planes->samples = (char *)samples + bytes * (size_t)first;
        if (planes->blanked_samples) planes->blanked_samples = blanked + plane * first;
        if (planes->blanked_cells) planes->blanked_cells = blanked_cells + cells * first;
    } else {
        memcpy(planes->samples, (char *)samples + bytes * (size_t)first, bytes * (size_t)planes->count);
        if (planes->blanked_samples)
            memcpy(planes->blanked_samples, blanked + plane * first, (size_t)(plane * planes->count));
        if (planes->blanked_cells)
            memcpy(planes->blanked_cells, blanked_cells + cells * first, (size_t)(cells * cell_planes));
    }
    return flow_call(f);
}

static int counts_take(void *user, size_t surface, const tc_counts *counts) {
    flow *f = user;
    tc_counts *sums = &f->counts[surface];
    sums->struct_size = sizeof *sums;
    sums->vertex_count += counts->vertex_count;
    sums->triangle_count += counts->triangle_count;
    sums->active_cell_count += counts->active_cell_count;
    return flow_call(f);
}

static int piece_take(void *user, const tc_mesh_piece *piece) {
    flow *f = user;
    joined *j = &f->meshes[piece->surface];
    const uint64_t *before = f->before[piece->surface];
    EXPECT(before[0] + piece->first_vertex == j->vertex_count && before[1] + piece->first_triangle == j->triangle_count,
           "a piece of a stream does not follow the one before");
    float *values =
        values_carried(piece->grid, &f->surfaces[piece->surface],
                       field + piece->first_plane * f->whole->dims[0] * f->whole->dims[1], piece->mesh->vertex_count);
    join(j, piece->mesh, values);
    free(values);
    return flow_call(f);
}

static tc_status flow_run(tc_context *context, flow *f, uint64_t budget) {
    tc_stream_options o;
    tc_stream_options_init(&o);
    o.grid = f->whole;
    o.surfaces = f->surfaces;
    o.surface_count = SURFACES;
    o.max_memory_bytes = budget;
    o.read = planes_give;
    o.counted = counts_take;
    o.take = piece_take;
    o.user = f;
    memcpy(o.owned, f->owned, sizeof o.owned);
    return tc_stream(context, &o);
}

static void flow_release(flow *f) {
    for (int n = 0; n < SURFACES; n++) {
        free(f->meshes[n].positions);
        free(f->meshes[n].normals);
        free(f->meshes[n].values);
        free(f->meshes[n].triangles);
    }
}

static void expect_streamed(tc_context *context, const tc_grid_options *whole, const tc_extract_options *how,
                            uint64_t seed) {
    const tc_extract_options surfaces[SURFACES] = {*how, *how};
    const uint64_t plane = tc_type_bytes(whole->type) * (uint64_t)(whole->dims[0] * whole->dims[1]);
    flow f = {.whole = whole, .surfaces = surfaces, .in_place = random_below(2)};
    tc_extract_options *second = (tc_extract_options *)&surfaces[1];
    second->isovalue = 40;
    const bool in_parts = random_below(2);
    tc_status status = TC_OK;
    while (f.owned[1] < whole->dims[2] && !status) {
        f.owned[0] = f.owned[1];
        f.owned[1] = in_parts ? f.owned[1] + LAYER * (1 + random_below(6)) : whole->dims[2];
        if (f.owned[1] > whole->dims[2]) f.owned[1] = whole->dims[2];
        for (int n = 0; n < SURFACES; n++)
            f.before[n][0] = f.meshes[n].vertex_count, f.before[n][1] = f.meshes[n].triangle_count;
        f.calls = 0;
        status = flow_run(context, &f, random_below(8) ? 2 * plane * (1 + random_below(60)) : 0);
    }
    EXPECT(status == TC_OK, "seed %" PRIu64 ": a stream: %s", seed, tc_message());
    EXPECT(in_parts || !f.backwards, "seed %" PRIu64 ": a stream goes backwards", seed);
    for (int n = 0; n < SURFACES && !status; n++) {
        tc_mesh *mesh = NULL;
        tc_mesh_data data;
        const joined *j = &f.meshes[n];
        if (!extract(context, whole, &surfaces[n], &mesh, &data)) continue;
        const tc_mesh_data sum = {.vertex_count = j->vertex_count,
                                  .triangle_count = j->triangle_count,
                                  .active_cell_count = f.counts[n].active_cell_count,
                                  .positions = j->positions,
                                  .normals = data.normals ? j->normals : NULL,
                                  .triangles = j->triangles};
        const char *difference = mesh_difference(&data, &sum);
        EXPECT(!difference, "seed %" PRIu64 ": streamed: %s", seed, difference);
        EXPECT(f.counts[n].vertex_count == data.vertex_count && f.counts[n].triangle_count == data.triangle_count,
               "seed %" PRIu64 ": a stream counts otherwise", seed);
        tc_mesh_destroy(mesh);
    }
    flow_release(&f);
}

static void expect_joined(tc_context *context, const tc_grid_options *options, const tc_extract_options *how,
                          uint64_t seed) {
    tc_mesh_data whole = {.struct_size = sizeof whole};
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    joined j = {0};
    tc_status status = tc_grid_create(context, options, &grid);
    if (!status) status = tc_extract(grid, how, &mesh);
    if (!status) status = tc_mesh_get(mesh, &whole);
    EXPECT(status == TC_OK, "seed %" PRIu64 ": the whole: %s", seed, tc_message());
    float *values = status ? NULL : values_carried(grid, how, field, whole.vertex_count);
    if (!status && pieces_join(context, options, how, &j)) {
        const tc_mesh_data sum = {.vertex_count = j.vertex_count,
                                  .triangle_count = j.triangle_count,
                                  .active_cell_count = j.active_cell_count,
                                  .positions = j.positions,
                                  .normals = whole.normals ? j.normals : NULL,
                                  .triangles = j.triangles};
        const char *difference = mesh_difference(&whole, &sum);
        if (!difference && memcmp(values, j.values, sizeof *values * (size_t)whole.vertex_count))
            difference = "carried values differ";
        EXPECT(!difference, "seed %" PRIu64 ": pieces: %s (method %d, %s)", seed, difference, (int)how->method,
               context == contexts[0]   ? "reference"
               : context == contexts[1] ? "device"
                                        : "windows");
    }
    free(values);
    free(j.positions);
    free(j.normals);
    free(j.values);
    free(j.triangles);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
}

/* In the quick tier few kernels, which other tests build too. */
static bool runs_on_device(const tc_grid_options *grid, const tc_extract_options *how, grid_kind kind) {
    if (!tier_is_quick()) return true;
    if (kind == UNIFORM) return grid->type == TC_U8 && !how->normals;
    return kind == CURVILINEAR && grid->type == TC_F32 && how->normals && how->method == TC_METHOD_TETRA;
}

static void run(uint64_t seed) {
    tc_grid_options grid;
    tc_extract_options how;
    random_state = seed;
    const grid_kind kind = (grid_kind)random_below(KINDS);
    grid_choose(&grid, &how, kind);
    how.closed = random_below(4) == 0;
    expect_joined(contexts[0], &grid, &how, seed);
    expect_streamed(contexts[0], &grid, &how, seed);
    for (int n = 1; n < ENGINES && runs_on_device(&grid, &how, kind); n++)
        if (contexts[n]) {
            expect_joined(contexts[n], &grid, &how, seed);
            expect_streamed(contexts[n], &grid, &how, seed);
        }
}

/* ---------------------------------------------------------------------------------------------------------- refused */

static void expect_no_piece(tc_grid_options options, int64_t low, int64_t high, int64_t first, int64_t end) {
    char what[100];
    tc_grid *grid = NULL;
    options.first_index[2] += low;
    options.dims[2] = high - low;
    options.owned[0] = first - low;
    options.owned[1] = end - low;
    snprintf(what, sizeof what, "planes %d to %d, of which %d to %d are owned", (int)low, (int)high, (int)first,
             (int)end);
    EXPECT_REFUSED(tc_grid_create(contexts[0], &options, &grid), TC_ERROR_ARGUMENT, what);
}

static void test_refused(void) {
    tc_grid_options whole, options;
    tc_extract_options how;
    tc_counts counts = {.struct_size = sizeof counts};
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    random_state = 1;
    grid_choose(&whole, &how, UNIFORM);
    whole.dims[0] = whole.dims[1] = 10, whole.dims[2] = 40;
    how.method = TC_METHOD_TETRA;
    options = whole;
    options.owned[1] = 8;
    EXPECT_REFUSED(tc_grid_create(contexts[0], &options, &grid), TC_ERROR_ARGUMENT, "a piece without its whole");
    options = whole;
    options.whole = &whole;
    expect_no_piece(options, 0, 20, 0, 20);   /* nothing behind */
    expect_no_piece(options, 0, 20, 0, 19);   /* too little behind */
    expect_no_piece(options, 0, 20, 0, 10);   /* no whole layers */
    expect_no_piece(options, 4, 20, 4, 12);   /* nothing before */
    expect_no_piece(options, 3, 20, 8, 12);   /* bricks elsewhere */
    expect_no_piece(options, 0, 20, 6, 12);   /* no whole layers */
    expect_no_piece(options, 0, 20, 12, 12);  /* empty */
    expect_no_piece(options, 30, 44, 36, 44); /* beyond the whole */
    const range r = {8, 16, 4, 18};
    options = piece_of(&whole, &r);
    EXPECT(tc_grid_create(contexts[0], &options, &grid) == TC_OK, "a good piece: %s", tc_message());
    const uint64_t size = tc_seam_size(grid);
    EXPECT(size == 2, "a layer of 10 x 10 samples has 2 bricks, not %d", (int)size);
    EXPECT_REFUSED(tc_extract(grid, &how, &mesh), TC_ERROR_ARGUMENT, "tc_extract of a piece that others follow");
    EXPECT_REFUSED(tc_extract_piece(grid, &how, NULL, 0, &mesh), TC_ERROR_ARGUMENT, "no seam");
    EXPECT_REFUSED(tc_extract_piece(grid, &how, seams[0], size + 1, &mesh), TC_ERROR_ARGUMENT, "another seam");
    EXPECT_REFUSED(tc_count_piece(grid, &how, &counts, NULL, size), TC_ERROR_ARGUMENT, "no room for a seam");
    EXPECT_REFUSED(tc_count_piece(NULL, &how, &counts, seams[0], size), TC_ERROR_ARGUMENT, "no grid");
    how.method = TC_METHOD_SNAP;
    EXPECT_REFUSED(tc_count_piece(grid, &how, &counts, seams[0], size), TC_ERROR_ARGUMENT, "snap with a small halo");
    how.method = TC_METHOD_TETRA;
    seams[0][size - 1] = UINT32_MAX - 100;
    EXPECT_REFUSED(tc_extract_piece(grid, &how, seams[0], size, &mesh), TC_ERROR_LIMIT, "numbers beyond 32 bits");
    tc_grid_destroy(grid);
    EXPECT(tc_grid_create(contexts[0], &whole, &grid) == TC_OK, "the whole: %s", tc_message());
    EXPECT_REFUSED(tc_extract_piece(grid, &how, seams[0], size, &mesh), TC_ERROR_ARGUMENT, "a seam behind the whole");
    tc_grid_destroy(grid);
}

/* Every callback ends the stream in its turn. */
static void test_ended(void) {
    tc_grid_options whole;
    tc_extract_options how;
    random_state = 7;
    do grid_choose(&whole, &how, UNIFORM);
    while (whole.dims[2] < 40 || whole.has_nodata);
    const tc_extract_options surfaces[SURFACES] = {how, how};
    flow f = {.whole = &whole, .surfaces = surfaces};
    EXPECT(flow_run(contexts[0], &f, 1) == TC_OK && f.calls > 20, "a stream with little memory: %s", tc_message());
    const int calls = f.calls;
    flow_release(&f);
    for (int n = 1; n <= calls; n++) {
        f = (flow){.whole = &whole, .surfaces = surfaces, .end_at = n};
        EXPECT_REFUSED(flow_run(contexts[0], &f, 1), TC_ERROR_CANCELLED, "a stream that a callback ends");
        EXPECT(f.calls == n, "a stream goes on after callback %d", n);
        flow_release(&f);
    }
    tc_grid_options bad = whole;
    f = (flow){.whole = &bad, .surfaces = surfaces};
    bad.points = points;
    bad.samples = NULL;
    EXPECT_REFUSED(flow_run(contexts[0], &f, 1), TC_ERROR_ARGUMENT, "a stream of points without samples");
    bad = whole;
    bad.dims[0] = INT64_MAX;
    EXPECT_REFUSED(flow_run(contexts[0], &f, 1), TC_ERROR_DATA, "a stream of a grid that cannot be");
    EXPECT_REFUSED(tc_stream(NULL, NULL), TC_ERROR_ARGUMENT, "a stream without a context");
    EXPECT_REFUSED(tc_stream(contexts[0], NULL), TC_ERROR_ARGUMENT, "a stream without options");
}

int main(int argc, char **argv) {
    const uint64_t seed = argc > 1 ? strtoull(argv[1], NULL, 10) : 1,
                   count = argc > 2 ? strtoull(argv[2], NULL, 10) : tier_count(120);
    tc_context_options options;
    for (int n = 0; n < 2; n++) seams[n] = grown(NULL, AXIS_MAX, sizeof *seams[n]);
    contexts[0] = reference_open();
    if (device_exists()) {
        tc_context_options_init(&options);
        contexts[1] = context_open(&options);
        options.max_memory_bytes = 3 << 20;
        contexts[2] = context_open(&options);
    }
    test_refused();
    test_ended();
    for (uint64_t n = 0; n < count; n++) run(seed + n);
    for (int n = 0; n < ENGINES; n++) tc_context_destroy(contexts[n]);
    for (int n = 0; n < 2; n++) free(seams[n]);
    return EXPECT_DONE();
}
