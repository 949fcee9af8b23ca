/*
 * field.c - the analytic fields, each as a row of doubles along x, converted to the sample type
 *
 * Method: a volume is filled in columns of up to BLOCK samples along x. What depends on x alone is tabled once per
 * column of the volume, what depends on x and y once per (column, y); the row itself is then a few vectorisable
 * operations per sample. All tables live on the stack, nothing can fail.
 *
 * Invariant: the same samples on every machine. Only +, -, *, / and sqrt of IEEE doubles are used (the build forbids
 * contraction); sine and cosine are made of these too, since the C library's differ in the last bit from one machine
 * to the next.
 *
 * Sources: Marschner and Lobb, "An evaluation of reconstruction filters for volume rendering" (1994); Steele, Lea and
 * Flood, "Fast splittable pseudorandom number generators" (2014) for splitmix64.
 */
#include "field.h"

#include "sample_types.h"

#include <math.h>
#include <string.h>

#define BLOCK      256
#define FULL_RANGE 255.0
#define GYROID_K   3.0 /* times pi */

#define TORUS_RADIUS 0.6

#define LOBB_ALPHA     0.25
#define LOBB_FREQUENCY 6.0

#define TANGLE_SCALE  2.5
#define TANGLE_OFFSET 11.8
#define TANGLE_DEPTH  6.95 /* 3 * 6.25 - TANGLE_OFFSET: the depth of the polynomial's minima below zero */

#define SPLITMIX_STEP 0x9e3779b97f4a7c15u

/* One run of samples along x, at one y, with what the field keeps between rows. */
typedef struct block {
    int count;
    double x[BLOCK];
    double y;
    double a[BLOCK], b[BLOCK]; /* the field's own tables */
    uint64_t seed, index;      /* of the row's first sample in the whole grid */
} block;

/* How one field fills a row. Each may be NULL but row. */
typedef struct recipe {
    void (*of_x)(block *b);  /* tables that depend on x */
    void (*of_xy)(block *b); /* tables that depend on x and y */
    void (*row)(const block *b, double z, double *out);
} recipe;

/* sin(pi t) for |t| <= 1/4: Taylor's series, whose first term left out is below 1e-19. */
static double sin_pi_near_zero(double t) {
    double u = t * 3.141592653589793, s = u * u;
    double p = 1.0 - s / 342.0;
    for (int n = 16; n >= 2; n -= 2) p = 1.0 - s / (double)(n * (n + 1)) * p;
    return u * p;
}

/* cos(pi t) for |t| <= 1/4, likewise. */
static double cos_pi_near_zero(double t) {
    double u = t * 3.141592653589793, s = u * u;
    double p = 1.0 - s / 306.0;
    for (int n = 15; n >= 1; n -= 2) p = 1.0 - s / (double)(n * (n + 1)) * p;
    return p;
}

/* sin(pi t); the reduction to the nearest half turn is exact. */
static double sin_pi(double t) {
    double halves = floor(2.0 * t + 0.5), rest = t - 0.5 * halves;
    switch ((int)(halves - 4.0 * floor(halves / 4.0))) {
    case 0:
        return sin_pi_near_zero(rest);
    case 1:
        return cos_pi_near_zero(rest);
    case 2:
        return -sin_pi_near_zero(rest);
    default:
        return -cos_pi_near_zero(rest);
    }
}

static double cos_pi(double t) { return sin_pi(t + 0.5); }

static double clip(double value) { return value < 0.0 ? 0.0 : value > FULL_RANGE ? FULL_RANGE : value; }

/* ---------------------------------------------------------------------------------------------------------- fields */

static void sphere_row(const block *b, double z, double *out) {
    double yz = b->y * b->y + z * z;
    for (int i = 0; i < b->count; i++) out[i] = clip(FULL_RANGE * (1.0 - 0.75 * sqrt(b->x[i] * b->x[i] + yz)));
}

