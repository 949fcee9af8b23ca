/*
 * The public calls that make surfaces: arguments are checked, drivers vetted and tried, then surface.c takes over.
 */
#include "extract.h"

#include "opencl/context.h"
#include "failure.h"
#include "grid/method.h"
#include "base/float_environment.h"
#include "base/structs.h"
#include "structured/structured.h"
#include "surface/surface.h"
#include "trial/trial.h"
#include "opencl/vetting.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void tc_extract_options_init(tc_extract_options *options) {
    if (!options) return;
    *options = (tc_extract_options){.struct_size = sizeof *options, .snap = 0.5};
}

tc_status extract_options_take(tc_extract_options *o, const tc_extract_options *options) {
    tc_extract_options_init(o);
    tc_status status = struct_copy_in(o, sizeof *o, options, "extract options");
    if (!status && !isfinite(o->isovalue))
        status = (tc_status)fail(TC_ERROR_ARGUMENT, "isovalue %g: it has to be finite", o->isovalue);
    if (!status && !tc_method_name(o->method))
        status = (tc_status)fail(TC_ERROR_ARGUMENT, "%d is no method", (int)o->method);
    if (!status && o->method == TC_METHOD_SNAP && !(o->snap >= 0 && o->snap <= 0.5))
        status = (tc_status)fail(TC_ERROR_ARGUMENT, "snap %g: it has to be from 0 to 0.5", o->snap);
    if (!status && o->reserved)
        status =
            (tc_status)fail(TC_ERROR_ARGUMENT, "reserved is %d in the extract options: it has to be 0", o->reserved);
    return status;
}

static tc_status piece_check(const tc_grid *grid, const tc_extract_options *options) {
    const int64_t before = grid->own[0], behind = grid->dims[2] - grid->own[1];
    if (grid->complex || !method_has_zeros(options->method)) return TC_OK;
    if ((!grid->cut[0] || before >= PIECE_SNAP) && (!grid->cut[1] || behind >= PIECE_SNAP)) return TC_OK;
    return (tc_status)fail(TC_ERROR_ARGUMENT,
                           "method snap needs a halo of %d planes on either side of a piece: there are %lld and %lld",
                           PIECE_SNAP, (long long)before, (long long)behind);
}

/* At the start of a call: vets kernels that are not known to be good; may switch to the other variant of the kernels.
 */
static tc_status grid_vet(tc_grid *grid, const tc_extract_options *options, bool emits) {
    if (!surface_needs_kernels(grid, options)) return TC_OK;
    if (method_has_zeros(options->method) && !device_makes_vertices(grid->context, grid->type))
        return (tc_status)fail(TC_ERROR_DEVICE, "%s has no fp64: method snap takes %s samples by the reference engine",
                               grid->context->info.name, tc_type_name(grid->type));
    tc_status status = call_vet(grid->context, surface_kind(grid, options, emits));
    if (!status && grid->device) structured_reshape(grid);
    return status;
}

tc_status surface_count_vetted(tc_grid *grid, const tc_extract_options *options, double share, tc_counts *counts) {
    tc_status status;
    do { /* again where missing samples were met, and other kernels took over, or kernels were exchanged */
        *counts = (tc_counts){.struct_size = sizeof *counts};
        status = grid_vet(grid, options, false);
        if (!status) status = trial_run(grid, options, false);
        if (!status) status = surface_count(grid, options, share, counts);
    } while (vetting_restarts(grid->context) || (!status && trial_pending(grid, options, false)));
    return status;
}

tc_status tc_count(tc_grid *grid, const tc_extract_options *options, tc_counts *counts) {
    FLOAT_ENVIRONMENT_DEFAULT;
    tc_extract_options o;
    tc_counts found = {.struct_size = sizeof found};
    tc_status status = struct_clear(counts, sizeof *counts, "tc_count: counts");
    if (!status && !grid) status = (tc_status)fail(TC_ERROR_ARGUMENT, "tc_count needs a grid");
    if (!status) status = extract_options_take(&o, options);
    if (!status) status = context_check(grid->context);
    if (!status) status = piece_check(grid, &o);
    if (!status) status = surface_count_vetted(grid, &o, 1, &found);
    if (status) return status;
    if (grid->device) grid->context->counted_grid = grid; /* for tc_emit */
    found.mesh_bytes = channels_mesh_bytes(channels_asked(&o), found.vertex_count, found.triangle_count);
    struct_copy_out(counts, &found);
    return TC_OK;
}

/* A piece's last triangles use vertices of the next piece. */
static tc_status seam_refuse(const char *call) {
    return (tc_status)fail(TC_ERROR_ARGUMENT, "%s takes no piece that others follow: use tc_extract_piece", call);
}

tc_status tc_emit(tc_grid *grid, const tc_extract_options *options, const tc_device_mesh *mesh,
                  struct _cl_event **done) {
    FLOAT_ENVIRONMENT_DEFAULT;
    tc_extract_options o;
    tc_device_mesh m = {0};
    if (done) *done = NULL;
    if (!grid) return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_emit needs a grid");
    tc_status status = struct_copy_in(&m, sizeof m, mesh, "tc_emit: mesh");
    if (!status) status = extract_options_take(&o, options);
    if (!status) status = context_check(grid->context);
    if (status) return status;
    if (grid->complex)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_emit does not take grids of tetrahedra: use tc_extract");
    if (!grid->device) return (tc_status)fail(TC_ERROR_ARGUMENT, "the reference engine has no device to emit on");
    if (grid_has_seam(grid)) return seam_refuse("tc_emit");
    status = structured_emit(grid, &o, &m, done);
    vetting_restarts(grid->context); /* what was counted is gone: the caller counts again */
    return status;
}

static tc_status vetted_extract(tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh) {
    tc_status status = grid_vet(grid, options, true);
    if (!status) status = trial_run(grid, options, true);
    if (!status) status = surface_extract(grid, options, mesh);
    if (!status) memcpy(mesh->origin, grid->origin, sizeof mesh->origin);
    return status ? status : trial_run(grid, options, true); /* of other kernels, where missing samples were met */
}

tc_status tc_extract(tc_grid *grid, const tc_extract_options *options, tc_mesh **out) {
    FLOAT_ENVIRONMENT_DEFAULT;
    tc_extract_options o;
    if (out && *out) mesh_clear(*out);
    if (!grid || !out) return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_extract needs a grid and a place for the mesh");
    tc_mesh *mesh = *out ? *out : calloc(1, sizeof *mesh);
    if (!mesh) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for a mesh");
    mesh_clear(mesh);
    tc_status status = extract_options_take(&o, options);
    if (!status) status = context_check(grid->context);
    if (!status) status = piece_check(grid, &o);
    if (!status && grid_has_seam(grid) && !grid->seams.next) status = seam_refuse("tc_extract");
    if (!status) status = vetted_extract(grid, &o, mesh);
    while (vetting_restarts(grid->context)) { /* kernels were exchanged on the way */
        mesh_clear(mesh);
        status = vetted_extract(grid, &o, mesh);
    }
    if (status) mesh_clear(mesh);
    if (status && !*out) {
        tc_mesh_destroy(mesh);
        mesh = NULL;
    }
    *out = mesh;
    return status;
}
