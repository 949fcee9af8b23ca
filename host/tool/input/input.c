#include "input.h"

#include "dataset/region.h"
#include "exit_status.h"
#include "failure.h"
#include "library_status.h"
#include "mask.h"
#include "output.h"
#include "read.h"
#include "shortest.h"
#include "statistics.h"
#include "terminal/notice.h"
#include "used_points.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static int check_operands(const options *o) {
    if (o->operand_count == 0)
        return fail(STATUS_USAGE, "%s needs an input file; see 'tetracubes %s --help'", o->command, o->command);
    if (o->operand_count > 2)
        return fail(
            STATUS_USAGE,
            "%s: one input at a time, or the two files of Plot3D; '%s' is a third. Slices of TIFF are one input: "
            "their folder, or 'slices/%%04d.tif' for numbered names",
            o->command, o->operands[2]);
    if (o->operand_count == 2 && options_given(o, "--dims"))
        return fail(STATUS_USAGE, "%s: raw input is one file; '%s' is a second one", o->command, o->operands[1]);
    return 0;
}

int input_request(const options *o, read_request *request) {
    int status = check_operands(o), is_raw = options_given(o, "--dims");
    if (status) return status;
    if (is_raw && o->type < 0) return fail(STATUS_USAGE, "raw input needs --type beside --dims, as in --type u8");
    if (o->mask && strcmp(o->mask, "-") == 0 && strcmp(o->operands[0], "-") == 0)
        return fail(STATUS_USAGE, "--mask -: standard input is the volume; name a file");
    read_request_init(request, o->operands[0]);
    if (o->operand_count > 1) request->path2 = o->operands[1];
    for (int axis = 0; axis < 3; axis++) {
        request->dims[axis] = o->dims[axis];
        request->spacing[axis] = o->spacing[axis];
        request->origin[axis] = o->origin[axis];
    }
    request->has_spacing = options_given(o, "--spacing");
    request->has_origin = options_given(o, "--origin");
    request->type = o->type;
    request->big_endian = o->big_endian;
    request->skip = o->skip;
    request->component = o->component;
    request->frame = o->frame;
    request->field = o->field;
    request->has_nodata = o->has_nodata;
    request->nodata = o->nodata;
    request->region = o->region;
    request->region.has_indices = options_given(o, "--roi");
    request->region.has_world = options_given(o, "--roi-world");
    request->mask = o->mask;
    return 0;
}

int input_read(const read_request *request, dataset *d) {
    int status = dataset_read(request, d);
    for (int n = 0; !status && n < d->notice_count; n++) notice("%s: %s", request->path, d->notices[n]);
    return status;
}

void input_tell_average(const dataset *d, const char *name) {
    notice("field '%s' is of cells: averaged to the points between them%s", name,
           d->block_count > 1 ? ", in each piece alone: surfaces of neighbouring pieces may not meet" : "");
}

void input_tell_rounded(const char *name) {
    notice("field '%s' has 64-bit integers that no double holds: each is taken as the nearest double", name);
}

int input_select(const read_request *request, dataset *d, scalar *out) {
    int status = scalar_select(d, request, out);
    if (!status && out->is_active && !request->describe)
        notice("%s: holds several fields: '%s' is taken, its active scalars; --field takes another", request->path,
               out->name);
    if (!status && out->is_rounded) input_tell_rounded(out->name);
    if (!status && out->is_averaged) input_tell_average(d, out->name);
    if (!status && request->has_nodata && !out->has_nodata)
        notice("--nodata %s: no %s of %s%s%s equals it: nothing is left out", shortest_number(request->nodata).text,
               out->is_averaged ? "cell's value" : "sample", out->name[0] ? "field '" : "the input", out->name,
               out->name[0] ? "'" : "");
    return status || !request->mask ? status : mask_apply(request, d, out);
}

int input_take_parts(dataset *d) {
    int status = 0;
    for (int n = 0; n < d->block_count; n++)
        for (int m = 0; m < d->blocks[n].field_count && !status; m++)
            status = region_field(d, &d->blocks[n], &d->blocks[n].fields[m], &d->blocks[n].fields[m]);
    return status;
}

/* Room for the arrays and behind them for a byte per point. */
static sample_array *allocate_samples(const dataset *d, uint8_t **used) {
    size_t points = 0, count = (size_t)d->block_count + 1;
    for (int n = 0; n < d->block_count; n++) points += (size_t)d->blocks[n].point_count;
    sample_array *arrays = calloc(count * sizeof *arrays + points, 1);
    if (!arrays) fail(STATUS_FAILED, "out of memory for %d blocks", d->block_count);
    *used = (uint8_t *)(arrays ? arrays + count : NULL);
    return arrays;
}

sample_array *input_samples(const dataset *d, const scalar *field) {
    uint8_t *used;
    sample_array *arrays = allocate_samples(d, &used);
    int is_any_used = 0;
    for (int n = 0; arrays && n < d->block_count; n++) {
        const scalar_block *b = &field->blocks[n];
        arrays[n] = (sample_array){.type = b->type,
                                   .samples = b->samples,
                                   .count = (uint64_t)d->blocks[n].point_count,
                                   .blanked = b->blanked_points,
                                   .has_nodata = b->has_nodata,
                                   .nodata = b->nodata};
        const enum point_use use = used_points_mark(&d->blocks[n], b->blanked_cells, used);
        if (use != POINTS_ALL_USED) arrays[n].used = used;
        is_any_used |= use != POINTS_NONE_USED;
        used += d->blocks[n].point_count;
    }
    for (int n = 0; arrays && n < d->block_count && !is_any_used; n++) arrays[n].used = NULL;
    return arrays;
}

int input_overwrite_check(const options *o, const dataset *d, const char *option, const char *path) {
    struct stat in, out;
    if (output_is_dash(path)) return 0;
    for (int n = 0; n < o->operand_count; n++) {
        if (stat(o->operands[n], &in) || stat(path, &out)) continue;
        if (in.st_dev == out.st_dev && in.st_ino == out.st_ino && S_ISREG(in.st_mode))
            return fail(STATUS_USAGE, "%s %s is the input itself: name another file", option, path);
    }
    if (o->mask && !stat(o->mask, &in) && !stat(path, &out) && in.st_dev == out.st_dev && in.st_ino == out.st_ino &&
        S_ISREG(in.st_mode))
        return fail(STATUS_USAGE, "%s %s is the mask itself: name another file", option, path);
    if (d && file_list_has(&d->files, path))
        return fail(STATUS_USAGE, "%s %s is a file that the input names, read as part of it: name another file", option,
                    path);
    return 0;
}

int input_has_choice(const read_request *request, const dataset *d, int *has) {
    const char **names;
    int count = common_field_names(d, &names);
    if (count < 0) return STATUS_FAILED;
    int is_plain =
        count == 1 && (request->component != COMPONENT_OPEN || block_field(d->blocks, names[0])->components == 1);
    free(names);
    *has = request->field || is_plain;
    return 0;
}

int input_status(const options *o, tc_status status) {
    int of_input = status == TC_ERROR_DATA || (status == TC_ERROR_ARGUMENT && !options_given(o, "--dims"));
    return of_input ? fail(STATUS_INPUT, "%s: %s", o->operands[0], tc_message()) : library_status(status);
}
