#include "child.h"

#include "drivers/child_process.h"
#include "exit_status.h"
#include "failure.h"
#include "library_status.h"
#include "mesh_compare.h"
#include "sample_types.h"
#include "shortest.h"
#include "trials.h"
#include "vectors.h"
#include "volume.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What the child is to do. */
typedef struct selftest_job {
    int group;          /* index in trial_groups, or VECTORS */
    const char *device; /* NULL: the default */
    int quick;
    int first;           /* number of the first trial; those before are passed over */
    const char *vectors; /* file; NULL: those that come with the tool */
} selftest_job;

/* A group's run. */
typedef struct group_run {
    const selftest_job *job;
    const trial_group *group;
    tc_context *reference;
    tc_device_info info;
    uint32_t work_items; /* that the device gets by default */
    int number;          /* of the next trial */
    uint32_t most_slabs;
} group_run;

/* ---------------------------------------------------------------------------------------------------------- trials */

/* What an engine makes of a trial's volume. */
typedef struct trial_result {
    tc_grid *grid;
    tc_mesh *mesh;
    tc_interval_volume *interval;
    tc_mesh_data surface;
    tc_interval_volume_data volume; /* of interval volumes, instead */
} trial_result;

static tc_status extract_surface(const trial *t, trial_result *r) {
    tc_extract_options how;
    tc_extract_options_init(&how);
    how.isovalue = t->change == CHANGE_SUBNORMAL ? ldexp(t->isovalue, selftest_exponent(t)) : t->isovalue;
    how.normals = t->normals;
    how.closed = t->closed;
    how.method = t->method;
    return tc_extract(r->grid, &how, &r->mesh);
}

static tc_status extract_labels(const trial *t, trial_result *r) {
    tc_labels_options how;
    tc_labels_options_init(&how);
    how.closed = t->closed;
    return tc_extract_labels(r->grid, &how, &r->mesh);
}

static tc_status extract_interval(const trial *t, trial_result *r) {
    const tc_interval_volume_options how = {sizeof how, t->isovalue, t->high};
    const tc_status status = tc_extract_interval_volume(r->grid, &how, &r->interval);
    return status ? status : tc_interval_volume_get(r->interval, &r->volume);
}

static tc_status extract_trial(const trial *t, tc_context *context, const selftest_volume *v, trial_result *r) {
    r->surface.struct_size = sizeof r->surface;
    r->volume.struct_size = sizeof r->volume;
    tc_status status = selftest_grid_create(v, context, &r->grid);
    if (status) return status;
    if (t->product == PRODUCT_INTERVAL) return extract_interval(t, r);
    status = t->product == PRODUCT_LABELS ? extract_labels(t, r) : extract_surface(t, r);
    return status ? status : tc_mesh_get(r->mesh, &r->surface);
}

static void release_trial(trial_result *r) {
    tc_mesh_destroy(r->mesh);
    tc_interval_volume_destroy(r->interval);
    tc_grid_destroy(r->grid);
}

static int volumes_are_same(const tc_interval_volume_data *device, const tc_interval_volume_data *reference, char *text,
                            size_t bytes) {
    const int counts = device->sample_count == reference->sample_count && device->low_count == reference->low_count &&
                       device->high_count == reference->high_count &&
                       device->tetrahedron_count == reference->tetrahedron_count;
    if (!counts)
        snprintf(text, bytes,
                 "%" PRIu64 " vertices and %" PRIu64 " tetrahedra, the reference's are %" PRIu64 " and %" PRIu64,
                 device->vertex_count, device->tetrahedron_count, reference->vertex_count,
                 reference->tetrahedron_count);
    else if (device->vertex_count && memcmp(device->positions, reference->positions, (size_t)device->vertex_count * 12))
        snprintf(text, bytes, "vertices of the interval volume lie elsewhere than the reference's");
    else if (device->tetrahedron_count &&
             memcmp(device->tetrahedra, reference->tetrahedra, (size_t)device->tetrahedron_count * 16))
        snprintf(text, bytes, "tetrahedra have other corners than the reference's");
    return !*text;
}

static void compare_trial(const trial *t, const trial_result *device, const trial_result *reference, char *text,
                          size_t bytes) {
    const int is_volume = t->product == PRODUCT_INTERVAL;
    const uint64_t vertices = is_volume ? device->volume.vertex_count : device->surface.vertex_count;
    const uint64_t parts = is_volume ? device->volume.tetrahedron_count : device->surface.triangle_count;
    if (is_volume ? !volumes_are_same(&device->volume, &reference->volume, text, bytes)
                  : !meshes_are_same(&device->surface, &reference->surface, text, bytes))
        return;
    if (t->is_known && (vertices != t->vertices || parts != t->triangles))
        snprintf(text, bytes, "%" PRIu64 " vertices and %" PRIu64 " %s, should be %" PRIu64 " and %" PRIu64, vertices,
                 parts, is_volume ? "tetrahedra" : "triangles", t->vertices, t->triangles);
}

