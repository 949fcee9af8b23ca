/* layout.c - takes one scalar volume out of a stored array; see layout.h */
#include "dataset/layout.h"

#include "exit_status.h"
#include "failure.h"

#include <inttypes.h>
#include <string.h>

/* The index along an axis of frames or components that the request chooses; 0 where it may leave that open. */
static int choose(const char *path, const axes *from, int axis, const read_request *request, uint64_t *index) {
    int is_component = from->role[axis] == AXIS_COMPONENT, wanted = is_component ? request->component : request->frame;
    const char *meaning = is_component ? from->meaning : NULL;
    int64_t size = from->size[axis];
    if (wanted < 0 && request->describe) wanted = 0;
    if (wanted >= 0 && wanted < size) {
        *index = (uint64_t)wanted;
        return 0;
    }
    return fail(STATUS_USAGE, "%s: has %" PRId64 " %s%s%s%s; choose one with %s 0 to %" PRId64 "%s", path, size,
                is_component ? "values per sample" : "frames", meaning ? " (" : "", meaning ? meaning : "",
                meaning ? ")" : "", is_component ? "--component" : "--frame", size - 1,
                is_component ? ", or their length with --component magnitude" : "");
}

/* Whether all components are taken: for their length, or to be described. */
static int are_together(const read_request *request) {
    return request->component == COMPONENT_MAGNITUDE || (request->component < 0 && request->describe);
}

/* Sizes multiplied, all checked, before any is acted on. */
static int count_elements(const char *path, const axes *from, int element, layout *out) {
    int several[3] = {0};
    for (int a = 0; a < from->count; a++) {
        if (from->size[a] < 1)
            return fail(STATUS_INPUT, "%s: says %" PRId64 " samples along axis %d; at least 1 is needed", path,
                        from->size[a], a + 1);
        if (__builtin_mul_overflow(out->count, (uint64_t)from->size[a], &out->count))
            return fail(STATUS_INPUT,
                        "%s: its sizes, of the header or --dims, multiply to more than 2^64 samples: they are wrong",
                        path);
        if (from->role[a] != AXIS_SPACE && from->size[a] > 1 && several[from->role[a]]++)
            return fail(STATUS_INPUT, "%s: has more axes than three of space, one of components and one of frames",
                        path);
    }
    if (__builtin_mul_overflow(out->count, element_bytes(element), &out->bytes) || out->bytes > INT64_MAX / 8)
        return fail(STATUS_INPUT,
                    "%s: its sizes, of the header or --dims, ask for more than 2^60 bytes: they are wrong", path);
    return 0;
}

int layout_make(const char *path, const axes *from, int element, const read_request *request, layout *out) {
    *out = (layout){.element = element, .count = 1, .dims = {1, 1, 1}, .components = 1, .frames = 1, .slope = 1};
    int status = count_elements(path, from, element, out), space = 0, chosen[3] = {0};
    uint64_t stride = 1;
    for (int a = 0; a < from->count && !status; stride *= (uint64_t)from->size[a++]) {
        uint64_t index = 0;
        if (from->role[a] == AXIS_SPACE) {
            out->dims[space] = from->size[a];
            out->stride[space++] = stride;
            continue;
        }
        if (from->size[a] == 1) continue;
        chosen[from->role[a]] = 1;
        if (from->role[a] == AXIS_FRAME && request->frame < 0) out->frames = from->size[a];
        if (from->role[a] == AXIS_COMPONENT && are_together(request) && from->size[a] <= INT32_MAX) {
            out->components = (int)from->size[a];
            out->component_stride = stride;
            continue;
        }
        status = choose(path, from, a, request, &index);
        out->offset += index * stride;
    }
    if (!status && (request->component > 0 || request->component == COMPONENT_MAGNITUDE) && !chosen[AXIS_COMPONENT])
        status = fail(STATUS_USAGE, "%s: has one value per sample; leave out --component", path);
    if (!status && request->frame > 0 && !chosen[AXIS_FRAME])
        status = fail(STATUS_USAGE, "%s: has one frame; leave out --frame", path);
    return status;
}

void layout_cut(layout *l, const sample_box *part) {
    for (int axis = 0; axis < 3; axis++) {
        l->dims[axis] = part->count[axis];
        l->offset += (uint64_t)part->first[axis] * l->stride[axis];
        l->stride[axis] *= (uint64_t)part->step[axis];
    }
}

tc_type layout_type(const layout *l) { return l->scaled ? TC_F64 : element_sample_type(l->element); }

static int64_t values_per_sample(const layout *l) { return l->components > 1 ? l->components : 1; }

int layout_is_plain(const layout *l, const unsigned char *stored) {
    size_t bytes = element_bytes(l->element);
    uint64_t values = (uint64_t)values_per_sample(l), row = values * (uint64_t)l->dims[0];
    return !l->scaled && l->element < SAMPLE_TYPE_COUNT && (!l->swapped || bytes == 1) &&
           (values == 1 || l->component_stride == 1) && (l->dims[0] == 1 || l->stride[0] == values) &&
           (l->dims[1] == 1 || l->stride[1] == row) &&
           (l->dims[2] == 1 || l->stride[2] == row * (uint64_t)l->dims[1]) && (uintptr_t)stored % bytes == 0;
}

/* Copies n elements of the given size, in this machine's byte order. */
#define COPY_ELEMENTS(type, swap)                                                                                      \
    do {                                                                                                               \
        for (int64_t i = 0; i < n; i++, from += step) {                                                                \
            type value;                                                                                                \
            memcpy(&value, from, sizeof value);                                                                        \
            value = swapped ? swap(value) : value;                                                                     \
            memcpy(to + (size_t)i * sizeof value, &value, sizeof value);                                               \
        }                                                                                                              \
    } while (0)

