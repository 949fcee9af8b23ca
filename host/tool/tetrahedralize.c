/*
 * tetrahedralize.c - the converter as a command: read, cut all cells, write the complex with the fields at its points
 *
 * Blocks follow each other, as do their points; nothing is merged. Fields are those that every block has.
 */
#include "command_line/option_effects.h"
#include "commands.h"
#include "counted.h"
#include "exit_status.h"
#include "failure.h"
#include "input/blocks.h"
#include "input/face_faults.h"
#include "input/input.h"
#include "mesh_write.h"
#include "output.h"
#include "progress.h"
#include "terminal/json_report.h"
#include "terminal/notice.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct conversion {
    const options *o;
    read_request request;
    dataset data; /* owns what is joined, too */
    scalar field;
    block_list blocks;
    complex_faces faces;
    complex_file file;
    uint64_t flat, curved, blanked, inverted, folded, unsupported, surplus;
    double total_ms;
} conversion;

static int check_usage(const options *o) {
    if (!o->output) return fail(STATUS_USAGE, "tetrahedralize needs -o FILE, the unstructured grid to write: .vtu");
    int status = complex_write_check(o->output, o->format);
    if (!status) status = input_overwrite_check(o, NULL, "-o", o->output);
    return status ? status : output_check(o->output);
}

static int read_input(conversion *c) {
    int has_choice = 0, status = input_request(c->o, &c->request);
    if (!status) status = input_read(&c->request, &c->data);
    if (!status) status = input_overwrite_check(c->o, &c->data, "-o", c->o->output);
    if (!status) status = input_has_choice(&c->request, &c->data, &has_choice);
    if (!status) status = option_effects_check_input(c->o, &c->data, !has_choice);
    if (!status && has_choice) status = input_select(&c->request, &c->data, &c->field);
    return status ? status : progress_status();
}

static int cut(conversion *c) {
    int status = blocks_cut(c->o, &c->data, c->field.blocks ? &c->field : NULL, 1, &c->blocks);
    for (int n = 0; n < c->blocks.count; n++) {
        const tc_tetrahedra *one = &c->blocks.blocks[n].complex;
        c->flat += one->flat_cell_count;
        c->curved += one->curved_cell_count;
        c->blanked += one->blanked_cell_count;
        c->inverted += one->inverted_cell_count;
        c->folded += one->folded_cell_count;
        c->unsupported += one->unsupported_cell_count;
        c->surplus += one->surplus_cell_count;
        c->file.point_count += (uint64_t)c->data.blocks[n].point_count;
        c->file.tetrahedron_count += one->tetrahedron_count;
    }
    if (!status && c->file.point_count > UINT32_MAX)
        return fail(STATUS_FAILED, "%s: %" PRIu64 " points are more than the 2^32 - 1 that a complex numbers",
                    c->o->operands[0], c->file.point_count);
    if (!status) status = face_faults_find(&c->blocks, NULL, &c->faces);
    if (!status) face_faults_tell(&c->faces);
    return status ? status : progress_status();
}

/* --------------------------------------------------------------------------------------------------------- joining */

/* World coordinate r of a point of a uniform grid, in float32 as the library computes it for vertices. */
static float uniform_f32(const dataset_block *b, const int64_t p[3], int r) {
    const double *m = b->matrix[r];
    const float x = (float)(b->first[0] + p[0]), y = (float)(b->first[1] + p[1]), z = (float)(b->first[2] + p[2]);
    return (((float)m[0] * x + (float)m[1] * y) + (float)m[2] * z) + (float)m[3];
}

static double uniform_f64(const dataset_block *b, const int64_t p[3], int r) {
    const double *m = b->matrix[r];
    const double x = (double)(b->first[0] + p[0]), y = (double)(b->first[1] + p[1]), z = (double)(b->first[2] + p[2]);
    return ((m[0] * x + m[1] * y) + m[2] * z) + m[3];
}

/* Whether float32 would move points by more than 2^-12 of a cell. Looks at the corners, where numbers are largest. */
static int uniform_needs_f64(const dataset_block *b) {
    for (int corner = 0; corner < 8; corner++)
        for (int r = 0; r < 3; r++) {
            int64_t p[3];
            double cell = 0;
            for (int axis = 0; axis < 3; axis++) {
                p[axis] = corner >> axis & 1 ? b->dims[axis] - 1 : 0;
                cell = fmax(cell, fabs(b->matrix[r][axis]));
            }
            if (fabs(uniform_f64(b, p, r) - (double)uniform_f32(b, p, r)) > cell * 0x1p-12) return 1;
        }
    return 0;
}

