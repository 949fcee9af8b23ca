/*
 * vtk_hdf.c - UnstructuredGrid of VTKHDF files, with its parts and steps of time
 *
 * Every part has points, cells and fields of its own, which lie one behind the other in the arrays of the file. Parts
 * are joined to one grid, as pieces of parallel VTK XML are.
 *
 * Source: "VTKHDF File Format", in VTK's file format documentation (docs.vtk.org), and what VTK 9.7 writes.
 */
#define H5_USE_110_API

#include "vtk_hdf/vtk_hdf.h"

#include "dataset/cell_faces.h"
#include "exit_status.h"
#include "failure.h"
#include "image/image.h"
#include "stored_types.h"
#include "vtk_hdf/vtk_hdf_grid.h"
#include "vtk_parallel/pieces.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PARTS_MOST = 1 << 20 };

/* ------------------------------------------------------------------------------------------------------------ steps */

/* A number of the step, of an array that not every file has: *value stays where there is none. */
static int read_offset(hdf_grid *g, hid_t steps, const char *name, int64_t *value) {
    char path[NAME_BYTES + 40];
    const int64_t *values;
    int64_t count;
    hdf_values v;
    if (!hdf5_has(steps, name)) return 0;
    snprintf(path, sizeof path, ROOT "Steps/%s", name);
    int status = hdf_load(g->r, path, (hdf_rows){g->step.number, 1}, &v); /* of cells it may be of several kinds */
    if (status) return status;
    if (v.components == 1) {
        status = hdf_load_integers(g->r, path, (hdf_rows){g->step.number, 1}, &values, &count);
        if (!status) *value = *values;
    } else if (v.element == ELEMENT_I64) {
        memcpy(value, v.values, sizeof *value);
    }
    if (!status && *value < 0) status = fail(STATUS_INPUT, "%s: '%s' is below 0", g->r->h.path, path);
    return status;
}

static int choose_step(hdf_grid *g, double count) {
    const read_request *q = g->request;
    g->step.count = count >= 1 && count < 0x1p31 ? (int64_t)count : 1;
    if (g->step.count > 1 && q->frame < 0 && !q->describe)
        return fail(STATUS_USAGE, "%s: holds %" PRId64 " steps of time: choose by --frame one, from 0 to %" PRId64,
                    q->path, g->step.count, g->step.count - 1);
    if (q->frame >= g->step.count)
        return fail(STATUS_USAGE, "%s: holds %" PRId64 " steps of time, counted from 0: there is no --frame %d",
                    q->path, g->step.count, q->frame);
    g->step.number = q->frame > 0 ? q->frame : 0;
    if (g->step.count > 1 && q->frame < 0)
        dataset_notice(g->r->out, "holds %" PRId64 " steps of time: the first is described", g->step.count);
    return 0;
}

static int find_step(hdf_grid *g) {
    double count = 0;
    g->step.parts.count = -1;
    const hid_t steps = hdf5_open_group(&g->r->h, ROOT "Steps");
    if (steps < 0) {
        if (g->request->frame > 0) return fail(STATUS_USAGE, "%s: has one frame; leave out --frame", g->request->path);
        return 0;
    }
    hdf5_read_numbers(steps, "NSteps", &count, 1);
    int status = choose_step(g, count);
    if (!status) status = read_offset(g, steps, "PartOffsets", &g->step.parts.first);
    if (!status) status = read_offset(g, steps, "NumberOfParts", &g->step.parts.count);
    if (!status) status = read_offset(g, steps, "PointOffsets", &g->step.points);
    if (!status) status = read_offset(g, steps, "CellOffsets", &g->step.cells);
    if (!status) status = read_offset(g, steps, "ConnectivityIdOffsets", &g->step.corners);
    H5Gclose(steps);
    if (!status && g->step.parts.count < 0) g->step.parts.count = 1;
    if (!status && __builtin_add_overflow(g->step.cells, g->step.parts.first, &g->step.ends))
        status = fail(STATUS_INPUT, "%s: the offsets of its steps make no sense; the file is damaged", g->r->h.path);
    return status; /* every part before has one end more than cells */
}

