/*
 * test_labels.c - surfaces of label maps: every label by itself is the surface of its samples, and neighbours share
 * theirs
 *
 * All patterns of up to four labels on one cube, thousands of random grids with up to eight: each triangle is walked to
 * its tetrahedron, each label's surface compared with what the signs of its samples ask for (label_walk.h). One label
 * gives the bytes of an isosurface. Labels that are not wanted, missing samples, other types, and the layer of
 * background of closed surfaces give the bytes of a volume that has them so. Device and reference are compared byte for
 * byte.
 *
 * Usage: test_labels [SEED [COUNT [all]]], or test_labels alone|groups [always_copy] [SEED [COUNT]] for kernels of that
 * variant beside the reference. A failure names the seed of its grid: `test_labels SEED 1` repeats it.
 */
#include "engines.h"
#include "label_walk.h"
#include "random.h"

#include <inttypes.h>
#include <math.h>

enum { SAMPLES_MAX = 40000, LABELS = 8 };

static tc_context *reference, *device; /* device: NULL where there is none */
static uint8_t samples[SAMPLES_MAX];

static void grid_begin(tc_grid_options *grid, int64_t nx, int64_t ny, int64_t nz) {
    tc_grid_options_init(grid);
    grid->dims[0] = nx, grid->dims[1] = ny, grid->dims[2] = nz;
    grid->type = TC_U8;
    grid->samples = samples;
}

static int64_t sample_count(const tc_grid_options *grid) { return grid->dims[0] * grid->dims[1] * grid->dims[2]; }

static void options_begin(tc_labels_options *how) {
    tc_labels_options_init(how);
    how->smoothing = 0;
}

static bool extract_labels(tc_context *context, const tc_grid_options *options, const tc_labels_options *how,
                           tc_mesh **mesh, tc_mesh_data *data) {
    tc_grid *grid = NULL;
    *data = (tc_mesh_data){.struct_size = sizeof *data};
    tc_status status = tc_grid_create(context, options, &grid);
    if (!status) status = tc_extract_labels(grid, how, mesh);
    if (!status) status = tc_mesh_get(*mesh, data);
    tc_grid_destroy(grid);
    EXPECT(status == TC_OK, "extraction fails with status %d: %s", (int)status, tc_message());
    return status == TC_OK;
}

/* Both volumes, with their options, give the same mesh. */
static void expect_same(const tc_grid_options *a, const tc_labels_options *how_a, const tc_grid_options *b,
                        const tc_labels_options *how_b, const char *name) {
    tc_mesh *meshes[2] = {NULL, NULL};
    tc_mesh_data data[2];
    if (extract_labels(reference, a, how_a, &meshes[0], &data[0]) &&
        extract_labels(reference, b, how_b, &meshes[1], &data[1])) {
        const char *difference = mesh_difference(&data[0], &data[1]);
        EXPECT(!difference, "%s: %s", name, difference);
    }
    for (int n = 0; n < 2; n++) tc_mesh_destroy(meshes[n]);
}

static void expect_walked(const tc_grid_options *grid, const char *name) {
    static tc_mesh *meshes[2];
    tc_labels_options how;
    tc_mesh_data data, other;
    options_begin(&how);
    if (!extract_labels(reference, grid, &how, &meshes[0], &data)) return;
    const char *fault = label_walk_fault(grid, &data);
    EXPECT(!fault, "%s: %s", name, fault);
    if (!device || !test_chosen(name) || !extract_labels(device, grid, &how, &meshes[1], &other)) return;
    const char *difference = mesh_difference(&data, &other);
    EXPECT(!difference, "%s: device and reference: %s", name, difference);
}

/* --------------------------------------------------------------------------------------------------------- patterns */

/* Up to four labels on the corners of a cube, of either parity. all: every assignment; else of assignments that differ
 * only in names one. */
static void test_patterns(bool all) {
    static const uint8_t names[2][4] = {{0, 1, 2, 3}, {3, 1, 0, 2}};
    tc_grid_options grid;
    grid_begin(&grid, 2, 2, 2);
    for (unsigned pattern = 0; pattern < 1u << 16; pattern++) {
        unsigned most = 0;
        bool is_first = true; /* labels are met in their order */
        for (unsigned c = 0; c < 8; c++) {
            const unsigned label = pattern >> 2 * c & 3;
            is_first = is_first && label <= most;
            most = label >= most ? label + 1 : most;
        }
        if (!all && !is_first) continue;
        for (unsigned odd = 0; odd < 2; odd++) {
            char name[64];
            for (unsigned c = 0; c < 8; c++)
                samples[c] = names[(pattern ^ pattern >> 7 ^ odd) & 1][pattern >> 2 * c & 3];
            grid.first_index[0] = odd;
            snprintf(name, sizeof name, "pattern %u, %s cube", pattern, odd ? "odd" : "even");
            expect_walked(&grid, name);
        }
    }
}

