/*
 * The trial and its verdicts; the volume is made by trial_volume.c.
 */
#include "trial.h"

#include "complex.h"
#include "failure.h"
#include "inside.h"
#include "structured_run.h"

#include <string.h>

/* ------------------------------------------------------------------------------------------------------------ kinds */

/* What decides on the kernels; a number below TRIAL_KINDS. */
static unsigned kind_of(const tc_grid *grid, const tc_extract_options *options, bool emits) {
    unsigned kind = grid->complex ? 3 : (unsigned)grid->kind;
    bool missing = grid->device && grid->device->missing, hybrid = options->method == TC_METHOD_HYBRID;
    if (!emits && !grid->complex) kind = 0; /* kernel 1 knows nothing of coordinates */
    bool normals = emits && options->normals;
    return ((((kind * 8 + (unsigned)grid->type) * 2 + hybrid) * 2 + missing) * 2 + normals) * 2 + emits;
}

bool trial_pending(const tc_grid *grid, const tc_extract_options *options, bool emits) {
    const tc_context *context = grid->context;
    if (!context->options.check_device || context->options.engine != TC_ENGINE_OPENCL) return false;
    if (grid->complex && !grid->complex->tetrahedron_count) return false;
    return !inside_range_of(grid->type, options->isovalue).uniform && !context->passed[kind_of(grid, options, emits)];
}

/* ------------------------------------------------------------------------------------------------------- comparison */

static tc_status wrong(const tc_context *context, const trial_volume *v, const char *what, uint64_t n) {
    static const char *const kinds[] = {"uniform", "rectilinear", "curvilinear"};
    return (tc_status)fail(TC_ERROR_WRONG,
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
    n = difference(found->positions.memory, expected->positions.memory, expected->vertex_count);
    if (n < expected->vertex_count) return wrong(context, v, "vertex", n);
    if (!expected->has_normals) return TC_OK;
    n = difference(found->normals.memory, expected->normals.memory, expected->vertex_count);
    return n < expected->vertex_count ? wrong(context, v, "normal", n) : TC_OK;
}

/* ------------------------------------------------------------------------------------------------------------ trial */

/* Two isovalues: one that samples have, and one that none has, so that quotients of integers have full mantissas. */
enum { SURFACES = 2 };

static tc_status reference_make(const trial_volume *v, const tc_extract_options how[SURFACES], tc_context **context,
                                tc_grid **grid, tc_mesh *meshes[SURFACES]) {
    tc_context_options reference;
    tc_context_options_init(&reference);
    reference.engine = TC_ENGINE_REFERENCE;
    tc_status status = tc_context_create(&reference, context);
    if (!status) status = trial_grid_create(v, *context, grid);
    for (int n = 0; n < SURFACES && !status; n++) status = tc_extract(*grid, &how[n], &meshes[n]);
    return status;
}

static tc_status count_try(tc_context *context, const trial_volume *v, tc_grid *grid, const tc_extract_options *how,
                           const tc_mesh *expected) {
    tc_counts counts = {.struct_size = sizeof counts};
    tc_status status = tc_count(grid, how, &counts);
    return status ? status : counts_compare(context, v, &counts, expected);
}

static tc_status extract_try(tc_context *context, const trial_volume *v, tc_grid *grid, const tc_extract_options *how,
                             const tc_mesh *expected) {
    tc_mesh *mesh = NULL;
    tc_status status = tc_extract(grid, how, &mesh);
    if (!status) status = meshes_compare(context, v, mesh, expected);
    tc_mesh_destroy(mesh);
    return status;
}

/* One mesh only: a launch that does nothing must not find another's results. */
static tc_status device_try(tc_context *context, const trial_volume *v, const tc_extract_options how[SURFACES],
                            bool emits, tc_mesh *const expected[SURFACES]) {
    tc_grid *counted = NULL, *grid = NULL;
    context->options.tile_bricks = 1;
    tc_status status = trial_grid_create(v, context, &counted);
    if (!status) status = count_try(context, v, counted, &how[0], expected[0]);
    if (!status) status = trial_grid_create(v, context, &grid);
    if (!status && emits) status = extract_try(context, v, grid, &how[0], expected[0]);
    context->options.spin_limit = 1; /* every tile recomputes the one before it */
    if (!status) status = count_try(context, v, grid, &how[1], expected[1]);
    if (!status && emits) status = extract_try(context, v, grid, &how[1], expected[1]);
    tc_grid_destroy(grid);
    tc_grid_destroy(counted);
    return status;
}

static tc_status kinds_try(tc_context *context, trial_volume *v, const tc_extract_options *options, bool emits) {
    tc_extract_options how[SURFACES] = {*options, *options};
    tc_context *reference = NULL;
    tc_grid *grid = NULL;
    tc_mesh *meshes[SURFACES] = {NULL, NULL};
    const tc_context_options kept = context->options;
    tc_status status = trial_volume_make(v);
    how[0].isovalue = v->isovalue;
    how[1].isovalue = v->isovalue + 0.3;
    if (!status) status = reference_make(v, how, &reference, &grid, meshes);
    context->options.check_device = 0;
    context->options.progress = NULL;
    if (!status) status = device_try(context, v, how, emits, meshes);
    context->options = kept;
    for (int n = 0; n < SURFACES; n++) tc_mesh_destroy(meshes[n]);
    tc_grid_destroy(grid);
    tc_context_destroy(reference);
    return status;
}

tc_status trial_run(const tc_grid *grid, const tc_extract_options *options, bool emits) {
    if (!trial_pending(grid, options, emits)) return TC_OK;
    trial_volume v = {.type = grid->type,
                      .kind = grid->kind,
                      .unstructured = grid->complex != NULL,
                      .missing = grid->device && grid->device->missing,
                      .plain = options->normals != 0};
    tc_status status = kinds_try(grid->context, &v, options, emits);
    trial_volume_release(&v);
    if (status) return status;
    grid->context->passed[kind_of(grid, options, emits)] = true;
    return context_progress(grid->context, "trial", 0);
}
