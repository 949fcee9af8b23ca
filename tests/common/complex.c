#include "complex.h"

#include "random.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Faces of a polyhedron here, and their corners together. */
enum { FACES_MOST = 14, CORNERS_MOST = 72 };

static void *memory_get(uint64_t bytes) {
    void *memory = calloc((size_t)bytes + 1, 1);
    if (memory) return memory;
    printf("no memory\n");
    exit(EXIT_FAILURE);
}

cell_list cell_list_make(uint64_t points, uint64_t cells) {
    return (cell_list){.points = memory_get(12 * points),
                       .types = memory_get(cells),
                       .offsets = memory_get(8 * (cells + 1)),
                       .connectivity = memory_get(8 * 12 * cells),
                       .cell_faces = memory_get(8 * (cells + 1)),
                       .face_offsets = memory_get(8 * (FACES_MOST * cells + 1)),
                       .face_connectivity = memory_get(8 * CORNERS_MOST * cells)};
}

void cell_list_free(cell_list *list) {
    free(list->points);
    free(list->types);
    free(list->offsets);
    free(list->connectivity);
    free(list->cell_faces);
    free(list->face_offsets);
    free(list->face_connectivity);
    *list = (cell_list){0};
}

tc_cells cell_list_view(const cell_list *list) {
    return (tc_cells){.struct_size = sizeof(tc_cells),
                      .point_count = list->point_count,
                      .points = list->points,
                      .cell_count = list->cell_count,
                      .types = list->types,
                      .offsets = list->offsets,
                      .connectivity = list->connectivity,
                      .cell_faces = list->cell_faces,
                      .face_offsets = list->face_offsets,
                      .face_connectivity = list->face_connectivity};
}

uint32_t cell_list_point(cell_list *list, double x, double y, double z) {
    float *p = list->points + 3 * list->point_count;
    p[0] = (float)x, p[1] = (float)y, p[2] = (float)z;
    return (uint32_t)list->point_count++;
}

void cell_list_add(cell_list *list, int type, int corner_count, const uint32_t *corners, bool inverted) {
    static const uint8_t turned[17][12] = {[10] = {0, 2, 1, 3},
                                           [11] = {4, 5, 6, 7, 0, 1, 2, 3},
                                           [12] = {4, 5, 6, 7, 0, 1, 2, 3},
                                           [13] = {3, 4, 5, 0, 1, 2},
                                           [14] = {0, 3, 2, 1, 4},
                                           [15] = {5, 6, 7, 8, 9, 0, 1, 2, 3, 4},
                                           [16] = {6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 4, 5}};
    int64_t *out = list->connectivity + list->offsets[list->cell_count];
    for (int n = 0; n < corner_count; n++) out[n] = corners[inverted ? turned[type][n] : n];
    list->inverted_count += inverted;
    list->types[list->cell_count++] = (uint8_t)type;
    list->offsets[list->cell_count] = list->offsets[list->cell_count - 1] + corner_count;
    list->cell_faces[list->cell_count] = list->cell_faces[list->cell_count - 1];
}

static void face_add(cell_list *list, int64_t face, int count, const uint32_t *points) {
    int64_t *out = list->face_connectivity + list->face_offsets[face];
    uint32_t first = random_below((uint32_t)count);
    bool reversed = random_below(2);
    for (uint32_t n = 0, side = (uint32_t)count; n < side; n++)
        out[n] = points[(first + (reversed ? side - n : n)) % side];
    list->face_offsets[face + 1] = list->face_offsets[face] + count;
}

void cell_list_add_polyhedron(cell_list *list, int face_count, const int *counts, const uint32_t *points) {
    const uint32_t *faces[FACES_MOST];
    int order[FACES_MOST];
    const int64_t first = list->cell_faces[list->cell_count];
    for (int n = 0; n < face_count; points += counts[n++]) faces[n] = points, order[n] = n;
    for (int n = 0; n < face_count; n++) {
        uint32_t m = (uint32_t)n + random_below((uint32_t)(face_count - n));
        int other = order[m];
        order[m] = order[n], order[n] = other;
        face_add(list, first + n, counts[other], faces[other]);
    }
    list->types[list->cell_count++] = 42;
    list->offsets[list->cell_count] = list->offsets[list->cell_count - 1];
    list->cell_faces[list->cell_count] = first + face_count;
}

