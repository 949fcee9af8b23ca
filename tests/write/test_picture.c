/*
 * test_picture.c - pictures show what geometry says: which triangle is in front, from which side, in which place
 *
 * Rays are cast here through single triangles, in floating point and without keys or steps. Samples closer to a side of
 * some triangle than that can tell are left out, and counted.
 */
#include "expect.h"
#include "random.h"
#include "slice_picture.h"
#include "surface_picture.h"

#include <math.h>
#include <sched.h>
#include <string.h>

enum { WIDTH = 120, HEIGHT = 90, SOUP = 60 };

static const double pi = 3.14159265358979323846;

typedef struct test_mesh {
    tc_mesh_data data;
    float positions[3 * 20000], normals[3 * 20000];
    uint32_t triangles[3 * 40000];
} test_mesh;

static void mesh_begin(test_mesh *m) {
    memset(&m->data, 0, sizeof m->data);
    m->data.positions = m->positions;
    m->data.triangles = m->triangles;
}

static uint32_t mesh_vertex(test_mesh *m, double x, double y, double z) {
    float *at = m->positions + 3 * m->data.vertex_count;
    at[0] = (float)x;
    at[1] = (float)y;
    at[2] = (float)z;
    return (uint32_t)m->data.vertex_count++;
}

static void mesh_triangle(test_mesh *m, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t *at = m->triangles + 3 * m->data.triangle_count++;
    at[0] = a;
    at[1] = b;
    at[2] = c;
}

static picture shown_parts(const test_mesh *m, const mesh_part *parts, int count, view_angles angles, int width,
                           int height) {
    picture p;
    EXPECT(!picture_make(&p, width, height), "no memory");
    EXPECT(!surface_picture(&m->data, parts, count, angles, &p), "not drawn");
    return p;
}

static picture shown(const test_mesh *m, view_angles angles, int width, int height) {
    return shown_parts(m, NULL, 0, angles, width, height);
}

static const unsigned char *pixel(const picture *p, int x, int y) {
    return p->pixels + 3 * ((size_t)y * (size_t)p->width + (size_t)x);
}

static int is_white(const unsigned char *at) { return at[0] == 255 && at[1] == 255 && at[2] == 255; }
static int is_outer(const unsigned char *at) { return at[2] > at[0]; }

static int is_same(const picture *a, const picture *b) {
    return a->width == b->width && a->height == b->height &&
           memcmp(a->pixels, b->pixels, (size_t)3 * (size_t)a->width * (size_t)a->height) == 0;
}

static double random_part(void) { return random_between(0, 1); }

/* ----------------------------------------------------------------------------------------------------------- views */

static int is_axis(const double v[3], double x, double y, double z) { return v[0] == x && v[1] == y && v[2] == z; }