/* ----------------------------------------------------------------------------------------------------- random grids */

static int64_t size_choose(bool large) {
    return large ? 2 + random_below(random_below(2) ? 140 : 12) : 2 + random_below(6);
}

/* Noise, or cells around random centres, so that some samples are like their neighbours. */
static void samples_choose(const tc_grid_options *grid, unsigned labels) {
    const bool is_noise = random_below(3) == 0;
    const unsigned centres = 2 * labels;
    double at[2 * LABELS][3];
    for (unsigned n = 0; n < centres; n++)
        for (int axis = 0; axis < 3; axis++) at[n][axis] = random_between(0, (double)grid->dims[axis]);
    for (int64_t n = 0; n < sample_count(grid); n++) {
        const double p[3] = {(double)(n % grid->dims[0]), (double)(n / grid->dims[0] % grid->dims[1]),
                             (double)(n / grid->dims[0] / grid->dims[1])};
        double least = 1e9;
        samples[n] = (uint8_t)random_below(labels);
        for (unsigned c = 0; c < centres && !is_noise; c++) {
            double distance = 0;
            for (int axis = 0; axis < 3; axis++) distance += (p[axis] - at[c][axis]) * (p[axis] - at[c][axis]);
            if (distance < least) least = distance, samples[n] = (uint8_t)(c % labels);
        }
    }
}

static void grid_choose(tc_grid_options *grid, uint64_t seed, bool large) {
    random_state = seed;
    do grid_begin(grid, size_choose(large), size_choose(large), size_choose(large));
    while (sample_count(grid) > SAMPLES_MAX);
    for (int axis = 0; axis < 3; axis++) grid->first_index[axis] = (int64_t)random_below(5) - 2;
    samples_choose(grid, 2 + random_below(LABELS - 1));
}

static void run(uint64_t seed, bool large) {
    tc_grid_options grid;
    char name[80];
    grid_choose(&grid, seed, large);
    snprintf(name, sizeof name, "seed %" PRIu64 ", %s, %d x %d x %d", seed, large ? "large" : "small",
             (int)grid.dims[0], (int)grid.dims[1], (int)grid.dims[2]);
    expect_walked(&grid, name);
}

/* ------------------------------------------------------------------------------------------------------- promises */

/* One label: the bytes of the isosurface, also where the grid is mirrored and sheared. */
static void test_one_label(void) {
    static const double matrix[3][4] = {{-0.5, 0.1, 0, 3}, {0.2, 0.7, 0, -1}, {0, 0.3, 2, 5}};
    tc_grid_options grid;
    tc_labels_options how;
    tc_extract_options isosurface;
    tc_mesh *meshes[2] = {NULL, NULL};
    tc_mesh_data labels, surface;
    grid_choose(&grid, 11, true);
    grid_begin(&grid, 70, 11, 9);
    samples_choose(&grid, 2);
    memcpy(grid.matrix, matrix, sizeof matrix);
    options_begin(&how);
    tc_extract_options_init(&isosurface);
    isosurface.isovalue = 0.5;
    if (extract_labels(reference, &grid, &how, &meshes[0], &labels) &&
        extract(reference, &grid, &isosurface, &meshes[1], &surface)) {
        EXPECT(labels.boundary_labels && !surface.boundary_labels, "labels of a label map, and of an isosurface");
        labels.boundary_labels = NULL;
        const char *difference = mesh_difference(&labels, &surface);
        EXPECT(!difference && labels.triangle_count > 500, "one label, and its isosurface: %s", difference);
    }
    for (int n = 0; n < 2; n++) tc_mesh_destroy(meshes[n]);
}

