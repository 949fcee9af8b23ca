/*
 * The trial of the kernels of label maps: a volume with edges of words, bricks and tiles, where up to four labels meet
 * in most tetrahedra, against the reference; then once more by the fallback of the scan.
 */
#include "trial/trial.h"

#include "failure.h"
#include "grid/label_volume.h"
#include "labels/label_run.h"
#include "opencl/context.h"
#include "reference/reference_labels.h"
#include "surface/grids.h"

#include <stdlib.h>
#include <string.h>

enum { NX = 70, NY = 17, NZ = 9, SAMPLES = NX * NY * NZ };

/* Labels of 0 to 5, with others in between that fill the type. */
static void labels_make(tc_type type, uint32_t *memory) {
    const uint32_t large = type == TC_U8 ? 250 : type == TC_U16 ? 65530 : 4294967290u;
    uint64_t state = 1;
    for (int n = 0; n < SAMPLES; n++) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        const uint32_t label = (uint32_t)(state >> 61) % 6, other = label > 3 ? large + label : label;
        if (type == TC_U8)
            ((uint8_t *)memory)[n] = (uint8_t)other;
        else if (type == TC_U16)
            ((uint16_t *)memory)[n] = (uint16_t)other;
        else
            memory[n] = other;
    }
}

static tc_status compare(const tc_context *context, const tc_mesh *found, const tc_mesh *expected) {
    const char *what = NULL;
    const size_t vertices = (size_t)expected->vertex_count, triangles = (size_t)expected->triangle_count;
    if (found->vertex_count != vertices || found->triangle_count != triangles ||
        found->active_cell_count != expected->active_cell_count)
        what = "a number of vertices, triangles or cells";
    else if (memcmp(found->channels[0].memory, expected->channels[0].memory, vertices * CHANNEL_BYTES))
        what = "a vertex";
    else if (memcmp(found->triangles.memory, expected->triangles.memory, triangles * TRIANGLE_BYTES))
        what = "a triangle";
    else if (memcmp(found->boundary_labels.memory, expected->boundary_labels.memory, triangles * LABELS_BYTES))
        what = "a label";
    if (!what) return TC_OK;
    return (tc_status)fail(TC_ERROR_WRONG_RESULT,
                           "device %s gives wrong results: %s of a small label map is not that of the reference "
                           "engine; use that one",
                           context->info.name, what);
}

static tc_status kernels_build(tc_context *context, kernel_kind kind) {
    sized_kernel built[LABEL_KERNELS];
    tc_status status = label_kernels_get(context, kind, built);
    return status ? status : context_progress(context, "run", 0);
}

static tc_status device_try(tc_context *context, const label_volume *volume, const tc_mesh *expected) {
    tc_status status = TC_OK;
    for (uint32_t again = 0; again < 2 && !status; again++) {
        tc_mesh *mesh = mesh_create(NULL);
        if (!mesh) return TC_ERROR_MEMORY;
        const scan_parameters scan = {1, again ? 1 : context->launch.scan.spin_limit};
        status = labels_extract(volume, scan, mesh);
        if (!status) status = compare(context, mesh, expected);
        tc_mesh_destroy(mesh);
    }
    return status;
}

static tc_status volume_try(tc_context *context, const tc_grid_options *grid_options) {
    tc_labels_options all;
    tc_labels_options_init(&all);
    label_volume volume = {0};
    tc_grid *grid = NULL;
    tc_mesh *expected = mesh_create(NULL);
    tc_status status = expected ? grid_create(context, grid_options, context->launch.scan, &grid) : TC_ERROR_MEMORY;
    if (!status) status = label_volume_make(grid, &all, &volume);
    if (!status) status = reference_labels(&volume, expected);
    if (!status) status = device_try(context, &volume, expected);
    label_volume_release(&volume);
    tc_mesh_destroy(expected);
    grid_destroy(grid);
    return status;
}

tc_status trial_of_labels(tc_context *context, kernel_kind kind) {
    static const double matrix[3][4] = {{0.7, 0.1, 0, 3}, {0, -0.9, 0.2, 1}, {0.3, 0, 1.3, 0}};
    tc_grid_options options;
    uint32_t *samples = malloc(SAMPLES * sizeof *samples);
    if (!samples) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the trial of a device");
    labels_make(kind.type, samples);
    tc_grid_options_init(&options);
    options.dims[0] = NX, options.dims[1] = NY, options.dims[2] = NZ;
    options.type = kind.type;
    options.samples = samples;
    memcpy(options.matrix, matrix, sizeof matrix);
    tc_status status = context->for_trial ? kernels_build(context, kind) : TC_OK;
    context->trial_runs = true;
    if (!status) status = volume_try(context, &options);
    context->trial_runs = false;
    free(samples);
    return status;
}