/* Returns 0, or an exit status where it could not be run; text: what is wrong, or "". */
static int run_trial(group_run *r, const trial *t, tc_context *device, char *text, size_t bytes) {
    trial_result results[2] = {{0}, {0}};
    selftest_volume volume;
    int status = selftest_volume_make(t, &volume);
    if (!status) status = library_status(extract_trial(t, r->reference, &volume, &results[0]));
    if (!status) {
        if (extract_trial(t, device, &volume, &results[1]))
            snprintf(text, bytes, "%s", tc_message());
        else
            compare_trial(t, &results[1], &results[0], text, bytes);
        if (results[1].surface.slab_count > r->most_slabs) r->most_slabs = results[1].surface.slab_count;
    }
    for (int e = 0; e < 2; e++) release_trial(&results[e]);
    selftest_volume_release(&volume);
    return status;
}

static void name_trial(const trial *t, const launch *l, char *name, size_t bytes) {
    int length = snprintf(name, bytes, "%s %" PRId64 "x%" PRId64 "x%" PRId64 " %s, ", t->field ? t->field : "quotients",
                          t->dims[0], t->dims[1], t->dims[2], tc_type_name(t->type));
    if (t->product == PRODUCT_LABELS)
        length += snprintf(name + length, bytes - (size_t)length, "labels");
    else
        length += snprintf(name + length, bytes - (size_t)length, "isovalue %s", shortest_number(t->isovalue).text);
    if (t->product == PRODUCT_INTERVAL)
        length += snprintf(name + length, bytes - (size_t)length, " to %s", shortest_number(t->high).text);
    const struct {
        const char *what;
        uint64_t value;
    } given[] = {{"work items", l->work_items},
                 {"groups", l->work_groups},
                 {"tile bricks", l->tile_bricks},
                 {"polls", l->spin_limit},
                 {"bytes", l->max_memory_bytes}};
    const char *changes[] = {[CHANGE_STEPS] = "steps",
                             [CHANGE_MISSING] = "missing",
                             [CHANGE_SUBNORMAL] = "subnormal",
                             [CHANGE_HUGE] = "huge",
                             [CHANGE_MIDPOINTS] = "midpoints"};
    const char *kinds[] = {"", ", rectilinear", ", curvilinear", ", tetrahedra"};
    length += snprintf(name + length, bytes - (size_t)length, "%s%s%s%s%s%s%s%s%s", t->change ? ", " : "",
                       t->change ? changes[t->change] : "", kinds[t->kind], t->method ? ", " : "",
                       t->method ? tc_method_name(t->method) : "", t->normals ? ", normals" : "",
                       t->closed ? ", closed" : "", t->mirrored ? ", mirrored" : "", t->has_nodata ? ", nodata" : "");
    for (size_t n = 0; n < sizeof given / sizeof *given; n++)
        if (given[n].value)
            length += snprintf(name + length, bytes - (size_t)length, ", %s %" PRIu64, given[n].what, given[n].value);
    if (l->division) snprintf(name + length, bytes - (size_t)length, ", division %d", (int)l->division);
}

static void report_trial(const char *text) {
    if (*text)
        child_report("failed %s", text);
    else
        child_report("ok");
}

/* ----------------------------------------------------------------------------------------------------------- groups */

static int open_device(const char *spec, const launch *l, tc_context **context) {
    tc_context_options how;
    tc_expert_options expert;
    tc_context_options_init(&how);
    tc_expert_options_init(&expert);
    how.expert = &expert;
    how.device = spec;
    expert.work_items = l->work_items;
    expert.work_groups = l->work_groups;
    expert.tile_bricks = l->tile_bricks;
    expert.spin_limit = l->spin_limit;
    expert.division = l->division;
    how.max_memory_bytes = l->max_memory_bytes;
    return library_status(tc_context_create(&how, context));
}

/* Why the device is not launched so; NULL where it is. Only compilers that are known to take the kernels for one
 * work-item get them: a driver without them does not fail. */
static const char *launch_refusal(const group_run *r, const launch *l) {
    if (l->work_items > r->info.max_work_group_size) return "the device has no groups so large";
    if (l->work_items == 1 && r->work_items != 1) return "the device gets the kernels for groups";
    if (l->division == TC_DIVISION_BUILT_IN && !r->info.rounds_division) return "the device does not round divisions";
    return l->division == TC_DIVISION_FP64 && !r->info.has_fp64 ? "the device has no fp64" : NULL;
}

/* Likewise for samples of a type. */
static const char *samples_refusal(const tc_device_info *info, tc_type type, int is_made_in_double) {
    const int needs_fp64 = type_is_wide(type) && is_made_in_double;
    return needs_fp64 && !info->has_fp64 ? "the device has no fp64" : NULL;
}

