#include "grid/coordinates.h"

#include "failure.h"
#include "parallel.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK_POINTS = 1 << 16 };

/* ---------------------------------------------------------------------------------------------------------- checks */

typedef struct point_check {
    const tc_grid *grid;
    int64_t count;
    atomic_llong next;    /* chunk */
    atomic_llong fault;   /* the first point of a present sample that is not usable, or count */
    atomic_bool excluded; /* some point is not usable, or some sample is missing */
} point_check;

static uint32_t floats_most(const float *at, int64_t count) {
    uint32_t most = 0;
    for (int64_t n = 0; n < count; n++) {
        uint32_t bits;
        memcpy(&bits, at + n, sizeof bits);
        bits &= 0x7fffffff;
        most = most > bits ? most : bits;
    }
    return most;
}

static bool floats_usable(const float *at, int64_t count) { return floats_most(at, count) < 0x7f000000; }

static bool floats_finite(const float *at, int64_t count) { return floats_most(at, count) < 0x7f800000; }

static bool point_usable(const tc_grid *grid, int64_t n) { return floats_usable(grid->points + 3 * n, 3); }

/* Whether some sample of the chunk has no value. Samples that are only blanked may be overlooked. */
static bool chunk_misses(const tc_grid *grid, int64_t first, int64_t end) {
    bool misses = false;
    if (!grid->samples || !(grid->has_nodata || type_is_real(grid->type))) return false;
    if (grid->type == TC_F32 && !grid->has_nodata)
        return !floats_finite((const float *)grid->samples + first, end - first);
    for (int64_t n = first; n < end && !misses; n++) misses = grid_sample_missing(grid, n);
    return misses;
}

static void chunk_check(point_check *c, int64_t first, int64_t end) {
    if (!atomic_load(&c->excluded) && chunk_misses(c->grid, first, end)) atomic_store(&c->excluded, true);
    if (floats_usable(c->grid->points + 3 * first, 3 * (end - first))) return;
    atomic_store(&c->excluded, true);
    while (first < end && (point_usable(c->grid, first) || grid_sample_missing(c->grid, first))) first++;
    long long fault = atomic_load(&c->fault);
    while (first < end && first < fault && !atomic_compare_exchange_weak(&c->fault, &fault, first)) {
    }
}

static void points_check_work(void *shared) {
    point_check *c = shared;
    for (int64_t first; (first = atomic_fetch_add(&c->next, 1) * CHUNK_POINTS) < c->count;)
        chunk_check(c, first, first + CHUNK_POINTS < c->count ? first + CHUNK_POINTS : c->count);
}

/* *excluded: some samples are missing; only their points may be not usable. */
static tc_status points_check(const tc_grid *grid, bool *excluded) {
    point_check c = {.grid = grid, .count = grid_sample_count(grid)};
    atomic_init(&c.fault, c.count);
    parallel_run((uint64_t)(c.count + CHUNK_POINTS - 1) / CHUNK_POINTS, points_check_work, &c);
    int64_t n = atomic_load(&c.fault);
    *excluded = atomic_load(&c.excluded);
    if (n == c.count) return TC_OK;
    double p[3];
    for (int axis = 0; axis < 3; axis++) p[axis] = coordinate_get(grid->given_points, 3 * (uint64_t)n + (uint64_t)axis);
    return (tc_status)fail(
        TC_ERROR_DATA,
        "point %lld, %lld, %lld of the grid is at %g, %g, %g: coordinates have to be finite and below "
        "1.7e38 but for missing samples; blank the sample, if there is nothing there",
        (long long)(n % grid->dims[0]), (long long)(n / grid->dims[0] % grid->dims[1]),
        (long long)(n / grid->dims[0] / grid->dims[1]), p[0], p[1], p[2]);
}

/* ----------------------------------------------------------------------------------------------------- orientation */

