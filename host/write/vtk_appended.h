/*
 * vtk_appended.h - VTK XML files whose arrays follow each other as raw appended data
 *
 *     vtk_file f = {.o = o};
 *     text_add(&f.text, ...); vtk_array_add(&f, ...); text_add(&f.text, ...);
 *     vtk_file_write(&f, "PolyData");
 *
 * Every array, with its length as UInt64 before it, begins at a multiple of eight bytes in the file, so that a reader
 * can use it where it lies.
 */
#ifndef VTK_APPENDED_H
#define VTK_APPENDED_H

#include "file_text.h"
#include "output.h"
#include "stored_types.h"

typedef struct vtk_array {
    const char *name;
    int type; /* stored_types.h */
    int components;
    record_span span;
    size_t record_bytes;
    output_encode *encode; /* NULL: the source lies in memory as it should lie in the file */
    const void *source;
} vtk_array;

typedef struct vtk_file {
    output *o;
    file_text text; /* of the grid's element: what is inside <PolyData> ... */
    vtk_array *arrays;
    size_t array_count;
    uint64_t appended_bytes;
    char **field_names; /* as they stand in the text */
    size_t field_count;
} vtk_file;

/* Adds the array's element to the text and the array to what is appended. Names may be any bytes: what XML cannot hold
 * becomes '_'. What it points to is borrowed until vtk_file_write. */
void vtk_array_add(vtk_file *f, const vtk_array *array);

/* The same for a field, whose name the writer does not choose: '_' is appended to it where it is one of `own`, the
 * names of the arrays that the writer makes itself (NULL after the last), or that of an earlier field. */
void vtk_field_add(vtk_file *f, const vtk_array *array, const char *const *own);

/* Adds the element FieldData with these texts of letters and digits; NULL or "" is left out, and FieldData without any.
 */
void vtk_notes_add(vtk_file *f, const char *world, const char *units);

/* Writes the whole file and frees what the vtk_file holds. */
void vtk_file_write(vtk_file *f, const char *grid);

/* Whether connectivity and offsets up to these numbers need Int64; VTK wants both of one type. */
static inline int vtk_needs_wide(uint64_t points, uint64_t corners) {
#ifndef VTK_WIDE_FROM
#define VTK_WIDE_FROM INT32_MAX
#endif
    return points > VTK_WIDE_FROM || corners > VTK_WIDE_FROM;
}

static inline int vtk_index_type(int is_wide) { return is_wide ? (int)ELEMENT_I64 : (int)TC_I32; }

/* Writes an index of that type; returns the address behind. */
static inline unsigned char *put_index(unsigned char *to, uint64_t index, int is_wide) {
    uint32_t narrow = (uint32_t)index;
    size_t bytes = is_wide ? 8 : 4;
    __builtin_memcpy(to, is_wide ? (void *)&index : (void *)&narrow, bytes);
    return to + bytes;
}

#endif
