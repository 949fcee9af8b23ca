/*
 * join.c - the parts of a surface, each the work of another process, become the one file that one process writes
 *
 * The parts are mapped, and copied some records at a time. What is copied is compared with the digest of each part, and
 * the numbers of its vertices are checked; the file appears when all of it is good.
 */
#include "commands.h"
#include "counted.h"
#include "exit_status.h"
#include "extract/surface_files.h"
#include "failure.h"
#include "input/input.h"
#include "mesh_write.h"
#include "output.h"
#include "parts/part.h"
#include "parts/part_digest.h"
#include "progress.h"
#include "terminal/json_report.h"
#include "vertex_values.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

enum { RECORDS_AT_ONCE = 1 << 20 };

static const uintptr_t page = 4096;

typedef struct join_job {
    const options *o;
    part *parts;
    size_t count;
    uint64_t vertex_count, triangle_count;
    double origin[3];
    mesh_write_options how;
    vertex_array *fields;
    int takes_halves; /* the file takes vertices and triangles of a part one after the other */
    mesh_file *file;
} join_job;

static int check_usage(const options *o) {
    const mesh_write_options how = {.format = o->format};
    if (!o->operand_count)
        return fail(STATUS_USAGE, "join needs the files of all parts: tetracubes join PARTS... -o FILE");
    if (!o->output) return fail(STATUS_USAGE, "join needs -o FILE, the mesh to write");
    int status = mesh_file_check(o->output, &how);
    if (!status) status = input_overwrite_check(o, NULL, "-o", o->output);
    return status ? status : output_check(o->output);
}

static int open_parts(join_job *j) {
    j->parts = calloc((size_t)j->o->operand_count, sizeof *j->parts);
    if (!j->parts) return fail(STATUS_FAILED, "out of memory for the parts");
    for (int n = 0; n < j->o->operand_count; n++) {
        const int status = part_open(j->o->operands[n], &j->parts[j->count++]);
        if (status) return status;
    }
    return parts_sort(j->parts, j->count);
}

/* --------------------------------------------------------------------------------------------------------- the file */

static int open_file(join_job *j) {
    static const float some;
    const part_layout *l = &j->parts[0].layout;
    const json_t *surface = j->parts[0].header.surface;
    tc_mesh_data whole = {.struct_size = sizeof whole};
    for (size_t n = 0; n < j->count; n++) {
        const part_header *h = &j->parts[n].header;
        j->vertex_count += h->vertex_count;
        j->triangle_count += h->triangle_count;
        if (h->has_origin) memcpy(j->origin, h->origin, sizeof j->origin);
    }
    j->fields = calloc((size_t)l->array_count, sizeof *j->fields);
    if (!j->fields) return fail(STATUS_FAILED, "out of memory for the fields");
    whole.vertex_count = j->vertex_count;
    whole.triangle_count = j->triangle_count;
    memcpy(whole.origin, j->origin, sizeof whole.origin);
    for (int n = 0; n < l->channel_count; n++)
        if (j->vertex_count) mesh_values_set(&whole, l->arrays[n].channel, &some);
    j->how = (mesh_write_options){.format = j->o->format,
                                  .fields = j->fields,
                                  .field_count = l->array_count - 1 - l->channel_count,
                                  .world = json_string_value(json_object_get(surface, "world")),
                                  .units = json_string_value(json_object_get(surface, "units")),
                                  .origin_at =
                                      surface_file_zero(j->o, json_is_true(json_object_get(surface, "suits_world")))};
    for (int n = 0; n < j->how.field_count; n++) {
        const part_array *a = &l->arrays[l->channel_count + n];
        j->fields[n] = (vertex_array){a->name, a->components, NULL, ROLE_DATA};
    }
    if (mesh_write_is_relative(j->o->output, &whole, &j->how)) surface_files_tell_relative(whole.origin, 0);
    j->takes_halves = mesh_file_takes_halves(j->o->output, &j->how);
    return mesh_file_open(j->o->output, &j->how, &whole, &j->file);
}

/* ---------------------------------------------------------------------------------------------------------- copying */

/* Pages that have been copied are not needed any more. */
static void forget(const part *p, const part_array *a, uint64_t first, uint64_t count) {
    const uintptr_t begin = (uintptr_t)part_record(p, a, first), end = begin + count * a->record_bytes;
    const uintptr_t low = (begin + page - 1) / page * page, high = end / page * page;
    if (low < high)
        (void)madvise((char *)(uintptr_t)part_record(p, a, first) + (low - begin), high - low, MADV_DONTNEED);
}

/* Vertices of the part behind part n; of more parts than layers some own no planes. */
static uint64_t next_vertices(const join_job *j, size_t n) {
    do n++;
    while (n < j->count && j->parts[n].header.planes[0] == j->parts[n].header.planes[1]);
    return n < j->count ? j->parts[n].header.vertex_count : 0;
}

/* Whether the vertices of these triangles are there, in the part or the next one. */
static int check_triangles(const join_job *j, size_t n, uint64_t first, uint64_t count) {
    const part *p = &j->parts[n];
    const uint32_t *corners = part_record(p, part_triangles(&p->layout), first);
    const uint64_t most = p->header.vertex_count + next_vertices(j, n);
    uint32_t largest = 0;
    for (uint64_t c = 0; c < 3 * count; c++)
        if (corners[c] > largest) largest = corners[c];
    if (!count || largest < most) return 0;
    return fail(STATUS_INPUT, "%s: damaged: a triangle names a vertex that there is not; make it anew", p->path);
}

