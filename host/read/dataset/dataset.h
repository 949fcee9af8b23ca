/*
 * dataset.h - what every reader produces: grids, one or more blocks of them, with their fields in memory
 *
 * Values are in native byte order, tuple by tuple; points of structured blocks run x fastest. Whatever a block points
 * to belongs to its dataset: memory that readers take from dataset_allocate, or the mapped file where values can be
 * used in place.
 */
#ifndef DATASET_H
#define DATASET_H

#include "file/file_list.h"
#include "tetracubes.h"

/* What the only field is called on command lines and in files where the format has no names. */
#define FIELD_WITHOUT_NAME "samples"

typedef struct dataset_field {
    const char *name; /* "" where the format has no names */
    int on_cells;     /* a tuple per cell, not per point */
    int components;   /* values per tuple: 1 for a scalar */
    tc_type type;     /* f64 where the file has 64-bit integers */
    int is_active;    /* the file's active scalars: taken where none of several fields is chosen */
    int is_number;    /* global numbers: points or cells of several pieces with the same number are one */
    int is_rounded;   /* no double holds some of these integers: the nearest stands for them */
    int is_scaled;    /* f64, made of stored values by a slope and an intercept that have the precision of f32 */
    const void *values;
    const char *meaning; /* of the components, "red, green, blue"; NULL where unknown */
    int is_whole;   /* of a block that is a region: values are those of the whole block as the file has them, which need
                       not be aligned, and region_field (region.h) has to take the region's */
    int is_swapped; /* they are in the other byte order: only where is_whole */
} dataset_field;

/* Coordinates in the precision of the file: one of the two is NULL. */
typedef struct coordinates {
    const float *f32;
    const double *f64;
} coordinates;

static inline double coordinate_at(coordinates c, int64_t n) { return c.f64 ? c.f64[n] : (double)c.f32[n]; }

/* Bits of vtkGhostType, which blanked_cells has of VTK's files: the cell is another piece's, too; it is hidden. */
enum { CELL_IS_DUPLICATE = 1, CELL_IS_HIDDEN = 32, GHOST_CELL = CELL_IS_DUPLICATE | CELL_IS_HIDDEN };

/* Of points it is hidden; there is no more to know. */
enum { POINT_IS_HIDDEN = 2 };

enum block_kind { BLOCK_UNIFORM, BLOCK_RECTILINEAR, BLOCK_CURVILINEAR, BLOCK_UNSTRUCTURED };

/* Samples of a structured block, along each axis: the first one, counted from 0; how many; each so many after the one
 * before it. */
typedef struct sample_box {
    int64_t first[3], count[3], step[3];
} sample_box;

typedef struct dataset_block {
    enum block_kind kind;
    int64_t point_count, cell_count;
    int number; /* in the input, from 0 */
    const struct dataset_block
        *whole;        /* of a region: the block that it is a region of, without fields; NULL: all there is */
    sample_box region; /* of a region: its samples in the whole */

    int64_t dims[3];     /* all but unstructured: points along x, y, z; cells are cubes between them */
    int64_t first[3];    /* index of the first point in the whole extent */
    double matrix[3][4]; /* uniform: index space to world, as tc_grid_options.matrix */
    coordinates axes[3]; /* rectilinear: dims[a] positions along each axis */
    coordinates points;  /* curvilinear and unstructured: x, y, z of every point */

    const uint8_t *cell_types;   /* unstructured: VTK's numbers of cell types */
    const int64_t *cell_offsets; /* cell_count + 1: where in cell_points the points of a cell begin */
    const int64_t *cell_points;  /* each checked to be below point_count */
    const int64_t *cell_faces, *face_offsets, *face_points; /* of polyhedra, as in tc_cells; NULL: none */

    const uint8_t *blanked_points, *blanked_cells; /* nonzero: missing; NULL: none */
    dataset_field *fields;
    int field_count;
} dataset_block;

/* An array of the file that was left out. The reason is told where somebody asks for it by its name. */
typedef struct dataset_absent {
    const char *name, *reason; /* "its type String cannot be read" */
} dataset_absent;

typedef struct dataset {
    dataset_block *blocks;
    int block_count;
    char format[24]; /* "NRRD", "VTK legacy", "VTK XML", "Plot3D", ... */
    char space[64];  /* the file's name of its world space, or "" */
    char world[8];   /* where the axes of this space point, in letters as RAS and LPS; "" where the file does not say */
    char units[16];  /* of coordinates, as "mm"; "" where the file does not say */

    char **notices;                /* what the user should know about how the file was read: dataset_notice */
    int notice_count, notice_lost; /* lost: there was no memory for one */
    char notice[256];              /* the same joined by "; ", as many as there is room for; or "" */

    dataset_absent *absent; /* each name once */
    int absent_count;

    int64_t frames; /* of images, which have one uniform block with one unnamed field: volumes to choose from, of which
                       this is the first; 1 where one was chosen, or is the only one. 0: other grids */

    void *mapping; /* a file mapped into memory, or NULL */
    size_t mapping_bytes;
    file_list files;               /* all that the input was read from: none may be overwritten while it is in use */
    struct dataset_memory *memory; /* list of all that dataset_allocate gave */
} dataset;

/* Frees or unmaps all and zeroes *d. */
void dataset_release(dataset *d);

/* Memory that lives as long as the dataset, page-aligned and in huge pages where large; also for 0 bytes. NULL, with
 * the message of STATUS_FAILED, where there is none. */
void *dataset_allocate(dataset *d, uint64_t bytes);

/* Maps a file of the input (mapping.h) and notes it among its files; the mapping is the caller's. 0 or a status. */
struct mapping;
int dataset_map(dataset *d, const char *path, struct mapping *m);

/* Takes over memory from samples_allocate: it lives as long as the dataset, or is freed at once where this fails. 0 or
 * STATUS_FAILED. */
int dataset_keep(dataset *d, void *memory);

/* Takes over the blocks, files and memory of another dataset and what is to be told of it, which is told once; of
 * notices_of that alone. *from is then empty. 0 or STATUS_FAILED, and both are to be released. */
int dataset_absorb(dataset *to, dataset *from);
int dataset_notices_of(dataset *to, const dataset *from);

/* Sets the units, unless the text is none that can stand in a header: printed characters without blanks, quotation
 * marks and '='. */
void dataset_set_units(dataset *d, const char *text);

/* A copy of the text that lives as long as the dataset. */
char *dataset_text(dataset *d, const char *text);

/* Adds a zeroed block or field; *out stays valid until the next is added. 0 or STATUS_FAILED. */
int dataset_block_add(dataset *d, dataset_block **out);
int dataset_field_add(dataset_block *block, dataset_field **out);

/* Begins an image: its block, and its field without a name. 0 or STATUS_FAILED. */
int dataset_image_begin(dataset *d);

/* Notes an array that is left out; format makes the reason. The first array of a name gets a notice. Strings are
 * copied. 0 or STATUS_FAILED. */
int dataset_leave_out(dataset *d, const char *name, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Adds a notice: half a sentence, as the name of the input is put before it. After very many a last one says that the
 * others are left out. */
void dataset_notice(dataset *d, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
