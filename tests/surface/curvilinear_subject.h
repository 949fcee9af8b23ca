/* curvilinear_subject.h - grids for test_curvilinear.c: samples, points or axes, blanks, in memory of their own */
#ifndef CURVILINEAR_SUBJECT_H
#define CURVILINEAR_SUBJECT_H

#include "expect.h"
#include "random.h"
#include "samples.h"
#include "tetracubes.h"

#include <math.h>
#include <string.h>

enum { SAMPLES_MOST = 40000 };

/* A grid in memory of its own. */
typedef struct subject {
    tc_grid_options grid;
    tc_extract_options how;
    int64_t count, cell_count;
    double samples[SAMPLES_MOST];
    float points[3 * SAMPLES_MOST], axes[3][256];
    uint8_t blanked_samples[SAMPLES_MOST], blanked_cells[SAMPLES_MOST];
} subject;

static void subject_begin(subject *s, tc_type type, const int64_t dims[3]) {
    tc_grid_options_init(&s->grid);
    tc_extract_options_init(&s->how);
    memcpy(s->grid.dims, dims, sizeof s->grid.dims);
    s->grid.type = type;
    s->grid.samples = s->samples;
    s->count = dims[0] * dims[1] * dims[2];
    s->cell_count = (dims[0] - 1) * (dims[1] - 1) * (dims[2] - 1);
    EXPECT(s->count <= SAMPLES_MOST && dims[0] <= 256 && dims[1] <= 256 && dims[2] <= 256, "no room for a subject");
    if (s->count > SAMPLES_MOST) exit(EXIT_FAILURE);
    s->how.isovalue = 100.5;
}

static void place_of(const subject *s, int64_t n, double p[3]) {
    const int64_t *d = s->grid.dims;
    p[0] = (double)(n % d[0]), p[1] = (double)(n / d[0] % d[1]), p[2] = (double)(n / d[0] / d[1]);
}

/* Waves with ties, within all types. */
static void samples_fill(subject *s, double noise) {
    for (int64_t n = 0; n < s->count; n++) {
        double p[3];
        place_of(s, n, p);
        double wave = sin(0.31 * p[0]) * cos(0.27 * p[1]) + sin(0.35 * p[2] + 0.1 * p[0]);
        double value = 63 + 30 * wave + random_between(-noise, noise);
        sample_set(s->samples, s->grid.type, n, fmin(126, fmax(0, value)));
    }
    s->how.isovalue = random_below(3) ? 63.25 : 63;
}

/* A smooth map without folds but for the noise, mirrored where `turned` is odd. */
static void points_fill(subject *s, int turned, double noise) {
    for (int64_t n = 0; n < s->count; n++) {
        double p[3];
        place_of(s, n, p);
        double x = 1.5 * p[0] + 0.4 * sin(0.5 * p[1]) + 0.2 * p[2], y = p[1] + 0.3 * sin(0.4 * p[2] + 0.2 * p[0]);
        double q[3] = {turned & 1 ? 50 - x : x, y, 0.7 * p[2] + 0.02 * p[0] * p[1] - 20};
        for (int row = 0; row < 3; row++) s->points[3 * n + row] = (float)(q[row] + random_between(-noise, noise));
    }
    s->grid.points = s->points;
}

static void axes_fill(subject *s, int turned) {
    for (int axis = 0; axis < 3; axis++) {
        double at = random_between(-50, 50), sign = turned >> axis & 1 ? -1 : 1;
        for (int64_t n = 0; n < s->grid.dims[axis]; n++)
            s->axes[axis][n] = (float)(at += sign * random_between(0.01, 2));
        s->grid.axes[axis] = s->axes[axis];
    }
}

/* One in `one_in` of each; points of blanked samples are nowhere. */
static void blanks_fill(subject *s, int samples, int cells, uint32_t one_in) {
    for (int64_t n = 0; n < s->count; n++) {
        s->blanked_samples[n] = random_below(one_in) ? 0 : (uint8_t)(1 + random_below(255));
        if (samples && s->blanked_samples[n] && s->grid.points)
            s->points[3 * n + random_below(3)] = random_below(2) ? NAN : -INFINITY;
    }
    for (int64_t n = 0; n < s->cell_count; n++) s->blanked_cells[n] = random_below(one_in) ? 0 : 128;
    s->grid.blanked_samples = samples ? s->blanked_samples : NULL;
    s->grid.blanked_cells = cells ? s->blanked_cells : NULL;
}

#endif
