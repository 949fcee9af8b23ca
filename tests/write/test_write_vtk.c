/*
 * test_write_vtk.c - fields on vertices in PLY and VTP files, and complexes as VTU files
 */
#include "dataset/dataset.h"
#include "exit_status.h"
#include "failure.h"
#include "folder.h"
#include "mesh_files.h"
#include "mesh_write.h"
#include "vtk_files.h"

#include <unistd.h>

static const char *path_of(const char *name) {
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static float *make_values(uint64_t count) {
    float *values = allocate(count * sizeof *values);
    for (uint64_t i = 0; i < count; i++) values[i] = random_float();
    return values;
}

/* The values as a file of soup or shared vertices shows them. */
static float *shown_values(const tc_mesh_data *mesh, const float *values, uint64_t components, int soup) {
    uint64_t count = soup ? 3 * mesh->triangle_count : mesh->vertex_count;
    float *shown = allocate(count * components * sizeof *shown);
    for (uint64_t v = 0; v < count; v++)
        memcpy(shown + v * components, values + components * (soup ? mesh->triangles[v] : v), components * 4);
    return shown;
}

static char *write_and_read(const char *name, const tc_mesh_data *mesh, const mesh_write_options *options,
                            size_t *bytes) {
    int status = mesh_write(path_of(name), mesh, options);
    EXPECT(status == 0, "%s: status %d: %s", name, status, failure_text());
    char *text = read_file(path_of(name), bytes);
    EXPECT(text != NULL, "%s is missing", name);
    unlink(path_of(name));
    return text;
}

static void test_vtp_fields(const tc_mesh_data *mesh, const vertex_array *fields, int soup) {
    static const char *const names[] = {"pressure", "a&lt;b&gt; &quot;c&quot; &amp; \xc3\xa4_", "momentum"};
    mesh_write_options options = {.soup = soup, .fields = fields, .field_count = 3};
    size_t bytes;
    char *text = write_and_read("mesh.vtp", mesh, &options, &bytes);
    for (int i = 0; i < 3 && text; i++) {
        uint64_t components = (uint64_t)fields[i].components;
        uint64_t count = soup ? 3 * mesh->triangle_count : mesh->vertex_count;
        float *should = shown_values(mesh, fields[i].values, components, soup);
        vtk_values is = vtk_find(text, bytes, names[i]);
        EXPECT(vtk_holds(&is, "Float32", fields[i].components, should, 4 * count * components),
               "field %s, soup %d: %s, %d components, %llu bytes", names[i], soup, is.type, is.components,
               (unsigned long long)is.bytes);
        free(should);
    }
    if (text) {
        tc_mesh_data is = parse_vtp(text, bytes);
        uint64_t wrong = is.triangle_count != mesh->triangle_count;
        for (uint64_t c = 0; c < 3 * is.triangle_count; c++)
            wrong += is.triangles[c] != (soup ? c : mesh->triangles[c]);
        EXPECT(wrong == 0, "%llu corners of %llu triangles are wrong", (unsigned long long)wrong,
               (unsigned long long)mesh->triangle_count);
        free_mesh(&is);
    }
    free(text);
}

static void test_ply_fields(const tc_mesh_data *mesh, const vertex_array *fields, int soup) {
    mesh_write_options options = {.soup = soup, .fields = fields, .field_count = 3};
    uint64_t count = soup ? 3 * mesh->triangle_count : mesh->vertex_count;
    const char *end = "property list uchar uint vertex_indices\nend_header\n";
    char should[1024];
    size_t bytes;
    char *text = write_and_read("mesh.ply", mesh, &options, &bytes);
    snprintf(should, sizeof should,
             "property float z\n%sproperty float pressure\nproperty float a_b___c_______\nproperty float momentum_0\n"
             "property float momentum_1\nproperty float momentum_2\nelement face %llu\n",
             mesh->normals ? "property float nx\nproperty float ny\nproperty float nz\n" : "",
             (unsigned long long)mesh->triangle_count);
    EXPECT(text && strstr(text, should), "PLY header: %.600s", text ? text : "");
    const char *data = text ? strstr(text, end) : NULL;
    if (data) {
        data += strlen(end);
        size_t vertex_bytes = (mesh->normals ? 24 : 12) + 5 * 4;
        EXPECT(bytes == (size_t)(data - text) + count * vertex_bytes + 13 * mesh->triangle_count, "%zu bytes", bytes);
        uint64_t wrong = 0;
        for (uint64_t v = 0; v < count; v++) {
            uint64_t from = soup ? mesh->triangles[v] : v;
            float record[11], *to = record;
            memcpy(to, mesh->positions + 3 * from, 12);
            to += 3;
            if (mesh->normals) memcpy(to, mesh->normals + 3 * from, 12);
            to += mesh->normals ? 3 : 0;
            *to++ = fields[0].values[from];
            *to++ = fields[1].values[from];
            memcpy(to, fields[2].values + 3 * from, 12);
            wrong += memcmp(record, data + v * vertex_bytes, vertex_bytes) != 0;
        }
        EXPECT(wrong == 0, "%llu PLY vertices are wrong, soup %d", (unsigned long long)wrong, soup);
    }
    free(text);
}

/* Names of fields that the format uses itself, or that are given twice. */
static void test_ply_names(void) {
    tc_mesh_data mesh = make_mesh(1, 0, 0);
    float values[4] = {1, 2, 3, 4};
    vertex_array fields[] = {{"x", 1, values, ROLE_DATA},
                             {"nx", 1, values, ROLE_DATA},
                             {"", 1, values, ROLE_DATA},
                             {"x", 1, values, ROLE_DATA},
                             {"a b", 2, values, ROLE_DATA}};
    mesh_write_options options = {.fields = fields, .field_count = 5};
    size_t bytes;
    char *text = write_and_read("names.ply", &mesh, &options, &bytes);
    EXPECT(text && strstr(text, "property float z\nproperty float x_\nproperty float nx_\nproperty float field\n"
                                "property float x__\nproperty float a_b_0\nproperty float a_b_1\nelement face"),
           "PLY header: %.500s", text ? text : "");
    free(text);
    free_mesh(&mesh);
}

static void test_fields(void) {
    static const uint64_t sizes[][2] = {{4, 4}, {0, 0}, {100003, 50021}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int with_normals = 0; with_normals < 2; with_normals++) {
            tc_mesh_data mesh = make_mesh(sizes[i][0], sizes[i][1], with_normals);
            float *values[3] = {make_values(sizes[i][0]), make_values(sizes[i][0]), make_values(3 * sizes[i][0])};
            vertex_array fields[3] = {{"pressure", 1, values[0], ROLE_DATA},
                                      {"a<b> \"c\" & \xc3\xa4\xff", 1, values[1], ROLE_DATA},
                                      {"momentum", 3, values[2], ROLE_DATA}};
            for (int soup = 0; soup < 2; soup++) {
                test_vtp_fields(&mesh, fields, soup);
                test_ply_fields(&mesh, fields, soup);
            }
            for (int k = 0; k < 3; k++) free(values[k]);
            free_mesh(&mesh);
        }
}

static void test_refusals(void) {
    vertex_array field = {"f", 1, (float[]){0}, ROLE_DATA}, wide = {"f", 1 << 20, (float[]){0}, ROLE_DATA};
    mesh_write_options with = {.fields = &field, .field_count = 1}, too_many = {.fields = &wide, .field_count = 1};
    EXPECT(mesh_write_check("a.stl", &with) == STATUS_USAGE && strstr(failure_text(), "ply, vtp or npz"), "STL: %s",
           failure_text());
    EXPECT(mesh_write_check("a.obj", &with) == STATUS_USAGE && strstr(failure_text(), "ply, vtp or npz"), "OBJ: %s",
           failure_text());
    EXPECT(mesh_write_check("a.vtp", &too_many) == STATUS_USAGE && strstr(failure_text(), "4096"), "many: %s",
           failure_text());
    EXPECT(mesh_write_check("a.VTP", &with) == 0 && mesh_write_check("a.ply", &with) == 0, "%s", failure_text());
    EXPECT(complex_write_check("a.vtu", NULL) == 0 && complex_write_check("a.b/c.Vtu", NULL) == 0, "%s",
           failure_text());
    EXPECT(complex_write_check("a", "VTU") == 0 && complex_write_check("-", NULL) == 0, "%s", failure_text());
    EXPECT(complex_write_check("a.vtk", NULL) == STATUS_USAGE && strstr(failure_text(), ".vtu"), "VTK: %s",
           failure_text());
    EXPECT(complex_write_check("a.vtu", "ply") == STATUS_USAGE && strstr(failure_text(), "as vtu"), "PLY: %s",
           failure_text());
    EXPECT(complex_write_check(".vtu", NULL) == STATUS_USAGE && complex_write_check("", NULL) == STATUS_USAGE,
           "no name");
    complex_file none = {0};
    EXPECT(complex_write(path_of("none/a.vtu"), &none) == STATUS_FAILED, "a folder that is not there");
}

/* ------------------------------------------------------------------------------------------------------- complexes */

static void expect_cells(const char *text, size_t bytes, const complex_file *c) {
    vtk_values corners = vtk_find(text, bytes, "connectivity"), ends = vtk_find(text, bytes, "offsets"),
               types = vtk_find(text, bytes, "types");
    uint64_t count = c->tetrahedron_count, wrong = 0;
    EXPECT(corners.data && corners.bytes == 4 * count * vtk_index_bytes(&corners), "connectivity of %llu bytes",
           (unsigned long long)corners.bytes);
    EXPECT(ends.data && ends.bytes == count * vtk_index_bytes(&ends) && strcmp(ends.type, corners.type) == 0,
           "offsets of %llu bytes", (unsigned long long)ends.bytes);
    EXPECT(types.data && types.bytes == count && strcmp(types.type, "UInt8") == 0, "types of %llu bytes",
           (unsigned long long)types.bytes);
    if (!corners.data || !ends.data || !types.data) return;
    for (uint64_t t = 0; t < count; t++) {
        for (uint64_t k = 0; k < 4; k++) wrong += vtk_index(&corners, 4 * t + k) != c->tetrahedra[4 * t + k];
        wrong += vtk_index(&ends, t) != (int64_t)(4 * t + 4) || types.data[t] != 10;
    }
    EXPECT(wrong == 0, "%llu corners, ends or types are wrong", (unsigned long long)wrong);
}

static void test_complex(uint64_t point_count, uint64_t count) {
    static const char *const types[] = {"UInt8", "Int8", "UInt16", "Int16", "UInt32", "Int32", "Float32", "Float64"};
    static const size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    uint32_t *tetrahedra = allocate(16 * count);
    float *points = make_values(3 * point_count), *values = make_values(2 * 2 * point_count);
    for (uint64_t i = 0; i < 4 * count; i++) tetrahedra[i] = (uint32_t)(random_u64() % point_count);
    dataset_field fields[8] = {{0}};
    for (int i = 0; i < 8; i++)
        fields[i] = (dataset_field){.name = types[i], .components = 1 + i % 2, .type = (tc_type)i, .values = values};
    complex_file c = {.point_count = point_count,
                      .points = points,
                      .tetrahedron_count = count,
                      .tetrahedra = tetrahedra,
                      .fields = fields,
                      .field_count = 8};
    EXPECT(complex_write(path_of("c.vtu"), &c) == 0, "%s", failure_text());
    size_t bytes;
    char *text = read_file(path_of("c.vtu"), &bytes);
    EXPECT(text && vtk_count(text, "NumberOfPoints") == point_count && vtk_count(text, "NumberOfCells") == count,
           "counts of %.400s", text ? text : "");
    for (int i = 0; i < 8 && text; i++) {
        vtk_values is = vtk_find(text, bytes, types[i]);
        EXPECT(vtk_holds(&is, types[i], 1 + i % 2, values, point_count * (1 + (uint64_t)i % 2) * sizes[i]),
               "field %s of %llu points", types[i], (unsigned long long)point_count);
    }
    if (text) {
        vtk_values is = vtk_find(text, bytes, "Points");
        EXPECT(vtk_holds(&is, "Float32", 3, points, 12 * point_count), "points");
        expect_cells(text, bytes, &c);
    }
    unlink(path_of("c.vtu"));
    free(text);
    free(tetrahedra);
    free(points);
    free(values);
}

int main(void) {
    random_state = 1996;
    folder_make("write-vtk");
    test_fields();
    test_ply_names();
    test_refusals();
    test_complex(5, 3);
    test_complex(1, 0);
    test_complex(0, 0);
    test_complex(100003, 300007);
    EXPECT(rmdir(folder) == 0, "files are left in %s", folder);
    return EXPECT_DONE();
}
