/*
 * mesh_files.c - the tool's writers, its hash and its pictures, for the Python package: files have the same bytes as
 * the tool's
 */
#include "dataset/dataset.h"
#include "exit_status.h"
#include "failure.h"
#include "mesh_check.h"
#include "mesh_write.h"
#include "surface_picture.h"

#include <stdlib.h>

#define FILES_API __attribute__((visibility("default")))

FILES_API uint64_t mesh_files_hash(const tc_mesh_data *mesh);
FILES_API int mesh_files_save(const char *path, const char *format, const tc_mesh_data *mesh, int field_count,
                              const char *const *names, const int *components, const float *const *values,
                              const double *origin_at, int *is_relative);
FILES_API int mesh_files_save_complex(const char *path, const char *format, const complex_file *complex,
                                      int field_count, const char *const *names, const int *components,
                                      const float *const *values);
FILES_API const char *mesh_files_view(int n, view_angles *angles);
FILES_API int mesh_files_draw(const tc_mesh_data *mesh, view_angles angles, int width, int height,
                              unsigned char *pixels);
FILES_API int mesh_files_save_picture(const char *path, int width, int height, unsigned char *pixels);
FILES_API const char *mesh_files_message(void);

uint64_t mesh_files_hash(const tc_mesh_data *mesh) {
    return mesh_hash(mesh->positions, mesh->vertex_count, mesh->triangles, mesh->triangle_count);
}

/* Returns a status of exit_status.h. origin_at: as of mesh_write_options. *is_relative: whether the file's coordinates
 * are relative to the mesh's origin. */
int mesh_files_save(const char *path, const char *format, const tc_mesh_data *mesh, int field_count,
                    const char *const *names, const int *components, const float *const *values,
                    const double *origin_at, int *is_relative) {
    vertex_array *fields = calloc((size_t)field_count + 1, sizeof *fields);
    mesh_write_options options = {
        .format = format, .fields = fields, .field_count = field_count, .origin_at = origin_at};
    if (!fields) return fail(STATUS_FAILED, "out of memory for %d fields", field_count);
    for (int n = 0; n < field_count; n++) fields[n] = (vertex_array){names[n], components[n], values[n], ROLE_DATA};
    int status = mesh_write_check(path, &options);
    if (!status) status = mesh_write(path, mesh, &options);
    *is_relative = !status && mesh_write_is_relative(path, mesh, &options);
    free(fields);
    return status;
}

/* The complex is given without its fields. */
int mesh_files_save_complex(const char *path, const char *format, const complex_file *complex, int field_count,
                            const char *const *names, const int *components, const float *const *values) {
    complex_file file = *complex;
    dataset_field *fields = calloc((size_t)field_count + 1, sizeof *fields);
    if (!fields) return fail(STATUS_FAILED, "out of memory for %d fields", field_count);
    for (int n = 0; n < field_count; n++)
        fields[n] = (dataset_field){.name = names[n], .components = components[n], .type = TC_F32, .values = values[n]};
    file.fields = fields;
    file.field_count = field_count;
    int status = complex_write_check(path, format);
    if (!status) status = complex_write(path, &file);
    free(fields);
    return status;
}

/* The name of view n and its angles; behind the last NULL, and the angles where none is chosen. */
const char *mesh_files_view(int n, view_angles *angles) {
    const char *name = view_name(n);
    *angles = name ? view_named(n) : VIEW_DEFAULT;
    return name;
}

/* pixels: 3 bytes each, row by row from the top, white before. */
int mesh_files_draw(const tc_mesh_data *mesh, view_angles angles, int width, int height, unsigned char *pixels) {
    picture p = {width, height, pixels};
    return surface_picture(mesh, NULL, 0, angles, &p);
}

int mesh_files_save_picture(const char *path, int width, int height, unsigned char *pixels) {
    const picture p = {width, height, pixels};
    int status = picture_check("picture", path);
    return status ? status : picture_write(&p, path, NULL);
}

const char *mesh_files_message(void) { return failure_text(); }
