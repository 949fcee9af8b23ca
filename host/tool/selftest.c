/* selftest.c - runs the groups of trials on a device; says PASS or FAIL */
#include "commands.h"
#include "exit_status.h"
#include "failure.h"
#include "progress.h"
#include "report.h"
#include "selftest.h"
#include "verify.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What a group came to. */
typedef struct verdict {
    int trial_count, failed_count;
    uint32_t most_slabs;
    char text[512]; /* the first failure */
} verdict;

/* ---------------------------------------------------------------------------------------------------------- trials */

static tc_status extract_trial(const trial *t, tc_context *context, const selftest_volume *v, tc_grid **grid,
                               tc_mesh **mesh, tc_mesh_data *data) {
    tc_extract_options how;
    tc_extract_options_init(&how);
    how.isovalue = t->change == CHANGE_SUBNORMAL ? ldexp(t->isovalue, selftest_exponent(t)) : t->isovalue;
    how.normals = t->normals;
    how.method = t->method;
    data->struct_size = sizeof *data;
    tc_status status = selftest_grid_create(v, context, grid);
    if (!status) status = tc_extract(*grid, &how, mesh);
    return status ? status : tc_mesh_get(*mesh, data);
}

static void compare_trial(const trial *t, const tc_mesh_data *device, const tc_mesh_data *reference, char *text,
                          size_t bytes) {
    if (!verify_same(device, reference, text, bytes)) return;
    if (t->is_known && (device->vertex_count != t->vertices || device->triangle_count != t->triangles))
        snprintf(text, bytes, "%" PRIu64 " vertices and %" PRIu64 " triangles, should be %" PRIu64 " and %" PRIu64,
                 device->vertex_count, device->triangle_count, t->vertices, t->triangles);
}

/* Runs a trial; counts it, and its failure, in *v. Returns 0, or an exit status where it could not be run. */
static int run_trial(const trial *t, const launch *l, tc_context *device, tc_context *reference, verdict *v) {
    tc_grid *grids[2] = {NULL, NULL};
    tc_mesh *meshes[2] = {NULL, NULL};
    tc_mesh_data data[2] = {{0}, {0}};
    char text[256] = "";
    selftest_volume volume;
    int status = selftest_volume_make(t, &volume);
    if (status) goto cleanup;
    tc_status expected = extract_trial(t, reference, &volume, &grids[0], &meshes[0], &data[0]);
    if (expected) {
        status = library_status(expected);
        goto cleanup;
    }
    tc_status extracted = extract_trial(t, device, &volume, &grids[1], &meshes[1], &data[1]);
    if (extracted == TC_ERROR_CANCELLED) {
        status = library_status(extracted);
        goto cleanup;
    }
    if (extracted)
        snprintf(text, sizeof text, "%s", tc_message());
    else
        compare_trial(t, &data[1], &data[0], text, sizeof text);
    if (data[1].slab_count > v->most_slabs) v->most_slabs = data[1].slab_count;
    v->trial_count++;
    if (text[0] && v->failed_count++ == 0)
        snprintf(v->text, sizeof v->text,
                 "%s %" PRId64 "x%" PRId64 "x%" PRId64
                 " %s, isovalue %g, work items %u, groups %u, tile bricks %u, division %d: %s",
                 t->field ? t->field : "quotients", t->dims[0], t->dims[1], t->dims[2], tc_type_name(t->type),
                 t->isovalue, l->work_items, l->work_groups, l->tile_bricks, l->division, text);
cleanup:
    for (int e = 0; e < 2; e++) {
        tc_mesh_destroy(meshes[e]);
        tc_grid_destroy(grids[e]);
    }
    selftest_volume_release(&volume);
    return status;
}

static int open_device(const char *spec, const launch *l, tc_context **context) {
    tc_context_options how;
    tc_context_options_init(&how);
    how.device = spec;
    how.work_items = l->work_items;
    how.work_groups = l->work_groups;
    how.tile_bricks = l->tile_bricks;
    how.spin_limit = l->spin_limit;
    how.division = l->division;
    how.max_memory_bytes = l->max_memory_bytes;
    how.progress = progress_update;
    return library_status(tc_context_create(&how, context));
}