/* ------------------------------------------------------------------------------------------------------------ parts */

static int read_counts(hdf_grid *g, const char *name, const int64_t **counts, int64_t *sum) {
    int64_t parts;
    int status = hdf_load_integers(g->r, name, g->step.parts, counts, &parts);
    if (status) return status;
    if (parts > PARTS_MOST) return fail(STATUS_INPUT, "%s: has more than %d parts", g->r->h.path, PARTS_MOST);
    if (g->part_count && parts != g->part_count)
        return fail(STATUS_INPUT, "%s: its arrays tell of %" PRId64 " parts, and of %" PRId64 "; the file is damaged",
                    g->r->h.path, g->part_count, parts);
    g->part_count = parts;
    *sum = 0;
    for (int64_t n = 0; n < parts; n++)
        if ((*counts)[n] < 0 || __builtin_add_overflow(*sum, (*counts)[n], sum) || *sum > INT64_MAX / 64)
            return fail(STATUS_INPUT, "%s: '%s' makes no sense; the file is damaged", g->r->h.path, name);
    return 0;
}

static int read_all_counts(hdf_grid *g) {
    int status = read_counts(g, ROOT "NumberOfPoints", &g->point_counts, &g->point_count);
    if (!status) status = read_counts(g, ROOT "NumberOfCells", &g->cell_counts, &g->cell_count);
    if (!status) status = read_counts(g, ROOT "NumberOfConnectivityIds", &g->corner_counts, &g->corner_count);
    if (!status && !g->point_count) status = fail(STATUS_INPUT, "%s: holds no points", g->r->h.path);
    return status;
}

static int make_blocks(hdf_grid *g) {
    for (int64_t n = 0; n < g->part_count; n++) {
        dataset_block *b;
        if (dataset_block_add(&g->parts, &b)) return STATUS_FAILED;
        b->kind = BLOCK_UNSTRUCTURED;
        b->point_count = g->point_counts[n];
        b->cell_count = g->cell_counts[n];
    }
    return 0;
}

static int load_points(hdf_grid *g) {
    hdf_values v;
    int status = hdf_load(g->r, ROOT "Points", (hdf_rows){g->step.points, g->point_count}, &v);
    if (status) return status;
    if (v.components != 3 || !element_is_real(v.element))
        return fail(STATUS_INPUT, "%s: its Points are not of three numbers of floating point each", g->r->h.path);
    for (int64_t n = 0, at = 0; n < g->part_count; at += 3 * g->point_counts[n++]) {
        coordinates *c = &g->parts.blocks[n].points;
        if (v.element == TC_F64)
            c->f64 = (const double *)v.values + at;
        else
            c->f32 = (const float *)v.values + at;
    }
    return 0;
}

static int wrong_cells(const hdf_grid *g, int64_t part, const char *what) {
    return fail(STATUS_INPUT, "%s: the cells of its part %" PRId64 " %s; the file is damaged", g->r->h.path, part,
                what);
}

/* Each part's offsets begin at 0, and end with what NumberOfConnectivityIds says. */
static int check_cells(const hdf_grid *g, int64_t part) {
    const dataset_block *b = &g->parts.blocks[part];
    if (b->cell_offsets[0] != 0 || b->cell_offsets[b->cell_count] > g->corner_counts[part])
        return wrong_cells(g, part, "have other Offsets than NumberOfConnectivityIds says");
    for (int64_t c = 0; c < b->cell_count; c++)
        if (b->cell_offsets[c + 1] < b->cell_offsets[c]) return wrong_cells(g, part, "have Offsets that fall");
    for (int64_t n = 0; n < b->cell_offsets[b->cell_count]; n++)
        if (b->cell_points[n] < 0 || b->cell_points[n] >= b->point_count)
            return wrong_cells(g, part, "name a point that it does not have");
    return 0;
}

