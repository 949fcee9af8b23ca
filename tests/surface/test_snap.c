/*
 * test_snap.c - method snap: the surface is that of the tetrahedra, with fewer and better triangles
 *
 * Random grids of all kinds: noise, smooth fields, ties and extremes, every sample type, missing samples and cells,
 * small sizes and those around words of 64, uniform, rectilinear and curvilinear, mirrored, from odd indices on. Of
 * each the mesh is made by tetra and by snap. Both have to be oriented manifolds of the same pieces: for each piece of
 * one there is one of the other with the same Euler characteristic and as many borders. And the mesh has to be the one
 * that the definition gives, vertex by vertex and triangle by triangle (common/snapped.h), so that a sample that should
 * have been snapped and was not is found too.
 *
 * Usage: test_snap [SEED [SMALL [LARGE]]]: so many grids of small sizes and of large ones. A failure names the seed of
 * its grid: `test_snap SEED 1 0` or `test_snap SEED 0 1` repeats it.
 */
#include "engines.h"
#include "pieces.h"
#include "random.h"
#include "random_field.h"
#include "samples.h"
#include "snapped.h"

#include <inttypes.h>
#include <math.h>

enum { SAMPLES_MAX = 40000 };

static tc_context *reference, *device; /* device: NULL where there is none */
static tc_mesh *meshes[3];             /* by tetra; by snap, of the reference, of the device */
static double memory[SAMPLES_MAX];     /* aligned for every type */

/* What the long tier reports. */
static struct tally { uint64_t grids, surfaces, missing, doubtful, on_device; } tally;

/* Exactly: the vertices of a border lie in the same face of the box. Of grids in index space. */
static bool border_is_in_faces(const tc_grid_options *grid, const tc_mesh_data *mesh, const pieces *p) {
    for (uint32_t n = 0; n < p->side_count; n++) {
        bool found = false;
        for (size_t axis = 0; axis < 3; axis++) {
            const double a = (double)mesh->positions[3 * (size_t)p->sides[n][0] + axis] + mesh->origin[axis];
            const double b = (double)mesh->positions[3 * (size_t)p->sides[n][1] + axis] + mesh->origin[axis];
            const double first = (double)grid->first_index[axis], last = first + (double)(grid->dims[axis] - 1);
            found = found || (a == b && (a == first || a == last));
        }
        if (!found) return false;
    }
    return true;
}

/* ------------------------------------------------------------------------------------------------------- comparison */

/* Position and normal. */
typedef struct vertex {
    float numbers[6];
} vertex;

static int vertex_order(const void *a, const void *b) { return memcmp(a, b, sizeof(vertex)); }

static vertex *vertices_of(const tc_mesh_data *mesh) {
    vertex *list = memory_get(mesh->vertex_count, sizeof *list);
    for (uint64_t n = 0; n < mesh->vertex_count; n++) {
        memcpy(list[n].numbers, mesh->positions + 3 * n, 3 * sizeof(float));
        if (mesh->normals) memcpy(list[n].numbers + 3, mesh->normals + 3 * n, 3 * sizeof(float));
    }
    qsort(list, mesh->vertex_count, sizeof *list, vertex_order);
    return list;
}

/* Bit for bit: a snapped sample is moved to a vertex of tetra. */
static bool vertices_are_of(const tc_mesh_data *tetra, const tc_mesh_data *snap) {
    vertex *all = vertices_of(tetra), *some = vertices_of(snap);
    bool found = true;
    for (uint64_t n = 0; n < snap->vertex_count && found; n++)
        found = bsearch(&some[n], all, tetra->vertex_count, sizeof *all, vertex_order) != NULL;
    free(all);
    free(some);
    return found;
}

typedef struct grid_kind {
    bool complete, plain; /* nothing is missing; positions are indices */
    bool on_device;       /* too */
} grid_kind;