/* Adds vertices and triangles of part n from these on, so many of each. */
static int add_records(join_job *j, size_t n, const uint64_t first[2], const uint64_t count[2],
                       const uint64_t base[2]) {
    const part *p = &j->parts[n];
    const part_layout *l = &p->layout;
    tc_mesh_data piece = {.struct_size = sizeof piece, .vertex_count = count[0], .triangle_count = count[1]};
    memcpy(piece.origin, j->origin, sizeof piece.origin);
    for (int a = 0; a < l->array_count - 1; a++) {
        const float *values = part_record(p, &l->arrays[a], first[0]);
        if (a < l->channel_count)
            mesh_values_set(&piece, l->arrays[a].channel, values);
        else
            j->fields[a - l->channel_count].values = values;
    }
    piece.triangles = part_record(p, part_triangles(l), first[1]);
    const int status = check_triangles(j, n, first[1], count[1]);
    return status ? status : mesh_file_add(j->file, base[0] + first[0], base[1] + first[1], &piece, j->fields);
}

static void digest_records(part_digest *d, const part *p, const uint64_t first[2], const uint64_t count[2]) {
    const part_layout *l = &p->layout;
    for (int a = 0; a < l->array_count; a++) {
        const int kind = a == l->array_count - 1;
        part_digest_add(d, a, part_record(p, &l->arrays[a], first[kind]), count[kind] * l->arrays[a].record_bytes);
        forget(p, &l->arrays[a], first[kind], count[kind]);
    }
}

/* Adds all records of one kind, 0 vertices and 1 triangles, some at a time. Where those of the other kind have been
 * added, numbers of vertices still count from the part's first. */
static int add_half(join_job *j, size_t n, int kind, part_digest *d, const uint64_t base[2]) {
    const part_header *h = &j->parts[n].header;
    const uint64_t all = kind ? h->triangle_count : h->vertex_count;
    int status = 0;
    for (uint64_t at = 0; at < all && !status; at += RECORDS_AT_ONCE) {
        uint64_t first[2] = {0}, count[2] = {0};
        first[kind] = at;
        count[kind] = all - at < RECORDS_AT_ONCE ? all - at : RECORDS_AT_ONCE;
        status = add_records(j, n, first, count, base);
        digest_records(d, &j->parts[n], first, count);
        if (!status) status = progress_status();
    }
    return status;
}

static int add_part(join_job *j, size_t n, const uint64_t base[2]) {
    const part *p = &j->parts[n];
    const uint64_t first[2] = {0}, count[2] = {p->header.vertex_count, p->header.triangle_count};
    char line[PART_DIGEST_BYTES + 1];
    part_digest *d = part_digest_begin(&p->layout);
    int status = d ? 0 : STATUS_FAILED;
    if (!status && !j->takes_halves && (count[0] || count[1])) {
        status = add_records(j, n, first, count, base);
        digest_records(d, p, first, count);
    } else if (!status && j->takes_halves) {
        status = add_half(j, n, 0, d, base);
        if (!status) status = add_half(j, n, 1, d, base);
    }
    if (!status) part_digest_line(d, p->m.bytes, p->header_bytes, line);
    part_digest_free(d);
    if (status || memcmp(line, p->m.bytes + p->layout.digest_offset, PART_DIGEST_BYTES) == 0) return status;
    return fail(STATUS_INPUT, "%s: damaged: its bytes are not those that were written; make it anew", p->path);
}

static int add_parts(join_job *j) {
    uint64_t base[2] = {0};
    int status = 0;
    for (size_t n = 0; n < j->count && !status; n++) {
        progress_update(NULL, "join", (double)n / (double)j->count);
        status = add_part(j, n, base);
        base[0] += j->parts[n].header.vertex_count;
        base[1] += j->parts[n].header.triangle_count;
    }
    return status ? status : progress_status();
}

/* ------------------------------------------------------------------------------------------------------------- run */

static int print_report(const join_job *j, double total_ms) {
    progress_clear();
    if (j->o->json)
        return json_report_print(json_pack("{s:o, s:I, s:o, s:o, s:f}", "output", string_json(j->o->output), "parts",
                                           (json_int_t)j->count, "vertices", count_json(j->vertex_count), "triangles",
                                           count_json(j->triangle_count), "total_ms", total_ms));
    if (!j->o->quiet)
        printf("%s: %s, %s of %s, in %.2f ms\n", j->o->output, counted(j->vertex_count, "vertex", "vertices").text,
               counted(j->triangle_count, "triangle", "triangles").text, counted(j->count, "part", "parts").text,
               total_ms);
    return 0;
}

int join_run(const options *o) {
    const double begin = now_ms();
    join_job j = {.o = o};
    int status = check_usage(o);
    if (!status) status = open_parts(&j);
    if (!status) status = open_file(&j);
    if (!status) status = add_parts(&j);
    if (status)
        mesh_file_discard(j.file);
    else
        status = mesh_file_close(j.file);
    if (!status) status = print_report(&j, now_ms() - begin);
    for (size_t n = 0; n < j.count; n++) part_close(&j.parts[n]);
    free(j.fields);
    free(j.parts);
    return status;
}
