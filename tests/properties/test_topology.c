/*
 * test_topology.c - the surfaces of random grids of every kind and sample type, and of every pattern of small ones,
 * against what the signs of their samples say; and that faults in them are found
 *
 * Usage: test_topology random KIND|all TYPE|all SEED COUNT [EVERY [any]]
 *        test_topology patterns small|large
 *        test_topology faults
 *
 * Random grids have the seeds from SEED on. One in EVERY (1: all, 0: none) is extracted on the OpenCL device too, whose
 * bytes must be the reference's; without `any` only where other tests build the kernels as well. A failure prints
 * the command that repeats its grid alone.
 */
#include "surface.h"

#include "engines.h"
#include "random.h"
#include "samples.h"
#include "topology.h"

#include <inttypes.h>

enum { FAILURES_SHOWN = 20 };

static const char *program;
static tc_context *reference, *device; /* device: NULL where none is wanted, or there is none */
static tc_mesh *meshes[2];
static subject grid;

/* ----------------------------------------------------------------------------------------------------- random grids */

typedef struct tally {
    uint64_t grids, surfaces, incomplete, on_device;
} tally;

/* Whether other tests build the kernels for it as well. */
static bool kernels_are_ready(const subject *s) {
    const bool missing = s->grid.has_nodata || s->grid.blanked_samples || s->grid.blanked_cells;
    if (!kind_is_structured(s->kind)) return true;
    const bool uniform = !s->grid.points && !s->grid.axes[0];
    const tc_type t = s->type;
    if (s->kind == HYBRID)
        return uniform && (t == TC_U8 || t == TC_F32 || (!missing && (t == TC_I16 || t == TC_U32 || t == TC_F64)));
    return uniform || t == TC_F32 || (s->grid.points && (t == TC_U8 || t == TC_F64));
}

/* The fault of the reference's mesh, or of the device's where `too` is set; NULL where there is none. */
static const char *subject_fault(const subject *s, bool too, tally *sum) {
    tc_mesh_data data[2];
    expected e;
    if (subject_extract(s, reference, &meshes[0], &data[0])) return tc_message();
    subject_expect(s, &e);
    const char *fault = surface_fault(s, &e, &data[0], CHECK_ALL);
    expected_free(&e);
    sum->grids++;
    sum->surfaces += data[0].triangle_count > 0;
    sum->incomplete += !s->complete;
    sum->on_device += too;
    if (fault || !too) return fault;
    if (subject_extract(s, device, &meshes[1], &data[1])) return tc_message();
    return mesh_difference(&data[0], &data[1]);
}

static void random_run(kind k, tc_type type, uint64_t seed, uint64_t count, uint64_t every, bool any) {
    tally sum = {0};
    const long failures = expect_failures;
    for (uint64_t n = seed; n < seed + count && expect_failures < failures + FAILURES_SHOWN; n++) {
        subject_make(&grid, k, type, n);
        const bool too = device && n % every == 0 && (any || kernels_are_ready(&grid));
        const char *fault = subject_fault(&grid, too, &sum);
        EXPECT(!fault, "%s; again by: %s random %s %s %" PRIu64 " 1%s", fault, program, kind_name(k),
               tc_type_name(type), n, too ? " 1 any" : "");
        subject_free(&grid);
    }
    printf("random %s %s: %" PRIu64 " grids, %" PRIu64 " with a surface, %" PRIu64 " with parts missing, %" PRIu64
           " on the device\n",
           kind_name(k), tc_type_name(type), sum.grids, sum.surfaces, sum.incomplete, sum.on_device);
}

static void device_open(void) {
    tc_context_options options;
    tc_device_info info = {.struct_size = sizeof info};
    tc_context_options_init(&options);
    device = context_open(&options);
    EXPECT(!tc_context_device(device, &info), "%s", tc_message());
    printf("device: %s, driver %s\n", info.name, info.driver);
}

static int random_main(int argc, char **argv) {
    if (argc < 6) return 2;
    const uint64_t seed = strtoull(argv[4], NULL, 0), count = strtoull(argv[5], NULL, 0);
    const uint64_t every = argc > 6 ? strtoull(argv[6], NULL, 0) : 0;
    int status = 2;
    if (every > 0 && device_exists()) device_open();
    for (kind k = UNIFORM; k < KINDS; k++)
        for (tc_type type = TC_U8; type <= TC_F64; type++)
            if ((!strcmp(argv[2], "all") || !strcmp(argv[2], kind_name(k))) &&
                (!strcmp(argv[3], "all") || !strcmp(argv[3], tc_type_name(type)))) {
                random_run(k, type, seed, count, every, argc > 7);
                status = every > 0 && !device ? SKIPPED : 0;
            }
    return status;
}