static void test_named_views(void) {
    static const struct {
        const char *name;
        double right[3], up[3], toward[3];
    } expected[] = {
        {"front", {1, 0, 0}, {0, 0, 1}, {0, -1, 0}}, {"back", {-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
        {"left", {0, -1, 0}, {0, 0, 1}, {-1, 0, 0}}, {"right", {0, 1, 0}, {0, 0, 1}, {1, 0, 0}},
        {"top", {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},    {"bottom", {1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
    };
    int found = 0;
    for (int n = 0; view_name(n); n++)
        for (size_t e = 0; e < sizeof expected / sizeof *expected; e++) {
            if (strcmp(view_name(n), expected[e].name) != 0) continue;
            const view_axes axes = view_axes_of(view_named(n));
            const double *r = expected[e].right, *u = expected[e].up, *t = expected[e].toward;
            found++;
            EXPECT(is_axis(axes.right, r[0], r[1], r[2]) && is_axis(axes.up, u[0], u[1], u[2]) &&
                       is_axis(axes.toward, t[0], t[1], t[2]),
                   "%s: other axes", view_name(n));
        }
    EXPECT(found == 6, "%d views of six are known", found);
}

static double scalar(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void test_axes(void) {
    for (int n = 0; n < 200; n++) {
        const view_angles angles = {720 * random_part() - 360, 180 * random_part() - 90};
        const view_axes v = view_axes_of(n ? angles : view_named(0));
        const double cross[3] = {v.right[1] * v.up[2] - v.right[2] * v.up[1],
                                 v.right[2] * v.up[0] - v.right[0] * v.up[2],
                                 v.right[0] * v.up[1] - v.right[1] * v.up[0]};
        EXPECT(fabs(scalar(v.right, v.right) - 1) < 1e-8 && fabs(scalar(v.up, v.up) - 1) < 1e-8 &&
                   fabs(scalar(v.right, v.up)) < 1e-8 && fabs(scalar(cross, v.toward) - 1) < 1e-8,
               "%g, %g: no right-handed unit axes", angles.azimuth, angles.elevation);
        EXPECT(v.right[2] == 0 && v.up[2] >= 0, "%g, %g: z is not up", angles.azimuth, angles.elevation);
        EXPECT(!n || fabs(asin(v.toward[2]) * 180 / pi - angles.elevation) < 1e-4, "%g: another elevation",
               angles.elevation);
    }
    const view_axes iso = view_axes_of(view_named(0));
    EXPECT(fabs(fabs(iso.toward[0]) - fabs(iso.toward[2])) < 1e-8 && fabs(iso.toward[0] + iso.toward[1]) < 1e-8,
           "iso does not see the axes at one angle");
}

/* ------------------------------------------------------------------------------------------- rays through triangles */

typedef struct fit {
    view_axes axes;
    double middle[2], units; /* of a sample */
    int width, height;       /* samples */
} fit;

static void seen(const fit *f, const float *v, double out[3]) {
    const double p[3] = {v[0], v[1], v[2]};
    out[0] = scalar(f->axes.right, p);
    out[1] = scalar(f->axes.up, p);
    out[2] = scalar(f->axes.toward, p);
}

/* The definition in surface_picture.h: fitted, centred, a margin of 4% of the shorter side. */
static fit fit_of(const test_mesh *m, view_angles angles, int width, int height) {
    fit f = {.axes = view_axes_of(angles), .width = 2 * width, .height = 2 * height};
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    const double margin = 0.08 * fmin(f.width, f.height);
    for (uint64_t v = 0; v < m->data.vertex_count; v++) {
        double place[3];
        seen(&f, m->positions + 3 * v, place);
        for (int n = 0; n < 2; n++) {
            low[n] = fmin(low[n], place[n]);
            high[n] = fmax(high[n], place[n]);
        }
    }
    for (int n = 0; n < 2; n++) f.middle[n] = (low[n] + high[n]) / 2;
    f.units = fmax((high[0] - low[0]) / (f.width - margin), (high[1] - low[1]) / (f.height - margin));
    return f;
}

/* Whether the ray through the middle of a sample meets the triangle: 1, 0, or -1 too close to tell; and how near. */
static int meets(const fit *f, const test_mesh *m, uint64_t triangle, int x, int y, double *nearness) {
    const double at_x = f->middle[0] + (x + 0.5 - f->width / 2.0) * f->units;
    const double at_y = f->middle[1] - (y + 0.5 - f->height / 2.0) * f->units;
    double v[3][3], least = INFINITY;
    for (int n = 0; n < 3; n++) seen(f, m->positions + 3 * m->triangles[3 * triangle + (uint64_t)n], v[n]);
    const double a = v[1][0] - v[0][0], b = v[2][0] - v[0][0], c = v[1][1] - v[0][1], d = v[2][1] - v[0][1];
    const double turn = a * d - b * c, s = ((at_x - v[0][0]) * d - (at_y - v[0][1]) * b) / turn;
    const double t = ((at_y - v[0][1]) * a - (at_x - v[0][0]) * c) / turn, weights[3] = {1 - s - t, s, t};
    for (int n = 0; n < 3; n++) { /* distances from the sides, in samples */
        const double *p = v[(n + 1) % 3], *q = v[(n + 2) % 3];
        const double side = hypot(q[0] - p[0], q[1] - p[1]);
        least = fmin(least, weights[n] * fabs(turn) / side / f->units);
    }
    *nearness = weights[0] * v[0][2] + weights[1] * v[1][2] + weights[2] * v[2][2];
    return fabs(least) < 0.02 || !isfinite(least) ? -1 : least > 0;
}

/* The triangle in front at a sample; -1: none; -2: too close to tell. */
static int in_front(const fit *f, const test_mesh *m, int x, int y) {
    int front = -1;
    double nearest = -INFINITY;
    for (uint64_t t = 0; t < m->data.triangle_count; t++) {
        double nearness;
        const int meeting = meets(f, m, t, x, y, &nearness);
        if (meeting < 0) return -2;
        if (meeting && fabs(nearness - nearest) < 1e-3) return -2;
        if (!meeting || nearness < nearest) continue;
        nearest = nearness;
        front = (int)t;
    }
    return front;
}

/* Triangles that share no vertex: each has one colour, that of its picture alone with the same fit. */
static void make_soup(test_mesh *m) {
    mesh_begin(m);
    for (int t = 0; t < SOUP; t++) {
        double middle[3];
        uint32_t v[3];
        for (int axis = 0; axis < 3; axis++) middle[axis] = random_part();
        for (int n = 0; n < 3; n++)
            v[n] = mesh_vertex(m, middle[0] + 1.2 * random_part(), middle[1] + 1.2 * random_part(),
                               middle[2] + 1.2 * random_part());
        mesh_triangle(m, v[0], v[1], v[2]);
    }
}

static test_mesh alone; /* one triangle of another mesh, with its vertices */

static void find_colours(const test_mesh *m, view_angles angles, picture *colours) {
    for (int t = 0; t < SOUP; t++) {
        memcpy(&alone, m, sizeof alone);
        alone.data.positions = alone.positions;
        alone.data.triangles = alone.triangles;
        alone.data.triangle_count = 1;
        memcpy(alone.triangles, m->triangles + 3 * t, 3 * sizeof *alone.triangles);
        colours[t] = shown(&alone, angles, WIDTH, HEIGHT);
    }
}

/* Pixels whose four samples all show one triangle, or nothing. */
static void compare_soup(const test_mesh *m, view_angles angles) {
    static picture colours[SOUP];
    const fit f = fit_of(m, angles, WIDTH, HEIGHT);
    picture p = shown(m, angles, WIDTH, HEIGHT);
    int told = 0, hidden = 0;
    find_colours(m, angles, colours);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            int front = in_front(&f, m, 2 * x, 2 * y);
            for (int n = 1; n < 4; n++)
                if (in_front(&f, m, 2 * x + n % 2, 2 * y + n / 2) != front) front = -2;
            if (front == -2) continue;
            told++;
            const unsigned char white[3] = {255, 255, 255};
            const unsigned char *expected = front < 0 ? white : pixel(&colours[front], x, y);
            EXPECT(memcmp(pixel(&p, x, y), expected, 3) == 0, "%g, %g: pixel %d %d does not show triangle %d",
                   angles.azimuth, angles.elevation, x, y, front);
            for (int t = 0; t < SOUP; t++) hidden += front >= 0 && t != front && !is_white(pixel(&colours[t], x, y));
        }
    EXPECT(told > WIDTH * HEIGHT / 3 && hidden > told / 4, "only %d pixels told, %d hidden triangles", told, hidden);
    picture_release(&p);
    for (int t = 0; t < SOUP; t++) picture_release(&colours[t]);
}

static test_mesh soup, other;

static void test_front(void) {
    for (int n = 0; n < 6; n++) {
        make_soup(&soup);
        compare_soup(&soup, n ? (view_angles){360 * random_part(), 180 * random_part() - 90} : view_named(1));
    }
}

/* The order of triangles, and the number of threads, change nothing. */
static void test_order(void) {
    cpu_set_t all, one;
    make_soup(&soup);
    picture p = shown(&soup, VIEW_DEFAULT, WIDTH, HEIGHT);
    memcpy(&other, &soup, sizeof other);
    other.data.positions = other.positions;
    other.data.triangles = other.triangles;
    for (uint32_t n = 0; n < 3 * SOUP; n++) other.triangles[n] = soup.triangles[3 * (SOUP - 1 - n / 3) + n % 3];
    picture q = shown(&other, VIEW_DEFAULT, WIDTH, HEIGHT);
    EXPECT(is_same(&p, &q), "the order of triangles shows");
    picture_release(&q);
    CPU_ZERO(&one);
    sched_getaffinity(0, sizeof all, &all);
    CPU_SET((size_t)sched_getcpu(), &one);
    sched_setaffinity(0, sizeof one, &one);
    q = shown(&soup, VIEW_DEFAULT, WIDTH, HEIGHT);
    sched_setaffinity(0, sizeof all, &all);
    EXPECT(is_same(&p, &q), "the number of threads shows");
    picture_release(&q);
    picture_release(&p);
}

/* ---------------------------------------------------------------------------------------------------------- sphere */

enum { RINGS = 60, SPOKES = 120 };

/* Winds counter-clockwise seen from outside. */
static void make_sphere(test_mesh *m, double x, double y, double z, double radius) {
    mesh_begin(m);
    for (int ring = 0; ring <= RINGS; ring++)
        for (int spoke = 0; spoke < SPOKES; spoke++) {
            const double down = pi * ring / RINGS, round = 2 * pi * spoke / SPOKES;
            const double n[3] = {sin(down) * cos(round), sin(down) * sin(round), cos(down)};
            for (uint64_t axis = 0; axis < 3; axis++) m->normals[3 * m->data.vertex_count + axis] = (float)n[axis];
            mesh_vertex(m, x + radius * n[0], y + radius * n[1], z + radius * n[2]);
        }
    for (uint32_t ring = 0; ring < RINGS; ring++)
        for (uint32_t spoke = 0; spoke < SPOKES; spoke++) {
            const uint32_t a = ring * SPOKES + spoke, b = ring * SPOKES + (spoke + 1) % SPOKES;
            if (ring) mesh_triangle(m, a, a + SPOKES, b);
            if (ring + 1 < RINGS) mesh_triangle(m, b, a + SPOKES, b + SPOKES);
        }
}

/* A disc of the radius that the fit gives, without holes, outer side, and its light above on the left. */
static void test_sphere(void) {
    static test_mesh ball;
    make_sphere(&ball, 3, -2, 5, 2);
    picture p = shown(&ball, (view_angles){30, 20}, 200, 150);
    const double radius = 0.92 * 150 / 2;
    double brightest = 0;
    int covered = 0, bright_x = 0, bright_y = 0;
    for (int y = 0; y < 150; y++)
        for (int x = 0; x < 200; x++) {
            const double distance = hypot(x + 0.5 - 100, y + 0.5 - 75);
            const unsigned char *at = pixel(&p, x, y);
            const double bright = at[0] + at[1] + at[2];
            if (distance < radius - 1.2) EXPECT(is_outer(at), "a hole, or an inner side, at %d %d", x, y);
            if (distance > radius + 1) EXPECT(is_white(at), "beyond the disc, at %d %d", x, y);
            covered += !is_white(at);
            if (distance > radius - 2 || bright < brightest) continue;
            brightest = bright;
            bright_x = x;
            bright_y = y;
        }
    EXPECT(fabs(covered / (pi * radius * radius) - 1) < 0.03, "%d pixels for a disc of radius %g", covered, radius);
    EXPECT(fabs((bright_x - 100) / radius + 2 / 7.0) < 0.06 && fabs((75 - bright_y) / radius - 3 / 7.0) < 0.06,
           "brightest at %d %d", bright_x, bright_y);

    ball.data.normals = ball.normals; /* those that triangles give are as good */
    picture q = shown(&ball, (view_angles){30, 20}, 200, 150);
    int most = 0;
    for (int n = 0; n < 3 * 200 * 150; n++)
        most = abs(p.pixels[n] - q.pixels[n]) > most ? abs(p.pixels[n] - q.pixels[n]) : most;
    EXPECT(most > 0 && most <= 6, "normals of triangles and of the sphere differ by %d", most);
    for (uint64_t n = 0; n < 3 * ball.data.vertex_count; n++) ball.normals[n] = NAN; /* the triangles' own then */
    picture r = shown(&ball, (view_angles){30, 20}, 200, 150);
    EXPECT(is_outer(pixel(&r, 100, 75)) && !is_same(&r, &q), "normals that are no numbers");
    picture_release(&p);
    picture_release(&q);
    picture_release(&r);

    ball.data.normals = NULL; /* turned over: the inner side */
    for (uint64_t t = 0; t < ball.data.triangle_count; t++) {
        const uint32_t first = ball.triangles[3 * t];
        ball.triangles[3 * t] = ball.triangles[3 * t + 1];
        ball.triangles[3 * t + 1] = first;
    }
    p = shown(&ball, (view_angles){30, 20}, 200, 150);
    for (int y = 0; y < 150; y++)
        for (int x = 0; x < 200; x++)
            if (hypot(x + 0.5 - 100, y + 0.5 - 75) < radius - 2)
                EXPECT(!is_outer(pixel(&p, x, y)), "an outer side at %d %d", x, y);
    EXPECT(pixel(&p, bright_x, bright_y)[0] > 230 && pixel(&p, 140, 120)[0] < pixel(&p, bright_x, bright_y)[0] - 30,
           "the light is not where it is on an outer side");
    picture_release(&p);
}

/* The pixels of a sphere, as they were made on the first machine: FNV-1a. */
static void test_pixels(void) {
    static test_mesh ball;
    uint64_t hash = 0xcbf29ce484222325;
    make_sphere(&ball, 0, 0, 0, 1);
    picture p = shown(&ball, (view_angles){30, 20}, 200, 150);
    for (int n = 0; n < 3 * 200 * 150; n++) hash = (hash ^ p.pixels[n]) * 0x100000001b3;
    EXPECT(hash == 0xbba93bb0b3cefb3e, "pixels have the hash %#llx", (unsigned long long)hash);
    picture_release(&p);
}

/* A part of the mesh with an origin of its own, far from zero: the same positions, and so the same pixels. */
static void test_parts(void) {
    static test_mesh two;
    make_sphere(&two, 0, 0, 0, 1);
    const uint64_t vertices = two.data.vertex_count, triangles = two.data.triangle_count;
    for (uint64_t v = 0; v < vertices; v++) {
        const float *p = two.positions + 3 * v;
        for (int axis = 0; axis < 3; axis++)
            two.positions[3 * v + (uint64_t)axis] = ldexpf(roundf(ldexpf(p[axis], 12)), -12);
    }
    for (uint64_t v = 0; v < vertices; v++)
        mesh_vertex(&two, two.positions[3 * v] + 1.5, two.positions[3 * v + 1] - 0.5, two.positions[3 * v + 2]);
    for (uint64_t t = 0; t < triangles; t++)
        mesh_triangle(&two, two.triangles[3 * t] + (uint32_t)vertices, two.triangles[3 * t + 1] + (uint32_t)vertices,
                      two.triangles[3 * t + 2] + (uint32_t)vertices);
    picture p = shown(&two, VIEW_DEFAULT, WIDTH, HEIGHT);
    for (uint64_t v = vertices; v < 2 * vertices; v++) {
        two.positions[3 * v] -= 64;
        two.positions[3 * v + 2] += 8;
    }
    const mesh_part parts[] = {{vertices, triangles, {0x1p40, -0x1p41, 7}},
                               {vertices, triangles, {0x1p40 + 64, -0x1p41, 7 - 8}}};
    picture q = shown_parts(&two, parts, 2, VIEW_DEFAULT, WIDTH, HEIGHT);
    int differing = 0; /* offsets are turned before they are added: the last bit may round otherwise */
    for (int n = 0; n < WIDTH * HEIGHT; n++) differing += memcmp(p.pixels + 3 * n, q.pixels + 3 * n, 3) != 0;
    EXPECT(differing < WIDTH * HEIGHT / 200, "%d pixels of parts differ from those of one", differing);
    picture_release(&p);
    picture_release(&q);
}

/* A square cut into triangles: no pixel within it shows what is behind. */
static void test_no_gaps(void) {
    static test_mesh flat;
    enum { SIDE = 40 };
    mesh_begin(&flat);
    for (int y = 0; y <= SIDE; y++)
        for (int x = 0; x <= SIDE; x++) {
            const double is_inner = x && y && x < SIDE && y < SIDE;
            mesh_vertex(&flat, x + is_inner * (random_part() - 0.5), 0, y + is_inner * (random_part() - 0.5));
        }
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            const uint32_t a = y * (SIDE + 1) + x;
            mesh_triangle(&flat, a, a + 1, a + SIDE + 1);
            mesh_triangle(&flat, a + 1, a + SIDE + 2, a + SIDE + 1);
        }
    picture p = shown(&flat, view_named(1), 97, 97);
    const unsigned char *middle = pixel(&p, 48, 48);
    EXPECT(is_outer(middle), "the square is seen from behind");
    for (int y = 6; y < 91; y++)
        for (int x = 6; x < 91; x++) EXPECT(memcmp(pixel(&p, x, y), middle, 3) == 0, "a gap at %d %d", x, y);
    picture_release(&p);
}

static int white_count(const picture *p) {
    int count = 0;
    for (int n = 0; n < p->width * p->height; n++) count += is_white(p->pixels + 3 * n);
    return count;
}

static void test_odd_meshes(void) {
    static test_mesh odd;
    mesh_begin(&odd);
    picture p = shown(&odd, VIEW_DEFAULT, 32, 16);
    EXPECT(white_count(&p) == 32 * 16, "an empty mesh shows");
    picture_release(&p);

    mesh_triangle(&odd, mesh_vertex(&odd, 1, 1, 1), mesh_vertex(&odd, 1, 1, 1), mesh_vertex(&odd, 1, 1, 1));
    p = shown(&odd, VIEW_DEFAULT, 32, 16);
    EXPECT(white_count(&p) == 32 * 16, "a point shows");
    picture_release(&p);

    mesh_begin(&odd);
    for (int n = 0; n < 4; n++) mesh_vertex(&odd, n & 1, 0, n >> 1);
    mesh_vertex(&odd, NAN, 0, 0);
    mesh_vertex(&odd, 0, -1e30, INFINITY);
    mesh_triangle(&odd, 0, 1, 2);
    mesh_triangle(&odd, 1, 3, 4);
    mesh_triangle(&odd, 1, 3, 5);
    p = shown(&odd, view_named(1), 60, 60); /* the lower left half of a square; the other corners count for nothing */
    EXPECT(is_outer(pixel(&p, 20, 45)) && is_white(pixel(&p, 45, 20)), "corners that are not finite");
    picture_release(&p);
    p = shown(&odd, view_named(5), 60, 60);
    EXPECT(white_count(&p) == 60 * 60, "a plane shows from its edge");
    picture_release(&p);
    for (uint64_t n = 0; n < 12; n++) odd.positions[n] *= 3e38f;
    p = shown(&odd, view_named(1), 60, 60);
    EXPECT(is_outer(pixel(&p, 20, 45)) && is_white(pixel(&p, 45, 20)), "large coordinates");
    picture_release(&p);
}

/* ---------------------------------------------------------------------------------------------------------- slices */

enum { NX = 9, NY = 7, NZ = 5 };

/* Grey at the middle of a panel's pixel that shows this place. */
static void expect_grey(const picture *p, int x, int y, double value, const char *what) {
    const unsigned char *at = pixel(p, x, y);
    EXPECT(at[0] == at[1] && at[1] == at[2] && fabs(at[0] - value) < 2.5, "%s: %d %d is %d %d %d, not %g", what, x, y,
           at[0], at[1], at[2], value);
}

static void test_slices(void) {
    static float samples[NX * NY * NZ];
    static uint8_t blanked[NX * NY * NZ];
    double positions[3][NX];
    sliced_volume v = {
        .type = TC_F32, .samples = samples, .count = {NX, NY, NZ}, .stride = {1, NX, NX * NY}, .white = 8};
    for (int axis = 0; axis < 3; axis++) {
        for (int n = 0; n < NX; n++) positions[axis][n] = n;
        v.positions[axis] = positions[axis];
    }
    for (int n = 0; n < NX * NY * NZ; n++) samples[n] = (float)(n % NX);
    picture p;
    const double isovalue = 2.5;
    EXPECT(!picture_make(&p, 240, 200) && !slice_picture(&v, &isovalue, 1, &p), "not drawn");
    /* margins of 8; 8 + 6 across by 6 + 4 down at min(216 / 14, 176 / 10) = 15.43: 123, 93 and 62 pixels */
    const int left = (240 - 123 - 93 - 8) / 2, top = (200 - 93 - 62 - 8) / 2;
    expect_grey(&p, left + 100, top + 40, 255 * (100.5 / 123), "from above, x to the right");
    expect_grey(&p, left + 100, top + 93 + 8 + 30, 255 * (100.5 / 123), "from the front, x to the right");
    expect_grey(&p, left + 123 + 8 + 40, top + 93 + 8 + 30, 255 * 0.5, "from the right, the middle of x");
    const int line = left + (int)(2.5 / 8 * 123);
    EXPECT(pixel(&p, line, top + 40)[0] > 200 && pixel(&p, line, top + 40)[1] < 60, "no red line at 2.5");
    EXPECT(pixel(&p, line - 3, top + 40)[0] == pixel(&p, line - 3, top + 40)[1], "the line is wide");
    EXPECT(is_white(pixel(&p, 200, 40)) && is_white(pixel(&p, left - 1, top + 40)), "beyond the slices");
    picture_release(&p);

    for (int n = 0; n < NX * NY * NZ; n++) samples[n] = (float)(n / NX % NY);
    v.white = 6;
    EXPECT(!picture_make(&p, 240, 200) && !slice_picture(&v, NULL, 0, &p), "not drawn");
    expect_grey(&p, left + 40, top + 20, 255 * (1 - 20.5 / 93), "from above, y up");
    expect_grey(&p, left + 123 + 8 + 20, top + 93 + 8 + 30, 255 * (20.5 / 93), "from the right, y to the right");
    picture_release(&p);

    for (int n = 0; n < NX * NY * NZ; n++) samples[n] = (float)(n / (NX * NY));
    samples[NX * NY * 2 + NX * 3 + 2] = NAN;
    samples[NX * NY * 2 + NX * 3 + 6] = 77;
    blanked[NX * NY * 2 + NX * 1 + 4] = 1;
    v.white = 4;
    v.blanked = blanked;
    v.has_nodata = 1;
    v.nodata = 77;
    v.stride[2] = -NX * NY; /* z falls in memory */
    v.first = NX * NY * (NZ - 1);
    EXPECT(!picture_make(&p, 240, 200) && !slice_picture(&v, NULL, 0, &p), "not drawn");
    expect_grey(&p, left + 8, top + 93 + 8 + 10, 255 * (10.5 / 62), "z that falls");
    expect_grey(&p, left + 8, top + 8, 127.5, "the middle of z");
    for (int n = 0; n < 3; n++) {
        const int x = left + (int)((2 + 2 * n) / 8.0 * 123) + 3, y = top + 93 - (int)((n == 1 ? 1 : 3) / 6.0 * 93) - 3;
        EXPECT(pixel(&p, x, y)[0] == 250 && pixel(&p, x, y)[2] == 200, "missing sample %d is not shown", n);
    }
    picture_release(&p);
}

/* An axis with unequal steps; volumes of one plane; doubles as far apart as can be. */
static void test_odd_slices(void) {
    const double positions[3][3] = {{0, 1, 10}, {0, 5, 10}, {0, 0, 0}}, samples[9] = {0, 1, 1, 0, 1, 1, 0, 1, 1};
    const double wide[2] = {-1.5e308, 1.5e308};
    sliced_volume v = {.type = TC_F64, .samples = samples, .count = {3, 3, 1}, .stride = {1, 3, 9}, .white = 1};
    picture p;
    for (int axis = 0; axis < 3; axis++) v.positions[axis] = positions[axis];
    EXPECT(!picture_make(&p, 400, 200) && !slice_picture(&v, NULL, 0, &p), "not drawn");
    /* margins of 8; 10 + 10 across, 10 down, at 17.6 pixels: 176 each */
    const int left = (400 - 2 * 176 - 8) / 2, top = (200 - 176 - 1 - 8) / 2;
    expect_grey(&p, left + 8, top + 100, 255 * (8.5 / 17.6), "between unequal steps");
    expect_grey(&p, left + 30, top + 100, 255, "beyond them");
    picture_release(&p);
    v = (sliced_volume){
        .type = TC_F64, .samples = wide, .count = {2, 1, 1}, .stride = {1, 2, 2}, .black = wide[0], .white = wide[1]};
    for (int axis = 0; axis < 3; axis++) v.positions[axis] = positions[axis];
    EXPECT(!picture_make(&p, 400, 200) && !slice_picture(&v, NULL, 0, &p), "not drawn");
    expect_grey(&p, 200, (200 - 1 - 1 - 8) / 2, 255 * (193.5 / 376), "half-way between the least and the greatest");
    picture_release(&p);
}

int main(void) {
    test_named_views();
    test_axes();
    test_front();
    test_order();
    test_sphere();
    test_pixels();
    test_parts();
    test_no_gaps();
    test_odd_meshes();
    test_slices();
    test_odd_slices();
    return EXPECT_DONE();
}