static int launch_fits(const launch *l, const tc_device_info *device) {
    return l->work_items <= device->max_work_group_size && (l->division != 1 || device->rounds_division) &&
           (l->division != 2 || device->has_fp64);
}

static int run_group(const char *spec, const tc_device_info *info, const trial_group *g, tc_context *reference,
                     verdict *v) {
    int status = 0;
    for (int n = 0; n < g->launch_count && !status; n++) {
        tc_context *device = NULL;
        if (!launch_fits(&g->launches[n], info)) continue;
        status = open_device(spec, &g->launches[n], &device);
        for (int t = 0; t < g->trial_count && !status; t++)
            status = run_trial(&g->trials[t], &g->launches[n], device, reference, v);
        tc_context_destroy(device);
        if (!status) status = progress_status();
    }
    if (!status && g->wants_slabs && v->most_slabs < 2 && v->failed_count++ == 0)
        snprintf(v->text, sizeof v->text, "the bound on memory did not make slabs");
    return status;
}

/* --------------------------------------------------------------------------------------------------------- results */

static void print_group(const trial_group *g, const verdict *v) {
    progress_clear();
    printf("%-30s %3d trials  %s\n", g->title, v->trial_count, v->failed_count ? "FAILED" : "ok");
    if (v->failed_count) printf("  %d failed; the first: %s\n", v->failed_count, v->text);
    fflush(stdout);
}

static json_t *group_json(const trial_group *g, const verdict *v) {
    return json_pack("{s:s, s:i, s:i, s:s}", "name", g->name, "trials", v->trial_count, "failed", v->failed_count,
                     "message", v->text);
}

static int describe_device(const char *spec, tc_device_info *info) {
    tc_context *context = NULL;
    *info = (tc_device_info){.struct_size = sizeof *info};
    int status = open_device(spec, &(launch){0}, &context);
    if (!status) status = library_status(tc_context_device(context, info));
    tc_context_destroy(context);
    return status;
}

static int open_reference(tc_context **context) {
    tc_context_options how;
    tc_context_options_init(&how);
    how.engine = TC_ENGINE_REFERENCE;
    return library_status(tc_context_create(&how, context));
}

/* Runs all groups; prints them, or collects them in *groups. Sets *failed_count. */
static int run_groups(const options *o, const tc_device_info *info, tc_context *reference, json_t *groups,
                      int *failed_count) {
    for (int n = 0; n < trial_group_count; n++) {
        verdict v = {0};
        int status = run_group(o->device, info, &trial_groups[n], reference, &v);
        if (status) return status;
        *failed_count += v.failed_count;
        if (o->json)
            json_array_append_new(groups, group_json(&trial_groups[n], &v));
        else
            print_group(&trial_groups[n], &v);
    }
    return 0;
}

int selftest_run(const options *o) {
    tc_device_info info;
    tc_context *reference = NULL;
    json_t *groups = NULL;
    int failed_count = 0;
    if (o->operand_count)
        return fail(STATUS_USAGE, "selftest takes no '%s'; name a device with --device", o->operands[0]);
    int status = describe_device(o->device, &info);
    if (status) goto cleanup;
    if ((status = open_reference(&reference))) goto cleanup;
    if (o->json)
        groups = json_array();
    else
        printf("%s\n", info.name);
    if ((status = run_groups(o, &info, reference, groups, &failed_count))) goto cleanup;
    if (o->json)
        status = report_print(
            json_pack("{s:s, s:O, s:b}", "device", info.name, "groups", groups, "pass", !failed_count), 15);
    else
        printf("%s\n", failed_count ? "FAIL" : "PASS");
    if (!status && failed_count)
        status = fail(STATUS_CHECK, "%d trials failed: do not trust results of %s", failed_count, info.name);
cleanup:
    json_decref(groups);
    tc_context_destroy(reference);
    return status;
}
