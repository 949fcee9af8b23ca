/*
 * test_dataset.c - from a dataset in memory to the samples that are contoured, and which reader takes a file
 *
 * Proves: fields found by name, choices that are open or wrong refused with what there is; components taken apart;
 * values of cells averaged as a sum over all cells at every point says, written out here the other way round (by point,
 * not by cell); missing values marked; images as datasets; unknown formats refused with what is read.
 */
#include "exit_status.h"
#include "expect.h"
#include "failure.h"
#include "field/average.h"
#include "field/select.h"
#include "folder.h"
#include "random.h"
#include "read.h"
#include "sample_types.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const read_request any_field = {.path = "f", .component = COMPONENT_OPEN};

/* ----------------------------------------------------------------------------------------------- datasets to try on */

static dataset_block *add_block(dataset *d, int64_t nx, int64_t ny, int64_t nz) {
    dataset_block *b;
    if (dataset_block_add(d, &b)) abort();
    b->kind = BLOCK_UNIFORM;
    b->dims[0] = nx, b->dims[1] = ny, b->dims[2] = nz;
    b->point_count = nx * ny * nz;
    b->cell_count = (nx - 1) * (ny - 1) * (nz - 1);
    return b;
}

/* The structured block as an unstructured one of hexahedra. */
static void make_unstructured(dataset *d, dataset_block *b) {
    uint8_t *types = dataset_allocate(d, (uint64_t)b->cell_count);
    int64_t *offsets = dataset_allocate(d, (uint64_t)(b->cell_count + 1) * 8);
    int64_t *points = dataset_allocate(d, (uint64_t)b->cell_count * 64);
    static const int order[8] = {0, 1, 3, 2, 4, 5, 7, 6};
    int64_t cell = 0, nx = b->dims[0], ny = b->dims[1];
    if (!types || !offsets || !points) abort();
    for (int64_t k = 0; k + 1 < b->dims[2]; k++)
        for (int64_t j = 0; j + 1 < ny; j++)
            for (int64_t i = 0; i + 1 < nx; i++, cell++) {
                types[cell] = 12;
                offsets[cell] = 8 * cell;
                for (int n = 0; n < 8; n++)
                    points[8 * cell + n] =
                        i + (order[n] & 1) + nx * (j + (order[n] >> 1 & 1) + ny * (k + (order[n] >> 2)));
            }
    offsets[cell] = 8 * cell;
    b->kind = BLOCK_UNSTRUCTURED;
    b->cell_types = types;
    b->cell_offsets = offsets;
    b->cell_points = points;
}

static void add_field(dataset_block *b, const char *name, int on_cells, int components, tc_type type,
                      const void *values) {
    dataset_field *f;
    if (dataset_field_add(b, &f)) abort();
    *f = (dataset_field){.name = name, .on_cells = on_cells, .components = components, .type = type, .values = values};
}

static void says(const char *text) { EXPECT(strstr(failure_text(), text), "'%s' is not in: %s", text, failure_text()); }

/* ---------------------------------------------------------------------------------------------------------- choices */

static const float eight[8] = {1, 2, 3, 4, 5, 6, 7, 8};
static const uint8_t triples[24] = {0, 10, 20, 1, 11, 21, 2, 12, 22, 3, 13, 23,
                                    4, 14, 24, 5, 15, 25, 6, 16, 26, 7, 17, 27};

static void the_only_field_is_taken(void) {
    dataset d = {0};
    scalar s;
    add_field(add_block(&d, 2, 2, 2), "density", 0, 1, TC_F32, eight);
    EXPECT(scalar_select(&d, &any_field, &s) == 0, "%s", failure_text());
    EXPECT(strcmp(s.name, "density") == 0 && s.component == -1 && !s.is_averaged, "another field");
    EXPECT(s.blocks[0].samples == eight && s.blocks[0].type == TC_F32, "samples are not used in place");
    EXPECT(!s.blocks[0].has_nodata && !s.blocks[0].blanked_points && !s.blocks[0].blanked_cells, "something missing");
    read_request named = any_field;
    named.field = "density";
    EXPECT(scalar_select(&d, &named, &s) == 0, "%s", failure_text());
    named.path = "the file";
    named.field = "Density";
    EXPECT(scalar_select(&d, &named, &s) == STATUS_USAGE, "a name in other letters is taken");
    says("the file");
    says("density (point)");
    dataset_release(&d);
}

