/*
 * test_write_vtkhdf.c - meshes as VTKHDF files, read back through libhdf5: points, triangles, normals, fields of any
 * names
 */
#include "exit_status.h"
#include "failure.h"
#include "folder.h"
#include "mesh_files.h"
#include "mesh_write.h"

#include <hdf5.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#ifndef VTK_WIDE_FROM
#define VTK_WIDE_FROM INT32_MAX
#endif

static const char *path_of(const char *name) {
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

/* Whether the array has that type and shape, and these bytes. */
static int holds(hid_t file, const char *name, hid_t type, uint64_t rows, uint64_t columns, const void *should) {
    char path[300];
    snprintf(path, sizeof path, "/VTKHDF/%s", name);
    hsize_t shape[2] = {0, 1};
    const hid_t set = H5Dopen2(file, path, H5P_DEFAULT);
    if (set < 0) return 0;
    const hid_t space = H5Dget_space(set), own = H5Dget_type(set);
    const int dimension = H5Sget_simple_extent_ndims(space);
    int is_good = dimension == (columns > 1 ? 2 : 1) && H5Tequal(own, type) > 0;
    if (is_good) H5Sget_simple_extent_dims(space, shape, NULL);
    is_good = is_good && shape[0] == rows && shape[1] == columns;
    const size_t bytes = (size_t)(rows * columns) * H5Tget_size(own);
    unsigned char *is = allocate(bytes + 1);
    if (is_good && bytes)
        is_good = H5Dread(set, own, H5S_ALL, H5S_ALL, H5P_DEFAULT, is) >= 0 && !memcmp(is, should, bytes);
    /* arrays begin where they can be used in place */
    if (is_good && bytes > 4096) is_good = H5Dget_offset(set) % 64 == 0;
    free(is);
    H5Tclose(own);
    H5Sclose(space);
    H5Dclose(set);
    return is_good;
}

static void expect_number(hid_t file, const char *name, int64_t should) {
    EXPECT(holds(file, name, H5T_STD_I64LE, 1, 1, &should), "%s is not %lld", name, (long long)should);
}

static void expect_triangles(hid_t file, const char *what, const tc_mesh_data *mesh, int soup) {
    const uint64_t corners = 3 * mesh->triangle_count, vertices = soup ? corners : mesh->vertex_count;
    const int wide = vertices > VTK_WIDE_FROM || corners > VTK_WIDE_FROM;
    const size_t bytes = wide ? 8 : 4;
    unsigned char *links = allocate(corners * bytes + 1), *starts = allocate((mesh->triangle_count + 1) * bytes);
    for (uint64_t c = 0; c < corners; c++) {
        const uint64_t index = soup ? c : mesh->triangles[c];
        memcpy(links + c * bytes, &index, bytes);
    }
    for (uint64_t t = 0; t <= mesh->triangle_count; t++) memcpy(starts + t * bytes, &(uint64_t){3 * t}, bytes);
    const hid_t type = wide ? H5T_STD_I64LE : H5T_STD_I32LE;
    EXPECT(holds(file, "Polygons/Connectivity", type, corners, 1, links), "%s: connectivity", what);
    EXPECT(holds(file, "Polygons/Offsets", type, mesh->triangle_count + 1, 1, starts), "%s: offsets", what);
    expect_number(file, "NumberOfPoints", (int64_t)vertices);
    expect_number(file, "Polygons/NumberOfCells", (int64_t)mesh->triangle_count);
    expect_number(file, "Polygons/NumberOfConnectivityIds", (int64_t)corners);
    expect_number(file, "Strips/NumberOfCells", 0);
    free(links);
    free(starts);
}

/* Values as the file shows them. */
static float *shown(const tc_mesh_data *mesh, const float *values, uint64_t components, int soup) {
    const uint64_t count = soup ? 3 * mesh->triangle_count : mesh->vertex_count;
    float *to = allocate(count * components * sizeof *to + 1);
    for (uint64_t v = 0; v < count; v++)
        memcpy(to + v * components, values + components * (soup ? mesh->triangles[v] : v), components * 4);
    return to;
}

static void test_mesh(const tc_mesh_data *mesh, int soup) {
    static const char *const names[][2] = {{"pressure", "PointData/pressure"},  {"a/b c\xff", "PointData/a_b c\xff"},
                                           {"Normals", "PointData/Normals_"},   {".", "PointData/_"},
                                           {"pressure", "PointData/pressure_"}, {"", "PointData/__"}};
    enum { FIELDS = 6 };
    const uint64_t rows = soup ? 3 * mesh->triangle_count : mesh->vertex_count;
    float *values = allocate(3 * mesh->vertex_count * FIELDS * sizeof *values + 1);
    vertex_array fields[FIELDS];
    char what[100];
    for (uint64_t n = 0; n < 3 * mesh->vertex_count * FIELDS; n++) values[n] = random_float();
    for (uint64_t n = 0; n < FIELDS; n++)
        fields[n] = (vertex_array){names[n][0], n == 1 ? 3 : 1, values + 3 * mesh->vertex_count * n, ROLE_DATA};
    const mesh_write_options options = {.soup = soup, .fields = fields, .field_count = FIELDS};
    snprintf(what, sizeof what, "%llu vertices, normals %d, soup %d", (unsigned long long)mesh->vertex_count,
             mesh->normals != NULL, soup);
    EXPECT(mesh_write(path_of("a.vtkhdf"), mesh, &options) == 0, "%s: %s", what, failure_text());
    const hid_t file = H5Fopen(path_of("a.vtkhdf"), H5F_ACC_RDONLY, H5P_DEFAULT);
    EXPECT(file >= 0, "%s: not opened", what);
    expect_triangles(file, what, mesh, soup);
    for (uint64_t n = 0; n < FIELDS; n++) {
        const uint64_t columns = (uint64_t)fields[n].components;
        float *should = shown(mesh, fields[n].values, columns, soup);
        EXPECT(holds(file, names[n][1], H5T_IEEE_F32LE, rows, columns, should), "%s: field %s", what, names[n][1]);
        free(should);
    }
    float *points = shown(mesh, mesh->positions, 3, soup),
          *normals = mesh->normals ? shown(mesh, mesh->normals, 3, soup) : NULL;
    EXPECT(holds(file, "Points", H5T_IEEE_F32LE, rows, 3, points), "%s: points", what);
    if (normals) EXPECT(holds(file, "PointData/Normals", H5T_IEEE_F32LE, rows, 3, normals), "%s: normals", what);
    free(points);
    free(normals);
    free(values);
    H5Fclose(file);
    unlink(path_of("a.vtkhdf"));
}

/* Far from zero the points are doubles. */
static void test_moved(void) {
    tc_mesh_data mesh = make_mesh(1000, 100, 0);
    double *should = allocate(3000 * sizeof *should);
    const double origin[3] = {1e7, -2.5, 1e9};
    memcpy(mesh.origin, origin, sizeof origin);
    for (int n = 0; n < 3000; n++) should[n] = (double)mesh.positions[n] + origin[n % 3];
    EXPECT(mesh_write(path_of("far.vtkhdf"), &mesh, NULL) == 0, "%s", failure_text());
    const hid_t file = H5Fopen(path_of("far.vtkhdf"), H5F_ACC_RDONLY, H5P_DEFAULT);
    EXPECT(holds(file, "Points", H5T_IEEE_F64LE, 1000, 3, should), "points far from zero");
    H5Fclose(file);
    unlink(path_of("far.vtkhdf"));
    free(should);
    free_mesh(&mesh);
}

/* What does not fit leaves nothing, whether the description or the arrays are too large. */
static void test_limits(void) {
    tc_mesh_data mesh = make_mesh(100003, 200009, 0);
    struct rlimit limit;
    getrlimit(RLIMIT_FSIZE, &limit);
    signal(SIGXFSZ, SIG_IGN);
    for (rlim_t most = 1000; most < 4000000; most *= 7) {
        setrlimit(RLIMIT_FSIZE, &(struct rlimit){most, limit.rlim_max});
        const int status = mesh_write(path_of("large.vtkhdf"), &mesh, NULL);
        setrlimit(RLIMIT_FSIZE, &limit);
        EXPECT(status == STATUS_FAILED && strstr(failure_text(), "ulimit"), "%llu bytes: status %d, %s",
               (unsigned long long)most, status, failure_text());
    }
    free_mesh(&mesh);
}

int main(void) {
    static const uint64_t sizes[][2] = {{4, 4}, {0, 0}, {7, 0}, {1, 1}, {100003, 200009}};
    folder_make("vtkhdf");
    EXPECT(mesh_write_check("a.vtkhdf", NULL) == STATUS_USAGE && strstr(failure_text(), "libhdf5 was not built in"),
           "%s", failure_text());
    mesh_write_add_hdf5();
    EXPECT(mesh_write_check("a.VTKHDF", NULL) == 0, "%s", failure_text());
    for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++)
        for (int normals = 0; normals < 2; normals++) {
            tc_mesh_data mesh = make_mesh(sizes[n][0], sizes[n][1], normals);
            test_mesh(&mesh, 0);
            test_mesh(&mesh, 1);
            free_mesh(&mesh);
        }
    test_moved();
    test_limits();
    EXPECT(mesh_write(path_of("none/a.vtkhdf"), &(tc_mesh_data){0}, NULL) == STATUS_FAILED, "written to no folder");
    folder_remove();
    return EXPECT_DONE();
}
