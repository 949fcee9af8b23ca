/*
 * test_far.c - grids far from zero keep their shape
 *
 * The same grid lies once near zero and once far from it, moved by numbers that double precision adds exactly. Both
 * engines must make the same bytes; every vertex must lie where its edge says, relative to the origin (mesh_walk.h, in
 * long double); indices must be the same; area and volume must agree to 1e-6. Fill values at points that nothing uses
 * may not hide where the grid lies. Grids near zero must keep the origin 0, 0, 0, and double coordinates that are
 * floats must give the bytes of these floats. Parts that name their whole must have its triangles, to the bit.
 */
#include "complex.h"
#include "engines.h"
#include "mesh_walk.h"
#include "random.h"

#include <math.h>

enum { NX = 21, NY = 19, NZ = 17, POINTS = NX * NY * NZ };

enum kind { UNIFORM, ROTATED, INDEXED, RECTILINEAR, CURVILINEAR, COMPLEX, KINDS };

static const char *const kind_names[KINDS] = {"uniform",     "rotated",     "uniform with a far first index",
                                              "rectilinear", "curvilinear", "complex"};
static const double far_place[3] = {500000, 4649776, -1048576};

static tc_context *reference, *device; /* device: NULL where there is none */

/* A grid of one kind in memory of its own. */
typedef struct subject {
    enum kind kind;
    tc_grid_options grid;
    tc_extract_options how;
    float samples[POINTS];
    double points[3 * POINTS], axes[3][NX];
    uint8_t is_out[POINTS], blanked_cells[POINTS];
    tc_tetrahedra complex;
} subject;

typedef struct surface {
    tc_mesh *mesh;
    tc_mesh_data data;
    double area, volume;
} surface;

static const int64_t dims[3] = {NX, NY, NZ};

static void samples_fill(subject *s) {
    for (int n = 0; n < POINTS; n++) {
        const double x = n % NX - 10, y = n / NX % NY - 9, z = n / NX / NY - 8;
        s->samples[n] = (float)(8 - sqrt(x * x + y * y + z * z) + 0.4 * sin(2 * x + y));
    }
}

/* Coordinates are multiples of 2^-10, so that adding the far place is exact. */
static double place_of(int n, int axis) {
    const double x = n % NX, y = n / NX % NY, z = n / NX / NY;
    const double q[3] = {0.25 * x + 0.03 * sin(y), 0.25 * y + 0.02 * z, 0.5 * z + 0.01 * x};
    return round(q[axis] * 1024) / 1024;
}

static void subject_make(subject *s, enum kind kind, const double at[3]) {
    *s = (subject){.kind = kind, .complex = {.struct_size = sizeof s->complex}};
    tc_grid_options_init(&s->grid);
    tc_extract_options_init(&s->how);
    memcpy(s->grid.dims, dims, sizeof dims);
    s->grid.type = TC_F32;
    s->grid.samples = s->samples;
    s->how.normals = kind != COMPLEX;
    s->how.isovalue = 1.125;
    samples_fill(s);
    for (int row = 0; row < 3; row++) {
        s->grid.matrix[row][row] = 0.25;
        s->grid.matrix[row][3] = at[row];
    }
    if (kind == ROTATED) s->grid.matrix[0][1] = -0.125, s->grid.matrix[1][0] = 0.125;
    for (int n = 0; n < POINTS; n++)
        for (int axis = 0; axis < 3; axis++) s->points[3 * n + axis] = at[axis] + place_of(n, axis);
    for (int axis = 0; axis < 3; axis++)
        for (int n = 0; n < dims[axis]; n++) s->axes[axis][n] = at[axis] + 0.25 * n + (n & 1) * 0.0625;
    for (int axis = 0; axis < 3 && kind == RECTILINEAR; axis++) s->grid.axes_f64[axis] = s->axes[axis];
    if (kind >= CURVILINEAR) s->grid.points_f64 = s->points;
}

static void subject_release(subject *s) { tc_tetrahedra_release(&s->complex); }

