/* shared_points.h - which points of the pieces of an unstructured grid are one point of the whole */
#ifndef VTK_PARALLEL_SHARED_POINTS_H
#define VTK_PARALLEL_SHARED_POINTS_H

#include "vtk_parallel/pieces.h"

/* Numbers go over all points of all pieces, one piece after the other; starts[p] is the first of piece p, and
 * starts[count] their sum. */
typedef struct shared_points {
    int64_t *numbers;   /* of each point: that of the whole's; -1: left out */
    int64_t *sources;   /* of each point: the one whose position and values the whole takes, itself or an earlier one */
    uint8_t *is_shared; /* of each point: whether other pieces have it */
    int64_t count;      /* of the whole */
    int64_t differing;  /* points whose values are not the same in all pieces */
    int64_t unclear;    /* positions where a piece has several points, which are not joined */
    int by_number;      /* the file has global numbers, which the whole's points are in the order of */
} shared_points;

/* Points with the same global number are one, or, without such numbers, those at the same position. Where a piece has
 * several points at a position, those are one that have the same values, if that leaves one of each piece. is_left_out:
 * of each point. Arrays are to be freed, also after a failure. */
int shared_points_find(const piece_list *list, const int64_t *starts, const uint8_t *is_left_out, shared_points *out);
void shared_points_release(shared_points *s);

/* Keys with what they are of, sorted by key; of equal keys the order stays. *spare has room for as many. */
typedef struct sort_entry {
    uint64_t key;
    int64_t of;
} sort_entry;
void entries_sort(sort_entry *entries, sort_entry *spare, size_t count);

/* Global numbers of points or cells as keys: the field, where every piece has it; NULL: none that can be used. */
const dataset_field *piece_numbers(const grid_piece *piece, int on_cells);
int pieces_have_numbers(const piece_list *list, int on_cells);
uint64_t number_key(const dataset_field *f, int64_t n);

/* Bits mixed so that every one of the sum depends on each. */
static inline uint64_t mixed(uint64_t x) {
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return x ^ x >> 31;
}

#endif
