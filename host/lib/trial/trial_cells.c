/*
 * The cells of a trial of method hybrid: the volume's cubes in pairs along x, each pair in one of six ways, so that
 * cells of all shapes meet, cut faces and prisms among them; some are turned over.
 */
#include "trial/trial.h"

#include "failure.h"
#include "tables/cell_split.h"

#include <stdlib.h>
#include <string.h>

enum { HEXAHEDRON = 12, VOXEL = 11, WEDGE = 13, PYRAMID = 14, TETRAHEDRON = 10, PRISM = 16 };
enum { WAYS = 6, CELLS_MOST = 12, POINTS_MOST = 48 }; /* of a pair: twelve tetrahedra, or two cubes' */

static void cell_add(tc_cells *c, unsigned type, const uint32_t *points, const uint8_t *order, int count) {
    int64_t *offsets = (int64_t *)(uintptr_t)c->offsets, first = offsets[c->cell_count];
    for (int n = 0; n < count; n++) ((int64_t *)(uintptr_t)c->connectivity)[first + n] = points[order[n]];
    ((uint8_t *)(uintptr_t)c->types)[c->cell_count++] = (uint8_t)type;
    offsets[c->cell_count] = first + count;
}

/* points: of a cube, as VTK numbers a hexahedron's. */
static void cube_add(tc_cells *c, unsigned way, const uint32_t points[CELL_CORNERS_MAX]) {
    static const uint8_t straight[8] = {0, 1, 2, 3, 4, 5, 6, 7}, turned[8] = {4, 5, 6, 7, 0, 1, 2, 3};
    static const uint8_t voxel[8] = {0, 1, 3, 2, 4, 5, 7, 6}, wedges[2][6] = {{0, 2, 1, 4, 6, 5}, {0, 3, 2, 4, 7, 6}};
    static const uint8_t pyramids[3][5] = {{1, 2, 6, 5, 0}, {3, 7, 6, 2, 0}, {4, 5, 6, 7, 0}};
    uint32_t cut[CELL_TETRAHEDRA_MAX][4];
    if (way == 0) cell_add(c, HEXAHEDRON, points, straight, 8);
    if (way == 1) cell_add(c, HEXAHEDRON, points, turned, 8);
    if (way == 2) cell_add(c, VOXEL, points, voxel, 8);
    for (int n = 0; n < 2 && way == 3; n++) cell_add(c, WEDGE, points, wedges[n], 6);
    for (int n = 0; n < 3 && way == 4; n++) cell_add(c, PYRAMID, points, pyramids[n], 5);
    const int count = way == 5 ? cell_split(CELL_HEXAHEDRON, points, cut) : 0;
    for (int n = 0; n < count; n++) cell_add(c, TETRAHEDRON, cut[n], straight, 4);
}

/* at: of the first point; step: to the next along each axis. */
static void pair_add(tc_cells *c, uint32_t way, uint32_t at, const uint32_t step[3]) {
    static const uint8_t order[12] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    uint32_t prism[12];
    for (uint32_t n = 0; n < 12; n++) {
        const uint32_t around = n % 6, x = around < 3 ? around : 5 - around;
        prism[n] = at + x * step[0] + (around > 2) * step[1] + n / 6 * step[2];
    }
    if (way == WAYS) {
        cell_add(c, PRISM, prism, order, 12);
        return;
    }
    for (int cube = 0; cube < 2; cube++) {
        const uint32_t *p = prism + cube;
        const uint32_t points[CELL_CORNERS_MAX] = {p[0], p[1], prism[4 - cube],  prism[5 - cube],
                                                   p[6], p[7], prism[10 - cube], prism[11 - cube]};
        cube_add(c, cube ? (way + 1) % WAYS : way, points);
    }
}

tc_status trial_cells_make(trial_volume *v, uint64_t noise(uint64_t)) {
    const uint64_t nx = (uint64_t)v->options.dims[0], ny = (uint64_t)v->options.dims[1],
                   nz = (uint64_t)v->options.dims[2];
    const uint64_t pairs = (nx - 1) / 2 * (ny - 1) * (nz - 1);
    const uint32_t step[3] = {1, (uint32_t)nx, (uint32_t)(nx * ny)};
    tc_cells *c = &v->cells;
    *c = (tc_cells){.struct_size = sizeof *c, .point_count = nx * ny * nz, .points = v->points};
    c->types = malloc(CELLS_MOST * pairs);
    c->offsets = calloc(CELLS_MOST * pairs + 1, sizeof *c->offsets);
    c->connectivity = malloc(POINTS_MOST * pairs * sizeof *c->connectivity);
    if (!c->types || !c->offsets || !c->connectivity)
        return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the trial of a device");
    for (uint64_t n = 0; n < pairs; n++) {
        const uint64_t x = 2 * (n % ((nx - 1) / 2)), row = n / ((nx - 1) / 2), y = row % (ny - 1), z = row / (ny - 1);
        pair_add(c, (uint32_t)(noise(n) >> 32) % (WAYS + 1), (uint32_t)((z * ny + y) * nx + x), step);
    }
    return tc_tetrahedralize(c, &v->complex);
}

void trial_cells_release(trial_volume *v) {
    free((void *)(uintptr_t)v->cells.types);
    free((void *)(uintptr_t)v->cells.offsets);
    free((void *)(uintptr_t)v->cells.connectivity);
    v->cells = (tc_cells){0};
}
