/*
 * vtk_legacy_files.h - what the tests of VTK legacy files share: bytes read as a file, fields compared value by value,
 * and what has to hold however a file is damaged
 *
 * Run under sanitizers, read_bytes also shows that no byte behind a file is touched: it lies in memory of its exact
 * size.
 */
#ifndef VTK_LEGACY_FILES_H
#define VTK_LEGACY_FILES_H

#include "read_files.h"

#include "random.h"
#include "vtk_legacy/vtk_legacy.h"

#define HEAD    "# vtk DataFile Version 3.0\nt\nASCII\n"
#define BINARY  "# vtk DataFile Version 4.2\nt\nBINARY\n"
#define IMAGE   HEAD "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 1\n"
#define IMAGE_B BINARY "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 1\n"
#define LAST    "SCALARS last int\nLOOKUP_TABLE default\n"

#define CURVED(version, blanking)                                                                                      \
    "# vtk DataFile Version " version "\nt\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 4 1 1\n" blanking               \
    "POINTS 4 float\n0 0 0 1 0 0 2 0 0 3 0 0\n"

#define UNSTRUCTURED(points) "# vtk DataFile Version 5.1\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " points

enum { FLIPS = 1000 };

static inline double field_value(const dataset_field *f, int64_t i) {
    return value_at(f->type, f->values, (uint64_t)i);
}

static inline int64_t value_count(const dataset_block *b, const dataset_field *f) {
    return (f->on_cells ? b->cell_count : b->point_count) * f->components;
}

/* Reads the bytes as the file `path`. */
static inline int read_bytes(const char *path, const unsigned char *data, size_t size, dataset *out) {
    unsigned char *exact = malloc(size + !size);
    memcpy(exact, data, size);
    read_request r = request_for(path);
    mapping m = {.bytes = exact, .size = size};
    *out = (dataset){0};
    fail(0, "(no text)");
    int status = vtk_legacy_read(&r, &m, out);
    if (status) dataset_release(out);
    free(exact);
    return status;
}

static inline int read_path(const char *path, dataset *out) {
    read_request r = request_for(path);
    mapping m;
    *out = (dataset){0};
    int status = mapping_open(path, &m);
    if (!status && (status = vtk_legacy_read(&r, &m, out))) dataset_release(out);
    mapping_close(&m);
    return status;
}

static inline const dataset_field *find_field(const dataset *d, const char *name, int on_cells) {
    const dataset_block *b = d->blocks;
    for (int i = 0; i < b->field_count; i++)
        if (b->fields[i].on_cells == on_cells && !strcmp(b->fields[i].name, name)) return &b->fields[i];
    return NULL;
}

static inline void expect_field(const char *what, const dataset *d, const char *name, int on_cells, int type,
                                int components, const double *values) {
    const dataset_field *f = find_field(d, name, on_cells);
    EXPECT(f, "%s: no field '%s'", what, name);
    if (!f) return;
    EXPECT((int)f->type == type && f->components == components, "%s: '%s' has type %d and %d components", what, name,
           (int)f->type, f->components);
    if ((int)f->type != type || f->components != components) return;
    for (int64_t i = 0; i < value_count(d->blocks, f); i++)
        EXPECT(field_value(f, i) == values[i], "%s: '%s'[%" PRId64 "] is %g, not %g", what, name, i, field_value(f, i),
               values[i]);
}

/* Whatever was read can be read to its end. */
static inline void touch(const dataset *d) {
    volatile double sum = 0;
    const dataset_block *b = d->blocks;
    for (int f = 0; f < b->field_count; f++)
        for (int64_t i = 0; i < value_count(b, &b->fields[f]); i++) sum = sum + field_value(&b->fields[f], i);
    for (int64_t i = 0; (b->points.f32 || b->points.f64) && i < 3 * b->point_count; i++)
        sum = sum + coordinate_at(b->points, i);
    for (int a = 0; a < 3; a++)
        for (int64_t i = 0; (b->axes[a].f32 || b->axes[a].f64) && i < b->dims[a]; i++)
            sum = sum + coordinate_at(b->axes[a], i);
    for (int64_t i = 0; b->blanked_points && i < b->point_count; i++) sum = sum + b->blanked_points[i];
    for (int64_t i = 0; b->blanked_cells && i < b->cell_count; i++) sum = sum + b->blanked_cells[i];
    for (int64_t c = 0; b->cell_offsets && c < b->cell_count; c++)
        for (int64_t i = b->cell_offsets[c]; i < b->cell_offsets[c + 1]; i++)
            EXPECT(b->cell_points[i] >= 0 && b->cell_points[i] < b->point_count, "cell %d has point %d", (int)c,
                   (int)b->cell_points[i]);
    for (int64_t i = 0; b->cell_faces && i < b->face_offsets[b->cell_faces[b->cell_count]]; i++)
        EXPECT(b->face_points[i] >= 0 && b->face_points[i] < b->point_count, "a face has point %d",
               (int)b->face_points[i]);
}

static inline void expect_survives(const char *what, const unsigned char *data, size_t size) {
    dataset d;
    int status = read_bytes("damaged.vtk", data, size, &d);
    if (status) {
        EXPECT(status == STATUS_INPUT && strstr(failure_text(), "damaged.vtk: "), "%s: status %d: %s", what, status,
               failure_text());
        return;
    }
    touch(&d);
    dataset_release(&d);
}

/* Cut at every byte, and with some bytes changed at random: an error that names the file, or a grid to be read. */
static inline void test_damage(const char *what, const bytes *b) {
    for (size_t size = 0; size < b->size; size++) expect_survives(what, b->data, size);
    unsigned char *copy = malloc(b->size);
    for (int i = 0; i < FLIPS; i++) {
        memcpy(copy, b->data, b->size);
        for (uint32_t flips = random_below(4) + 1; flips; flips--)
            copy[random_below((uint32_t)b->size)] = (unsigned char)"0197 \n-.e%"[random_below(10)];
        expect_survives(what, copy, b->size);
    }
    free(copy);
}

#endif
