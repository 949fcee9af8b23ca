/*
 * isovolume.c - interval volumes: read, choose the field, cut what has to be cut, upload, then for every range make the
 * tetrahedra, verify, check, measure, write; report
 *
 * With --engine auto, the reference engine takes over where the main engine fails. A volume that fails verification or
 * check is not written; the others are, and the exit status is 3.
 */
#include "command_line/name_pattern.h"
#include "command_line/option_effects.h"
#include "commands.h"
#include "counted.h"
#include "exit_status.h"
#include "failure.h"
#include "input/input.h"
#include "isovolume/joined_volume.h"
#include "isovolume/volume_report.h"
#include "input/statistics.h"
#include "library_status.h"
#include "mesh_write.h"
#include "output.h"
#include "progress.h"
#include "shortest.h"
#include "terminal/notice.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct volume_job {
    const options *o;
    read_request request;
    dataset data;
    scalar field;
    carried_fields carried;
    block_list blocks;
    engine main, reference; /* reference: for --verify only */
    isovolume_report report;
    int failed_count;
} volume_job;

/* ----------------------------------------------------------------------------------------------------------- files */

static int check_file(const options *o, const dataset *d, const typed_range *range) {
    char *path = name_pattern_fill(o->output, range->text, "");
    int status = path ? complex_write_check(path, o->format) : STATUS_FAILED;
    if (!status) status = input_overwrite_check(o, d, "-o", path);
    if (!status) status = output_check(path);
    free(path);
    return status;
}

/* d NULL: before the input is read. */
static int check_files(const options *o, const dataset *d) {
    int status = 0;
    if (!o->output) return 0;
    status = name_pattern_check("-o", o->output, o->range_count, "range");
    for (size_t a = 0; a < o->range_count && !status; a++)
        for (size_t b = 0; b < a; b++)
            if (strcmp(o->ranges[a].text, o->ranges[b].text) == 0)
                return fail(STATUS_USAGE, "--range: %s is given twice and both would be written to one file",
                            o->ranges[a].text);
    for (size_t n = 0; n < o->range_count && !status; n++) status = check_file(o, d, &o->ranges[n]);
    return status;
}

static int check_usage(volume_job *j) {
    if (!j->o->range_count)
        return fail(STATUS_USAGE,
                    "isovolume needs --range LO,HI, the values between which the volume lies; 'tetracubes "
                    "info INPUT' tells the range of the samples");
    int status = input_request(j->o, &j->request);
    return status ? status : check_files(j->o, NULL);
}

/* ---------------------------------------------------------------------------------------------------------- stages */

static int read_input(volume_job *j) {
    const double begin = now_ms();
    int status = input_read(&j->request, &j->data);
    if (!status) status = check_files(j->o, &j->data);
    if (!status) status = option_effects_check_input(j->o, &j->data, 0);
    if (!status) status = input_select(&j->request, &j->data, &j->field);
    if (!status) status = carried_fields_select(j->o, &j->data, &j->carried);
    j->report.times.read_ms = now_ms() - begin;
    return status ? status : progress_status();
}

static int cut(volume_job *j) {
    int status = blocks_cut(j->o, &j->data, &j->field, 0, &j->blocks);
    j->report.input = input_summarize(j->o, &j->data, &j->field, &j->blocks);
    return status ? status : progress_status();
}

static int engine_begin(volume_job *j) {
    tc_device_info info = {.struct_size = sizeof info};
    const double begin = now_ms();
    int status = engine_open(j->o, j->report.engine, &j->main);
    const double opened = now_ms();
    j->report.times.device_start_ms += opened - begin;
    if (!status) status = engine_upload(j->o, &j->blocks, &j->main);
    if (!status && j->report.engine == TC_ENGINE_OPENCL)
        status = library_status(tc_context_device(j->main.context, &info));
    snprintf(j->report.device, sizeof j->report.device, "%s", info.name);
    j->report.times.upload_ms += now_ms() - opened;
    return status;
}

/* Called when the main engine has failed. With --engine auto the reference takes its place. Returns 0, or the status
 * that stays. */
static int fall_back(volume_job *j, int status) {
    if (!engine_gives_way(j->o, j->report.engine, &j->main, status)) return status;
    j->report.engine = TC_ENGINE_REFERENCE;
    return engine_begin(j);
}

static int upload(volume_job *j) {
    int status = engine_begin(j);
    if (status) status = fall_back(j, status);
    if (!status && j->o->verify) status = engine_open(j->o, TC_ENGINE_REFERENCE, &j->reference);
    if (!status && j->o->verify) status = engine_upload(j->o, &j->blocks, &j->reference);
    return status;
}

/* ------------------------------------------------------------------------------------------------------ one volume */

