/*
 * view.h - where a picture is looked at from: angles, the names of usual ones, and the axes of the picture in space
 *
 * Projection is parallel. z is up, and seen from the front x runs to the right: `front` looks along +y. The azimuth
 * turns the viewer around z, to the right; the elevation lifts the viewer. Degrees.
 */
#ifndef VIEW_H
#define VIEW_H

typedef struct view_angles {
    double azimuth, elevation;
} view_angles;

/* Unit vectors, right-handed: to the right and up in the picture, and from it towards the viewer. */
typedef struct view_axes {
    double right[3], up[3], toward[3];
} view_axes;

/* A three-quarter view, where none is chosen. */
#define VIEW_DEFAULT ((view_angles){30, 25})

/* Name n of a view; NULL behind the last. */
const char *view_name(int n);
view_angles view_named(int n);

/* The same on every machine: sines and cosines are rounded to 30 binary digits, far above the errors of a libm. */
view_axes view_axes_of(view_angles angles);

#endif
