/*
 * extract.c - the main job: read, choose the field, cut what has to be cut, upload, then for every isovalue extract,
 * verify, check, carry, write; report
 *
 * The device is started on a second thread while the input is read: neither needs the other, and a compressed volume
 * takes as long as a driver.
 *
 * Whatever fails in the main engine, --engine auto gives to the reference engine, which goes on from there: its meshes
 * are the same.
 *
 * What the command line alone can tell is refused before any work. A surface that fails verification or check is not
 * written; the others are, and the exit status is 3.
 */
#include "carry.h"
#include "coarse.h"
#include "commands.h"
#include "drop.h"
#include "effects.h"
#include "exit_status.h"
#include "failure.h"
#include "input.h"
#include "mesh_check.h"
#include "notice.h"
#include "progress.h"
#include "report.h"
#include "surface_check.h"
#include "surface_files.h"
#include "surface_notices.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct job {
    const options *o;
    dataset data;
    scalar field;
    carried carried;
    block_list blocks;
    engine main, reference; /* reference: for --verify only */
    int start_status;       /* of starting the main engine's device */
    char start_text[1024];
    extract_report report;
    int failed_count; /* surfaces that failed verification or check */
} job;

static int check_usage(const options *o) {
    if (!o->isovalue_count)
        return fail(STATUS_USAGE,
                    "extract needs --iso V, the value on the surface; 'tetracubes info INPUT' suggests some");
    read_request request;
    int status = input_request(o, &request);
    return status ? status : surface_files_check(o);
}

/* ---------------------------------------------------------------------------------------------------------- stages */

static int read_input(job *j) {
    double begin = now_ms();
    int status = input_read(j->o, &j->data);
    if (!status) status = surface_files_check(j->o);
    if (!status) status = effects_check_input(j->o, &j->data, 0);
    if (!status) status = input_select(j->o, &j->data, &j->field);
    if (!status) status = carry_select(j->o, &j->data, &j->carried);
    j->report.read_ms = now_ms() - begin;
    return status ? status : progress_status();
}

/* Where the main engine has failed: with --engine auto the reference takes its place, with what has been uploaded,
 * unless it would fail alike. Returns the status that is left. */
static int fall_back(job *j, int status) {
    if (status != STATUS_FAILED || j->main.fails_alike || progress_cancelled()) return status;
    if (j->o->engine != ENGINE_AUTO || j->report.engine == TC_ENGINE_REFERENCE) return status;
    notice("%s", failure_text());
    notice("the reference engine takes over");
    engine_close(&j->main);
    j->report.engine = TC_ENGINE_REFERENCE;
    j->report.device[0] = '\0';
    status = engine_open(j->o, TC_ENGINE_REFERENCE, &j->main);
    return status || !j->blocks.count ? status : engine_upload(j->o, &j->blocks, &j->main);
}

/* The second thread: texts of failures are each thread's own, so this one's is handed over. */
static void *device_start(void *argument) {
    job *j = argument;
    double begin = now_ms();
    j->start_status = engine_open(j->o, j->report.engine, &j->main);
    j->report.device_start_ms = now_ms() - begin;
    if (j->start_status) snprintf(j->start_text, sizeof j->start_text, "%s", failure_text());
    return NULL;
}

static int read_and_start(job *j) {
    pthread_t starter;
    int is_threaded = pthread_create(&starter, NULL, device_start, j) == 0;
    int status = read_input(j);
    if (is_threaded)
        pthread_join(starter, NULL);
    else if (!status)
        device_start(j);
    if (status || !j->start_status) return status;
    return fall_back(j, fail(j->start_status, "%s", j->start_text));
}

static void describe_input(job *j) {
    const dataset_block *first = j->data.blocks;
    j->report.block_count = j->data.block_count;
    j->report.is_complex = first->kind == BLOCK_UNSTRUCTURED;
    j->report.field = j->field.name;
    j->report.type = j->field.blocks[0].type;
    j->report.point_count = 0;
    for (int n = 0; n < j->data.block_count; n++) j->report.point_count += (uint64_t)first[n].point_count;
    j->report.dims = j->data.block_count == 1 && first->kind != BLOCK_UNSTRUCTURED ? first->dims : NULL;
    j->report.cell_count = j->blocks.cell_count;
    j->report.tetrahedron_count = j->blocks.tetrahedron_count;
}

