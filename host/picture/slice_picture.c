#include "slice_picture.h"

#include "exit_status.h"
#include "failure.h"
#include "sample_types.h"

#include <math.h>
#include <stdlib.h>

#define MARGIN 0.04 /* of the picture's shorter side: around the slices and between them */

static const unsigned char missing_colour[3] = {250, 240, 200};

static const unsigned char line_colours[][3] = {{214, 39, 40},  {31, 119, 180},  {44, 160, 44},
                                                {255, 127, 14}, {148, 103, 189}, {23, 190, 207}};

enum { LINE_COLOURS = sizeof line_colours / sizeof *line_colours };

/* A slice: which axes run to the right and up, which one is cut, and where its pixels lie. */
typedef struct panel {
    int right, up, through;
    int x, y, width, height;
} panel;

/* Where a pixel lies among the samples along an axis: between two of them. */
typedef struct between {
    int64_t low, high;
    double part; /* of the way */
} between;

static double extent_of(const sliced_volume *v, int axis) {
    return v->positions[axis][v->count[axis] - 1] - v->positions[axis][0];
}

static between between_of(const sliced_volume *v, int axis, double position) {
    const double *positions = v->positions[axis];
    int64_t low = 0, high = v->count[axis] - 1;
    while (high - low > 1) {
        const int64_t middle = low + (high - low) / 2;
        if (positions[middle] <= position)
            low = middle;
        else
            high = middle;
    }
    const double gap = positions[high] - positions[low], part = gap > 0 ? (position - positions[low]) / gap : 0;
    return (between){low, high, part > 0 ? part < 1 ? part : 1 : 0};
}

/* The middles of `pixels` pixels over the whole axis. */
static void spread(const sliced_volume *v, int axis, int pixels, between *out) {
    for (int n = 0; n < pixels; n++)
        out[n] = between_of(v, axis, v->positions[axis][0] + extent_of(v, axis) * ((n + 0.5) / pixels));
}

/* NaN: missing. */
static double sample_at(const sliced_volume *v, int64_t n) {
    if (v->blanked && v->blanked[n]) return NAN;
    const double value = value_at(v->type, v->samples, (uint64_t)n);
    return !isfinite(value) || (v->has_nodata && value == v->nodata) ? NAN : value;
}

/* NaN where one of the two is, whatever its part. */
static double mix(double a, double b, double part) { return a * (1 - part) + b * part; }

static double value_between(const sliced_volume *v, const panel *at, between right, between up) {
    const int64_t start = v->first + v->count[at->through] / 2 * v->stride[at->through];
    double row[2];
    for (int n = 0; n < 2; n++) {
        const int64_t line = start + (n ? up.high : up.low) * v->stride[at->up];
        row[n] = mix(sample_at(v, line + right.low * v->stride[at->right]),
                     sample_at(v, line + right.high * v->stride[at->right]), right.part);
    }
    return mix(row[0], row[1], up.part);
}

/* Halves, as the range of doubles may be beyond that of their differences. */
static unsigned char grey_of(const sliced_volume *v, double value) {
    const double range = v->white / 2 - v->black / 2;
    const double part = range > 0 ? (value / 2 - v->black / 2) / range : 0.5;
    return (unsigned char)(255 * (part > 0 ? part < 1 ? part : 1 : 0) + 0.5);
}

static unsigned char *pixel_at(const picture *p, const panel *at, int x, int y) {
    return p->pixels + 3 * ((size_t)(at->y + y) * (size_t)p->width + (size_t)(at->x + x));
}

static void put(const picture *p, const panel *at, int x, int y, const unsigned char colour[3]) {
    unsigned char *pixel = pixel_at(p, at, x, y);
    for (int n = 0; n < 3; n++) pixel[n] = colour[n];
}

static int differ(double a, double b, double isovalue) {
    return !isnan(a) && !isnan(b) && (a >= isovalue) != (b >= isovalue);
}

/* Pixels on both sides of a line take its colour. */
static void draw_line(const picture *p, const panel *at, const double *values, double isovalue,
                      const unsigned char colour[3]) {
    for (int y = 0; y < at->height; y++)
        for (int x = 0; x < at->width; x++) {
            const double *here = values + (size_t)y * (size_t)at->width + (size_t)x;
            const int to_right = x + 1 < at->width && differ(here[0], here[1], isovalue);
            const int below = y + 1 < at->height && differ(here[0], here[at->width], isovalue);
            if (to_right || below) put(p, at, x, y, colour);
            if (to_right) put(p, at, x + 1, y, colour);
            if (below) put(p, at, x, y + 1, colour);
        }
}

static void draw_values(const picture *p, const panel *at, const sliced_volume *v, const double *values) {
    for (int y = 0; y < at->height; y++)
        for (int x = 0; x < at->width; x++) {
            const double value = values[(size_t)y * (size_t)at->width + (size_t)x];
            const unsigned char grey = isnan(value) ? 0 : grey_of(v, value);
            put(p, at, x, y, isnan(value) ? missing_colour : (unsigned char[3]){grey, grey, grey});
        }
}

static int draw_panel(const picture *p, const panel *at, const sliced_volume *v, const double *isovalues,
                      size_t isovalue_count) {
    const size_t width = (size_t)at->width, height = (size_t)at->height;
    between *columns = malloc(width * sizeof *columns), *rows = malloc(height * sizeof *rows);
    double *values = malloc(width * height * sizeof *values);
    const int is_done = columns && rows && values;
    if (columns && rows && values) {
        spread(v, at->right, at->width, columns);
        spread(v, at->up, at->height, rows);
        for (size_t y = 0; y < height; y++)
            for (size_t x = 0; x < width; x++)
                values[y * width + x] = value_between(v, at, columns[x], rows[height - 1 - y]);
        draw_values(p, at, v, values);
        for (size_t n = 0; n < isovalue_count; n++)
            draw_line(p, at, values, isovalues[n], line_colours[n % LINE_COLOURS]);
    }
    free(columns);
    free(rows);
    free(values);
    return is_done ? 0 : fail(STATUS_FAILED, "out of memory for a picture of %d x %d pixels", p->width, p->height);
}

static int pixels_of(double extent, double scale) {
    const double pixels = floor(extent * scale + 0.5);
    return pixels > 1 ? (int)pixels : 1;
}

int slice_picture(const sliced_volume *v, const double *isovalues, size_t isovalue_count, picture *p) {
    const int shorter = p->width < p->height ? p->width : p->height, margin = (int)(MARGIN * shorter);
    const double x = extent_of(v, 0), y = extent_of(v, 1), z = extent_of(v, 2);
    const double across = (x + y) / (p->width - 3 * margin), down = (y + z) / (p->height - 3 * margin);
    const double units = across > down ? across : down, scale = units > 0 ? 1 / units : 1;
    const int wide = pixels_of(x, scale), deep = pixels_of(y, scale), high = pixels_of(z, scale);
    const int left = (p->width - wide - deep - margin) / 2, top = (p->height - deep - high - margin) / 2;
    const panel panels[] = {{0, 1, 2, left, top, wide, deep},
                            {0, 2, 1, left, top + deep + margin, wide, high},
                            {1, 2, 0, left + wide + margin, top + deep + margin, deep, high}};
    int status = 0;
    for (int n = 0; n < 3 && !status; n++) status = draw_panel(p, &panels[n], v, isovalues, isovalue_count);
    return status;
}
