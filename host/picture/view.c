#include "view.h"

#include <math.h>
#include <stddef.h>

/* iso sees x, y and z at one angle: the elevation is atan(1 / sqrt(2)). */
static const struct {
    const char *name;
    view_angles angles;
} views[] = {
    {"iso", {45, 35.264389682754654}},
    {"front", {0, 0}},
    {"back", {180, 0}},
    {"left", {-90, 0}},
    {"right", {90, 0}},
    {"top", {0, 90}},
    {"bottom", {0, -90}},
};

enum { VIEW_COUNT = sizeof views / sizeof *views };

const char *view_name(int n) { return n < VIEW_COUNT ? views[n].name : NULL; }

view_angles view_named(int n) { return views[n].angles; }

static double rounded(double value) { return floor(ldexp(value, 30) + 0.5) / ldexp(1, 30); }

static double sine(double degrees) { return rounded(sin(degrees * (3.14159265358979323846 / 180))); }

static double cosine(double degrees) { return rounded(cos(degrees * (3.14159265358979323846 / 180))); }

view_axes view_axes_of(view_angles angles) {
    const double sin_a = sine(angles.azimuth), cos_a = cosine(angles.azimuth);
    const double sin_e = sine(angles.elevation), cos_e = cosine(angles.elevation);
    return (view_axes){.right = {cos_a, sin_a, 0},
                       .up = {-sin_a * sin_e, cos_a * sin_e, cos_e},
                       .toward = {sin_a * cos_e, -cos_a * cos_e, sin_e}};
}