static const char *snap_fault(const tc_grid_options *grid, const tc_extract_options *how, grid_kind kind,
                              const tc_mesh_data *tetra, const tc_mesh_data *snap) {
    bool doubtful;
    pieces p = pieces_of(tetra), q = pieces_of(snap);
    const char *fault = pieces_differ(&p, &q);
    if (!fault && kind.complete && q.pinches) fault = "a vertex of a complete grid has several fans";
    if (!fault && kind.complete && kind.plain && !border_is_in_faces(grid, snap, &q))
        fault = "the border has left the box";
    if (!fault && !vertices_are_of(tetra, snap)) fault = "a vertex is none of the tetrahedra's";
    if (!fault) fault = snapped_fault(grid, how->isovalue, how->snap, snap, &doubtful);
    tally.doubtful += !fault && doubtful;
    pieces_free(&p);
    pieces_free(&q);
    return fault;
}

/* The samples, carried to the vertices, have the isovalue there. */
static bool carries_the_isovalue(tc_grid *grid, const tc_grid_options *o, const tc_extract_options *how,
                                 const tc_mesh_data *mesh) {
    const tc_field field = {.struct_size = sizeof field, .type = o->type, .components = 1, .values = o->samples};
    float *values = memory_get(mesh->vertex_count, sizeof *values);
    double size = fabs(how->isovalue);
    bool right = true;
    for (int64_t n = 0; n < o->dims[0] * o->dims[1] * o->dims[2]; n++) {
        const double value = sample_get(o->samples, o->type, n);
        if (isfinite(value)) size = fmax(size, fabs(value));
    }
    if (tc_interpolate_field(grid, how, &field, values, mesh->vertex_count)) right = false;
    /* values are floats, in which some of f64 are infinite */
    for (uint64_t n = 0; n < mesh->vertex_count && right && size <= (double)FLT_MAX; n++)
        right = fabs((double)values[n] - how->isovalue) <= 1e-6 * size;
    free(values);
    return right;
}

/* No sample lies where the surface of snap 0 would go through it: the mesh of tetra is then the same. */
static bool no_sample_has(const tc_grid_options *grid, double isovalue) {
    for (int64_t n = 0; n < grid->dims[0] * grid->dims[1] * grid->dims[2]; n++) {
        const double value = sample_get(grid->samples, grid->type, n);
        if (value == isovalue || value == (double)(float)isovalue) return false;
    }
    return true;
}

static void expect_snapped(const tc_grid_options *options, const tc_extract_options *how, grid_kind kind,
                           const char *name) {
    tc_extract_options by_tetra = *how;
    tc_mesh_data tetra, snap = {.struct_size = sizeof snap};
    tc_counts counts = {.struct_size = sizeof counts};
    tc_grid *grid = NULL;
    by_tetra.method = TC_METHOD_TETRA;
    if (!test_chosen(name) || !extract(reference, options, &by_tetra, &meshes[0], &tetra)) return;
    tc_status status = tc_grid_create(reference, options, &grid);
    if (!status) status = tc_extract(grid, how, &meshes[1]);
    if (!status) status = tc_mesh_get(meshes[1], &snap);
    if (!status) status = tc_count(grid, how, &counts);
    EXPECT(status == TC_OK, "%s: %s", name, tc_message());
    if (!status) {
        const char *fault = snap_fault(options, how, kind, &tetra, &snap);
        if (!fault && how->snap == 0 && no_sample_has(options, how->isovalue)) fault = mesh_difference(&tetra, &snap);
        if (!fault && !carries_the_isovalue(grid, options, how, &snap))
            fault = "carried samples differ from the isovalue";
        if (!fault && (counts.vertex_count != snap.vertex_count || counts.triangle_count != snap.triangle_count ||
                       counts.active_cell_count != snap.active_cell_count))
            fault = "tc_count counts something else";
        EXPECT(!fault, "%s: %s", name, fault);
        tc_mesh_data other;
        if (device && kind.on_device && extract(device, options, how, &meshes[2], &other)) {
            const char *difference = mesh_difference(&snap, &other);
            EXPECT(!difference, "%s: device and reference: %s", name, difference);
            tally.on_device++;
        }
        tally.grids++;
        tally.surfaces += snap.triangle_count > 0;
        tally.missing += !kind.complete;
    }
    tc_grid_destroy(grid);
}