/* Labels that are not wanted are background, as are missing samples. */
static void test_wanted(void) {
    static uint8_t kept[SAMPLES_MAX], blanked[SAMPLES_MAX];
    static const uint32_t wanted[] = {5, 1, 70000, 4};
    tc_grid_options grid, other;
    tc_labels_options how, all;
    grid_begin(&grid, 20, 13, 11);
    random_state = 12;
    samples_choose(&grid, LABELS);
    other = grid;
    other.samples = kept;
    grid.has_nodata = 1;
    grid.nodata = 4;
    grid.blanked_samples = blanked;
    for (int64_t n = 0; n < sample_count(&grid); n++) {
        blanked[n] = random_below(10) == 0;
        kept[n] = (samples[n] == 5 || samples[n] == 1) && !blanked[n] ? samples[n] : 0;
    }
    options_begin(&how);
    options_begin(&all);
    how.labels = wanted;
    how.label_count = sizeof wanted / sizeof *wanted;
    expect_same(&grid, &how, &other, &all, "labels that are wanted");
}

/* Other types; negative samples are background. */
static void test_types(void) {
    static uint32_t memory[SAMPLES_MAX];
    static uint8_t low[SAMPLES_MAX];
    static const tc_type types[] = {TC_I8, TC_U16, TC_I16, TC_U32, TC_I32};
    tc_grid_options grid, other;
    tc_labels_options how;
    grid_begin(&grid, 20, 13, 11);
    random_state = 13;
    samples_choose(&grid, LABELS);
    options_begin(&how);
    for (unsigned t = 0; t < sizeof types / sizeof *types; t++) {
        const bool is_signed = types[t] != TC_U16 && types[t] != TC_U32;
        other = grid;
        other.type = types[t];
        other.samples = memory;
        for (int64_t n = 0; n < sample_count(&grid); n++) {
            const int value = is_signed && samples[n] == 2 ? -3 : samples[n];
            low[n] = value < 0 ? 0 : samples[n];
            if (types[t] == TC_I8)
                ((int8_t *)memory)[n] = (int8_t)value;
            else if (tc_type_bytes(types[t]) == 2)
                ((int16_t *)memory)[n] = (int16_t)value;
            else
                ((int32_t *)memory)[n] = value;
        }
        grid.samples = low;
        expect_same(&grid, &how, &other, &how, tc_type_name(types[t]));
        grid.samples = samples;
    }
}

/* Closed: as if the volume had a layer of background around it. */
static void test_closed(void) {
    static uint8_t around[SAMPLES_MAX];
    tc_grid_options grid, other;
    tc_labels_options how, closed;
    tc_mesh *mesh = NULL;
    tc_mesh_data data;
    grid_begin(&grid, 20, 13, 11);
    random_state = 14;
    samples_choose(&grid, LABELS);
    other = grid;
    other.samples = around;
    for (int axis = 0; axis < 3; axis++) other.dims[axis] += 2, other.first_index[axis]--;
    for (int64_t n = 0; n < sample_count(&grid); n++) {
        const int64_t x = n % 20 + 1, y = n / 20 % 13 + 1, z = n / 260 + 1;
        around[(z * other.dims[1] + y) * other.dims[0] + x] = samples[n];
    }
    options_begin(&how);
    closed = how;
    closed.closed = 1;
    expect_same(&grid, &closed, &other, &how, "closed");
    if (extract_labels(reference, &grid, &closed, &mesh, &data)) {
        const char *fault = label_walk_fault(&other, &data);
        EXPECT(!fault, "closed: %s", fault);
    }
    tc_mesh_destroy(mesh);
}

