#include "label_order.h"

#include <errno.h>
#include <stdlib.h>

static uint64_t pair_of(const shown_mesh *s, uint32_t triangle) {
    const uint32_t *labels = s->labels + (size_t)2 * triangle;
    return (uint64_t)labels[0] << 32 | labels[1];
}

static int compare(const void *first, const void *second, void *shown) {
    const uint32_t a = *(const uint32_t *)first, b = *(const uint32_t *)second;
    const uint64_t pair_a = pair_of(shown, a), pair_b = pair_of(shown, b);
    return pair_a != pair_b ? (pair_a > pair_b) - (pair_a < pair_b) : (a > b) - (a < b);
}

int label_order_make(const shown_mesh *s, label_order *order) {
    const size_t count = s->labels ? (size_t)s->mesh->triangle_count : 0;
    *order = (label_order){s, NULL};
    if (!count) return 0;
    if (!(order->triangles = malloc(count * sizeof *order->triangles))) return ENOMEM;
    for (size_t n = 0; n < count; n++) order->triangles[n] = (uint32_t)n;
    qsort_r(order->triangles, count, sizeof *order->triangles, compare, (void *)(uintptr_t)s);
    return 0;
}

void label_order_release(label_order *order) {
    free(order->triangles);
    order->triangles = NULL;
}

uint64_t label_order_end(const label_order *order, uint64_t first, int is_pair) {
    const uint32_t *own = label_order_at(order, first);
    uint64_t end = first + 1;
    for (; end < order->shown->mesh->triangle_count; end++) {
        const uint32_t *other = label_order_at(order, end);
        if (other[0] != own[0] || (is_pair && other[1] != own[1])) break;
    }
    return end;
}

static unsigned char *encode_ordered(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const label_order *order = source;
    for (uint64_t n = first; n < end; n++) {
        const uint64_t triangle = order->triangles[n];
        to = encode_triangles(order->shown, triangle, triangle + 1, to);
    }
    return to;
}

record_array records_of_ordered(const shown_mesh *s, const label_order *order) {
    record_array records = records_of_triangles(s);
    if (order->triangles) records.encode = encode_ordered, records.source = order;
    return records;
}