/* ----------------------------------------------------------------------------------------------------- random grids */

enum { EXTREMES = RANDOM_FIELDS, FIELD_KINDS };

/* Without those so small that a half of them is rounded. */
static double extreme_value(tc_type type) {
    const double least = type_least(type), most = type_most(type);
    const double integers[] = {least, most, least + 1, most - 1, 1},
                 floats[] = {least, most, most / 2, least / 4, 1, 0, -0.0};
    return type_is_floating(type) ? floats[random_below(7)] : integers[random_below(5)];
}

static void samples_choose(tc_grid_options *grid, int kind) {
    double wave[4];
    int64_t n = 0;
    wave_choose(wave);
    for (int64_t z = 0; z < grid->dims[2]; z++)
        for (int64_t y = 0; y < grid->dims[1]; y++)
            for (int64_t x = 0; x < grid->dims[0]; x++)
                sample_set(memory, grid->type, n++,
                           kind == EXTREMES ? extreme_value(grid->type)
                                            : field_value(kind, wave, (double)x, (double)y, (double)z));
}

static void sizes_choose(int64_t dims[3], bool large) {
    static const int64_t xs[] = {2, 3, 63, 64, 65, 66, 127, 128, 129, 130}, ys[] = {2, 3, 7, 8, 9, 10, 16, 17};
    static const int64_t zs[] = {2, 3, 4, 5, 8, 9, 13};
    if (large) {
        dims[0] = xs[random_below(10)], dims[1] = ys[random_below(8)], dims[2] = zs[random_below(7)];
        return;
    }
    for (int axis = 0; axis < 3; axis++) dims[axis] = random_below(4) ? 2 + random_below(8) : 2 + random_below(2);
}

/* Uniform, in index space or with another matrix; rectilinear; curvilinear. True in index space. */
static bool places_choose(tc_grid_options *grid) {
    static float axes[3][130], points[SAMPLES_MAX][3];
    const uint32_t kind = random_below(4);
    for (int axis = 0; axis < 3; axis++) {
        const double start = random_between(-9, 9), step = random_below(2) ? 1 : -0.7;
        for (int64_t n = 0; n < grid->dims[axis]; n++)
            axes[axis][n] = (float)(start + step * ((double)n + random_between(0, 0.5)));
        if (kind == 1) grid->axes[axis] = axes[axis];
    }
    for (int row = 0; row < 3 && kind == 2; row++) {
        for (int column = 0; column < 3; column++) grid->matrix[row][column] = random_between(-0.2, 0.2);
        grid->matrix[row][row] = random_below(2) ? random_between(0.5, 2) : random_between(-2, -0.5);
        grid->matrix[row][3] = random_between(-100, 100);
    }
    for (int64_t n = 0; n < grid->dims[0] * grid->dims[1] * grid->dims[2] && kind == 3; n++) {
        int64_t p[3];
        grid_place(grid, n, p);
        for (int axis = 0; axis < 3; axis++) points[n][axis] = axes[axis][p[axis]] + (float)random_between(-0.1, 0.1);
    }
    if (kind == 3) grid->points = points[0];
    return kind == 0;
}

