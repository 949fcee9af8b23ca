#include "complex.h"

#include "random.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
                       .connectivity = memory_get(8 * 8 * cells)};
}

void cell_list_free(cell_list *list) {
    free(list->points);
    free(list->types);
    free(list->offsets);
    free(list->connectivity);
    *list = (cell_list){0};
}

tc_cells cell_list_view(const cell_list *list) {
    return (tc_cells){.struct_size = sizeof(tc_cells),
                      .point_count = list->point_count,
                      .points = list->points,
                      .cell_count = list->cell_count,
                      .types = list->types,
                      .offsets = list->offsets,
                      .connectivity = list->connectivity};
}

uint32_t cell_list_point(cell_list *list, double x, double y, double z) {
    float *p = list->points + 3 * list->point_count;
    p[0] = (float)x, p[1] = (float)y, p[2] = (float)z;
    return (uint32_t)list->point_count++;
}

void cell_list_add(cell_list *list, int type, int corner_count, const uint32_t *corners, bool inverted) {
    static const uint8_t turned[15][8] = {[10] = {0, 2, 1, 3},
                                          [11] = {4, 5, 6, 7, 0, 1, 2, 3},
                                          [12] = {4, 5, 6, 7, 0, 1, 2, 3},
                                          [13] = {3, 4, 5, 0, 1, 2},
                                          [14] = {0, 3, 2, 1, 4}};
    int64_t *out = list->connectivity + list->offsets[list->cell_count];
    for (int n = 0; n < corner_count; n++) out[n] = corners[inverted ? turned[type][n] : n];
    list->inverted_count += inverted;
    list->types[list->cell_count++] = (uint8_t)type;
    list->offsets[list->cell_count] = list->offsets[list->cell_count - 1] + corner_count;
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
    tc_complex complex = {.struct_size = sizeof complex};
    if (tc_tetrahedralize(&one, &complex)) printf("a hexahedron is not cut: %s\n", tc_message());
    for (uint64_t n = 0; n < complex.tetrahedron_count; n++)
        cell_list_add(list, 10, 4, complex.tetrahedra + 4 * n, random_below(2));
    tc_complex_release(&complex);
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

complex_facts complex_facts_of(const tc_complex *complex, const float *points, uint64_t point_count) {
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