/* a: squared distance, within the plane z = 0, from the circle. */
static void torus_of_xy(block *b) {
    for (int i = 0; i < b->count; i++) {
        double inward = sqrt(b->x[i] * b->x[i] + b->y * b->y) - TORUS_RADIUS;
        b->a[i] = inward * inward;
    }
}

static void torus_row(const block *b, double z, double *out) {
    for (int i = 0; i < b->count; i++) out[i] = clip(FULL_RANGE * (1.0 - sqrt(b->a[i] + z * z) / TORUS_RADIUS));
}

/* a: sin kx, b: cos kx. */
static void gyroid_of_x(block *b) {
    for (int i = 0; i < b->count; i++) {
        b->a[i] = sin_pi(GYROID_K * b->x[i]);
        b->b[i] = cos_pi(GYROID_K * b->x[i]);
    }
}

static void gyroid_row(const block *b, double z, double *out) {
    double cos_y = cos_pi(GYROID_K * b->y), sin_z = sin_pi(GYROID_K * z);
    double sin_y_cos_z = sin_pi(GYROID_K * b->y) * cos_pi(GYROID_K * z);
    for (int i = 0; i < b->count; i++) {
        double value = b->a[i] * cos_y + sin_y_cos_z + sin_z * b->b[i];
        out[i] = clip((value + 1.7) / 3.4 * FULL_RANGE);
    }
}

/* a: alpha (1 + rho_r). */
static void lobb_of_xy(block *b) {
    for (int i = 0; i < b->count; i++) {
        double r = sqrt(b->x[i] * b->x[i] + b->y * b->y);
        b->a[i] = LOBB_ALPHA * (1.0 + cos_pi(2.0 * LOBB_FREQUENCY * cos_pi(0.5 * r)));
    }
}

static void lobb_row(const block *b, double z, double *out) {
    double along_z = 1.0 - sin_pi(0.5 * z);
    for (int i = 0; i < b->count; i++) out[i] = FULL_RANGE * ((along_z + b->a[i]) / (2.0 * (1.0 + LOBB_ALPHA)));
}

static double tangle_of(double coordinate) {
    double s = TANGLE_SCALE * coordinate * (TANGLE_SCALE * coordinate);
    return s * s - 5.0 * s;
}

static void tangle_of_x(block *b) {
    for (int i = 0; i < b->count; i++) b->a[i] = tangle_of(b->x[i]);
}

static void tangle_row(const block *b, double z, double *out) {
    double rest = tangle_of(b->y) + tangle_of(z) + TANGLE_OFFSET;
    for (int i = 0; i < b->count; i++) out[i] = clip(0.5 * FULL_RANGE * (1.0 - (b->a[i] + rest) / TANGLE_DEPTH));
}

/* Output number `index` of splitmix64 from `seed`: the upper 24 bits as a multiple of 2^-16, exact in every type. */
static void noise_row(const block *b, double z, double *out) {
    (void)z;
    for (int i = 0; i < b->count; i++) {
        uint64_t h = b->seed + (b->index + (uint64_t)i + 1) * SPLITMIX_STEP;
        h = (h ^ h >> 30) * 0xbf58476d1ce4e5b9u;
        h = (h ^ h >> 27) * 0x94d049bb133111ebu;
        h ^= h >> 31;
        out[i] = (double)(h >> 40) / 65536.0;
    }
}

static void empty_row(const block *b, double z, double *out) {
    (void)z;
    for (int i = 0; i < b->count; i++) out[i] = 0.0;
}

static void full_row(const block *b, double z, double *out) {
    (void)z;
    for (int i = 0; i < b->count; i++) out[i] = FULL_RANGE;
}

