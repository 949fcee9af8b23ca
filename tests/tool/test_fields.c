/*
 * test_fields.c - the analytic fields against their definitions, written out again here with the C library's functions
 *
 * Proves: values at every sample (a tolerance in f64, exact truncation and saturation in the others), planes made
 * piecewise equal planes made at once, noise by its published generator, names found.
 */
#include "expect.h"
#include "field.h"
#include "random.h"
#include "samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

static double clip(double v) { return fmin(fmax(v, 0.0), 255.0); }

static double sphere(double x, double y, double z) { return clip(255 * (1 - 0.75 * sqrt(x * x + y * y + z * z))); }

static double torus(double x, double y, double z) { return clip(255 * (1 - hypot(hypot(x, y) - 0.6, z) / 0.6)); }

static double gyroid(double x, double y, double z) {
    double k = 3 * PI;
    return clip((sin(k * x) * cos(k * y) + sin(k * y) * cos(k * z) + sin(k * z) * cos(k * x) + 1.7) / 3.4 * 255);
}

static double marschner_lobb(double x, double y, double z) {
    double rho_r = cos(2 * PI * 6 * cos(PI * hypot(x, y) / 2));
    return 255 * (1 - sin(PI * z / 2) + 0.25 * (1 + rho_r)) / (2 * (1 + 0.25));
}

static double quartic(double v) { return pow(2.5 * v, 4) - 5 * pow(2.5 * v, 2); }

static double tangle(double x, double y, double z) {
    return clip(127.5 * (1 - (quartic(x) + quartic(y) + quartic(z) + 11.8) / 6.95));
}

static double empty(double x, double y, double z) { return 0 * (x + y + z); }

static double full(double x, double y, double z) { return 255 + 0 * (x + y + z); }

static const struct formula {
    const char *name;
    double (*value)(double x, double y, double z);
} formulas[] = {{"sphere", sphere}, {"torus", torus}, {"gyroid", gyroid}, {"marschner-lobb", marschner_lobb},
                {"tangle", tangle}, {"empty", empty}, {"full", full}};

#define FORMULA_COUNT (int)(sizeof formulas / sizeof *formulas)

static const int64_t dims[3] = {301, 9, 7}; /* more than one block of the implementation along x */
#define SAMPLE_COUNT (301 * 9 * 7)

static const size_t type_bytes[] = {1, 1, 2, 2, 4, 4, 4, 8};

static void values_follow_the_definition(const struct formula *formula) {
    static double got[SAMPLE_COUNT];
    const field *f = field_find(formula->name);
    EXPECT(f != NULL, "no field %s", formula->name);
    if (!f) return;
    field_sample(f, dims, TC_F64, 0, 0, dims[2], got);
    double worst = 0;
    for (int k = 0, n = 0; k < dims[2]; k++)
        for (int j = 0; j < dims[1]; j++)
            for (int i = 0; i < dims[0]; i++, n++) {
                double want = formula->value(2.0 * i / 300 - 1, 2.0 * j / 8 - 1, 2.0 * k / 6 - 1);
                worst = fmax(worst, fabs(got[n] - want));
                EXPECT(got[n] >= 0 && got[n] <= 255, "%s at %d %d %d: %g", f->name, i, j, k, got[n]);
            }
    EXPECT(worst < 1e-10, "%s differs from its definition by %g", f->name, worst);
}

/* What an f64 sample becomes in the type, as a double. */
static double converted(double value, tc_type type) {
    static const double low[] = {0, -128, 0, -32768, 0, -2147483648.0};
    static const double high[] = {255, 127, 65535, 32767, 4294967295.0, 2147483647.0};
    if (type == TC_F32) return (double)(float)value;
    if (type == TC_F64) return value;
    return fmin(fmax(trunc(value), low[type]), high[type]);
}

static void types_truncate_and_saturate(const field *f) {
    static double exact[SAMPLE_COUNT], typed[SAMPLE_COUNT];
    field_sample(f, dims, TC_F64, 7, 0, dims[2], exact);
    for (int type = TC_U8; type <= TC_F64; type++) {
        field_sample(f, dims, (tc_type)type, 7, 0, dims[2], typed);
        size_t wrong = 0;
        for (size_t n = 0; n < SAMPLE_COUNT; n++)
            wrong += sample_get(typed, (tc_type)type, (int64_t)n) != converted(exact[n], (tc_type)type);
        EXPECT(wrong == 0, "%s, type %d: %zu samples wrong", f->name, type, wrong);
    }
}

