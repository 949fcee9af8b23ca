#include "samples.h"

#include "complexes.h"
#include "exit_status.h"
#include "failure.h"
#include "progress.h"
#include "read.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <sys/mman.h>

#define CHUNK_BYTES ((uint64_t)4 << 20) /* made between two looks at progress */

int samples_describe(const field *f, const int64_t dims[3], tc_type type, samples *out) {
    *out = (samples){.made_from = f, .name = f->name};
    tc_grid_options_init(&out->grid);
    uint64_t plane = (uint64_t)dims[0] * (uint64_t)dims[1] * tc_type_bytes(type);
    if (__builtin_mul_overflow(plane, (uint64_t)dims[2], &out->bytes) || out->bytes > PTRDIFF_MAX)
        return fail(STATUS_USAGE, "--dims %" PRId64 ",%" PRId64 ",%" PRId64 " are more bytes than memory can have",
                    dims[0], dims[1], dims[2]);
    out->grid.type = type;
    for (int axis = 0; axis < 3; axis++) {
        out->grid.dims[axis] = dims[axis];
        out->grid.matrix[axis][axis] = 2.0 / (double)(dims[axis] - 1);
        out->grid.matrix[axis][3] = -1.0;
    }
    return 0;
}

void samples_place(samples *s, bench_grid grid) {
    const uint64_t x = (uint64_t)s->grid.dims[0], y = (uint64_t)s->grid.dims[1], z = (uint64_t)s->grid.dims[2];
    if (s->grid.axes[0] || s->grid.points) return;
    s->placed = grid;
    s->coordinate_bytes = grid >= BENCH_CURVILINEAR ? 12 * x * y * z : grid == BENCH_RECTILINEAR ? 4 * (x + y + z) : 0;
}

/* The uniform position of sample n of an axis, and the step that it is moved by. */
static double axis_position(int64_t n, int64_t count) { return 2.0 * (double)n / (double)(count - 1) - 1.0; }

static double axis_step(double position) { return 0.05 * sin(3.0 * position); }

static void axes_make(samples *s) {
    float *at = s->coordinates;
    for (int axis = 0; axis < 3; axis++) {
        s->grid.axes[axis] = at;
        for (int64_t n = 0; n < s->grid.dims[axis]; n++) {
            double position = axis_position(n, s->grid.dims[axis]);
            *at++ = (float)(position + axis_step(position));
        }
    }
}

/* x moves with y, y with z, z with x. */
static int points_make(samples *s) {
    const int64_t *dims = s->grid.dims;
    float *at = s->coordinates;
    for (int64_t k = 0; k < dims[2]; k++) {
        double z = axis_position(k, dims[2]), y_step = axis_step(z);
        for (int64_t j = 0; j < dims[1]; j++) {
            double y = axis_position(j, dims[1]), x_step = axis_step(y);
            for (int64_t i = 0; i < dims[0]; i++) {
                double x = axis_position(i, dims[0]);
                *at++ = (float)(x + x_step);
                *at++ = (float)(y + y_step);
                *at++ = (float)(z + axis_step(x));
            }
        }
        if (progress_update(NULL, "making points", (double)(k + 1) / (double)dims[2])) return progress_status();
    }
    s->grid.points = s->coordinates;
    return 0;
}

int memory_make(uint64_t bytes, const char *what, void **out) {
    void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED)
        return fail(STATUS_FAILED, "no %" PRIu64 " MB of memory for the %s; give smaller --dims", bytes >> 20, what);
    madvise(memory, bytes, MADV_HUGEPAGE);
    *out = memory;
    return 0;
}

static int coordinates_make(samples *s) {
    void *memory = NULL;
    if (!s->coordinate_bytes) return 0;
    int status = memory_make(s->coordinate_bytes, "points", &memory);
    if (status) return status;
    s->coordinates = memory;
    if (s->placed >= BENCH_CURVILINEAR) return points_make(s);
    axes_make(s);
    return 0;
}

static int values_make(samples *s) {
    void *memory = NULL;
    int status = memory_make(s->bytes, "samples", &memory);
    if (status) return status;
    s->made = memory;
    s->grid.samples = memory;
    const int64_t *dims = s->grid.dims;
    uint64_t plane = s->bytes / (uint64_t)dims[2];
    int64_t step = plane < CHUNK_BYTES ? (int64_t)(CHUNK_BYTES / plane) : 1;
    for (int64_t z = 0; z < dims[2]; z += step) {
        int64_t end = dims[2] - z < step ? dims[2] : z + step;
        field_sample(s->made_from, dims, s->grid.type, 0, z, end, (char *)memory + (uint64_t)z * plane);
        if (progress_update(NULL, "making samples", (double)end / (double)dims[2])) return progress_status();
    }
    return 0;
}

int samples_make(samples *s) {
    int status = coordinates_make(s);
    if (!status && s->made_from) status = values_make(s);
    return status || s->placed < BENCH_TETRAHEDRA ? status : complex_make(s);
}

int samples_read(const bench_options *o, samples *out) {
    read_request request;
    *out = (samples){.name = o->input};
    if (strrchr(o->input, '/')) out->name = strrchr(o->input, '/') + 1;
    read_request_init(&request, o->input);
    if (o->dims_count) {
        memcpy(request.dims, o->dims[0], sizeof request.dims);
        request.type = (int)o->types[0];
    }
    int status = dataset_read(&request, &out->read);
    if (status) return status;
    if (!out->read.frames)
        return fail(STATUS_INPUT, "%s: is no image; of images this program reads raw, NRRD, MetaImage and NIfTI",
                    o->input);
    const dataset_block *b = out->read.blocks;
    tc_grid_options_init(&out->grid);
    memcpy(out->grid.dims, b->dims, sizeof b->dims);
    memcpy(out->grid.first_index, b->first, sizeof b->first);
    memcpy(out->grid.matrix, b->matrix, sizeof b->matrix);
    out->grid.type = b->fields->type;
    out->grid.samples = b->fields->values;
    out->bytes = (uint64_t)b->point_count * tc_type_bytes(b->fields->type);
    return 0;
}

int samples_dump(const samples *s, const char *path) {
    FILE *file = fopen(path, "wb");
    if (!file) return fail(STATUS_FAILED, "--dump %s: cannot be written: %s", path, strerror(errno));
    int failed = fwrite(s->grid.samples, 1, s->bytes, file) != s->bytes;
    int error = errno;
    if (fclose(file) && !failed) failed = 1, error = errno;
    if (!failed) return 0;
    remove(path);
    return fail(STATUS_FAILED, "--dump %s: writing failed: %s", path, strerror(error));
}

void samples_release(samples *s) {
    if (s->made) munmap(s->made, s->bytes);
    if (s->coordinates) munmap(s->coordinates, s->coordinate_bytes);
    complex_release(s);
    dataset_release(&s->read);
    *s = (samples){0};
}
