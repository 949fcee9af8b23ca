/*
 * extract.c - the main job: read, choose the field, cut what has to be cut, upload, then for every isovalue extract,
 * verify, simplify, check, carry, write; report
 *
 * The device is started on a second thread while the input is read: neither needs the other, and a compressed volume
 * takes as long as a driver.
 *
 * With --engine auto, the reference engine takes over where the main engine fails, and goes on from there: its meshes
 * are the same.
 *
 * Surfaces that would not fit into memory are streamed instead (extract/streamed.h), as are those that several
 * processes make together (extract/team.h): these end each stage together, so that what is wrong on one is known to
 * all.
 *
 * What the command line alone can tell is refused before any work. A surface that fails verification or check is not
 * written; the others are, and the exit status is 3. Files of a surface appear together, when all are complete.
 */
#include "command_line/option_effects.h"
#include "commands.h"
#include "counted.h"
#include "exit_status.h"
#include "extract/surface_check.h"
#include "extract/surface_totals.h"
#include "extract/surface_files.h"
#include "extract/surface_notices.h"
#include "extract/streamed.h"
#include "extract/surface_preview.h"
#include "extract/surface_simplify.h"
#include "failure.h"
#include "input/input.h"
#include "library_status.h"
#include "progress.h"
#include "terminal/notice.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct job {
    const options *o;
    team *team; /* or NULL */
    read_request request;
    dataset data;
    scalar field;
    carried_fields carried;
    block_list blocks;
    engine main, reference; /* reference: for --verify only */
    int start_status;       /* of starting the main engine's device */
    char start_text[1024];
    extract_report report;
    int failed_count; /* surfaces that failed verification or check */
    int streams;      /* surfaces are made window by window: the blocks are not uploaded */
} job;

static int check_usage(job *j) {
    const options *o = j->o;
    if (!o->isovalue_count)
        return fail(STATUS_USAGE,
                    "extract needs --iso V, the value on the surface; 'tetracubes info INPUT' suggests some");
    int status = input_request(o, &j->request);
    if (!status) status = surface_simplify_check_usage(o);
    if (!status) status = surface_files_check(o, NULL);
    return status ? status : surface_preview_check(o, NULL);
}

/* ---------------------------------------------------------------------------------------------------------- stages */

static int read_input(job *j) {
    double begin = now_ms();
    int status = input_read(&j->request, &j->data);
    if (!status) status = surface_files_check(j->o, &j->data);
    if (!status) status = surface_preview_check(j->o, &j->data);
    if (!status) status = option_effects_check_input(j->o, &j->data, 0);
    if (!status) status = input_select(&j->request, &j->data, &j->field);
    if (!status) status = carried_fields_select(j->o, &j->data, &j->carried);
    j->report.times.read_ms = now_ms() - begin;
    return status ? status : progress_status();
}

/* Ends a stage: of a team, when all have ended it. */
static int together(const job *j, int status) { return j->team ? j->team->agree(j->team, status) : status; }

/* Called when the main engine has failed. With --engine auto the reference takes its place, and gets the blocks that
 * were uploaded, unless it would fail in the same way. Returns 0, or the status that stays. */
static int fall_back(job *j, int status) {
    if (!engine_gives_way(j->o, j->report.engine, &j->main, status)) return status;
    j->report.engine = TC_ENGINE_REFERENCE;
    j->report.device[0] = '\0';
    status = engine_open(j->o, TC_ENGINE_REFERENCE, &j->main);
    return status || !j->blocks.count || j->streams ? status : engine_upload(j->o, &j->blocks, &j->main);
}

/* Runs on the second thread. Every thread has a failure text of its own, so this one's is copied for the first. */
static void *device_start(void *argument) {
    job *j = argument;
    double begin = now_ms();
    j->start_status = engine_open(j->o, j->report.engine, &j->main);
    j->report.times.device_start_ms = now_ms() - begin;
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
    j->report.input = input_summarize(j->o, &j->data, &j->field, &j->blocks);
    j->report.has_tetrahedra = j->data.blocks->kind == BLOCK_UNSTRUCTURED && j->o->method == TC_METHOD_TETRA;
}

static int cut(job *j) {
    double begin = now_ms();
    int status = blocks_cut(j->o, &j->data, &j->field, 0, &j->blocks);
    j->report.times.upload_ms = now_ms() - begin;
    if (!status) describe_input(j);
    return status ? status : progress_status();
}

static int describe_device(job *j) {
    tc_device_info info = {.struct_size = sizeof info};
    if (j->report.engine == TC_ENGINE_REFERENCE) return 0;
    int status = library_status(tc_context_device(j->main.context, &info));
    snprintf(j->report.device, sizeof j->report.device, "%s", info.name);
    return status;
}

static int upload(job *j) {
    double begin = now_ms();
    int status = fall_back(j, engine_upload(j->o, &j->blocks, &j->main));
    j->report.times.upload_ms += now_ms() - begin;
    if (!status && j->o->verify) status = engine_open(j->o, TC_ENGINE_REFERENCE, &j->reference);
    if (!status && j->o->verify) status = engine_upload(j->o, &j->blocks, &j->reference);
    return status ? status : describe_device(j);
}