static tc_status grid_make(subject *s, tc_context *context, tc_grid **grid) {
    if (s->kind != COMPLEX) return tc_grid_create(context, &s->grid, grid);
    tc_tetrahedra_release(&s->complex);
    static const uint8_t zeros[POINTS]; /* so that tetrahedra without a sample are there, too */
    tc_grid_options whole = s->grid;
    whole.type = TC_U8, whole.samples = zeros;
    tc_status status = tc_tetrahedralize_grid(&whole, &s->complex);
    tc_tetrahedra_grid_options o;
    tc_tetrahedra_grid_options_init(&o);
    o.point_count = POINTS;
    o.points_f64 = s->points;
    o.type = TC_F32;
    o.samples = s->samples;
    o.tetrahedron_count = s->complex.tetrahedron_count;
    o.tetrahedra = s->complex.tetrahedra;
    o.has_origin = s->grid.has_origin;
    memcpy(o.origin, s->grid.origin, sizeof o.origin);
    return status ? status : tc_tetrahedra_grid_create(context, &o, grid);
}

/* Twice the area, and six times the volume of a cone to the origin. */
static void surface_measure(surface *s) {
    const tc_mesh_data *m = &s->data;
    for (uint64_t t = 0; t < m->triangle_count; t++) {
        double p[3][3], u[3], v[3], c[3];
        for (int k = 0; k < 3; k++)
            for (int axis = 0; axis < 3; axis++)
                p[k][axis] = (double)m->positions[3 * (uint64_t)m->triangles[3 * t + (uint64_t)k] + (uint64_t)axis];
        for (int axis = 0; axis < 3; axis++) u[axis] = p[1][axis] - p[0][axis], v[axis] = p[2][axis] - p[0][axis];
        for (int axis = 0; axis < 3; axis++)
            c[axis] = u[(axis + 1) % 3] * v[(axis + 2) % 3] - u[(axis + 2) % 3] * v[(axis + 1) % 3];
        s->area += sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
        s->volume += c[0] * p[0][0] + c[1] * p[0][1] + c[2] * p[0][2];
    }
}

static bool surface_extract(subject *s, tc_context *context, surface *out) {
    tc_grid *grid = NULL;
    double origin[3] = {NAN, NAN, NAN};
    *out = (surface){.data = {.struct_size = sizeof out->data}};
    tc_status status = grid_make(s, context, &grid);
    if (!status) status = tc_grid_origin(grid, origin);
    if (!status) status = tc_extract(grid, &s->how, &out->mesh);
    if (!status) status = tc_mesh_get(out->mesh, &out->data);
    EXPECT(!status, "%s: %s", kind_names[s->kind], tc_message());
    EXPECT(status || !memcmp(origin, out->data.origin, sizeof origin), "%s: two origins", kind_names[s->kind]);
    if (!status) surface_measure(out);
    tc_grid_destroy(grid);
    return !status;
}

static bool moved(const surface *s) {
    const double *o = s->data.origin;
    return o[0] != 0 || o[1] != 0 || o[2] != 0;
}

static void expect_same_shape(const char *name, const surface *far, const surface *near) {
    const tc_mesh_data *a = &far->data, *b = &near->data;
    EXPECT(a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count && a->triangle_count > 500,
           "%s: %llu triangles far, %llu near", name, (unsigned long long)a->triangle_count,
           (unsigned long long)b->triangle_count);
    if (a->triangle_count != b->triangle_count) return;
    EXPECT(!memcmp(a->triangles, b->triangles, 12 * (size_t)a->triangle_count), "%s: other triangles", name);
    for (uint64_t n = 0; n < 3 * a->vertex_count; n++)
        if (a->origin[n % 3] != 0 && fabsf(a->positions[n]) > 16) {
            EXPECT(false, "%s: a coordinate of %g from the origin", name, (double)a->positions[n]);
            break;
        }
    EXPECT(fabs(far->area - near->area) <= 1e-6 * near->area, "%s: area %.9g far, %.9g near", name, far->area / 2,
           near->area / 2);
    EXPECT(fabs(far->volume - near->volume) <= 1e-6 * fabs(near->volume), "%s: volume %.9g far, %.9g near", name,
           far->volume / 6, near->volume / 6);
}

