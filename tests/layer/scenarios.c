#define CL_TARGET_OPENCL_VERSION 120

#include "scenarios.h"

#include "engines.h"
#include "folder.h"

#include <CL/cl.h>
#include <dirent.h>
#include <math.h>
#include <unistd.h>

enum { NX = 34, NY = 14, NZ = 44, SAMPLES = NX * NY * NZ, PATH_BYTES = 4096 };

typedef enum flow { FLOW_DEVICES, FLOW_EXTRACT, FLOW_EMIT, FLOW_COMPLEX, FLOW_CARRY, FLOW_LABELS } flow;
typedef enum coordinates { UNIFORM, RECTILINEAR, CURVILINEAR } coordinates;

struct scenario {
    const char *name;
    flow flow;
    tc_type type;
    coordinates coordinates;
    tc_method method;
    bool normals, always_copy, slabs, cold;
    bool interval; /* interval volumes are made, from each isovalue on, in place of surfaces */
    bool is_rare;  /* other scenarios have nearly all of its calls: failures of each are for the long tier */
    tc_engine engine;
};

static const scenario scenarios[] = {
    {.name = "devices", .flow = FLOW_DEVICES},
    {.name = "whole", .flow = FLOW_EXTRACT},
    {.name = "copied buffers, hybrid, normals",
     .flow = FLOW_EXTRACT,
     .method = TC_METHOD_HYBRID,
     .normals = true,
     .always_copy = true},
    {.name = "slabs, missing samples", .flow = FLOW_EXTRACT, .type = TC_F32, .slabs = true},
    {.name = "slabs, copied buffers, missing samples",
     .flow = FLOW_EXTRACT,
     .type = TC_F32,
     .slabs = true,
     .always_copy = true},
    {.name = "rectilinear", .flow = FLOW_EXTRACT, .coordinates = RECTILINEAR},
    {.name = "curvilinear, slabs", .flow = FLOW_EXTRACT, .coordinates = CURVILINEAR, .slabs = true},
    {.name = "curvilinear, copied buffers", .flow = FLOW_EXTRACT, .coordinates = CURVILINEAR, .always_copy = true},
    {.name = "complex", .flow = FLOW_COMPLEX},
    {.name = "complex, copied buffers", .flow = FLOW_COMPLEX, .always_copy = true},
    {.name = "complex, slabs", .flow = FLOW_COMPLEX, .slabs = true},
    {.name = "whole cells", .flow = FLOW_COMPLEX, .method = TC_METHOD_HYBRID},
    {.name = "whole cells, copied buffers", .flow = FLOW_COMPLEX, .method = TC_METHOD_HYBRID, .always_copy = true},
    {.name = "whole cells, slabs", .flow = FLOW_COMPLEX, .method = TC_METHOD_HYBRID, .slabs = true},
    {.name = "interval", .flow = FLOW_EXTRACT, .interval = true},
    {.name = "complex interval", .flow = FLOW_COMPLEX, .interval = true},
    {.name = "complex interval, copied buffers",
     .flow = FLOW_COMPLEX,
     .interval = true,
     .always_copy = true,
     .is_rare = true},
    {.name = "complex interval, slabs", .flow = FLOW_COMPLEX, .interval = true, .slabs = true},
    {.name = "count and emit", .flow = FLOW_EMIT},
    {.name = "empty cache of programs", .flow = FLOW_EXTRACT, .cold = true},
    {.name = "reference, missing samples",
     .flow = FLOW_EXTRACT,
     .type = TC_F32,
     .normals = true,
     .engine = TC_ENGINE_REFERENCE},
    {.name = "reference, hybrid, curvilinear",
     .flow = FLOW_EXTRACT,
     .method = TC_METHOD_HYBRID,
     .coordinates = CURVILINEAR,
     .engine = TC_ENGINE_REFERENCE},
    {.name = "reference, complex", .flow = FLOW_COMPLEX, .engine = TC_ENGINE_REFERENCE},
    {.name = "reference, complex interval", .flow = FLOW_COMPLEX, .interval = true, .engine = TC_ENGINE_REFERENCE},
    {.name = "carry", .flow = FLOW_CARRY, .engine = TC_ENGINE_REFERENCE},
    {.name = "labels", .flow = FLOW_LABELS},
    {.name = "labels, copied buffers", .flow = FLOW_LABELS, .always_copy = true, .is_rare = true},
    {.name = "labels, slabs", .flow = FLOW_LABELS, .slabs = true},
    {.name = "interval, copied buffers, missing samples",
     .flow = FLOW_EXTRACT,
     .interval = true,
     .type = TC_F32,
     .always_copy = true,
     .is_rare = true},
    {.name = "reference, labels", .flow = FLOW_LABELS, .engine = TC_ENGINE_REFERENCE},
    {.name = "reference, interval", .flow = FLOW_EXTRACT, .interval = true, .engine = TC_ENGINE_REFERENCE},
};
enum { SCENARIOS = sizeof scenarios / sizeof *scenarios };

