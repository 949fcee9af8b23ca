/*
 * statistics.c - two passes over the samples (range, then histogram), and Otsu's threshold of the histogram
 *
 * Source: Otsu, "A threshold selection method from gray-level histograms" (1979): the split of the bins in two classes
 * with the greatest variance between the classes. Where several splits in a row are equally good (empty bins between
 * two materials) the middle one is taken.
 */
#include "statistics.h"

#include "sample_types.h"

#include <math.h>
#include <string.h>

/* Finite values of one array, or of one component: every stride-th value from the first on. */
typedef struct extent {
    uint64_t finite_count, nonfinite_count, missing_count;
    double least, most; /* infinities where there is no finite value */
} extent;

static const extent nothing = {0, 0, 0, INFINITY, -INFINITY};

static int may_be_missing(const sample_array *array) { return array->blanked || array->has_nodata || array->used; }

static int is_used(const sample_array *array, uint64_t n) { return !array->used || array->used[n]; }

static int is_missing(const sample_array *array, uint64_t n, double value) {
    return (array->blanked && array->blanked[n]) || (array->has_nodata && value == array->nodata);
}

/* Of arrays with samples that may be missing; others have loops of their own, ten times as fast. */
static extent extent_of_present(const sample_array *array) {
    extent e = nothing;
    for (uint64_t n = 0; n < array->count; n++) {
        double value = value_at(array->type, array->samples, n);
        if (!is_used(array, n)) continue;
        if (is_missing(array, n, value)) {
            e.missing_count++;
        } else if (isfinite(value)) {
            e.finite_count++;
            e.least = value < e.least ? value : e.least;
            e.most = value > e.most ? value : e.most;
        } else {
            e.nonfinite_count++;
        }
    }
    return e;
}

#define EXTENT_OF_INTEGERS(type, name, c_type, ...)                                                                    \
    case type: {                                                                                                       \
        const c_type *at = array->samples;                                                                             \
        c_type least = at[first], most = at[first];                                                                    \
        for (uint64_t n = first; n < array->count; n += stride) {                                                      \
            least = at[n] < least ? at[n] : least;                                                                     \
            most = at[n] > most ? at[n] : most;                                                                        \
        }                                                                                                              \
        e.finite_count = (array->count - first + stride - 1) / stride;                                                 \
        e.least = (double)least;                                                                                       \
        e.most = (double)most;                                                                                         \
        break;                                                                                                         \
    }

#define EXTENT_OF_REALS(type, name, c_type, ...)                                                                       \
    case type: {                                                                                                       \
        const c_type *at = array->samples;                                                                             \
        for (uint64_t n = first; n < array->count; n += stride) {                                                      \
            double value = (double)at[n];                                                                              \
            int finite = isfinite(value);                                                                              \
            e.finite_count += (uint64_t)finite;                                                                        \
            e.nonfinite_count += (uint64_t)!finite;                                                                    \
            if (!finite) continue;                                                                                     \
            e.least = value < e.least ? value : e.least;                                                               \
            e.most = value > e.most ? value : e.most;                                                                  \
        }                                                                                                              \
        break;                                                                                                         \
    }

static extent extent_of(const sample_array *array, uint64_t first, uint64_t stride) {
    extent e = nothing;
    if (array->count <= first) return e;
    switch (array->type) {
        INTEGER_TYPES(EXTENT_OF_INTEGERS)
        REAL_TYPES(EXTENT_OF_REALS)
    }
    return e;
}

int statistics_range(const sample_array *array, int first, int stride, double range[2]) {
    extent e = extent_of(array, (uint64_t)first, (uint64_t)stride);
    range[0] = e.least;
    range[1] = e.most;
    return e.finite_count != 0;
}

static extent extent_of_all(const sample_array *arrays, int count) {
    extent all = nothing;
    for (int n = 0; n < count; n++) {
        extent e = may_be_missing(&arrays[n]) ? extent_of_present(&arrays[n]) : extent_of(&arrays[n], 0, 1);
        all.missing_count += e.missing_count;
        all.finite_count += e.finite_count;
        all.nonfinite_count += e.nonfinite_count;
        all.least = e.least < all.least ? e.least : all.least;
        all.most = e.most > all.most ? e.most : all.most;
    }
    return all;
}

int statistics_extent(const sample_array *arrays, int count, double range[2]) {
    const extent all = extent_of_all(arrays, count);
    range[0] = all.least;
    range[1] = all.most;
    return all.finite_count != 0;
}

uint64_t statistics_count_equal(const sample_array *arrays, int count, double value) {
    uint64_t equal = 0;
    for (int n = 0; n < count; n++)
        for (uint64_t m = 0; m < arrays[n].count; m++)
            equal += value_at(arrays[n].type, arrays[n].samples, m) == value && is_used(&arrays[n], m) &&
                     !is_missing(&arrays[n], m, value);
    return equal;
}

