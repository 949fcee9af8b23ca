/*
 * The rules of kernels/snap/nearest.cl and snapped.cl: nearest_of_sample and snapped_to. The arithmetic is the
 * reference's.
 */
#include "structured/snapped_edge.h"

#include "grid/carry.h"

#define REAL    float
#define NAME(x) x##_f32
#include "reference/reference_nearest.inc"
#undef REAL
#undef NAME
#define REAL    double
#define NAME(x) x##_f64
#include "reference/reference_nearest.inc"
#undef REAL
#undef NAME

#define LINK_STEP(x, y, z) {x, y, z},
static const int8_t link_steps[LINK_EVEN][3] = {LINK_SAMPLES(LINK_STEP)};

snapped_edges snapped_edges_of(const tc_grid *grid, const tc_extract_options *options) {
    snapped_edges e = {.grid = grid, .isovalue = options->isovalue, .threshold = (float)options->snap};
    for (int n = 0; n < LINK_EVEN; n++)
        e.steps[n] = link_steps[n][0] + grid->dims[0] * (link_steps[n][1] + grid->dims[1] * link_steps[n][2]);
    return e;
}

/* Samples of the link towards which a sample may move: one on a border of the grid moves within the border. */
static uint32_t link_moves(const tc_grid *grid, const int64_t p[3]) {
    uint32_t moves = (1u << (((grid_parity(grid) + (uint64_t)(p[0] + p[1] + p[2])) & 1) ? LINK_ODD : LINK_EVEN)) - 1;
    for (int axis = 0; axis < 3; axis++)
        for (int n = 0; n < LINK_EVEN && (p[axis] == 0 || p[axis] + 1 == grid->dims[axis]); n++)
            if (link_steps[n][axis]) moves &= ~(1u << n);
    return moves;
}

void snapped_edge_find(const snapped_edges *e, const int64_t p[3], int64_t *low, int64_t *high) {
    const tc_grid *grid = e->grid;
    const int64_t here = (p[2] * grid->dims[1] + p[1]) * grid->dims[0] + p[0];
    int64_t samples[1 + LINK_EVEN] = {here};
    double values[1 + LINK_EVEN], steepness = 0;
    int to[LINK_EVEN], count = 0;
    for (uint32_t rest = link_moves(grid, p); rest; rest &= rest - 1) {
        to[count] = __builtin_ctz(rest);
        samples[1 + count] = here + e->steps[to[count]];
        count++;
    }
    carry_samples(grid, samples, (uint32_t)(1 + count), values);
    int nearest = -1;
    const bool inside = values[0] >= e->isovalue, wide = type_is_wide(grid->type);
    for (int n = 0; n < count; n++) {
        const double other = values[1 + n];
        const bool across = to[n] >= LINK_ODD;
        if ((other >= e->isovalue) == inside) continue;
        if (wide ? crossing_is_nearer_f64(values[0], other, e->isovalue, e->threshold, across, &steepness)
                 : crossing_is_nearer_f32(values[0], other, e->isovalue, e->threshold, across, &steepness))
            nearest = to[n];
    }
    if (nearest < 0) nearest = p[0] + 1 < grid->dims[0] ? 1 : 0; /* only where the caller changes samples meanwhile */
    const int64_t there = here + e->steps[nearest];
    *low = here < there ? here : there;
    *high = here < there ? there : here;
}
