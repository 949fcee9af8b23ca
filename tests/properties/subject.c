#include "subject.h"

#include "random.h"
#include "samples.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *kind_name(kind k) {
    static const char *const names[KINDS] = {"uniform", "rectilinear", "curvilinear", "missing",
                                             "hybrid",  "tetrahedra",  "hexahedra",   "mixed"};
    return names[k];
}

/* ------------------------------------------------------------------------------------------------------- the field */

typedef enum field_kind { NOISE, WAVES, SMALL, TIES, EXTREMES, FIELD_KINDS } field_kind;

static double clamp(tc_type type, double value) { return fmin(fmax(value, type_least(type)), type_most(type)); }

static double extreme_value(tc_type type) {
    if (!type_is_floating(type)) {
        const double values[] = {type_least(type), type_most(type), type_least(type) + 1, type_most(type) - 1, 1};
        return values[random_below(5)];
    }
    const double least = type == TC_F32 ? 0x1p-149 : 0x1p-1074;
    const double values[] = {type_most(type), -type_most(type), least, -least, 0.0, -0.0, 3 * least, 1};
    return values[random_below(8)];
}

static double field_value(field_kind f, tc_type type, const double wave[4], const double p[3], double middle) {
    switch (f) {
    case NOISE:
        return clamp(type, middle + random_between(-60, 60));
    case WAVES:
        return clamp(type,
                     middle + 50 * sin(wave[0] * p[0] + wave[3]) * cos(wave[1] * p[1]) + 12 * sin(wave[2] * p[2]));
    case SMALL:
        return random_below(4);
    case TIES:
        return clamp(type, middle + (double)random_below(3) - 1);
    default:
        return extreme_value(type);
    }
}

static void place_in_index(const subject *s, int64_t n, double p[3]) {
    const int64_t *d = s->grid.dims;
    for (int axis = 0; axis < 3 && !kind_is_structured(s->kind); axis++) p[axis] = (double)s->list.points[3 * n + axis];
    if (kind_is_structured(s->kind))
        p[0] = (double)(n % d[0]), p[1] = (double)(n / d[0] % d[1]), p[2] = (double)(n / d[0] / d[1]);
}

/* Samples, and an isovalue among them that many may equal. */
static void samples_fill(subject *s) {
    const field_kind f = (field_kind)random_below(FIELD_KINDS);
    const double lowest = fmax(type_least(s->type), -1000), highest = fmin(type_most(s->type), 1000);
    const double middle = floor(random_between(0.75 * lowest + 0.25 * highest, 0.25 * lowest + 0.75 * highest));
    double wave[4], p[3];
    for (int n = 0; n < 4; n++) wave[n] = random_between(0.1, 1.5);
    for (int64_t n = 0; n < s->sample_count; n++) {
        place_in_index(s, n, p);
        sample_set(s->samples, s->type, n, field_value(f, s->type, wave, p, middle));
    }
    const double one = sample_get(s->samples, s->type, random_below((uint32_t)s->sample_count));
    const double isovalues[] = {middle, middle + random_between(-20, 20), one, floor(one) + 0.5};
    s->how.isovalue = f == TIES ? middle : isovalues[random_below(4)];
    if (f == SMALL) s->how.isovalue = 0.5 * (1 + random_below(6));
    if (f == EXTREMES) s->how.isovalue = one;
}

/* Samples that are not finite, where the type has such. */
static void samples_spoil(subject *s) {
    static const double not_finite[] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    const uint32_t rarity = 2 + random_below(30);
    for (int64_t n = 0; n < s->sample_count; n++)
        if (random_below(rarity) == 0) sample_set(s->samples, s->type, n, not_finite[random_below(3)]);
}

/* ------------------------------------------------------------------------------------------------- structured grids */

static void dims_choose(int64_t dims[3]) {
    static const int64_t ends[3][4] = {{63, 64, 65, 66}, {7, 8, 9, 17}, {4, 5, 8, 9}};
    const uint32_t most = random_below(4) ? 4 : 6;
    for (int axis = 0; axis < 3; axis++) dims[axis] = 2 + random_below(most - 1);
    if (random_below(24)) return;
    const uint32_t axis = random_below(3);
    dims[axis] = ends[axis][random_below(4)];
}

