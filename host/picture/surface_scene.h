/*
 * surface_scene.h - a mesh in the space of a picture; for surface_picture.c and its stages
 *
 * A position in that space is x to the right, y up, z towards the viewer, in the mesh's units, relative to the origin
 * of the mesh's first part.
 */
#ifndef SURFACE_SCENE_H
#define SURFACE_SCENE_H

#include "surface_picture.h"

#include <math.h>
#include <stdatomic.h>

enum {
    SAMPLES = 2,     /* of a pixel, along either side */
    STEPS = 256,     /* of a sample: positions of corners are multiples of its STEPS-th part */
    DEPTH_BITS = 30, /* of a key; the rest is the triangle's number */
    SHARE_TRIANGLES = 1 << 15,
    SHARE_VERTICES = 1 << 16,
};

/* Consecutive vertices and triangles, up to before these, whose positions have one origin. */
typedef struct scene_part {
    uint64_t vertex_end, triangle_end;
    double offset[3]; /* of the origin, in the picture's space */
} scene_part;

typedef struct scene {
    const tc_mesh_data *mesh;
    scene_part *parts; /* from malloc */
    int part_count;
    double rows[3][3];    /* right, up, toward */
    double bounds[2][3];  /* of the finite vertices, in the picture's space; the first above the second: none */
    const float *normals; /* of vertices, in world space */
    float *made_normals;  /* the same where the mesh has none; from malloc */

    int64_t width, height;  /* samples */
    double scale;           /* samples per unit */
    double depth_scale;     /* steps of depth per unit */
    _Atomic uint64_t *keys; /* of each sample: depth, then the triangle's number; all ones: nothing is there */
} scene;

#define KEY_NOTHING UINT64_MAX

/* A corner of a triangle among the samples: x to the right and y down in steps, the depth behind the nearest vertex. */
typedef struct corner {
    int64_t x, y;
    double depth;
} corner;

static inline void scene_turn(const scene *s, const float vector[3], double out[3]) {
    for (int row = 0; row < 3; row++)
        out[row] = s->rows[row][0] * (double)vector[0] + s->rows[row][1] * (double)vector[1] +
                   s->rows[row][2] * (double)vector[2];
}

/* The position of a vertex. Returns whether it is finite. */
static inline int scene_position(const scene *s, const scene_part *part, uint64_t vertex, double out[3]) {
    scene_turn(s, s->mesh->positions + 3 * vertex, out);
    for (int axis = 0; axis < 3; axis++) out[axis] += part->offset[axis];
    return isfinite(out[0]) && isfinite(out[1]) && isfinite(out[2]);
}

/* The corners of a triangle; 0 where one is not finite. */
static inline int scene_corners(const scene *s, const scene_part *part, uint64_t triangle, corner out[3]) {
    for (int n = 0; n < 3; n++) {
        double position[3];
        if (!scene_position(s, part, s->mesh->triangles[3 * triangle + (uint64_t)n], position)) return 0;
        const double x = position[0] - (s->bounds[0][0] + (s->bounds[1][0] - s->bounds[0][0]) / 2);
        const double y = position[1] - (s->bounds[0][1] + (s->bounds[1][1] - s->bounds[0][1]) / 2);
        out[n].x = (int64_t)floor(x * s->scale * STEPS + 0.5) + s->width * (STEPS / 2);
        out[n].y = (int64_t)floor(-y * s->scale * STEPS + 0.5) + s->height * (STEPS / 2);
        out[n].depth = (s->bounds[1][2] - position[2]) * s->depth_scale;
    }
    return 1;
}

/* Twice the area of the triangle of a, b and a point among the samples; positive where it runs clockwise, as y is down.
 */
static inline int64_t corner_area(const corner *a, const corner *b, int64_t x, int64_t y) {
    return (b->x - a->x) * (y - a->y) - (b->y - a->y) * (x - a->x);
}

/* The part that the triangle belongs to. */
static inline const scene_part *scene_part_of_triangle(const scene *s, uint64_t triangle) {
    int low = 0, high = s->part_count - 1;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (triangle < s->parts[middle].triangle_end)
            high = middle;
        else
            low = middle + 1;
    }
    return &s->parts[low];
}

/* Fills s->normals. Returns 0, or STATUS_FAILED without memory. */
int surface_normals(scene *s);

/* Fills s->keys, which say nothing before, with what the samples show. */
void surface_draw(scene *s);

/* Colours the picture by the keys. */
void surface_shade(const scene *s, picture *p);

#endif