static int needs_f64(const dataset_block *b) {
    if (b->kind == BLOCK_UNIFORM) return uniform_needs_f64(b);
    return b->kind == BLOCK_RECTILINEAR ? b->axes[0].f64 || b->axes[1].f64 || b->axes[2].f64 : b->points.f64 != NULL;
}

/* World coordinate r of a structured grid's point. */
static double position_of(const dataset_block *b, const int64_t p[3], int r, int is_f64) {
    if (b->kind == BLOCK_RECTILINEAR) return coordinate_at(b->axes[r], p[r]);
    return is_f64 ? uniform_f64(b, p, r) : (double)uniform_f32(b, p, r);
}

static void put_coordinate(const complex_file *file, uint64_t n, double value) {
    if (file->points_f64)
        ((double *)(uintptr_t)file->points_f64)[n] = value;
    else
        ((float *)(uintptr_t)file->points)[n] = (float)value;
}

/* Positions of a block's points, to the file's from number n on. */
static void put_points(const dataset_block *b, const complex_file *file, uint64_t n) {
    if (b->kind == BLOCK_CURVILINEAR || b->kind == BLOCK_UNSTRUCTURED) {
        for (int64_t at = 0; at < 3 * b->point_count; at++) put_coordinate(file, n++, coordinate_at(b->points, at));
        return;
    }
    int64_t p[3];
    for (p[2] = 0; p[2] < b->dims[2]; p[2]++)
        for (p[1] = 0; p[1] < b->dims[1]; p[1]++)
            for (p[0] = 0; p[0] < b->dims[0]; p[0]++)
                for (int r = 0; r < 3; r++) put_coordinate(file, n++, position_of(b, p, r, file->points_f64 != NULL));
}

static int join_points(conversion *c) {
    int is_f64 = 0;
    for (int n = 0; n < c->data.block_count; n++) is_f64 = is_f64 || needs_f64(&c->data.blocks[n]);
    void *points = dataset_allocate(&c->data, c->file.point_count * 3 * (is_f64 ? sizeof(double) : sizeof(float)));
    uint64_t first = 0;
    if (!points) return STATUS_FAILED;
    if (is_f64)
        c->file.points_f64 = points;
    else
        c->file.points = points;
    for (int n = 0; n < c->data.block_count; n++) {
        put_points(&c->data.blocks[n], &c->file, first);
        first += 3 * (uint64_t)c->data.blocks[n].point_count;
    }
    return 0;
}

static int join_tetrahedra(conversion *c) {
    uint64_t values = 4 * c->file.tetrahedron_count;
    uint32_t first = 0, *to;
    c->file.tetrahedra = c->blocks.blocks[0].complex.tetrahedra;
    if (c->blocks.count == 1) return 0;
    if (!(to = dataset_allocate(&c->data, values * sizeof *to))) return STATUS_FAILED;
    c->file.tetrahedra = to;
    for (int n = 0; n < c->blocks.count; n++) {
        const tc_tetrahedra *one = &c->blocks.blocks[n].complex;
        for (uint64_t m = 0; m < 4 * one->tetrahedron_count; m++) *to++ = one->tetrahedra[m] + first;
        first += (uint32_t)c->data.blocks[n].point_count;
    }
    return 0;
}

/* Whether the blocks' values can follow each other in one array. */
static int fits_together(const conversion *c, const char *name) {
    const dataset_field *first = block_field(c->data.blocks, name);
    for (int n = 1; n < c->data.block_count; n++) {
        const dataset_field *f = block_field(&c->data.blocks[n], name);
        if (f->components != first->components || f->type != first->type || f->on_cells != first->on_cells) {
            notice("field '%s' is left out: it differs in kind from block to block", name);
            return 0;
        }
    }
    return 1;
}

