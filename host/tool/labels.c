/*
 * labels.c - surfaces of a label map: read, choose the field, extract all surfaces as one mesh, smooth, verify, check
 * each label by itself, write one file or one per label; report
 *
 * With --engine auto the reference engine takes over where the device fails. What fails verification or check is not
 * written. Files appear together, when all are complete.
 */
#include "command_line/option_effects.h"
#include "commands.h"
#include "counted.h"
#include "exit_status.h"
#include "extract/engine.h"
#include "extract/surface_preview.h"
#include "failure.h"
#include "input/cell_sizes.h"
#include "input/input.h"
#include "labels/label_cells.h"
#include "labels/label_files.h"
#include "labels/label_report.h"
#include "labels/label_samples.h"
#include "library_status.h"
#include "mesh_compare.h"
#include "mesh_labels.h"
#include "progress.h"
#include "terminal/notice.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { SWEEPS_MOST = 1000 };

typedef struct label_job {
    const options *o;
    read_request request;
    dataset data;
    scalar field;
    block_list blocks;
    int suits_world; /* of blocks_suit_world */
    tc_labels_options how;
    engine main, reference; /* reference: for --verify only */
    tc_mesh *reference_mesh;
    tc_mesh_data mesh;
    mesh_labels labels;
    label_mesh one;
    output_group files;
    label_report report;
    int is_good; /* as far as the mesh is verified and checked */
} label_job;

static int check_usage(label_job *j) {
    if (j->o->smooth > SWEEPS_MOST)
        return fail(STATUS_USAGE, "--smooth %" PRIu64 ": give at most %d sweeps", j->o->smooth, SWEEPS_MOST);
    const int status = input_request(j->o, &j->request);
    return status ? status : label_files_check(j->o, NULL);
}

/* ----------------------------------------------------------------------------------------------------------- input */

static int check_block(const label_job *j) {
    const char *input = j->o->operands[0];
    if (j->data.block_count != 1)
        return fail(STATUS_INPUT, "%s: has %d blocks; a label map is one structured grid", input, j->data.block_count);
    if (j->data.blocks[0].kind == BLOCK_UNSTRUCTURED)
        return fail(STATUS_INPUT, "%s: is unstructured; a label map is one structured grid", input);
    if (j->data.blocks[0].kind != BLOCK_UNIFORM && options_given(j->o, "--smooth") && j->o->smooth)
        return fail(STATUS_USAGE, "%s: is no uniform grid: surfaces are smoothed on these only; leave out --smooth",
                    input);
    return 0;
}

static int read_input(label_job *j) {
    const double begin = now_ms();
    int status = input_read(&j->request, &j->data);
    if (!status) status = label_files_check(j->o, &j->data);
    if (!status) status = check_block(j);
    if (!status) status = option_effects_check_input(j->o, &j->data, 0);
    if (!status) status = label_cells_take(&j->request, &j->data);
    if (!status) status = input_select(&j->request, &j->data, &j->field);
    if (!status) status = label_samples_make(j->o->operands[0], &j->data, &j->field);
    if (!status) status = blocks_cut(j->o, &j->data, &j->field, 0, &j->blocks);
    if (!status) j->suits_world = blocks_suit_world(&j->blocks);
    j->report.times.read_ms = now_ms() - begin;
    return status ? status : progress_status();
}

/* Whether the block ends within a larger one, along some axis, by --roi or --roi-world. */
static int is_region(const options *o, const dataset_block *b) {
    const sample_box *p = &b->region;
    if (!b->whole || !(options_given(o, "--roi") || options_given(o, "--roi-world"))) return 0;
    for (int axis = 0; axis < 3; axis++)
        if (p->first[axis] > 0 || p->first[axis] + p->count[axis] * p->step[axis] < b->whole->dims[axis]) return 1;
    return 0;
}