/* Takes samples and cells away, or none. True where none may be missing. */
static bool parts_remove(tc_grid_options *grid) {
    static uint8_t blanked[SAMPLES_MAX];
    const int64_t count = grid->dims[0] * grid->dims[1] * grid->dims[2];
    const uint32_t kind = random_below(8), rarity = 2 + random_below(60);
    if (kind > 3) return true;
    for (int64_t n = 0; n < count; n++) {
        const bool goes = random_below(rarity) == 0;
        blanked[n] = goes;
        if (kind == 0 && goes) sample_set(memory, grid->type, n, 3);
        if (kind == 1 && goes && type_is_floating(grid->type)) sample_set(memory, grid->type, n, (double)NAN);
    }
    grid->has_nodata = kind == 0;
    grid->nodata = 3;
    if (kind == 2) grid->blanked_samples = blanked;
    if (kind == 3) grid->blanked_cells = blanked;
    return false;
}

static double threshold_choose(void) {
    static const double usual[] = {0, 0.25, 0.4, 0.5, 0.5};
    const uint32_t n = random_below(10);
    return n < 5 ? usual[n] : random_between(0, 0.5);
}

/* Two kinds of uniform grids: kernels for every kind would take minutes to build. */
static bool runs_on_device(const tc_grid_options *grid, const tc_extract_options *how, grid_kind kind) {
    if (grid->points || grid->axes[0] || grid->blanked_samples || grid->blanked_cells) return false;
    return grid->type == TC_F32 ? !kind.complete && how->normals
                                : grid->type == TC_U8 && kind.complete && !how->normals;
}

static void run(uint64_t seed, bool large) {
    tc_grid_options grid;
    tc_extract_options how;
    grid_kind kind;
    char name[200];
    random_state = seed * 0x2545f4914f6cdd1du + large;
    tc_grid_options_init(&grid);
    tc_extract_options_init(&how);
    sizes_choose(grid.dims, large);
    grid.type = (tc_type)random_below(8);
    grid.samples = memory;
    for (int axis = 0; axis < 3; axis++)
        if (random_below(2)) grid.first_index[axis] = (int64_t)random_below(2001) - 1000;
    const int field = (int)random_below(FIELD_KINDS);
    samples_choose(&grid, field);
    kind.plain = places_choose(&grid);
    kind.complete = parts_remove(&grid);
    how.method = TC_METHOD_SNAP;
    how.isovalue = field == TIES ? 58 + 0.5 * random_below(8) : 60 + random_between(-20, 20);
    if (field == EXTREMES)
        how.isovalue = 0.5 * extreme_value(grid.type) + 0.5 * (random_below(2) ? extreme_value(grid.type) : 1);
    how.snap = threshold_choose();
    how.normals = random_below(4) == 0;
    kind.on_device = runs_on_device(&grid, &how, kind);
    snprintf(name, sizeof name, "seed %" PRIu64 ", %s: %lldx%lldx%lld %s, isovalue %.17g, snap %.17g, %s", seed,
             large ? "large" : "small", (long long)grid.dims[0], (long long)grid.dims[1], (long long)grid.dims[2],
             tc_type_name(grid.type), how.isovalue, how.snap, kind.complete ? "complete" : "with parts missing");
    expect_snapped(&grid, &how, kind, name);
}

/* The surface lies between bricks, each of which is on one side. */
static void test_between_bricks(void) {
    static const int64_t bricks[3] = {64, 8, 4};
    static const double isovalues[3] = {120, 130, 140};
    for (int axis = 0; axis < 3; axis++)
        for (int n = 0; n < 3; n++) {
            tc_grid_options grid;
            tc_extract_options how;
            char name[80];
            tc_grid_options_init(&grid);
            tc_extract_options_init(&how);
            grid.dims[0] = 130, grid.dims[1] = 18, grid.dims[2] = 10;
            grid.samples = memory;
            for (int64_t m = 0; m < 130 * 18 * 10; m++) {
                int64_t p[3];
                grid_place(&grid, m, p);
                sample_set(memory, TC_U8, m, p[axis] < bricks[axis] ? 100 : 160);
            }
            how.method = TC_METHOD_SNAP;
            how.isovalue = isovalues[n];
            snprintf(name, sizeof name, "between bricks along %c: u8, isovalue %g, complete", 'x' + axis, how.isovalue);
            expect_snapped(&grid, &how, (grid_kind){true, true, true}, name);
        }
}

