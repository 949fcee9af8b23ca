#include "tetrahedra_measure.h"

#include "exit_status.h"
#include "failure.h"
#include "parallel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK = 1 << 14 };

/* Edges from the first point; false where the tetrahedron does not count. */
static int edges_take(const tetrahedra_view *t, uint64_t n, double d[3][3]) {
    const uint32_t *v = t->tetrahedra + 4 * n;
    for (int m = 0; m < 4; m++)
        if (v[m] >= t->point_count) return 0;
    const float *p = t->points + 3 * (uint64_t)v[0];
    double sum = 0;
    for (int m = 0; m < 3; m++) {
        const float *q = t->points + 3 * (uint64_t)v[m + 1];
        for (int axis = 0; axis < 3; axis++) {
            d[m][axis] = (double)q[axis] - (double)p[axis];
            sum += d[m][axis];
        }
    }
    return isfinite(sum);
}

static void cross(const double u[3], const double v[3], double out[3]) {
    for (int n = 0; n < 3; n++) out[n] = u[(n + 1) % 3] * v[(n + 2) % 3] - u[(n + 2) % 3] * v[(n + 1) % 3];
}

static double dot(const double u[3], const double v[3]) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; }

/* ------------------------------------------------------------------------------------------------------- integrals */

typedef struct integration {
    const tetrahedra_view *t;
    const float *values;
    int components;
    double *sums; /* of each chunk: six times the volume, 24 times the integral of each component */
    uint64_t chunk_count, next_chunk;
} integration;

static void chunk_integrate(const integration *i, uint64_t chunk) {
    const uint64_t first = chunk * CHUNK;
    const uint64_t end = first + CHUNK < i->t->tetrahedron_count ? first + CHUNK : i->t->tetrahedron_count;
    double *sums = i->sums + chunk * ((uint64_t)i->components + 1);
    for (uint64_t n = first; n < end; n++) {
        double d[3][3], normal[3];
        if (!edges_take(i->t, n, d)) continue;
        cross(d[0], d[1], normal);
        const double volume = dot(normal, d[2]);
        sums[0] += volume;
        for (int c = 0; c < i->components; c++) {
            double sum = 0;
            for (int m = 0; m < 4; m++)
                sum += (double)i->values[(uint64_t)i->components * i->t->tetrahedra[4 * n + (uint64_t)m] + (uint64_t)c];
            sums[c + 1] += volume * sum;
        }
    }
}

static void chunks_integrate(void *shared) {
    integration *i = shared;
    uint64_t chunk;
    while ((chunk = __atomic_fetch_add(&i->next_chunk, 1, __ATOMIC_RELAXED)) < i->chunk_count)
        chunk_integrate(i, chunk);
}

int tetrahedra_integrate(const tetrahedra_view *t, const float *values, int components, double *volume,
                         double *integrals) {
    integration i = {.t = t, .values = values, .components = integrals ? components : 0};
    const uint64_t width = (uint64_t)i.components + 1;
    i.chunk_count = (t->tetrahedron_count + CHUNK - 1) / CHUNK;
    i.sums = calloc((size_t)(i.chunk_count * width + 1), sizeof *i.sums);
    *volume = 0;
    for (int c = 0; c < i.components; c++) integrals[c] = 0;
    if (!i.sums) return fail(STATUS_FAILED, "no memory for sums over tetrahedra");
    parallel_run(i.chunk_count, chunks_integrate, &i);
    for (uint64_t n = 0; n < i.chunk_count; n++) {
        *volume += i.sums[n * width] / 6;
        for (int c = 0; c < i.components; c++) integrals[c] += i.sums[n * width + (uint64_t)c + 1] / 24;
    }
    free(i.sums);
    return 0;
}

/* ---------------------------------------------------------------------------------------------------------- shapes */

typedef struct inspection {
    const tetrahedra_view *t;
    tetrahedra_shapes *sum;
    uint64_t next_chunk;
    int lock;
} inspection;

