/*
 * analytic.h - smooth fields whose surfaces are known, and grids of their samples
 *
 * Area and volume of the gyroid's piece: integrals over one period of |grad f| g(f - c) and of its antiderivative, g
 * Gaussian of widths 0.04 to 0.08, by the trapezoidal rule (exact to rounding there: 320^3 and 400^3 points agree to
 * 13 digits), extrapolated in the square of the width; the last two extrapolations agree to 1e-9.
 */
#ifndef ANALYTIC_H
#define ANALYTIC_H

#include "tetracubes.h"

#include <stdbool.h>

typedef double field_value(const double p[3]);

typedef struct shape {
    const char *name;
    field_value *value, *distance; /* of a point from the surface; the gyroid's to first order */
    double isovalue, low, high;    /* the domain's ends along each axis */
    double area, volume;
    double (*cap)(double x); /* how much of a plane across an axis, in which the domain ends, is inside */
    double room;             /* the surface may be moved by so much */
} shape;

enum { SHAPES = 3 };

/* Sphere, torus, gyroid: one period of it, open where the domain ends. */
extern const shape shapes[SHAPES];

/* Where a grid's origin lies in the field. */
typedef struct place {
    double of[3];
} place;

/* Number n of places spread evenly over the room, however many they are. */
place place_choose(int n, double room);

typedef enum layout { UNIFORM, CURVILINEAR, HEXAHEDRA, LAYOUTS } layout;

const char *layout_name(layout l);

typedef struct field_grid {
    int64_t n; /* samples along each axis */
    float *points;
    void *samples;
    tc_type type;
    double low, step;
} field_grid;

/* n^3 points from low to high, those within moved by a smooth map where `mapped`; exits where memory runs out. */
field_grid field_grid_make(field_value *value, double low, double high, place origin, int64_t n, bool mapped,
                           tc_type type);
void field_grid_free(field_grid *g);

/* Into *mesh, which is made where NULL; *data stays until the next extraction. */
tc_status field_grid_extract(const field_grid *g, tc_context *context, layout l, tc_method method, double isovalue,
                             tc_mesh **mesh, tc_mesh_data *data);

#endif