/* ---------------------------------------------------------------------------------------------------------- figures */

typedef enum shape { SPHERE, GYROID, WHITE_NOISE, SHAPES } shape;

static const char *const shape_names[SHAPES] = {"sphere", "gyroid", "white noise"};

/* A cube of samples between -1 and 1. */
static void shape_make(shape which, int64_t size, tc_grid_options *grid, tc_extract_options *how) {
    const double turn = 3 * 3.14159265358979323846;
    random_state = 11;
    tc_grid_options_init(grid);
    tc_extract_options_init(how);
    for (int axis = 0; axis < 3; axis++) grid->dims[axis] = size;
    grid->type = TC_F32;
    grid->samples = memory;
    how->method = TC_METHOD_SNAP;
    for (int64_t n = 0; n < size * size * size; n++) {
        int64_t p[3];
        double x[3], value = random_between(-1, 1);
        grid_place(grid, n, p);
        for (int axis = 0; axis < 3; axis++) x[axis] = 2 * (double)p[axis] / (double)(size - 1) - 1;
        if (which == SPHERE) value = 0.5 - 0.75 * sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        if (which == GYROID)
            value = sin(turn * x[0]) * cos(turn * x[1]) + sin(turn * x[1]) * cos(turn * x[2]) +
                    sin(turn * x[2]) * cos(turn * x[0]);
        sample_set(memory, TC_F32, n, value);
    }
}

/* The gradient of the trilinear interpolant at a place in index space. */
static void gradient_at(const tc_grid_options *grid, const double at[3], double out[3]) {
    int64_t p[3];
    double part[3];
    for (int axis = 0; axis < 3; axis++) {
        p[axis] = (int64_t)fmin(floor(at[axis]), (double)(grid->dims[axis] - 2));
        part[axis] = at[axis] - (double)p[axis];
        out[axis] = 0;
    }
    for (int c = 0; c < 8; c++) {
        const int64_t n = ((p[2] + (c >> 2)) * grid->dims[1] + p[1] + (c >> 1 & 1)) * grid->dims[0] + p[0] + (c & 1);
        const double value = sample_get(grid->samples, grid->type, n);
        for (int axis = 0; axis < 3; axis++) {
            double weight = c >> axis & 1 ? 1 : -1;
            for (int other = 0; other < 3; other++)
                if (other != axis) weight *= c >> other & 1 ? part[other] : 1 - part[other];
            out[axis] += weight * value;
        }
    }
}

/* What share of the triangles faces uphill, where the field rises. */
static double share_turned(const tc_grid_options *grid, const tc_mesh_data *mesh) {
    uint64_t turned = 0;
    for (uint64_t n = 0; n < mesh->triangle_count; n++) {
        double p[3][3], gradient[3], middle[3], volume = 0;
        for (size_t corner = 0; corner < 3; corner++)
            for (size_t axis = 0; axis < 3; axis++)
                p[corner][axis] = (double)mesh->positions[3 * (size_t)mesh->triangles[3 * n + corner] + axis];
        for (int axis = 0; axis < 3; axis++) middle[axis] = (p[0][axis] + p[1][axis] + p[2][axis]) / 3;
        gradient_at(grid, middle, gradient);
        for (int axis = 0; axis < 3; axis++) {
            const int b = (axis + 1) % 3, c = (axis + 2) % 3;
            volume += gradient[axis] *
                      ((p[1][b] - p[0][b]) * (p[2][c] - p[0][c]) - (p[1][c] - p[0][c]) * (p[2][b] - p[0][b]));
        }
        turned += volume > 0;
    }
    return (double)turned / (double)mesh->triangle_count;
}