static void copy_elements(unsigned char *to, const unsigned char *from, int64_t n, size_t step, size_t bytes,
                          int swapped) {
    switch (bytes) {
    case 1:
        for (int64_t i = 0; i < n; i++) to[i] = from[(size_t)i * step];
        break;
    case 2:
        COPY_ELEMENTS(uint16_t, __builtin_bswap16);
        break;
    case 4:
        COPY_ELEMENTS(uint32_t, __builtin_bswap32);
        break;
    default:
        COPY_ELEMENTS(uint64_t, __builtin_bswap64);
        break;
    }
}

#define SWAP_NEIGHBOURS(type, swap)                                                                                    \
    for (int64_t i = 0; i < n; i++) {                                                                                  \
        type value;                                                                                                    \
        memcpy(&value, from + (size_t)i * sizeof value, sizeof value);                                                 \
        value = swap(value);                                                                                           \
        memcpy(to + (size_t)i * sizeof value, &value, sizeof value);                                                   \
    }                                                                                                                  \
    break

/* Contiguous elements of 2, 4 or 8 bytes in the other byte order: as the step is constant, the compiler makes vector
 * code. */
static void swap_neighbours(unsigned char *to, const unsigned char *from, int64_t n, size_t bytes) {
    switch (bytes) {
    case 2:
        SWAP_NEIGHBOURS(uint16_t, __builtin_bswap16);
    case 4:
        SWAP_NEIGHBOURS(uint32_t, __builtin_bswap32);
    default:
        SWAP_NEIGHBOURS(uint64_t, __builtin_bswap64);
    }
}

static void copy_row(unsigned char *to, const unsigned char *from, int64_t n, size_t step, size_t bytes, int swapped) {
    if (step != bytes)
        copy_elements(to, from, n, step, bytes, swapped);
    else if (swapped && bytes > 1)
        swap_neighbours(to, from, n, bytes);
    else
        memcpy(to, from, (size_t)n * bytes);
}

/* The element as a double; *exact is cleared where a 64-bit integer has none. */
static double element_value(const unsigned char *from, int element, int swapped, int *exact) {
    union {
#define MEMBER(element, name, c_type, ...) c_type name;
        STORED_TYPES(MEMBER)
#undef MEMBER
        unsigned char bytes[8];
    } v;
    size_t bytes = element_bytes(element);
    copy_elements(v.bytes, from, 1, bytes, bytes, swapped);
    double value;
    switch (element) {
#define VALUE_CASE(type, name, ...)                                                                                    \
    case type:                                                                                                         \
        return (double)v.name;
        SAMPLE_TYPES(VALUE_CASE)
#undef VALUE_CASE
    case ELEMENT_I64: /* 2^63 itself, to which large values round, would overflow on the way back */
        value = (double)v.i64;
        if (value >= 0x1p63 || (int64_t)value != v.i64) *exact = 0;
        return value;
    default:
        value = (double)v.u64;
        if (value >= 0x1p64 || (uint64_t)value != v.u64) *exact = 0;
        return value;
    }
}

static int convert_elements(double *to, const unsigned char *from, int64_t n, size_t step, const layout *l) {
    int exact = 1;
    for (int64_t i = 0; i < n; i++, from += step) {
        double value = element_value(from, l->element, l->swapped, &exact);
        to[i] = l->scaled ? l->slope * value + l->intercept : value;
    }
    return exact;
}

/* n elements, each `step` elements behind the one before. Returns 0 where one has no exact double. */
static int take_run(const layout *l, unsigned char *to, const unsigned char *from, int64_t n, uint64_t step) {
    size_t bytes = element_bytes(l->element);
    if (l->scaled || l->element >= SAMPLE_TYPE_COUNT)
        return convert_elements((double *)(void *)to, from, n, (size_t)step * bytes, l);
    copy_row(to, from, n, (size_t)step * bytes, bytes, l->swapped);
    return 1;
}

/* A row of samples: one run where they have one value, or their values lie side by side; else a run for each sample. */
static int take_row(const layout *l, unsigned char *to, const unsigned char *from) {
    int64_t values = values_per_sample(l);
    size_t bytes = element_bytes(l->element), sample = (size_t)values * sample_bytes(layout_type(l));
    int exact = 1;
    if (values == 1) return take_run(l, to, from, l->dims[0], l->stride[0]);
    if (l->component_stride == 1 && l->stride[0] == (uint64_t)values)
        return take_run(l, to, from, l->dims[0] * values, 1);
    for (int64_t x = 0; x < l->dims[0]; x++)
        exact &= take_run(l, to + (size_t)x * sample, from + (size_t)x * (size_t)l->stride[0] * bytes, values,
                          l->component_stride);
    return exact;
}

int layout_gather(const char *path, const layout *l, const unsigned char *stored, void *samples) {
    size_t bytes = element_bytes(l->element);
    size_t row = (size_t)l->dims[0] * (size_t)values_per_sample(l) * sample_bytes(layout_type(l));
    unsigned char *to = samples;
    for (int64_t z = 0; z < l->dims[2]; z++)
        for (int64_t y = 0; y < l->dims[1]; y++, to += row) {
            uint64_t first = l->offset + (uint64_t)z * l->stride[2] + (uint64_t)y * l->stride[1];
            if (!take_row(l, to, stored + first * bytes))
                return fail(STATUS_INPUT,
                            "%s: has 64-bit integers that a double cannot hold exactly; convert it to another type",
                            path);
        }
    return 0;
}
