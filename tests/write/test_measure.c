/*
 * test_measure.c - volume, integrals and shapes of tetrahedra: known ones, and damaged ones
 */
#include "expect.h"
#include "tetrahedra_measure.h"

#include <math.h>
#include <string.h>

enum { SIDE = 24, POINTS = (SIDE + 1) * (SIDE + 1) * (SIDE + 1), TETRAHEDRA = 6 * SIDE * SIDE * SIDE };

static float points[3 * POINTS], values[2 * POINTS];
static uint32_t tetrahedra[4 * TETRAHEDRA];

/* A cube of side 3, cut into smaller ones, each into six tetrahedra along its diagonal. */
static tetrahedra_view cube_make(void) {
    static const int orders[6][2] = {{1, 3}, {1, 5}, {2, 3}, {2, 6}, {4, 5}, {4, 6}};
    uint32_t at = 0;
    for (int n = 0; n < POINTS; n++) {
        const int p[3] = {n % (SIDE + 1), n / (SIDE + 1) % (SIDE + 1), n / (SIDE + 1) / (SIDE + 1)};
        for (int axis = 0; axis < 3; axis++) points[3 * n + axis] = 3.0f * (float)p[axis] / SIDE;
        values[2 * n] = points[3 * n];
        values[2 * n + 1] = 2;
    }
    for (int n = 0; n < SIDE * SIDE * SIDE; n++)
        for (int order = 0; order < 6; order++) {
            const int corners[4] = {0, orders[order][0], orders[order][1], 7};
            const int is_odd = order == 1 || order == 2 || order == 5;
            for (int m = 0; m < 4; m++) {
                const int c = corners[is_odd && m > 1 ? 5 - m : m];
                const int p[3] = {n % SIDE + (c & 1), n / SIDE % SIDE + (c >> 1 & 1), n / SIDE / SIDE + (c >> 2)};
                tetrahedra[at++] = (uint32_t)((p[2] * (SIDE + 1) + p[1]) * (SIDE + 1) + p[0]);
            }
        }
    return (tetrahedra_view){points, POINTS, tetrahedra, TETRAHEDRA};
}

static void test_cube(void) {
    const tetrahedra_view t = cube_make();
    tetrahedra_shapes shapes = {0};
    double volume, integrals[2];
    EXPECT(!tetrahedra_integrate(&t, values, 2, &volume, integrals), "no integrals");
    EXPECT(fabs(volume - 27) < 1e-5, "volume %.9g", volume);
    EXPECT(fabs(integrals[0] - 27 * 1.5) < 1e-5 && fabs(integrals[1] - 54) < 1e-5, "integrals %.9g and %.9g",
           integrals[0], integrals[1]);
    tetrahedra_shapes_add(&t, &shapes);
    EXPECT(shapes.count == TETRAHEDRA && !shapes.flat && !shapes.inverted && !shapes.below_10, "shapes of a cube");
    EXPECT(fabs(shapes.least - 45) < 1e-3, "least dihedral angle %.9g", shapes.least);
}

static void test_damage(void) {
    tetrahedra_view t = cube_make();
    tetrahedra_shapes shapes = {0};
    double volume;
    const uint32_t first = tetrahedra[2];
    tetrahedra[2] = tetrahedra[3], tetrahedra[3] = first; /* turned over */
    tetrahedra[5] = POINTS;                               /* left out */
    tetrahedra[10] = tetrahedra[9];                       /* flat */
    tetrahedra_integrate(&t, NULL, 0, &volume, NULL);
    const double one = 27.0 / TETRAHEDRA;
    EXPECT(fabs(volume - (27 - 4 * one)) < 1e-5, "volume %.9g of damaged tetrahedra", volume);
    tetrahedra_shapes_add(&t, &shapes);
    EXPECT(shapes.inverted == 1 && shapes.flat == 1 && shapes.count == TETRAHEDRA - 2, "damage is not seen");
    points[3 * tetrahedra[100]] = NAN;
    tetrahedra_integrate(&t, NULL, 0, &volume, NULL);
    EXPECT(isfinite(volume), "a point that is not finite spoils the volume");
}

/* Known angles: a regular one, a corner of a cube, a thin one, a flat one. */
static void test_shapes(void) {
    static const float at[] = {1, 1, 1, -1, -1, 1, -1, 1, -1, 1,    -1,   -1,    0,    0,    0,
                               1, 0, 0, 0,  1,  0, 0,  0, 1,  0.3f, 0.3f, 0.02f, 0.3f, 0.3f, 1e-8f};
    static const uint32_t each[4][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}, {4, 5, 6, 8}, {4, 5, 6, 9}};
    static const double angles[4] = {70.528779, 54.735610, 0, 0};
    for (int n = 0; n < 4; n++) {
        const tetrahedra_view t = {at, 10, each[n], 1};
        tetrahedra_shapes s = {0};
        tetrahedra_shapes_add(&t, &s);
        EXPECT(s.flat == (n == 3) && s.count == (n != 3), "shape %d: %d flat", n, (int)s.flat);
        if (n < 2) EXPECT(fabs(s.least - angles[n]) < 1e-4, "shape %d: %.9g degrees", n, s.least);
        if (n < 2) EXPECT(fabs(tetrahedra_shapes_median(&s) - angles[n]) < 0.11, "shape %d: median", n);
        if (n == 2) EXPECT(s.below_5 == 1 && s.below_10 == 1, "a thin one has %g degrees", s.least);
    }
}

int main(void) {
    test_cube();
    test_damage();
    test_shapes();
    return EXPECT_DONE();
}
