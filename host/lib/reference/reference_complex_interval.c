/*
 * The part of a grid of tetrahedra between two isovalues: one loop over the tetrahedra counts, another emits. Vertices
 * of the two surfaces are numbered when their edges are first met, as reference_complex.c does it; samples within, of
 * points that a present tetrahedron has, by point number.
 */
#include "failure.h"
#include "tables/interval_cases.h"
#include "reference/reference_complex_run.h"
#include "reference/reference_interval.h"

#include <math.h>
#include <stdlib.h>

typedef struct interval_run {
    const tc_grid *grid;
    reference bounds[BOUND_COUNT];
    tc_mesh surfaces[BOUND_COUNT]; /* where their vertices are in the interval volume */
    uint32_t first[BOUND_COUNT];   /* number of the first vertex of each */
    interval_case cases[INTERVAL_CASES];
    uint32_t *point_numbers;      /* of samples within; NO_NUMBER elsewhere */
    tc_interval_volume *interval; /* NULL: count only */
    uint64_t sample_count, tetrahedron_count;
} interval_run;

static unsigned value_where(const interval_run *v, double value) {
    if (value >= v->bounds[BOUND_HIGH].isovalue) return SAMPLE_ABOVE;
    return value >= v->bounds[BOUND_LOW].isovalue ? SAMPLE_WITHIN : SAMPLE_BELOW;
}

/* Where the points of a tetrahedron are; false where a sample is missing. */
static bool points_where(const interval_run *v, const uint32_t points[4], unsigned where[4]) {
    for (unsigned n = 0; n < 4; n++) {
        const double value = grid_value_at(v->grid, points[n]);
        if (!isfinite(value)) return false;
        where[n] = value_where(v, value);
    }
    return true;
}

static unsigned pattern_from(const unsigned where[4], unsigned least) {
    unsigned pattern = 0;
    for (unsigned n = 0; n < 4; n++) pattern |= (unsigned)(where[n] >= least) << n;
    return pattern;
}

/* An edge of a tetrahedron whose corners are in the order of their numbers, by its edges as they were. */
static unsigned edge_as_given(const uint32_t points[4], uint32_t a, uint32_t b) {
    for (unsigned e = 0; e < 6; e++) {
        const uint32_t p = points[tetrahedron_edges[e][0]], q = points[tetrahedron_edges[e][1]];
        if ((p == a && q == b) || (p == b && q == a)) return e;
    }
    return 0;
}

static tc_status part_emit(interval_run *v, const uint32_t points[4], const uint32_t sorted[4],
                           uint32_t numbers[BOUND_COUNT][6], const uint8_t part[4], bool is_odd) {
    const uint64_t n = v->tetrahedron_count++;
    if (!v->interval) return TC_OK;
    if (n >= v->interval->size.tetrahedra) return reference_complex_change_fail();
    uint32_t *out = (uint32_t *)v->interval->tetrahedra.memory + 4 * n;
    for (unsigned m = 0; m < 4; m++) {
        const unsigned vertex = part[is_odd && m > 1 ? 5 - m : m];
        if (vertex < INTERVAL_LOW) {
            out[m] = v->point_numbers[sorted[vertex]];
            if (out[m] == NO_NUMBER) return reference_complex_change_fail();
            continue;
        }
        const int bound = vertex < INTERVAL_HIGH ? BOUND_LOW : BOUND_HIGH;
        const uint8_t *ends = tetrahedron_edges[vertex - (bound == BOUND_LOW ? INTERVAL_LOW : INTERVAL_HIGH)];
        out[m] = v->first[bound] + numbers[bound][edge_as_given(points, sorted[ends[0]], sorted[ends[1]])];
    }
    return TC_OK;
}

static tc_status tetrahedron_run(interval_run *v, uint64_t tetrahedron) {
    const uint32_t *points = v->grid->complex->tetrahedra + 4 * tetrahedron;
    uint32_t numbers[BOUND_COUNT][6] = {{0}}, sorted[4];
    unsigned where[4], digits = 0;
    for (unsigned n = 0; n < 4; n++) {
        if (points[n] >= v->grid->complex->point_count) return complex_point_fail(v->grid->complex);
        sorted[n] = points[n];
    }
    if (!points_where(v, points, where)) return TC_OK;
    tc_status status = reference_complex_vertices(&v->bounds[BOUND_LOW], points, pattern_from(where, SAMPLE_WITHIN),
                                                  numbers[BOUND_LOW]);
    if (!status)
        status = reference_complex_vertices(&v->bounds[BOUND_HIGH], points, pattern_from(where, SAMPLE_ABOVE),
                                            numbers[BOUND_HIGH]);
    const bool is_odd = corners_sort(sorted);
    points_where(v, sorted, where);
    for (unsigned n = 4; n-- > 0;) {
        digits = 3 * digits + where[n];
        if (!v->interval && where[n] == SAMPLE_WITHIN) v->point_numbers[sorted[n]] = 0;
    }
    const interval_case *found = &v->cases[digits];
    for (unsigned n = 0; n < found->count && !status; n++)
        status = part_emit(v, points, sorted, numbers, found->parts[n], is_odd);
    return status;
}