static void open_choices_list_what_there_is(void) {
    dataset d = {0};
    scalar s;
    read_request request = any_field;
    dataset_block *b = add_block(&d, 2, 2, 2);
    EXPECT(scalar_select(&d, &any_field, &s) == STATUS_INPUT, "no field at all");
    says("no field");
    add_field(b, "density", 0, 1, TC_F32, eight);
    add_field(b, "colour", 0, 3, TC_U8, triples);
    add_field(b, "material", 1, 1, TC_F32, eight);
    EXPECT(scalar_select(&d, &any_field, &s) == STATUS_USAGE, "one of three fields is taken");
    says("density (point), colour (point, 3 components), material (cell)");
    says("--field");
    request.field = "colour";
    EXPECT(scalar_select(&d, &request, &s) == STATUS_USAGE, "one of three components is taken");
    says("--component");
    request.component = 3;
    EXPECT(scalar_select(&d, &request, &s) == STATUS_USAGE, "component 3 of 3 is there");
    for (request.component = 0; request.component < 3; request.component++) {
        EXPECT(scalar_select(&d, &request, &s) == 0, "%s", failure_text());
        EXPECT(s.component == request.component && s.blocks[0].type == TC_U8, "another component or type");
        for (int n = 0; n < 8; n++)
            EXPECT(((const uint8_t *)s.blocks[0].samples)[n] == 10 * request.component + n, "sample %d", n);
    }
    request = (read_request){.path = "f", .field = "density", .component = 1};
    EXPECT(scalar_select(&d, &request, &s) == STATUS_USAGE, "component 1 of 1 is there");
    dataset_release(&d);
}

static void long_lists_are_cut(void) {
    static char names[100][48];
    dataset d = {0};
    scalar s;
    dataset_block *b = add_block(&d, 2, 2, 2);
    for (int n = 0; n < 100; n++) {
        snprintf(names[n], sizeof names[n], "a field with a rather long name %d", n);
        add_field(b, names[n], 0, 1, TC_F32, eight);
    }
    EXPECT(scalar_select(&d, &any_field, &s) == STATUS_USAGE, "one of a hundred");
    says(", ...");
    dataset_release(&d);
}

static void every_block_must_have_the_field(void) {
    dataset d = {0};
    scalar s;
    point_field p;
    read_request request = any_field;
    dataset_block *b = add_block(&d, 2, 2, 2);
    add_field(b, "a", 0, 1, TC_F32, eight);
    add_field(b, "b", 0, 1, TC_F32, eight);
    b = add_block(&d, 2, 2, 2);
    add_field(b, "b", 1, 1, TC_F32, eight);
    add_field(b, "b", 0, 1, TC_F64, (const double[8]){8, 7, 6, 5, 4, 3, 2, 1});
    add_field(b, "c", 0, 1, TC_F32, eight);
    EXPECT(scalar_select(&d, &any_field, &s) == 0 && strcmp(s.name, "b") == 0, "b is not the only common one");
    EXPECT(s.blocks[1].type == TC_F64 && !s.is_averaged, "values of cells come before those of points");
    request.field = "a";
    EXPECT(scalar_select(&d, &request, &s) == STATUS_USAGE, "a is not in block 1");
    says("every block");
    request.field = "c";
    EXPECT(scalar_select(&d, &request, &s) == STATUS_USAGE, "c is not in block 0");
    EXPECT(point_field_select(&d, "f", "b", &p) == 0 && p.components == 1 && !p.is_averaged, "%s", failure_text());
    EXPECT(point_field_select(&d, "f", "a", &p) == STATUS_USAGE, "a is not in block 1");
    says("--carry");
    b->fields[1].components = 2;
    EXPECT(point_field_select(&d, "f", "b", &p) == STATUS_INPUT, "components differ");
    dataset_release(&d);
}

/* ---------------------------------------------------------------------------------------------------------- missing */