/* On other grids vertices are the middles of points; closed ones end half a cell beyond. */
static void test_other_grids(void) {
    static float axes[3][20], points[20 * 13 * 11][3];
    tc_grid_options uniform, rectilinear, curvilinear;
    tc_labels_options how;
    grid_begin(&uniform, 20, 13, 11);
    random_state = 15;
    samples_choose(&uniform, LABELS);
    for (int axis = 0; axis < 3; axis++) {
        uniform.matrix[axis][axis] = -0.5;
        for (int n = 0; n < 20; n++) axes[axis][n] = -0.5f * (float)n;
    }
    for (int64_t n = 0; n < sample_count(&uniform); n++) {
        points[n][0] = axes[0][n % 20];
        points[n][1] = axes[1][n / 20 % 13];
        points[n][2] = axes[2][n / 260];
    }
    rectilinear = curvilinear = uniform;
    for (int axis = 0; axis < 3; axis++) rectilinear.axes[axis] = axes[axis];
    curvilinear.points = points[0];
    options_begin(&how);
    for (how.closed = 0; how.closed < 2; how.closed++) {
        tc_mesh *meshes[3] = {NULL, NULL, NULL};
        tc_mesh_data data[3];
        const tc_grid_options *grids[3] = {&uniform, &rectilinear, &curvilinear};
        bool is_made = true;
        for (int n = 0; n < 3; n++)
            is_made = extract_labels(reference, grids[n], &how, &meshes[n], &data[n]) && is_made;
        for (int n = 1; n < 3 && is_made; n++) {
            double most = 0;
            for (uint64_t v = 0; v < 3 * data[0].vertex_count && data[n].vertex_count == data[0].vertex_count; v++) {
                const double apart = (double)data[0].positions[v] - (double)data[n].positions[v];
                most = apart > most ? apart : -apart > most ? -apart : most;
            }
            EXPECT(most < 1e-6 && data[n].vertex_count == data[0].vertex_count &&
                       !memcmp(data[0].triangles, data[n].triangles, 12 * (size_t)data[0].triangle_count),
                   "grid %d has another surface, %g away", n, most);
        }
        for (int n = 0; n < 3; n++) tc_mesh_destroy(meshes[n]);
    }
}

/* ------------------------------------------------------------------------------------------------------- smoothing */

typedef struct joined {
    uint32_t from, to;
} joined;

static int joined_order(const void *a, const void *b) {
    const joined *p = a, *q = b;
    if (p->from != q->from) return p->from < q->from ? -1 : 1;
    return p->to < q->to ? -1 : p->to > q->to;
}

/* Where one sweep takes a vertex, along an axis; sides: its edges, once for each triangle there, `count` of them. */
static double swept(const tc_grid_options *grid, const tc_mesh_data *mesh, const joined *sides, size_t count,
                    int axis) {
    const double old = (double)mesh->positions[3 * (uint64_t)sides->from + (uint64_t)axis];
    double sums[3] = {0, 0, 0}, numbers[3] = {0, 0, 0}; /* of edges with one triangle, two, more */
    for (size_t n = 0, end; n < count; n = end) {
        for (end = n + 1; end < count && sides[end].to == sides[n].to;) end++;
        const int kind = end - n > 2 ? 2 : (int)(end - n) - 1;
        sums[kind] += (double)mesh->positions[3 * (uint64_t)sides[n].to + (uint64_t)axis] - old;
        numbers[kind]++;
    }
    double moved = 0.75 * (sums[0] + sums[1] + sums[2]) / (numbers[0] + numbers[1] + numbers[2]);
    if (numbers[2] > 0) moved = 0.75 * sums[2] / numbers[2];
    if (numbers[0] > 0) moved = 0.75 * sums[0] / numbers[0];
    if (numbers[0] > 0 && (old == 0 || old == (double)(grid->dims[axis] - 1))) moved = 0;
    return old + (moved > 0.45 ? 0.45 : moved < -0.45 ? -0.45 : moved);
}

/* The farthest that a vertex of a mesh that was smoothed by one sweep is from where it should be. */
static double sweep_error(const tc_grid_options *grid, const tc_mesh_data *before, const tc_mesh_data *after) {
    const size_t count = 6 * (size_t)before->triangle_count;
    joined *sides = malloc((count + 1) * sizeof *sides);
    double most = 0;
    if (!sides) exit(EXIT_FAILURE);
    for (size_t n = 0; n < count / 2; n++) {
        const uint32_t a = before->triangles[n], b = before->triangles[n % 3 == 2 ? n - 2 : n + 1];
        sides[2 * n] = (joined){a, b}, sides[2 * n + 1] = (joined){b, a};
    }
    qsort(sides, count, sizeof *sides, joined_order);
    for (size_t n = 0, end; n < count; n = end) {
        for (end = n + 1; end < count && sides[end].from == sides[n].from;) end++;
        for (int axis = 0; axis < 3; axis++) {
            const double found = (double)after->positions[3 * (uint64_t)sides[n].from + (uint64_t)axis];
            most = fmax(most, fabs(found - swept(grid, before, sides + n, end - n, axis)));
        }
    }
    free(sides);
    return most;
}