static void matrix_choose(subject *s) {
    double(*m)[4] = s->grid.matrix;
    const unsigned shape = random_below(4);
    if (shape == 0) return;
    for (int r = 0; r < 3; r++) {
        m[r][r] = random_between(0.3, 3);
        if (random_below(2)) m[r][r] = -m[r][r], s->mirrored = !s->mirrored;
        for (int c = 0; c < 3; c++)
            if (c != r && shape == 3) m[r][c] = random_between(-0.1, 0.1);
        m[r][3] = random_between(-100, 100);
    }
}

static void axes_choose(subject *s) {
    for (int axis = 0; axis < 3; axis++) {
        const bool falling = random_below(2);
        double at = random_between(-50, 50);
        s->mirrored ^= falling;
        for (int64_t n = 0; n < s->grid.dims[axis]; n++)
            s->axes[axis][n] = (float)(at += (falling ? -1 : 1) * random_between(0.05, 2));
        s->grid.axes[axis] = s->axes[axis];
    }
}

/* Every point moved by less than makes a tetrahedron flat; where there are many cubes, a few by more. */
static void points_choose(subject *s) {
    const int64_t *d = s->grid.dims;
    const double noise = random_below(4) ? 0.1 : 0, size = random_between(0.4, 2);
    s->mirrored = random_below(2);
    s->folded = random_below(6) == 0 && (d[0] - 1) * (d[1] - 1) * (d[2] - 1) >= 27;
    for (int64_t n = 0; n < s->sample_count; n++) {
        double p[3];
        place_in_index(s, n, p);
        for (int axis = 0; axis < 3; axis++) p[axis] += random_between(-noise, noise);
        s->points[3 * n] = (float)(size * (1.2 * p[0] + 0.3 * p[1]));
        s->points[3 * n + 1] = (float)(size * (p[1] - 0.2 * p[2]) - 7);
        s->points[3 * n + 2] = (float)(s->mirrored ? 20 - p[2] : p[2] + 0.1 * p[0]);
    }
    for (int n = 0; n < 2 && s->folded; n++) {
        float *p = s->points + 3 * random_below((uint32_t)s->sample_count);
        for (int axis = 0; axis < 3; axis++) p[axis] += (float)(random_between(-1, 1) * fmin(size, 1));
    }
    s->grid.points = s->points;
}

static void blanks_choose(subject *s) {
    const unsigned which = 1 + random_below(7);
    const uint32_t rarity = 4 + random_below(40);
    const int64_t *d = s->grid.dims, cubes = (d[0] - 1) * (d[1] - 1) * (d[2] - 1);
    if (type_is_floating(s->type) && random_below(2)) samples_spoil(s);
    if (which & 1) {
        s->grid.has_nodata = 1;
        s->grid.nodata = sample_get(s->samples, s->type, random_below((uint32_t)s->sample_count));
        if (!isfinite(s->grid.nodata)) s->grid.nodata = 3;
    }
    for (int64_t n = 0; n < s->sample_count && (which & 2); n++) {
        s->blanked_samples[n] = random_below(rarity) ? 0 : (uint8_t)(1 + random_below(255));
        if (s->blanked_samples[n] && s->grid.points)
            s->points[3 * n + random_below(3)] = random_below(2) ? NAN : INFINITY;
    }
    for (int64_t n = 0; n < cubes; n++) s->blanked_cells[n] = random_below(rarity) ? 0 : 128;
    if (which & 2) s->grid.blanked_samples = s->blanked_samples;
    if (which & 4) s->grid.blanked_cells = s->blanked_cells;
    s->complete = false;
}

static void structured_make(subject *s) {
    kind coordinates = s->kind;
    if (s->kind == MISSING || s->kind == HYBRID) coordinates = (kind)random_below(3);
    dims_choose(s->grid.dims);
    s->sample_count = s->grid.dims[0] * s->grid.dims[1] * s->grid.dims[2];
    for (int axis = 0; axis < 3; axis++)
        if (random_below(3) == 0) s->grid.first_index[axis] = (int64_t)random_below(2001) - 1000;
    if (coordinates == UNIFORM) matrix_choose(s);
    if (coordinates == RECTILINEAR) axes_choose(s);
    if (coordinates == CURVILINEAR) points_choose(s);
    samples_fill(s);
    const bool blanked = s->kind == MISSING || (s->kind == HYBRID && random_below(3) == 0);
    if (blanked) blanks_choose(s);
    if (s->kind == HYBRID) s->how.method = TC_METHOD_HYBRID;
    s->how.normals = s->kind != HYBRID && (blanked || coordinates != UNIFORM);
}

/* -------------------------------------------------------------------------------------------------------- complexes */