static int cut(job *j) {
    double begin = now_ms();
    int status = blocks_cut(j->o, &j->data, &j->field, 0, &j->blocks);
    j->report.upload_ms = now_ms() - begin;
    if (!status) describe_input(j);
    return status ? status : progress_status();
}

static int upload(job *j) {
    double begin = now_ms();
    int status = fall_back(j, engine_upload(j->o, &j->blocks, &j->main));
    j->report.upload_ms += now_ms() - begin;
    if (!status && j->o->verify) status = engine_open(j->o, TC_ENGINE_REFERENCE, &j->reference);
    if (!status && j->o->verify) status = engine_upload(j->o, &j->blocks, &j->reference);
    if (status || j->report.engine == TC_ENGINE_REFERENCE) return status;
    tc_device_info info = {.struct_size = sizeof info};
    status = library_status(tc_context_device(j->main.context, &info));
    snprintf(j->report.device, sizeof j->report.device, "%s", info.name);
    return status;
}

/* The part of a call before its first kernel: the first call makes the kernels ready. */
static void add_device_start(job *j, double begin_ms, double kernels_ms) {
    j->report.device_start_ms += now_ms() - begin_ms - kernels_ms;
}

static int count_surface(job *j, const tc_extract_options *how, surface_report *s) {
    tc_counts counts;
    double begin = now_ms();
    int status = engine_count(&j->main, how, &counts);
    if (status && !(status = fall_back(j, status))) status = engine_count(&j->main, how, &counts);
    add_device_start(j, begin, counts.classify_ms);
    s->vertex_count = counts.vertex_count;
    s->triangle_count = counts.triangle_count;
    s->active_cell_count = counts.active_cell_count;
    s->classify_ms = counts.classify_ms;
    if (!status) status = surface_tell_empty(&j->data, &j->field, s);
    return status ? status : progress_status();
}

/* The box of the surface in world space. */
static void find_bounds(const shown_surface *shown, double bounds[2][3]) {
    const float *positions = shown->mesh.positions;
    for (int axis = 0; axis < 3; axis++) {
        bounds[0][axis] = INFINITY;
        bounds[1][axis] = -INFINITY;
    }
    for (int n = 0; n < shown->part_count; n++) {
        const mesh_part *part = &shown->parts[n];
        mesh_summary own;
        mesh_summarize(positions, part->vertex_count, NULL, 0, &own);
        positions += 3 * part->vertex_count;
        if (part->vertex_count <= own.nonfinite_vertices) continue;
        for (int axis = 0; axis < 3; axis++) {
            bounds[0][axis] = fmin(bounds[0][axis], own.bounds[0][axis] + part->origin[axis]);
            bounds[1][axis] = fmax(bounds[1][axis], own.bounds[1][axis] + part->origin[axis]);
        }
    }
}

static void describe_mesh(const job *j, const shown_surface *shown, surface_report *s) {
    const tc_mesh_data *m = &shown->mesh;
    s->has_mesh = 1;
    s->vertex_count = m->vertex_count;
    s->triangle_count = m->triangle_count;
    s->active_cell_count = m->active_cell_count;
    s->soup_vertex_count = j->o->soup && j->o->output ? 3 * m->triangle_count : 0;
    s->classify_ms = m->timings.classify_ms;
    s->emit_ms = m->timings.emit_ms;
    s->readback_ms = m->timings.readback_ms;
    s->slab_count = m->slab_count;
    if (j->o->quiet && !j->o->json) return; /* nobody will read it */
    mesh_summarize(m->positions, m->vertex_count, m->triangles, m->triangle_count, &s->summary);
    s->has_origin = !engine_origins_differ(&j->main);
    for (int axis = 0; axis < 3; axis++) {
        s->origin[axis] = m->origin[axis];
        for (int end = 0; end < 2; end++) s->summary.bounds[end][axis] += m->origin[axis];
    }
    if (!s->has_origin) find_bounds(shown, s->summary.bounds);
    s->hash = mesh_hash(m->positions, m->vertex_count, m->triangles, m->triangle_count);
}

static int write_surface(job *j, const coarse_surface *source, const shown_surface *shown, surface_report *s) {
    double begin = now_ms();
    int status = carry_to_mesh(&j->carried, &j->main, source->how, source->mesh);
    if (!status) status = surface_carry(shown, &j->carried);
    if (!status) status = surface_files_write(j->o, s->iso, shown, j->carried.fields, j->carried.count, &s->path);
    j->report.write_ms += now_ms() - begin;
    return status;
}