static int join_field(conversion *c, const char *name, dataset_field *out) {
    point_field from;
    int status = point_field_select(&c->data, c->o->operands[0], name, &from);
    if (status) return status;
    int is_rounded = 0;
    for (int n = 0; n < c->data.block_count; n++) is_rounded |= block_field(&c->data.blocks[n], name)->is_rounded;
    if (is_rounded && !(c->field.blocks && c->field.is_rounded && strcmp(c->field.name, name) == 0))
        input_tell_rounded(name);
    *out = from.blocks[0];
    if (!name[0]) out->name = FIELD_WITHOUT_NAME; /* arrays of the format have names */
    if (c->data.block_count == 1) return 0;
    size_t bytes = tc_type_bytes(out->type) * (size_t)out->components;
    unsigned char *to = dataset_allocate(&c->data, c->file.point_count * bytes);
    if (!to) return STATUS_FAILED;
    out->values = to;
    for (int n = 0; n < c->data.block_count; n++) {
        size_t size = (size_t)c->data.blocks[n].point_count * bytes;
        memcpy(to, from.blocks[n].values, size);
        to += size;
    }
    return 0;
}

static int join_fields(conversion *c) {
    const char **names;
    int status = 0, count = common_field_names(&c->data, &names);
    if (count < 0) return STATUS_FAILED;
    dataset_field *fields = dataset_allocate(&c->data, (uint64_t)count * sizeof *fields);
    if (!fields) status = STATUS_FAILED;
    c->file.fields = fields;
    for (int n = 0; n < count && !status; n++)
        if (fits_together(c, names[n])) status = join_field(c, names[n], &fields[c->file.field_count++]);
    free(names);
    return status;
}

static int join(conversion *c) {
    int status = join_points(c);
    if (!status) status = join_tetrahedra(c);
    if (!status) status = join_fields(c);
    return status ? status : progress_status();
}

/* ---------------------------------------------------------------------------------------------------------- report */

static int print_json(const conversion *c) {
    json_t *object = json_object(), *fields = json_array();
    for (int n = 0; n < c->file.field_count; n++) json_array_append_new(fields, string_json(c->file.fields[n].name));
    json_object_set_new(object, "input", string_json(c->o->operands[0]));
    json_object_set_new(object, "output", string_json(c->o->output));
    json_object_set_new(object, "blocks", json_integer(c->blocks.count));
    json_object_set_new(object, "points", count_json(c->file.point_count));
    json_object_set_new(object, "cells", count_json(c->blocks.cell_count));
    json_object_set_new(object, "tetrahedra", count_json(c->file.tetrahedron_count));
    json_object_set_new(object, "flat_cells", count_json(c->flat));
    json_object_set_new(object, "curved_cells", count_json(c->curved));
    json_object_set_new(object, "blanked_cells", count_json(c->blanked));
    json_object_set_new(object, "inverted_cells", count_json(c->inverted));
    json_object_set_new(object, "folded_cells", count_json(c->folded));
    json_object_set_new(object, "unsupported_cells", count_json(c->unsupported));
    json_object_set_new(object, "surplus_cells", count_json(c->surplus));
    json_object_set_new(object, "folded_faces", count_json(c->faces.folded_faces));
    json_object_set_new(object, "fields", fields);
    json_object_set_new(object, "total_ms", real_json(c->total_ms));
    json_object_set_new(object, "notices", notices_json());
    return json_report_print(object);
}

static int print_report(const conversion *c) {
    progress_clear();
    if (c->o->json) return print_json(c);
    if (c->o->quiet) return 0;
    printf("%s: %s, %s\n", c->o->operands[0], counted(c->file.point_count, "point", "points").text,
           counted(c->blocks.cell_count, "cell", "cells").text);
    printf("%s: %s, %s, total %.2f ms\n", output_is_dash(c->o->output) ? "standard output" : c->o->output,
           counted(c->file.tetrahedron_count, "tetrahedron", "tetrahedra").text,
           counted((uint64_t)c->file.field_count, "field", "fields").text, c->total_ms);
    return 0;
}

int tetrahedralize_run(const options *o) {
    double begin = now_ms();
    conversion c = {.o = o};
    int status = check_usage(o);
    if (!status) status = read_input(&c);
    if (!status) status = cut(&c);
    if (!status) status = join(&c);
    c.file.world = c.data.world;
    c.file.units = c.data.units;
    if (!status) status = complex_write(o->output, &c.file);
    c.total_ms = now_ms() - begin;
    if (!status) status = print_report(&c);
    blocks_release(&c.blocks);
    dataset_release(&c.data);
    return status;
}
