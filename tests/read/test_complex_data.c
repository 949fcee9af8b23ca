/*
 * test_complex_data.c - published unstructured grids as tetrahedral complexes: neighbours agree on every face
 *
 * The border of the complex has to be that of the cells, whose faces are listed here by themselves: a triangle for
 * every triangular face that one cell has alone, two for every quadrilateral one; and no face has three tetrahedra.
 *
 * The files are found through the environment variable TETRACUBES_DATA; where it is unset, this test says so and skips
 * (status 77).
 */
#include "complex.h"
#include "read.h"
#include "expect.h"
#include "failure.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SKIPPED = 77, FACES_MOST = 6, NONE = -1 };

/* Corners of the faces of a type of cells, in VTK's numbering; NONE: a triangle. */
typedef struct cell_faces {
    uint8_t type;
    int count;
    int corners[FACES_MOST][4];
} cell_faces;

static const cell_faces faces_of_types[] = {
    {10, 4, {{0, 1, 3, NONE}, {1, 2, 3, NONE}, {2, 0, 3, NONE}, {0, 2, 1, NONE}}},
    {11, 6, {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}},
    {12, 6, {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}},
    {13, 5, {{0, 1, 2, NONE}, {3, 5, 4, NONE}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}},
    {14, 5, {{0, 3, 2, 1}, {0, 1, 4, NONE}, {1, 2, 4, NONE}, {2, 3, 4, NONE}, {3, 0, 4, NONE}}},
};

/* Points in ascending order, a triangle's first one -1. */
typedef struct face {
    int64_t points[4];
} face;

static int point_compare(const void *a, const void *b) {
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

static int face_compare(const void *a, const void *b) {
    for (int n = 0; n < 4; n++) {
        int order = point_compare(&((const face *)a)->points[n], &((const face *)b)->points[n]);
        if (order) return order;
    }
    return 0;
}

/* How many triangles the faces make that one cell has alone. */
static uint64_t border_triangles(const dataset_block *b) {
    face *faces = calloc((size_t)b->cell_count * FACES_MOST + 1, sizeof *faces);
    size_t count = 0;
    uint64_t triangles = 0;
    for (int64_t cell = 0; cell < b->cell_count && faces; cell++)
        for (size_t t = 0; t < sizeof faces_of_types / sizeof *faces_of_types; t++)
            for (int f = 0; b->cell_types[cell] == faces_of_types[t].type && f < faces_of_types[t].count; f++) {
                for (int n = 0; n < 4; n++) {
                    int corner = faces_of_types[t].corners[f][n];
                    faces[count].points[n] = corner < 0 ? -1 : b->cell_points[b->cell_offsets[cell] + corner];
                }
                qsort(faces[count++].points, 4, sizeof(int64_t), point_compare);
            }
    if (faces) qsort(faces, count, sizeof *faces, face_compare);
    for (size_t n = 0, same; n < count; n += same) {
        for (same = 1; n + same < count && !face_compare(&faces[n], &faces[n + same]);) same++;
        if (same == 1) triangles += faces[n].points[0] < 0 ? 1 : 2;
    }
    free(faces);
    return triangles;
}

static void test_file(const char *folder, const char *name) {
    char path[1024];
    dataset d;
    read_request request;
    tc_tetrahedra complex = {.struct_size = sizeof complex};
    snprintf(path, sizeof path, "%s/unstructured/%s", folder, name);
    read_request_init(&request, path);
    int status = dataset_read(&request, &d);
    EXPECT(!status, "%s: %s", name, failure_text());
    if (status) return;
    const dataset_block *b = d.blocks;
    const tc_cells cells = {.struct_size = sizeof cells,
                            .point_count = (uint64_t)b->point_count,
                            .points = b->points.f32,
                            .points_f64 = b->points.f64,
                            .cell_count = (uint64_t)b->cell_count,
                            .types = b->cell_types,
                            .offsets = b->cell_offsets,
                            .connectivity = b->cell_points};
    tc_status cut = tc_tetrahedralize(&cells, &complex);
    EXPECT(!cut && complex.tetrahedron_count, "%s: %s", name, tc_message());
    if (!cut) {
        float *points = malloc(3 * (size_t)b->point_count * sizeof *points);
        if (!points) exit(EXIT_FAILURE);
        for (int64_t i = 0; i < 3 * b->point_count; i++) points[i] = (float)coordinate_at(b->points, i);
        complex_facts facts = complex_facts_of(&complex, points, (uint64_t)b->point_count);
        free(points);
        uint64_t border = border_triangles(b);
        EXPECT(!facts.bad_faces && !facts.bad_tetrahedra, "%s: %llu faces do not fit, %llu tetrahedra are not valid",
               name, (unsigned long long)facts.bad_faces, (unsigned long long)facts.bad_tetrahedra);
        EXPECT(facts.boundary_faces == border, "%s: %llu triangles on the border, of the cells' faces %llu", name,
               (unsigned long long)facts.boundary_faces, (unsigned long long)border);
    }
    tc_tetrahedra_release(&complex);
    dataset_release(&d);
}

int main(void) {
    static const char *const names[] = {"CylinderLinear.vtk",     "hexa.vtk",      "fire_ug.vtu",
                                        "notch_stress_fixed.vtk", "uGridEx.vtk",   "fichera-mixed.vtu",
                                        "fichera-mixed-16.vtu",   "tetraMesh.vtk", "pyramid_ug.vtu"};
    const char *folder = getenv("TETRACUBES_DATA");
    if (!folder || !*folder) {
        printf("TETRACUBES_DATA is not set: published files are skipped\n");
        return SKIPPED;
    }
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) test_file(folder, names[n]);
    return EXPECT_DONE();
}