static void kuhn_add(cell_list *list, const uint32_t cube[8]) {
    for (unsigned n = 0; n < 6; n++) { /* the ways from corner 0 to corner 7, an axis after the other */
        const unsigned first = n % 3, second = (first + 1 + n / 3) % 3;
        const uint32_t p[4] = {cube[0], cube[1u << first], cube[1u << first | 1u << second], cube[7]};
        /* those that take the axes in turn have positive volume */
        cell_list_add(list, 10, 4, p, (n / 3 == 1) ^ random_below(2));
    }
}

static void hexahedron_add(cell_list *list, const uint32_t cube[8]) {
    const uint32_t h[8] = {cube[0], cube[1], cube[3], cube[2], cube[4], cube[5], cube[7], cube[6]};
    const bool voxel = random_below(2);
    cell_list_add(list, voxel ? 11 : 12, 8, voxel ? cube : h, random_below(2));
}

/* A block of cubes whose points are numbered at random. */
static cell_list block_make(kind k, const uint32_t size[3]) {
    const uint32_t nx = size[0] + 1, ny = size[1] + 1, count = nx * ny * (size[2] + 1);
    cell_list list = cell_list_make(count, 6 * size[0] * size[1] * size[2]);
    uint32_t numbers[SUBJECT_SAMPLES] = {0}, cube[8];
    for (uint32_t n = 0; n < count; n++) numbers[n] = n;
    for (uint32_t n = count - 1; n > 0; n--) {
        const uint32_t m = random_below(n + 1), number = numbers[n];
        numbers[n] = numbers[m], numbers[m] = number;
    }
    for (uint32_t n = 0; n < count; n++) {
        float *p = list.points + 3 * numbers[n];
        p[0] = (float)(n % nx), p[1] = (float)(n / nx % ny), p[2] = (float)(n / nx / ny);
    }
    list.point_count = count;
    for (uint32_t n = 0; n < size[0] * size[1] * size[2]; n++) {
        const uint32_t x = n % size[0], y = n / size[0] % size[1], z = n / size[0] / size[1];
        for (uint32_t c = 0; c < 8; c++) cube[c] = numbers[((z + (c >> 2)) * ny + y + (c >> 1 & 1)) * nx + x + (c & 1)];
        k == TETRAHEDRA ? kuhn_add(&list, cube) : hexahedron_add(&list, cube);
    }
    return list;
}

/* Inner points by a little, then all of them by a map that may mirror. */
static void points_move(subject *s, const uint32_t size[3]) {
    const double noise = random_below(4) ? 0.04 : 0, scale = random_between(0.4, 2), turned = random_below(2) ? -1 : 1;
    for (uint64_t n = 0; n < s->list.point_count; n++) {
        float *p = s->list.points + 3 * n;
        bool inner = true;
        for (int axis = 0; axis < 3; axis++) inner = inner && p[axis] > 0 && p[axis] < (float)size[axis];
        for (int axis = 0; axis < 3 && inner; axis++) p[axis] += (float)random_between(-noise, noise);
        p[0] = (float)(turned * scale * ((double)p[0] + 0.3 * (double)p[1]) + 5);
        p[1] = (float)(scale * (double)p[1] - 11);
    }
    s->volume = 6 * scale * scale * size[0] * size[1] * size[2];
    s->boundary_faces = 4ull * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]);
}

static void cells_cut(subject *s, const tc_cells *cells) {
    if (tc_tetrahedralize(cells, &s->complex)) printf("cells are not cut: %s\n", tc_message());
    tc_tetrahedra_grid_options_init(&s->cells);
    s->cells.point_count = s->list.point_count, s->cells.points = s->list.points;
    s->cells.type = s->type, s->cells.samples = s->samples;
    s->cells.tetrahedron_count = s->complex.tetrahedron_count, s->cells.tetrahedra = s->complex.tetrahedra;
}

static uint64_t left_out_count(const tc_cells *cells) {
    uint64_t count = 0;
    for (uint64_t cell = 0; cell < cells->cell_count; cell++) {
        bool is_out = cells->blanked_cells && cells->blanked_cells[cell];
        for (int64_t n = cells->offsets[cell]; n < cells->offsets[cell + 1] && cells->blanked_points; n++)
            is_out = is_out || cells->blanked_points[cells->connectivity[n]];
        count += is_out;
    }
    return count;
}