/* -------------------------------------------------------------------------------------------------------- patterns */

/* Every pattern of so many samples, in both parities, by both methods. */
static void grids_run(int64_t nx, int64_t ny, int64_t nz) {
    const int64_t dims[3] = {nx, ny, nz};
    const unsigned patterns = 1u << (nx * ny * nz);
    tally sum = {0};
    for (int n = 0; n < 4; n++) {
        subject_make_plain(&grid, n & 1 ? HYBRID : UNIFORM, dims);
        grid.grid.first_index[0] = n >> 1;
        for (unsigned pattern = 0; pattern < patterns && expect_failures < FAILURES_SHOWN; pattern++) {
            for (int64_t m = 0; m < grid.sample_count; m++)
                sample_set(grid.samples, TC_U8, m, (double)(pattern >> m & 1));
            const char *fault = subject_fault(&grid, false, &sum);
            EXPECT(!fault, "%s: pattern 0x%x of %d x %d x %d, %s, parity %d", fault, pattern, (int)nx, (int)ny, (int)nz,
                   kind_name(grid.kind), n >> 1);
        }
    }
    printf("patterns of %d x %d x %d samples: %" PRIu64 " grids\n", (int)nx, (int)ny, (int)nz, sum.grids);
}

static const struct cell_shape {
    const char *name;
    int type, corner_count;
    double volume; /* six times it */
    uint64_t faces;
    float corners[8][3];
} shapes[] = {
    {"tetrahedron", 10, 4, 1, 4, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
    {"voxel", 11, 8, 6, 12, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}}},
    {"hexahedron",
     12,
     8,
     6,
     12,
     {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}},
    {"wedge", 13, 6, 3, 8, {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}}},
    {"pyramid", 14, 5, 2, 6, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5f, 0.5f, 1}}},
};

/* Every pattern of one cell, its points numbered in `orders` ways. */
static void cell_run(const struct cell_shape *shape, int orders) {
    const int64_t dims[3] = {shape->corner_count, 1, 1};
    tally sum = {0};
    for (int order = 0; order < orders; order++) {
        uint32_t numbers[8];
        random_state = (uint64_t)order;
        subject_make_plain(&grid, MIXED, dims);
        grid.list = cell_list_make((uint64_t)shape->corner_count, 1);
        grid.list.point_count = (uint64_t)shape->corner_count;
        for (uint32_t n = 0; n < 8; n++) numbers[n] = n;
        for (uint32_t n = (uint32_t)shape->corner_count - 1; n > 0; n--) {
            const uint32_t m = random_below(n + 1), number = numbers[n];
            numbers[n] = numbers[m], numbers[m] = number;
        }
        for (int n = 0; n < shape->corner_count; n++)
            memcpy(grid.list.points + 3 * numbers[n], shape->corners[n], sizeof shape->corners[n]);
        cell_list_add(&grid.list, shape->type, shape->corner_count, numbers, order % 2);
        subject_cut(&grid);
        grid.volume = shape->volume, grid.boundary_faces = shape->faces;
        for (unsigned pattern = 0; pattern < 1u << shape->corner_count; pattern++) {
            for (int64_t m = 0; m < shape->corner_count; m++)
                sample_set(grid.samples, TC_U8, m, (double)(pattern >> m & 1));
            const char *fault = subject_fault(&grid, false, &sum);
            EXPECT(!fault, "%s: pattern 0x%x of a %s, order %d", fault, pattern, shape->name, order);
        }
        subject_free(&grid);
    }
    printf("patterns of a %s: %" PRIu64 " complexes\n", shape->name, sum.grids);
}

static int patterns_main(bool large) {
    grids_run(2, 2, 2);
    grids_run(3, 2, 2);
    if (large) {
        grids_run(2, 3, 2);
        grids_run(2, 2, 3);
        grids_run(3, 3, 2);
        grids_run(3, 2, 3);
        grids_run(2, 3, 3);
    }
    for (size_t n = 0; n < sizeof shapes / sizeof *shapes; n++) cell_run(&shapes[n], large ? 200 : 10);
    return 0;
}

/* ---------------------------------------------------------------------------------------------------------- faults */

typedef enum mutation { FLIP, TURN, DROP, TWICE, CORNER, SPLIT, MERGE, ORPHAN, MOVE, CELLS, SIGN, MUTATIONS } mutation;