static void find_range(const sample_array *arrays, int count, statistics *s) {
    const extent all = extent_of_all(arrays, count);
    s->finite_count = all.finite_count;
    s->missing_count = all.missing_count;
    s->nonfinite_count = all.nonfinite_count;
    s->minimum = all.finite_count ? all.least : 0.0;
    s->maximum = all.finite_count ? all.most : 0.0;
}

static void choose_bins(int all_integers, statistics *s) {
    if (!s->finite_count) return;
    if (all_integers) {
        double values = s->maximum - s->minimum + 1.0;
        s->width = ceil(values / STATISTICS_BINS);
        s->bin_count = (int)ceil(values / s->width);
        s->low = s->minimum - 0.5;
        return;
    }
    s->low = s->minimum;
    s->width = s->maximum / STATISTICS_BINS - s->minimum / STATISTICS_BINS; /* the difference may overflow */
    s->bin_count = s->width > 0.0 ? STATISTICS_BINS : 1;
}

static void count_sample(statistics *s, double value) {
    double position = s->width > 0.0 ? (0.5 * value - 0.5 * s->low) / s->width * 2.0 : 0.0;
    int bin = position < 0.0 ? 0 : position >= s->bin_count ? s->bin_count - 1 : (int)position;
    s->bins[bin]++;
}

#define COUNT_SAMPLES(type, name, c_type, ...)                                                                         \
    case type:                                                                                                         \
        for (uint64_t n = 0; n < array->count; n++)                                                                    \
            if (isfinite((double)((const c_type *)array->samples)[n]))                                                 \
                count_sample(s, (double)((const c_type *)array->samples)[n]);                                          \
        break;

static void fill_bins_of_present(const sample_array *array, statistics *s) {
    for (uint64_t n = 0; n < array->count; n++) {
        double value = value_at(array->type, array->samples, n);
        if (isfinite(value) && is_used(array, n) && !is_missing(array, n, value)) count_sample(s, value);
    }
}

static void fill_bins(const sample_array *array, statistics *s) {
    if (may_be_missing(array)) {
        fill_bins_of_present(array, s);
        return;
    }
    switch (array->type) { SAMPLE_TYPES(COUNT_SAMPLES) }
}

void statistics_of(const sample_array *arrays, int count, statistics *out) {
    int all_integers = 1;
    memset(out, 0, sizeof *out);
    for (int n = 0; n < count; n++) all_integers &= !type_is_real(arrays[n].type);
    find_range(arrays, count, out);
    choose_bins(all_integers, out);
    for (int n = 0; n < count && out->finite_count; n++) fill_bins(&arrays[n], out);
}

/* The bin that starts the upper class when bins [begin, end) are split; begin where they hold less than two values. */
static int otsu_split(const statistics *s, int begin, int end) {
    double total = 0.0, moment = 0.0, below = 0.0, below_moment = 0.0, best = 0.0;
    int first = begin, last = begin;
    for (int n = begin; n < end; n++) {
        total += (double)s->bins[n];
        moment += (double)n * (double)s->bins[n];
    }
    for (int n = begin + 1; n < end; n++) {
        below += (double)s->bins[n - 1];
        below_moment += (double)(n - 1) * (double)s->bins[n - 1];
        if (below == 0.0 || below == total) continue;
        double apart = below_moment / below - (moment - below_moment) / (total - below);
        double between = below * (total - below) * apart * apart;
        if (between > best) {
            best = between;
            first = n;
        }
        if (between == best) last = n;
    }
    return first + (last - first) / 2;
}

static double edge(const statistics *s, int bin) { return s->low + (double)bin * s->width; }

static int suggest(const statistics *s, double value, const char *name, const char *reason, suggestion *out,
                   int count) {
    if (!(value > s->minimum && value <= s->maximum)) return count;
    for (int n = 0; n < count; n++)
        if (out[n].isovalue == value) return count;
    out[count] = (suggestion){value, name, reason};
    return count + 1;
}

int statistics_suggest(const statistics *s, suggestion out[SUGGESTIONS_MAX]) {
    int split = otsu_split(s, 0, s->bin_count), count = 0;
    if (split > 0) {
        int upper = otsu_split(s, split, s->bin_count), lower = otsu_split(s, 0, split);
        count = suggest(s, edge(s, split), "otsu", "Otsu's threshold of all finite samples", out, count);
        if (upper > split)
            count =
                suggest(s, edge(s, upper), "otsu-upper", "Otsu's threshold of the samples above the first", out, count);
        if (lower > 0)
            count =
                suggest(s, edge(s, lower), "otsu-lower", "Otsu's threshold of the samples below the first", out, count);
    }
    return suggest(s, 0.5 * s->minimum + 0.5 * s->maximum, "middle", "half-way between minimum and maximum", out,
                   count);
}