/* So many vertices that several ranges of them are smoothed, each sample with a label of its own. */
static void test_ranges(void) {
    tc_mesh *meshes[2] = {NULL, NULL};
    tc_grid_options grid;
    tc_labels_options how;
    tc_mesh_data stairs, smooth;
    grid_begin(&grid, 23, 16, 15);
    for (int64_t n = 0; n < sample_count(&grid); n++) samples[n] = (uint8_t)random_between(0, LABELS);
    options_begin(&how);
    bool is_made = extract_labels(reference, &grid, &how, &meshes[0], &stairs);
    how.smoothing = 1;
    is_made = is_made && extract_labels(reference, &grid, &how, &meshes[1], &smooth);
    if (is_made) {
        EXPECT(stairs.vertex_count > 1 << 16, "%d vertices are too few", (int)stairs.vertex_count);
        EXPECT(sweep_error(&grid, &stairs, &smooth) < 1e-5, "a vertex is %g from where one sweep takes it",
               sweep_error(&grid, &stairs, &smooth));
    }
    for (int n = 0; n < 2; n++) tc_mesh_destroy(meshes[n]);
}

/* Triangles stay, vertices keep to their boxes, those on the border to it; surfaces get smaller. */
static void test_smoothing(void) {
    static tc_mesh *meshes[3];
    tc_grid_options grid;
    tc_labels_options how;
    tc_mesh_data stairs, smooth, again;
    double areas[2] = {0, 0};
    grid_begin(&grid, 33, 31, 29);
    random_state = 16;
    for (;;) { /* no noise */
        samples_choose(&grid, LABELS);
        if (samples[0] == samples[1] && samples[1] == samples[2] && samples[2] == samples[3]) break;
    }
    options_begin(&how);
    if (!extract_labels(reference, &grid, &how, &meshes[0], &stairs)) return;
    how.smoothing = 1;
    if (!extract_labels(reference, &grid, &how, &meshes[1], &smooth)) return;
    EXPECT(sweep_error(&grid, &stairs, &smooth) < 1e-5, "a vertex is %g from where one sweep takes it",
           sweep_error(&grid, &stairs, &smooth));
    how.smoothing = 16;
    if (!extract_labels(reference, &grid, &how, &meshes[1], &smooth)) return;
    if (!extract_labels(reference, &grid, &how, &meshes[2], &again)) return;
    EXPECT(!mesh_difference(&smooth, &again), "smoothed twice: %s", mesh_difference(&smooth, &again));
    EXPECT(!memcmp(stairs.triangles, smooth.triangles, 12 * (size_t)stairs.triangle_count) &&
               smooth.vertex_count == stairs.vertex_count,
           "smoothing changes triangles");
    double most = 0;
    uint64_t off_border = 0;
    for (uint64_t n = 0; n < 3 * stairs.vertex_count; n++) {
        const double from = (double)stairs.positions[n], to = (double)smooth.positions[n];
        most = to - from > most ? to - from : from - to > most ? from - to : most;
        off_border += (from == 0 || from == (double)(grid.dims[n % 3] - 1)) && to != from;
    }
    EXPECT(most <= 0.45001 && most > 0.2, "a vertex moves by %g", most);
    EXPECT(off_border == 0, "%d vertices leave the grid's border", (int)off_border);
    for (int m = 0; m < 2; m++) {
        const tc_mesh_data *mesh = m ? &smooth : &stairs;
        for (uint64_t t = 0; t < mesh->triangle_count; t++) {
            double p[3][3], u[3], v[3], n[3];
            for (int c = 0; c < 3; c++)
                for (uint64_t axis = 0; axis < 3; axis++)
                    p[c][axis] = (double)mesh->positions[3 * (uint64_t)mesh->triangles[3 * t + (uint64_t)c] + axis];
            for (int axis = 0; axis < 3; axis++) u[axis] = p[1][axis] - p[0][axis], v[axis] = p[2][axis] - p[0][axis];
            for (int axis = 0; axis < 3; axis++)
                n[axis] = u[(axis + 1) % 3] * v[(axis + 2) % 3] - u[(axis + 2) % 3] * v[(axis + 1) % 3];
            areas[m] += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        }
    }
    EXPECT(areas[1] < 0.95 * areas[0] && areas[1] > 0.5 * areas[0], "areas %g and %g", areas[0], areas[1]);
    for (int n = 0; n < 3; n++) tc_mesh_destroy(meshes[n]);
}

/* ----------------------------------------------------------------------------------------------------------- faults */

