/* option_effects.c - one table: an option, and the case in which it has no effect */
#include "option_effects.h"

#include "exit_status.h"
#include "failure.h"
#include "field.h"
#include "mesh_write.h"
#include "sample_types.h"
#include "terminal/notice.h"

#include <string.h>

typedef struct situation {
    const options *o;
    const dataset *d; /* NULL: not read yet */
    int is_open;
} situation;

/* ----------------------------------------------------------------------------------------------------------- cases */

static int has_no_output(const situation *s) { return !s->o->output; }

static int has_no_file(const situation *s) { return !s->o->output && !s->o->preview; }

static int has_no_preview(const situation *s) { return !s->o->preview; }

static int has_no_file_nor_reference(const situation *s) { return has_no_file(s) && !s->o->verify; }

static int has_no_mesh(const situation *s) { return s->o->count; }

static int makes_part(const situation *s) { return s->o->part[1] != 0; }

static int file_has_no_normals(const situation *s) {
    const mesh_write_options how = {.format = s->o->format};
    return s->o->output && mesh_write_lacks(s->o->output, &how, ROLE_NORMALS);
}

static int has_no_device(const situation *s) { return s->o->engine == TC_ENGINE_REFERENCE; }

static int has_no_device_nor_stream(const situation *s) { return has_no_device(s) && !s->o->stream; }

static int is_not_raw(const situation *s) { return !options_given(s->o, "--dims"); }

static int has_bytes(const situation *s) {
    return options_given(s->o, "--dims") && s->o->type >= 0 && sample_bytes((tc_type)s->o->type) == 1;
}

static int is_not_noise(const situation *s) {
    return s->o->operand_count == 1 && field_find(s->o->operands[0]) && strcmp(s->o->operands[0], "noise") != 0;
}

static int has_no_time(const situation *s) { return s->o->timeout == 0; }

static int has_no_main_engine(const situation *s) { return s->o->engine != TC_ENGINE_OPENCL; }

static int has_cells(const situation *s) {
    for (int n = 0; n < s->d->block_count; n++)
        if (s->d->blocks[n].kind == BLOCK_UNSTRUCTURED) return 1;
    return 0;
}

static int has_only_cells(const situation *s) {
    for (int n = 0; n < s->d->block_count; n++)
        if (s->d->blocks[n].kind != BLOCK_UNSTRUCTURED) return 0;
    return s->d->block_count > 0;
}

static int has_world_range(const situation *s) { return options_given(s->o, "--roi-world"); }

static int is_everything(const situation *s) {
    return s->o->region.step[0] == 1 && s->o->region.step[1] == 1 && s->o->region.step[2] == 1;
}

static int has_no_cells(const situation *s) { return !has_cells(s); }

static int is_snap_of_cells(const situation *s) { return has_cells(s) && s->o->method == TC_METHOD_SNAP; }

static int is_not_snap(const situation *s) { return s->o->method != TC_METHOD_SNAP; }

static int is_not_simplified(const situation *s) { return !options_given(s->o, "--simplify"); }

static int has_no_field(const situation *s) { return s->is_open; }

/* ----------------------------------------------------------------------------------------------------------- table */

enum verdict { REFUSED, TOLD };
enum moment { BEFORE_READING, AFTER_READING };

typedef struct effect {
    unsigned commands;
    const char *option;
    enum moment moment;
    int (*has_no_effect)(const situation *s);
    enum verdict verdict;
    const char *text; /* behind the input's name, where that was read */
} effect;

#define NO_MESH           "--count makes no mesh: leave out "
#define NO_VOLUME         "--count makes no volume: leave out "
#define PART_OPTION(name) name " is for the mesh of all parts: give it to 'tetracubes join'"
#define NOT_RAW           " describes raw input: give --dims NX,NY,NZ too, or leave it out"
#define NOT_GRID          " is for structured grids only"
#define NO_FIELD          " is for the values of one field, and none is chosen: see --field and --component"

