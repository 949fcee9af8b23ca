/*
 * A structured grid into a tetrahedral complex: the five tetrahedra of every cube that has all its corners, as the
 * structured path cuts it, and turned over where that turns its triangles over.
 */
#include "base/structs.h"
#include "convert/tetrahedralize.h"

#include "failure.h"
#include "base/float_environment.h"
#include "grid/grid.h"
#include "tables/tables.h"

typedef struct grid_source {
    tc_grid grid;
    bool may_miss; /* samples */
} grid_source;

static bool cube_missing(const grid_source *s, uint64_t cube, const uint32_t corners[8]) {
    if (s->grid.blanked_cells && s->grid.blanked_cells[cube]) return true;
    for (int c = 0; c < 8 && s->may_miss; c++)
        if (grid_sample_missing(&s->grid, corners[c])) return true;
    return false;
}

static bool cube_folded(const grid_source *s, const uint32_t tetrahedra[][4]) {
    bool positive = false, negative = false;
    for (int n = 0; n < TETRAHEDRA_PER_CUBE; n++) {
        double volume = tetrahedron_volume(s->grid.given_points, tetrahedra[n]);
        positive = positive || volume > 0;
        negative = negative || volume < 0;
    }
    return positive && negative;
}

static void cube_cut(const grid_source *s, unsigned parity, const uint32_t corners[8], uint32_t tetrahedra[][4]) {
    for (int n = 0; n < TETRAHEDRA_PER_CUBE; n++)
        for (int v = 0; v < 4; v++) {
            int from = s->grid.mirrored && v >= 2 ? 5 - v : v;
            tetrahedra[n][v] = corners[tetrahedron_corners[parity][n][from]];
        }
}

static bool cubes_cut(const void *source, uint64_t first, uint64_t end, tetrahedron_writer *writer) {
    const grid_source *s = source;
    const int64_t *dims = s->grid.dims;
    const uint64_t nx = (uint64_t)dims[0] - 1, ny = (uint64_t)dims[1] - 1;
    for (uint64_t cube = first; cube < end; cube++) {
        uint64_t x = cube % nx, y = cube / nx % ny, z = cube / nx / ny;
        uint32_t corners[8], tetrahedra[TETRAHEDRA_PER_CUBE][4];
        for (unsigned c = 0; c < 8; c++)
            corners[c] =
                (uint32_t)(((z + (c >> 2)) * (uint64_t)dims[1] + y + (c >> 1 & 1)) * (uint64_t)dims[0] + x + (c & 1));
        if (cube_missing(s, cube, corners)) {
            writer->tally->blanked++;
            continue;
        }
        cube_cut(s, (grid_parity(&s->grid) ^ (unsigned)(x + y + z)) & 1, corners, tetrahedra);
        writer->tally->inverted += s->grid.mirrored;
        if (writer->tetrahedra && s->grid.points)
            writer->tally->folded += cube_folded(s, (const uint32_t(*)[4])tetrahedra);
        tetrahedra_put(writer, (const uint32_t(*)[4])tetrahedra, TETRAHEDRA_PER_CUBE, cube);
    }
    return true;
}

static tc_status source_check(const tc_grid *grid) {
    if (!grid->samples)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_tetrahedralize_grid takes samples, not cl_samples");
    if (grid_sample_count(grid) > UINT32_MAX)
        return (tc_status)fail(TC_ERROR_LIMIT, "%lld samples: the points of tetrahedra are limited to %lu",
                               (long long)grid_sample_count(grid), (unsigned long)UINT32_MAX);
    return TC_OK;
}

tc_status tc_tetrahedralize_grid(const tc_grid_options *options, tc_tetrahedra *complex) {
    FLOAT_ENVIRONMENT_DEFAULT;
    grid_source s;
    tc_grid_options o;
    uint64_t bad_cell;
    tc_tetrahedra made = {.struct_size = sizeof made};
    tc_grid_options_init(&o);
    tc_status status = complex_begin(complex, "tc_tetrahedralize_grid: tetrahedra");
    if (!status) status = struct_copy_in(&o, sizeof o, options, "grid options");
    if (status) return status;
    s.grid = (tc_grid){0};
    status = grid_describe(&o, &s.grid);
    if (!status) status = source_check(&s.grid);
    s.may_miss = s.grid.blanked_samples || s.grid.has_nodata || type_is_real(s.grid.type);
    const uint64_t cubes = (uint64_t)((s.grid.dims[0] - 1) * (s.grid.dims[1] - 1) * (s.grid.dims[2] - 1));
    if (!status) status = complex_make(cubes_cut, &s, cubes, &made, &bad_cell);
    grid_release(&s.grid);
    if (!status) struct_copy_out(complex, &made);
    return status;
}