static void choose_options(label_job *j) {
    const int is_uniform = j->data.blocks[0].kind == BLOCK_UNIFORM;
    tc_labels_options_init(&j->how);
    j->how.labels = j->o->labels;
    j->how.label_count = j->o->label_count;
    j->how.closed = j->o->closed;
    if (options_given(j->o, "--smooth")) j->how.smoothing = (uint32_t)j->o->smooth;
    if (!is_uniform && j->how.smoothing) notice("%s: is no uniform grid: surfaces are not smoothed", j->o->operands[0]);
    if (!is_uniform) j->how.smoothing = 0;
    if (j->how.smoothing && is_region(j->o, &j->data.blocks[0]))
        notice("%s: surfaces are smoothed at the border of the region, too: those of regions that share a plane of "
               "samples fit by --smooth 0 alone",
               j->o->operands[0]);
    j->report.smoothing = j->how.smoothing;
}

/* ------------------------------------------------------------------------------------------------------ extraction */

static int extract(label_job *j, engine *e, tc_mesh **mesh, tc_mesh_data *data) {
    *data = (tc_mesh_data){.struct_size = sizeof *data};
    int status = library_status(tc_extract_labels(e->grids[0], &j->how, mesh));
    return status ? status : library_status(tc_mesh_get(*mesh, data));
}

static int make_with(label_job *j, tc_engine kind) {
    tc_device_info info = {.struct_size = sizeof info};
    const double begin = now_ms();
    int status = engine_open(j->o, kind, &j->main);
    const double opened = now_ms();
    if (!status) status = engine_upload(j->o, &j->blocks, &j->main);
    j->report.times.device_start_ms = opened - begin;
    j->report.times.upload_ms = now_ms() - opened;
    if (!status) status = extract(j, &j->main, &j->main.mesh, &j->mesh);
    if (!status && kind == TC_ENGINE_OPENCL) status = library_status(tc_context_device(j->main.context, &info));
    memcpy(j->report.device, info.name, sizeof info.name);
    return status;
}

static int make_surfaces(label_job *j) {
    const tc_engine kind = j->o->engine == TC_ENGINE_REFERENCE ? TC_ENGINE_REFERENCE : TC_ENGINE_OPENCL;
    int status = make_with(j, kind);
    if (engine_gives_way(j->o, kind, &j->main, status)) status = make_with(j, TC_ENGINE_REFERENCE);
    return status ? status : progress_status();
}

static int verify(label_job *j) {
    tc_mesh_data reference;
    char text[256];
    if (!j->o->verify) return 0;
    int status = engine_open(j->o, TC_ENGINE_REFERENCE, &j->reference);
    if (!status) status = engine_upload(j->o, &j->blocks, &j->reference);
    if (!status) status = extract(j, &j->reference, &j->reference.mesh, &reference);
    if (status) return status;
    j->report.has_verdict = 1;
    j->report.verified = meshes_are_same(&j->mesh, &reference, text, sizeof text);
    if (!j->report.verified) message("verification failed: %s", text);
    j->is_good = j->is_good && j->report.verified;
    return 0;
}

static void describe(label_job *j) {
    const tc_mesh_data *m = &j->mesh;
    label_report *r = &j->report;
    mesh_summary summary;
    r->grid = &j->data.blocks[0];
    r->field = j->field.name;
    r->type = j->field.blocks[0].type;
    r->vertex_count = m->vertex_count;
    r->triangle_count = m->triangle_count;
    r->active_cell_count = m->active_cell_count;
    r->timings = m->timings;
    r->slab_count = m->slab_count;
    if (j->o->quiet && !j->o->json) return;
    mesh_summarize(m->positions, m->vertex_count, m->triangles, m->triangle_count, &summary);
    for (int n = 0; n < 6; n++) r->bounds[n / 3][n % 3] = summary.bounds[n / 3][n % 3] + m->origin[n % 3];
    r->degenerate_triangles = summary.degenerate_triangles;
    r->hash = mesh_hash(m->positions, m->vertex_count, m->triangles, m->triangle_count);
}

/* ------------------------------------------------------------------------------------------------------ each label */

static int check_label(label_job *j, label_row *row) {
    const tc_mesh_data *m = &j->one.mesh;
    mesh_topology *t = &row->topology;
    const int status = mesh_check(m->positions, m->vertex_count, m->triangles, m->triangle_count, t);
    if (status) return status;
    if (!t->nonmanifold_edges && !t->nonmanifold_vertices && !t->misoriented_edges && !t->invalid_triangles) return 0;
    j->is_good = 0;
    message("label %" PRIu32 ": check failed: %s, %s, %s, %s", row->label,
            counted(t->nonmanifold_edges, "non-manifold edge", "non-manifold edges").text,
            counted(t->nonmanifold_vertices, "non-manifold vertex", "non-manifold vertices").text,
            counted(t->misoriented_edges, "misoriented edge", "misoriented edges").text,
            counted(t->invalid_triangles, "invalid triangle", "invalid triangles").text);
    return 0;
}

