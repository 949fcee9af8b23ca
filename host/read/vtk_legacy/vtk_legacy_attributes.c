/*
 * vtk_legacy_attributes.c - fields at the points and cells of VTK legacy files; see vtk_legacy_attributes.h
 *
 * Arrays of strings and variants are left out, colour tables are skipped. VTK's ghost flags do not become fields:
 * points that they hide, and cells that they hide or that another piece owns, are missing.
 */
#include "vtk_legacy/vtk_legacy_attributes.h"

#include "exit_status.h"
#include "vtk_legacy/vtk_legacy_array.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* vtkDataSetAttributes: HIDDENPOINT, HIDDENCELL, DUPLICATECELL */
enum { HIDDEN_POINT = 2, HIDDEN_OR_DUPLICATE_CELL = 32 | 1, ANY_LEVEL = 255, TENSOR = 9, SYMMETRIC_TENSOR = 6 };

static int64_t tuple_count(const legacy *r) {
    return r->section == SECTION_CELLS ? r->block->cell_count : r->block->point_count;
}

int legacy_blank(legacy *r, int on_cells, const uint8_t *flags, int64_t count, unsigned mask) {
    uint8_t **blanked = on_cells ? &r->blanked_cells : &r->blanked_points;
    int64_t first = 0;
    while (first < count && !(flags[first] & mask)) first++;
    if (first == count) return 0;
    if (!*blanked) {
        if (!(*blanked = dataset_allocate(r->out, (uint64_t)count))) return STATUS_FAILED;
        memset(*blanked, 0, (size_t)count);
    }
    for (int64_t i = first; i < count; i++) (*blanked)[i] |= (flags[i] & mask) != 0;
    return 0;
}

static int add_field(legacy *r, const char *name, int type, int64_t components, const void *values, int is_rounded) {
    dataset_field *field;
    const char *kept = dataset_text(r->out, name);
    if (!kept || dataset_field_add(r->block, &field)) return STATUS_FAILED;
    *field = (dataset_field){.name = kept,
                             .on_cells = r->section == SECTION_CELLS,
                             .components = (int)components,
                             .type = (tc_type)type,
                             .is_rounded = is_rounded,
                             .values = values};
    return 0;
}

/* The bits of ghost flags that make a point or cell missing; 0 where the array has no such flags. Files before version
 * 4 have levels instead, above 0 where another piece owns the cell. */
static unsigned ghost_mask(const legacy *r, const char *name, int type, int64_t components) {
    if (type != TC_U8 || components != 1) return 0;
    if (!strcmp(name, "vtkGhostType")) return r->section == SECTION_CELLS ? HIDDEN_OR_DUPLICATE_CELL : HIDDEN_POINT;
    return r->major < 4 && r->section == SECTION_CELLS && !strcmp(name, "vtkGhostLevels") ? ANY_LEVEL : 0;
}

/* Reads the values of a named array of the current section. */
static int read_array(legacy *r, const char *name, int type, int64_t components) {
    void *values = NULL;
    uint64_t rounded = 0;
    int64_t count = tuple_count(r);
    int wanted = type == LEGACY_BIT ? TC_U8 : (int)element_sample_type(type);
    unsigned ghosts = ghost_mask(r, name, type, components);
    char what[LEGACY_WORD + 16];
    snprintf(what, sizeof what, "array '%.100s'", name);
    if (type >= LEGACY_STRING) {
        int failed = legacy_array(r, what, type, count, components, 0, NULL, NULL);
        return failed ? failed
                      : dataset_leave_out(r->out, name, "its type %s cannot be read",
                                          type == LEGACY_STRING ? "string" : "variant");
    }
    if (r->block->field_count == LEGACY_FIELDS)
        return legacy_fail(r, "has more than %d arrays; split it", LEGACY_FIELDS);
    int status = legacy_array(r, what, type, count, components, wanted, &values, wanted == type ? NULL : &rounded);
    if (status) return status;
    if (ghosts) return legacy_blank(r, r->section == SECTION_CELLS, values, count, ghosts);
    return add_field(r, name, wanted, components, values, rounded > 0);
}

/* The array that was added since is the section's active scalars, if it is its first. */
static void note_active(const legacy *r, int fields_before) {
    const int on_cells = r->section == SECTION_CELLS;
    dataset_block *b = r->block;
    for (int n = 0; n < fields_before; n++)
        if (b->fields[n].is_active && b->fields[n].on_cells == on_cells) return;
    if (b->field_count > fields_before) b->fields[fields_before].is_active = 1;
}

/* NAME TYPE, then the values. */
static int read_named(legacy *r, int64_t components) {
    char name[LEGACY_WORD];
    int type, status;
    if ((status = legacy_name(r, name)) || (status = legacy_type(r, &type))) return status;
    return read_array(r, name, type, components);
}

/* NAME TYPE [COMPONENTS], LOOKUP_TABLE NAME, which some writers leave out, then the values. */
static int read_scalars(legacy *r) {
    char name[LEGACY_WORD], table[LEGACY_WORD];
    int type, status;
    int64_t components = 1;
    if ((status = legacy_name(r, name)) || (status = legacy_type(r, &type))) return status;
    int goes_on = legacy_line_goes_on(r), has_table = legacy_accept(r, "LOOKUP_TABLE");
    if (goes_on && !has_table) {
        if ((status = legacy_integer(r, "the components of SCALARS", 1, INT32_MAX, &components))) return status;
        has_table = legacy_accept(r, "LOOKUP_TABLE");
    }
    if (has_table && (status = legacy_need(r, "the name of a LOOKUP_TABLE", table))) return status;
    return read_array(r, name, type, components);
}