/* Degrees; of the four faces' normals, which point outward, or all inward. */
static double least_dihedral(double normals[4][3], const double lengths[4]) {
    double most = -1; /* cosine of the angle between the planes */
    for (int a = 0; a < 4; a++)
        for (int b = 0; b < a; b++) most = fmax(most, -dot(normals[a], normals[b]) / (lengths[a] * lengths[b]));
    return acos(fmin(most, 1)) * (180 / 3.14159265358979323846);
}

static void shape_add(double d[3][3], tetrahedra_shapes *sum) {
    static const double flat = 0x1p-20;
    double normals[4][3], lengths[4], sides[6][3], longest = 0, largest = 0;
    for (int n = 0; n < 3; n++) {
        memcpy(sides[n], d[n], sizeof sides[n]);
        for (int axis = 0; axis < 3; axis++) sides[3 + n][axis] = d[(n + 1) % 3][axis] - d[n][axis];
    }
    for (int n = 0; n < 6; n++) longest = fmax(longest, sqrt(dot(sides[n], sides[n])));
    for (int n = 0; n < 3; n++) cross(d[(n + 1) % 3], d[n], normals[n]); /* outward of a positive tetrahedron */
    cross(sides[3], sides[4], normals[3]);
    const double volume = -dot(normals[0], d[2]); /* six times it */
    for (int n = 0; n < 4; n++) {
        lengths[n] = sqrt(dot(normals[n], normals[n]));
        largest = fmax(largest, lengths[n]);
    }
    if (!(fabs(volume) > flat * longest * largest)) {
        sum->flat++;
        return;
    }
    const double angle = least_dihedral(normals, lengths);
    const int tenth = (int)(10 * angle);
    if (!sum->count || angle < sum->least) sum->least = angle;
    sum->count++;
    sum->inverted += volume < 0;
    sum->below_5 += angle < 5, sum->below_10 += angle < 10;
    sum->by_tenth[tenth < DIHEDRAL_TENTHS ? tenth : DIHEDRAL_TENTHS - 1]++;
}

static void shapes_join(const tetrahedra_shapes *from, tetrahedra_shapes *sum) {
    if (from->count && (!sum->count || from->least < sum->least)) sum->least = from->least;
    sum->flat += from->flat, sum->inverted += from->inverted, sum->count += from->count;
    sum->below_5 += from->below_5, sum->below_10 += from->below_10;
    for (int n = 0; n < DIHEDRAL_TENTHS; n++) sum->by_tenth[n] += from->by_tenth[n];
}

static void chunks_inspect(void *shared) {
    inspection *i = shared;
    tetrahedra_shapes own = {0};
    uint64_t first;
    double d[3][3];
    while ((first = __atomic_fetch_add(&i->next_chunk, 1, __ATOMIC_RELAXED) * CHUNK) < i->t->tetrahedron_count)
        for (uint64_t n = first; n < first + CHUNK && n < i->t->tetrahedron_count; n++)
            if (edges_take(i->t, n, d)) shape_add(d, &own);
    while (__atomic_exchange_n(&i->lock, 1, __ATOMIC_ACQUIRE)) continue;
    shapes_join(&own, i->sum);
    __atomic_store_n(&i->lock, 0, __ATOMIC_RELEASE);
}

void tetrahedra_shapes_add(const tetrahedra_view *t, tetrahedra_shapes *sum) {
    inspection i = {.t = t, .sum = sum};
    parallel_run((t->tetrahedron_count + CHUNK - 1) / CHUNK, chunks_inspect, &i);
}

double tetrahedra_shapes_median(const tetrahedra_shapes *shapes) {
    uint64_t before = 0;
    for (int n = 0; n < DIHEDRAL_TENTHS; n++) {
        before += shapes->by_tenth[n];
        if (2 * before >= shapes->count && shapes->count) return n / 10.0;
    }
    return 0;
}
