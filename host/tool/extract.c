/*
 * extract.c - the main job: read, upload, then for every isovalue extract, verify, check, write; report
 *
 * The device is started on a second thread while the input is read: neither needs the other, and a compressed volume
 * takes as long as a driver.
 *
 * What the command line alone can tell is refused before any work. A surface that fails verification or check is not
 * written; the others are, and the exit status is 3.
 */
#include "commands.h"
#include "exit_status.h"
#include "failure.h"
#include "mesh_check.h"
#include "mesh_write.h"
#include "progress.h"
#include "report.h"
#include "verify.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* One engine and what it holds. */
typedef struct engine {
    tc_context *context;
    tc_grid *grid;
    tc_mesh *mesh;
} engine;

typedef struct job {
    const options *o;
    volume v;
    engine main, reference; /* reference: for --verify only */
    int start_status;       /* of starting the main engine's device */
    char start_text[1024];
    extract_report report;
    int failed_count; /* surfaces that failed verification or check */
} job;

/* ----------------------------------------------------------------------------------------------------------- usage */

/* The file of one isovalue, from malloc: with several isovalues every % stands for the isovalue as typed. */
static char *output_path(const options *o, const typed_isovalue *iso) {
    const char *stand_in = o->isovalue_count > 1 ? iso->text : "%";
    size_t bytes = 1;
    for (const char *c = o->output; *c; c++) bytes += *c == '%' ? strlen(stand_in) : 1;
    char *path = malloc(bytes), *at = path;
    for (const char *c = o->output; path && *c; c++) {
        size_t length = *c == '%' ? strlen(stand_in) : 1;
        memcpy(at, *c == '%' ? stand_in : c, length);
        at += length;
    }
    if (path) *at = '\0';
    return path;
}

/* The mesh must not replace the volume that it is made from. */
static int check_overwrite(const options *o, const char *path) {
    struct stat input, output;
    if (stat(o->operands[0], &input) || stat(path, &output)) return 0;
    if (input.st_dev != output.st_dev || input.st_ino != output.st_ino || !S_ISREG(input.st_mode)) return 0;
    return fail(STATUS_USAGE, "-o %s is the input itself: name another file", path);
}

static int check_output(const options *o) {
    const mesh_write_options how = {.format = o->format, .soup = o->soup};
    if (o->isovalue_count > 1 && !strchr(o->output, '%'))
        return fail(STATUS_USAGE, "-o %s: with several isovalues the name needs a %%, which stands for the isovalue",
                    o->output);
    for (size_t a = 0; a < o->isovalue_count; a++)
        for (size_t b = 0; b < a; b++)
            if (strcmp(o->isovalues[a].text, o->isovalues[b].text) == 0)
                return fail(STATUS_USAGE, "--iso: %s is given twice and both would be written to one file",
                            o->isovalues[a].text);
    int status = mesh_write_check(o->output, &how);
    for (size_t n = 0; n < o->isovalue_count && !status; n++) {
        char *path = output_path(o, &o->isovalues[n]);
        status = path ? check_overwrite(o, path) : fail(STATUS_FAILED, "out of memory for the name of the output");
        free(path);
    }
    return status;
}

static int check_usage(const options *o) {
    static const char *const need_mesh[] = {"--output", "--verify", "--check", "--normals", "--soup", "--format"};
    if (!o->isovalue_count)
        return fail(STATUS_USAGE,
                    "extract needs --iso V, the value on the surface; 'tetracubes info INPUT' suggests some");
    for (size_t n = 0; n < sizeof need_mesh / sizeof *need_mesh; n++)
        if (o->count && options_given(o, need_mesh[n]))
            return fail(STATUS_USAGE, "--count makes no mesh: leave out %s, or --count", need_mesh[n]);
    if (o->verify && o->engine == TC_ENGINE_REFERENCE)
        return fail(STATUS_USAGE, "--verify compares with the reference engine: it proves nothing about that engine "
                                  "itself; leave out --verify or --engine reference");
    return o->output ? check_output(o) : 0;
}

/* ---------------------------------------------------------------------------------------------------------- stages */

static int read_input(job *j) {
    read_request request;
    int status = input_request(j->o, &request);
    if (status) return status;
    double begin = now_ms();
    status = volume_read(&request, &j->v);
    j->report.read_ms = now_ms() - begin;
    if (!status && j->v.notice[0] && !j->o->quiet) message("%s: %s", request.path, j->v.notice);
    return status ? status : progress_status();
}