static const effect table[] = {
    {COMMAND_EXTRACT, "--output", BEFORE_READING, has_no_mesh, REFUSED, NO_MESH "--output, or --count"},
    {COMMAND_EXTRACT, "--preview", BEFORE_READING, has_no_mesh, REFUSED, NO_MESH "--preview, or --count"},
    {COMMAND_EXTRACT, "--verify", BEFORE_READING, has_no_mesh, REFUSED, NO_MESH "--verify, or --count"},
    {COMMAND_EXTRACT, "--check", BEFORE_READING, has_no_mesh, REFUSED, NO_MESH "--check, or --count"},
    {COMMAND_EXTRACT, "--normals", BEFORE_READING, has_no_mesh, REFUSED, NO_MESH "--normals, or --count"},
    {COMMAND_EXTRACT, "--soup", BEFORE_READING, has_no_mesh, REFUSED, NO_MESH "--soup, or --count"},
    {COMMAND_EXTRACT, "--format", BEFORE_READING, has_no_mesh, REFUSED, NO_MESH "--format, or --count"},
    {COMMAND_EXTRACT, "--blocks", BEFORE_READING, has_no_mesh, REFUSED, NO_MESH "--blocks, or --count"},
    {COMMAND_EXTRACT, "--carry", BEFORE_READING, has_no_mesh, REFUSED, NO_MESH "--carry, or --count"},
    {COMMAND_EXTRACT, "--origin-at", BEFORE_READING, has_no_mesh, REFUSED, NO_MESH "--origin-at, or --count"},
    {COMMAND_EXTRACT, "--stream", BEFORE_READING, has_no_mesh, REFUSED, NO_MESH "--stream, or --count"},
    {COMMAND_EXTRACT, "--part", BEFORE_READING, has_no_mesh, REFUSED, NO_MESH "--part, or --count"},
    {COMMAND_EXTRACT, "--drop-degenerate", BEFORE_READING, has_no_mesh, REFUSED,
     NO_MESH "--drop-degenerate, or --count"},
    {COMMAND_EXTRACT, "--simplify", BEFORE_READING, has_no_mesh, REFUSED, NO_MESH "--simplify, or --count"},

    {COMMAND_ISOVOLUME, "--output", BEFORE_READING, has_no_mesh, REFUSED, NO_VOLUME "--output, or --count"},
    {COMMAND_ISOVOLUME, "--format", BEFORE_READING, has_no_mesh, REFUSED, NO_VOLUME "--format, or --count"},
    {COMMAND_ISOVOLUME, "--verify", BEFORE_READING, has_no_mesh, REFUSED, NO_VOLUME "--verify, or --count"},
    {COMMAND_ISOVOLUME, "--check", BEFORE_READING, has_no_mesh, REFUSED, NO_VOLUME "--check, or --count"},
    {COMMAND_ISOVOLUME, "--carry", BEFORE_READING, has_no_mesh, REFUSED, NO_VOLUME "--carry, or --count"},

    {COMMAND_EXTRACT, "--carry", BEFORE_READING, has_no_output, REFUSED,
     "--carry puts fields into the mesh's file: give -o FILE"},
    {COMMAND_EXTRACT, "--part", BEFORE_READING, has_no_output, REFUSED, "--part writes a file: give -o FILE"},
    {COMMAND_EXTRACT, "--format", BEFORE_READING, makes_part, REFUSED, PART_OPTION("--format")},
    {COMMAND_EXTRACT, "--origin-at", BEFORE_READING, makes_part, REFUSED, PART_OPTION("--origin-at")},
    {COMMAND_EXTRACT, "--blocks", BEFORE_READING, has_no_file, REFUSED,
     "--blocks names files: give -o FILE or --preview FILE"},
    {COMMAND_EXTRACT | COMMAND_LABELS, "--view", BEFORE_READING, has_no_preview, REFUSED,
     "--view is of a picture: give --preview FILE"},
    {COMMAND_EXTRACT | COMMAND_INFO | COMMAND_LABELS, "--preview-size", BEFORE_READING, has_no_preview, REFUSED,
     "--preview-size is of a picture: give --preview FILE"},
    {COMMAND_INFO, "--iso", BEFORE_READING, has_no_preview, REFUSED,
     "--iso is for the isolines of a picture: give --preview FILE"},
    {COMMAND_LABELS, "--separate", BEFORE_READING, has_no_output, REFUSED, "--separate names files: give -o FILE"},
    {COMMAND_EXTRACT | COMMAND_LABELS, "--format", BEFORE_READING, has_no_output, REFUSED,
     "--format is that of the mesh's file: give -o FILE, or -o - for standard output"},
    {COMMAND_ISOVOLUME, "--format", BEFORE_READING, has_no_output, REFUSED,
     "--format is that of the tetrahedra's file: give -o FILE, or -o - for standard output"},
    {COMMAND_EXTRACT | COMMAND_LABELS, "--origin-at", BEFORE_READING, has_no_output, REFUSED,
     "--origin-at is for the coordinates in the mesh's file: give -o FILE"},
    {COMMAND_EXTRACT, "--normals", BEFORE_READING, has_no_file_nor_reference, TOLD,
     "--normals has no effect without -o FILE, nor --preview FILE, nor --verify"},
    {COMMAND_EXTRACT, "--soup", BEFORE_READING, has_no_output, TOLD,
     "--soup has no effect without -o FILE: the report is of shared vertices"},
    {COMMAND_EXTRACT, "--normals", BEFORE_READING, file_has_no_normals, TOLD,
     "--normals has no effect on STL and OFF, which hold no normals of vertices: ply, vtp, obj, glb, npz, vtkhdf and "
     "html do"},

    {MAKES, "--verify", BEFORE_READING, has_no_main_engine, REFUSED,
     "--verify compares with the reference engine: it proves nothing about that engine itself; leave out --verify or "
     "--engine"},
    {MAKES, "--device", BEFORE_READING, has_no_device, TOLD, "--device has no effect with --engine reference"},
    {COMMAND_ISOVOLUME | COMMAND_LABELS, "--max-memory", BEFORE_READING, has_no_device, TOLD,
     "--max-memory has no effect with --engine reference: it bounds memory of a device"},
    {COMMAND_EXTRACT, "--max-memory", BEFORE_READING, has_no_device_nor_stream, TOLD,
     "--max-memory has no effect with --engine reference: it bounds memory of a device, and of --stream"},

    {COMMAND_EXTRACT, "--snap", BEFORE_READING, is_not_snap, REFUSED,
     "--snap is the threshold of --method snap: give that too, or leave it out"},

    {COMMAND_EXTRACT, "--simplify-error", BEFORE_READING, is_not_simplified, REFUSED,
     "--simplify-error bounds what --simplify does: give that too, or leave it out"},

    {READS, "--type", BEFORE_READING, is_not_raw, REFUSED, "--type" NOT_RAW},
    {READS, "--endian", BEFORE_READING, is_not_raw, REFUSED, "--endian" NOT_RAW},
    {READS, "--skip", BEFORE_READING, is_not_raw, REFUSED, "--skip" NOT_RAW},
    {READS, "--endian", BEFORE_READING, has_bytes, TOLD, "--endian has no effect on samples of one byte"},
    {COMMAND_GENERATE, "--seed", BEFORE_READING, is_not_noise, TOLD, "--seed has an effect on noise alone"},

    {TAKES_PARTS, "--roi", BEFORE_READING, has_world_range, REFUSED,
     "--roi and --roi-world both choose a region: leave one out"},
    {TAKES_PARTS, "--step", BEFORE_READING, is_everything, TOLD, "--step 1 takes every sample: it has no effect"},

    {COMMAND_SELFTEST, "--timeout", BEFORE_READING, has_no_time, REFUSED,
     "--timeout 0 leaves no time for a trial; leave it out for no limit"},

    {COMMAND_EXTRACT, "--normals", AFTER_READING, has_cells, REFUSED,
     "is unstructured: --normals are made of structured grids only"},
    {COMMAND_EXTRACT, "--method", AFTER_READING, is_snap_of_cells, REFUSED,
     "is unstructured: --method snap is for structured grids only"},
    {TAKES_PARTS, "--roi", AFTER_READING, has_cells, REFUSED, "is unstructured: --roi" NOT_GRID},
    {TAKES_PARTS, "--roi-world", AFTER_READING, has_cells, REFUSED, "is unstructured: --roi-world" NOT_GRID},
    {TAKES_PARTS, "--step", AFTER_READING, has_cells, REFUSED, "is unstructured: --step" NOT_GRID},
    {TAKES_PARTS, "--mask", AFTER_READING, has_cells, REFUSED, "is unstructured: --mask" NOT_GRID},
    {COMMAND_EXTRACT | COMMAND_ISOVOLUME | COMMAND_TETRAHEDRALIZE, "--skip-unsupported", AFTER_READING, has_no_cells,
     TOLD, "is structured: it has no cells that --skip-unsupported could leave out"},
    {COMMAND_TETRAHEDRALIZE, "--nodata", AFTER_READING, has_no_field, REFUSED, "--nodata" NO_FIELD},
    {COMMAND_TETRAHEDRALIZE, "--component", AFTER_READING, has_no_field, REFUSED, "--component" NO_FIELD},
    {COMMAND_INFO, "--preview", AFTER_READING, has_only_cells, REFUSED,
     "is unstructured: --preview of info shows slices of structured grids only; extract --preview shows surfaces"},
    {COMMAND_INFO, "--preview", AFTER_READING, has_no_field, REFUSED, "--preview" NO_FIELD},
    {COMMAND_INFO, "--nodata", AFTER_READING, has_no_field, TOLD, "--nodata" NO_FIELD},
    {COMMAND_INFO, "--mask", AFTER_READING, has_no_field, TOLD, "--mask" NO_FIELD},
    {COMMAND_INFO, "--component", AFTER_READING, has_no_field, TOLD, "--component" NO_FIELD},
};

static int check(const situation *s) {
    const enum moment moment = s->d ? AFTER_READING : BEFORE_READING;
    const char *input = s->d ? s->o->operands[0] : "", *separator = s->d ? ": " : "";
    for (int verdict = REFUSED; verdict <= TOLD; verdict++) /* no notice of a run that is refused */
        for (const effect *e = table; e < table + sizeof table / sizeof *table; e++) {
            if (!(e->commands & s->o->bit) || e->moment != moment || (int)e->verdict != verdict) continue;
            if (!options_given(s->o, e->option) || !e->has_no_effect(s)) continue;
            if (verdict == REFUSED) return fail(STATUS_USAGE, "%s%s%s", input, separator, e->text);
            notice("%s%s%s", input, separator, e->text);
        }
    return 0;
}

int option_effects_check(const options *o) { return check(&(situation){.o = o}); }

int option_effects_check_input(const options *o, const dataset *d, int is_open) {
    return check(&(situation){.o = o, .d = d, .is_open = is_open});
}