/* Whether vertices of wide samples are made on the device, which the host does of other surfaces where it has to. */
static int needs_double(const trial *t) {
    return t->kind == KIND_COMPLEX || t->method == TC_METHOD_SNAP || t->product == PRODUCT_INTERVAL;
}

static int run_launch(group_run *r, const launch *l, int trial_count) {
    tc_context *device = NULL;
    int status = 0;
    for (int t = 0; t < trial_count && !status; t++) {
        char name[300], text[700] = "";
        const int number = r->number++;
        const trial *of = &r->group->trials[t];
        const char *refusal = launch_refusal(r, l);
        if (number < r->job->first) continue;
        if (!refusal) refusal = samples_refusal(&r->info, of->type, needs_double(of));
        name_trial(of, l, name, sizeof name);
        child_report("trial %d %s", number, name);
        if (!refusal && !device) status = open_device(r->job->device, l, &device);
        if (!refusal && !status) status = run_trial(r, of, device, text, sizeof text);
        if (refusal)
            child_report("skipped %s", refusal);
        else if (!status)
            report_trial(text);
    }
    tc_context_destroy(device);
    return status;
}

static int run_group(group_run *r) {
    const trial_group *g = r->group;
    const int launches = r->job->quick ? g->quick_launches : g->launch_count;
    int status = 0;
    for (int n = 0; n < launches && !status; n++)
        status = run_launch(r, &g->launches[n], r->job->quick ? g->quick_trials : g->trial_count);
    if (status || !g->wants_slabs || r->job->first) return status;
    child_report("trial %d slabs are made", r->number);
    report_trial(r->most_slabs < 2 ? "the bound on memory did not make slabs" : "");
    return 0;
}

static int begin_group(group_run *r) {
    tc_context_options how;
    tc_context *device = NULL;
    tc_tuning tuning = {.struct_size = sizeof tuning};
    r->info.struct_size = sizeof r->info;
    int status = open_device(r->job->device, &(launch){0}, &device);
    if (!status) status = library_status(tc_context_device(device, &r->info));
    if (!status) status = library_status(tc_context_tuning(device, &tuning));
    r->work_items = tuning.work_items;
    tc_context_destroy(device);
    tc_context_options_init(&how);
    how.engine = TC_ENGINE_REFERENCE;
    return status ? status : library_status(tc_context_create(&how, &r->reference));
}

/* ---------------------------------------------------------------------------------------------------------- vectors */

static int is_quick(const vector *v) { return v->dims[0] * v->dims[1] * v->dims[2] <= 128 * 128 * 128; }

static int run_vectors(const selftest_job *job) {
    vector_list list;
    tc_context *device = NULL;
    tc_device_info info = {.struct_size = sizeof info};
    int number = 0, status = vectors_read(job->vectors, &list);
    if (!status) status = open_device(job->device, &(launch){0}, &device);
    if (!status) status = library_status(tc_context_device(device, &info));
    for (int n = 0; n < list.count && !status; n++) {
        const vector *v = &list.vectors[n];
        char text[700] = "";
        if (job->quick && !is_quick(v)) continue;
        if (number++ < job->first) continue;
        child_report("trial %d %s %" PRId64 "x%" PRId64 "x%" PRId64 " %s, isovalue %s, %s, %s", number - 1, v->field,
                     v->dims[0], v->dims[1], v->dims[2], tc_type_name(v->type), shortest_number(v->isovalue).text,
                     tc_method_name(v->method), v->options);
        const char *refusal = samples_refusal(&info, v->type, v->is_complex || v->method == TC_METHOD_SNAP);
        if (!refusal) status = vector_try(v, device, text, sizeof text);
        if (refusal)
            child_report("skipped %s", refusal);
        else if (!status)
            report_trial(text);
    }
    tc_context_destroy(device);
    vectors_release(&list);
    return status;
}

/* ------------------------------------------------------------------------------------------------------------- main */

int selftest_child(int argc, char **argv) {
    if (argc != 5) return STATUS_USAGE;
    const selftest_job job = {.group = atoi(argv[0]),
                              .device = *argv[1] ? argv[1] : NULL,
                              .quick = atoi(argv[2]),
                              .first = atoi(argv[3]),
                              .vectors = *argv[4] ? argv[4] : NULL};
    if (job.group < VECTORS || job.group >= trial_group_count) return STATUS_USAGE;
    child_begin();
    group_run r = {.job = &job};
    int status = 0;
    if (job.group == VECTORS) {
        status = run_vectors(&job);
    } else {
        r.group = &trial_groups[job.group];
        status = begin_group(&r);
        if (!status) status = run_group(&r);
        tc_context_destroy(r.reference);
    }
    child_report("end %d %s", status, status ? failure_text() : "");
    return 0;
}
