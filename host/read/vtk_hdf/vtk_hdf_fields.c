/* vtk_hdf_fields.c - the fields of an unstructured grid of VTKHDF; see vtk_hdf_grid.h */
#define H5_USE_110_API

#include "dataset/layout.h"
#include "exit_status.h"
#include "failure.h"
#include "stored_types.h"
#include "vtk_hdf/vtk_hdf_grid.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FIELDS_MOST = 4096 };

typedef struct field_names {
    char (*names)[NAME_BYTES];
    int count, no_memory;
} field_names;

/* Links to other places are none of VTK's. */
static herr_t note_name(hid_t group, const char *name, const H5L_info_t *info, void *user) {
    field_names *f = user;
    (void)group;
    if (info->type != H5L_TYPE_HARD || strlen(name) >= NAME_BYTES || f->count == FIELDS_MOST) return 0;
    if ((f->count & (f->count - 1)) == 0) {
        char(*grown)[NAME_BYTES] = realloc(f->names, (size_t)(f->count ? 2 * f->count : 1) * sizeof *grown);
        if (!grown) {
            f->no_memory = 1;
            return -1;
        }
        f->names = grown;
    }
    snprintf(f->names[f->count++], NAME_BYTES, "%s", name);
    return 0;
}

/* What VTK calls the array: an attribute of it, or, in older files, one of its group that has its name. */
static int is_called(const hdf_grid *g, hid_t group, const char *name, const char *what) {
    char text[HDF5_TEXT_BYTES];
    hdf5_read_text(g->r->h.dataset, "Attribute", text);
    if (strcmp(text, what) == 0) return 1;
    hdf5_read_text(group, what, text);
    return strcmp(text, name) == 0;
}

/* A byte for each point or cell of a part: the bits that say it is missing. */
static int load_blanked(hdf_grid *g, const hdf_values *v, int on_cells) {
    const uint8_t *flags = v->values;
    const int bits = on_cells ? GHOST_CELL : POINT_IS_HIDDEN;
    uint8_t *blanked = dataset_allocate(g->r->out, (uint64_t)v->rows);
    if (!blanked) return STATUS_FAILED;
    for (int64_t n = 0; n < v->rows; n++) blanked[n] = (uint8_t)(flags[n] & bits);
    for (int64_t n = 0, at = 0; n < g->part_count; n++) {
        dataset_block *b = &g->parts.blocks[n];
        const int64_t count = on_cells ? b->cell_count : b->point_count;
        int any = 0;
        for (int64_t i = 0; i < count && !any; i++) any = blanked[at + i];
        if (any) *(on_cells ? &b->blanked_cells : &b->blanked_points) = blanked + at;
        at += count;
    }
    return 0;
}

/* 64-bit integers become doubles; the nearest where none is equal. */
static int widen(hdf_grid *g, hdf_values *v, dataset_field *f) {
    const uint64_t count = (uint64_t)v->rows * (uint64_t)v->components;
    layout convert = {.element = v->element, .dims = {(int64_t)count, 1, 1}, .stride = {1, 0, 0}};
    void *memory = dataset_allocate(g->r->out, count * sizeof(double));
    if (!memory) return STATUS_FAILED;
    if (count) f->is_rounded = layout_gather(g->r->h.path, &convert, v->values, memory) != 0; /* filled in any case */
    v->values = memory;
    return 0;
}

static int add_field(hdf_grid *g, const dataset_field *field, const hdf_values *v) {
    const size_t tuple = (size_t)field->components * sample_bytes(field->type);
    const unsigned char *at = v->values;
    for (int64_t n = 0; n < g->part_count; n++) {
        dataset_block *b = &g->parts.blocks[n];
        dataset_field *added;
        if (dataset_field_add(b, &added)) return STATUS_FAILED;
        *added = *field;
        added->values = at;
        at += tuple * (size_t)(field->on_cells ? b->cell_count : b->point_count);
    }
    return 0;
}

/* Where a step begins in an array of fields: it may say so itself. */
static int find_rows(hdf_grid *g, const char *name, int on_cells, hdf_rows *rows) {
    *rows = on_cells ? (hdf_rows){g->step.cells, g->cell_count} : (hdf_rows){g->step.points, g->point_count};
    if (!g->step.count) return 0;
    const hid_t offsets =
        hdf5_open_group(&g->r->h, on_cells ? ROOT "Steps/CellDataOffsets" : ROOT "Steps/PointDataOffsets");
    if (offsets < 0) return 0;
    char path[NAME_BYTES + 40];
    const int is_there = hdf5_has(offsets, name);
    const int64_t *first;
    int64_t count;
    H5Gclose(offsets);
    if (!is_there) return 0;
    snprintf(path, sizeof path, ROOT "Steps/%sDataOffsets/%s", on_cells ? "Cell" : "Point", name);
    int status = hdf_load_integers(g->r, path, (hdf_rows){g->step.number, 1}, &first, &count);
    if (!status) rows->first = *first;
    return status;
}

static int load_field(hdf_grid *g, hid_t group, const char *name, int on_cells) {
    char path[NAME_BYTES + 40];
    hdf_values v;
    hdf_rows rows;
    int status = find_rows(g, name, on_cells, &rows);
    if (status) return status;
    snprintf(path, sizeof path, ROOT "%sData/%s", on_cells ? "Cell" : "Point", name);
    if (hdf5_open_array(&g->r->h, path)) /* strings, groups, numbers of odd types */
        return dataset_leave_out(g->r->out, name, "it is no array of numbers that can be read");
    if ((status = hdf_load(g->r, path, rows, &v))) return status;
    if (strcmp(name, "vtkGhostType") == 0 && v.components == 1 && v.element == TC_U8)
        return load_blanked(g, &v, on_cells);
    dataset_field f = {.name = dataset_text(g->r->out, name),
                       .on_cells = on_cells,
                       .components = v.components,
                       .type = element_sample_type(v.element),
                       .is_active = is_called(g, group, name, "Scalars"),
                       .is_number = is_called(g, group, name, "GlobalIds")};
    if (!f.name) return STATUS_FAILED;
    if (v.element >= SAMPLE_TYPE_COUNT) status = widen(g, &v, &f);
    return status ? status : add_field(g, &f, &v);
}

int hdf_load_fields(hdf_grid *g, int on_cells) {
    field_names f = {0};
    int status = 0;
    const hid_t group = hdf5_open_group(&g->r->h, on_cells ? ROOT "CellData" : ROOT "PointData");
    if (group < 0) return 0;
    if (H5Literate(group, H5_INDEX_NAME, H5_ITER_NATIVE, NULL, note_name, &f) < 0 && !f.no_memory)
        status = hdf5_fail(&g->r->h, "its list of arrays cannot be read");
    if (f.no_memory) status = fail(STATUS_FAILED, "%s: no memory for the names of its arrays", g->r->h.path);
    for (int n = 0; n < f.count && !status; n++) status = load_field(g, group, f.names[n], on_cells);
    free(f.names);
    H5Gclose(group);
    return status;
}
