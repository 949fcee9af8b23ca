/*
 * vtkhdf.c - VTKHDF PolyData (.vtkhdf), through libhdf5: points and their values, triangles
 *
 * libhdf5 makes the file in memory, with every large array at its place and nothing in it: pages that nobody writes
 * take none. What it has written, the description, then goes to the output with the arrays between, in the order of the
 * file, so that they are encoded as in every other format and the output may be a pipe.
 *
 * Source: "VTKHDF File Format", in VTK's file format documentation (docs.vtk.org). Connectivity and offsets have 32
 * bits where that is enough, else 64. The bytes depend on the mesh alone: no times are kept.
 */
#include "formats.h"
#include "hdf5_memory.h"
#include "shown_records.h"
#include "vtk_appended.h"
#include "vtkhdf.h"

#include <errno.h>
#include <hdf5.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum { COPY_BYTES = 64 << 10, ALIGNED_FROM = 512, ALIGNMENT = 64, OWN_ARRAYS = 4 };

/* An array that lies in the file in one piece. */
typedef struct hdf_array {
    char *name;
    hid_t type;
    uint64_t rows;
    int columns; /* 1: the array has one axis */
    const char *attribute;
    record_array records;
    uint64_t start; /* in the file */
} hdf_array;

typedef struct hdf_file {
    output *o;
    const shown_mesh *s;
    shown_array *shown;
    hdf_array *arrays;
    size_t array_count;
    int memory; /* the descriptor of the file in memory */
    int is_wide;
} hdf_file;

/* ---------------------------------------------------------------------------------------------------------- arrays */

static unsigned char *encode_corners(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const hdf_file *f = source;
    for (uint64_t c = 3 * first; c < 3 * end; c++) to = put_index(to, corner_vertex(f->s, c), f->is_wide);
    return to;
}

/* Where each triangle begins, and behind the last. */
static unsigned char *encode_starts(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const hdf_file *f = source;
    for (uint64_t t = first; t < end; t++) to = put_index(to, 3 * t, f->is_wide);
    return to;
}

static int is_taken(const hdf_file *f, const char *name) {
    for (size_t n = 0; n < f->array_count; n++)
        if (strcmp(f->arrays[n].name, name) == 0) return 1;
    return 0;
}

/* The path of an array of points: a name may hold anything but '/', and is not "."; '_' goes behind one that is taken.
 * NULL without memory. */
static char *make_name(const hdf_file *f, const char *name, int is_normals) {
    static const char folder[] = "PointData/";
    const size_t capacity = strlen(name) + sizeof folder + (size_t)f->s->array_count + 2;
    char *path = malloc(capacity);
    if (!path) return NULL;
    size_t length = (size_t)snprintf(path, capacity, "%s%s", folder, *name ? name : "_");
    char *own = path + sizeof folder - 1;
    for (char *at = own; *at; at++)
        if (*at == '/') *at = '_';
    if (strcmp(own, ".") == 0) *own = '_';
    while (!is_normals && (strcmp(own, "Normals") == 0 || is_taken(f, path))) {
        path[length++] = '_';
        path[length] = '\0';
    }
    return path;
}

static void add_array(hdf_file *f, char *name, hid_t type, uint64_t rows, int columns, record_array records) {
    if (!name)
        f->o->error = ENOMEM;
    else
        f->arrays[f->array_count++] = (hdf_array){name, type, rows, columns, NULL, records, 0};
}

static void add_values(hdf_file *f) {
    for (int n = 0; n < f->s->array_count && !f->o->error; n++) {
        const vertex_array *a = &f->s->arrays[n];
        const int is_normals = a->role == ROLE_NORMALS;
        f->shown[n] = (shown_array){f->s, *a};
        add_array(f, make_name(f, is_normals ? "Normals" : a->name, is_normals), H5T_IEEE_F32LE,
                  file_vertex_count(f->s), a->components, records_of_values(&f->shown[n]));
        if (is_normals && !f->o->error) f->arrays[f->array_count - 1].attribute = "Normals";
    }
}

static void list_arrays(hdf_file *f) {
    const shown_mesh *s = f->s;
    const uint64_t triangles = s->triangle_count;
    const size_t index = f->is_wide ? 8 : 4;
    const hid_t type = f->is_wide ? H5T_STD_I64LE : H5T_STD_I32LE;
    record_span starts = triangle_span(s);
    starts.end += starts.end == starts.count++;
    add_array(f, strdup("Points"), s->is_moved ? H5T_IEEE_F64LE : H5T_IEEE_F32LE, file_vertex_count(s), 3,
              records_of_positions(s, s->is_moved));
    add_values(f);
    if (s->labels) add_array(f, strdup("CellData/BoundaryLabels"), H5T_STD_U32LE, triangles, 2, records_of_labels(s));
    add_array(f, strdup("Polygons/Connectivity"), type, 3 * triangles, 1,
              (record_array){triangle_span(s), 3 * index, encode_corners, f});
    add_array(f, strdup("Polygons/Offsets"), type, triangles + 1, 1, (record_array){starts, index, encode_starts, f});
}