static int load_cells(hdf_grid *g) {
    const int64_t *ends = NULL, *corners = NULL;
    int64_t count, at = 0, corner = 0;
    hdf_values types;
    int status = hdf_load(g->r, ROOT "Types", (hdf_rows){g->step.cells, g->cell_count}, &types);
    if (!status && (types.element != TC_U8 || types.components != 1))
        status = fail(STATUS_INPUT, "%s: its Types are not single bytes", g->r->h.path);
    if (!status)
        status = hdf_load_integers(g->r, ROOT "Offsets", (hdf_rows){g->step.ends, g->cell_count + g->part_count}, &ends,
                                   &count);
    if (!status)
        status = hdf_load_integers(g->r, ROOT "Connectivity", (hdf_rows){g->step.corners, g->corner_count}, &corners,
                                   &count);
    for (int64_t n = 0; n < g->part_count && !status; n++) {
        dataset_block *b = &g->parts.blocks[n];
        b->cell_types = (const uint8_t *)types.values + at;
        b->cell_offsets = ends + at + n;
        b->cell_points = corners + corner;
        at += g->cell_counts[n];
        corner += g->corner_counts[n];
        status = check_cells(g, n);
    }
    return status;
}

/* ------------------------------------------------------------------------------------------------------------ faces */

typedef struct face_arrays {
    const int64_t *counts, *corner_counts,
        *named_counts; /* of faces, their points, and their names in cells, per part */
    const int64_t *ends, *points, *named, *cell_ends;
} face_arrays;

static int load_face_arrays(hdf_grid *g, face_arrays *f) {
    int64_t faces, corners, named, count;
    const int64_t parts = g->part_count;
    int status = read_counts(g, ROOT "NumberOfFaces", &f->counts, &faces);
    if (!status) status = read_counts(g, ROOT "NumberOfFaceConnectivityIds", &f->corner_counts, &corners);
    if (!status) status = read_counts(g, ROOT "NumberOfPolyhedronToFaceIds", &f->named_counts, &named);
    if (!status) status = hdf_load_integers(g->r, ROOT "FaceOffsets", (hdf_rows){0, faces + parts}, &f->ends, &count);
    if (!status) status = hdf_load_integers(g->r, ROOT "FaceConnectivity", (hdf_rows){0, corners}, &f->points, &count);
    if (!status) status = hdf_load_integers(g->r, ROOT "PolyhedronToFaces", (hdf_rows){0, named}, &f->named, &count);
    if (!status)
        status = hdf_load_integers(g->r, ROOT "PolyhedronOffsets", (hdf_rows){0, g->cell_count + parts}, &f->cell_ends,
                                   &count);
    return status;
}

/* Files have such arrays where a cell is a polyhedron. */
static int load_faces(hdf_grid *g, hid_t root) {
    face_arrays f;
    int64_t face = 0, corner = 0, named = 0, cell = 0;
    int has_polyhedra = 0;
    for (int64_t n = 0; n < g->part_count && !has_polyhedra; n++)
        has_polyhedra =
            g->cell_counts[n] && memchr(g->parts.blocks[n].cell_types, CELL_POLYHEDRON, (size_t)g->cell_counts[n]);
    if (!has_polyhedra || !hdf5_has(root, "FaceConnectivity")) return 0;
    if (g->step.count > 1)
        return fail(STATUS_INPUT, "%s: holds polyhedra in several steps of time, which are not read; save one step",
                    g->r->h.path);
    int status = load_face_arrays(g, &f);
    for (int64_t n = 0; n < g->part_count && !status; n++) {
        const face_lists lists = {.cell_ends = f.cell_ends + cell + n + 1,
                                  .faces = f.named + named,
                                  .face_ends = f.ends + face + n + 1,
                                  .points = f.points + corner,
                                  .face_count = f.counts[n]};
        const int64_t last_cell = g->cell_counts[n] ? lists.cell_ends[g->cell_counts[n] - 1] : 0;
        const int64_t last_face = f.counts[n] ? lists.face_ends[f.counts[n] - 1] : 0;
        if (last_cell > f.named_counts[n] || last_face > f.corner_counts[n])
            status = wrong_cells(g, n, "have other faces than the numbers of faces say");
        if (!status) status = cell_faces_gather(&g->parts, &g->parts.blocks[n], g->r->h.path, &lists);
        face += f.counts[n];
        corner += f.corner_counts[n];
        named += f.named_counts[n];
        cell += g->cell_counts[n];
    }
    return status;
}