void cell_list_renumber(cell_list *list) {
    const uint32_t count = (uint32_t)list->point_count;
    uint32_t *numbers = memory_get(4ull * count);
    float *points = memory_get(12ull * count);
    for (uint32_t n = 0; n < count; n++) numbers[n] = n;
    for (uint32_t n = count; n > 1; n--) {
        uint32_t m = random_below(n), number = numbers[n - 1];
        numbers[n - 1] = numbers[m], numbers[m] = number;
    }
    memcpy(points, list->points, 12ull * count);
    for (uint32_t n = 0; n < count; n++) memcpy(list->points + 3 * numbers[n], points + 3 * n, 12);
    for (int64_t n = 0; n < list->offsets[list->cell_count]; n++)
        list->connectivity[n] = numbers[list->connectivity[n]];
    for (int64_t n = 0; n < list->face_offsets[list->cell_faces[list->cell_count]]; n++)
        list->face_connectivity[n] = numbers[list->face_connectivity[n]];
    free(numbers);
    free(points);
}

cell_list hexahedra_make(const uint32_t sizes[3], bool renumbered) {
    const uint32_t nx = sizes[0] + 1, ny = sizes[1] + 1, nz = sizes[2] + 1, up = nx * ny;
    cell_list list = cell_list_make((uint64_t)up * nz, (uint64_t)sizes[0] * sizes[1] * sizes[2]);
    for (uint32_t p = 0; p < up * nz; p++) cell_list_point(&list, p % nx, p / nx % ny, p / up);
    for (uint32_t c = 0; c < sizes[0] * sizes[1] * sizes[2]; c++) {
        const uint32_t x = c % sizes[0], y = c / sizes[0] % sizes[1], z = c / sizes[0] / sizes[1];
        const uint32_t first = (z * ny + y) * nx + x;
        const uint32_t corners[8] = {first,      first + 1,      first + nx + 1,      first + nx,
                                     first + up, first + up + 1, first + up + nx + 1, first + up + nx};
        cell_list_add(&list, 12, 8, corners, renumbered && random_below(2));
    }
    if (renumbered) cell_list_renumber(&list);
    return list;
}

/* ----------------------------------------------------------------------------------------------------- mixed block */

static const uint8_t hexahedron_order[8] = {0, 1, 3, 2, 4, 5, 7, 6};

static void pyramids_add(cell_list *list, const uint32_t h[8]) {
    static const uint8_t bases[6][4] = {{0, 3, 7, 4}, {1, 5, 6, 2}, {0, 4, 5, 1},
                                        {3, 2, 6, 7}, {0, 1, 2, 3}, {4, 7, 6, 5}}; /* seen from inside */
    double middle[3] = {0};
    for (unsigned n = 0; n < 24; n++) middle[n % 3] += (double)list->points[3 * h[n / 3] + n % 3] / 8;
    uint32_t apex = cell_list_point(list, middle[0], middle[1], middle[2]);
    for (int n = 0; n < 6; n++) {
        uint32_t p[5] = {h[bases[n][0]], h[bases[n][1]], h[bases[n][2]], h[bases[n][3]], apex};
        cell_list_add(list, 14, 5, p, random_below(2));
    }
}

static void tetrahedra_add(cell_list *list, const uint32_t h[8]) {
    int64_t offsets[2] = {0, 8}, connectivity[8];
    uint8_t type = 12;
    for (int n = 0; n < 8; n++) connectivity[n] = h[n];
    tc_cells one = cell_list_view(list);
    one.cell_count = 1, one.types = &type, one.offsets = offsets, one.connectivity = connectivity;
    tc_tetrahedra complex = {.struct_size = sizeof complex};
    if (tc_tetrahedralize(&one, &complex)) printf("a hexahedron is not cut: %s\n", tc_message());
    for (uint64_t n = 0; n < complex.tetrahedron_count; n++)
        cell_list_add(list, 10, 4, complex.tetrahedra + 4 * n, random_below(2));
    tc_tetrahedra_release(&complex);
}

