#include "label_files.h"

#include "exit_status.h"
#include "extract/surface_files.h"
#include "failure.h"
#include "input/input.h"
#include "mesh_write.h"
#include "output.h"
#include "terminal/notice.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static mesh_write_options write_options(const options *o) {
    return (mesh_write_options){.format = o->format,
                                .origin_at = options_given(o, "--origin-at") ? o->origin_at : NULL};
}

int label_files_check(const options *o, const dataset *d) {
    const mesh_write_options how = write_options(o);
    if (!o->output) return 0;
    int status = mesh_write_check(o->output, &how);
    if (!status && o->separate_labels && !output_is_file(o->output))
        status = fail(STATUS_USAGE, "--separate writes several files: -o %s is one stream; name files", o->output);
    if (status || o->separate_labels) return status; /* whose names are known when their labels are */
    status = input_overwrite_check(o, d, "-o", o->output);
    return status ? status : output_check(o->output);
}

char *label_file_name(const char *pattern, uint32_t label) {
    const char *percent = strchr(pattern, '%'), *slash = strrchr(pattern, '/');
    const char *dot = strrchr(slash ? slash : pattern, '.'), *at = percent ? percent : dot;
    char *path = NULL;
    if (!at) at = pattern + strlen(pattern);
    if (asprintf(&path, "%.*s%s%" PRIu32 "%s", (int)(at - pattern), pattern, percent ? "" : "_", label,
                 percent ? at + 1 : at) >= 0)
        return path;
    fail(STATUS_FAILED, "out of memory for the name of the output");
    return NULL;
}

int label_file_write(const options *o, const dataset *d, const char *path, const tc_mesh_data *mesh,
                     output_group *group) {
    mesh_write_options how = write_options(o);
    how.world = d->world;
    how.units = d->units;
    how.group = group;
    int status = input_overwrite_check(o, d, "-o", path);
    return status ? status : mesh_write(path, mesh, &how);
}

void label_files_tell(const options *o, const tc_mesh_data *mesh) {
    const mesh_write_options how = write_options(o);
    if (!o->output) return;
    if (!o->separate_labels && mesh_write_lacks_labels(o->output, &how))
        notice("%s: the format does not say which labels a triangle lies between: PLY, VTP, NPZ and VTKHDF do, or "
               "--separate writes a file for each label",
               o->output);
    if (mesh_write_is_relative(o->output, mesh, &how)) surface_files_tell_relative(mesh->origin, 0);
}