static const double isovalues[2] = {127.5, 90};

static char problem[1500];
static uint8_t bytes[SAMPLES], labels[SAMPLES];
static float values[SAMPLES], points[3 * SAMPLES], axes[3][NZ]; /* NZ is the most */
static uint64_t budgets[SCENARIOS];                             /* of memory, for those in slabs */
static tc_tetrahedra complex, of_cells;
static tc_cells cells; /* of method hybrid */
static tc_mesh *expected[SCENARIOS][2];
static tc_interval_volume *expected_intervals[SCENARIOS][2];
static cl_context theirs; /* a caller's own context */
static cl_command_queue their_queue;
static cl_mem their_samples, their_positions, their_triangles;

int scenario_count(void) { return SCENARIOS; }

const char *scenario_name(int index) { return scenarios[index].name; }

bool scenario_is_rare(int index) { return scenarios[index].is_rare; }

bool scenario_uses_device(int index) { return scenarios[index].engine == TC_ENGINE_OPENCL; }

/* ------------------------------------------------------------------------------------------------------------ input */

static void input_make(void) {
    for (int n = 0; n < SAMPLES; n++) {
        const int x = n % NX, y = n / NX % NY, z = n / NX / NY;
        const double value = 127.5 + 60 * sin(0.33 * x) * cos(0.41 * y) + 60 * sin(0.37 * z + 0.2 * y);
        bytes[n] = (uint8_t)value;
        labels[n] = bytes[n] / 64;
        values[n] = x == 20 && y == 10 ? NAN : (float)value;
        points[3 * n] = (float)(x + 0.1 * sin(0.5 * y));
        points[3 * n + 1] = (float)(y + 0.1 * sin(0.5 * z));
        points[3 * n + 2] = (float)(z + 0.1 * sin(0.5 * x));
    }
    for (int axis = 0; axis < 3; axis++)
        for (int n = 0; n < NZ; n++) axes[axis][n] = (float)(n + 0.01 * n * n);
}

/* The cubes as hexahedra, every third as wedges, whose sides are cut differently: some faces of hexahedra are cut. */
static tc_status cells_make(void) {
    enum { CUBES = (NX - 1) * (NY - 1) * (NZ - 1) };
    static uint8_t types[2 * CUBES];
    static int64_t offsets[2 * CUBES + 1], corners[12 * CUBES];
    static const int hexahedron[8] = {0, 1, 3, 2, 4, 5, 7, 6}, wedges[2][6] = {{0, 3, 1, 4, 7, 5}, {0, 2, 3, 4, 6, 7}};
    cells = (tc_cells){.struct_size = sizeof cells, .point_count = SAMPLES, .points = points};
    cells.types = types, cells.offsets = offsets, cells.connectivity = corners;
    for (int n = 0; n < CUBES; n++) {
        const int x = n % (NX - 1), y = n / (NX - 1) % (NY - 1), z = n / (NX - 1) / (NY - 1),
                  first = (z * NY + y) * NX + x;
        const int count = n % 3 == 0 ? 6 : 8;
        for (int part = 0; part < (count == 6 ? 2 : 1); part++) {
            const int *order = count == 6 ? wedges[part] : hexahedron;
            int64_t *out = corners + offsets[cells.cell_count];
            for (int c = 0; c < count; c++)
                out[c] = first + (order[c] & 1) + NX * (order[c] >> 1 & 1) + NX * NY * (order[c] >> 2);
            types[cells.cell_count] = count == 6 ? 13 : 12;
            offsets[++cells.cell_count] = out - corners + count;
        }
    }
    of_cells.struct_size = sizeof of_cells;
    return tc_tetrahedralize(&cells, &of_cells);
}