/* Far and near, on one engine; what is far is handed out. */
static void compare_places(enum kind kind, tc_context *context, surface *far) {
    static subject here, there;
    surface near;
    subject_make(&here, kind, (double[3]){0, 0, 0});
    subject_make(&there, kind, far_place);
    static const int64_t far_first[3] = {12000000, INT32_MIN, INT32_MAX - 31}; /* even: cubes keep their parity */
    for (int axis = 0; axis < 3 && kind == INDEXED; axis++) {
        there.grid.first_index[axis] = far_first[axis];
        there.grid.matrix[axis][3] = -0.25 * (double)far_first[axis];
    }
    if (kind == RECTILINEAR || kind == CURVILINEAR) { /* of these the first index tells the parity alone */
        here.grid.first_index[0] = here.grid.first_index[1] = 1;
        there.grid.first_index[0] = INT32_MAX - NX + 1;
        there.grid.first_index[1] = INT32_MIN + 1;
        there.grid.first_index[2] = INT32_MIN;
    }
    if (surface_extract(&here, context, &near) && surface_extract(&there, context, far)) {
        EXPECT(!moved(&near), "%s: moved though near zero", kind_names[kind]);
        EXPECT(moved(far) == (kind != INDEXED), "%s: origin %g, %g, %g", kind_names[kind], far->data.origin[0],
               far->data.origin[1], far->data.origin[2]);
        const char *fault = kind == COMPLEX ? NULL : mesh_fault(&there.grid, there.how.isovalue, &far->data);
        EXPECT(!fault, "%s: %s", kind_names[kind], fault);
        expect_same_shape(kind_names[kind], far, &near);
    }
    tc_mesh_destroy(near.mesh);
    subject_release(&here);
    subject_release(&there);
}

static void test_places(void) {
    for (enum kind kind = 0; kind < KINDS; kind++) {
        surface scalar, parallel;
        compare_places(kind, reference, &scalar);
        if (device) {
            compare_places(kind, device, &parallel);
            const char *difference = mesh_difference(&scalar.data, &parallel.data);
            EXPECT(!difference, "%s: %s", kind_names[kind], difference);
            tc_mesh_destroy(parallel.mesh);
        }
        tc_mesh_destroy(scalar.mesh);
    }
}

/* Why points are not used. */
enum reason { BLANKED_SAMPLES, BLANKED_CELLS, NO_VALUE, REASONS };

/* Leaves two layers of points out. */
static void points_leave_out(subject *s, enum reason reason) {
    int64_t cell = 0;
    for (int n = 0; n < POINTS; n++) {
        const int x = n % NX, y = n / NX % NY, z = n / NX / NY;
        s->is_out[n] = x == 3 || z == 11;
        if (s->is_out[n] && reason == NO_VALUE) s->samples[n] = NAN;
        if (x + 1 < NX && y + 1 < NY && z + 1 < NZ) s->blanked_cells[cell++] = x == 2 || x == 3 || z == 10 || z == 11;
    }
    if (reason == BLANKED_SAMPLES) s->grid.blanked_samples = s->is_out;
    if (reason == BLANKED_CELLS) s->grid.blanked_cells = s->blanked_cells;
    if (reason == BLANKED_CELLS) s->how.normals = 0; /* differences still see these points */
}