static void planes_fit_together(const field *f) {
    static unsigned char whole[SAMPLE_COUNT * 8], pieces[SAMPLE_COUNT * 8];
    static const int cuts[] = {0, 1, 3, 7};
    size_t plane = (size_t)(dims[0] * dims[1]);
    for (int type = TC_U8; type <= TC_F64; type++) {
        memset(pieces, 0xa5, sizeof pieces);
        field_sample(f, dims, (tc_type)type, 3, 0, dims[2], whole);
        for (int c = 0; c < 3; c++)
            field_sample(f, dims, (tc_type)type, 3, cuts[c], cuts[c + 1],
                         pieces + (size_t)cuts[c] * plane * type_bytes[type]);
        EXPECT(memcmp(whole, pieces, SAMPLE_COUNT * type_bytes[type]) == 0, "%s, type %d: planes differ", f->name,
               type);
        for (size_t n = SAMPLE_COUNT * type_bytes[type]; n < sizeof pieces; n++)
            EXPECT(pieces[n] == 0xa5, "%s, type %d: wrote beyond the samples", f->name, type);
    }
}

/* The generator in its usual, sequential form. */
static void noise_is_splitmix64(uint64_t seed) {
    static double got[SAMPLE_COUNT];
    random_state = seed;
    field_sample(field_find("noise"), dims, TC_F64, seed, 0, dims[2], got);
    size_t wrong = 0, histogram[256] = {0};
    for (size_t n = 0; n < SAMPLE_COUNT; n++) {
        double want = (double)(random_u64() >> 40) / 65536.0;
        wrong += got[n] != want || want != (double)(float)want;
        histogram[(int)got[n] & 255]++;
    }
    EXPECT(wrong == 0, "noise of seed %llu: %zu samples wrong", (unsigned long long)seed, wrong);
    for (int v = 0; v < 256; v++)
        EXPECT(histogram[v] > 30 && histogram[v] < 130, "noise: %d occurs %zu times, 74 expected", v, histogram[v]);
}

/* splitmix64 of seed 1234567: the first output as published with the generator's reference code. */
static void noise_starts_as_published(void) {
    double first;
    const int64_t one[3] = {1, 1, 1};
    field_sample(field_find("noise"), one, TC_F64, 1234567, 0, 1, &first);
    EXPECT(first == (double)(6457827717110365317u >> 40) / 65536.0, "first noise sample is %.17g", first);
}

static void sensible_isovalues_cut(const field *f) {
    static double got[SAMPLE_COUNT];
    field_sample(f, dims, TC_F64, 1, 0, dims[2], got);
    int below = 0, above = 0;
    for (size_t n = 0; n < SAMPLE_COUNT; n++) *(got[n] >= f->isovalue ? &above : &below) += 1;
    int uniform = strcmp(f->name, "empty") == 0 || strcmp(f->name, "full") == 0;
    EXPECT((below && above) != uniform, "%s: %d samples below, %d above %g", f->name, below, above, f->isovalue);
}

int main(void) {
    for (int n = 0; n < FORMULA_COUNT; n++) values_follow_the_definition(&formulas[n]);
    int count = 0;
    for (const field *f = fields; f->name; f++, count++) {
        EXPECT(field_find(f->name) == f, "%s is not found by its name", f->name);
        EXPECT(f->definition && *f->definition, "%s has no definition", f->name);
        types_truncate_and_saturate(f);
        planes_fit_together(f);
        sensible_isovalues_cut(f);
    }
    EXPECT(count == FORMULA_COUNT + 1, "%d fields, of which %d are tested", count, FORMULA_COUNT + 1);
    EXPECT(field_find("sphere ") == NULL && field_find("") == NULL, "found a field that is none");
    noise_is_splitmix64(0);
    noise_is_splitmix64(UINT64_MAX);
    noise_starts_as_published();
    return EXPECT_DONE();
}
