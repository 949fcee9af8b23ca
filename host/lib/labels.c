/*
 * The public call for label maps: arguments are checked, the labels that are wanted taken, surfaces made and smoothed.
 */
#include "base/float_environment.h"
#include "base/structs.h"
#include "failure.h"
#include "grid/label_volume.h"
#include "grid/mesh.h"
#include "labels/label_run.h"
#include "labels/smooth.h"
#include "opencl/context.h"
#include "opencl/vetting.h"
#include "reference/reference_labels.h"
#include "trial/trial.h"

#include <stdlib.h>
#include <string.h>

enum { SWEEPS_DEFAULT = 8, SWEEPS_MOST = 1000 };

void tc_labels_options_init(tc_labels_options *options) {
    if (!options) return;
    *options = (tc_labels_options){.struct_size = sizeof *options, .smoothing = SWEEPS_DEFAULT};
}

static tc_status options_take(const tc_grid *grid, tc_labels_options *o, const tc_labels_options *options) {
    tc_labels_options_init(o);
    tc_status status = struct_copy_in(o, sizeof *o, options, "label options");
    if (!status && o->smoothing > SWEEPS_MOST)
        status = (tc_status)fail(TC_ERROR_ARGUMENT, "%lu sweeps of smoothing: at most %d", (unsigned long)o->smoothing,
                                 SWEEPS_MOST);
    if (!status && o->smoothing && grid->kind != GRID_UNIFORM && !grid->complex)
        status = (tc_status)fail(TC_ERROR_ARGUMENT, "surfaces of label maps are smoothed on uniform grids only: set "
                                                    "smoothing to 0");
    return status;
}

/* Kernels place vertices of uniform grids only; the host makes the surfaces of others. */
static bool runs_on_device(const tc_grid *grid) {
    return grid->context->options.engine == TC_ENGINE_OPENCL && grid->kind == GRID_UNIFORM;
}

/* By kernels that are vetted and tried first; again if vetting has switched to the other variant. */
static tc_status device_make(const label_volume *volume, tc_mesh *mesh) {
    tc_context *context = volume->grid->context;
    tc_status status;
    do {
        status = call_vet(context, labels_kind(volume));
        if (!status) status = trial_once(context, labels_kind(volume));
        if (!status) status = labels_extract(volume, volume->grid->scan, mesh);
    } while (vetting_restarts(context));
    return status;
}

static tc_status surfaces_make(const tc_grid *grid, const tc_labels_options *o, tc_mesh *mesh) {
    label_volume volume = {0};
    const double start = clock_ms();
    tc_status status = label_volume_make(grid, o, &volume);
    const double known = clock_ms();
    if (!status) status = runs_on_device(grid) ? device_make(&volume, mesh) : reference_labels(&volume, mesh);
    const double made = clock_ms();
    if (!status) status = labels_smooth(&volume, o->smoothing, mesh);
    if (!status) memcpy(mesh->origin, grid->origin, sizeof mesh->origin);
    mesh->timings.total_ms += known - start + clock_ms() - made; /* not the building of kernels */
    label_volume_release(&volume);
    return status;
}

tc_status tc_extract_labels(tc_grid *grid, const tc_labels_options *options, tc_mesh **out) {
    FLOAT_ENVIRONMENT_DEFAULT;
    tc_labels_options o;
    if (out && *out) mesh_clear(*out);
    if (!grid || !out)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_extract_labels needs a grid and a place for the mesh");
    tc_mesh *mesh = *out ? *out : mesh_create(grid->context->spare);
    if (!mesh) return TC_ERROR_MEMORY;
    tc_status status = options_take(grid, &o, options);
    if (!status) status = context_check(grid->context);
    if (!status) status = surfaces_make(grid, &o, mesh);
    if (status) mesh_clear(mesh);
    if (status && !*out) {
        tc_mesh_destroy(mesh);
        mesh = NULL;
    }
    *out = mesh;
    return status;
}
