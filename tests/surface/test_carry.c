/*
 * test_carry.c - carried fields of the OpenCL engine against the scalar reference's, bit for bit
 *
 * Proves: values are the same for all types of samples and of fields, one component and several, all methods, uniform,
 * rectilinear and curvilinear grids, with and without missing samples and cells, and complexes; whole and in slabs; in
 * both variants of the kernels; after an extraction, a count, a call for another surface, and with nothing before. Room
 * for more or fewer values is refused, and nothing is written then.
 */
#include "engines.h"
#include "random.h"

#include <math.h>

enum { NX = 131, NY = 21, NZ = 27, COUNT = NX * NY * NZ, COMPONENTS = 3, TYPES = TC_F64 + 1 };

static uint64_t samples[TYPES][COUNT];
static uint64_t fields[TYPES][COMPONENTS * COUNT];
static float points[3 * COUNT], axes[3][NX];
static uint8_t blanked[COUNT], blanked_cells[COUNT];
static float found[COMPONENTS * 6 * COUNT], expected[COMPONENTS * 6 * COUNT];
static tc_tetrahedra cut = {.struct_size = sizeof cut};

static void value_set(void *values, tc_type type, int n, double value) {
    switch (type) {
    case TC_U8:
        ((uint8_t *)values)[n] = (uint8_t)value;
        break;
    case TC_I8:
        ((int8_t *)values)[n] = (int8_t)(value - 128);
        break;
    case TC_U16:
        ((uint16_t *)values)[n] = (uint16_t)(value * 200);
        break;
    case TC_I16:
        ((int16_t *)values)[n] = (int16_t)(value * 200 - 25000);
        break;
    case TC_U32:
        ((uint32_t *)values)[n] = (uint32_t)(value * 16e6);
        break;
    case TC_I32:
        ((int32_t *)values)[n] = (int32_t)(value * 16e6 - 2e9);
        break;
    case TC_F32:
        ((float *)values)[n] = (float)value;
        break;
    default:
        ((double *)values)[n] = value;
        break;
    }
}

/* A value of 0 to 255 taken to the range of the type. */
static double isovalue_of(tc_type type, double value) {
    static const double scale[TYPES] = {1, 1, 200, 200, 16e6, 16e6, 1, 1};
    static const double shift[TYPES] = {0, -128, 0, -25000, 0, -2e9, 0, 0};
    return scale[type] * value + shift[type];
}

static void fill(void) {
    for (int n = 0; n < COUNT; n++) {
        const int x = n % NX, y = n / NX % NY, z = n / NX / NY;
        const double wave = 127.5 + 45 * sin(0.3 * x + 0.2 * z) + 45 * cos(0.7 * y + 0.4 * z);
        const double value = floor(wave + 30 * random_between(0, 1));
        for (int type = 0; type < TYPES; type++) {
            value_set(samples[type], (tc_type)type, n, value);
            for (int c = 0; c < COMPONENTS; c++)
                value_set(fields[type], (tc_type)type, COMPONENTS * n + c, 250 * random_between(0, 1));
        }
        points[3 * n] = (float)(x + 0.2 * sin(y));
        points[3 * n + 1] = (float)(y + 0.1 * x);
        points[3 * n + 2] = (float)(z + 0.2 * cos(x));
        blanked[n] = random_between(0, 1) < 0.01;
        blanked_cells[n] = random_between(0, 1) < 0.01;
    }
    for (int n = 0; n < NX; n++) axes[0][n] = axes[1][n] = axes[2][n] = 0.01f * (float)(n * n) + (float)n;
}

/* A grid of one of these kinds. */
typedef enum kind { UNIFORM, RECTILINEAR, CURVILINEAR, MISSING, BLANKED, COMPLEX, KINDS } kind;
static const char *const kind_names[KINDS] = {"uniform", "rectilinear", "curvilinear", "missing", "blanked", "complex"};

static tc_grid *open_grid(tc_context *context, kind k, tc_type type) {
    tc_grid_options o;
    tc_grid *grid = NULL;
    if (k == COMPLEX) {
        tc_tetrahedra_grid_options complex;
        tc_tetrahedra_grid_options_init(&complex);
        complex.point_count = COUNT;
        complex.points = points;
        complex.type = type;
        complex.samples = samples[type];
        complex.tetrahedron_count = cut.tetrahedron_count;
        complex.tetrahedra = cut.tetrahedra;
        EXPECT(tc_tetrahedra_grid_create(context, &complex, &grid) == TC_OK, "%s", tc_message());
        return grid;
    }
    tc_grid_options_init(&o);
    o.dims[0] = NX, o.dims[1] = NY, o.dims[2] = NZ;
    o.first_index[0] = k == RECTILINEAR;
    o.type = type;
    o.samples = samples[type];
    for (int axis = 0; axis < 3 && k == RECTILINEAR; axis++) o.axes[axis] = axes[axis];
    if (k == CURVILINEAR) o.points = points;
    if (k == BLANKED) o.blanked_samples = blanked, o.blanked_cells = blanked_cells;
    if (k == MISSING) o.has_nodata = 1, o.nodata = isovalue_of(type, 140);
    EXPECT(tc_grid_create(context, &o, &grid) == TC_OK, "%s", tc_message());
    return grid;
}