/* Points that no present cell uses: zero, a fill value, nothing at all. */
static void test_fill_values(void) {
    static const double fills[] = {0, -9999, 1e30, NAN, INFINITY};
    static subject there, filled;
    for (int n = 0; n < 2 * REASONS * 5; n++) {
        const enum kind kind = n & 1 ? COMPLEX : CURVILINEAR;
        const double fill = fills[n / 2 % 5];
        const enum reason reason = (enum reason)(n / 10);
        surface a, b;
        if (reason != BLANKED_SAMPLES && kind == COMPLEX && !(fabs(fill) < 1e6)) continue; /* these turn cells over */
        if (reason == BLANKED_CELLS && !isfinite(fill)) continue; /* refused: the points are there */
        subject_make(&there, kind, far_place);
        points_leave_out(&there, reason);
        filled = there;
        filled.grid.samples = filled.samples, filled.grid.points_f64 = filled.points;
        for (int p = 0; p < POINTS; p++)
            for (int axis = 0; axis < 3 && there.is_out[p]; axis++) filled.points[3 * p + axis] = fill;
        if (surface_extract(&there, reference, &a) && surface_extract(&filled, reference, &b)) {
            const char *difference = mesh_difference(&a.data, &b.data);
            EXPECT(moved(&b) && !memcmp(a.data.origin, b.data.origin, sizeof a.data.origin),
                   "%s, unused points at %g: origin %g, %g, %g", kind_names[kind], fill, b.data.origin[0],
                   b.data.origin[1], b.data.origin[2]);
            EXPECT(!difference, "%s, unused points at %g: %s", kind_names[kind], fill, difference);
        }
        tc_mesh_destroy(a.mesh);
        tc_mesh_destroy(b.mesh);
        subject_release(&there);
        subject_release(&filled);
    }
}

/* Doubles that are floats give the bytes of the floats; so does an origin of 0, 0, 0 that the caller gives. */
static void test_near(void) {
    static subject s;
    static float points[3 * POINTS], axes[3][NX];
    for (enum kind kind = RECTILINEAR; kind <= CURVILINEAR; kind++) {
        surface as_doubles, as_floats, given;
        subject_make(&s, kind, (double[3]){3, -2, 40});
        for (int n = 0; n < 3 * POINTS; n++) points[n] = (float)s.points[n];
        for (int axis = 0; axis < 3; axis++)
            for (int n = 0; n < dims[axis]; n++) axes[axis][n] = (float)s.axes[axis][n];
        surface_extract(&s, reference, &as_doubles);
        s.grid.has_origin = 1;
        surface_extract(&s, reference, &given);
        s.grid.has_origin = 0, s.grid.points_f64 = NULL;
        if (kind == CURVILINEAR) s.grid.points = points;
        for (int axis = 0; axis < 3 && kind == RECTILINEAR; axis++)
            s.grid.axes_f64[axis] = NULL, s.grid.axes[axis] = axes[axis];
        surface_extract(&s, reference, &as_floats);
        EXPECT(!moved(&as_doubles) && !moved(&as_floats), "%s: moved though near zero", kind_names[kind]);
        const char *difference = mesh_difference(&as_doubles.data, &as_floats.data);
        if (!difference) difference = mesh_difference(&as_doubles.data, &given.data);
        EXPECT(!difference, "%s, doubles or floats: %s", kind_names[kind], difference);
        tc_mesh_destroy(as_doubles.mesh), tc_mesh_destroy(as_floats.mesh), tc_mesh_destroy(given.mesh);
        subject_release(&s);
    }
}

/* An origin of the caller's is taken as it is, and positions are relative to it. */
static void test_given_origin(void) {
    static subject s;
    for (enum kind kind = 0; kind < KINDS; kind++) {
        surface own, given;
        subject_make(&s, kind, far_place);
        surface_extract(&s, reference, &own);
        s.grid.has_origin = 1;
        for (int axis = 0; axis < 3; axis++) s.grid.origin[axis] = far_place[axis] + 2;
        surface_extract(&s, reference, &given);
        EXPECT(!memcmp(given.data.origin, s.grid.origin, sizeof s.grid.origin), "%s: another origin", kind_names[kind]);
        for (uint64_t n = 0; n < 3 * own.data.vertex_count; n++) {
            const double a = own.data.origin[n % 3] + (double)own.data.positions[n];
            const double b = given.data.origin[n % 3] + (double)given.data.positions[n];
            EXPECT(fabs(a - b) < 1e-5, "%s: coordinate %llu at %.9g and at %.9g", kind_names[kind],
                   (unsigned long long)n, a, b);
            if (fabs(a - b) >= 1e-5) break;
        }
        tc_mesh_destroy(own.mesh);
        tc_mesh_destroy(given.mesh);
        subject_release(&s);
    }
}