typedef struct flux {
    const tc_grid *grid;
    const float *origin; /* the first point met: distances from it are small */
    double sum;
} flux;

/* a . (b x c) */
static double triple_product(const double a[3], const double b[3], const double c[3]) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Adds the flux along an axis through the face that has its lowest corner at p, times sign. */
static void face_add(flux *f, const int64_t p[3], int axis, double sign) {
    const int64_t *dims = f->grid->dims, strides[3] = {1, dims[0], dims[0] * dims[1]};
    int64_t first = p[2] * strides[2] + p[1] * strides[1] + p[0];
    int64_t u = strides[(axis + 1) % 3], v = strides[(axis + 2) % 3];
    const int64_t corners[4] = {first, first + u, first + u + v, first + v};
    double q[4][3];
    if (!f->origin) f->origin = f->grid->points + 3 * first;
    for (int n = 0; n < 4; n++)
        for (int row = 0; row < 3; row++)
            q[n][row] = (double)f->grid->points[3 * corners[n] + row] - (double)f->origin[row];
    f->sum += sign * ((triple_product(q[0], q[1], q[2]) + triple_product(q[0], q[2], q[3])) +
                      (triple_product(q[0], q[1], q[3]) + triple_product(q[1], q[2], q[3])));
}

/* The flux through the grid's boundary, where all cubes count. */
static void boundary_add(flux *f) {
    const int64_t *dims = f->grid->dims;
    for (int axis = 0; axis < 3; axis++) {
        int across = (axis + 1) % 3, up = (axis + 2) % 3;
        int64_t p[3];
        for (p[up] = 0; p[up] + 1 < dims[up]; p[up]++)
            for (p[across] = 0; p[across] + 1 < dims[across]; p[across]++) {
                p[axis] = 0;
                face_add(f, p, axis, -1);
                p[axis] = dims[axis] - 1;
                face_add(f, p, axis, 1);
            }
    }
}

/* Two planes of the grid with a margin of cubes that do not count before and after every row and plane. */
typedef struct cube_planes {
    uint8_t *samples[2]; /* nonzero: does not count */
    uint8_t *cubes[2];   /* [y + 1][x + 1] */
} cube_planes;

static bool cube_planes_allocate(const tc_grid *grid, cube_planes *planes) {
    size_t plane = (size_t)(grid->dims[0] * grid->dims[1]), cubes = (size_t)((grid->dims[0] + 1) * (grid->dims[1] + 1));
    bool done = true;
    for (int n = 0; n < 2; n++) {
        planes->samples[n] = calloc(plane, 1);
        planes->cubes[n] = malloc(cubes);
        done = done && planes->samples[n] && planes->cubes[n];
        if (planes->cubes[n]) memset(planes->cubes[n], 1, cubes);
    }
    return done;
}

static void cube_planes_release(cube_planes *planes) {
    for (int n = 0; n < 2; n++) {
        free(planes->samples[n]);
        free(planes->cubes[n]);
    }
}

static void samples_judge(const tc_grid *grid, int64_t z, uint8_t *out) {
    int64_t plane = grid->dims[0] * grid->dims[1], first = z * plane;
    for (int64_t n = 0; n < plane; n++) out[n] = grid_sample_missing(grid, first + n) || !point_usable(grid, first + n);
}

/* The cubes between two planes of samples; none where z is past the last ones. */
static void cubes_judge(const tc_grid *grid, int64_t z, uint8_t *const samples[2], uint8_t *cubes) {
    int64_t nx = grid->dims[0], ny = grid->dims[1], stride = nx + 1;
    const uint8_t *blanked = grid->blanked_cells ? grid->blanked_cells + z * (ny - 1) * (nx - 1) : NULL;
    if (z + 1 >= grid->dims[2]) {
        memset(cubes, 1, (size_t)(stride * (ny + 1)));
        return;
    }
    for (int64_t y = 0; y + 1 < ny; y++)
        for (int64_t x = 0; x + 1 < nx; x++) {
            const uint8_t *a = samples[0] + y * nx + x, *b = samples[1] + y * nx + x;
            int skipped = a[0] | a[1] | a[nx] | a[nx + 1] | b[0] | b[1] | b[nx] | b[nx + 1];
            cubes[(y + 1) * stride + x + 1] = skipped || (blanked && blanked[y * (nx - 1) + x]);
        }
}

