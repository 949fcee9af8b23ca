/*
 * surface_shade.c - the colour of every pixel, the mean of its samples
 *
 * One light behind the viewer, above on the left. It wraps around a little, so that no part that is seen is black; a
 * weak highlight shows how the surface is curved. The inner side of a surface is lit as the outer one is.
 */
#include "label_colour.h"
#include "parallel.h"
#include "surface_scene.h"

/* Of sRGB, 0 to 255, as all colours here. */
static const double outer_colour[3] = {158, 192, 230}, inner_colour[3] = {232, 194, 140};

static const double light[3] = {-2 / 7.0, 3 / 7.0, 6 / 7.0}; /* unit length */

#define CREASE    0.25 /* cosine: vertices whose normal is further from the triangle's own take that */
#define WRAP      0.30 /* of light behind the edge of the shadow */
#define AMBIENT   0.36
#define HIGHLIGHT 45.0

typedef struct shade_job {
    const scene *s;
    picture *p;
    _Atomic int next;
} shade_job;

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* To unit length; 0 where there is none. */
static int make_unit(double v[3]) {
    const double most = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (!(most > 0) || !isfinite(most)) return 0;
    for (int axis = 0; axis < 3; axis++) v[axis] /= most;
    const double length = sqrt(dot(v, v));
    for (int axis = 0; axis < 3; axis++) v[axis] /= length;
    return 1;
}

/* The triangle's own normal in the picture's space, counter-clockwise seen from its outer side. */
static void face_normal(const scene *s, const scene_part *part, uint64_t triangle, double out[3]) {
    double positions[3][3], a[3], b[3];
    for (int n = 0; n < 3; n++) scene_position(s, part, s->mesh->triangles[3 * triangle + (uint64_t)n], positions[n]);
    for (int axis = 0; axis < 3; axis++) {
        a[axis] = positions[1][axis] - positions[0][axis];
        b[axis] = positions[2][axis] - positions[0][axis];
    }
    for (int axis = 0; axis < 3; axis++) {
        const int y = (axis + 1) % 3, z = (axis + 2) % 3;
        out[axis] = a[y] * b[z] - a[z] * b[y];
    }
    if (make_unit(out)) return;
    out[0] = out[1] = 0;
    out[2] = 1;
}

/* The normal at a sample, between those of the corners. */
static void normal_at(const scene *s, const scene_part *part, uint64_t triangle, const double face[3], int64_t x,
                      int64_t y, double out[3]) {
    corner v[3] = {{0}};
    scene_corners(s, part, triangle, v);
    const int64_t at_x = x * STEPS + STEPS / 2, at_y = y * STEPS + STEPS / 2;
    out[0] = out[1] = out[2] = 0;
    for (int n = 0; n < 3; n++) {
        const corner *next = &v[(n + 1) % 3], *last = &v[(n + 2) % 3];
        const double weight =
            (double)corner_area(next, last, at_x, at_y) / (double)corner_area(&v[0], &v[1], v[2].x, v[2].y);
        double normal[3];
        scene_turn(s, s->normals + (size_t)3 * s->mesh->triangles[3 * triangle + (uint64_t)n], normal);
        const int is_smooth = make_unit(normal) && dot(normal, face) >= CREASE;
        for (int axis = 0; axis < 3; axis++) out[axis] += weight * (is_smooth ? normal[axis] : face[axis]);
    }
    if (make_unit(out)) return;
    for (int axis = 0; axis < 3; axis++) out[axis] = face[axis];
}

/* What is seen of a triangle between labels is the body behind it; from within a body at the border, its own wall. */
static void colour_of(const scene *s, uint64_t triangle, int is_outer, double out[3]) {
    const uint32_t *sides = s->mesh->boundary_labels ? s->mesh->boundary_labels + 2 * triangle : NULL;
    if (sides) {
        label_colour(is_outer || !sides[1] ? sides[0] : sides[1], out);
        for (int n = 0; n < 3; n++) out[n] *= 255;
        return;
    }
    for (int n = 0; n < 3; n++) out[n] = (is_outer ? outer_colour : inner_colour)[n];
}

/* Adds the colour of a sample that shows a triangle. */
static void add_lit(const scene *s, uint64_t triangle, int64_t x, int64_t y, double sum[3]) {
    const scene_part *part = scene_part_of_triangle(s, triangle);
    double face[3], normal[3], own[3];
    face_normal(s, part, triangle, face);
    normal_at(s, part, triangle, face, x, y, normal);
    const int is_outer = face[2] >= 0;
    const double towards = is_outer ? dot(normal, light) : -dot(normal, light);
    const double wrapped = (towards + WRAP) / (1 + WRAP), lit = wrapped > 0 ? wrapped < 1 ? wrapped : 1 : 0;
    double shine = towards > 0 ? towards * towards : 0;
    for (int n = 0; n < 4; n++) shine *= shine;
    colour_of(s, triangle, is_outer, own);
    for (int n = 0; n < 3; n++) {
        const double colour = own[n] * (AMBIENT + (1 - AMBIENT) * lit) + HIGHLIGHT * shine;
        sum[n] += colour < 255 ? colour : 255;
    }
}

static void shade_pixel(const scene *s, int64_t x, int64_t y, unsigned char out[3]) {
    double sum[3] = {0, 0, 0};
    for (int64_t row = SAMPLES * y; row < SAMPLES * (y + 1); row++)
        for (int64_t column = SAMPLES * x; column < SAMPLES * (x + 1); column++) {
            const uint64_t key = s->keys[row * s->width + column];
            if (key != KEY_NOTHING) add_lit(s, key & (UINT64_MAX >> DEPTH_BITS), column, row, sum);
            for (int n = 0; n < 3 && key == KEY_NOTHING; n++) sum[n] += 255;
        }
    for (int n = 0; n < 3; n++) out[n] = (unsigned char)(sum[n] / (SAMPLES * SAMPLES) + 0.5);
}

static void shade_rows(void *shared) {
    shade_job *j = shared;
    int y;
    while ((y = atomic_fetch_add(&j->next, 1)) < j->p->height)
        for (int x = 0; x < j->p->width; x++)
            shade_pixel(j->s, x, y, j->p->pixels + 3 * ((size_t)y * (size_t)j->p->width + (size_t)x));
}

void surface_shade(const scene *s, picture *p) {
    shade_job j = {.s = s, .p = p};
    parallel_run((uint64_t)p->height, shade_rows, &j);
}