static void missing_values_are_marked(void) {
    static const float values[8] = {1, NAN, 3, -9, 5, 6, INFINITY, 8};
    static const uint8_t blanked[8] = {1};
    static const uint8_t with_nodata[8] = {1, 1, 0, 1, 0, 0, 1, 0}, without[8] = {1, 1, 0, 0, 0, 0, 1, 0};
    for (int nodata = 0; nodata < 2; nodata++) {
        dataset d = {0};
        scalar s;
        read_request request = {.path = "f", .component = COMPONENT_OPEN, .has_nodata = nodata, .nodata = -9};
        dataset_block *b = add_block(&d, 2, 2, 2);
        b->blanked_points = blanked;
        add_field(b, "v", 0, 1, TC_F32, values);
        EXPECT(scalar_select(&d, &request, &s) == 0, "%s", failure_text());
        EXPECT(s.blocks[0].blanked_points == blanked && s.blocks[0].has_nodata == nodata && s.blocks[0].nodata == -9,
               "a structured block's samples are the library's to compare");
        make_unstructured(&d, b);
        EXPECT(scalar_select(&d, &request, &s) == 0, "%s", failure_text());
        EXPECT(memcmp(s.blocks[0].blanked_points, nodata ? with_nodata : without, 8) == 0, "nodata %d: mask", nodata);
        b->fields[0].values = eight;
        EXPECT(scalar_select(&d, &request, &s) == 0, "%s", failure_text());
        EXPECT(s.blocks[0].blanked_points == blanked, "nothing is missing, and yet there is a mask");
        dataset_release(&d);
    }
}

static void missing_cells_are_left_out(void) {
    static const int16_t cells[2] = {-9, 7}; /* side by side */
    dataset d = {0};
    scalar s;
    read_request request = {.path = "f", .component = COMPONENT_OPEN, .has_nodata = 1, .nodata = -9};
    add_field(add_block(&d, 3, 2, 2), "v", 1, 1, TC_I16, cells);
    EXPECT(scalar_select(&d, &request, &s) == 0 && s.is_averaged, "%s", failure_text());
    EXPECT(s.blocks[0].blanked_cells && s.blocks[0].blanked_cells[0] && !s.blocks[0].blanked_cells[1], "cells' mask");
    EXPECT(s.blocks[0].type == TC_F32 && !s.blocks[0].has_nodata, "means are compared with nodata");
    for (int n = 0; n < 12; n++) {
        float mean = ((const float *)s.blocks[0].samples)[n];
        EXPECT(n % 3 == 0 ? isnan(mean) : mean == 7.0f, "point %d: %g", n, (double)mean);
    }
    dataset_release(&d);
}

static void flat_cells_do_not_count(void) {
    static const uint8_t types[2] = {10, 5}; /* a tetrahedron and a triangle */
    static const int64_t offsets[3] = {0, 4, 7}, points[7] = {0, 1, 2, 3, 1, 2, 4};
    static const float values[2] = {10, 20};
    dataset d = {0};
    dataset_block *b;
    point_field p;
    if (dataset_block_add(&d, &b)) abort();
    *b = (dataset_block){.kind = BLOCK_UNSTRUCTURED, .point_count = 5, .cell_count = 2};
    b->cell_types = types;
    b->cell_offsets = offsets;
    b->cell_points = points;
    add_field(b, "v", 1, 1, TC_F32, values);
    EXPECT(point_field_select(&d, "f", "v", &p) == 0 && p.is_averaged, "%s", failure_text());
    const float *mean = p.blocks[0].values;
    EXPECT(mean[1] == 10.0f && mean[2] == 10.0f, "a triangle's value counts: %g", (double)mean[1]);
    EXPECT(isnan(mean[4]), "a point of a triangle only: %g", (double)mean[4]);
    dataset_release(&d);
}

/* ---------------------------------------------------------------------------------------------------------- average */

enum { MOST = 6, COMPONENTS = 3 };

typedef struct trial {
    int64_t dims[3];
    tc_type type;
    int components;
    double values[MOST * MOST * MOST * COMPONENTS];
    uint8_t blanked_cells[MOST * MOST * MOST], blanked_points[MOST * MOST * MOST];
} trial;

