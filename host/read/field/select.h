/*
 * select.h - which field of a dataset is contoured, and its samples: one number per point of every block
 *
 * A field is chosen by its name. Where points and cells have fields of one name, that of the points is taken;
 * point:NAME and cell:NAME choose. A field whose own name begins like that has precedence. Where no name is given, the
 * only field is taken, or of several the file's active scalars, as VTK's files name them. Values of cells are averaged
 * to points (average.h). New arrays lie in the dataset's memory; values that need no change are used where they are.
 */
#ifndef SELECT_H
#define SELECT_H

#include "dataset/dataset.h"
#include "dataset/request.h"

/* One block's samples, and what is missing: what the block blanks, and values that are nodata or not finite. */
typedef struct scalar_block {
    tc_type type;
    const void *samples;                           /* one per point */
    const uint8_t *blanked_points, *blanked_cells; /* as in dataset_block */
    int has_nodata; /* structured blocks: some samples are nodata; these, and those that are not finite, are still to be
                       left out. Unstructured blocks have both among blanked_points */
    double nodata;  /* in the type of the samples */
} scalar_block;

typedef struct scalar {
    const char *name;
    int is_active;   /* not chosen by the request: the file's active scalars */
    int component;   /* -1 of a field that has one; or COMPONENT_MAGNITUDE */
    int is_averaged; /* of cells */
    int is_rounded;  /* as that of dataset_field, in some block */
    int has_nodata;  /* some value equals the request's nodata */
    scalar_block *blocks;
} scalar;

/* A field of every block at the points; type and values are each block's own. */
typedef struct point_field {
    const char *name; /* as it was asked for */
    int components;
    int is_averaged;
    dataset_field *blocks;
} point_field;

/* Chooses the field and makes its samples. Returns 0, STATUS_USAGE where the
 * request leaves a choice open or names what is not there (the text lists what is), STATUS_INPUT where there is no
 * field, or STATUS_FAILED. */
int scalar_select(dataset *d, const read_request *request, scalar *out);

/* The name of the field that is taken where several are there and none is named; NULL: none is. */
const char *active_field(const dataset *d);

/* *out: of the first block, the field that is named, active or the only one; NULL where that choice is open, or there
 * is none. Returns as scalar_select where a name is not there. */
int scalar_field(const dataset *d, const read_request *request, const dataset_field **out);

/* The number of its components, or 0. */
int scalar_components(const dataset *d, const read_request *request, int *components);

/* The field of that name with all its components. path is the input's name for messages. Returns as scalar_select;
 * STATUS_INPUT too where blocks differ in the number of components. */
int point_field_select(dataset *d, const char *path, const char *name, point_field *out);

/* The names of fields that every block has, as names of the first block's fields, each once; *names from malloc. -1
 * without memory, with its message; else how many. */
int common_field_names(const dataset *d, const char ***names);

/* The length of "point:" or "cell:" where the string begins with it, else 0. */
size_t field_prefix(const char *text);

/* The block's field of that name; NULL where it has none. */
const dataset_field *block_field(const dataset_block *b, const char *name);

#endif