static void grid_describe(const scenario *s, tc_grid_options *o) {
    tc_grid_options_init(o);
    o->dims[0] = NX;
    o->dims[1] = NY;
    o->dims[2] = NZ;
    o->type = s->type;
    o->samples = s->type == TC_F32 ? (const void *)values : s->flow == FLOW_LABELS ? labels : bytes;
    if (s->coordinates == CURVILINEAR) o->points = points;
    for (int axis = 0; axis < 3 && s->coordinates == RECTILINEAR; axis++) o->axes[axis] = axes[axis];
}

static tc_tetrahedra_grid_options complex_describe(const scenario *s) {
    const tc_tetrahedra *cut = s->method == TC_METHOD_HYBRID ? &of_cells : &complex;
    tc_tetrahedra_grid_options o;
    tc_tetrahedra_grid_options_init(&o);
    o.point_count = SAMPLES;
    o.points = points;
    o.type = TC_U8;
    o.samples = bytes;
    o.tetrahedron_count = cut->tetrahedron_count;
    o.tetrahedra = cut->tetrahedra;
    if (cut == &of_cells) o.source = &cells, o.cells = cut->cells;
    return o;
}

static tc_extract_options surface_describe(const scenario *s, int index) {
    tc_extract_options o;
    tc_extract_options_init(&o);
    o.isovalue = isovalues[index];
    o.method = s->method;
    o.normals = s->normals;
    return o;
}

/* Of label maps: all labels, and one of them. */
static tc_labels_options labels_describe(int index) {
    static const uint32_t one = 2;
    tc_labels_options o;
    tc_labels_options_init(&o);
    if (index) o.labels = &one, o.label_count = 1;
    return o;
}

static tc_interval_volume_options interval_describe(int index) {
    tc_interval_volume_options o;
    tc_interval_volume_options_init(&o);
    o.low = isovalues[index];
    if (index == 0) o.high = o.low + 30.5;
    return o;
}

/* ------------------------------------------------------------------------------------------------------------ trial */

