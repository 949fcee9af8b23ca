/* seeds_hdf5.c - HDF5 files: datasets in every form, VTKHDF images and unstructured grids; see seeds.h */
#include "seeds.h"

#include <hdf5.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char plain[4] = {-1, -1, 0, 0};

static void add_array(hid_t at, const char *name, hid_t type, int dimension, const hsize_t *shape, const double *values,
                      int form) {
    const hid_t plan = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate_simple(dimension, shape, NULL);
    hsize_t chunk[3];
    for (int a = 0; a < dimension; a++) chunk[a] = shape[a] > 1 ? shape[a] - 1 : 1;
    if (form == 1) H5Pset_layout(plan, H5D_COMPACT);
    if (form >= 2) H5Pset_chunk(plan, dimension, chunk);
    if (form == 3) H5Pset_shuffle(plan);
    if (form == 3) H5Pset_deflate(plan, 6);
    if (form == 4) H5Pset_fletcher32(plan);
    const hid_t made = H5Dcreate2(at, name, type, space, H5P_DEFAULT, plan, H5P_DEFAULT);
    H5Dwrite(made, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    H5Dclose(made);
    H5Sclose(space);
    H5Pclose(plan);
}

static void add_row(hid_t at, const char *name, hid_t type, hsize_t count, const double *values, int form) {
    add_array(at, name, type, 1, &count, values, form);
}

static void add_text(hid_t at, const char *name, const char *text) {
    const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(type, strlen(text));
    const hid_t made = H5Acreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(made, type, text);
    H5Aclose(made);
    H5Sclose(space);
    H5Tclose(type);
}

static void add_numbers(hid_t at, const char *name, hsize_t count, const double *values) {
    const hid_t space = H5Screate_simple(1, &count, NULL);
    const hid_t made = H5Acreate2(at, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(made, H5T_NATIVE_DOUBLE, values);
    H5Aclose(made);
    H5Sclose(space);
}

static void add_image(hid_t file, int form, int of_vtk) {
    static const double spacing[] = {1, 2, 0.5}, extent[] = {0, 3, 0, 2, 0, 1};
    double values[24];
    const hsize_t shape[3] = {2, 3, 4};
    for (int n = 0; n < 24; n++) values[n] = n * 7 % 11;
    if (!of_vtk) {
        add_array(file, "a", form & 1 ? H5T_STD_I16BE : H5T_STD_U8LE, 3, shape, values, form);
        return;
    }
    const hid_t root = H5Gcreate2(file, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t points = H5Gcreate2(root, "PointData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    add_text(root, "Type", "ImageData");
    add_numbers(root, "Spacing", 3, spacing);
    add_numbers(root, "WholeExtent", 6, extent);
    add_array(points, "a", H5T_IEEE_F32LE, 3, shape, values, form);
    H5Gclose(points);
    H5Gclose(root);
}

static void add_grid(hid_t file, int form, int with_steps) {
    static const double two[] = {4, 4}, ones[] = {1, 1}, links[] = {0, 1, 2, 3, 0, 1, 2, 3}, ends[] = {0, 4, 0, 4},
                        types[] = {10, 42}, faces[] = {0, 4}, corners[] = {0, 12}, zero[] = {0, 0},
                        none[] = {0, 1, 2, 3}, face_ends[] = {0, 0, 3, 6, 9, 12},
                        face_links[] = {0, 1, 2, 0, 1, 3, 1, 2, 3, 0, 2, 3}, cell_ends[] = {0, 0, 0, 4},
                        numbers[] = {5, 6, 7, 8, 5, 6, 7, 9}, steps[] = {1};
    double points[24] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, -1};
    const hid_t root = H5Gcreate2(file, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t of_points = H5Gcreate2(root, "PointData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t of_cells = H5Gcreate2(root, "CellData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    add_text(root, "Type", "UnstructuredGrid");
    add_row(root, "NumberOfPoints", H5T_STD_I64LE, 2, two, 0);
    add_row(root, "NumberOfCells", H5T_STD_I64LE, 2, ones, 0);
    add_row(root, "NumberOfConnectivityIds", H5T_STD_I64LE, 2, two, 0);
    add_array(root, "Points", H5T_IEEE_F32LE, 2, (hsize_t[2]){8, 3}, points, form);
    add_row(root, "Types", H5T_STD_U8LE, 2, types, form);
    add_row(root, "Offsets", H5T_STD_I64LE, 4, ends, form);
    add_row(root, "Connectivity", H5T_STD_I32BE, 8, links, form);
    add_row(root, "NumberOfFaces", H5T_STD_I64LE, 2, faces, 0);
    add_row(root, "NumberOfFaceConnectivityIds", H5T_STD_I64LE, 2, corners, 0);
    add_row(root, "NumberOfPolyhedronToFaceIds", H5T_STD_I64LE, 2, faces, 0);
    add_row(root, "FaceOffsets", H5T_STD_I64LE, 6, face_ends, form);
    add_row(root, "FaceConnectivity", H5T_STD_I64LE, 12, face_links, form);
    add_row(root, "PolyhedronToFaces", H5T_STD_I64LE, 4, none, form);
    add_row(root, "PolyhedronOffsets", H5T_STD_I64LE, 4, cell_ends, form);
    add_row(of_points, "n", H5T_STD_I64LE, 8, numbers, form);
    add_row(of_cells, "vtkGhostType", H5T_STD_U8LE, 2, zero, form);
    const hid_t set = H5Dopen2(of_points, "n", H5P_DEFAULT);
    add_text(set, "Attribute", "GlobalIds");
    H5Dclose(set);
    if (with_steps) {
        const hid_t group = H5Gcreate2(root, "Steps", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        add_numbers(group, "NSteps", 1, steps);
        add_row(group, "NumberOfParts", H5T_STD_I64LE, 1, two + 1, 0);
        add_row(group, "PointOffsets", H5T_STD_I64LE, 1, zero, 0);
        H5Gclose(group);
    }
    H5Gclose(of_points);
    H5Gclose(of_cells);
    H5Gclose(root);
}

static void add_file(int kind, int form, int latest) {
    char path[] = "/tmp/tetracubes-seed-XXXXXX", name[64];
    const int descriptor = mkstemp(path);
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    if (latest) H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    if (kind < 2)
        add_image(file, form, kind);
    else
        add_grid(file, form, kind == 3);
    H5Fclose(file);
    H5Pclose(access);
    const off_t size = lseek(descriptor, 0, SEEK_END);
    unsigned char *bytes = malloc((size_t)size + 1);
    snprintf(name, sizeof name, "kind-%d-form-%d-latest-%d", kind, form, latest);
    if (bytes && pread(descriptor, bytes, (size_t)size, 0) == size)
        seed_file("hdf5", name, bytes, (size_t)size, NULL, 0, plain);
    free(bytes);
    close(descriptor);
    unlink(path);
}

void seeds_hdf5(void) {
    for (int n = 0; n < 40; n++) add_file(n / 10, n / 2 % 5, n & 1);
}
