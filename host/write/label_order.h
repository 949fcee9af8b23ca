/*
 * label_order.h - the triangles of a label map in the order of their labels, for formats that show them label by label
 */
#ifndef LABEL_ORDER_H
#define LABEL_ORDER_H

#include "shown_records.h"

/* Sorted by their pairs of labels; triangles that have the same pair stay in the mesh's order. */
typedef struct label_order {
    const shown_mesh *shown;
    uint32_t *triangles; /* from malloc; NULL: the mesh has no labels, or no triangles, or there is no memory */
} label_order;

/* Returns 0, or ENOMEM. To be released in any case. */
int label_order_make(const shown_mesh *s, label_order *order);
void label_order_release(label_order *order);

/* The labels of the triangle at this position of the order: the inner side's, the outer side's. */
static inline const uint32_t *label_order_at(const label_order *order, uint64_t position) {
    return order->shown->labels + (size_t)2 * order->triangles[position];
}

/* One past the last triangle, from position `first` on, with the same inner label; is_pair: and the same outer one. */
uint64_t label_order_end(const label_order *order, uint64_t first, int is_pair);

/* The records of triangles, in that order where there is one. */
record_array records_of_ordered(const shown_mesh *s, const label_order *order);

#endif