/* VTK's wedge has its first triangle counter-clockwise seen from outside. */
static void wedges_add(cell_list *list, const uint32_t h[8], bool diagonal) {
    static const uint8_t ends[2][2][3] = {{{0, 2, 1}, {0, 3, 2}}, {{0, 3, 1}, {1, 3, 2}}};
    for (int n = 0; n < 2; n++) {
        uint32_t p[6];
        for (int v = 0; v < 6; v++) p[v] = h[ends[diagonal][n][v % 3] + 4 * (v / 3)];
        cell_list_add(list, 13, 6, p, random_below(2));
    }
}

static void cube_add(cell_list *list, const uint32_t voxel[8], uint32_t column) {
    uint32_t h[8];
    for (int n = 0; n < 8; n++) h[n] = voxel[hexahedron_order[n]];
    if (column < 2) {
        wedges_add(list, h, column);
        return;
    }
    switch (random_below(4)) {
    case 0:
        cell_list_add(list, 12, 8, h, random_below(2));
        break;
    case 1:
        cell_list_add(list, 11, 8, voxel, random_below(2));
        break;
    case 2:
        pyramids_add(list, h);
        break;
    default:
        tetrahedra_add(list, h);
        break;
    }
}

cell_list mixed_block_make(uint32_t size, uint64_t seed) {
    random_state = seed;
    const uint32_t side = size + 1, count = side * side * side;
    cell_list list = cell_list_make(count + size * size * size, 6 * size * size * size);
    uint32_t *numbers = memory_get(4ull * count), *columns = memory_get(4 * size * size);
    for (uint32_t n = 0; n < count; n++) numbers[n] = n;
    for (uint32_t n = count - 1; n > 0; n--) {
        uint32_t m = random_below(n + 1), number = numbers[n];
        numbers[n] = numbers[m], numbers[m] = number;
    }
    for (uint32_t n = 0; n < count; n++) {
        float *p = list.points + 3 * numbers[n];
        p[0] = (float)(n % side), p[1] = (float)(n / side % side), p[2] = (float)(n / side / side);
    }
    list.point_count = count;
    for (uint32_t n = 0; n < size * size; n++) columns[n] = random_below(5);
    for (uint32_t n = 0; n < size * size * size; n++) {
        uint32_t x = n % size, y = n / size % size, z = n / size / size, voxel[8];
        for (uint32_t c = 0; c < 8; c++)
            voxel[c] = numbers[((z + (c >> 2)) * side + y + (c >> 1 & 1)) * side + x + (c & 1)];
        cube_add(&list, voxel, columns[n % (size * size)]);
    }
    free(numbers);
    free(columns);
    return list;
}

/* ------------------------------------------------------------------------------- truncated octahedra and honeycombs */

/* The point at x, y, z of a block of side^3 of them; made where it is not there yet. */
static uint32_t lattice_point(cell_list *list, uint32_t *made, int side, int x, int y, int z) {
    uint32_t *at = made + (z * side + y) * side + x;
    if (!*at) *at = cell_list_point(list, x, y, z) + 1;
    return *at - 1;
}

/* Corners are at the permutations of 0, +-1, +-2 around the centre: in a square (+-2, 0, 0) from the next to the next,
 * in a hexagon (+-1, +-1, +-1) by exchanging coordinates. */
