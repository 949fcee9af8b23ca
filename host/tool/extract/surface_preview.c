#include "surface_preview.h"

#include "exit_status.h"
#include "failure.h"
#include "surface_files.h"
#include "surface_picture.h"

#include <stdlib.h>
#include <string.h>

/* The folder of a path as the system knows it, from malloc; NULL where there is none, or no memory. */
static char *folder_of(const char *path) {
    const char *slash = strrchr(path, '/');
    char *name = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup("."), *folder = NULL;
    if (name) folder = realpath(name, NULL);
    free(name);
    return folder;
}

/* Whether two names are one file's, as ./a.png and a.png are. */
static int names_one_file(const char *a, const char *b) {
    const char *name_a = strrchr(a, '/'), *name_b = strrchr(b, '/');
    if (strcmp(name_a ? name_a + 1 : a, name_b ? name_b + 1 : b) != 0) return 0;
    char *folder_a = folder_of(a), *folder_b = folder_of(b);
    const int is_one = folder_a && folder_b ? strcmp(folder_a, folder_b) == 0 : strcmp(a, b) == 0;
    free(folder_a);
    free(folder_b);
    return is_one;
}

int preview_check(const options *o) {
    if (!o->preview) return 0;
    int status = picture_check("--preview", o->preview);
    if (!status && o->output && names_one_file(o->output, o->preview))
        status = fail(STATUS_USAGE, "-o and --preview both name %s: name two files", o->output);
    return status;
}

int surface_preview_check(const options *o, const dataset *d) {
    const int status = preview_check(o);
    return status || !o->preview ? status : surface_names_check(o, d, "--preview", o->preview);
}

int preview_write(const options *o, const char *path, const tc_mesh_data *mesh, const mesh_part *parts, int part_count,
                  output_group *group) {
    picture p = {0};
    int status = picture_make(&p, (int)o->preview_size[0], (int)o->preview_size[1]);
    if (!status) status = surface_picture(mesh, parts, part_count, o->view, &p);
    if (!status) status = picture_write(&p, path, group);
    picture_release(&p);
    return status;
}

int surface_preview_write(const options *o, const typed_isovalue *iso, int block, const result_mesh *mesh,
                          output_group *group) {
    char *path = surface_file_name(o, o->preview, iso, block);
    const int status = path ? preview_write(o, path, &mesh->mesh, mesh->parts, mesh->part_count, group) : STATUS_FAILED;
    free(path);
    return status;
}