/* Triangles that face the wrong way, and how many there are, both against tetra. */
static void test_figures(void) {
    enum { SIZE = 34 };
    for (int which = 0; which < SHAPES; which++) {
        tc_grid_options grid;
        tc_extract_options how, by_tetra;
        tc_mesh_data tetra, snap;
        shape_make((shape)which, SIZE, &grid, &how);
        by_tetra = how;
        by_tetra.method = TC_METHOD_TETRA;
        expect_snapped(&grid, &how, (grid_kind){true, true, false}, shape_names[which]);
        if (!test_chosen(shape_names[which]) || !extract(reference, &grid, &by_tetra, &meshes[0], &tetra) ||
            !extract(reference, &grid, &how, &meshes[1], &snap))
            continue;
        const double ratio = (double)snap.triangle_count / (double)tetra.triangle_count;
        const double before = share_turned(&grid, &tetra), after = share_turned(&grid, &snap);
        printf("%s: %.3f times the triangles; facing uphill %.3f%% of them, of tetra's %.3f%%\n", shape_names[which],
               ratio, 100 * after, 100 * before);
        EXPECT(ratio < (which == WHITE_NOISE ? 0.75 : 0.3), "%s: %g times the triangles", shape_names[which], ratio);
        /* of smooth fields a smaller share; of noise, where every triangle is as long as its cube, some more */
        EXPECT(which == WHITE_NOISE ? ratio * after <= 1.35 * before : after <= before,
               "%s: %g of the triangles face uphill, of tetra's %g", shape_names[which], after, before);
    }
}

/* ---------------------------------------------------------------------------------------------------- what is found */

/* A corner moved, a triangle turned over and one less are found by what all grids are checked with. */
static void test_faults_are_found(void) {
    tc_grid_options grid;
    tc_extract_options how;
    tc_mesh_data tetra, snap;
    shape_make(WHITE_NOISE, 12, &grid, &how);
    how.isovalue = 0.1;
    if (!extract(reference, &grid, &how, &meshes[1], &snap)) return;
    how.method = TC_METHOD_TETRA;
    if (!extract(reference, &grid, &how, &meshes[0], &tetra)) return;
    const size_t count = 3 * (size_t)snap.triangle_count;
    uint32_t *triangles = memory_get(count, sizeof *triangles);
    memcpy(triangles, snap.triangles, count * sizeof *triangles);
    snap.triangles = triangles;
    const grid_kind kind = {true, true, false};
    EXPECT(!snap_fault(&grid, &how, kind, &tetra, &snap), "%s", snap_fault(&grid, &how, kind, &tetra, &snap));
    for (int n = 0; n < 200; n++) {
        uint32_t *corner = triangles + random_below((uint32_t)count), old = *corner;
        *corner = (old + 1 + random_below((uint32_t)snap.vertex_count - 1)) % (uint32_t)snap.vertex_count;
        EXPECT(snap_fault(&grid, &how, kind, &tetra, &snap), "a corner moved from %u to %u is not found", old, *corner);
        *corner = old;
    }
    snap.triangle_count--;
    EXPECT(snap_fault(&grid, &how, kind, &tetra, &snap), "a missing triangle is not found");
    snap.triangle_count++;
    EXPECT(snap_fault(&grid, &how, kind, &tetra, &tetra), "a mesh where nothing was snapped is not found");
    free(triangles);
}

static void test_options(void) {
    static const double refused[] = {-0.1, 0.51, (double)NAN, (double)INFINITY};
    tc_grid_options grid;
    tc_extract_options how;
    tc_mesh *mesh = NULL;
    tc_grid *made = NULL;
    shape_make(SPHERE, 5, &grid, &how);
    EXPECT(how.snap == 0.5, "the default is %g", how.snap);
    EXPECT(tc_grid_create(reference, &grid, &made) == TC_OK, "no grid: %s", tc_message());
    for (int n = 0; n < 4; n++) {
        how.snap = refused[n];
        EXPECT_REFUSED(tc_extract(made, &how, &mesh), TC_ERROR_ARGUMENT, "a threshold out of range");
        EXPECT(strstr(tc_message(), "snap") != NULL, "no word about snap: %s", tc_message());
    }
    how.method = TC_METHOD_TETRA; /* which does not look at it */
    EXPECT(tc_extract(made, &how, &mesh) == TC_OK, "%s", tc_message());
    tc_mesh_destroy(mesh);
    tc_grid_destroy(made);
}

