/*
 * vtk_legacy_text.h - what the parts of the VTK legacy reader share: the position in the file, and its words
 *
 * A file is a sequence of words separated by white space, keywords in any case, with arrays of values between them: in
 * ASCII files more words, in BINARY ones big-endian bytes that begin after the line feed that ends the line of the last
 * word. Nothing is read beyond the mapped bytes; no zero byte ends them. Memory for an array is asked for only after
 * its size was compared with the rest of the file.
 */
#ifndef VTK_LEGACY_TEXT_H
#define VTK_LEGACY_TEXT_H

#include "dataset/dataset.h"
#include "dataset/request.h"
#include "stored_types.h"

#include <stddef.h>

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
    int64_t *offsets, *links;         /* cell_offsets and cell_points of the block, before they are checked */
    uint8_t *blanked_points, *blanked_cells;
    int64_t blanking_count; /* of the section BLANKING */
} legacy;

/* STATUS_INPUT, with a message of the file, the formatted text, and the line or byte. */
int legacy_fail(const legacy *r, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The next word; "" at the end of the file. Control characters become '?'. STATUS_INPUT where it is too long. */
int legacy_word(legacy *r, char word[LEGACY_WORD]);

/* The next word, which has to exist: `what` names it in the message. */
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

#endif