const field fields[] = {
    {"sphere", "255 (1 - 0.75 r), clipped at 0; r the distance from the centre", 127.5},
    {"torus", "255 (1 - d / 0.6), clipped at 0; d the distance from the circle of radius 0.6 in the plane z = 0",
     127.5},
    {"gyroid", "255 (sin kx cos ky + sin ky cos kz + sin kz cos kx + 1.7) / 3.4, k = 3 pi, clipped to 0..255", 127.5},
    {"marschner-lobb",
     "255 (1 - sin(pi z / 2) + a (1 + cos(2 pi f cos(pi r / 2)))) / (2 (1 + a)), a = 0.25, f = 6, r^2 = x^2 + y^2",
     127.5},
    {"tangle",
     "127.5 (1 - t / 6.95), clipped to 0..255; t the sum of s^4 - 5 s^2 over s = 2.5 x, 2.5 y, 2.5 z, plus 11.8",
     127.5},
    {"noise", "uniform in 0 <= v < 256, in steps of 2^-16: sample n is output n of splitmix64 seeded with --seed",
     127.5},
    {"empty", "0 everywhere: no surface", 127.5},
    {"full", "255 everywhere: no surface", 127.5},
    {NULL, NULL, 0.0},
};

/* In the order of `fields`. */
static const recipe recipes[] = {
    {NULL, NULL, sphere_row},     {NULL, torus_of_xy, torus_row},  {gyroid_of_x, NULL, gyroid_row},
    {NULL, lobb_of_xy, lobb_row}, {tangle_of_x, NULL, tangle_row}, {NULL, NULL, noise_row},
    {NULL, NULL, empty_row},      {NULL, NULL, full_row},
};

const field *field_find(const char *name) {
    for (const field *f = fields; f->name; f++)
        if (strcmp(f->name, name) == 0) return f;
    return NULL;
}

/* -------------------------------------------------------------------------------------------------------- sampling */

static double coordinate(int64_t i, int64_t n) { return n > 1 ? 2.0 * (double)i / (double)(n - 1) - 1.0 : 0.0; }

static void store(const double *row, int count, tc_type type, void *out) {
    switch (type) {
/* Conversion in C truncates toward zero; what the type cannot hold saturates first. */
#define STORE_CASE(type, name, c_type, least, most, ...)                                                               \
    case type:                                                                                                         \
        for (int i = 0; i < count; i++)                                                                                \
            ((c_type *)out)[i] = (c_type)(row[i] < (double)(least)  ? (double)(least)                                  \
                                          : row[i] > (double)(most) ? (double)(most)                                   \
                                                                    : row[i]);                                         \
        break;
        INTEGER_TYPES(STORE_CASE)
#undef STORE_CASE
    case TC_F32:
        for (int i = 0; i < count; i++) ((float *)out)[i] = (float)row[i];
        break;
    case TC_F64:
        memcpy(out, row, (size_t)count * sizeof *row);
        break;
    }
}

void field_sample(const field *f, const int64_t dims[3], tc_type type, uint64_t seed, int64_t z0, int64_t z1,
                  void *samples) {
    const recipe *make = &recipes[f - fields];
    const size_t bytes = sample_bytes(type);
    block b = {.seed = seed};
    double row[BLOCK];
    for (int64_t x0 = 0; x0 < dims[0]; x0 += BLOCK) {
        b.count = (int)(dims[0] - x0 < BLOCK ? dims[0] - x0 : BLOCK);
        for (int i = 0; i < b.count; i++) b.x[i] = coordinate(x0 + i, dims[0]);
        if (make->of_x) make->of_x(&b);
        for (int64_t j = 0; j < dims[1]; j++) {
            b.y = coordinate(j, dims[1]);
            if (make->of_xy) make->of_xy(&b);
            for (int64_t k = z0; k < z1; k++) {
                b.index = (uint64_t)((k * dims[1] + j) * dims[0] + x0);
                make->row(&b, coordinate(k, dims[2]), row);
                uint64_t at = b.index - (uint64_t)(z0 * dims[1] * dims[0]);
                store(row, b.count, type, (char *)samples + at * bytes);
            }
        }
    }
}