/* Windows of sign words reach so far beyond a slab that the samples there are snapped as in the whole. */
static void test_slabs(tc_context_options options) {
    enum { SIZE = 34 };
    tc_grid_options grid;
    tc_extract_options how;
    tc_mesh_data whole, other;
    uint32_t slabs = 0;
    shape_make(WHITE_NOISE, SIZE, &grid, &how);
    grid.dims[0] = 12, grid.dims[1] = 12, grid.dims[2] = (int64_t)SIZE * SIZE * SIZE / 144;
    if (!device || !extract(reference, &grid, &how, &meshes[1], &whole)) return;
    for (options.max_memory_bytes = 4 << 20; options.max_memory_bytes > 1 << 20;
         options.max_memory_bytes -= options.max_memory_bytes / 40) {
        tc_context *small = context_open(&options);
        tc_grid *made = NULL;
        if (!tc_grid_create(small, &grid, &made) && !tc_extract(made, &how, &meshes[2])) {
            other = (tc_mesh_data){.struct_size = sizeof other};
            EXPECT(!tc_mesh_get(meshes[2], &other), "%s", tc_message());
            const char *difference = mesh_difference(&whole, &other);
            EXPECT(!difference, "%u slabs: %s", other.slab_count, difference);
            expect_within(small, options.max_memory_bytes, "slabs");
            slabs = other.slab_count > slabs ? other.slab_count : slabs;
        }
        tc_grid_destroy(made);
        tc_context_destroy(small);
    }
    EXPECT(slabs >= 3, "no budget makes more than %u slabs", slabs);
}

/* test_snap [groups] [SEED SMALL LARGE]: groups: kernels for groups of work-items, on fewer grids. */
int main(int argc, char **argv) {
    const bool groups = argc > 1 && !strcmp(argv[1], "groups");
    argc -= groups, argv += groups;
    const uint64_t seed = argc > 1 ? strtoull(argv[1], NULL, 0) : 1996;
    const uint64_t small = argc > 2 ? strtoull(argv[2], NULL, 0) : groups ? 300 : tier_count(3000);
    const uint64_t large = argc > 3 ? strtoull(argv[3], NULL, 0) : groups ? 10 : tier_count(40);
    tc_context_options options;
    tc_expert_options expert;
    options_init(&options, &expert);
    if (groups) expert.work_items = 32;
    reference = reference_open();
    if (device_exists()) device = context_open(&options);
    test_slabs(options);
    const bool skipped = !device;
    for (uint64_t n = 0; n < small; n++) run(seed + n, false);
    for (uint64_t n = 0; n < large; n++) run(seed + n, true);
    test_between_bricks();
    test_figures();
    test_faults_are_found();
    test_options();
    printf("random: %" PRIu64 " grids, %" PRIu64 " with a surface, %" PRIu64 " with parts missing, %" PRIu64
           " too near the threshold to tell, %" PRIu64 " on the device\n",
           tally.grids, tally.surfaces, tally.missing, tally.doubtful, tally.on_device);
    EXPECT(tally.grids < 100 || tally.doubtful * 10 <= tally.grids,
           "too many grids are too near the threshold to tell");
    for (int n = 0; n < 3; n++) tc_mesh_destroy(meshes[n]);
    tc_context_destroy(reference);
    tc_context_destroy(device);
    const int failed = EXPECT_DONE();
    return failed || !skipped ? failed : SKIPPED;
}