/* ------------------------------------------------------------------------------------------------------ description */

static int add_text(hid_t object, const char *name, const char *text) {
    const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(type, strlen(text));
    H5Tset_strpad(type, H5T_STR_NULLPAD);
    const hid_t made = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    const int is_made = made >= 0 && H5Awrite(made, type, text) >= 0;
    if (made >= 0) H5Aclose(made);
    H5Sclose(space);
    H5Tclose(type);
    return is_made;
}

static int add_version(hid_t object) {
    static const int64_t version[2] = {2, 0};
    const hid_t space = H5Screate_simple(1, (hsize_t[1]){2}, NULL);
    const hid_t made = H5Acreate2(object, "Version", H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    const int is_made = made >= 0 && H5Awrite(made, H5T_NATIVE_INT64, version) >= 0;
    if (made >= 0) H5Aclose(made);
    H5Sclose(space);
    return is_made;
}

static int add_group(hid_t root, const char *name) {
    const hid_t made = H5Gcreate2(root, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (made >= 0) H5Gclose(made);
    return made >= 0;
}

/* One number, or none, as a part of the description. */
static int add_number(hid_t root, const char *name, hsize_t count, int64_t value) {
    const hid_t plan = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate_simple(1, &count, NULL);
    H5Pset_layout(plan, H5D_COMPACT);
    H5Pset_obj_track_times(plan, 0);
    const hid_t made = H5Dcreate2(root, name, H5T_STD_I64LE, space, H5P_DEFAULT, plan, H5P_DEFAULT);
    const int is_made =
        made >= 0 && (!count || H5Dwrite(made, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value) >= 0);
    if (made >= 0) H5Dclose(made);
    H5Sclose(space);
    H5Pclose(plan);
    return is_made;
}

/* A string of the file's field data. */
static int add_note(hid_t root, const char *name, const char *value) {
    char path[64];
    const hid_t type = H5Tcopy(H5T_C_S1), plan = H5Pcreate(H5P_DATASET_CREATE);
    const hid_t space = H5Screate_simple(1, (hsize_t[1]){1}, NULL);
    snprintf(path, sizeof path, "FieldData/%s", name);
    H5Tset_size(type, H5T_VARIABLE);
    H5Pset_obj_track_times(plan, 0);
    const hid_t made = H5Dcreate2(root, path, type, space, H5P_DEFAULT, plan, H5P_DEFAULT);
    const int is_made = made >= 0 && H5Dwrite(made, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value) >= 0;
    if (made >= 0) H5Dclose(made);
    H5Sclose(space);
    H5Pclose(plan);
    H5Tclose(type);
    return is_made;
}

/* Cells of a kind that the mesh has not. */
static int add_no_cells(hid_t root, const char *kind) {
    char name[64];
    static const struct {
        const char *name;
        hsize_t count;
    } numbers[] = {{"NumberOfCells", 1}, {"NumberOfConnectivityIds", 1}, {"Offsets", 1}, {"Connectivity", 0}};
    int is_made = add_group(root, kind);
    for (size_t n = 0; n < 4 && is_made; n++) {
        snprintf(name, sizeof name, "%s/%s", kind, numbers[n].name);
        is_made = add_number(root, name, numbers[n].count, 0);
    }
    return is_made;
}

/* Has its place in the file, but no values. An array of none has no place. */
static int place_array(hid_t root, hdf_array *a) {
    const hsize_t sizes[2] = {a->rows, (hsize_t)a->columns};
    const hid_t plan = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate_simple(a->columns > 1 ? 2 : 1, sizes, NULL);
    H5Pset_layout(plan, H5D_CONTIGUOUS);
    H5Pset_alloc_time(plan, H5D_ALLOC_TIME_EARLY);
    H5Pset_fill_time(plan, H5D_FILL_TIME_NEVER);
    H5Pset_obj_track_times(plan, 0);
    const hid_t made = H5Dcreate2(root, a->name, a->type, space, H5P_DEFAULT, plan, H5P_DEFAULT);
    const haddr_t start = made < 0 || !a->rows ? 0 : H5Dget_offset(made);
    const int is_made =
        made >= 0 && start != HADDR_UNDEF && (!a->attribute || add_text(made, "Attribute", a->attribute));
    a->start = start;
    if (made >= 0) H5Dclose(made);
    H5Sclose(space);
    H5Pclose(plan);
    return is_made;
}

static int describe(hdf_file *f, hid_t file) {
    static const char *const groups[] = {"PointData", "CellData", "FieldData", "Polygons"};
    static const char *const none[] = {"Vertices", "Lines", "Strips"};
    const int64_t triangles = (int64_t)f->s->triangle_count;
    const hid_t root = H5Gcreate2(file, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    int is_made = root >= 0 && add_version(root) && add_text(root, "Type", "PolyData");
    for (size_t n = 0; n < sizeof groups / sizeof *groups && is_made; n++) is_made = add_group(root, groups[n]);
    for (size_t n = 0; n < sizeof none / sizeof *none && is_made; n++) is_made = add_no_cells(root, none[n]);
    is_made = is_made && add_number(root, "NumberOfPoints", 1, (int64_t)file_vertex_count(f->s)) &&
              add_number(root, "Polygons/NumberOfCells", 1, triangles) &&
              add_number(root, "Polygons/NumberOfConnectivityIds", 1, 3 * triangles);
    for (int n = 0; shown_notes(f->s, n).name && is_made; n++)
        is_made = add_note(root, shown_notes(f->s, n).name, shown_notes(f->s, n).value);
    for (size_t n = 0; n < f->array_count && is_made; n++) is_made = place_array(root, &f->arrays[n]);
    if (root >= 0) H5Gclose(root);
    return is_made;
}

/* Makes the file in memory. */
static int make_file(hdf_file *f) {
    const hid_t access = hdf5_memory_access(NULL, 0, f->memory, &f->o->error), create = H5Pcreate(H5P_FILE_CREATE);
    H5Pset_alignment(access, ALIGNED_FROM, ALIGNMENT); /* arrays can be used where they lie */
    H5Pset_obj_track_times(create, 0);
    const hid_t file = H5Fcreate("memory", H5F_ACC_TRUNC, create, access);
    int is_made = file >= 0 && describe(f, file);
    if (file >= 0 && H5Fclose(file) < 0) is_made = 0;
    H5Pclose(access);
    H5Pclose(create);
    return is_made;
}

/* ---------------------------------------------------------------------------------------------------------- writing */

static int compare_starts(const void *first, const void *second) {
    const hdf_array *a = first, *b = second;
    return (a->start > b->start) - (a->start < b->start);
}

/* The description from one place of the file to another. */
static void copy_description(hdf_file *f, uint64_t from, uint64_t to) {
    unsigned char *buffer = malloc(COPY_BYTES);
    if (!buffer) f->o->error = ENOMEM;
    while (from < to && !f->o->error) {
        const uint64_t bytes = to - from < COPY_BYTES ? to - from : COPY_BYTES;
        const ssize_t got = pread(f->memory, buffer, (size_t)bytes, (off_t)from);
        if (got <= 0)
            f->o->error = got < 0 ? errno : EIO;
        else
            output_bytes(f->o, buffer, (uint64_t)got);
        from += got > 0 ? (uint64_t)got : 0;
    }
    free(buffer);
}

static void write_file(hdf_file *f) {
    struct stat about;
    uint64_t at = 0;
    if (fstat(f->memory, &about) != 0) {
        f->o->error = errno;
        return;
    }
    output_expect(f->o, (uint64_t)about.st_size);
    qsort(f->arrays, f->array_count, sizeof *f->arrays, compare_starts);
    for (size_t n = 0; n < f->array_count && !f->o->error; n++) {
        const hdf_array *a = &f->arrays[n];
        if (!a->rows) continue;
        copy_description(f, at, a->start);
        write_records(f->o, &a->records);
        at = a->start + record_array_bytes(&a->records);
    }
    copy_description(f, at, (uint64_t)about.st_size);
}

static void write_vtkhdf(output *o, const shown_mesh *s) {
    hdf_file f = {.o = o,
                  .s = s,
                  .shown = malloc(((size_t)s->array_count + 1) * sizeof *f.shown),
                  .arrays = malloc(((size_t)s->array_count + OWN_ARRAYS) * sizeof *f.arrays),
                  .memory = memfd_create("vtkhdf", MFD_CLOEXEC),
                  .is_wide = vtk_needs_wide(file_vertex_count(s), 3 * s->triangle_count)};
    H5E_auto2_t report;
    void *report_data;
    H5Eget_auto2(H5E_DEFAULT, &report, &report_data);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    if (!f.shown || !f.arrays || f.memory < 0) o->error = ENOMEM;
    if (!o->error) list_arrays(&f);
    if (!o->error && !make_file(&f) && !o->error) o->error = ENOMEM; /* nothing else can be wrong with a description */
    if (!o->error) write_file(&f);
    H5Eclear2(H5E_DEFAULT);
    H5Eset_auto2(H5E_DEFAULT, report, report_data);
    for (size_t n = 0; n < f.array_count; n++) free(f.arrays[n].name);
    free(f.arrays);
    free(f.shown);
    if (f.memory >= 0) close(f.memory);
}

void mesh_write_add_hdf5(void) { vtkhdf_writer = write_vtkhdf; }