static tc_extract_options how_of(tc_type type, tc_method method, double value) {
    tc_extract_options how;
    tc_extract_options_init(&how);
    how.isovalue = isovalue_of(type, value);
    how.method = method;
    return how;
}

static uint64_t vertices_of(tc_grid *grid, const tc_extract_options *how, uint32_t *slabs) {
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    EXPECT(tc_extract(grid, how, &mesh) == TC_OK && tc_mesh_get(mesh, &data) == TC_OK, "%s", tc_message());
    if (slabs) *slabs = data.slab_count;
    tc_mesh_destroy(mesh);
    return data.vertex_count;
}

/* Every value of the two grids' fields; the device's grid is in whatever state. */
static void compare(tc_grid *grid, tc_grid *reference, const tc_extract_options *how, tc_type type, int components,
                    uint64_t vertices, const char *what) {
    const tc_field field = {sizeof field, type, components, fields[type]};
    const uint64_t count = vertices * (uint64_t)components;
    memset(found, 0xa5, sizeof *found * (size_t)(count + 1));
    memset(expected, 0x5a, sizeof *expected * (size_t)(count + 1));
    EXPECT(tc_interpolate_field(reference, how, &field, expected, count) == TC_OK, "%s: %s", what, tc_message());
    EXPECT(tc_interpolate_field(grid, how, &field, found, count) == TC_OK, "%s: %s", what, tc_message());
    uint64_t n = 0;
    while (n < count && memcmp(&found[n], &expected[n], sizeof *found) == 0) n++;
    EXPECT(n == count, "%s, field of %s: value %llu of %llu is %g, not %g", what, tc_type_name(type),
           (unsigned long long)n, (unsigned long long)count, (double)found[n], (double)expected[n]);
}

static void test_surface(tc_context *context, tc_context *reference, kind k, tc_type type, tc_method method,
                         const char *mode) {
    char what[128];
    const tc_extract_options how = how_of(type, method, 127.5), other = how_of(type, method, 140);
    tc_grid *grid = open_grid(context, k, type), *slow = open_grid(reference, k, type);
    tc_grid *beside = open_grid(context, UNIFORM, TC_U8);
    snprintf(what, sizeof what, "%s, %s, %s samples, %s", mode, kind_names[k], tc_type_name(type),
             tc_method_name(method));
    const uint64_t vertices = vertices_of(slow, &how, NULL), fewer = vertices_of(slow, &other, NULL);
    EXPECT(vertices > 1000 && fewer > 1000, "%s: small surfaces", what);
    compare(grid, slow, &how, TC_F32, 1, vertices, what); /* nothing was made before */
    vertices_of(grid, &other, NULL);
    compare(grid, slow, &how, TC_F64, 1, vertices, what); /* another surface was */
    vertices_of(grid, &how, NULL);
    compare(grid, slow, &how, (tc_type)((int)type * 5 % TYPES), COMPONENTS, vertices, what); /* the same was */
    const tc_extract_options besides = how_of(TC_U8, TC_METHOD_TETRA, 100);
    vertices_of(beside, &besides, NULL);
    compare(grid, slow, &other, TC_U8, 2, fewer, what); /* another grid's was */
    tc_counts counts = {.struct_size = sizeof counts};
    EXPECT(tc_count(grid, &how, &counts) == TC_OK, "%s", tc_message());
    compare(grid, slow, &how, TC_I16, 1, vertices, what);
    tc_grid_destroy(beside);
    compare(grid, slow, &how, TC_I8, 1, vertices, what);
    tc_grid_destroy(grid);
    tc_grid_destroy(slow);
}

static void test_fields(tc_context *context, tc_context *reference) {
    const tc_extract_options how = how_of(TC_F32, TC_METHOD_TETRA, 127.5);
    tc_grid *grid = open_grid(context, UNIFORM, TC_F32), *slow = open_grid(reference, UNIFORM, TC_F32);
    const uint64_t vertices = vertices_of(grid, &how, NULL);
    for (int type = 0; type < TYPES; type++)
        for (int components = 1; components <= COMPONENTS; components++)
            compare(grid, slow, &how, (tc_type)type, components, vertices, "fields");
    const tc_field field = {sizeof field, TC_F32, 1, fields[TC_F32]};
    for (int more = -1; more <= 1; more += 2) {
        memset(found, 0xa5, sizeof *found * (size_t)(vertices + 1));
        EXPECT_REFUSED(tc_interpolate_field(grid, &how, &field, found, vertices + (uint64_t)more), TC_ERROR_ARGUMENT,
                       "room");
        uint32_t first;
        memcpy(&first, found, sizeof first);
        EXPECT(first == 0xa5a5a5a5u, "written without room");
    }
    tc_grid_destroy(grid);
    tc_grid_destroy(slow);
}

typedef struct surface_case {
    kind k;
    tc_type type;
    tc_method method;
} surface_case;

