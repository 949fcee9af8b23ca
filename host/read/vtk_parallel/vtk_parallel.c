/*
 * vtk_parallel.c - VTK XML files that name others; see index.h
 *
 * Every file is read by the reader of serial files, into a dataset of its own. Pieces are then joined to one block;
 * blocks go into the dataset one after the other. A file counts once: a short list must not ask for a large one again
 * and again.
 */
#include "vtk_parallel/vtk_parallel.h"

#include "exit_status.h"
#include "failure.h"
#include "file/xml_root.h"
#include "stored_types.h"
#include "vtk_parallel/pieces.h"
#include "vtk_xml/vtk_xml.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEEPEST = 3 }; /* lists of blocks that name lists of pieces */

static int read_index(const read_request *request, const mapping *file, int depth, dataset *out);

/* ------------------------------------------------------------------------------------------------------------ files */

/* The request of one file: parts are cut, and options of placement used, when the grid is whole. */
static read_request request_of(const read_request *request, const char *path) {
    read_request own = *request;
    own.path = path;
    own.has_spacing = own.has_origin = 0;
    own.region = (region_request){0};
    own.like = NULL;
    return own;
}

static int was_read(const file_list *files, file_identity file) {
    for (size_t n = 0; n + 1 < files->count; n++) /* the last one is the file itself */
        if (files->files[n].device == file.device && files->files[n].inode == file.inode) return 1;
    return 0;
}

static int open_file(const vtk_index *x, int64_t n, dataset *out, mapping *m, char type[XML_TYPE_BYTES]) {
    const char *path = x->files.paths[n];
    int status = data_names_open(x->path, path, out, m);
    if (status) return status;
    if (was_read(&out->files, m->identity))
        status = fail(STATUS_INPUT, "%s: names the file %s twice; each has to be there once", x->path, path);
    else if (!xml_root_type(m, type))
        status = fail(STATUS_INPUT, "%s: is no VTK XML file, but %s names it as one", path, x->path);
    if (status) mapping_close(m);
    return status;
}

/* ----------------------------------------------------------------------------------------------------------- pieces */

static const char *kind_name(enum block_kind kind) {
    static const char *const names[] = {"ImageData", "RectilinearGrid", "StructuredGrid", "UnstructuredGrid"};
    return names[kind];
}

static int read_piece(piece_list *list, int64_t n, dataset *out) {
    const vtk_index *x = list->index;
    char type[XML_TYPE_BYTES];
    mapping m;
    int status = open_file(x, n, out, &m, type);
    if (status) return status;
    if (strcmp(type, kind_name(x->kind)) != 0) {
        status = fail(STATUS_INPUT, "%s: holds %s, but %s lists pieces of %s", x->files.paths[n],
                      *type ? type : "no named type of data", x->path, kind_name(x->kind));
        mapping_close(&m);
        return status;
    }
    const read_request own = request_of(list->request, x->files.paths[n]);
    status = vtk_xml_read_piece(&own, &m, &list->parts[n]);
    return status ? status : dataset_notices_of(out, &list->parts[n]);
}

/* The blocks of all files, in their order. */
static int list_pieces(piece_list *list) {
    const vtk_index *x = list->index;
    size_t blocks = 0;
    for (size_t n = 0; n < list->part_count; n++) blocks += (size_t)list->parts[n].block_count;
    if (!blocks) return fail(STATUS_INPUT, "%s: holds no points: none of its pieces has any", x->path);
    if (!(list->pieces = calloc(blocks, sizeof *list->pieces)))
        return fail(STATUS_FAILED, "%s: no memory for the list of its pieces", x->path);
    for (size_t n = 0; n < list->part_count; n++)
        for (int b = 0; b < list->parts[n].block_count; b++) {
            list->pieces[list->count] = (grid_piece){x->files.paths[n], &list->parts[n].blocks[b], n, {{0}, {0}}};
            if (x->extents) list->pieces[list->count].extent = x->extents[n];
            list->count++;
        }
    return 0;
}