/* Where the rule draws the line: 512 cells and 8 sizes from zero, each axis for itself. */
static void test_rule(void) {
    static const struct {
        double at, spacing;
        bool is_moved;
    } cases[] = {{0, 1, false},    {400, 1, false}, {490, 1, false},     {540, 1, true},        {-540, 1, true},
                 {49, 0.1, false}, {54, 0.1, true}, {4.6e6, 0.25, true}, {4.6e6, 30000, false}, {4.6e6, 8000, true}};
    static subject s;
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++)
        for (int axis = 0; axis < 3; axis++) {
            surface made;
            subject_make(&s, UNIFORM, (double[3]){0, 0, 0});
            for (int row = 0; row < 3; row++) s.grid.matrix[row][row] = cases[n].spacing;
            s.grid.matrix[axis][3] = cases[n].at;
            surface_extract(&s, reference, &made);
            for (int row = 0; row < 3; row++)
                EXPECT((made.data.origin[row] != 0) == (row == axis && cases[n].is_moved),
                       "at %g along axis %d with cells of %g: the origin of axis %d is %g", cases[n].at, axis,
                       cases[n].spacing, row, made.data.origin[row]);
            tc_mesh_destroy(made.mesh);
        }
}

/* A long grid: its own size decides. */
static void test_long_grid(void) {
    static const struct {
        double at;
        bool is_moved;
    } cases[] = {{1300, false}, {1500, true}, {-1500, false}, {-1700, true}};
    static subject s;
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        tc_grid *grid = NULL;
        double origin[3] = {NAN, NAN, NAN};
        subject_make(&s, UNIFORM, (double[3]){0, 0, 0});
        s.grid.dims[0] = 200, s.grid.dims[1] = s.grid.dims[2] = 5;
        for (int row = 0; row < 3; row++) s.grid.matrix[row][row] = 1;
        s.grid.matrix[0][3] = cases[n].at;
        tc_status status = tc_grid_create(reference, &s.grid, &grid);
        if (!status) status = tc_grid_origin(grid, origin);
        EXPECT(!status && (origin[0] != 0) == cases[n].is_moved, "200 cells at %g: origin %g", cases[n].at, origin[0]);
        tc_grid_destroy(grid);
    }
}

/* Neither the size nor the place of a long grid decides where its indices leave those of float32. */
static void test_long_far_grid(void) {
    enum { LONG = 1 << 22, AT = LONG - 4 };
    uint8_t *samples = calloc(4, LONG);
    for (int n = 0; n < 4 * LONG; n++) samples[n] = n % LONG > AT ? 255 : 0;
    for (int n = 0; n < 4; n++) {
        static const int64_t firsts[4] = {(1 << 24) + 2, -(1 << 25), -LONG - (1 << 24), 1 << 26};
        surface s;
        subject made = {.kind = UNIFORM};
        tc_grid_options_init(&made.grid);
        tc_extract_options_init(&made.how);
        made.how.isovalue = 127.5;
        made.grid.type = TC_U8;
        made.grid.samples = samples;
        made.grid.dims[0] = LONG, made.grid.dims[1] = made.grid.dims[2] = 2;
        made.grid.first_index[0] = firsts[n];
        made.grid.matrix[0][3] = -(double)firsts[n];
        surface_extract(&made, reference, &s);
        EXPECT(s.data.vertex_count == 8, "from %lld on: %llu vertices", (long long)firsts[n],
               (unsigned long long)s.data.vertex_count);
        for (uint64_t v = 0; v < s.data.vertex_count; v++)
            EXPECT(s.data.origin[0] + (double)s.data.positions[3 * v] == AT + 0.5, "from %lld on: a vertex at %.9g",
                   (long long)firsts[n], s.data.origin[0] + (double)s.data.positions[3 * v]);
        tc_mesh_destroy(s.mesh);
    }
    free(samples);
}

/* ----------------------------------------------------------------------------------------------------------- parts */