/* ------------------------------------------------------------------------------------------------------------- grid */

/* Parts with points, as pieces of a list. */
static int join_parts(hdf_grid *g) {
    const vtk_index index = {.path = g->request->path, .kind = BLOCK_UNSTRUCTURED};
    piece_list list = {.request = g->request, .index = &index, .parts = &g->parts, .part_count = 1};
    int status = 0;
    if (!(list.pieces = calloc((size_t)g->part_count, sizeof *list.pieces)))
        return fail(STATUS_FAILED, "%s: no memory for the list of its parts", index.path);
    for (int64_t n = 0; n < g->part_count && !status; n++) {
        char label[600];
        if (!g->point_counts[n]) continue;
        snprintf(label, sizeof label, "%.500s, part %" PRId64, index.path, n);
        grid_piece *piece = &list.pieces[list.count++];
        piece->block = &g->parts.blocks[n];
        if (!(piece->path = dataset_text(g->r->out, label))) status = STATUS_FAILED;
    }
    if (!status) status = cell_pieces_join(&list, g->r->out);
    free(list.pieces);
    return status;
}

static int read_grid(hdf_grid *g) {
    int status = find_step(g);
    if (!status) status = read_all_counts(g);
    if (!status) status = make_blocks(g);
    if (!status) status = load_points(g);
    if (!status) status = load_cells(g);
    const hid_t root = status ? -1 : hdf5_open_group(&g->r->h, "/VTKHDF");
    if (!status) status = load_faces(g, root);
    if (root >= 0) H5Gclose(root);
    if (!status) status = hdf_load_fields(g, 0);
    if (!status) status = hdf_load_fields(g, 1);
    if (status) return status;
    return g->part_count == 1 ? dataset_absorb(g->r->out, &g->parts) : join_parts(g);
}

static int read_unstructured(hdf_reader *r, const read_request *request) {
    hdf_grid g = {.r = r, .request = request};
    int status = dataset_map(r->out, request->path, &r->file);
    if (!status) status = read_grid(&g);
    dataset_release(&g.parts);
    if (!status && r->uses_file) {
        r->out->mapping = (void *)(uintptr_t)r->file.bytes;
        r->out->mapping_bytes = r->file.size;
    } else {
        mapping_close(&r->file);
    }
    if (!status) snprintf(r->out->format, sizeof r->out->format, "VTKHDF");
    return status;
}

/* What VTKHDF file it is; "" where it is none. */
static int find_type(hdf_reader *r, const read_request *request, const mapping *file, char type[HDF5_TEXT_BYTES]) {
    type[0] = '\0';
    if (request->inside) return 0;
    int status = hdf5_open_file(&r->h, request->path, file);
    const hid_t group = status ? -1 : hdf5_open_group(&r->h, "/VTKHDF");
    if (group < 0) return status;
    hdf5_read_text(group, "Type", type);
    H5Gclose(group);
    return 0;
}

int vtk_hdf_read(const read_request *request, const mapping *file, dataset *out) {
    hdf_reader r = {.h = {.path = request->path, .file = -1, .dataset = -1}, .out = out};
    char type[HDF5_TEXT_BYTES];
    int is_image = 0, status = find_type(&r, request, file, type);
    if (!status && strcmp(type, "UnstructuredGrid") == 0)
        status = read_unstructured(&r, request);
    else if (!status && *type && strcmp(type, "ImageData") != 0)
        status = fail(STATUS_INPUT, "%s: holds %.40s%s; of VTKHDF, ImageData and UnstructuredGrid are read",
                      request->path, type, strcmp(type, "PolyData") ? "" : ", a surface, which has no isosurfaces");
    else if (!status)
        is_image = 1;
    if (r.h.file >= 0) hdf5_close(&r.h);
    return is_image ? hdf5_read(request, file, out) : status;
}
