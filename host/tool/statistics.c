/*
 * statistics.c - two passes over the samples (range, then histogram), and Otsu's threshold of the histogram
 *
 * Source: Otsu, "A threshold selection method from gray-level histograms" (1979): the split of the bins in two classes
 * with the greatest variance between the classes. Where several splits in a row are equally good (empty bins between
 * two materials) the middle one is taken.
 */
#include "statistics.h"

#include <math.h>
#include <string.h>

static size_t sample_count(const volume *v) { return (size_t)(v->dims[0] * v->dims[1] * v->dims[2]); }

#define RANGE_OF_INTEGERS(c_type)                                                                                      \
    {                                                                                                                  \
        const c_type *at = v->samples;                                                                                 \
        c_type least = at[0], most = at[0];                                                                            \
        for (size_t n = 0; n < count; n++) {                                                                           \
            least = at[n] < least ? at[n] : least;                                                                     \
            most = at[n] > most ? at[n] : most;                                                                        \
        }                                                                                                              \
        s->finite_count = count;                                                                                       \
        s->minimum = (double)least;                                                                                    \
        s->maximum = (double)most;                                                                                     \
    }                                                                                                                  \
    break

#define RANGE_OF_REALS(c_type)                                                                                         \
    {                                                                                                                  \
        const c_type *at = v->samples;                                                                                 \
        double least = INFINITY, most = -INFINITY;                                                                     \
        for (size_t n = 0; n < count; n++) {                                                                           \
            double value = (double)at[n];                                                                              \
            if (!isfinite(value)) continue;                                                                            \
            s->finite_count++;                                                                                         \
            least = value < least ? value : least;                                                                     \
            most = value > most ? value : most;                                                                        \
        }                                                                                                              \
        s->minimum = s->finite_count ? least : 0.0;                                                                    \
        s->maximum = s->finite_count ? most : 0.0;                                                                     \
    }                                                                                                                  \
    break

static void find_range(const volume *v, statistics *s) {
    size_t count = sample_count(v);
    switch (v->type) {
    case TC_U8:
        RANGE_OF_INTEGERS(uint8_t);
    case TC_I8:
        RANGE_OF_INTEGERS(int8_t);
    case TC_U16:
        RANGE_OF_INTEGERS(uint16_t);
    case TC_I16:
        RANGE_OF_INTEGERS(int16_t);
    case TC_U32:
        RANGE_OF_INTEGERS(uint32_t);
    case TC_I32:
        RANGE_OF_INTEGERS(int32_t);
    case TC_F32:
        RANGE_OF_REALS(float);
    case TC_F64:
        RANGE_OF_REALS(double);
    }
    s->nonfinite_count = count - s->finite_count;
}

static void choose_bins(const volume *v, statistics *s) {
    if (!s->finite_count) return;
    if (v->type != TC_F32 && v->type != TC_F64) {
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
    double place = s->width > 0.0 ? (0.5 * value - 0.5 * s->low) / s->width * 2.0 : 0.0;
    int bin = place < 0.0 ? 0 : place >= s->bin_count ? s->bin_count - 1 : (int)place;
    s->bins[bin]++;
}

#define COUNT_SAMPLES(c_type)                                                                                          \
    for (size_t n = 0; n < count; n++)                                                                                 \
        if (isfinite((double)((const c_type *)v->samples)[n]))                                                         \
            count_sample(s, (double)((const c_type *)v->samples)[n]);                                                  \
    break

static void fill_bins(const volume *v, statistics *s) {
    size_t count = s->finite_count ? sample_count(v) : 0;
    switch (v->type) {
    case TC_U8:
        COUNT_SAMPLES(uint8_t);
    case TC_I8:
        COUNT_SAMPLES(int8_t);
    case TC_U16:
        COUNT_SAMPLES(uint16_t);
    case TC_I16:
        COUNT_SAMPLES(int16_t);
    case TC_U32:
        COUNT_SAMPLES(uint32_t);
    case TC_I32:
        COUNT_SAMPLES(int32_t);
    case TC_F32:
        COUNT_SAMPLES(float);
    case TC_F64:
        COUNT_SAMPLES(double);
    }
}

void statistics_of(const volume *v, statistics *out) {
    memset(out, 0, sizeof *out);
    find_range(v, out);
    choose_bins(v, out);
    fill_bins(v, out);
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
