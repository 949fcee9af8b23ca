/*
 * engines.h - both engines side by side: a grid extracted by each, meshes compared byte for byte
 */
#ifndef ENGINES_H
#define ENGINES_H

#include "expect.h"
#include "mesh_walk.h"
#include "tetracubes.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { SKIPPED = 77 };

/* Defaults for both, with the options for experts behind those of the context. */
static inline void options_init(tc_context_options *options, tc_expert_options *expert) {
    tc_context_options_init(options);
    tc_expert_options_init(expert);
    options->expert = expert;
}

/* A new context; without one the test ends. */
static inline tc_context *context_open(const tc_context_options *options) {
    tc_context *context = NULL;
    EXPECT(tc_context_create(options, &context) == TC_OK, "no context: %s", tc_message());
    if (!context) exit(EXIT_FAILURE);
    return context;
}

/* A test of the quick tier, which takes a sample of what the long tier tries (common/test_add.cmake). */
static inline bool tier_is_quick(void) { return getenv("TEST_PLAIN_KERNELS") != NULL; }

/* How many random cases are tried where none are asked for: in the quick tier half as many. */
static inline uint64_t tier_count(uint64_t count) { return tier_is_quick() ? count / 2 : count; }

/* In the quick tier kernels for groups are not optimised: PoCL takes ten seconds for one, and no CPU gets it unless it
 * is asked for. PoCL does not go back once it was told, so groups come last. */
static inline void groups_begin(void) {
    const char *flags = getenv("TEST_PLAIN_KERNELS");
    if (flags && *flags) setenv("POCL_EXTRA_BUILD_FLAGS", flags, 1);
}

static inline tc_context *reference_open(void) {
    tc_context_options options;
    tc_context_options_init(&options);
    options.engine = TC_ENGINE_REFERENCE;
    return context_open(&options);
}

/* False, with a line that says why, where this machine has no OpenCL device. */
static inline bool device_exists(void) {
    int count;
    if (tc_device_count(&count) == TC_OK) return true;
    printf("skipped, what needs a device: %s\n", tc_message());
    return false;
}

/* Extracts into *mesh, which is made where NULL; false where that fails. */
static inline bool extract(tc_context *context, const tc_grid_options *grid_options, const tc_extract_options *options,
                           tc_mesh **mesh, tc_mesh_data *data) {
    tc_grid *grid = NULL;
    *data = (tc_mesh_data){.struct_size = sizeof *data};
    tc_status status = tc_grid_create(context, grid_options, &grid);
    if (!status) status = tc_extract(grid, options, mesh);
    if (!status) status = tc_mesh_get(*mesh, data);
    tc_grid_destroy(grid);
    EXPECT(status == TC_OK, "extraction fails with status %d: %s", (int)status, tc_message());
    return status == TC_OK;
}

/* The bytes that the message of a refusal advises to allow. */
static inline uint64_t bytes_advised(const char *name) {
    const char *allow = strstr(tc_message(), "allow ");
    EXPECT(allow != NULL, "%s: the refusal does not say what would do: %s", name, tc_message());
    return allow ? strtoull(allow + 6, NULL, 10) : 0;
}

/* Buffers of the context have never taken more than the budget. */
static inline void expect_within(const tc_context *context, uint64_t budget, const char *name) {
    uint64_t peak = 0;
    tc_context_device_bytes(context, &peak);
    EXPECT(peak <= budget, "%s: %llu bytes of buffers, and %llu were allowed", name, (unsigned long long)peak,
           (unsigned long long)budget);
}

/* What differs between two meshes; NULL where nothing does. */
static inline const char *mesh_difference(const tc_mesh_data *a, const tc_mesh_data *b) {
    size_t vertices = 3 * sizeof(float) * (size_t)a->vertex_count;
    size_t triangles = 3 * sizeof(uint32_t) * (size_t)a->triangle_count;
    if (a->vertex_count != b->vertex_count) return "numbers of vertices differ";
    if (a->triangle_count != b->triangle_count) return "numbers of triangles differ";
    if (a->active_cell_count != b->active_cell_count) return "numbers of active cells differ";
    if (a->vertex_count && !a->normals != !b->normals) return "one mesh has normals, the other has none";
    if (vertices && memcmp(a->positions, b->positions, vertices)) return "positions differ";
    if (vertices && a->normals && memcmp(a->normals, b->normals, vertices)) return "normals differ";
    if (triangles && memcmp(a->triangles, b->triangles, triangles)) return "triangles differ";
    if (!a->boundary_labels != !b->boundary_labels) return "one mesh has labels, the other has none";
    if (triangles && a->boundary_labels && memcmp(a->boundary_labels, b->boundary_labels, triangles / 3 * 2))
        return "labels of triangles differ";
    return NULL;
}

/* The call has to end in the status, with a message. */
#define EXPECT_REFUSED(call, wanted, what)                                                                             \
    do {                                                                                                               \
        tc_status status_ = (call);                                                                                    \
        EXPECT(status_ == (wanted), "%s: status %d, not %d (%s)", what, (int)status_, (int)(wanted), tc_message());    \
        EXPECT(*tc_message(), "%s: no message", what);                                                                 \
    } while (0)

#endif
