/* vtk_xml_load.h - arrays of a VTK XML file, found and brought to where a dataset keeps their values */
#ifndef VTK_XML_LOAD_H
#define VTK_XML_LOAD_H

#include "dataset/dataset.h"
#include "dataset/request.h"
#include "vtk_xml/vtk_xml_data.h"

typedef struct xml_reader {
    const read_request *request;
    xml_document doc;
    dataset *out;
    int uses_file;        /* whether any values are used in the mapped file */
    unsigned char *chunk; /* for small arrays, which would waste a page each */
    size_t chunk_left;
} xml_reader;

/* Memory of the dataset; NULL, with the failure's text set, where there is none. */
void *vtk_xml_memory(xml_reader *r, uint64_t bytes);

/* The array of that index among those of a section and, unless it is NULL, of a name. NULL: there are fewer. */
const xml_array *vtk_xml_array_find(const xml_reader *r, const xml_piece *piece, enum xml_section section,
                                    const char *name, int index);

/* *values: those of an array that is open, in the stored type, in the mapped file or in memory of the dataset. */
int vtk_xml_load_opened(xml_reader *r, xml_values *v, const void **values);

/* The first `count` values of an array, in the stored type: in the mapped file or in memory of the dataset. */
int vtk_xml_load_stored(xml_reader *r, const xml_array *array, uint64_t count, const void **values);

/* The same for a short while: *owned is to be freed; NULL where the values are in the mapped file. */
int vtk_xml_load_briefly(xml_reader *r, const xml_array *array, uint64_t count, const unsigned char **values,
                         void **owned);

/* Coordinates, from any type of number: integers become doubles. */
int vtk_xml_load_coordinates(xml_reader *r, const xml_array *array, uint64_t count, coordinates *values);

/* Writes `count` integers, stored in any type of integer. */
int vtk_xml_load_integers(xml_reader *r, const xml_array *array, uint64_t count, int64_t *to);

/* The same from memory. Unsigned ones of 64 bits that int64 cannot hold become negative. */
void vtk_xml_to_integers(int64_t *to, const unsigned char *from, uint64_t count, int element);

/* A notice where the array holds more than is wanted of it. */
void vtk_xml_note_more(xml_reader *r, const xml_values *v);

#endif
