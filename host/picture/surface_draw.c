/*
 * surface_draw.c - which triangle each sample shows
 *
 * Corners lie at whole steps, so whether a sample lies in a triangle is settled in integers, by the area that it makes
 * with each side. A sample on a side belongs to one of the two triangles there: to the one that the side is above or
 * left of. Threads share the samples: each has a key, depth before the triangle's number, that only becomes less.
 */
#include "parallel.h"
#include "surface_scene.h"

typedef struct draw_job {
    scene *s;
    _Atomic uint64_t next;
} draw_job;

/* 0 where samples on the side belong to the triangle on its inner side, else -1: to be added to areas. */
static int64_t side_bias(const corner *a, const corner *b) {
    const int is_left = b->y < a->y, is_top = b->y == a->y && b->x > a->x;
    return is_left || is_top ? 0 : -1;
}

static void key_lower(_Atomic uint64_t *pixel, uint64_t key) {
    uint64_t there = atomic_load_explicit(pixel, memory_order_relaxed);
    while (key < there &&
           !atomic_compare_exchange_weak_explicit(pixel, &there, key, memory_order_relaxed, memory_order_relaxed)) {
    }
}

static uint64_t key_of(double depth, uint64_t triangle) {
    const double most = (double)(((uint64_t)1 << DEPTH_BITS) - 2);
    const double within = depth > 0 ? depth < most ? depth : most : 0;
    return (uint64_t)(within + 0.5) << (64 - DEPTH_BITS) | triangle;
}

/* The first and the last sample of a range of steps, by their middles; within 0 to count - 1. */
static int64_t first_sample(int64_t least) {
    const int64_t n = (least - STEPS / 2 + STEPS - 1) >> 8;
    return n > 0 ? n : 0;
}

static int64_t last_sample(int64_t most, int64_t count) {
    const int64_t n = (most - STEPS / 2) >> 8;
    return n < count ? n : count - 1;
}

_Static_assert(STEPS == 1 << 8, "samples are found by shifts");

static int64_t least_of(int64_t a, int64_t b, int64_t c) {
    const int64_t least = a < b ? a : b;
    return least < c ? least : c;
}

static int64_t most_of(int64_t a, int64_t b, int64_t c) { return -least_of(-a, -b, -c); }

static void draw_triangle(scene *s, uint64_t number, const corner v[3]) {
    const int64_t x0 = first_sample(least_of(v[0].x, v[1].x, v[2].x));
    const int64_t x1 = last_sample(most_of(v[0].x, v[1].x, v[2].x), s->width);
    const int64_t y0 = first_sample(least_of(v[0].y, v[1].y, v[2].y));
    const int64_t y1 = last_sample(most_of(v[0].y, v[1].y, v[2].y), s->height);
    if (x0 > x1 || y0 > y1) return;
    const int64_t area = corner_area(&v[0], &v[1], v[2].x, v[2].y);
    const corner *a = &v[0], *b = area > 0 ? &v[1] : &v[2], *c = area > 0 ? &v[2] : &v[1];
    const double whole = (double)(area > 0 ? area : -area);
    const int64_t bias_a = side_bias(b, c), bias_b = side_bias(c, a), bias_c = side_bias(a, b);
    if (!area) return;
    for (int64_t y = y0; y <= y1; y++)
        for (int64_t x = x0; x <= x1; x++) {
            const int64_t at_x = x * STEPS + STEPS / 2, at_y = y * STEPS + STEPS / 2;
            const int64_t of_a = corner_area(b, c, at_x, at_y), of_b = corner_area(c, a, at_x, at_y);
            const int64_t of_c = corner_area(a, b, at_x, at_y);
            if (((of_a + bias_a) | (of_b + bias_b) | (of_c + bias_c)) < 0) continue;
            const double depth = ((double)of_a * a->depth + (double)of_b * b->depth + (double)of_c * c->depth) / whole;
            key_lower(&s->keys[y * s->width + x], key_of(depth, number));
        }
}

static void draw_shares(void *shared) {
    draw_job *j = shared;
    const uint64_t count = j->s->mesh->triangle_count;
    uint64_t begin;
    while ((begin = atomic_fetch_add(&j->next, SHARE_TRIANGLES)) < count) {
        const uint64_t end = count - begin < SHARE_TRIANGLES ? count : begin + SHARE_TRIANGLES;
        const scene_part *part = scene_part_of_triangle(j->s, begin);
        for (uint64_t t = begin; t < end; t++) {
            corner corners[3];
            while (t >= part->triangle_end) part++;
            if (scene_corners(j->s, part, t, corners)) draw_triangle(j->s, t, corners);
        }
    }
}

void surface_draw(scene *s) {
    draw_job j = {.s = s};
    parallel_run(s->mesh->triangle_count / SHARE_TRIANGLES + 1, draw_shares, &j);
}