/* Whether a call succeeds, at once or again where the trial wants it made again. */
#define TRIED(t, call)                                                                                                 \
    ((status = (call)) == TC_OK ||                                                                                     \
     ((t)->failed(t, #call, status) && ((status = (call)) == TC_OK || fails_again(#call, status))))

static bool fails_again(const char *call, tc_status status) {
    snprintf(problem, sizeof problem, "%s fails once more, status %d: %s", call, (int)status, tc_message());
    return false;
}

/* Whether the mesh is that of the reference. */
static bool mesh_is_right(int index, int surface, tc_mesh *mesh) {
    tc_mesh_data found = {.struct_size = sizeof found}, wanted = {.struct_size = sizeof wanted};
    if (tc_mesh_get(mesh, &found) || tc_mesh_get(expected[index][surface], &wanted)) return false;
    const char *difference = mesh_difference(&wanted, &found);
    if (!difference && scenarios[index].slabs && found.slab_count < 2) difference = "the grid was not cut into slabs";
    if (difference) snprintf(problem, sizeof problem, "isovalue %g: %s", isovalues[surface], difference);
    return !difference;
}

static bool counts_are_right(int index, int surface, const tc_counts *found) {
    tc_mesh_data wanted = {.struct_size = sizeof wanted};
    if (tc_mesh_get(expected[index][surface], &wanted)) return false;
    if (found->vertex_count == wanted.vertex_count && found->triangle_count == wanted.triangle_count) return true;
    snprintf(problem, sizeof problem, "isovalue %g: counts are wrong", isovalues[surface]);
    return false;
}

/* Counts and extracts both surfaces, the second into the mesh of the first; then the first again. */
static tc_status surfaces_run(int index, trial *t, tc_grid *grid) {
    tc_mesh *mesh = NULL;
    tc_status status = TC_OK;
    bool fine = true;
    for (int n = 0; n < 3 && fine; n++) {
        const tc_extract_options how = surface_describe(&scenarios[index], n % 2);
        tc_counts counts = {.struct_size = sizeof counts};
        if (n < 2) fine = TRIED(t, tc_count(grid, &how, &counts)) && counts_are_right(index, n, &counts);
        fine = fine && TRIED(t, tc_extract(grid, &how, &mesh)) && mesh_is_right(index, n % 2, mesh);
    }
    tc_mesh_destroy(mesh);
    return status;
}

static bool interval_is_right(int index, int n, const tc_interval_volume *interval) {
    tc_interval_volume_data found = {.struct_size = sizeof found}, wanted = {.struct_size = sizeof wanted};
    if (tc_interval_volume_get(interval, &found) || tc_interval_volume_get(expected_intervals[index][n], &wanted))
        return false;
    const bool sizes = found.vertex_count == wanted.vertex_count && found.tetrahedron_count == wanted.tetrahedron_count;
    const char *difference =
        !sizes                                                                               ? "sizes differ"
        : memcmp(found.positions, wanted.positions, 12 * (size_t)wanted.vertex_count)        ? "positions differ"
        : memcmp(found.tetrahedra, wanted.tetrahedra, 16 * (size_t)wanted.tetrahedron_count) ? "tetrahedra differ"
        : scenarios[index].slabs && found.slab_count < 2 ? "the grid was not cut into slabs"
                                                         : NULL;
    if (difference) snprintf(problem, sizeof problem, "interval volume from %g on: %s", isovalues[n], difference);
    return !difference;
}

/* Interval volumes as surfaces_run does surfaces, with a field carried to the first. */
static tc_status intervals_run(int index, trial *t, tc_grid *grid) {
    const tc_field field = {.struct_size = sizeof field, .type = TC_F32, .components = 1, .values = values};
    tc_interval_volume *interval = NULL;
    tc_status status = TC_OK;
    bool fine = true;
    for (int n = 0; n < 3 && fine; n++) {
        const tc_interval_volume_options how = interval_describe(n % 2);
        tc_interval_volume_counts counts = {.struct_size = sizeof counts};
        if (n < 2) fine = TRIED(t, tc_count_interval_volume(grid, &how, &counts));
        fine = fine && TRIED(t, tc_extract_interval_volume(grid, &how, &interval)) &&
               interval_is_right(index, n % 2, interval);
    }
    if (fine) {
        const tc_interval_volume_options how = interval_describe(0);
        tc_interval_volume_data d = {.struct_size = sizeof d};
        tc_interval_volume_get(interval, &d);
        float *carried = calloc((size_t)d.vertex_count, sizeof *carried);
        (void)TRIED(t, tc_interpolate_interval_volume(grid, &how, &field, carried, d.vertex_count));
        free(carried);
    }
    tc_interval_volume_destroy(interval);
    return status;
}

static tc_status label_surfaces_run(int index, trial *t, tc_grid *grid) {
    tc_mesh *mesh = NULL;
    tc_status status = TC_OK;
    bool fine = true;
    for (int n = 0; n < 3 && fine; n++) {
        const tc_labels_options how = labels_describe(n % 2);
        fine = TRIED(t, tc_extract_labels(grid, &how, &mesh)) && mesh_is_right(index, n % 2, mesh);
    }
    tc_mesh_destroy(mesh);
    return status;
}

static tc_status results_run(int index, trial *t, tc_grid *grid) {
    if (scenarios[index].flow == FLOW_LABELS) return label_surfaces_run(index, t, grid);
    return scenarios[index].interval ? intervals_run(index, t, grid) : surfaces_run(index, t, grid);
}

/* ------------------------------------------------------------------------------------------------------------ flows */

static tc_status devices_run(trial *t) {
    int count = 0;
    tc_device_info info = {.struct_size = sizeof info};
    tc_status status;
    if (TRIED(t, tc_device_count(&count)) && count > 0 && TRIED(t, tc_device_get(0, &info)) && !info.compute_units)
        snprintf(problem, sizeof problem, "the device has no compute units");
    return status;
}

static tc_status grid_run(int index, trial *t, tc_context *context) {
    tc_grid_options options;
    tc_grid *grid = NULL;
    tc_status status;
    grid_describe(&scenarios[index], &options);
    if (TRIED(t, tc_grid_create(context, &options, &grid))) status = results_run(index, t, grid);
    tc_grid_destroy(grid);
    return status;
}

static tc_status complex_run(int index, trial *t, tc_context *context) {
    const tc_tetrahedra_grid_options options = complex_describe(&scenarios[index]);
    tc_grid *grid = NULL;
    tc_status status;
    if (TRIED(t, tc_tetrahedra_grid_create(context, &options, &grid))) status = results_run(index, t, grid);
    tc_grid_destroy(grid);
    return status;
}

/* A cone as a polyhedron of so many faces and corners that cutting it takes memory. */
static tc_cells cone_describe(void) {
    enum { SIDES = 300 };
    static float cone_points[3 * (SIDES + 1)];
    static int64_t starts[2] = {0, SIDES + 1}, face_offsets[SIDES + 2], faces[4 * SIDES];
    static const int64_t offsets[2] = {0, 0};
    static const uint8_t polyhedron = 42;
    for (int n = 0; n < SIDES; n++) {
        cone_points[3 * n] = (float)cos(n * 2 * M_PI / SIDES),
                        cone_points[3 * n + 1] = (float)sin(n * 2 * M_PI / SIDES);
        faces[3 * n] = SIDES, faces[3 * n + 1] = n, faces[3 * n + 2] = (n + 1) % SIDES;
        faces[3 * SIDES + n] = SIDES - 1 - n;
        face_offsets[n] = 3 * n;
    }
    cone_points[3 * SIDES + 2] = 1;
    face_offsets[SIDES] = 3 * SIDES, face_offsets[SIDES + 1] = 4 * SIDES;
    return (tc_cells){.struct_size = sizeof(tc_cells),
                      .point_count = SIDES + 1,
                      .points = cone_points,
                      .cell_count = 1,
                      .types = &polyhedron,
                      .offsets = offsets,
                      .cell_faces = starts,
                      .face_offsets = face_offsets,
                      .face_connectivity = faces};
}

/* Cuts a polyhedron, and the grid into a complex, and carries a field onto the surface. */
static tc_status carry_run(int index, trial *t, tc_context *context) {
    tc_grid_options options;
    tc_grid *grid = NULL;
    const tc_cells cone = cone_describe();
    tc_tetrahedra cut = {.struct_size = sizeof cut}, cut_cone = {.struct_size = sizeof cut_cone};
    tc_mesh_data wanted = {.struct_size = sizeof wanted};
    const tc_extract_options how = surface_describe(&scenarios[index], 0);
    const tc_field field = {.struct_size = sizeof field, .type = TC_F32, .components = 1, .values = values};
    tc_status status;
    grid_describe(&scenarios[index], &options);
    tc_mesh_get(expected[index][0], &wanted);
    float *carried = calloc((size_t)wanted.vertex_count, sizeof *carried);
    if (TRIED(t, tc_tetrahedralize(&cone, &cut_cone)) && TRIED(t, tc_tetrahedralize_grid(&options, &cut)) &&
        TRIED(t, tc_grid_create(context, &options, &grid)))
        (void)TRIED(t, tc_interpolate_field(grid, &how, &field, carried, wanted.vertex_count));
    tc_tetrahedra_release(&cut);
    tc_tetrahedra_release(&cut_cone);
    tc_grid_destroy(grid);
    free(carried);
    return status;
}

/* Counts, then emits into the caller's buffers. The command that reads them back is the caller's too. */
static tc_status emit_run(int index, trial *t, tc_context *context) {
    tc_grid_options options;
    tc_grid *grid = NULL;
    tc_status status;
    cl_event done = NULL;
    const tc_extract_options how = surface_describe(&scenarios[index], 0);
    const tc_device_mesh mesh = {
        .struct_size = sizeof mesh, .positions = their_positions, .triangles = their_triangles};
    tc_counts counts = {.struct_size = sizeof counts};
    grid_describe(&scenarios[index], &options);
    options.samples = NULL;
    options.cl_samples = their_samples;
    if (TRIED(t, tc_grid_create(context, &options, &grid)) && TRIED(t, tc_count(grid, &how, &counts)) &&
        counts_are_right(index, 0, &counts))
        (void)TRIED(t, tc_emit(grid, &how, &mesh, &done));
    if (done) clReleaseEvent(done);
    tc_grid_destroy(grid);
    return status;
}

static void emitted_check(int index) {
    tc_mesh_data wanted = {.struct_size = sizeof wanted};
    tc_mesh_get(expected[index][0], &wanted);
    const size_t position_bytes = 12 * (size_t)wanted.vertex_count, triangle_bytes = 12 * (size_t)wanted.triangle_count;
    char *positions = malloc(position_bytes), *triangles = malloc(triangle_bytes);
    cl_int error =
        clEnqueueReadBuffer(their_queue, their_positions, CL_TRUE, 0, position_bytes, positions, 0, NULL, NULL);
    if (!error)
        error = clEnqueueReadBuffer(their_queue, their_triangles, CL_TRUE, 0, triangle_bytes, triangles, 0, NULL, NULL);
    if (error || memcmp(positions, wanted.positions, position_bytes) ||
        memcmp(triangles, wanted.triangles, triangle_bytes))
        snprintf(problem, sizeof problem, "what was emitted differs (%d)", (int)error);
    free(positions);
    free(triangles);
}

/* --------------------------------------------------------------------------------------------------------- contexts */

static void cache_clear(void) {
    DIR *cache = opendir(folder);
    char path[PATH_BYTES];
    for (struct dirent *entry; cache && (entry = readdir(cache));) {
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        if (entry->d_name[0] != '.') unlink(path);
    }
    if (cache) closedir(cache);
}

static tc_context_options context_describe(int index) {
    const scenario *s = &scenarios[index];
    tc_context_options o;
    static tc_expert_options expert;
    options_init(&o, &expert);
    o.engine = s->engine;
    expert.always_copy = s->always_copy;
    o.max_memory_bytes = budgets[index];
    if (s->flow == FLOW_EMIT) {
        o.cl_context = theirs;
        o.cl_queue = their_queue;
    }
    return o;
}

static tc_status context_run(int index, trial *t) {
    const tc_context_options options = context_describe(index);
    const flow kind = scenarios[index].flow;
    tc_context *context = NULL;
    tc_status status;
    if (TRIED(t, tc_context_create(&options, &context)))
        status = kind == FLOW_COMPLEX ? complex_run(index, t, context)
                 : kind == FLOW_EMIT  ? emit_run(index, t, context)
                 : kind == FLOW_CARRY ? carry_run(index, t, context)
                                      : grid_run(index, t, context);
    tc_context_destroy(context);
    return status;
}

const char *scenario_run(int index, trial *t) {
    const scenario *s = &scenarios[index];
    problem[0] = 0;
    if (s->cold) cache_clear();
    const tc_status status = s->flow == FLOW_DEVICES ? devices_run(t) : context_run(index, t);
    if (t->over) t->over(t);
    if (status == TC_OK && !problem[0] && s->flow == FLOW_EMIT) emitted_check(index);
    return problem[0] ? problem : NULL;
}

/* ------------------------------------------------------------------------------------------------------ preparation */

static bool calls_may_fail(trial *t, const char *call, tc_status status) {
    (void)t, (void)call, (void)status;
    return false;
}

/* To within a tenth, the least memory that a grid does with, so that there are many slabs; of a complex, which can be
 * cut into thousands, the most that still cuts it. */
static bool budget_find(int index) {
    const bool falling = scenarios[index].flow == FLOW_COMPLEX;
    trial quiet = {.failed = calls_may_fail};
    for (budgets[index] = falling ? 100000000 : 2000; budgets[index] >= 2000 && budgets[index] <= 100000000;
         budgets[index] = falling ? budgets[index] / 10 * 9 : budgets[index] / 10 * 11) {
        problem[0] = 0;
        if (context_run(index, &quiet) == TC_OK && !problem[0]) return true;
    }
    return false;
}

static tc_status reference_make(int index, int n, tc_grid *grid) {
    const scenario *s = &scenarios[index];
    const tc_extract_options surface = surface_describe(s, n);
    const tc_labels_options all = labels_describe(n);
    const tc_interval_volume_options interval = interval_describe(n);
    if (s->flow == FLOW_LABELS) return tc_extract_labels(grid, &all, &expected[index][n]);
    if (s->interval) return tc_extract_interval_volume(grid, &interval, &expected_intervals[index][n]);
    return tc_extract(grid, &surface, &expected[index][n]);
}

static tc_status reference_extract_all(tc_context *reference) {
    tc_status status = TC_OK;
    for (int index = 0; index < SCENARIOS && !status; index++) {
        const scenario *s = &scenarios[index];
        tc_grid_options options;
        const tc_tetrahedra_grid_options complex_options = complex_describe(s);
        tc_grid *grid = NULL;
        if (s->flow == FLOW_DEVICES) continue;
        grid_describe(s, &options);
        status = s->flow == FLOW_COMPLEX ? tc_tetrahedra_grid_create(reference, &complex_options, &grid)
                                         : tc_grid_create(reference, &options, &grid);
        for (int n = 0; n < 2 && !status; n++) status = reference_make(index, n, grid);
        tc_grid_destroy(grid);
    }
    return status;
}

/* The context, queue and buffers of a caller. */
static bool theirs_make(void) {
    cl_platform_id platform;
    cl_device_id device;
    cl_int error;
    if (clGetPlatformIDs(1, &platform, NULL) || clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, NULL))
        return false;
    theirs = clCreateContext(NULL, 1, &device, NULL, NULL, &error);
    if (!error) their_queue = clCreateCommandQueue(theirs, device, 0, &error);
    if (!error)
        their_samples = clCreateBuffer(theirs, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, sizeof bytes, bytes, &error);
    if (!error) their_positions = clCreateBuffer(theirs, CL_MEM_READ_WRITE, 1 << 20, NULL, &error);
    if (!error) their_triangles = clCreateBuffer(theirs, CL_MEM_READ_WRITE, 1 << 20, NULL, &error);
    return !error;
}

bool scenarios_prepare(void) {
    tc_context *reference = NULL;
    tc_context_options options;
    tc_grid_options grid;
    input_make();
    folder_make("programs");
    setenv("TETRACUBES_CACHE_DIR", folder, 1);
    complex.struct_size = sizeof complex;
    grid_describe(&scenarios[1], &grid);
    grid.points = points;
    tc_context_options_init(&options);
    options.engine = TC_ENGINE_REFERENCE;
    tc_status status = tc_context_create(&options, &reference);
    if (!status) status = tc_tetrahedralize_grid(&grid, &complex);
    if (!status) status = cells_make();
    if (!status) status = reference_extract_all(reference);
    tc_context_destroy(reference);
    if (status || !theirs_make()) return false;
    for (int index = 0; index < SCENARIOS; index++)
        if (scenarios[index].slabs && test_chosen(scenarios[index].name) && !budget_find(index)) return false;
    return true;
}

void scenarios_release(void) {
    cl_mem buffers[] = {their_samples, their_positions, their_triangles};
    for (int index = 0; index < SCENARIOS; index++)
        for (int n = 0; n < 2; n++)
            tc_mesh_destroy(expected[index][n]), tc_interval_volume_destroy(expected_intervals[index][n]);
    tc_tetrahedra_release(&complex);
    tc_tetrahedra_release(&of_cells);
    folder_remove();
    for (int n = 0; n < 3; n++)
        if (buffers[n]) clReleaseMemObject(buffers[n]);
    if (their_queue) clReleaseCommandQueue(their_queue);
    if (theirs) clReleaseContext(theirs);
}