static void complex_make(subject *s) {
    uint32_t size[3];
    for (int axis = 0; axis < 3; axis++) size[axis] = 1 + random_below(3);
    if (s->kind == MIXED) size[1] = size[2] = size[0] = 1 + random_below(2) + random_below(2) / 2;
    s->list = s->kind == MIXED ? mixed_block_make(size[0], random_u64()) : block_make(s->kind, size);
    points_move(s, size);
    s->sample_count = (int64_t)s->list.point_count;
    samples_fill(s);
    tc_cells cells = cell_list_view(&s->list);
    const unsigned which = random_below(4) ? 0 : 1 + random_below(3);
    for (int64_t n = 0; n < s->sample_count; n++) s->blanked_samples[n] = random_below(12) == 0;
    for (uint64_t n = 0; n < cells.cell_count; n++) s->blanked_cells[n] = random_below(6) == 0;
    if (which & 1) cells.blanked_points = s->blanked_samples;
    if (which & 2) cells.blanked_cells = s->blanked_cells;
    s->blanked_points = cells.blanked_points;
    s->left_out_count = left_out_count(&cells);
    s->complete = which == 0;
    if (type_is_floating(s->type) && random_below(6) == 0) samples_spoil(s), s->complete = false;
    cells_cut(s, &cells);
}

void subject_cut(subject *s) {
    const tc_cells cells = cell_list_view(&s->list);
    cells_cut(s, &cells);
}

/* ------------------------------------------------------------------------------------------------------------ whole */

static void subject_begin(subject *s, kind k, tc_type type) {
    s->kind = k, s->type = type;
    s->complete = true, s->mirrored = s->folded = false;
    s->list = (cell_list){0};
    s->blanked_points = NULL, s->left_out_count = 0;
    s->complex = (tc_tetrahedra){.struct_size = sizeof s->complex};
    tc_extract_options_init(&s->how);
    tc_grid_options_init(&s->grid);
    s->grid.type = type;
    s->grid.samples = s->samples;
}

void subject_make(subject *s, kind k, tc_type type, uint64_t seed) {
    random_state = (seed * KINDS + k) * 8 + type;
    random_state = random_u64();
    subject_begin(s, k, type);
    kind_is_structured(k) ? structured_make(s) : complex_make(s);
}

void subject_make_plain(subject *s, kind k, const int64_t dims[3]) {
    subject_begin(s, k, TC_U8);
    memcpy(s->grid.dims, dims, sizeof s->grid.dims);
    s->sample_count = dims[0] * dims[1] * dims[2];
    memset(s->samples, 0, (size_t)s->sample_count);
    s->how.isovalue = 1;
    s->how.method = k == HYBRID ? TC_METHOD_HYBRID : TC_METHOD_TETRA;
}

void subject_free(subject *s) {
    tc_tetrahedra_release(&s->complex);
    cell_list_free(&s->list);
}

bool subject_has(const subject *s, int64_t sample) {
    const double value = sample_get(s->samples, s->type, sample);
    if (!isfinite(value)) return false;
    if (!kind_is_structured(s->kind)) return true;
    return !(s->grid.has_nodata && value == s->grid.nodata) &&
           !(s->grid.blanked_samples && s->grid.blanked_samples[sample]);
}

void subject_place(const subject *s, int64_t sample, double out[3]) {
    const float *points = kind_is_structured(s->kind) ? s->grid.points : s->list.points;
    double p[3];
    place_in_index(s, sample, p);
    for (int row = 0; row < 3; row++) {
        const double *m = s->grid.matrix[row];
        if (points) {
            out[row] = (double)points[3 * sample + row];
        } else if (s->grid.axes[0]) {
            out[row] = (double)s->grid.axes[row][(int64_t)p[row]];
        } else {
            out[row] = m[3];
            for (int axis = 0; axis < 3; axis++) out[row] += m[axis] * (p[axis] + (double)s->grid.first_index[axis]);
        }
    }
}

tc_status subject_extract(const subject *s, tc_context *context, tc_mesh **mesh, tc_mesh_data *data) {
    tc_grid *grid = NULL;
    *data = (tc_mesh_data){.struct_size = sizeof *data};
    tc_status status = kind_is_structured(s->kind) ? tc_grid_create(context, &s->grid, &grid)
                                                   : tc_tetrahedra_grid_create(context, &s->cells, &grid);
    if (!status) status = tc_extract(grid, &s->how, mesh);
    if (!status) status = tc_mesh_get(*mesh, data);
    tc_grid_destroy(grid);
    return status;
}