enum { WIDE = 6, LONG_PLANES = 1500, LONG_POINTS = WIDE * WIDE * LONG_PLANES };

typedef struct triangle {
    float at[9];
} triangle;

static int triangle_compare(const void *a, const void *b) { return memcmp(a, b, sizeof(triangle)); }

/* Adds the mesh's triangles, each from its least vertex on. */
static void triangles_add(const tc_mesh_data *m, triangle *all, size_t *count) {
    for (uint64_t t = 0; t < m->triangle_count; t++, ++*count) {
        float p[3][3];
        int first = 0;
        for (int k = 0; k < 3; k++)
            memcpy(p[k], m->positions + 3 * (uint64_t)m->triangles[3 * t + (uint64_t)k], sizeof p[k]);
        for (int k = 1; k < 3; k++)
            if (memcmp(p[k], p[first], sizeof p[k]) < 0) first = k;
        for (int k = 0; k < 3; k++) memcpy(all[*count].at + 3 * k, p[(first + k) % 3], sizeof p[k]);
    }
    qsort(all, *count, sizeof *all, triangle_compare);
}

/* Extracts planes first to last of a long grid along z, as a part of it or as a grid by itself. */
static void part_add(const tc_grid_options *whole, tc_context *context, int64_t first, int64_t last, bool is_part,
                     triangle *all, size_t *count) {
    const int64_t plane = WIDE * WIDE;
    static subject s;
    surface made;
    s.kind = whole->points_f64 ? CURVILINEAR : whole->axes_f64[0] ? RECTILINEAR : UNIFORM;
    s.grid = *whole;
    s.grid.dims[2] = last - first + 1;
    s.grid.first_index[2] += first;
    s.grid.samples = (const float *)whole->samples + first * plane;
    if (s.grid.points_f64) s.grid.points_f64 += 3 * first * plane;
    if (s.grid.axes_f64[2]) s.grid.axes_f64[2] += first;
    s.grid.whole = is_part ? whole : NULL;
    tc_extract_options_init(&s.how);
    s.how.isovalue = 0.1;
    if (!surface_extract(&s, context, &made)) return;
    triangles_add(&made.data, all, count);
    tc_mesh_destroy(made.mesh);
}

/* Parts that share a plane have the triangles of the whole, to the bit, also one that lies far from 0 by itself: as
 * grids of their own they do not, so that this is a test. */
static void test_parts(tc_context *context) {
    static float samples[LONG_POINTS];
    static double points[3 * LONG_POINTS], axes[3][LONG_PLANES];
    const int64_t ends[] = {0, 701, 722, LONG_PLANES - 1};
    triangle *all[3];
    for (int n = 0; n < 3; n++) all[n] = calloc(20 * LONG_POINTS, sizeof **all);
    for (int n = 0; n < LONG_POINTS; n++) {
        const double x = n % WIDE, y = n / WIDE % WIDE, z = n / WIDE / WIDE;
        samples[n] = (float)(sin(0.7 * x + 0.31 * z) + cos(0.9 * y - 0.23 * z));
        points[3 * n] = x + 0.1 * sin(y), points[3 * n + 1] = y, points[3 * n + 2] = 0.7 * z + 0.05 * x;
    }
    for (int n = 0; n < LONG_PLANES; n++) axes[0][n] = n, axes[1][n] = 0.3 * n, axes[2][n] = 0.7 * n;
    for (int kind = UNIFORM; kind <= CURVILINEAR; kind++)
        for (int64_t shift = 0; shift < 2; shift++) {
            size_t counts[3] = {0};
            tc_grid_options whole;
            tc_grid_options_init(&whole);
            whole.dims[0] = whole.dims[1] = WIDE, whole.dims[2] = LONG_PLANES;
            whole.type = TC_F32, whole.samples = samples;
            whole.matrix[2][2] = 0.7;
            if (kind == ROTATED) whole.matrix[0][2] = 0.4, whole.matrix[2][0] = -0.6;
            if (kind == INDEXED) whole.first_index[0] = 3, whole.first_index[2] = shift ? 1 << 30 : -80001;
            if (kind == CURVILINEAR) whole.points_f64 = points;
            for (int axis = 0; axis < 3 && kind == RECTILINEAR; axis++) whole.axes_f64[axis] = axes[axis];
            if (kind != INDEXED) whole.first_index[0] = shift, whole.matrix[2][3] = 1e6 * (double)shift;
            part_add(&whole, context, 0, LONG_PLANES - 1, false, all[0], &counts[0]);
            for (int n = 0; n < 3; n++) {
                part_add(&whole, context, ends[n], ends[n + 1], true, all[1], &counts[1]);
                part_add(&whole, context, ends[n], ends[n + 1], false, all[2], &counts[2]);
            }
            EXPECT(counts[0] > 1000 && counts[1] == counts[0] && counts[2] == counts[0],
                   "%s: %zu triangles, in parts %zu", kind_names[kind], counts[0], counts[1]);
            EXPECT(!memcmp(all[0], all[1], counts[0] * sizeof **all), "%s: parts differ from the whole",
                   kind_names[kind]);
            EXPECT(memcmp(all[0], all[2], counts[0] * sizeof **all), "%s: parts by themselves do not differ",
                   kind_names[kind]);
        }
    for (int n = 0; n < 3; n++) free(all[n]);
}