/* Whether float32 is fine enough for the mesh, and the file's numbers for what is written. */
static int tell_numbers(const job *j, const coarse_surface *source, const shown_surface *shown, surface_report *s) {
    coarse_verdict mesh, file;
    int status = coarse_tell_mesh(source, j->o->check, &mesh);
    if (!status) status = surface_files_tell_numbers(j->o, source, shown, &file);
    if (status) return status;
    s->is_coarse = mesh.any > 0;
    s->coarse_vertices = mesh.vertices > file.vertices ? mesh.vertices : file.vertices;
    return 0;
}

/* The surface that is made of the engine's mesh: told, checked, written. */
static int finish_surface(job *j, const tc_extract_options *how, const tc_mesh_data *mesh, shown_surface *shown,
                          surface_report *s) {
    const coarse_surface source = {&j->main, &j->blocks, how, mesh, s->iso};
    int good = 1, status = j->o->verify ? surface_verify(&j->reference, how, mesh, s) : 0;
    if (!status && j->o->drop_degenerate) status = surface_drop_degenerate(shown, s);
    if (status) return status;
    describe_mesh(j, shown, s);
    status = surface_tell_empty(&j->data, &j->field, s);
    if (!status) status = tell_numbers(j, &source, shown, s);
    if (!status && !s->has_dropped) status = surface_tell_degenerate(&j->data, &j->field, s);
    surface_tell_dropped(shown, s);
    if (!status && j->o->check) status = surface_check(&j->blocks, &shown->mesh, s, &good);
    if (status || (status = progress_status())) return status;
    if (!good || (s->has_verdict && !s->verified)) {
        j->failed_count++;
        return 0;
    }
    return j->o->output ? write_surface(j, &source, shown, s) : 0;
}

static int make_surface(job *j, surface_report *s) {
    tc_mesh_data mesh;
    shown_surface shown;
    tc_extract_options how;
    int status;
    tc_extract_options_init(&how);
    how.isovalue = s->iso->value;
    how.normals = j->o->normals;
    how.method = (tc_method)j->o->method;
    if (j->o->count) return count_surface(j, &how, s);
    double begin = now_ms();
    status = engine_extract(&j->main, &how, &mesh);
    if (status && !(status = fall_back(j, status))) status = engine_extract(&j->main, &how, &mesh);
    if (status) return status;
    add_device_start(j, begin, mesh.timings.total_ms + mesh.timings.readback_ms);
    surface_show(&j->main, &mesh, &shown);
    status = finish_surface(j, &how, &mesh, &shown, s);
    surface_release(&shown);
    return status;
}

static int make_surfaces(job *j) {
    size_t count = j->o->isovalue_count;
    j->report.surfaces = calloc(count, sizeof *j->report.surfaces);
    if (!j->report.surfaces) return fail(STATUS_FAILED, "out of memory for the report");
    for (size_t n = 0; n < count; n++) {
        surface_report *s = &j->report.surfaces[j->report.surface_count++];
        s->iso = &j->o->isovalues[n];
        surface_tell_isovalue(s->iso);
        int status = make_surface(j, s);
        if (status) return status;
    }
    return 0;
}

static int print_report(job *j, double begin_ms) {
    j->report.total_ms = now_ms() - begin_ms;
    progress_clear();
    if (j->o->json) return report_extract_json(&j->report);
    if (!j->o->quiet) report_extract_text(&j->report);
    return 0;
}

int extract_run(const options *o) {
    double begin = now_ms();
    job j = {.o = o};
    j.report.o = o;
    j.report.engine = o->engine == TC_ENGINE_REFERENCE ? TC_ENGINE_REFERENCE : TC_ENGINE_OPENCL;
    int status = check_usage(o);
    if (status) goto cleanup;
    if ((status = read_and_start(&j))) goto cleanup;
    if ((status = cut(&j))) goto cleanup;
    if ((status = upload(&j))) goto cleanup;
    if ((status = make_surfaces(&j))) goto cleanup;
    if ((status = print_report(&j, begin))) goto cleanup;
    if (j.failed_count)
        status = fail(STATUS_CHECK, "%d of %zu surfaces failed and %s", j.failed_count, o->isovalue_count,
                      o->output ? "were not written" : "should not be used");
cleanup:
    for (size_t n = 0; n < j.report.surface_count; n++) free(j.report.surfaces[n].path);
    free(j.report.surfaces);
    engine_close(&j.reference);
    engine_close(&j.main);
    blocks_release(&j.blocks);
    carry_release(&j.carried);
    dataset_release(&j.data);
    return status;
}
