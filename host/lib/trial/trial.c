/*
 * The trial and its verdicts; the volume is made by trial_volume.c.
 */
#include "trial/trial.h"

#include "opencl/context.h"
#include "failure.h"
#include "surface/grids.h"
#include "opencl/kernels.h"
#include "grid/complex.h"
#include "grid/mesh.h"
#include "surface/surface.h"
#include "reference/reference_interval.h"
#include "structured/structured_interval.h"

#include <stdlib.h>
#include <string.h>

bool trial_pending(const tc_grid *grid, const tc_extract_options *options, bool emits) {
    const tc_context *context = grid->context;
    return context->options.check_device && surface_needs_kernels(grid, options) &&
           !context->trial_passed[kind_number(surface_kind(grid, options, emits))];
}

/* ------------------------------------------------------------------------------------------------------- comparison */

static tc_status wrong(const tc_context *context, const trial_volume *v, const char *what, uint64_t n) {
    static const char *const kinds[] = {"uniform", "rectilinear", "curvilinear"};
    return (tc_status)fail(TC_ERROR_WRONG_RESULT,
                           "device %s gives wrong results: %s %llu of a small %s grid of %s samples%s is not that of "
                           "the reference engine; use that one",
                           context->info.name, what, (unsigned long long)n,
                           v->unstructured ? "unstructured" : kinds[v->kind], tc_type_name(v->type),
                           v->missing ? ", some missing," : "");
}

/* The first of count triples of words that differs, or count. */
static uint64_t difference(const void *a, const void *b, uint64_t count) {
    enum { TRIPLE = 12 };
    uint64_t n = 0;
    while (n < count && !memcmp((const char *)a + n * TRIPLE, (const char *)b + n * TRIPLE, TRIPLE)) n++;
    return n;
}

static tc_status counts_compare(const tc_context *context, const trial_volume *v, const tc_counts *found,
                                const tc_mesh *expected) {
    if (found->vertex_count != expected->vertex_count)
        return wrong(context, v, "the number of vertices,", found->vertex_count);
    if (found->triangle_count != expected->triangle_count)
        return wrong(context, v, "the number of triangles,", found->triangle_count);
    if (found->active_cell_count != expected->active_cell_count)
        return wrong(context, v, "the number of active cells,", found->active_cell_count);
    return TC_OK;
}

static tc_status meshes_compare(const tc_context *context, const trial_volume *v, const tc_mesh *found,
                                const tc_mesh *expected) {
    const tc_counts counts = {.vertex_count = found->vertex_count,
                              .triangle_count = found->triangle_count,
                              .active_cell_count = found->active_cell_count};
    tc_status status = counts_compare(context, v, &counts, expected);
    if (status) return status;
    uint64_t n = difference(found->triangles.memory, expected->triangles.memory, expected->triangle_count);
    if (n < expected->triangle_count) return wrong(context, v, "triangle", n);
    for (int channel = 0; channel < CHANNEL_COUNT; channel++) {
        if (!channel_in(expected->made, channel)) continue;
        n = difference(found->channels[channel].memory, expected->channels[channel].memory, expected->vertex_count);
        if (n < expected->vertex_count) return wrong(context, v, mesh_channels[channel].one, n);
    }
    return TC_OK;
}

/* ------------------------------------------------------------------------------------------------------------ trial */

/* Two isovalues: one that samples have, and one that none has, so that quotients of integers have full mantissas. */
enum { SURFACES = 2 };

/* On a grid of the host's alone, before the device has seen the volume: it may write where it should only read. */
static tc_status reference_make(const trial_volume *v, const tc_extract_options how[SURFACES],
                                tc_mesh *meshes[SURFACES]) {
    tc_context host = {.options = {.struct_size = sizeof host.options, .engine = TC_ENGINE_REFERENCE}};
    tc_grid *grid;
    tc_status status = trial_grid_create(v, &host, host.launch.scan, &grid);
    for (int n = 0; n < SURFACES && !status; n++) {
        meshes[n] = mesh_create(NULL);
        status = meshes[n] ? surface_extract(grid, &how[n], meshes[n]) : TC_ERROR_MEMORY;
    }
    grid_destroy(grid);
    return status;
}

static tc_status count_try(tc_context *context, const trial_volume *v, tc_grid *grid, const tc_extract_options *how,
                           const tc_mesh *expected) {
    tc_counts counts = {.struct_size = sizeof counts};
    tc_status status = surface_count(grid, how, 1, &counts);
    return status ? status : counts_compare(context, v, &counts, expected);
}

static tc_status extract_try(tc_context *context, const trial_volume *v, tc_grid *grid, const tc_extract_options *how,
                             const tc_mesh *expected) {
    tc_mesh *mesh = mesh_create(NULL);
    if (!mesh) return TC_ERROR_MEMORY;
    tc_status status = surface_extract(grid, how, mesh);
    if (!status) status = meshes_compare(context, v, mesh, expected);
    tc_mesh_destroy(mesh);
    return status;
}

/* The second surface is made by the fallback of the scan: every tile recomputes the one before it. Its grid was counted
 * before, and has ranges. One mesh at a time: a launch that does nothing must not find another's results. */
static tc_status device_try(tc_context *context, const trial_volume *v, const tc_extract_options how[SURFACES],
                            bool emits, tc_mesh *const expected[SURFACES]) {
    tc_grid *counted = NULL, *grid = NULL;
    const scan_parameters usual = {.tile_bricks = 1, .spin_limit = context->launch.scan.spin_limit};
    tc_status status = trial_grid_create(v, context, usual, &counted);
    if (!status) status = count_try(context, v, counted, &how[0], expected[0]);
    if (!status) status = trial_grid_create(v, context, usual, &grid);
    if (!status && emits) status = extract_try(context, v, grid, &how[0], expected[0]);
    if (!status) grid->scan.spin_limit = 1;
    if (!status) status = count_try(context, v, grid, &how[1], expected[1]);
    if (!status && emits) status = extract_try(context, v, grid, &how[1], expected[1]);
    grid_destroy(grid);
    grid_destroy(counted);
    return status;
}

