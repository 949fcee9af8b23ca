/*
 * vtk_xml_header.h - what a VTK XML file says of its pieces and arrays
 *
 * The parts of the reader:
 *
 *     vtk_xml_header.c   the XML, through expat: pieces, and where each array lies in the file
 *     vtk_xml_data.c     the values of one array: base64, blocks, compression, byte order
 *     vtk_xml_text.c     the values of one array written as text
 *     vtk_xml.c          datasets made of them
 *
 * Source: "VTK XML Formats" in VTK's file format documentation (docs.vtk.org), and what VTK 9 writes and reads.
 */
#ifndef VTK_XML_HEADER_H
#define VTK_XML_HEADER_H

#include "dataset/dataset.h"
#include "file/mapping.h"
#include "file/unpack_block.h"

#include <stddef.h>
#include <stdint.h>

enum xml_section { SECTION_NONE, SECTION_POINT_DATA, SECTION_CELL_DATA, SECTION_POINTS, SECTION_CELLS, SECTION_AXES };

enum xml_format { FORMAT_TEXT, FORMAT_BINARY, FORMAT_APPENDED };

typedef struct xml_array {
    enum xml_section section;
    size_t name;        /* where in the document's names */
    int element;        /* stored type (stored_types.h); -1: strings and others that are no numbers */
    int is_bits;        /* TC_U8 as text; else eight values to a byte, the first in the highest bit */
    char type[24];      /* as the file names it */
    int64_t components; /* at least 1 */
    int is_active;      /* the section's Scalars */
    int is_number;      /* the section's GlobalIds */
    enum xml_format format;
    uint64_t offset;                      /* appended: from the first byte of the appended data */
    const unsigned char *text, *text_end; /* inline: without white space around it; both NULL: none */
} xml_array;

typedef struct xml_piece {
    int64_t first[3], dims[3]; /* structured: of the points; any of dims 0: none */
    uint64_t point_count, cell_count;
    size_t first_array, array_count;
} xml_piece;

typedef struct xml_document {
    const char *path;
    const unsigned char *bytes, *end; /* of the file */
    enum block_kind kind;
    int swapped;         /* the other byte order than this machine's */
    size_t header_bytes; /* 4 or 8: of each number in front of binary data */
    char compressor[40]; /* "" where binary data is not compressed */
    packing packed;      /* by this compressor */
    double origin[3], spacing[3], direction[9];

    const unsigned char *appended; /* first byte of the appended data; NULL: none */
    int appended_is_raw;           /* else base64 */
    uint64_t taken;                /* bytes of the file that arrays were decoded or copied from so far */
    uint64_t unpacked;             /* bytes that compressed arrays had */

    xml_piece *pieces;
    xml_array *arrays;
    char *names; /* zero-ended, one after the other */
    size_t piece_count, array_count, name_bytes;
} xml_document;

/* Fills *doc from a mapped file, which must outlive it; to be released, also after a failure. */
int vtk_xml_parse(const char *path, const mapping *file, xml_document *doc);

/* Frees and zeroes. */
void vtk_xml_release(xml_document *doc);

#endif
