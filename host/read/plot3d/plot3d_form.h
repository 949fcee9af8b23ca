/*
 * plot3d_form.h - the ways in which the bytes of one Plot3D file can be understood
 *
 * Plot3D files do not say how they were written. A file is therefore tried in every way there is: as text, Fortran
 * records or C binary, in either byte order and precision, as one block or several, as grid, solution or function. Its
 * header then tells its size, and what is left is a form: mostly one, as sizes and record marks must agree exactly.
 */
#ifndef PLOT3D_FORM_H
#define PLOT3D_FORM_H

#include "file/mapping.h"

#include <stdint.h>

enum plot3d_encoding { PLOT3D_TEXT, PLOT3D_RECORDS_4, PLOT3D_RECORDS_8, PLOT3D_BINARY, PLOT3D_ENCODINGS };
enum plot3d_content {
    PLOT3D_GRID,
    PLOT3D_GRID_IBLANK,
    PLOT3D_SOLUTION, /* density, momentum, energy */
    PLOT3D_OVERFLOW, /* the same and more, as the OVERFLOW solver writes it */
    PLOT3D_FUNCTION, /* any variables */
    PLOT3D_CONTENTS
};

typedef struct plot3d_block {
    int64_t dims[3];
    uint64_t points;
    uint64_t variables; /* per point: 3 in a grid */
    uint64_t values;    /* where they begin: all points of one variable, x fastest, then the next variable's */
    uint64_t iblank;    /* where these begin */
} plot3d_block;

typedef struct plot3d_form {
    enum plot3d_encoding encoding;
    enum plot3d_content content;
    int big_endian;
    int value_bytes; /* 4 or 8 */
    int is_multi;    /* begins with a number of blocks, which may be 1 */
    uint64_t padding;
    plot3d_block *blocks;
    int64_t block_count;
} plot3d_form;

enum { PLOT3D_FORMS = PLOT3D_ENCODINGS * PLOT3D_CONTENTS * 2 * 2 * 2 };

typedef struct plot3d_file {
    const char *path;
    const unsigned char *bytes; /* of text: its numbers, as native doubles */
    uint64_t size;
    double *numbers;
    plot3d_form forms[PLOT3D_FORMS];
    int form_count;
} plot3d_file;

/* Finds all forms that explain the file to its last byte; zero bytes at its end that fill up a storage block are left
 * over. STATUS_INPUT where there is none. To be released in any case. */
int plot3d_open(const char *path, const mapping *mapped, plot3d_file *file);
void plot3d_release(plot3d_file *file);

/* Whether values, of which some are looked at, are plausible: each is 0 or of a usual magnitude. Read in a wrong form
 * they hardly ever are. */
int plot3d_is_physical(const plot3d_file *file, const plot3d_form *form);

/* "big-endian C binary, f32, 1 block, grid with IBLANK" */
const char *plot3d_describe(const plot3d_form *form, char text[128]);

/* Converts `count` values from an offset on; out[0], out[stride], out[2 * stride] ... receive them. */
void plot3d_load_f32(const plot3d_file *file, const plot3d_form *form, uint64_t offset, uint64_t count, float *out,
                     uint64_t stride);
void plot3d_load_f64(const plot3d_file *file, const plot3d_form *form, uint64_t offset, uint64_t count, double *out,
                     uint64_t stride);

/* Whether the IBLANK value at that index is 0. */
int plot3d_is_blanked(const plot3d_file *file, const plot3d_form *form, const plot3d_block *block, uint64_t index);

#endif
