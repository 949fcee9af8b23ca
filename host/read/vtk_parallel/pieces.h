/* pieces.h - the pieces of one grid, each read as a block, and what makes one block of them */
#ifndef VTK_PARALLEL_PIECES_H
#define VTK_PARALLEL_PIECES_H

#include "dataset/dataset.h"
#include "dataset/request.h"
#include "vtk_parallel/index.h"

typedef struct grid_piece {
    const char *path;           /* its file */
    const dataset_block *block; /* with points; a file may hold several */
    size_t part;                /* the dataset that the block belongs to */
    index_extent extent;        /* structured grids: of its file, as the index has it */
} grid_piece;

typedef struct piece_list {
    const read_request *request;
    const vtk_index *index;
    dataset *parts; /* one of each file; freed as soon as what they hold is copied */
    grid_piece *pieces;
    size_t part_count, count; /* at least one piece */
} piece_list;

/* Both add one block to *out, and the notices that go with it. The pieces have the same fields (pieces_have_fields),
 * and the coordinates of one type. STATUS_INPUT, with a text that names the files, where pieces do not fit. */
int grid_pieces_join(const piece_list *list, dataset *out);
int cell_pieces_join(const piece_list *list, dataset *out);

/* The field of a block that has the name, the association and the occurrence of one of another block; NULL: none. */
const dataset_field *piece_field(const dataset_block *block, const dataset_block *of, int field);

/* Adds the fields of the first piece to the whole block, each with memory for its values, which *values lists. */
int pieces_add_fields(const piece_list *list, dataset *out, dataset_block *whole, unsigned char ***values);

/* Of coordinates that hold so many numbers: memory of the same type. STATUS_INPUT where another piece has another one:
 * f32 instead of f64, or the reverse. */
int pieces_add_coordinates(dataset *out, coordinates like, uint64_t count, coordinates *to, unsigned char **memory);
int piece_coordinates_fit(const piece_list *list, const grid_piece *piece, coordinates own, coordinates first);

/* Bytes of a value of the coordinates, and their values. */
static inline size_t coordinate_bytes(coordinates c) { return c.f64 ? sizeof *c.f64 : sizeof *c.f32; }
static inline const unsigned char *coordinate_values(coordinates c) {
    return c.f64 ? (const unsigned char *)c.f64 : (const unsigned char *)c.f32;
}

#endif