/* A grid that a file describes and the library refuses is the file's fault; of raw input it is the options'. */
static int grid_status(const options *o, tc_status status) {
    int of_input = status == TC_ERROR_DATA || (status == TC_ERROR_ARGUMENT && !options_given(o, "--dims"));
    return of_input ? fail(STATUS_INPUT, "%s: %s", o->operands[0], tc_message()) : library_status(status);
}

static int device_open(const job *j, tc_engine kind, tc_context **context) {
    tc_context_options device;
    tc_context_options_init(&device);
    device.engine = kind;
    device.device = j->o->device;
    device.max_memory_bytes = kind == TC_ENGINE_OPENCL ? j->o->max_memory : 0;
    device.progress = progress_update;
    return library_status(tc_context_create(&device, context));
}

static int grid_open(const job *j, engine *e) {
    tc_grid_options grid;
    tc_grid_options_init(&grid);
    memcpy(grid.dims, j->v.dims, sizeof grid.dims);
    memcpy(grid.first, j->v.first, sizeof grid.first);
    memcpy(grid.matrix, j->v.matrix, sizeof grid.matrix);
    grid.type = j->v.type;
    grid.samples = j->v.samples;
    grid.has_nodata = j->o->has_nodata;
    grid.nodata = j->o->nodata;
    return grid_status(j->o, tc_grid_create(e->context, &grid, &e->grid));
}

static void engine_close(engine *e) {
    tc_mesh_destroy(e->mesh);
    tc_grid_destroy(e->grid);
    tc_context_destroy(e->context);
    *e = (engine){0};
}

/* The second thread: texts of failures are each thread's own, so this one's is handed over. */
static void *device_start(void *argument) {
    job *j = argument;
    double begin = now_ms();
    j->start_status = device_open(j, (tc_engine)j->o->engine, &j->main.context);
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
    if (status) return status;
    return j->start_status ? fail(j->start_status, "%s", j->start_text) : 0;
}

static int upload(job *j) {
    double begin = now_ms();
    int status = grid_open(j, &j->main);
    j->report.upload_ms = now_ms() - begin;
    if (!status && j->o->verify) status = device_open(j, TC_ENGINE_REFERENCE, &j->reference.context);
    if (!status && j->o->verify) status = grid_open(j, &j->reference);
    if (status || j->o->engine == TC_ENGINE_REFERENCE) return status;
    tc_device_info info = {.struct_size = sizeof info};
    status = library_status(tc_context_device(j->main.context, &info));
    snprintf(j->report.device, sizeof j->report.device, "%s", info.name);
    return status;
}

static int extract_mesh(const job *j, engine *e, double isovalue, tc_mesh_data *data) {
    tc_extract_options how;
    tc_extract_options_init(&how);
    how.isovalue = isovalue;
    how.normals = j->o->normals;
    *data = (tc_mesh_data){.struct_size = sizeof *data};
    tc_status status = tc_extract(e->grid, &how, &e->mesh);
    return library_status(status ? status : tc_mesh_get(e->mesh, data));
}

/* The part of a call before its first kernel: the first call makes the kernels ready. */
static void add_device_start(job *j, double begin_ms, double kernels_ms) {
    j->report.device_start_ms += now_ms() - begin_ms - kernels_ms;
}

static int count_surface(job *j, surface_report *s) {
    tc_extract_options how;
    tc_counts counts = {.struct_size = sizeof counts};
    tc_extract_options_init(&how);
    how.isovalue = s->iso->value;
    double begin = now_ms();
    int status = library_status(tc_count(j->main.grid, &how, &counts));
    add_device_start(j, begin, counts.classify_ms);
    s->vertex_count = counts.vertex_count;
    s->triangle_count = counts.triangle_count;
    s->active_cell_count = counts.active_cell_count;
    s->classify_ms = counts.classify_ms;
    return status;
}

static void describe_mesh(const options *o, const tc_mesh_data *m, surface_report *s) {
    s->has_mesh = 1;
    s->vertex_count = m->vertex_count;
    s->triangle_count = m->triangle_count;
    s->active_cell_count = m->active_cell_count;
    s->classify_ms = m->timings.classify_ms;
    s->emit_ms = m->timings.emit_ms;
    s->readback_ms = m->timings.readback_ms;
    s->slab_count = m->slab_count;
    if (o->quiet && !o->json) return; /* nobody will read it */
    mesh_summarize(m->positions, m->vertex_count, m->triangles, m->triangle_count, &s->summary);
    s->hash = mesh_hash(m->positions, m->vertex_count, m->triangles, m->triangle_count);
}