static tc_status tetrahedra_run(interval_run *v, const char *stage, double before, double share) {
    const uint64_t count = v->grid->complex->tetrahedron_count, steps = 64;
    tc_status status = TC_OK;
    v->tetrahedron_count = 0;
    for (int n = 0; n < BOUND_COUNT; n++) reference_complex_restart(&v->bounds[n]);
    for (uint64_t step = 0, n = 0; step < steps && !status; step++) {
        for (; n < count * (step + 1) / steps && !status; n++) status = tetrahedron_run(v, n);
        if (!status)
            status = context_progress(v->grid->context, stage, before + share * (double)(step + 1) / (double)steps);
    }
    return status;
}

/* Numbers the samples within that were met. */
static void samples_number(interval_run *v) {
    v->sample_count = 0;
    for (uint64_t n = 0; n < v->grid->complex->point_count; n++)
        if (v->point_numbers[n] != NO_NUMBER) v->point_numbers[n] = (uint32_t)v->sample_count++;
}

static tc_status run_begin(interval_run *v, const tc_grid *grid, const tc_interval_volume_options *options) {
    const uint64_t points = grid->complex->point_count;
    tc_status status = TC_OK;
    *v = (interval_run){.grid = grid};
    interval_cases_derive(v->cases);
    for (int n = 0; n < BOUND_COUNT && !status; n++) {
        tc_extract_options surface;
        tc_extract_options_init(&surface);
        surface.isovalue = n == BOUND_LOW ? options->low : options->high;
        status = reference_complex_begin(&v->bounds[n], grid, &surface);
    }
    v->point_numbers = malloc((size_t)(points + 1) * sizeof *v->point_numbers);
    if (!status && !v->point_numbers) status = (tc_status)fail(TC_ERROR_MEMORY, "no memory for the numbers of samples");
    for (uint64_t n = 0; n < points && !status; n++) v->point_numbers[n] = NO_NUMBER;
    return status;
}

static void run_end(interval_run *v) {
    for (int n = 0; n < BOUND_COUNT; n++) reference_complex_end(&v->bounds[n]);
    free(v->point_numbers);
}

static tc_status run_count(interval_run *v, double share, interval_size *size) {
    tc_status status = tetrahedra_run(v, "classify", 0, share);
    if (!status) samples_number(v);
    *size = (interval_size){{v->sample_count, v->bounds[BOUND_LOW].vertex_count, v->bounds[BOUND_HIGH].vertex_count},
                            v->tetrahedron_count};
    return status;
}

static void run_prepare(interval_run *v, tc_interval_volume *interval) {
    float *positions = interval->positions.memory;
    v->interval = interval;
    for (int n = 0; n < BOUND_COUNT; n++) {
        const uint64_t first = interval_first(&interval->size, BLOCK_LOW + n);
        v->first[n] = (uint32_t)first;
        v->surfaces[n].channels[CHANNEL_POSITIONS].memory = positions + 3 * first;
        v->surfaces[n].vertex_count = interval->size.vertices[BLOCK_LOW + n];
        v->bounds[n].mesh = &v->surfaces[n];
    }
    for (uint64_t n = 0; n < v->grid->complex->point_count; n++)
        for (int axis = 0; axis < 3 && v->point_numbers[n] != NO_NUMBER; axis++)
            positions[3 * (uint64_t)v->point_numbers[n] + (uint64_t)axis] =
                v->grid->complex->points[3 * n + (uint64_t)axis];
}

static tc_status run_complete(const interval_run *v) {
    const interval_size *size = &v->interval->size;
    for (int n = 0; n < BOUND_COUNT; n++)
        if (v->bounds[n].vertex_count != size->vertices[BLOCK_LOW + n]) return reference_complex_change_fail();
    return v->tetrahedron_count == size->tetrahedra ? TC_OK : reference_complex_change_fail();
}

tc_status reference_complex_interval_count(const tc_grid *grid, const tc_interval_volume_options *options,
                                           interval_size *size) {
    interval_run v;
    tc_status status = run_begin(&v, grid, options);
    if (!status) status = run_count(&v, 1, size);
    run_end(&v);
    return status;
}

tc_status reference_complex_interval_extract(const tc_grid *grid, const tc_interval_volume_options *options,
                                             tc_interval_volume *interval) {
    interval_run v;
    interval_size size = {{0}, 0};
    const double start = clock_ms();
    tc_status status = run_begin(&v, grid, options);
    if (!status) status = run_count(&v, 0.5, &size);
    const double classified = clock_ms();
    if (!status) status = interval_allocate(interval, &size);
    if (!status) {
        run_prepare(&v, interval);
        status = tetrahedra_run(&v, "emit", 0.5, 0.5);
    }
    if (!status) status = run_complete(&v);
    interval->timings.classify_ms = classified - start;
    interval->timings.emit_ms = clock_ms() - classified;
    interval->timings.total_ms = clock_ms() - start;
    run_end(&v);
    return status;
}

tc_status reference_complex_interval_carry(const tc_grid *grid, const tc_interval_volume_options *options,
                                           const carry *c, uint64_t *count) {
    interval_run v;
    interval_size size = {{0}, 0};
    tc_status status = run_begin(&v, grid, options);
    if (!status) status = run_count(&v, 1, &size);
    for (uint64_t n = 0; n < grid->complex->point_count && !status; n++)
        if (v.point_numbers[n] != NO_NUMBER) carry_vertex(c, v.point_numbers[n], (int64_t)n, (int64_t)n, 0);
    *count = size.vertices[BLOCK_SAMPLES];
    run_end(&v);
    return status;
}