/* NAME COMPONENTS: bytes, or in ASCII files numbers from 0 to 1, which become bytes as in VTK. */
static int read_colors(legacy *r) {
    char name[LEGACY_WORD];
    int64_t components = 0, count = tuple_count(r);
    void *values = NULL;
    int status;
    if ((status = legacy_name(r, name)) ||
        (status = legacy_integer(r, "the components of COLOR_SCALARS", 1, INT32_MAX, &components)))
        return status;
    if (r->is_binary) return read_array(r, name, TC_U8, components);
    if ((status = legacy_array(r, "COLOR_SCALARS", TC_F32, count, components, TC_F32, &values, NULL))) return status;
    const float *shares = values;
    uint8_t *bytes = dataset_allocate(r->out, (uint64_t)(count * components));
    if (!bytes) return STATUS_FAILED;
    for (int64_t i = 0; i < count * components; i++) {
        double scaled = 255.0 * (double)shares[i] + 0.5;
        bytes[i] = scaled >= 255 ? 255 : scaled > 0 ? (uint8_t)scaled : 0;
    }
    return add_field(r, name, TC_U8, components, bytes, 0);
}

static int read_texture(legacy *r) {
    char name[LEGACY_WORD];
    int64_t components = 0;
    int type, status;
    if ((status = legacy_name(r, name)) ||
        (status = legacy_integer(r, "the dimension of TEXTURE_COORDINATES", 1, 3, &components)) ||
        (status = legacy_type(r, &type)))
        return status;
    return read_array(r, name, type, components);
}

/* NAME SIZE, then red, green, blue and opacity of each entry, as bytes or as numbers. */
static int skip_table(legacy *r) {
    char name[LEGACY_WORD];
    int64_t size = 0;
    int status;
    if ((status = legacy_name(r, name)) ||
        (status = legacy_integer(r, "the size of a LOOKUP_TABLE", 0, INT32_MAX, &size)))
        return status;
    return legacy_array(r, "LOOKUP_TABLE", r->is_binary ? TC_U8 : TC_F32, size, 4, 0, NULL, NULL);
}

/* One array of FIELD: NAME COMPONENTS TUPLES TYPE, then the values. Those of the whole dataset are passed over. */
static int read_field_array(legacy *r) {
    char name[LEGACY_WORD];
    int64_t components = 0, tuples = 0;
    int type, status;
    if ((status = legacy_name(r, name)) || !strcmp(name, "NULL_ARRAY") ||
        (status = legacy_integer(r, "the components of an array of FIELD", 0, INT32_MAX, &components)) ||
        (status = legacy_integer(r, "the tuples of an array of FIELD", 0, INT64_MAX / 16, &tuples)) ||
        (status = legacy_type(r, &type)))
        return status;
    if (r->section == SECTION_GEOMETRY || !components)
        return legacy_array(r, "an array of FIELD", type, tuples, components, 0, NULL, NULL);
    if (tuples != tuple_count(r))
        return legacy_fail(r, "has %" PRId64 " tuples in array '%.100s' for %" PRId64 " %s; it is damaged", tuples,
                           name, tuple_count(r), r->section == SECTION_CELLS ? "cells" : "points");
    return read_array(r, name, type, components);
}

static int read_field(legacy *r) {
    char name[LEGACY_WORD];
    int64_t count = 0;
    int status;
    if ((status = legacy_name(r, name)) ||
        (status = legacy_integer(r, "the number of arrays of FIELD", 0, INT32_MAX, &count)))
        return status;
    for (int64_t i = 0; i < count && !status; i++) status = read_field_array(r);
    return status;
}

int legacy_attribute(legacy *r, const char *keyword, int *known) {
    static const struct {
        const char *name;
        int (*read)(legacy *r); /* or NULL: read_named */
        int components;
    } attributes[] = {{"SCALARS", read_scalars, 0},
                      {"VECTORS", NULL, 3},
                      {"NORMALS", NULL, 3},
                      {"TENSORS", NULL, TENSOR},
                      {"TENSORS6", NULL, SYMMETRIC_TENSOR},
                      {"TEXTURE_COORDINATES", read_texture, 0},
                      {"GLOBAL_IDS", NULL, 1},
                      {"PEDIGREE_IDS", NULL, 1},
                      {"EDGE_FLAGS", NULL, 1},
                      {"COLOR_SCALARS", read_colors, 0},
                      {"LOOKUP_TABLE", skip_table, 0},
                      {"FIELD", read_field, 0}};
    *known = 1;
    for (size_t i = 0; i < sizeof attributes / sizeof *attributes; i++) {
        if (strcasecmp(keyword, attributes[i].name)) continue;
        const int before = r->block->field_count;
        if (r->section == SECTION_GEOMETRY && attributes[i].read != read_field)
            return legacy_fail(r, "has %s before POINT_DATA or CELL_DATA, so that it belongs to neither", keyword);
        int status = attributes[i].read ? attributes[i].read(r) : read_named(r, attributes[i].components);
        if (attributes[i].read == read_scalars || attributes[i].read == read_colors) note_active(r, before);
        return status;
    }
    *known = 0;
    return 0;
}