static int count_surface(job *j, const tc_extract_options *how, surface_report *s) {
    tc_counts counts;
    int status = engine_count(&j->main, how, &counts);
    if (status && !(status = fall_back(j, status))) status = engine_count(&j->main, how, &counts);
    s->vertex_count = counts.vertex_count;
    s->triangle_count = counts.triangle_count;
    s->active_cell_count = counts.active_cell_count;
    s->classify_ms = counts.classify_ms;
    if (!status) status = surface_tell_empty(&j->data, &j->field, s);
    return status ? status : progress_status();
}

/* ------------------------------------------------------------------------------------------------------ one surface */

/* A surface while it is made: one mesh of all blocks or, with --blocks separate, a mesh of each, so that no more than
 * one block's is in memory. */
typedef struct surface_job {
    job *j;
    tc_extract_options how;
    surface_report *s;
    int is_good;        /* as far as meshes are verified and checked */
    output_group files; /* complete, but not under their names yet */
} surface_job;

/* Tells all that there is to tell of a surface, and judges it, once the last of its meshes is made. */
static int judge_surface(surface_job *w) {
    job *j = w->j;
    surface_report *s = w->s;
    int status = surface_tell_empty(&j->data, &j->field, s);
    if (status) return status;
    precision_tell_mesh(s);
    if (j->o->output) surface_files_tell_precision(j->o, j->blocks.count, s);
    s->coarse_vertices =
        s->coarse_in_mesh.lost > s->coarse_in_file.lost ? s->coarse_in_mesh.lost : s->coarse_in_file.lost;
    if (!s->has_dropped) status = surface_tell_degenerate(&j->data, &j->field, s);
    if (!s->has_dropped && j->o->output) surface_files_tell_joined(j->o, s);
    result_mesh_tell_dropped(s);
    surface_simplify_tell(j->o, s);
    return !status && j->o->check ? surface_judge(&j->blocks, s, j->o->closed, &w->is_good) : status;
}

static int write_preview(surface_job *w, block_range blocks, const result_mesh *mesh) {
    double begin = now_ms();
    int status = surface_preview_write(w->j->o, w->s->iso, blocks.first, mesh, &w->files);
    w->j->report.times.write_ms += now_ms() - begin;
    return status ? status : progress_status();
}

static int write_mesh(surface_job *w, block_range blocks, const tc_mesh_data *made, const result_mesh *mesh,
                      int is_last) {
    job *j = w->j;
    double begin = now_ms();
    int status = carried_fields_interpolate(&j->carried, &j->main, blocks, &w->how, made);
    if (!status) status = result_mesh_carry(mesh, &j->carried);
    if (!status && is_last) carried_fields_tell(&j->carried);
    if (!status) status = surface_files_write(j->o, &j->data, w->s->iso, blocks.first, mesh, &j->carried, &w->files);
    j->report.times.write_ms += now_ms() - begin;
    return status;
}

/* The mesh that the engine has made is verified, counted, checked and written. */
static int finish_mesh(surface_job *w, block_range blocks, const tc_mesh_data *made, result_mesh *mesh, int is_last) {
    job *j = w->j;
    surface_report *s = w->s;
    const surface_source source = {&j->main, &j->blocks, blocks, &w->how, made};
    int status = j->o->verify ? surface_verify(&j->reference, blocks, &w->how, made, s) : 0;
    if (!status && (j->o->drop_degenerate || j->o->simplify > 0)) status = result_mesh_drop_degenerate(mesh, s);
    if (!status && j->o->simplify > 0) status = surface_simplify(j->o, mesh, s, &w->is_good);
    if (status) return status;
    surface_totals_add(j->o, &source, mesh, s);
    status = precision_count_mesh(&source, j->o->check, &s->coarse_in_mesh);
    if (!status) status = surface_files_count_coarse(j->o, &source, mesh, s);
    if (!status && j->o->check) status = surface_check(&mesh->mesh, s);
    if (!status && is_last) status = judge_surface(w);
    if (status || (status = progress_status())) return status;
    if (s->has_verdict && !s->verified) w->is_good = 0;
    if (w->is_good && j->o->preview && (status = write_preview(w, blocks, mesh))) return status;
    return w->is_good && j->o->output ? write_mesh(w, blocks, made, mesh, is_last) : 0;
}

static int make_mesh(surface_job *w, block_range blocks, int is_last) {
    job *j = w->j;
    tc_mesh_data made;
    result_mesh mesh;
    int status = engine_extract(&j->main, blocks, &w->how, &made);
    if (status && !(status = fall_back(j, status))) status = engine_extract(&j->main, blocks, &w->how, &made);
    if (status) return status;
    result_mesh_begin(&j->main, blocks, &made, &mesh);
    status = finish_mesh(w, blocks, &made, &mesh, is_last);
    result_mesh_release(&mesh);
    return status;
}