static const struct {
    const char *name;
    unsigned found_by; /* checks of which each alone has to find it in a surface of many triangles without ties */
} mutations[MUTATIONS] = {
    {"a triangle turned round", CHECK_TOPOLOGY | CHECK_ARCS | CHECK_FACING},
    {"all triangles turned round", CHECK_ARCS | CHECK_FACING},
    {"a triangle left out", CHECK_COUNTS | CHECK_TOPOLOGY | CHECK_ARCS},
    {"a triangle twice", CHECK_COUNTS | CHECK_TOPOLOGY | CHECK_ARCS | CHECK_CELLS},
    {"a corner at another vertex", CHECK_TOPOLOGY | CHECK_ARCS},
    {"a vertex split in two", CHECK_COUNTS | CHECK_TOPOLOGY | CHECK_ARCS | CHECK_CELLS},
    {"two vertices made one", CHECK_COUNTS | CHECK_TOPOLOGY | CHECK_ARCS},
    {"a vertex without triangles", CHECK_COUNTS | CHECK_TOPOLOGY},
    {"a vertex moved by one bit", CHECK_PLACES},
    {"active cells miscounted", CHECK_COUNTS},
    {"a sample on the other side", 0},
};

/* A mesh that can be changed. */
typedef struct copy {
    tc_mesh_data data;
    float *positions;
    uint32_t *triangles;
} copy;

static copy copy_make(const tc_mesh_data *from) {
    copy c = {*from, malloc(12 * ((size_t)from->vertex_count + 1)), malloc(12 * ((size_t)from->triangle_count + 1))};
    if (!c.positions || !c.triangles) exit(EXIT_FAILURE);
    memcpy(c.positions, from->positions, 12 * (size_t)from->vertex_count);
    memcpy(c.triangles, from->triangles, 12 * (size_t)from->triangle_count);
    c.data.positions = c.positions, c.data.triangles = c.triangles;
    return c;
}

static void copy_free(copy *c) {
    free(c->positions);
    free(c->triangles);
}

static void triangle_turn(uint32_t *t) {
    const uint32_t first = t[0];
    t[0] = t[1], t[1] = first;
}

static void vertices_merge(copy *c, uint32_t a, uint32_t b) {
    const uint32_t last = (uint32_t)--c->data.vertex_count;
    for (uint64_t n = 0; n < 3 * c->data.triangle_count; n++) {
        if (c->triangles[n] == b) c->triangles[n] = a;
        if (c->triangles[n] == last && b != last) c->triangles[n] = b;
    }
    memmove(c->positions + 3 * (size_t)b, c->positions + 3 * (size_t)last, 12);
}

static void vertex_move(copy *c, uint32_t vertex) {
    uint32_t bits;
    float *p = c->positions + 3 * (size_t)vertex + random_below(3);
    memcpy(&bits, p, sizeof bits);
    bits ^= *p == 0 ? 0x3f800000 : 1; /* -0 is 0 */
    memcpy(p, &bits, sizeof bits);
}

/* Plants a fault in the mesh; SIGN is planted in the grid, by sample_turn. */
static void mutate(copy *c, mutation m) {
    const uint32_t count = (uint32_t)c->data.triangle_count, vertices = (uint32_t)c->data.vertex_count;
    uint32_t *one = c->triangles + 3 * random_below(count), *last = c->triangles + 3 * (count - 1);
    const uint32_t corner = random_below(3), vertex = random_below(vertices);
    if (m == FLIP) triangle_turn(one);
    for (uint32_t n = 0; n < count && m == TURN; n++) triangle_turn(c->triangles + 3 * n);
    if (m == DROP) memmove(one, last, 12), c->data.triangle_count--;
    if (m == TWICE) memcpy(last + 3, one, 12), c->data.triangle_count++;
    if (m == CORNER) one[corner] = (one[corner] + 1 + random_below(vertices - 1)) % vertices;
    if (m == SPLIT || m == ORPHAN) memcpy(c->positions + 3 * vertices, c->positions + 3 * vertex, 12);
    if (m == SPLIT) one[corner] = vertices;
    c->data.vertex_count += m == SPLIT || m == ORPHAN;
    if (m == MERGE) vertices_merge(c, vertex, (vertex + 1 + random_below(vertices - 1)) % vertices);
    if (m == MOVE) vertex_move(c, vertex);
    if (m == CELLS) c->data.active_cell_count++;
}

