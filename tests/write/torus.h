/* torus.h - a closed mesh, for faults to be planted in */
#ifndef TORUS_H
#define TORUS_H

#include "random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A torus of SIDE x SIDE quadrilaterals with shuffled vertices. */
#ifndef TORUS_SIDE
#define TORUS_SIDE 600
#endif
enum { SIDE = TORUS_SIDE, TORUS_VERTICES = SIDE * SIDE, TORUS_TRIANGLES = 2 * TORUS_VERTICES };

typedef struct torus {
    float (*positions)[3];
    uint32_t (*triangles)[3]; /* with room for one more */
} torus;

static void make_torus(torus *m) {
    uint32_t *shuffled = malloc(TORUS_VERTICES * sizeof *shuffled);
    m->positions = malloc(TORUS_VERTICES * sizeof *m->positions);
    m->triangles = malloc((TORUS_TRIANGLES + 1) * sizeof *m->triangles);
    if (!shuffled || !m->positions || !m->triangles) exit(EXIT_FAILURE);
    for (uint32_t v = 0; v < TORUS_VERTICES; v++) shuffled[v] = v;
    for (uint32_t v = TORUS_VERTICES; v > 1; v--) {
        uint32_t other = random_below(v), value = shuffled[v - 1];
        shuffled[v - 1] = shuffled[other];
        shuffled[other] = value;
    }
    for (uint32_t j = 0; j < SIDE; j++)
        for (uint32_t i = 0; i < SIDE; i++) {
            double around = 2 * 3.14159265358979323846 * i / SIDE, along = 2 * 3.14159265358979323846 * j / SIDE;
            uint32_t i1 = (i + 1) % SIDE, j1 = (j + 1) % SIDE, *t = m->triangles[2 * (j * SIDE + i)];
            uint32_t v = shuffled[j * SIDE + i], right = shuffled[j * SIDE + i1], up = shuffled[j1 * SIDE + i];
            uint32_t far = shuffled[j1 * SIDE + i1];
            m->positions[v][0] = (float)((3 + cos(around)) * cos(along));
            m->positions[v][1] = (float)((3 + cos(around)) * sin(along));
            m->positions[v][2] = (float)sin(around);
            memcpy(t, (uint32_t[6]){v, far, right, v, up, far}, 6 * sizeof *t);
        }
    free(shuffled);
}

#endif
