#include "vtk_xml/vtk_xml_load.h"

#include "dataset/array_memory.h"
#include "exit_status.h"
#include "failure.h"
#include "stored_types.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#ifndef SMALL_BYTES /* larger arrays have memory of their own */
#define SMALL_BYTES (16 << 10)
#endif
enum { CHUNK_BYTES = 128 << 10, ALIGNMENT = 64 };

void *vtk_xml_memory(xml_reader *r, uint64_t bytes) {
    if (bytes > SMALL_BYTES) return dataset_allocate(r->out, bytes);
    size_t rounded = ((size_t)(bytes ? bytes : 1) + ALIGNMENT - 1) & ~(size_t)(ALIGNMENT - 1);
    if (rounded > r->chunk_left) {
        r->chunk = dataset_allocate(r->out, CHUNK_BYTES);
        r->chunk_left = r->chunk ? CHUNK_BYTES : 0;
        if (!r->chunk) return NULL;
    }
    r->chunk_left -= rounded;
    return r->chunk + CHUNK_BYTES - r->chunk_left - rounded;
}

void vtk_xml_note_more(xml_reader *r, const xml_values *v) {
    if (v->more)
        dataset_notice(r->out, "%s holds more values than are needed; the rest is not used", v->label + v->label_array);
}

int vtk_xml_load_opened(xml_reader *r, xml_values *v, const void **values) {
    int status = 0;
    *values = v->in_place;
    if (v->in_place) {
        r->uses_file = 1;
    } else {
        void *memory = vtk_xml_memory(r, v->bytes);
        if (!memory) return STATUS_FAILED;
        *values = memory;
        status = vtk_xml_take(v, memory);
    }
    vtk_xml_note_more(r, v);
    return status;
}

int vtk_xml_load_stored(xml_reader *r, const xml_array *array, uint64_t count, const void **values) {
    xml_values v;
    int status = vtk_xml_open(&r->doc, array, count, &v);
    return status ? status : vtk_xml_load_opened(r, &v, values);
}

/* Doubles as they are stored. Later float32 coordinates are made of them, half their size: so sharing them is bounded
 * as copying is. */
static int load_doubles(xml_reader *r, const xml_array *array, uint64_t count, const double **values) {
    xml_values v;
    int status = vtk_xml_open(&r->doc, array, count, &v);
    if (!status && v.in_place) status = vtk_xml_note_taken(&r->doc, &v, v.bytes);
    return status ? status : vtk_xml_load_opened(r, &v, (const void **)values);
}

int vtk_xml_load_briefly(xml_reader *r, const xml_array *array, uint64_t count, const unsigned char **values,
                         void **owned) {
    xml_values v;
    *owned = NULL;
    int status = vtk_xml_open(&r->doc, array, count, &v);
    if (status) return status;
    if (v.in_place) {
        *values = v.in_place;
        status = vtk_xml_note_taken(&r->doc, &v, v.bytes);
    } else {
        if (!(*owned = samples_allocate(v.bytes)))
            return fail(STATUS_FAILED, "%s: no memory for %" PRIu64 " bytes", v.label, v.bytes);
        *values = *owned;
        status = vtk_xml_take(&v, *owned);
    }
    vtk_xml_note_more(r, &v);
    return status;
}

#define CONVERT_CASE(converted, type, stored)                                                                          \
    case type:                                                                                                         \
        for (uint64_t i = 0; i < count; i++) {                                                                         \
            stored value;                                                                                              \
            memcpy(&value, from + i * sizeof value, sizeof value);                                                     \
            to[i] = (converted)value;                                                                                  \
        }                                                                                                              \
        break;
#define TO_DOUBLE(type, name, c_type, ...)  CONVERT_CASE(double, type, c_type)
#define TO_INTEGER(type, name, c_type, ...) CONVERT_CASE(int64_t, type, c_type)

static void convert_to_doubles(double *to, const unsigned char *from, uint64_t count, int element) {
    switch (element) { STORED_INTEGERS(TO_DOUBLE) }
}

void vtk_xml_to_integers(int64_t *to, const unsigned char *from, uint64_t count, int element) {
    switch (element) { STORED_INTEGERS(TO_INTEGER) }
}

int vtk_xml_load_coordinates(xml_reader *r, const xml_array *array, uint64_t count, coordinates *values) {
    const unsigned char *stored = NULL;
    void *owned, *memory;
    if (array->element == TC_F32) return vtk_xml_load_stored(r, array, count, (const void **)&values->f32);
    if (array->element == TC_F64) return load_doubles(r, array, count, &values->f64);
    int status = vtk_xml_load_briefly(r, array, count, &stored, &owned);
    if (!status && !(memory = vtk_xml_memory(r, count * sizeof(double)))) status = STATUS_FAILED;
    if (!status) {
        convert_to_doubles(memory, stored, count, array->element);
        values->f64 = memory;
    }
    samples_free(owned);
    return status;
}

int vtk_xml_load_integers(xml_reader *r, const xml_array *array, uint64_t count, int64_t *to) {
    const unsigned char *stored = NULL;
    void *owned;
    if (element_is_real(array->element))
        return fail(STATUS_INPUT, "%s: its array '%.60s' is of floating point; it must be of integers", r->doc.path,
                    r->doc.names + array->name);
    int status = vtk_xml_load_briefly(r, array, count, &stored, &owned);
    if (!status) vtk_xml_to_integers(to, stored, count, array->element);
    samples_free(owned);
    return status;
}

const xml_array *vtk_xml_array_find(const xml_reader *r, const xml_piece *piece, enum xml_section section,
                                    const char *name, int index) {
    for (size_t i = 0; i < piece->array_count; i++) {
        const xml_array *array = &r->doc.arrays[piece->first_array + i];
        if (array->section == section && (!name || strcmp(name, r->doc.names + array->name) == 0) && !index--)
            return array;
    }
    return NULL;
}