static int name_files(surface_job *w) {
    const options *o = w->j->o;
    const int blocks = w->j->blocks.count;
    int status = 0;
    if (o->output) status = surface_files_name(o, o->output, w->s->iso, blocks, &w->s->outputs);
    if (!status && o->preview) status = surface_files_name(o, o->preview, w->s->iso, blocks, &w->s->previews);
    return status;
}

/* Puts the surface's files under their names, all together. */
static int publish(surface_job *w) {
    job *j = w->j;
    double begin = now_ms();
    if (!w->is_good) j->failed_count++;
    if (!w->is_good) return 0;
    int status = name_files(w);
    if (!status) status = output_group_publish(&w->files);
    j->report.times.write_ms += now_ms() - begin;
    return status;
}

static int make_surface(job *j, surface_report *s) {
    surface_job w = {.j = j, .s = s, .is_good = 1};
    const int blocks_each = j->o->separate_blocks ? 1 : j->blocks.count; /* of each mesh */
    int status = 0;
    engine_options(j->o, s->iso, &w.how);
    if (j->o->count) return count_surface(j, &w.how, s);
    carried_fields_begin(&j->carried);
    for (int first = 0; first < j->blocks.count && !status; first += blocks_each)
        status = make_mesh(&w, (block_range){first, blocks_each}, first + blocks_each == j->blocks.count);
    if (!status) status = publish(&w);
    output_group_discard(&w.files);
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
    if (j->o->closed && !j->o->check) surface_tell_closed(&j->blocks, j->report.surfaces, count);
    return 0;
}

/* ---------------------------------------------------------------------------------------------------------- streams */

/* Makes the surfaces window by window, where they would not fit into memory; else j->streams is 0 afterwards. */
static int make_streamed(job *j) {
    const stream_input in = {j->o, &j->data, &j->field, &j->blocks, &j->carried, j->team};
    const size_t count = j->o->isovalue_count;
    int status = stream_may_be_needed(&in, &j->streams);
    if (status || !j->streams) return status;
    surface_report *s = calloc(count, sizeof *s);
    if (!s) return fail(STATUS_FAILED, "out of memory for the report");
    status = stream_surfaces(&in, &j->main, s, &j->streams);
    if (status && !(status = fall_back(j, status))) status = stream_surfaces(&in, &j->main, s, &j->streams);
    if (status && j->team && !j->team->has_failed) j->team->leave(j->team, status);
    if (!status) status = describe_device(j);
    if (!status && !j->streams) {
        free(s);
        return 0;
    }
    j->report.surfaces = s;
    j->report.surface_count = count;
    for (size_t n = 0; n < count; n++) j->report.times.write_ms += s[n].write_ms;
    for (size_t n = 0; n < count && !status; n++) surface_tell_isovalue(s[n].iso);
    for (size_t n = 0; n < count && !status && !j->o->part[1]; n++)
        status = surface_tell_empty(&j->data, &j->field, &s[n]); /* a part may well be empty */
    if (!status && j->o->closed) surface_tell_closed(&j->blocks, s, count);
    return status;
}

static int print_report(job *j, double begin_ms) {
    run_times_end(&j->report.times, begin_ms, j->main.context);
    progress_clear();
    if (j->team) {
        double sent = (double)j->team->sent_bytes(j->team);
        j->team->most(j->team, &sent, 1);
        j->report.rank_count = j->team->size;
        j->report.begins = j->team->begins;
        j->report.sent_bytes = (uint64_t)sent;
        if (j->team->rank) return 0;
    }
    if (j->o->json) return extract_report_json(&j->report);
    if (!j->o->quiet) extract_report_text(&j->report);
    return 0;
}

int extract_run(const options *o) { return extract_run_together(o, NULL); }

int extract_run_together(const options *o, team *t) {
    double begin = now_ms();
    job j = {.o = o, .team = t};
    j.report.o = o;
    j.report.engine = o->engine == TC_ENGINE_REFERENCE ? TC_ENGINE_REFERENCE : TC_ENGINE_OPENCL;
    int status = together(&j, check_usage(&j));
    if (status) goto cleanup;
    if ((status = together(&j, read_and_start(&j)))) goto cleanup;
    if ((status = together(&j, cut(&j)))) goto cleanup;
    if ((status = together(&j, make_streamed(&j)))) goto cleanup;
    if (!j.streams && (status = upload(&j))) goto cleanup;
    if (!j.streams && (status = make_surfaces(&j))) goto cleanup;
    if ((status = print_report(&j, begin))) goto cleanup;
    if (j.failed_count)
        status = fail(STATUS_CHECK, "%d of %s failed: %s", j.failed_count,
                      counted(o->isovalue_count, "surface", "surfaces").text,
                      o->output || o->preview ? "not written" : "not to be used");
cleanup:
    for (size_t n = 0; n < j.report.surface_count; n++) {
        file_names_release(&j.report.surfaces[n].outputs);
        file_names_release(&j.report.surfaces[n].previews);
    }
    free(j.report.surfaces);
    if (t) free(t->begins);
    engine_close(&j.reference);
    engine_close(&j.main);
    blocks_release(&j.blocks);
    carried_fields_release(&j.carried);
    dataset_release(&j.data);
    return status;
}