static void kelvin_cell_add(cell_list *list, uint32_t *made, int side, const int centre[3]) {
    static const int square[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    static const int hexagon[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {2, 1, 0}, {2, 0, 1}, {1, 0, 2}};
    int counts[14];
    uint32_t points[72], *to = points;
    for (int n = 0; n < 6; n++) {
        for (int m = 0; m < 4; m++) {
            int p[3];
            p[n / 2] = centre[n / 2] + (n % 2 ? 2 : -2);
            p[(n / 2 + 1) % 3] = centre[(n / 2 + 1) % 3] + square[m][0];
            p[(n / 2 + 2) % 3] = centre[(n / 2 + 2) % 3] + square[m][1];
            *to++ = lattice_point(list, made, side, p[0], p[1], p[2]);
        }
        counts[n] = 4;
    }
    for (int n = 0; n < 8; n++) {
        for (int m = 0; m < 6; m++)
            *to++ = lattice_point(list, made, side, centre[0] + (n & 1 ? 1 : -1) * hexagon[m][0],
                                  centre[1] + (n & 2 ? 1 : -1) * hexagon[m][1],
                                  centre[2] + (n & 4 ? 1 : -1) * hexagon[m][2]);
        counts[6 + n] = 6;
    }
    cell_list_add_polyhedron(list, 14, counts, points);
}

cell_list kelvin_block_make(uint32_t size, uint64_t seed) {
    random_state = seed;
    const int side = 4 * (int)size + 3;
    const uint64_t volume = (4 * size + 3) * (4 * size + 3) * (4 * size + 3);
    const uint64_t count = 2ull * size * size * size;
    cell_list list = cell_list_make(24 * count, count);
    uint32_t *made = memory_get(4 * volume);
    for (uint32_t n = 0; n < count; n++) {
        uint32_t cube = n / 2;
        int centre[3] = {(int)(cube % size), (int)(cube / size % size), (int)(cube / size / size)};
        for (int axis = 0; axis < 3; axis++) centre[axis] = 4 * centre[axis] + 2 + 2 * (int)(n % 2);
        kelvin_cell_add(&list, made, side, centre);
    }
    free(made);
    cell_list_renumber(&list);
    return list;
}

static void hexagonal_polyhedron_add(cell_list *list, const uint32_t h[12]) {
    static const int counts[8] = {6, 6, 4, 4, 4, 4, 4, 4};
    uint32_t points[36];
    memcpy(points, h, 12 * sizeof *h);
    for (int n = 0; n < 6; n++) {
        uint32_t *side = points + 12 + 4 * n;
        side[0] = h[n], side[1] = h[(n + 1) % 6], side[2] = h[6 + (n + 1) % 6], side[3] = h[6 + n];
    }
    cell_list_add_polyhedron(list, 8, counts, points);
}

/* Corners 0 to 5 wind around the bottom, 6 to 11 around the top. */
static void hexagon_add(cell_list *list, const uint32_t h[12], uint32_t kind) {
    const uint32_t pentagon[10] = {h[0], h[1], h[2], h[3], h[4], h[6], h[7], h[8], h[9], h[10]},
                   wedge[6] = {h[0], h[5], h[4], h[6], h[11], h[10]},
                   halves[2][8] = {{h[0], h[1], h[2], h[3], h[6], h[7], h[8], h[9]},
                                   {h[0], h[3], h[4], h[5], h[6], h[9], h[10], h[11]}};
    if (kind == 0) {
        cell_list_add(list, 15, 10, pentagon, random_below(2));
        cell_list_add(list, 13, 6, wedge, random_below(2));
    } else if (kind == 1) {
        cell_list_add(list, 12, 8, halves[0], random_below(2));
        cell_list_add(list, 12, 8, halves[1], random_below(2));
    } else if (random_below(2)) {
        cell_list_add(list, 16, 12, h, random_below(2));
    } else {
        hexagonal_polyhedron_add(list, h);
    }
}

cell_list honeycomb_make(uint32_t size, uint64_t seed) {
    static const int around[6][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 0}, {-1, -1}, {0, -1}};
    random_state = seed;
    const int side = 3 * (int)size + 3;
    const uint64_t volume = (3 * size + 3) * (3 * size + 3) * (3 * size + 3);
    const uint64_t count = 2ull * size * size * size;
    cell_list list = cell_list_make(12 * count, count);
    uint32_t *made = memory_get(4 * volume);
    for (uint32_t column = 0; column < size * size; column++) {
        const int u = (int)(column % size), v = (int)(column / size);
        const uint32_t kind = random_below(4);
        for (int z = 0; z < (int)size; z++) {
            uint32_t h[12];
            for (int n = 0; n < 12; n++)
                h[n] = lattice_point(&list, made, side, 1 + 2 * u + v + around[n % 6][0],
                                     1 + u + 2 * v + around[n % 6][1], z + n / 6);
            hexagon_add(&list, h, kind);
        }
    }
    free(made);
    cell_list_renumber(&list);
    return list;
}

/* ----------------------------------------------------------------------------------------------------------- facts */

typedef struct face {
    uint32_t points[3]; /* rising */
    uint32_t direction; /* 1: an odd permutation of how its tetrahedron passes it */
} face;

static int face_compare(const void *a, const void *b) { return memcmp(a, b, sizeof((face *)0)->points); }

