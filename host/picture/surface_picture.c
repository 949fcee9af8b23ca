/* surface_picture.c - the stages: bounds, fit, normals, which triangle each sample shows, colours */
#include "surface_picture.h"

#include "exit_status.h"
#include "failure.h"
#include "parallel.h"
#include "surface_scene.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#define MARGIN 0.04 /* of the picture's shorter side, on each side */

static int set_parts(scene *s, const mesh_part *parts, int count) {
    const mesh_part whole = {s->mesh->vertex_count, s->mesh->triangle_count, {0, 0, 0}};
    const mesh_part *from = count ? parts : &whole;
    uint64_t vertices = 0, triangles = 0;
    s->part_count = count ? count : 1;
    s->parts = calloc((size_t)s->part_count, sizeof *s->parts);
    if (!s->parts) return fail(STATUS_FAILED, "out of memory for the parts of the surface");
    for (int n = 0; n < s->part_count; n++) {
        double move[3];
        for (int axis = 0; axis < 3; axis++) move[axis] = from[n].origin[axis] - from[0].origin[axis];
        for (int row = 0; row < 3; row++)
            s->parts[n].offset[row] = s->rows[row][0] * move[0] + s->rows[row][1] * move[1] + s->rows[row][2] * move[2];
        s->parts[n].vertex_end = vertices += from[n].vertex_count;
        s->parts[n].triangle_end = triangles += from[n].triangle_count;
    }
    return 0;
}

/* ---------------------------------------------------------------------------------------------------------- bounds */

typedef struct bounds_job {
    scene *s;
    _Atomic uint64_t next;
    pthread_mutex_t lock; /* of the scene's bounds */
} bounds_job;

static void bounds_clear(double bounds[2][3]) {
    for (int axis = 0; axis < 3; axis++) {
        bounds[0][axis] = INFINITY;
        bounds[1][axis] = -INFINITY;
    }
}

static void bounds_add(double bounds[2][3], const double low[3], const double high[3]) {
    for (int axis = 0; axis < 3; axis++) {
        if (low[axis] < bounds[0][axis]) bounds[0][axis] = low[axis];
        if (high[axis] > bounds[1][axis]) bounds[1][axis] = high[axis];
    }
}

static void find_bounds(void *shared) {
    bounds_job *j = shared;
    const scene *s = j->s;
    double own[2][3];
    uint64_t begin;
    bounds_clear(own);
    while ((begin = atomic_fetch_add(&j->next, SHARE_VERTICES)) < s->mesh->vertex_count) {
        const uint64_t left = s->mesh->vertex_count - begin,
                       end = begin + (left < SHARE_VERTICES ? left : SHARE_VERTICES);
        const scene_part *part = s->parts;
        for (uint64_t v = begin; v < end; v++) {
            double position[3];
            while (v >= part->vertex_end) part++;
            if (scene_position(s, part, v, position)) bounds_add(own, position, position);
        }
    }
    pthread_mutex_lock(&j->lock);
    bounds_add(j->s->bounds, own[0], own[1]);
    pthread_mutex_unlock(&j->lock);
}

/* The scale with which the bounds fit, whichever side of the picture they meet first. */
static void fit(scene *s) {
    const double shorter = (double)(s->width < s->height ? s->width : s->height), margin = 2 * MARGIN * shorter;
    const double x = (s->bounds[1][0] - s->bounds[0][0]) / ((double)s->width - margin);
    const double y = (s->bounds[1][1] - s->bounds[0][1]) / ((double)s->height - margin);
    const double units = x > y ? x : y, depth = s->bounds[1][2] - s->bounds[0][2];
    s->scale = units > 0 ? 1 / units : 1;
    s->depth_scale = depth > 0 ? (double)(((uint64_t)1 << DEPTH_BITS) - 2) / depth : 0;
}

/* ------------------------------------------------------------------------------------------------------------- all */

static int begin(scene *s, const mesh_part *parts, int part_count, view_angles angles) {
    const view_axes axes = view_axes_of(angles);
    memcpy(s->rows[0], axes.right, sizeof axes.right);
    memcpy(s->rows[1], axes.up, sizeof axes.up);
    memcpy(s->rows[2], axes.toward, sizeof axes.toward);
    bounds_clear(s->bounds);
    int status = set_parts(s, parts, part_count);
    if (status) return status;
    bounds_job j = {.s = s, .lock = PTHREAD_MUTEX_INITIALIZER};
    parallel_run(s->mesh->vertex_count / SHARE_VERTICES + 1, find_bounds, &j);
    return 0;
}

static int make_keys(scene *s) {
    const size_t count = (size_t)s->width * (size_t)s->height;
    s->keys = malloc(count * sizeof *s->keys);
    if (!s->keys)
        return fail(STATUS_FAILED, "out of memory for a picture of %lld x %lld pixels: make it smaller",
                    (long long)s->width / SAMPLES, (long long)s->height / SAMPLES);
    memset((void *)s->keys, 255, count * sizeof *s->keys);
    return 0;
}

int surface_picture(const tc_mesh_data *mesh, const mesh_part *parts, int part_count, view_angles angles, picture *p) {
    scene s = {.mesh = mesh, .width = (int64_t)SAMPLES * p->width, .height = (int64_t)SAMPLES * p->height};
    int status = begin(&s, parts, part_count, angles);
    if (status || s.bounds[0][0] > s.bounds[1][0]) goto cleanup;
    fit(&s);
    if ((status = surface_normals(&s))) goto cleanup;
    if ((status = make_keys(&s))) goto cleanup;
    surface_draw(&s);
    surface_shade(&s, p);
cleanup:
    free((void *)s.keys);
    free(s.made_normals);
    free(s.parts);
    return status;
}