static int lacks_field(const grid_piece *piece, const dataset_field *f, const grid_piece *other) {
    return fail(STATUS_INPUT, "%s: has no array '%.60s' of %s, which %s has: pieces have to have the same arrays",
                piece->path, f->name, f->on_cells ? "cells" : "points", other->path);
}

static int check_fields(const piece_list *list) {
    const grid_piece *first = list->pieces;
    for (size_t p = 1; p < list->count; p++) {
        const grid_piece *piece = &list->pieces[p];
        for (int n = 0; n < first->block->field_count; n++) {
            const dataset_field *f = &first->block->fields[n], *own = piece_field(piece->block, first->block, n);
            if (!own) return lacks_field(piece, f, first);
            if (own->type != f->type || own->components != f->components)
                return fail(STATUS_INPUT,
                            "%s: its array '%.60s' has %d values of %s each, that of %s %d of %s: pieces have to have "
                            "the same arrays",
                            piece->path, f->name, own->components, stored_types[own->type].vtk_xml, first->path,
                            f->components, stored_types[f->type].vtk_xml);
        }
        for (int n = 0; n < piece->block->field_count; n++)
            if (!piece_field(first->block, piece->block, n)) return lacks_field(first, &piece->block->fields[n], piece);
    }
    return 0;
}

static int read_pieces(const read_request *request, const vtk_index *x, dataset *out) {
    piece_list list = {.request = request, .index = x, .part_count = (size_t)x->files.count};
    int status = 0;
    if (!(list.parts = calloc(list.part_count, sizeof *list.parts)))
        status = fail(STATUS_FAILED, "%s: no memory for the list of its pieces", x->path);
    for (int64_t n = 0; n < x->files.count && !status; n++) status = read_piece(&list, n, out);
    if (!status) status = list_pieces(&list);
    if (!status) status = check_fields(&list);
    if (!status) status = x->kind == BLOCK_UNSTRUCTURED ? cell_pieces_join(&list, out) : grid_pieces_join(&list, out);
    for (size_t n = 0; n < list.part_count && list.parts; n++) dataset_release(&list.parts[n]);
    free(list.parts);
    free(list.pieces);
    return status;
}

/* ----------------------------------------------------------------------------------------------------------- blocks */

static int read_block(const read_request *request, const vtk_index *x, int64_t n, int depth, dataset *out) {
    char type[XML_TYPE_BYTES];
    mapping m;
    dataset block = {0};
    const read_request own = request_of(request, x->files.paths[n]);
    int status = open_file(x, n, out, &m, type);
    if (status) return status;
    if (strcmp(type, "PolyData") == 0 || strcmp(type, "PPolyData") == 0) {
        dataset_notice(out, "blocks of PolyData, surfaces, are left out");
        mapping_close(&m);
        return 0;
    }
    if (xml_type_is_index(type)) {
        status = read_index(&own, &m, depth + 1, out); /* into the same dataset, which knows the files read */
        mapping_close(&m);
        return status;
    }
    status = vtk_xml_read_piece(&own, &m, &block);
    if (!status) status = dataset_absorb(out, &block);
    dataset_release(&block);
    return status;
}

static int read_blocks(const read_request *request, const vtk_index *x, int depth, dataset *out) {
    int status = 0;
    if (depth == DEEPEST)
        return fail(STATUS_INPUT, "%s: is a list that another list names, more than %d deep", x->path, DEEPEST);
    for (int64_t n = 0; n < x->files.count && !status; n++) status = read_block(request, x, n, depth, out);
    if (!status && !depth && !out->block_count)
        status = fail(STATUS_INPUT, "%s: holds no grid with points: none of its blocks is one", x->path);
    return status;
}

static int read_index(const read_request *request, const mapping *file, int depth, dataset *out) {
    vtk_index x;
    int status = vtk_index_parse(request->path, file, &x);
    if (!status) status = x.is_list ? read_blocks(request, &x, depth, out) : read_pieces(request, &x, out);
    vtk_index_release(&x);
    return status;
}

int vtk_parallel_read(const read_request *request, const mapping *file, dataset *out) {
    int status = read_index(request, file, 0, out);
    if (!status) snprintf(out->format, sizeof out->format, "VTK XML");
    return status;
}