static int verify_surface(job *j, const tc_mesh_data *m, surface_report *s) {
    tc_mesh_data reference;
    char text[256];
    int status = extract_mesh(j, &j->reference, s->iso->value, &reference);
    if (status) return status;
    s->has_verdict = 1;
    s->verified = verify_same(m, &reference, text, sizeof text);
    if (!s->verified) message("isovalue %s: verification failed: %s", s->iso->text, text);
    return 0;
}

static int has_missing_samples(const job *j) {
    size_t count = (size_t)(j->v.dims[0] * j->v.dims[1] * j->v.dims[2]);
    if (j->o->has_nodata) return 1;
    for (size_t n = 0; j->v.type == TC_F32 && n < count; n++)
        if (!isfinite(((const float *)j->v.samples)[n])) return 1;
    for (size_t n = 0; j->v.type == TC_F64 && n < count; n++)
        if (!isfinite(((const double *)j->v.samples)[n])) return 1;
    return 0;
}

/* Sets *good. Beside missing cells a vertex may rightly have several fans of triangles. */
static int check_surface(const job *j, const tc_mesh_data *m, surface_report *s, int *good) {
    const mesh_topology *t = &s->topology;
    int status = mesh_check(m->positions, m->vertex_count, m->triangles, m->triangle_count, &s->topology);
    if (status) return status;
    s->has_topology = 1;
    *good = !t->nonmanifold_edges && !t->misoriented_edges && !t->orphan_vertices && !t->invalid_triangles &&
            (!t->nonmanifold_vertices || has_missing_samples(j));
    if (!*good)
        message("isovalue %s: check failed: %llu non-manifold edges, %llu non-manifold vertices, %llu misoriented "
                "edges, %llu unused vertices, %llu invalid triangles",
                s->iso->text, (unsigned long long)t->nonmanifold_edges, (unsigned long long)t->nonmanifold_vertices,
                (unsigned long long)t->misoriented_edges, (unsigned long long)t->orphan_vertices,
                (unsigned long long)t->invalid_triangles);
    return 0;
}

static int write_surface(job *j, const tc_mesh_data *m, surface_report *s) {
    const mesh_write_options how = {.format = j->o->format, .soup = j->o->soup};
    s->path = output_path(j->o, s->iso);
    if (!s->path) return fail(STATUS_FAILED, "out of memory for the name of the output");
    double begin = now_ms();
    int status = mesh_write(s->path, m, &how);
    j->report.write_ms += now_ms() - begin;
    return status;
}

static int make_surface(job *j, surface_report *s) {
    tc_mesh_data mesh;
    int status, good = 1;
    if (j->o->count) return count_surface(j, s);
    double begin = now_ms();
    if ((status = extract_mesh(j, &j->main, s->iso->value, &mesh))) return status;
    add_device_start(j, begin, mesh.timings.total_ms + mesh.timings.readback_ms);
    describe_mesh(j->o, &mesh, s);
    if (j->o->verify && (status = verify_surface(j, &mesh, s))) return status;
    if (j->o->check && (status = check_surface(j, &mesh, s, &good))) return status;
    if ((status = progress_status())) return status;
    if (!good || (s->has_verdict && !s->verified)) {
        j->failed_count++;
        return 0;
    }
    return j->o->output ? write_surface(j, &mesh, s) : 0;
}

static int make_surfaces(job *j) {
    size_t count = j->o->isovalue_count;
    j->report.surfaces = calloc(count, sizeof *j->report.surfaces);
    if (!j->report.surfaces) return fail(STATUS_FAILED, "out of memory for the report");
    for (size_t n = 0; n < count; n++) {
        surface_report *s = &j->report.surfaces[j->report.surface_count++];
        s->iso = &j->o->isovalues[n];
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
    j.report.v = &j.v;
    int status = check_usage(o);
    if (status) goto cleanup;
    if (o->engine == TC_ENGINE_REFERENCE && o->device && !o->quiet)
        message("--device has no effect with --engine reference");
    if ((status = read_and_start(&j))) goto cleanup;
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
    volume_release(&j.v);
    return status;
}