static int cell_is_present(const trial *t, int64_t i, int64_t j, int64_t k) {
    const int64_t *n = t->dims;
    int64_t cell = i + (n[0] - 1) * (j + (n[1] - 1) * k);
    if (i < 0 || j < 0 || k < 0 || i > n[0] - 2 || j > n[1] - 2 || k > n[2] - 2 || t->blanked_cells[cell]) return 0;
    for (int c = 0; c < 8; c++)
        if (t->blanked_points[i + (c & 1) + n[0] * (j + (c >> 1 & 1) + n[1] * (k + (c >> 2)))]) return 0;
    for (int c = 0; c < t->components; c++)
        if (!isfinite(t->values[cell * t->components + c])) return 0;
    return 1;
}

/* The mean at a point, gathered from the cells around it in their order. */
static double mean_at(const trial *t, int64_t i, int64_t j, int64_t k, int component) {
    const int64_t *n = t->dims;
    double sum = 0;
    int count = 0;
    for (int64_t z = k - 1; z <= k; z++)
        for (int64_t y = j - 1; y <= j; y++)
            for (int64_t x = i - 1; x <= i; x++) {
                if (!cell_is_present(t, x, y, z)) continue;
                sum += t->values[(x + (n[0] - 1) * (y + (n[1] - 1) * z)) * t->components + component];
                count++;
            }
    return count ? sum / count : NAN;
}

static void store(void *to, tc_type type, int64_t n, double value) {
    switch (type) {
    case TC_U8:
        ((uint8_t *)to)[n] = (uint8_t)value;
        return;
    case TC_I8:
        ((int8_t *)to)[n] = (int8_t)value;
        return;
    case TC_U16:
        ((uint16_t *)to)[n] = (uint16_t)value;
        return;
    case TC_I16:
        ((int16_t *)to)[n] = (int16_t)value;
        return;
    case TC_U32:
        ((uint32_t *)to)[n] = (uint32_t)value;
        return;
    case TC_I32:
        ((int32_t *)to)[n] = (int32_t)value;
        return;
    case TC_F32:
        ((float *)to)[n] = (float)value;
        return;
    case TC_F64:
        ((double *)to)[n] = value;
        return;
    }
}

static void make_trial(trial *t, void *stored) {
    for (int axis = 0; axis < 3; axis++) t->dims[axis] = 2 + (int64_t)random_below(MOST - 1);
    t->type = (tc_type)random_below(8);
    t->components = 1 + (int)random_below(COMPONENTS);
    int is_real = t->type == TC_F32 || t->type == TC_F64;
    for (int64_t n = 0; n < MOST * MOST * MOST; n++) {
        t->blanked_cells[n] = random_below(7) == 0;
        t->blanked_points[n] = random_below(40) == 0;
        for (int c = 0; c < t->components; c++) {
            double value = (double)random_below(128);
            if (is_real && random_below(50) == 0) value = NAN;
            t->values[n * t->components + c] = value;
            store(stored, t->type, n * t->components + c, value);
        }
    }
}

static void averages_agree_with_gathering(void) {
    static trial t;
    static double stored[MOST * MOST * MOST * COMPONENTS];
    random_state = 11;
    for (int round = 0; round < 400; round++) {
        make_trial(&t, stored);
        dataset d = {0};
        dataset_field out;
        dataset_block *b = add_block(&d, t.dims[0], t.dims[1], t.dims[2]);
        b->blanked_points = t.blanked_points;
        add_field(b, "v", 1, t.components, t.type, stored);
        if (round % 2) make_unstructured(&d, b);
        EXPECT(average_to_points(&d, b, t.blanked_cells, &b->fields[0], &out) == 0, "%s", failure_text());
        int is_wide = t.type == TC_U32 || t.type == TC_I32 || t.type == TC_F64;
        EXPECT(out.type == (is_wide ? TC_F64 : TC_F32) && out.components == t.components && !out.on_cells, "kind");
        for (int64_t n = 0; n < b->point_count * t.components; n++) {
            int64_t p = n / t.components, i = p % t.dims[0], j = p / t.dims[0] % t.dims[1];
            double mean = mean_at(&t, i, j, p / t.dims[0] / t.dims[1], (int)(n % t.components));
            double got = value_at(out.type, out.values, (uint64_t)n);
            double wanted = is_wide ? mean : (double)(float)mean;
            EXPECT(isnan(wanted) ? isnan(got) : got == wanted, "round %d value %lld: %.17g, not %.17g", round,
                   (long long)n, got, wanted);
        }
        dataset_release(&d);
    }
}

