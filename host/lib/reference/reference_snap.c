/*
 * Method snap: the surface is made to go through samples that it passes closely, where that does not change its
 * topology (kernels/README.md). kernels/snap/snap.cl does the same for 64 samples at a time.
 *
 * The signs of a sample's link decide. They must be such that the sample is a regular point of the surface, and of the
 * surface's border where the sample is on the grid's border: then the surface through the sample and the one on either
 * side of it are homeomorphic.
 */
#include "reference/reference_run.h"

#include "tables/tables.h"
#include "kernels/snap/link.h"

#include <string.h>

#define REAL    float
#define NAME(x) x##_f32
#include "reference/reference_nearest.inc"
#undef REAL
#undef NAME
#define REAL    double
#define NAME(x) x##_f64
#include "reference/reference_nearest.inc"

#define LINK_STEP(x, y, z) {x, y, z},
static const int8_t link_steps[LINK_EVEN][3] = {LINK_SAMPLES(LINK_STEP)};

/* Samples of a link are bits of a mask. */
typedef struct links {
    uint32_t joined[2][LINK_EVEN]; /* by the parity of the sample in the middle: to which others each is joined */
} links;

/* ------------------------------------------------------------------------------------------------------------ links */

static int link_index(const int step[3]) {
    for (int n = 0; n < LINK_EVEN; n++)
        if (link_steps[n][0] == step[0] && link_steps[n][1] == step[1] && link_steps[n][2] == step[2]) return n;
    return -1;
}

/* From the tetrahedra of the eight cubes around a sample: those that have it join their three other corners. */
static links links_derive(void) {
    links l;
    memset(&l, 0, sizeof l);
    for (unsigned n = 0; n < 2 * 8 * TETRAHEDRA_PER_CUBE; n++) {
        const unsigned parity = n & 1, middle = n >> 1 & 7; /* the sample is this corner of the cube */
        const unsigned odd = (parity ^ middle ^ middle >> 1 ^ middle >> 2) & 1;
        const uint8_t *corners = tetrahedron_corners[odd][n >> 4];
        if (!memchr(corners, (int)middle, 4)) continue;
        for (int a = 0; a < 4; a++)
            for (int b = 0; b < 4; b++) {
                int from[3], to[3];
                for (int axis = 0; axis < 3; axis++) {
                    from[axis] = (int)(corners[a] >> axis & 1) - (int)(middle >> axis & 1);
                    to[axis] = (int)(corners[b] >> axis & 1) - (int)(middle >> axis & 1);
                }
                if (a != b && corners[a] != middle && corners[b] != middle)
                    l.joined[parity][link_index(from)] |= 1u << link_index(to);
            }
    }
    return l;
}

/* ------------------------------------------------------------------------------------------------------------ signs */

/* What is around a sample: masks of its link. */
typedef struct surroundings {
    const uint32_t *joined;
    uint32_t here;              /* in the grid */
    uint32_t plus, minus, zero; /* inside, outside, on the surface */
    uint32_t crossed;           /* edges that have a crossing, and along which the sample may move */
} surroundings;

static unsigned colour_of(const reference *r, const int64_t p[3]) {
    const unsigned odd_j = (unsigned)(r->grid->first[1] + p[1]) & 1, odd_k = (unsigned)(r->grid->first[2] + p[2]) & 1;
    return cube_parity(r, p) ? COLOUR_ODD : COLOUR_EVEN(odd_j, odd_k);
}

static bool at_border(const reference *r, const int64_t p[3], int axis) {
    return p[axis] == 0 || p[axis] + 1 == r->dims[axis];
}

static void step_from(const int64_t p[3], int n, int64_t out[3]) {
    for (int axis = 0; axis < 3; axis++) out[axis] = p[axis] + link_steps[n][axis];
}

static surroundings surroundings_of(const reference *r, const links *l, const int64_t p[3]) {
    const unsigned odd = cube_parity(r, p);
    surroundings s = {.joined = l ? l->joined[odd] : NULL};
    for (int n = 0; n < (odd ? LINK_ODD : LINK_EVEN); n++) {
        int64_t q[3];
        bool in_grid = true, moves = true;
        step_from(p, n, q);
        for (int axis = 0; axis < 3; axis++) {
            in_grid = in_grid && q[axis] >= 0 && q[axis] < r->dims[axis];
            moves = moves && (!at_border(r, p, axis) || link_steps[n][axis] == 0); /* a border keeps its samples */
        }
        if (!in_grid) continue;
        const bool zero = sample_is(r, q, SNAPPED), inside = sample_is(r, q, INSIDE);
        s.here |= 1u << n;
        *(zero ? &s.zero : inside ? &s.plus : &s.minus) |= 1u << n;
        if (moves && inside != sample_is(r, p, INSIDE)) s.crossed |= 1u << n;
    }
    return s;
}