/* The faces below, before and to the left of the cubes of plane z and one beyond, where only one cube counts. */
static void plane_add(flux *f, int64_t z, const uint8_t *below, const uint8_t *cubes) {
    int64_t nx = f->grid->dims[0], ny = f->grid->dims[1], stride = nx + 1;
    for (int64_t y = 0; y < ny; y++)
        for (int64_t x = 0; x < nx; x++) {
            int64_t n = (y + 1) * stride + x + 1, p[3] = {x, y, z};
            if (cubes[n] != cubes[n - 1]) face_add(f, p, 0, cubes[n] ? 1 : -1);
            if (cubes[n] != cubes[n - stride]) face_add(f, p, 1, cubes[n] ? 1 : -1);
            if (cubes[n] != below[n]) face_add(f, p, 2, cubes[n] ? 1 : -1);
        }
}

/* The flux through the boundary of the cubes that count, where some may not. */
static tc_status counted_add(flux *f) {
    const tc_grid *grid = f->grid;
    cube_planes planes = {0};
    if (!cube_planes_allocate(grid, &planes)) {
        cube_planes_release(&planes);
        return (tc_status)fail(TC_ERROR_MEMORY, "no memory to tell which way round the grid is");
    }
    samples_judge(grid, 0, planes.samples[0]);
    for (int64_t z = 0; z < grid->dims[2]; z++) {
        uint8_t *samples[2] = {planes.samples[z & 1], planes.samples[~z & 1]}, *cubes = planes.cubes[z & 1];
        if (z + 1 < grid->dims[2]) samples_judge(grid, z + 1, samples[1]);
        cubes_judge(grid, z, samples, cubes);
        plane_add(f, z, planes.cubes[~z & 1], cubes);
    }
    cube_planes_release(&planes);
    return TC_OK;
}

/* ---------------------------------------------------------------------------------------------------------- origin */

static int cube_corners(const void *source, uint64_t cube, double corners[][3]) {
    const tc_grid *grid = source;
    const int64_t *dims = grid->dims, nx = dims[0] - 1, ny = dims[1] - 1, n = (int64_t)cube;
    if (grid->blanked_cells && grid->blanked_cells[n]) return 0;
    for (int c = 0; c < 8; c++) {
        const int64_t x = n % nx + (c & 1), y = n / nx % ny + (c >> 1 & 1), z = n / nx / ny + (c >> 2);
        const int64_t sample = (z * dims[1] + y) * dims[0] + x;
        if (grid_sample_missing(grid, sample)) return 0;
        for (int axis = 0; axis < 3; axis++)
            corners[c][axis] = coordinate_get(grid->given_points, (uint64_t)(3 * sample + axis));
    }
    return 8;
}

static void axes_extent(const tc_grid *grid, extent *e) {
    *e = extent_empty;
    for (int axis = 0; axis < 3; axis++)
        for (int64_t n = 0; n + 1 < grid->dims[axis]; n++) {
            double interval[2][3] = {{0}};
            extent one = extent_empty;
            for (int end = 0; end < 2; end++)
                interval[end][axis] = coordinate_get(grid->given_axes[axis], (uint64_t)(n + end));
            extent_add(&one, (const double(*)[3])interval, 2);
            if (one.low[axis] < e->low[axis]) e->low[axis] = one.low[axis];
            if (one.high[axis] > e->high[axis]) e->high[axis] = one.high[axis];
            if (one.cell[axis] < e->cell[axis]) e->cell[axis] = one.cell[axis];
        }
}