/* What is planted into a mesh is found by what all grids are checked with. */
static void test_faults_are_found(void) {
    tc_grid_options grid;
    tc_labels_options how;
    tc_mesh *mesh = NULL;
    tc_mesh_data data;
    grid_begin(&grid, 9, 8, 7);
    random_state = 17;
    samples_choose(&grid, LABELS);
    options_begin(&how);
    if (!extract_labels(reference, &grid, &how, &mesh, &data)) return;
    const size_t triangle_bytes = 12 * (size_t)data.triangle_count, label_bytes = 8 * (size_t)data.triangle_count;
    const size_t position_bytes = 12 * (size_t)data.vertex_count;
    uint32_t *triangles = malloc(triangle_bytes), *labels = malloc(label_bytes);
    float *positions = malloc(position_bytes);
    if (!triangles || !labels || !positions) exit(EXIT_FAILURE);
    memcpy(triangles, data.triangles, triangle_bytes);
    memcpy(labels, data.boundary_labels, label_bytes);
    memcpy(positions, data.positions, position_bytes);
    data.triangles = triangles;
    data.boundary_labels = labels;
    data.positions = positions;
    EXPECT(!label_walk_fault(&grid, &data), "%s", label_walk_fault(&grid, &data));
    for (int n = 0; n < 100; n++) {
        const uint32_t t = random_below((uint32_t)data.triangle_count), c = random_below(3);
        uint32_t *corner = &triangles[3 * t + c], *other = &triangles[3 * t + (c + 1) % 3], old = *corner,
                 next = *other;
        *corner = (old + 1 + random_below((uint32_t)data.vertex_count - 1)) % (uint32_t)data.vertex_count;
        EXPECT(label_walk_fault(&grid, &data), "a corner moved from %u to %u is not found", old, *corner);
        *corner = next, *other = old;
        EXPECT(label_walk_fault(&grid, &data), "a triangle turned over is not found");
        *corner = old, *other = next;
        uint32_t *label = &labels[2 * t + random_below(2)], was = *label;
        *label = (was + 1 + random_below(LABELS - 1)) % LABELS;
        EXPECT(label_walk_fault(&grid, &data), "a label changed from %u to %u is not found", was, *label);
        *label = was;
        float *place = &positions[3 * old + random_below(3)], stood = *place;
        *place += 0.25f;
        EXPECT(label_walk_fault(&grid, &data), "a vertex moved is not found");
        *place = stood;
    }
    data.triangle_count--;
    EXPECT(label_walk_fault(&grid, &data), "a missing triangle is not found");
    free(triangles);
    free(labels);
    free(positions);
    tc_mesh_destroy(mesh);
}

static void expect_refused(const tc_grid_options *options, const tc_labels_options *how, const char *word) {
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    EXPECT(tc_grid_create(reference, options, &grid) == TC_OK, "no grid: %s", tc_message());
    EXPECT(tc_extract_labels(grid, how, &mesh) == TC_ERROR_ARGUMENT && strstr(tc_message(), word) && !mesh, "%s: %s",
           word, tc_message());
    tc_grid_destroy(grid);
}

static void test_refused(void) {
    static const float reals[8];
    static const float axis[2] = {0, 1};
    static const uint32_t background[] = {3, 0};
    tc_grid_options grid;
    tc_labels_options how;
    grid_begin(&grid, 2, 2, 2);
    options_begin(&how);
    how.label_count = 1;
    expect_refused(&grid, &how, "label_count");
    how.labels = background;
    how.label_count = 2;
    expect_refused(&grid, &how, "background");
    options_begin(&how);
    how.smoothing = 1001;
    expect_refused(&grid, &how, "1000");
    how.smoothing = 16;
    for (int n = 0; n < 3; n++) grid.axes[n] = axis;
    expect_refused(&grid, &how, "uniform");
    options_begin(&how);
    grid_begin(&grid, 2, 2, 2);
    grid.type = TC_F32;
    grid.samples = reals;
    expect_refused(&grid, &how, "integers");
    how.struct_size = 0;
    expect_refused(&grid, &how, "options");
}