static void test_no_parts(void) {
    static subject s, other;
    tc_grid *grid = NULL;
    subject_make(&s, UNIFORM, far_place);
    subject_make(&other, RECTILINEAR, far_place);
    s.grid.whole = &other.grid;
    EXPECT_REFUSED(tc_grid_create(reference, &s.grid, &grid), TC_ERROR_ARGUMENT, "a whole of another kind");
    other.grid = s.grid;
    s.grid.whole = &other.grid, other.grid.samples = NULL;
    EXPECT(tc_grid_create(reference, &s.grid, &grid) == TC_OK, "a whole without samples: %s", tc_message());
    tc_grid_destroy(grid);
    for (int end = 0; end < 2; end++) {
        other.grid.first_index[1] += end ? -2 : 1;
        EXPECT_REFUSED(tc_grid_create(reference, &s.grid, &grid), TC_ERROR_ARGUMENT, "a part that lies outside");
    }
    other.grid.struct_size = 0;
    EXPECT_REFUSED(tc_grid_create(reference, &s.grid, &grid), TC_ERROR_ARGUMENT, "a whole that is not initialised");
}

static void test_refusals(void) {
    static subject s;
    tc_grid *grid = NULL;
    subject_make(&s, CURVILINEAR, far_place);
    s.points[3 * 100 + 1] = NAN;
    EXPECT_REFUSED(tc_grid_create(reference, &s.grid, &grid), TC_ERROR_DATA, "a point that is NaN");
    s.points[3 * 100 + 1] = 1e200;
    EXPECT_REFUSED(tc_grid_create(reference, &s.grid, &grid), TC_ERROR_DATA, "a point at 1e200");
    EXPECT(strstr(tc_message(), "1e+200") != NULL, "the message does not say where: %s", tc_message());
    s.grid.points = (const float *)s.samples;
    EXPECT_REFUSED(tc_grid_create(reference, &s.grid, &grid), TC_ERROR_ARGUMENT, "points twice");
    s.grid.points = NULL, s.grid.has_origin = 1, s.grid.origin[1] = INFINITY;
    EXPECT_REFUSED(tc_grid_create(reference, &s.grid, &grid), TC_ERROR_ARGUMENT, "an infinite origin");
}

int main(void) {
    tc_context_options options;
    tc_context_options_init(&options);
    reference = reference_open();
    if (device_exists()) device = context_open(&options);
    test_places();
    test_fill_values();
    test_near();
    test_given_origin();
    test_rule();
    test_long_grid();
    test_long_far_grid();
    test_parts(reference);
    if (device) test_parts(device);
    test_no_parts();
    test_refusals();
    tc_context_destroy(device);
    tc_context_destroy(reference);
    return EXPECT_DONE();
}
