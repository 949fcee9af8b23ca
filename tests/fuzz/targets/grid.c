/*
 * grid.c - the options of structured grids and extractions, of any value; arrays as large as the options say
 *
 * Sizes that no memory could hold go with arrays that are not that large: such a grid has to be refused, or, where its
 * sizes alone are possible, be left unread. The surface of a grid is also compared with that of the complex which the
 * library makes of it: both have as many triangles.
 */
#include "bytes.h"
#include "check.h"
#include "hang.h"
#include "surface.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { SAMPLES_MOST = 1 << 11, NO_METHOD = TC_METHOD_SNAP + 1 };
enum { HAS_AXES = 1, HAS_POINTS = 2, HAS_BLANKED = 4, HAS_BLANKED_CELLS = 8, HAS_MATRIX = 16, IS_LARGE = 32 };

typedef struct arrays {
    void *of[7];
    int count;
} arrays;

static void *array(arrays *a, bytes *b, int64_t size) { return a->of[a->count++] = bytes_array(b, (size_t)size); }

static void release(arrays *a) {
    while (a->count) free(a->of[--a->count]);
}

static void take_sizes(bytes *b, uint8_t flags, tc_grid_options *grid) {
    static const uint8_t limits[3] = {70, 12, 8}; /* a little more than a brick */
    for (int axis = 0; axis < 3; axis++) {
        grid->dims[axis] = flags & IS_LARGE ? bytes_i64(b) : bytes_u8(b) % limits[axis];
        grid->first_index[axis] = flags & IS_LARGE ? bytes_i64(b) : (int8_t)bytes_u8(b);
    }
}

/* How many samples there are, or 0 where they are too many for this test, or none. */
static int64_t sample_count(const tc_grid_options *grid) {
    int64_t count = 1;
    for (int axis = 0; axis < 3; axis++)
        if (grid->dims[axis] < 1 || __builtin_mul_overflow(count, grid->dims[axis], &count)) return 0;
    return count <= SAMPLES_MOST ? count : 0;
}

/* Coordinates are small fractions, or any bits. */
static const float *coordinates(arrays *a, bytes *b, int64_t count) {
    int any = bytes_u8(b) & 1;
    float *out = array(a, b, count * (int64_t)sizeof *out);
    for (int64_t n = 0; n < count && !any; n++) {
        int8_t value;
        memcpy(&value, out + n, 1);
        out[n] = value / 8.0f;
    }
    return out;
}

static void take_arrays(arrays *a, bytes *b, uint8_t flags, int64_t samples, tc_grid_options *grid) {
    if (flags & HAS_POINTS) grid->points = coordinates(a, b, 3 * samples);
    for (int axis = 0; axis < 3 && flags & HAS_AXES; axis++) grid->axes[axis] = coordinates(a, b, grid->dims[axis]);
    if (flags & HAS_BLANKED) grid->blanked_samples = array(a, b, samples);
    if (flags & HAS_BLANKED_CELLS)
        grid->blanked_cells = array(a, b, (grid->dims[0] - 1) * (grid->dims[1] - 1) * (grid->dims[2] - 1));
    grid->samples = array(a, b, samples * (int64_t)tc_type_bytes(grid->type));
}

/* The grid cut into a complex, and that one's surface. */
static void compare_complex(const tc_grid_options *from, const tc_extract_options *how, uint64_t triangle_count) {
    tc_tetrahedra complex = {.struct_size = sizeof complex};
    tc_status status = tc_tetrahedralize_grid(from, &complex);
    surface_check_status(status);
    CHECK(status == TC_OK);
    const int64_t *d = from->dims;
    const uint64_t points = (uint64_t)(d[0] * d[1] * d[2]);
    surface_check_complex(&complex, points, (uint64_t)((d[0] - 1) * (d[1] - 1) * (d[2] - 1)));
    float *zeros = calloc(3 * points, sizeof *zeros);
    tc_tetrahedra_grid_options options;
    tc_tetrahedra_grid_options_init(&options);
    options.point_count = points;
    options.points = from->points ? from->points : zeros;
    options.type = from->type;
    options.samples = from->samples;
    options.tetrahedron_count = complex.tetrahedron_count;
    options.tetrahedra = complex.tetrahedra;
    tc_grid *grid = NULL;
    status = tc_tetrahedra_grid_create(surface_context(), &options, &grid);
    surface_check_status(status);
    if (status == TC_OK) CHECK(surface_check(grid, how, from->type, from->samples) == triangle_count);
    tc_grid_destroy(grid);
    tc_tetrahedra_release(&complex);
    free(zeros);
}

/* Hybrid tables cost a thousand small grids: one input in eight asks for them, one for snap, one for no method. */
static tc_method method_of(uint8_t bits) {
    static const tc_method last[3] = {TC_METHOD_SNAP, (tc_method)NO_METHOD, TC_METHOD_HYBRID};
    const uint8_t number = bits >> 4 & 7;
    return number < 5 ? TC_METHOD_TETRA : last[number - 5];
}

static void extract(const tc_grid_options *from, tc_grid *grid, uint8_t bits, double isovalue) {
    tc_extract_options how;
    tc_extract_options_init(&how);
    how.isovalue = isovalue;
    how.normals = bits & 1;
    how.method = method_of(bits);
    if (how.method == TC_METHOD_SNAP && bits & 2) how.snap = bits & 4 ? isovalue : bits & 8 ? 0.25 : 0;
    uint64_t triangles = surface_check(grid, &how, from->type, from->samples);
    if (!(bits & 2) || how.method != TC_METHOD_TETRA) return;
    how.normals = 0;
    compare_complex(from, &how, triangles);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const uint64_t no_samples[8];
    bytes in = {data, size};
    arrays made = {0};
    tc_grid_options o;
    tc_grid *grid = NULL;
    hang_watch();
    tc_grid_options_init(&o);
    uint8_t flags = bytes_u8(&in), how = bytes_u8(&in);
    o.type = (tc_type)(bytes_u8(&in) % (TC_F64 + 2));
    o.has_nodata = how >> 7;
    take_sizes(&in, flags, &o);
    o.nodata = bytes_f64(&in);
    double isovalue = bytes_f64(&in);
    if (flags & HAS_MATRIX) bytes_take(&in, o.matrix, sizeof o.matrix);
    int64_t samples = sample_count(&o);
    if (samples)
        take_arrays(&made, &in, flags, samples, &o);
    else
        o.samples = no_samples;
    tc_status status = tc_grid_create(surface_context(), &o, &grid);
    surface_check_status(status);
    CHECK((status == TC_OK) == (grid != NULL));
    if (grid && samples) extract(&o, grid, how, isovalue);
    tc_grid_destroy(grid);
    release(&made);
    return 0;
}
