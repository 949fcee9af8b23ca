/* vtk_xml_data.h - the values of one array of a VTK XML file */
#ifndef VTK_XML_DATA_H
#define VTK_XML_DATA_H

#include "vtk_xml/vtk_xml_header.h"

/* Bytes of the file, or what base64 in it stands for, taken in order. A copy of it continues from the same position. */
typedef struct xml_source {
    const unsigned char *at, *end;
    int is_base64;
    unsigned char kept[3]; /* decoded, not yet taken */
    size_t kept_count;
} xml_source;

/* An array whose sizes have been compared with what the file holds. */
typedef struct xml_values {
    const xml_document *doc;
    const xml_array *array;
    uint64_t count, bytes;         /* of the values that are wanted */
    const unsigned char *in_place; /* where they lie in the file as this machine wants them; NULL: vtk_xml_take */
    const unsigned char *stored;   /* the same, be they swapped or not aligned; NULL: packed, or text */
    int more;                      /* whether the array holds more than that; of text only known when it is taken */
    char label[512];               /* file and array, for messages */
    size_t label_array;            /* where in it the array begins */

    xml_source data, sizes; /* sizes: of compressed blocks */
    uint64_t block_bytes, largest_block;
    int is_compressed;
} xml_values;

/* Finds the first `count` values, and checks that the file can hold them: to be called before memory is taken for
 * them. STATUS_INPUT where it cannot. */
int vtk_xml_open(xml_document *doc, const xml_array *array, uint64_t count, xml_values *out);

/* To be called before values that could be used in place are copied nevertheless. STATUS_INPUT where arrays have asked
 * for the same bytes of the file too often. */
int vtk_xml_note_taken(xml_document *doc, const xml_values *values, uint64_t bytes);

/* Writes values->bytes bytes: values of the stored type in this machine's byte order. */
int vtk_xml_take(xml_values *values, void *to);

#endif