static face face_make(uint32_t a, uint32_t b, uint32_t c) {
    face f = {{a, b, c}, 0};
    for (int pass = 0; pass < 3; pass++) {
        uint32_t *p = f.points + pass % 2, low = p[0];
        if (p[0] > p[1]) p[0] = p[1], p[1] = low, f.direction ^= 1;
    }
    return f;
}

static double volume_of(const float *points, const uint32_t *t) {
    double e[3][3];
    for (unsigned n = 0; n < 9; n++)
        e[n / 3][n % 3] = (double)points[3 * t[n / 3 + 1] + n % 3] - points[3 * t[0] + n % 3];
    return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
           e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

static bool tetrahedron_bad(const uint32_t *t, uint64_t point_count) {
    for (int n = 0; n < 4; n++)
        for (int m = 0; m < n; m++)
            if (t[n] == t[m]) return true;
    return t[0] >= point_count || t[1] >= point_count || t[2] >= point_count || t[3] >= point_count;
}

complex_facts complex_facts_of(const tc_tetrahedra *complex, const float *points, uint64_t point_count) {
    complex_facts facts = {0};
    face *faces = memory_get(4 * complex->tetrahedron_count * sizeof *faces);
    uint64_t face_count = 0;
    for (uint64_t n = 0; n < complex->tetrahedron_count; n++) {
        const uint32_t *t = complex->tetrahedra + 4 * n;
        if (tetrahedron_bad(t, point_count)) {
            facts.bad_tetrahedra++;
            continue;
        }
        double volume = volume_of(points, t);
        facts.volume += volume;
        facts.not_positive += !(volume > 0);
        faces[face_count++] = face_make(t[1], t[2], t[3]);
        faces[face_count++] = face_make(t[0], t[3], t[2]);
        faces[face_count++] = face_make(t[0], t[1], t[3]);
        faces[face_count++] = face_make(t[0], t[2], t[1]);
    }
    qsort(faces, face_count, sizeof *faces, face_compare);
    for (uint64_t n = 0, same; n < face_count; n += same) {
        for (same = 1; n + same < face_count && !face_compare(&faces[n], &faces[n + same]);) same++;
        facts.boundary_faces += same == 1;
        facts.bad_faces += same > 2 || (same == 2 && faces[n].direction == faces[n + 1].direction);
    }
    free(faces);
    return facts;
}

void cell_list_collapse(cell_list *list) {
    static const int wedge[8] = {0, 1, 2, 2, 3, 4, 5, 5}, pyramid[8] = {0, 1, 2, 3, 4, 4, 4, 4};
    static const int tetrahedron[8] = {0, 1, 2, 2, 3, 3, 3, 3};
    int64_t *all = memory_get(64 * list->cell_count), *to = all, *starts = memory_get(8 * (list->cell_count + 1));
    for (uint64_t c = 0; c < list->cell_count; c++) {
        const int64_t *points = list->connectivity + list->offsets[c];
        const int type = list->types[c], corners = (int)(list->offsets[c + 1] - list->offsets[c]);
        const int *as = type == 13 ? wedge : type == 14 ? pyramid : type == 10 ? tetrahedron : NULL;
        if (random_below(2)) as = NULL;
        const int count = as ? 8 : corners;
        for (int n = 0; n < count; n++) to[n] = points[as ? as[n] : n];
        if (as) list->types[c] = 12;
        starts[c] = to - all;
        to += count;
    }
    starts[list->cell_count] = to - all;
    memcpy(list->offsets, starts, 8 * (list->cell_count + 1));
    free(starts);
    free(list->connectivity);
    list->connectivity = all;
}

void cell_list_drop_polyhedra(cell_list *list) {
    uint64_t kept = 0;
    int64_t end = 0;
    for (uint64_t c = 0; c < list->cell_count; c++) {
        if (list->types[c] == 42) continue;
        const int64_t first = list->offsets[c], count = list->offsets[c + 1] - first;
        memmove(list->connectivity + end, list->connectivity + first, (size_t)count * sizeof(int64_t));
        list->types[kept] = list->types[c];
        list->offsets[kept++] = end;
        end += count;
    }
    list->offsets[kept] = end;
    list->cell_count = kept;
}