static bool connected(const uint32_t joined[LINK_EVEN], uint32_t samples) {
    uint32_t seen = samples & -samples, before = 0;
    while (seen != before) {
        before = seen;
        for (int n = 0; n < LINK_EVEN; n++)
            if (seen >> n & 1) seen |= joined[n] & samples;
    }
    return samples && seen == samples;
}

/* Whether the surface crosses a ring of link samples as often as it must: twice, or once where the grid's border has
 * cut the ring open. A snapped sample on it lies between + and -. */
static bool ring_is_regular(const surroundings *s, uint32_t ring) {
    const uint32_t samples = ring & s->here;
    int crossings = 0;
    for (int n = 0; n < LINK_EVEN; n++) {
        const uint32_t beside = s->joined[n] & samples;
        const int plus = __builtin_popcount(beside & s->plus), minus = __builtin_popcount(beside & s->minus);
        if (!(samples >> n & 1)) continue;
        if (s->zero >> n & 1) {
            if (plus != 1 || minus != 1) return false;
            crossings++;
        } else if (s->plus >> n & 1) {
            crossings += minus;
        }
    }
    return crossings == (samples == ring ? 2 : 1);
}

/* Samples of a link in the plane across an axis. */
static uint32_t ring_across(const surroundings *s, int axis) {
    uint32_t ring = 0;
    for (int n = 0; n < LINK_EVEN; n++)
        if (s->joined[n] && link_steps[n][axis] == 0) ring |= 1u << n;
    return ring;
}

static bool point_is_regular(const reference *r, const surroundings *s, const int64_t p[3]) {
    if (!connected(s->joined, s->plus) || !connected(s->joined, s->minus)) return false;
    for (int n = 0; n < LINK_EVEN; n++)
        if ((s->zero >> n & 1) && !ring_is_regular(s, s->joined[n])) return false;
    for (int axis = 0; axis < 3; axis++)
        if (at_border(r, p, axis) && !ring_is_regular(s, ring_across(s, axis))) return false;
    return true;
}

/* --------------------------------------------------------------------------------------------------------- snapping */

/* The index in the link of the nearest crossing that is near enough; -1: there is none. */
static int nearest_crossing(const reference *r, const surroundings *s, const int64_t p[3]) {
    const double value = sample_value(r, p);
    double steepness = 0;
    int nearest = -1;
    for (int n = 0; n < LINK_EVEN; n++) {
        int64_t q[3];
        if (!(s->crossed >> n & 1)) continue;
        step_from(p, n, q);
        const double other = sample_value(r, q);
        const bool across = n >= LINK_ODD;
        if (type_is_wide(r->grid->type)
                ? crossing_is_nearer_f64(value, other, r->isovalue, r->threshold, across, &steepness)
                : crossing_is_nearer_f32(value, other, r->isovalue, r->threshold, across, &steepness))
            nearest = n;
    }
    return nearest;
}

/* All cubes of the grid that have the sample are present. */
static bool cubes_around_present(const reference *r, const int64_t p[3]) {
    for (int c = 0; c < 8; c++) {
        const int64_t cube[3] = {p[0] - (c & 1), p[1] - (c >> 1 & 1), p[2] - (c >> 2)};
        if (cube_in_grid(r, cube) && !cube_present(r, cube)) return false;
    }
    return true;
}

static void sample_snap(reference *r, const links *l, const int64_t p[3]) {
    const surroundings s = surroundings_of(r, l, p);
    if (s.crossed && cubes_around_present(r, p) && nearest_crossing(r, &s, p) >= 0 && point_is_regular(r, &s, p))
        r->signs[sample_index(r, p)] |= SNAPPED;
}

void samples_snap(reference *r) {
    const links l = links_derive();
    for (unsigned colour = 0; colour < COLOURS; colour++)
        for (int64_t z = 0; z < r->dims[2]; z++)
            for (int64_t y = 0; y < r->dims[1]; y++)
                for (int64_t x = 0; x < r->dims[0]; x++) {
                    const int64_t p[3] = {x, y, z};
                    if (colour_of(r, p) == colour) sample_snap(r, &l, p);
                }
}

void snapped_edge(const reference *r, const int64_t p[3], int64_t a[3], int64_t b[3]) {
    const surroundings s = surroundings_of(r, NULL, p);
    int n = nearest_crossing(r, &s, p);
    if (n < 0) n = p[0] + 1 < r->dims[0] ? 1 : 0; /* only where the caller changes samples meanwhile */
    const bool up = link_steps[n][2] > 0 || (link_steps[n][2] == 0 &&
                                             (link_steps[n][1] > 0 || (link_steps[n][1] == 0 && link_steps[n][0] > 0)));
    memcpy(up ? a : b, p, 3 * sizeof *p);
    step_from(p, n, up ? b : a);
}
