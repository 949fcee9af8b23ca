/*
 * generate.c - an analytic field to a NRRD file, or to samples alone
 *
 * Made and written some planes at a time. The header is padded with a comment so that samples start at a multiple of
 * ALIGNMENT: a mapped file can then be used by a device in place.
 */
#include "commands.h"
#include "exit_status.h"
#include "failure.h"
#include "field.h"
#include "output.h"
#include "progress.h"
#include "similar_name.h"
#include "stored_types.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define ALIGNMENT   128
#define CHUNK_BYTES ((uint64_t)32 << 20)
#define AXIS_LIMIT  ((int64_t)1 << 24) /* the library's */

typedef struct recipe {
    const field *f;
    const options *o;
    int has_header;
    uint64_t plane_bytes;
} recipe;

void generate_help(FILE *out) {
    fprintf(out, "\nFields, with x, y, z from -1 to 1:\n");
    for (const field *f = fields; f->name; f++) fprintf(out, "  %-15s %s\n", f->name, f->definition);
    fprintf(out, "\nA good isovalue for all of them is 127.5 (for i8, which ends at 127, 64).\n");
}

static int unknown_field(const char *name) {
    const char *names[32] = {NULL};
    char all[256] = "";
    size_t count = 0;
    for (const field *f = fields; f->name; f++) {
        size_t used = strlen(all);
        snprintf(all + used, sizeof all - used, "%s%s", count ? ", " : "", f->name);
        names[count++] = f->name;
    }
    const char *meant = similar_name(name, names, count);
    return fail(STATUS_USAGE, "there is no field '%s'%s%s%s fields are %s", name, meant ? "; did you mean " : ";",
                meant ? meant : "", meant ? "? The" : "", all);
}

static int check_dims(const options *o, uint64_t *plane_bytes) {
    uint64_t bytes = tc_type_bytes((tc_type)o->type);
    for (int axis = 0; axis < 3; axis++) {
        if (o->dims[axis] > AXIS_LIMIT || bytes > (uint64_t)INT64_MAX / (uint64_t)o->dims[axis])
            return fail(STATUS_USAGE,
                        "--dims: %" PRId64 ",%" PRId64 ",%" PRId64 " is too large; an axis has at most "
                        "%" PRId64 " samples, a file 2^63 bytes",
                        o->dims[0], o->dims[1], o->dims[2], AXIS_LIMIT);
        bytes *= (uint64_t)o->dims[axis];
    }
    *plane_bytes = bytes / (uint64_t)o->dims[2];
    return 0;
}

static int check_usage(const options *o, recipe *r) {
    *r = (recipe){.o = o};
    if (o->operand_count == 0) return fail(STATUS_USAGE, "generate needs a field; see 'tetracubes generate --help'");
    if (o->operand_count > 1)
        return fail(STATUS_USAGE, "generate makes one field; '%s' is a second one", o->operands[1]);
    r->f = field_find(o->operands[0]);
    if (!r->f) return unknown_field(o->operands[0]);
    if (!options_given(o, "--dims")) return fail(STATUS_USAGE, "generate needs --dims NX,NY,NZ, as in --dims 64,64,64");
    if (o->type < 0) return fail(STATUS_USAGE, "generate needs --type, as in --type u8");
    if (!o->output) return fail(STATUS_USAGE, "generate needs -o FILE, ending in .nrrd or .raw");
    const char *ending = strrchr(o->output, '.');
    if (output_is_dash(o->output)) ending = ".nrrd";
    r->has_header = !ending || strcasecmp(ending, ".raw") != 0;
    if (r->has_header && (!ending || strcasecmp(ending, ".nrrd") != 0))
        return fail(STATUS_USAGE, "-o %s: generate writes .nrrd, or .raw without a header", o->output);
    return check_dims(o, &r->plane_bytes);
}

static double step(int64_t n) { return n > 1 ? 2.0 / (double)(n - 1) : 1.0; }

static double start(int64_t n) { return n > 1 ? -1.0 : 0.0; }

static void write_header(const recipe *r, output *out) {
    const char *native = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__ ? "big" : "little";
    const int64_t *n = r->o->dims;
    char text[1024], padding[ALIGNMENT + 2];
    const char *type = stored_types[r->o->type].nrrd + 1; /* the first of its names */
    int length = snprintf(text, sizeof text,
                          "NRRD0004\n# %s: %s\n"
                          "type: %.*s\ndimension: 3\nsizes: %" PRId64 " %" PRId64 " %" PRId64 "\n"
                          "space dimension: 3\nspace directions: (%.17g,0,0) (0,%.17g,0) (0,0,%.17g)\n"
                          "space origin: (%.17g,%.17g,%.17g)\nendian: %s\nencoding: raw\n",
                          r->f->name, r->f->definition, (int)strcspn(type, "|"), type, n[0], n[1], n[2], step(n[0]),
                          step(n[1]), step(n[2]), start(n[0]), start(n[1]), start(n[2]), native);
    int pad = ALIGNMENT - (length + 1) % ALIGNMENT; /* the line to add, its end included; the empty line is the + 1 */
    if (pad == 1) pad += ALIGNMENT;
    memset(padding, '.', sizeof padding);
    padding[0] = '#';
    output_bytes(out, text, (uint64_t)length);
    output_bytes(out, padding, (uint64_t)pad - 1);
    output_bytes(out, "\n\n", 2);
}

/* Makes and writes all planes; an error of the output or a signal ends it early. */
static void write_planes(const recipe *r, char *chunk, int64_t chunk_planes, output *out) {
    const options *o = r->o;
    for (int64_t z = 0; z < o->dims[2] && !out->error; z += chunk_planes) {
        int64_t end = o->dims[2] - z < chunk_planes ? o->dims[2] : z + chunk_planes;
        field_sample(r->f, o->dims, (tc_type)o->type, o->seed, z, end, chunk);
        output_bytes(out, chunk, (uint64_t)(end - z) * r->plane_bytes);
        if (progress_update(NULL, "generate", (double)end / (double)o->dims[2])) out->error = ECANCELED;
    }
}

int generate_run(const options *o) {
    recipe r;
    output out;
    int status = check_usage(o, &r);
    if (status) return status;
    /* A plane has samples: see check_usage. NOLINTNEXTLINE(clang-analyzer-core.DivideZero) */
    int64_t chunk_planes = r.plane_bytes < CHUNK_BYTES ? (int64_t)(CHUNK_BYTES / r.plane_bytes) : 1;
    if (chunk_planes > o->dims[2]) chunk_planes = o->dims[2];
    char *chunk = malloc((size_t)r.plane_bytes * (size_t)chunk_planes);
    if (!chunk) return fail(STATUS_FAILED, "out of memory for planes of %" PRIu64 " bytes", r.plane_bytes);
    status = output_open(&out, o->output);
    if (status) goto cleanup;
    if (r.has_header) write_header(&r, &out);
    write_planes(&r, chunk, chunk_planes, &out);
    status = output_close(&out);
    if (!status && !o->quiet)
        printf("%s: %s, %" PRId64 " x %" PRId64 " x %" PRId64 " %s\n",
               output_is_dash(o->output) ? "standard output" : o->output, r.f->name, o->dims[0], o->dims[1], o->dims[2],
               tc_type_name((tc_type)o->type));
cleanup:
    free(chunk);
    return status;
}