/* Types and sizes, parts and closed surfaces; in slabs too, by small budgets. */
static void expect_device_same(const tc_context_options *options, const char *name) {
    static uint32_t wide[SAMPLES_MAX];
    static const uint32_t wanted[] = {1, 3, 6};
    static const tc_type types[] = {TC_U8, TC_U16, TC_U32, TC_I16};
    static const double matrix[3][4] = {{-0.5, 0.1, 0, 3}, {0.2, 0.7, 0, -1}, {0, 0.3, 2, 5}};
    tc_context *context = context_open(options);
    tc_mesh *meshes[2] = {NULL, NULL};
    unsigned in_slabs = 0;
    for (unsigned n = 0; n < 24; n++) {
        tc_grid_options grid;
        tc_labels_options how;
        tc_mesh_data data[2];
        grid_choose(&grid, 100 + n, true);
        if (n % 3 == 0 || options->max_memory_bytes)
            grid_begin(&grid, 63 + n / 3 % 3, 9, 40), samples_choose(&grid, LABELS);
        const tc_type type = types[n % 4];
        for (int64_t at = 0; at < sample_count(&grid); at++) {
            const uint32_t label = n % 4 == 2 && samples[at] ? samples[at] + 4000000000u : samples[at];
            if (type == TC_U8)
                ((uint8_t *)wide)[at] = samples[at];
            else if (type == TC_U32)
                wide[at] = label;
            else
                ((uint16_t *)wide)[at] = samples[at];
        }
        grid.type = type;
        grid.samples = wide;
        if (n % 5 == 1) memcpy(grid.matrix, matrix, sizeof matrix);
        options_begin(&how);
        how.closed = n % 2;
        how.smoothing = n % 7 == 0 ? 3 : 0;
        if (n % 6 == 5) how.labels = wanted, how.label_count = 3;
        if (!extract_labels(reference, &grid, &how, &meshes[0], &data[0])) continue;
        if (!extract_labels(context, &grid, &how, &meshes[1], &data[1])) continue;
        const char *difference = mesh_difference(&data[0], &data[1]);
        EXPECT(!difference, "%s, volume %u, %s: %s", name, n, tc_type_name(type), difference);
        in_slabs += data[1].slab_count > 1;
        if (options->max_memory_bytes) expect_within(context, options->max_memory_bytes, name);
    }
    EXPECT(!options->max_memory_bytes || in_slabs > 5, "%u volumes in slabs", in_slabs);
    for (int n = 0; n < 2; n++) tc_mesh_destroy(meshes[n]);
    tc_context_destroy(context);
}

/* Kernels of one variant; copies: as on a device with memory of its own. */
static void test_device(bool groups, bool copies, uint64_t seed, uint64_t count) {
    tc_context_options options;
    tc_expert_options expert;
    options_init(&options, &expert);
    expert.work_items = groups ? 64 : 1;
    expert.always_copy = copies;
    device = context_open(&options);
    for (uint64_t n = 0; n < count; n++) run(seed + n, n % 10 == 0);
    tc_context_destroy(device);
    device = NULL;
    expect_device_same(&options, "default");
    expert.tile_bricks = 1;
    expert.spin_limit = 1;
    expect_device_same(&options, "every tile recounted");
    expert.tile_bricks = 3; /* the last tile of a slab is shorter */
    expert.spin_limit = 0;
    options.max_memory_bytes = 4 << 20;
    expect_device_same(&options, "slabs");
}

int main(int argc, char **argv) {
    const bool on_device = argc > 1 && (!strcmp(argv[1], "alone") || !strcmp(argv[1], "groups"));
    const bool copies = on_device && argc > 2 && !strcmp(argv[2], "always_copy");
    char **numbers = argv + on_device + copies;
    const int number_count = argc - on_device - copies;
    const uint64_t seed = number_count > 1 ? strtoull(numbers[1], NULL, 0) : 2022;
    const uint64_t count = number_count > 2 ? strtoull(numbers[2], NULL, 0) : on_device ? 300 : 1500;
    reference = reference_open();
    if (on_device) {
        if (!device_exists()) return SKIPPED;
        test_device(!strcmp(argv[1], "groups"), copies, seed, count);
        tc_context_destroy(reference);
        return EXPECT_DONE();
    }
    test_patterns(number_count > 3);
    for (uint64_t n = 0; n < count; n++) run(seed + n, n % 50 == 0);
    test_one_label();
    test_wanted();
    test_types();
    test_closed();
    test_other_grids();
    test_smoothing();
    test_ranges();
    test_faults_are_found();
    test_refused();
    tc_context_destroy(reference);
    return EXPECT_DONE();
}
