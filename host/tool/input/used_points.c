#include "used_points.h"

#include "dataset/cell_types.h"

uint64_t count_set(const uint8_t *mask, int64_t count) {
    uint64_t set = 0;
    for (int64_t n = 0; mask && n < count; n++) set += mask[n] != 0;
    return set;
}

static void mark_cell(const dataset_block *b, int64_t cell, uint8_t *used) {
    const uint8_t type = b->cell_types[cell];
    const int64_t begin = b->cell_offsets[cell], all = b->cell_offsets[cell + 1] - begin;
    const int64_t corners = cell_type_corners(type);
    for (int64_t n = 0; n < (corners && corners < all ? corners : all); n++) used[b->cell_points[begin + n]] = 1;
    if (!b->cell_faces) return;
    for (int64_t face = b->cell_faces[cell]; face < b->cell_faces[cell + 1]; face++)
        for (int64_t n = b->face_offsets[face]; n < b->face_offsets[face + 1]; n++) used[b->face_points[n]] = 1;
}

static void mark_cube(const int64_t d[3], int64_t x, int64_t y, int64_t z, uint8_t *used) {
    for (int corner = 0; corner < 8; corner++)
        used[x + (corner & 1) + d[0] * (y + (corner >> 1 & 1) + d[1] * (z + (corner >> 2)))] = 1;
}

static void mark_cubes(const dataset_block *b, const uint8_t *blanked_cells, uint8_t *used) {
    const int64_t *d = b->dims;
    int64_t cell = 0;
    for (int64_t z = 0; z + 1 < d[2]; z++)
        for (int64_t y = 0; y + 1 < d[1]; y++)
            for (int64_t x = 0; x + 1 < d[0]; x++)
                if (!blanked_cells[cell++]) mark_cube(d, x, y, z, used);
}

enum point_use used_points_mark(const dataset_block *b, const uint8_t *blanked_cells, uint8_t *used) {
    int64_t count = 0;
    if (b->kind != BLOCK_UNSTRUCTURED) {
        if (b->dims[0] < 2 || b->dims[1] < 2 || b->dims[2] < 2) return POINTS_NONE_USED;
        if (!blanked_cells) return POINTS_ALL_USED;
        mark_cubes(b, blanked_cells, used);
    }
    for (int64_t cell = 0; b->kind == BLOCK_UNSTRUCTURED && cell < b->cell_count; cell++)
        if (cell_type_dimension(b->cell_types[cell]) == 3 && !(blanked_cells && blanked_cells[cell]))
            mark_cell(b, cell, used);
    for (int64_t n = 0; n < b->point_count; n++) count += used[n];
    return !count ? POINTS_NONE_USED : count < b->point_count ? POINTS_SOME_USED : POINTS_ALL_USED;
}