void coordinates_origin(tc_grid *grid) {
    const int64_t *dims = grid->dims;
    extent e;
    if (grid->kind == GRID_CURVILINEAR) {
        origin_find(cube_corners, grid, (uint64_t)((dims[0] - 1) * (dims[1] - 1) * (dims[2] - 1)), grid->origin);
    } else {
        axes_extent(grid, &e);
        origin_choose(&e, grid->origin);
    }
}

static tc_status own_coordinates_allocate(tc_grid *grid, uint64_t count) {
    if (count <= SIZE_MAX / sizeof *grid->own_coordinates)
        grid->own_coordinates = malloc((size_t)count * sizeof *grid->own_coordinates);
    return grid->own_coordinates ? TC_OK
                                 : (tc_status)fail(TC_ERROR_MEMORY, "no memory for %llu coordinates in float32",
                                                   (unsigned long long)count);
}

/* Makes points relative to the origin. Uses the caller's array where that is so already. */
static tc_status points_move(tc_grid *grid) {
    const double *o = grid->origin;
    const uint64_t count = (uint64_t)grid_sample_count(grid);
    grid->points = grid->given_points.f32;
    if (grid->points && o[0] == 0 && o[1] == 0 && o[2] == 0) return TC_OK;
    tc_status status = own_coordinates_allocate(grid, 3 * count);
    if (status) return status;
    coordinates_move(grid->given_points, count, 3, o, grid->own_coordinates);
    grid->points = grid->own_coordinates;
    return TC_OK;
}

static tc_status axes_move(tc_grid *grid) {
    const double *o = grid->origin;
    const int64_t *dims = grid->dims;
    for (int axis = 0; axis < 3; axis++) grid->axes[axis] = grid->given_axes[axis].f32;
    if (grid->axes[0] && o[0] == 0 && o[1] == 0 && o[2] == 0) return TC_OK;
    tc_status status = own_coordinates_allocate(grid, (uint64_t)(dims[0] + dims[1] + dims[2]));
    float *to = grid->own_coordinates;
    for (int axis = 0; axis < 3 && !status; to += dims[axis++]) {
        coordinates_move(grid->given_axes[axis], (uint64_t)dims[axis], 1, &o[axis], to);
        grid->axes[axis] = to;
    }
    return status;
}

/* ----------------------------------------------------------------------------------------------------------- kinds */

static tc_status points_take(tc_grid *grid) {
    bool excluded;
    flux f = {.grid = grid};
    tc_status status = points_move(grid);
    if (!status) status = points_check(grid, &excluded);
    if (status) return status;
    if (excluded || grid->blanked_samples || grid->blanked_cells)
        status = counted_add(&f);
    else
        boundary_add(&f);
    grid->mirrored = f.sum < 0;
    return status;
}

static tc_status axes_take(tc_grid *grid) {
    double direction = 1;
    tc_status status = axes_move(grid);
    for (int axis = 0; axis < 3 && !status; axis++) {
        const float *at = grid->axes[axis];
        for (int64_t n = 0; n < grid->dims[axis]; n++)
            if (!coordinate_usable(at[n]))
                return (tc_status)fail(TC_ERROR_DATA,
                                       "position %lld along %c is %g: coordinates have to be finite and below 1.7e38",
                                       (long long)n, 'x' + axis, coordinate_get(grid->given_axes[axis], (uint64_t)n));
        float first = at[0], last = at[grid->dims[axis] - 1];
        direction *= last > first ? 1 : last < first ? -1 : 0;
    }
    grid->mirrored = direction < 0;
    return status;
}

tc_status coordinates_take(tc_grid *grid, const double *origin) {
    if (origin)
        memcpy(grid->origin, origin, sizeof grid->origin);
    else
        coordinates_origin(grid);
    return grid->kind == GRID_RECTILINEAR ? axes_take(grid) : points_take(grid);
}
