#include "surface_preview.h"

#include "exit_status.h"
#include "failure.h"
#include "surface_files.h"
#include "surface_picture.h"

#include <stdlib.h>
#include <string.h>

int preview_check(const options *o) {
    if (!o->preview) return 0;
    int status = picture_check("--preview", o->preview);
    if (!status && o->output && strcmp(o->output, o->preview) == 0)
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