/* A sample brought over to the other side of the isovalue; false where its type has no such value, or it is missing. */
static bool sample_turn(subject *s) {
    const int64_t n = random_below((uint32_t)s->sample_count);
    const double low = type_least(s->type), value = sample_get(s->samples, s->type, n);
    if (!subject_has(s, n) || s->how.isovalue > type_most(s->type) || s->how.isovalue <= low) return false;
    sample_set(s->samples, s->type, n, value >= s->how.isovalue ? low : type_most(s->type));
    return subject_has(s, n);
}

static bool vertices_differ(const tc_mesh_data *m) {
    for (uint64_t a = 0; a < m->vertex_count; a++)
        for (uint64_t b = 0; b < a; b++)
            if (!memcmp(m->positions + 3 * a, m->positions + 3 * b, 12)) return false;
    return true;
}

/* Plants each fault once; counts[] by mutation. Strictly: every check that should see it alone has to. */
static void faults_plant(const tc_mesh_data *mesh, bool strictly, uint64_t *counts, const char *name) {
    /* of the hybrid method cells may share three vertices, and disks are not flat */
    const unsigned unfit = grid.kind == HYBRID ? CHECK_CELLS | CHECK_FACING : 0;
    expected e;
    subject_expect(&grid, &e);
    for (mutation m = FLIP; m < SIGN; m++) {
        copy c = copy_make(mesh);
        mutate(&c, m);
        EXPECT(surface_fault(&grid, &e, &c.data, CHECK_ALL), "%s: %s is not found", name, mutations[m].name);
        EXPECT(mesh_difference(mesh, &c.data), "%s: %s makes no difference between engines", name, mutations[m].name);
        for (unsigned check = CHECK_COUNTS; check < CHECK_ALL && strictly; check *= 2)
            if (mutations[m].found_by & check & ~unfit)
                EXPECT(surface_fault(&grid, &e, &c.data, check), "%s: %s is not found by check %u", name,
                       mutations[m].name, check);
        counts[m]++;
        copy_free(&c);
    }
    expected_free(&e);
    if (!sample_turn(&grid)) return;
    subject_expect(&grid, &e);
    const char *fault = surface_fault(&grid, &e, mesh, CHECK_ALL);
    counts[SIGN] += e.triangle_count > 0 && fault;
    EXPECT(fault || !grid.complete, "%s: %s is not found", name, mutations[SIGN].name);
    expected_free(&e);
}

static int faults_main(void) {
    uint64_t counts[MUTATIONS] = {0}, strict = 0;
    for (kind k = UNIFORM; k < KINDS; k++)
        for (uint64_t seed = 0; seed < 400; seed++) {
            char name[80];
            tc_mesh_data data;
            const tc_type type = (tc_type)(seed % 8);
            snprintf(name, sizeof name, "%s %s, seed %" PRIu64, kind_name(k), tc_type_name(type), seed);
            subject_make(&grid, k, type, seed);
            EXPECT(!subject_extract(&grid, reference, &meshes[0], &data), "%s: %s", name, tc_message());
            topology t;
            topology_of(data.positions, data.vertex_count, data.triangles, data.triangle_count, &t);
            const bool strictly = data.triangle_count > 60 && 2 * t.boundary_edges < data.triangle_count &&
                                  !grid.folded && t.fans == data.vertex_count && vertices_differ(&data);
            strict += strictly;
            if (data.triangle_count > 1) faults_plant(&data, strictly, counts, name);
            subject_free(&grid);
        }
    for (mutation m = FLIP; m < MUTATIONS; m++) printf("found, %s: %" PRIu64 " times\n", mutations[m].name, counts[m]);
    printf("surfaces where every check had to find them alone: %" PRIu64 "\n", strict);
    for (mutation m = FLIP; m < MUTATIONS; m++) EXPECT(counts[m] > 100, "%s was hardly tried", mutations[m].name);
    EXPECT(strict > 10, "few surfaces without ties");
    return 0;
}

int main(int argc, char **argv) {
    const char *what = argc > 1 ? argv[1] : "";
    int status = 2;
    program = argv[0];
    reference = reference_open();
    if (!strcmp(what, "random")) status = random_main(argc, argv);
    if (!strcmp(what, "patterns")) status = patterns_main(argc > 2 && !strcmp(argv[2], "large"));
    if (!strcmp(what, "faults")) status = faults_main();
    for (int n = 0; n < 2; n++) tc_mesh_destroy(meshes[n]);
    tc_context_destroy(reference);
    tc_context_destroy(device);
    const int failed = EXPECT_DONE();
    if (status == 2) fprintf(stderr, "usage: see test_topology.c\n");
    return failed ? failed : status;
}
