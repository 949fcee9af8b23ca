/*
 * vtk_legacy.h - what the parts of the VTK legacy reader share: the place in the file, its words, its arrays
 *
 * A file is a sequence of words separated by white space, keywords in any case, with arrays of values between them: in
 * ASCII files more words, in BINARY ones big-endian bytes that begin after the line feed that ends the line of the last
 * word. Nothing is taken from behind the end of the mapped bytes, which no zero byte ends. Memory for an array is asked
 * for only after its size was compared with what is left of the file.
 */
#ifndef VTK_LEGACY_H
#define VTK_LEGACY_H

#include "layout.h"
#include "readers.h"

enum { LEGACY_WORD = 256, LEGACY_FIELDS = 4096 };

/* Types of stored values beyond those of tc_type and enum element. */
enum { LEGACY_BIT = ELEMENT_COUNT, LEGACY_STRING, LEGACY_VARIANT };

/* What the attributes that follow belong to. */
enum legacy_section { SECTION_GEOMETRY, SECTION_POINTS, SECTION_CELLS };

typedef struct legacy {
    const read_request *request;
    const char *path;
    const unsigned char *bytes;
    size_t size, at; /* at: the next byte to be read */
    int is_binary;
    int major; /* version of the format */
    dataset *out;
    dataset_block *block;
    enum legacy_section section;
    uint32_t seen; /* a bit per keyword of the geometry */

    double spacing[3], origin[3];
    int64_t axis_counts[3];
    int64_t type_count;               /* cell types read */
    int64_t offset_count, link_count; /* of the arrays of cells */
    int64_t *offsets, *links;         /* these: cell_offsets and cell_points before they are checked */
    uint8_t *blanked_points, *blanked_cells;
    int64_t blanking_count; /* of the section BLANKING */
} legacy;

/* ------------------------------------------------------------------------------- words, vtk_legacy_text.c */

/* STATUS_INPUT, with file, text and place. */
int legacy_fail(const legacy *r, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The next word; "" at the end of the file. Control characters become '?'. STATUS_INPUT where it is too long. */
int legacy_word(legacy *r, char word[LEGACY_WORD]);

/* The same where one is needed: `what` names it. */
int legacy_need(legacy *r, const char *what, char word[LEGACY_WORD]);

/* Takes the next word if it is the keyword. */
int legacy_accept(legacy *r, const char *keyword);

int legacy_integer(legacy *r, const char *what, int64_t low, int64_t high, int64_t *value);
int legacy_number(legacy *r, const char *what, double *value);

/* A name, percent-decoded. */
int legacy_name(legacy *r, char name[LEGACY_WORD]);

/* Moves behind the next line feed; to the end where there is none. Whether the line was blank. */
int legacy_skip_line(legacy *r);

/* Whether a word follows on the same line. */
int legacy_line_goes_on(const legacy *r);

static inline int legacy_is_space(unsigned char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/* ----------------------------------------------------- values and arrays, vtk_legacy_values.c and _array.c */

/* Decodes `count` values of a stored type that is no text into native ones (bits: TC_U8), `what` naming them. Bytes of
 * a binary file must be there; packed bits begin at a byte. */
int legacy_decode(legacy *r, const char *what, int type, uint64_t count, uint8_t *to);

/* Native values of a stored type as others; see legacy_array. How many the wanted type cannot hold. */
uint64_t legacy_convert(int type, const uint8_t *from, uint64_t count, int wanted, void *to);

/* Passes over a number of text, or over a word that is none. */
int legacy_skip_number(legacy *r, const char *what);

/* The name of a type of values. */
int legacy_type(legacy *r, int *type);

/* Reads tuples * components values and the METADATA behind them, in memory of the dataset. They become values of type
 * `wanted`: the stored type itself (bits: TC_U8; bytes of large binary arrays stay in the mapped file), TC_F32 or
 * TC_F64 (coordinates), TC_F64 (of 64-bit integers), ELEMENT_I64 (of any integers) or TC_U8 (of TC_I32). *unfit is the
 * number of values that it cannot hold, or that are not finite, rounded, or out of range; it may be NULL where nothing
 * is converted. With out NULL they are only skipped, and may be text too. `what` names the array in failures. */
int legacy_array(legacy *r, const char *what, int type, int64_t tuples, int64_t components, int wanted, void **out,
                 uint64_t *unfit);

/* ------------------------------------------------------------- parts, vtk_legacy_cells.c and _attributes.c */

/* CELLS, in both layouts, and CELL_TYPES. */
int legacy_cells(legacy *r);
int legacy_cell_types(legacy *r);

/* Once all sections of the geometry are read: every index checked, the faces of polyhedra taken. */
int legacy_check_cells(legacy *r);

/* The attribute that the keyword begins; *known is 0 where it begins none. */
int legacy_attribute(legacy *r, const char *keyword, int *known);

/* Marks what an array of VTK's ghost flags, or of BLANKING, hides: where (flags & mask) != 0. */
int legacy_blank(legacy *r, int on_cells, const uint8_t *flags, int64_t count, unsigned mask);

#endif