static int write_label(label_job *j, label_row *row) {
    const double begin = now_ms();
    row->path = label_file_name(j->o, row->label);
    const int status = row->path ? label_file_write(j->o, &j->data, j->suits_world, row->path, &j->one.mesh, &j->files)
                                 : STATUS_FAILED;
    j->report.times.write_ms += now_ms() - begin;
    return status;
}

static int take_labels(label_job *j) {
    const int writes = j->o->output && j->o->separate_labels;
    int status = mesh_labels_find(&j->mesh, &j->labels);
    if (!status && !(j->report.rows = calloc(j->labels.count + 1, sizeof *j->report.rows)))
        status = fail(STATUS_FAILED, "out of memory for the report");
    for (size_t n = 0; n < j->labels.count && !status; n++) {
        label_row *row = &j->report.rows[j->report.row_count++];
        row->label = j->labels.labels[n];
        row->triangle_count = j->labels.starts[n + 1] - j->labels.starts[n];
        if (j->o->check || writes) status = mesh_label_take(&j->labels, n, &j->one);
        if (!status && j->o->check) status = check_label(j, row);
        if (!status && writes) status = write_label(j, row);
        if (!status) status = progress_status();
    }
    return status;
}

/* Labels that were asked for and have no surface. */
static void tell_absent(const label_job *j) {
    if (!j->labels.count && !j->o->label_count)
        notice("no surface: all samples have one label, or none%s",
               j->o->closed ? "" : "; --closed ends surfaces at the grid's border");
    for (size_t n = 0; n < j->o->label_count; n++)
        if (!mesh_labels_has(&j->labels, j->o->labels[n]))
            notice("label %" PRIu32 " has no surface: no sample has it, or all have", j->o->labels[n]);
}

static int write_preview(label_job *j) {
    j->report.preview = label_preview_name(j->o);
    return j->report.preview ? preview_write(j->o, j->report.preview, &j->mesh, NULL, 0, &j->files) : STATUS_FAILED;
}

static int publish(label_job *j) {
    const double begin = now_ms();
    int status = 0;
    if (!j->is_good) return 0;
    if (j->o->output && !j->o->separate_labels) {
        j->report.path = label_file_name(j->o, 0);
        status = j->report.path ? label_file_write(j->o, &j->data, j->suits_world, j->report.path, &j->mesh, &j->files)
                                : STATUS_FAILED;
    }
    if (!status) label_files_tell(j->o, j->suits_world, &j->mesh);
    if (!status && j->o->preview) status = write_preview(j);
    if (!status) status = output_group_publish(&j->files);
    j->report.times.write_ms += now_ms() - begin;
    return status;
}

static void release(label_job *j) {
    output_group_discard(&j->files);
    for (size_t n = 0; n < j->report.row_count; n++) free(j->report.rows[n].path);
    free(j->report.rows);
    free(j->report.path);
    free(j->report.preview);
    label_mesh_release(&j->one);
    mesh_labels_release(&j->labels);
    engine_close(&j->main);
    engine_close(&j->reference);
    blocks_release(&j->blocks);
    dataset_release(&j->data);
}

int labels_run(const options *o) {
    const double begin = now_ms();
    label_job j = {.o = o, .report = {.o = o}, .is_good = 1};
    int status = check_usage(&j);
    if (!status) status = read_input(&j);
    if (!status) choose_options(&j);
    if (!status) status = make_surfaces(&j);
    if (!status) status = verify(&j);
    if (!status) describe(&j);
    if (!status) status = take_labels(&j);
    if (!status) tell_absent(&j);
    if (!status) status = publish(&j);
    run_times_end(&j.report.times, begin, j.main.context);
    if (!status) status = label_report_print(&j.report);
    if (!status && !j.is_good) status = fail(STATUS_CHECK, "verification or check failed: nothing is written");
    release(&j);
    return status;
}