/* Few, as each has kernels to be built. The first are tried with groups of work-items, too. */
static const surface_case cases[] = {
    {UNIFORM, TC_F32, TC_METHOD_TETRA}, {BLANKED, TC_I16, TC_METHOD_HYBRID},    {MISSING, TC_U32, TC_METHOD_TETRA},
    {COMPLEX, TC_F32, TC_METHOD_TETRA}, {MISSING, TC_U8, TC_METHOD_SNAP},       {UNIFORM, TC_U8, TC_METHOD_HYBRID},
    {UNIFORM, TC_I8, TC_METHOD_TETRA},  {UNIFORM, TC_U16, TC_METHOD_TETRA},     {MISSING, TC_F32, TC_METHOD_TETRA},
    {UNIFORM, TC_I32, TC_METHOD_TETRA}, {RECTILINEAR, TC_F32, TC_METHOD_TETRA}, {CURVILINEAR, TC_F64, TC_METHOD_TETRA}};

static bool case_chosen(const surface_case *c) {
    char name[64];
    snprintf(name, sizeof name, "%s %s %s", kind_names[c->k], tc_type_name(c->type), tc_method_name(c->method));
    return test_chosen(name);
}

enum { CASES = sizeof cases / sizeof *cases, CASES_IN_GROUPS = 5, CASES_IN_SLABS = 5 };

static void test_mode(const tc_context_options *options, tc_context *reference, int count, const char *mode) {
    tc_context *context = context_open(options);
    for (int n = 0; n < count; n++)
        if (case_chosen(&cases[n])) test_surface(context, reference, cases[n].k, cases[n].type, cases[n].method, mode);
    if (test_chosen("fields")) test_fields(context, reference);
    tc_context_destroy(context);
}

/* In how many slabs the kind is extracted, 0 where memory does not suffice; and the memory that it takes. */
static uint32_t slabs_within(const tc_context_options *options, kind k, tc_type type, const tc_extract_options *how,
                             uint64_t *bytes) {
    uint32_t slabs = 0;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    tc_context *context = context_open(options);
    tc_grid *grid = open_grid(context, k, type);
    if (tc_extract(grid, how, &mesh) == TC_OK && tc_mesh_get(mesh, &data) == TC_OK) slabs = data.slab_count;
    tc_context_device_bytes(context, bytes);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
    return slabs;
}

/* The most memory, of some, in which the kind is extracted in several slabs. Windows of snap are nearly the whole grid,
 * so it has to be little less than for that: what suffices for one slab is found to a hundredth by bisection, down from
 * twice what it takes without a bound. */
static uint64_t slabs_memory(tc_context_options options, kind k, tc_type type, const tc_extract_options *how) {
    const uint64_t part = how->method == TC_METHOD_SNAP ? 100 : 4;
    uint64_t taken;
    options.max_memory_bytes = 0;
    slabs_within(&options, k, type, how, &taken);
    uint64_t one = 2 * taken, less = taken / 2;
    while (one - less > one / part) {
        options.max_memory_bytes = less + (one - less) / 2;
        *(slabs_within(&options, k, type, how, &taken) == 1 ? &one : &less) = options.max_memory_bytes;
    }
    for (options.max_memory_bytes = less; options.max_memory_bytes > 1 << 14;
         options.max_memory_bytes -= options.max_memory_bytes / part)
        if (slabs_within(&options, k, type, how, &taken) > 1) return options.max_memory_bytes;
    EXPECT(0, "never in slabs");
    return 0;
}

static void test_slabs(tc_context_options options, tc_context *reference, const char *mode) {
    for (int n = 0; n < CASES_IN_SLABS; n++) {
        const tc_extract_options how = how_of(cases[n].type, cases[n].method, 127.5);
        if (!case_chosen(&cases[n])) continue;
        options.max_memory_bytes = slabs_memory(options, cases[n].k, cases[n].type, &how);
        tc_context *context = context_open(&options);
        test_surface(context, reference, cases[n].k, cases[n].type, cases[n].method, mode);
        tc_context_destroy(context);
    }
}

int main(void) {
    tc_context_options options;
    tc_grid_options grid;
    if (!device_exists()) return SKIPPED;
    tc_context_options_init(&options);
    tc_context *reference = reference_open();
    fill();
    tc_grid_options_init(&grid);
    grid.dims[0] = NX, grid.dims[1] = NY, grid.dims[2] = NZ;
    grid.type = TC_F32;
    grid.samples = samples[TC_F32];
    grid.points = points;
    EXPECT(tc_tetrahedralize_grid(&grid, &cut) == TC_OK, "%s", tc_message());
    test_mode(&options, reference, CASES, "whole");
    test_slabs(options, reference, "slabs");
    tc_expert_options expert;
    tc_expert_options_init(&expert);
    options.expert = &expert;
    expert.always_copy = 1;
    expert.work_items = 32;
    test_mode(&options, reference, CASES_IN_GROUPS, "groups, copied");
    test_slabs(options, reference, "groups, copied, slabs");
    tc_tetrahedra_release(&cut);
    tc_context_destroy(reference);
    return EXPECT_DONE();
}
