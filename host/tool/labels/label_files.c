#include "label_files.h"

#include "command_line/name_pattern.h"
#include "exit_status.h"
#include "extract/surface_files.h"
#include "extract/surface_preview.h"
#include "failure.h"
#include "input/input.h"
#include "mesh_write.h"
#include "output.h"
#include "terminal/notice.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static mesh_write_options write_options(const options *o, int suits_world) {
    return (mesh_write_options){.format = o->format, .origin_at = surface_file_zero(o, suits_world)};
}

/* Of one file of all labels, in whose name no label has a placeholder; option: which names it. */
static int check_one_file(const options *o, const dataset *d, const char *option, const char *name) {
    if (name_pattern_has_placeholder(name))
        return fail(STATUS_USAGE,
                    "%s %s: %% stands for a label, and one file has all: %sa percent sign in the name is typed %%%%",
                    option, name, name == o->output ? "--separate writes a file for each label; " : "");
    char *path = name_pattern_fill(name, "", "");
    int status = path ? input_overwrite_check(o, d, option, path) : STATUS_FAILED;
    if (!status) status = output_check(path);
    free(path);
    return status;
}

int label_files_check(const options *o, const dataset *d) {
    const mesh_write_options how = write_options(o, 0);
    int status = preview_check(o);
    if (!status && o->preview) status = check_one_file(o, d, "--preview", o->preview);
    if (status || !o->output) return status;
    status = mesh_write_check(o->output, &how);
    if (!status && o->separate_labels && !output_is_file(o->output))
        status = fail(STATUS_USAGE, "--separate writes several files: -o %s is one stream; name files", o->output);
    if (status || o->separate_labels) return status; /* whose names are known when their labels are */
    return check_one_file(o, d, "-o", o->output);
}

char *label_file_name(const options *o, uint32_t label) {
    char value[16], behind[17] = "";
    snprintf(value, sizeof value, "%" PRIu32, label);
    if (o->separate_labels && !name_pattern_has_placeholder(o->output)) snprintf(behind, sizeof behind, "_%s", value);
    return name_pattern_fill(o->output, value, behind);
}

int label_file_write(const options *o, const dataset *d, int suits_world, const char *path, const tc_mesh_data *mesh,
                     output_group *group) {
    mesh_write_options how = write_options(o, suits_world);
    how.world = d->world;
    how.units = d->units;
    how.group = group;
    int status = input_overwrite_check(o, d, "-o", path);
    return status ? status : mesh_write(path, mesh, &how);
}

char *label_preview_name(const options *o) { return name_pattern_fill(o->preview, "", ""); }

void label_files_tell(const options *o, int suits_world, const tc_mesh_data *mesh) {
    const mesh_write_options how = write_options(o, suits_world);
    if (!o->output) return;
    if (!o->separate_labels && mesh_write_lacks_labels(o->output, &how))
        notice("%s: the format does not say which labels a triangle lies between: PLY, VTP, NPZ and VTKHDF do, GLB and "
               "HTML show them, or "
               "--separate writes a file for each label",
               o->output);
    if (mesh_write_is_relative(o->output, mesh, &how)) surface_files_tell_relative(mesh->origin, 0);
}