/* Builds the kernels apart from running them, so that the report can tell which of the two failed. */
static tc_status kernels_build(tc_context *context, kernel_kind kind) {
    sized_kernel of_complexes[ALL_COMPLEX_KERNELS];
    kernels k;
    tc_status status =
        kind.grid == KIND_COMPLEX ? complex_kernels_get(context, kind, of_complexes) : kernels_get(context, kind, &k);
    return status ? status : context_progress(context, "run", 0);
}

/* What one interval volume has is compared, counts first. */
static tc_status interval_compare(tc_context *context, const trial_volume *v, tc_grid *grid,
                                  const tc_interval_volume_options *how, const tc_interval_volume *expected) {
    interval_size size;
    double ms;
    tc_interval_volume found = {.slab_count = 1};
    tc_status status = grid->complex ? complex_interval_count(grid, how, &size, &ms)
                                     : structured_interval_count(grid, how, &size, &ms);
    if (!status && memcmp(&size, &expected->size, sizeof size))
        status = wrong(context, v, "the number of tetrahedra,", size.tetrahedra);
    if (!status)
        status = grid->complex ? complex_interval_extract(grid, how, &found)
                               : structured_interval_extract(grid, how, &found);
    const uint64_t vertices = interval_first(&size, BLOCK_COUNT), indices = 4 * size.tetrahedra;
    uint64_t n = status ? 0 : difference(found.positions.memory, expected->positions.memory, vertices);
    if (!status && n < vertices) status = wrong(context, v, "vertex of an interval volume,", n);
    for (n = 0; n < indices && !status; n++)
        if (((uint32_t *)found.tetrahedra.memory)[n] != ((uint32_t *)expected->tetrahedra.memory)[n])
            status = wrong(context, v, "tetrahedron", n / 4);
    host_block_release(&found.positions);
    host_block_release(&found.tetrahedra);
    return status;
}

static tc_status interval_try(tc_context *context, trial_volume *v) {
    tc_context host = {.options = {.struct_size = sizeof host.options, .engine = TC_ENGINE_REFERENCE}};
    tc_grid *grid = NULL;
    tc_interval_volume expected = {.slab_count = 1};
    tc_status status = trial_volume_make(v);
    const tc_interval_volume_options how = {sizeof how, v->isovalue, v->isovalue + (type_is_real(v->type) ? 0.3 : 3.3)};
    if (!status) status = trial_grid_create(v, &host, host.launch.scan, &grid);
    if (!status)
        status = v->unstructured ? reference_complex_interval_extract(grid, &how, &expected)
                                 : reference_interval_extract(grid, &how, &expected);
    grid_destroy(grid);
    grid = NULL;
    if (!status) status = trial_grid_create(v, context, context->launch.scan, &grid);
    if (!status) status = interval_compare(context, v, grid, &how, &expected);
    grid_destroy(grid);
    host_block_release(&expected.positions);
    host_block_release(&expected.tetrahedra);
    return status;
}

static tc_status volume_try(tc_context *context, trial_volume *v, kernel_kind kind) {
    tc_extract_options how[SURFACES];
    tc_mesh *meshes[SURFACES] = {NULL, NULL};
    tc_status status = trial_volume_make(v);
    for (int n = 0; n < SURFACES; n++) {
        how[n] = (tc_extract_options){.struct_size = sizeof how[n],
                                      .isovalue = v->isovalue + (n ? 0.3 : 0),
                                      .method = kind.method,
                                      .normals = channel_in(kind.made, CHANNEL_NORMALS),
                                      .closed = kind.closed};
    }
    if (!status) status = reference_make(v, how, meshes);
    if (!status) status = device_try(context, v, how, kind.emits, meshes);
    for (int n = 0; n < SURFACES; n++) tc_mesh_destroy(meshes[n]);
    return status;
}

tc_status trial_of_kind(tc_context *context, kernel_kind kind) {
    if (kind.grid == KIND_LABELS) return trial_of_labels(context, kind);
    trial_volume v = {.type = kind.type,
                      .kind = kind.grid == KIND_COMPLEX ? GRID_CURVILINEAR : (grid_kind)kind.grid,
                      .unstructured = kind.grid == KIND_COMPLEX,
                      .whole = kind.grid == KIND_COMPLEX && kind.method == TC_METHOD_HYBRID,
                      .missing = kind.missing,
                      .plain = channel_in(kind.made, CHANNEL_NORMALS)};
    tc_status status = context->for_trial ? kernels_build(context, kind) : TC_OK;
    context->trial_runs = true;
    if (!status) status = kind.interval ? interval_try(context, &v) : volume_try(context, &v, kind);
    context->trial_runs = false;
    trial_volume_release(&v);
    return status;
}

tc_status trial_once(tc_context *context, kernel_kind kind) {
    bool *passed = &context->trial_passed[kind_number(kind)];
    if (!context->options.check_device || *passed) return TC_OK;
    const double start = clock_ms();
    tc_status status = trial_of_kind(context, kind);
    context->build_ms += clock_ms() - start;
    if (status) return status;
    *passed = true;
    return context_progress(context, "trial", 0);
}

tc_status trial_run(const tc_grid *grid, const tc_extract_options *options, bool emits) {
    if (!trial_pending(grid, options, emits)) return TC_OK;
    return trial_once(grid->context, surface_kind(grid, options, emits));
}
