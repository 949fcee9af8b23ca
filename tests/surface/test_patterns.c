/*
 * test_patterns.c - every sign pattern of a cube in both parities, and every pattern of below, equal and above
 *
 * 256 patterns of one cube, at even and odd first samples; 3^8 patterns of one cube, and of the middle cube of a 4 x 4
 * x 4 grid whose other samples are below: closed surfaces. Both engines; each mesh whole against its grid
 * (mesh_walk.h), and the device's against the reference's, byte for byte.
 */
#include "engines.h"
#include "topology.h"

enum { BELOW = 99, EQUAL, ABOVE };

static tc_context *contexts[2]; /* reference; device, NULL where there is none */
static tc_mesh *meshes[2];

static void expect_pattern(const tc_grid_options *grid, const char *name, unsigned pattern, bool closed) {
    tc_extract_options options;
    tc_mesh_data data[2];
    tc_extract_options_init(&options);
    options.isovalue = EQUAL;
    for (int n = 0; n < 2 && contexts[n]; n++)
        if (!extract(contexts[n], grid, &options, &meshes[n], &data[n])) return;
    const char *fault = mesh_fault(grid, EQUAL, &data[0]);
    EXPECT(!fault, "%s, pattern %u: %s", name, pattern, fault);
    const char *difference = contexts[1] ? mesh_difference(&data[0], &data[1]) : NULL;
    EXPECT(!difference, "%s, pattern %u: device and reference: %s", name, pattern, difference);
    if (!closed) return;
    topology t;
    topology_of(data[0].positions, data[0].vertex_count, data[0].triangles, data[0].triangle_count, &t);
    EXPECT(t.boundary_edges == 0 && t.volume >= -1e-6, "%s, pattern %u: %llu boundary edges, volume %g", name, pattern,
           (unsigned long long)t.boundary_edges, t.volume);
}

static void test_signs_of_a_cube(void) {
    uint8_t samples[8];
    for (unsigned n = 0; n < 512; n++) {
        tc_grid_options grid;
        tc_grid_options_init(&grid);
        for (int axis = 0; axis < 3; axis++) grid.dims[axis] = 2;
        grid.first_index[n % 3] = n >> 8; /* odd along each axis in turn */
        grid.samples = samples;
        for (unsigned c = 0; c < 8; c++) samples[c] = n >> c & 1 ? ABOVE : BELOW;
        expect_pattern(&grid, n >> 8 ? "one odd cube" : "one even cube", n & 255, false);
    }
}

static void test_ties_of_a_cube(void) {
    uint8_t one[8], embedded[64];
    memset(embedded, BELOW, sizeof embedded);
    for (unsigned n = 0; n < 6561; n++) {
        tc_grid_options grid;
        for (unsigned c = 0, rest = n; c < 8; c++, rest /= 3) {
            one[c] = (uint8_t)(BELOW + rest % 3);
            embedded[(1 + (c & 1)) + 4 * (1 + (c >> 1 & 1)) + 16 * (1 + (c >> 2))] = one[c];
        }
        tc_grid_options_init(&grid);
        grid.first_index[0] = n & 1;
        for (int axis = 0; axis < 3; axis++) grid.dims[axis] = 2;
        grid.samples = one;
        expect_pattern(&grid, "one cube with ties", n, false);
        for (int axis = 0; axis < 3; axis++) grid.dims[axis] = 4;
        grid.samples = embedded;
        expect_pattern(&grid, "a cube with ties within others", n, true);
    }
}

int main(void) {
    tc_context_options options;
    tc_context_options_init(&options);
    contexts[0] = reference_open();
    if (device_exists()) contexts[1] = context_open(&options);
    test_signs_of_a_cube();
    test_ties_of_a_cube();
    bool skipped = !contexts[1];
    for (int n = 0; n < 2; n++) {
        tc_mesh_destroy(meshes[n]);
        tc_context_destroy(contexts[n]);
    }
    int failed = EXPECT_DONE();
    return failed || !skipped ? failed : SKIPPED;
}