/* ------------------------------------------------------------------------------------------------------------ files */

static const char *file_of(const char *name, const void *bytes, size_t size) {
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    unlink(path);
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(bytes, 1, size, f) != size || fclose(f)) abort();
    return path;
}

static int read_file(const char *path, const char *path2, dataset *d) {
    read_request request;
    read_request_init(&request, path);
    request.path2 = path2;
    return dataset_read(&request, d);
}

static void images_are_datasets(void) {
    static const char nrrd[] =
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 3 4\nencoding: raw\n\nabcdefghijklmnopqrstuvwx";
    dataset d;
    const char *path = file_of("a.nrrd", nrrd, sizeof nrrd - 1);
    EXPECT(read_file(path, NULL, &d) == 0, "%s", failure_text());
    EXPECT(d.block_count == 1 && d.blocks[0].kind == BLOCK_UNIFORM && d.blocks[0].field_count == 1, "not one image");
    EXPECT(d.blocks[0].point_count == 24 && d.blocks[0].cell_count == 6, "sizes");
    EXPECT(d.blocks[0].dims[0] == 2 && d.blocks[0].dims[1] == 3 && d.blocks[0].dims[2] == 4, "dimensions");
    EXPECT(d.blocks[0].matrix[1][1] == 1.0 && strcmp(d.format, "NRRD") == 0, "matrix or format");
    const dataset_field *f = d.blocks[0].fields;
    EXPECT(f->name[0] == '\0' && f->type == TC_U8 && f->components == 1 && !f->on_cells, "kind of field");
    EXPECT(memcmp(f->values, "abcdefghijklmnopqrstuvwx", 24) == 0, "samples");
    dataset_release(&d);
    dataset_release(&d);
    EXPECT(read_file(path, "other.q", &d) == STATUS_USAGE, "two inputs, the first a NRRD file");
    says("other.q");
    EXPECT(d.block_count == 0 && !d.blocks && !d.memory, "not zeroed on failure");
    path = file_of("a.xyz", nrrd, sizeof nrrd - 1);
    EXPECT(read_file(path, "other.q", &d) == STATUS_USAGE, "two inputs, the first in fact a NRRD file");
}

static void what_is_not_read_is_named(void) {
    static const struct {
        const char *name, *bytes;
        int status;
        const char *says;
    } files[] = {{"a.ex2", "CDF\1....", STATUS_INPUT, "Exodus"}, {"a.e", "?", STATUS_INPUT, "contour_cells"},
                 {"a.nc", "CDF\2....", STATUS_INPUT, "nccopy"},  {"a.cgns", "?", STATUS_INPUT, "CGNS"},
                 {"a.stl", "solid", STATUS_INPUT, "surface"},    {"a.q", "?", STATUS_USAGE, "two inputs"},
                 {"a.bin", "?", STATUS_USAGE, "--dims"},         {"a", "?", STATUS_INPUT, "not known"},
                 {"a.txt", "", STATUS_INPUT, "not known"}};
    for (size_t n = 0; n < sizeof files / sizeof *files; n++) {
        dataset d;
        const char *path = file_of(files[n].name, files[n].bytes, strlen(files[n].bytes));
        int status = read_file(path, NULL, &d);
        EXPECT(status == files[n].status, "%s: status %d", files[n].name, status);
        says(files[n].says);
        says(path);
        if (files[n].status == STATUS_INPUT) says("reads raw, NRRD");
    }
}

int main(void) {
    folder_make("dataset");
    the_only_field_is_taken();
    open_choices_list_what_there_is();
    long_lists_are_cut();
    every_block_must_have_the_field();
    missing_values_are_marked();
    missing_cells_are_left_out();
    flat_cells_do_not_count();
    averages_agree_with_gathering();
    images_are_datasets();
    what_is_not_read_is_named();
    folder_remove();
    return EXPECT_DONE();
}