static int check_volume(const joined_volume *v, volume_report *r, int *is_good) {
    const tetrahedra_view view = {v->sum.positions, v->sum.vertex_count, v->sum.tetrahedra, v->sum.tetrahedron_count};
    tetrahedra_shapes_add(&view, &r->shapes);
    int status = complex_check(view.point_count, view.tetrahedra, view.tetrahedron_count, NULL, &r->faces);
    r->has_shapes = 1;
    if (r->faces.nonmanifold_faces || r->faces.folded_faces || r->faces.invalid_tetrahedra) *is_good = 0;
    return status;
}

static int write_volume(volume_job *j, const joined_volume *v, volume_report *r) {
    const double begin = now_ms();
    r->path = name_pattern_fill(j->o->output, r->range->text, "");
    int status = r->path ? joined_volume_write(v, &j->main, &j->carried, &j->data, r->path) : STATUS_FAILED;
    j->report.times.write_ms += now_ms() - begin;
    return status;
}

/* A volume of nothing, with the range of the samples. */
static int tell_empty(const volume_job *j, const volume_report *r) {
    double range[2];
    if (r->tetrahedron_count || !notice_wanted()) return 0;
    sample_array *arrays = input_samples(&j->data, &j->field);
    if (!arrays) return STATUS_FAILED;
    if (statistics_extent(arrays, j->data.block_count, range))
        notice("range %s: no part of the grid lies within: samples are %s to %s", r->range->text,
               shortest_number(range[0]).text, shortest_number(range[1]).text);
    else
        notice("range %s: no part of the grid lies within: every sample is missing", r->range->text);
    free(arrays);
    return 0;
}

static int finish_volume(volume_job *j, const tc_interval_volume_options *how, const joined_volume *v,
                         volume_report *r) {
    int is_good = 1, status = joined_volume_measure(v, &j->carried, r);
    if (!status && j->o->verify) status = joined_volume_verify(&j->reference, how, v, &r->verified);
    r->has_verdict = j->o->verify;
    if (r->has_verdict && !r->verified) is_good = 0;
    if (!status && j->o->check) status = check_volume(v, r, &is_good);
    if (!status) status = progress_status();
    j->failed_count += !status && !is_good;
    return !status && is_good && j->o->output ? write_volume(j, v, r) : status;
}

static int make_volume(volume_job *j, volume_report *r) {
    tc_interval_volume_options how;
    joined_volume v = {0};
    tc_interval_volume_options_init(&how);
    how.low = r->range->low, how.high = r->range->high;
    int status =
        j->o->count ? joined_volume_count(&j->main, &how, r) : joined_volume_make(&j->main, &how, &j->carried, &v);
    if (status) {
        const typed_range *range = r->range;
        joined_volume_release(&v);
        *r = (volume_report){.range = range};
        status = fall_back(j, status);
        if (!status)
            status = j->o->count ? joined_volume_count(&j->main, &how, r)
                                 : joined_volume_make(&j->main, &how, &j->carried, &v);
    }
    if (!status && !j->o->count) status = finish_volume(j, &how, &v, r);
    joined_volume_release(&v);
    if (!status) status = tell_empty(j, r);
    return status ? status : progress_status();
}

static int make_volumes(volume_job *j) {
    j->report.volumes = calloc(j->o->range_count, sizeof *j->report.volumes);
    if (!j->report.volumes) return fail(STATUS_FAILED, "out of memory for the report");
    for (size_t n = 0; n < j->o->range_count; n++) {
        volume_report *r = &j->report.volumes[j->report.volume_count++];
        r->range = &j->o->ranges[n];
        int status = make_volume(j, r);
        if (status) return status;
    }
    return 0;
}

static int print_report(volume_job *j, double begin_ms) {
    run_times_end(&j->report.times, begin_ms, j->main.context);
    progress_clear();
    if (j->o->json) return isovolume_report_json(&j->report);
    if (!j->o->quiet) isovolume_report_text(&j->report);
    return 0;
}

int isovolume_run(const options *o) {
    const double begin = now_ms();
    volume_job j = {.o = o};
    j.report.o = o;
    j.report.carried = &j.carried;
    j.report.engine = o->engine == TC_ENGINE_REFERENCE ? TC_ENGINE_REFERENCE : TC_ENGINE_OPENCL;
    int status = check_usage(&j);
    if (!status) status = read_input(&j);
    if (!status) status = cut(&j);
    if (!status) status = upload(&j);
    if (!status) status = make_volumes(&j);
    if (!status) status = print_report(&j, begin);
    if (!status && j.failed_count)
        status = fail(STATUS_CHECK, "%d of %s failed: %s", j.failed_count,
                      counted(o->range_count, "volume", "volumes").text, o->output ? "not written" : "not to be used");
    for (size_t n = 0; n < j.report.volume_count; n++) {
        free(j.report.volumes[n].path);
        free(j.report.volumes[n].integrals);
    }
    free(j.report.volumes);
    engine_close(&j.reference);
    engine_close(&j.main);
    blocks_release(&j.blocks);
    carried_fields_release(&j.carried);
    dataset_release(&j.data);
    return status;
}
