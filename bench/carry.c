/*
 * carry.c - tetracubes-bench-carry: how long it takes to carry a field, beside the emission of the surface
 *
 * Carrying reads a field of one float32 at both ends of every crossed edge and interpolates. Every case is verified
 * first: the carried values have to be those of the scalar reference, bit for bit. Then extraction into a kept mesh and
 * carrying take turns, so that a busy moment meets both.
 */
#include "exit_status.h"
#include "failure.h"
#include "field.h"
#include "progress.h"
#include "spread.h"
#include "tetracubes.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "tetracubes-bench-carry [--json] [N [REPEATS]]: carries a field onto surfaces of sphere and\n"
    "gyroid, N^3 samples (256) of f32 and u8, REPEATS times (31)\n";

typedef struct carry_options {
    int json, help;
    int size, repeats; /* samples along an axis; timed turns */
} carry_options;

typedef struct carry_result {
    const field *field;
    tc_type type;
    int size, repeats;
    uint64_t vertex_count;
    spread emit_ms, carry_ms;
    double reference_ms; /* carrying by the reference, once */
} carry_result;

/* What turns of one engine leave. */
typedef struct turns {
    int count;
    double *emit_ms, *carry_ms; /* of each turn */
    float *values;              /* carried last, one per vertex */
    uint64_t vertex_count;
} turns;

/* ----------------------------------------------------------------------------------------------------------- turns */

static int no_memory(void) { return fail(STATUS_FAILED, "no memory for the measurement; give a smaller N"); }

static int library_failed(void) { return fail(STATUS_FAILED, "%s", tc_message()); }

/* Extracts, then carries. The first turn, -1, is not timed: it makes the memory that is kept. */
static int turn_run(tc_grid *grid, const tc_extract_options *how, const tc_field *carried, int n, tc_mesh **mesh,
                    turns *t) {
    tc_mesh_data data = {.struct_size = sizeof data};
    if (tc_extract(grid, how, mesh) || tc_mesh_get(*mesh, &data)) return library_failed();
    if (!t->values && !(t->values = calloc((size_t)data.vertex_count + 1, sizeof *t->values))) return no_memory();
    const double start = now_ms();
    if (tc_interpolate_field(grid, how, carried, t->values, data.vertex_count)) return library_failed();
    if (n >= 0) {
        t->emit_ms[n] = data.timings.emit_ms;
        t->carry_ms[n] = now_ms() - start;
    }
    t->vertex_count = data.vertex_count;
    return 0;
}

static int turns_run(tc_engine engine, const tc_grid_options *volume, double isovalue, const tc_field *carried,
                     turns *t) {
    tc_context_options device;
    tc_extract_options how;
    tc_context *context = NULL;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_context_options_init(&device);
    tc_extract_options_init(&how);
    device.engine = engine;
    how.isovalue = isovalue;
    t->emit_ms = calloc((size_t)t->count, sizeof *t->emit_ms);
    t->carry_ms = calloc((size_t)t->count, sizeof *t->carry_ms);
    int status = t->emit_ms && t->carry_ms ? 0 : no_memory();
    if (!status && (tc_context_create(&device, &context) || tc_grid_create(context, volume, &grid)))
        status = library_failed();
    for (int n = -1; n < t->count && !status; n++) status = turn_run(grid, &how, carried, n, &mesh, t);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
    return status;
}

static void turns_release(turns *t) {
    free(t->emit_ms);
    free(t->carry_ms);
    free(t->values);
}

/* ----------------------------------------------------------------------------------------------------------- cases */

static int case_measure(const tc_grid_options *volume, const tc_field *carried, carry_result *out) {
    turns device = {.count = out->repeats}, reference = {.count = 1};
    const double isovalue = out->field->isovalue;
    int status = turns_run(TC_ENGINE_OPENCL, volume, isovalue, carried, &device);
    if (!status) status = turns_run(TC_ENGINE_REFERENCE, volume, isovalue, carried, &reference);
    if (!status && (device.vertex_count != reference.vertex_count ||
                    memcmp(device.values, reference.values, device.vertex_count * sizeof *device.values) != 0))
        status = fail(STATUS_CHECK, "%s %d^3 %s: verification failed: the carried values are not the reference's",
                      out->field->name, out->size, tc_type_name(out->type));
    if (!status) {
        out->vertex_count = device.vertex_count;
        out->emit_ms = spread_of(device.emit_ms, device.count);
        out->carry_ms = spread_of(device.carry_ms, device.count);
        out->reference_ms = reference.carry_ms[0];
    }
    turns_release(&device);
    turns_release(&reference);
    return status;
}

static int case_run(const carry_options *o, const field *f, tc_type type, carry_result *out) {
    const size_t count = (size_t)o->size * (size_t)o->size * (size_t)o->size;
    void *samples = malloc(count * tc_type_bytes(type));
    float *carried_values = malloc(count * sizeof *carried_values);
    *out = (carry_result){.field = f, .type = type, .size = o->size, .repeats = o->repeats};
    int status = samples && carried_values ? 0 : no_memory();
    if (!status) {
        const tc_field carried = {sizeof carried, TC_F32, 1, carried_values};
        tc_grid_options volume;
        tc_grid_options_init(&volume);
        for (int axis = 0; axis < 3; axis++) volume.dims[axis] = o->size;
        volume.type = type;
        volume.samples = samples;
        field_sample(f, volume.dims, type, 0, 0, o->size, samples);
        for (size_t n = 0; n < count; n++) carried_values[n] = (float)(n % 1000003);
        status = case_measure(&volume, &carried, out);
    }
    free(samples);
    free(carried_values);
    return status;
}

/* ---------------------------------------------------------------------------------------------------------- report */

static json_t *spread_json(spread s) {
    return json_pack("{s:f, s:f, s:f}", "median", s.median, "min", s.min, "max", s.max);
}

static json_t *result_json(const carry_result *r) {
    return json_pack("{s:s, s:[i, i, i], s:s, s:I, s:i, s:o, s:o, s:f}", "field", r->field->name, "dims", r->size,
                     r->size, r->size, "type", tc_type_name(r->type), "vertices", (json_int_t)r->vertex_count,
                     "repeats", r->repeats, "emit_ms", spread_json(r->emit_ms), "carry_ms", spread_json(r->carry_ms),
                     "reference_ms", r->reference_ms);
}

static void print_row(const carry_result *r) {
    printf("%-8s %d^3 %s: emit %.2f ms (least %.2f), carry %.2f ms (%.2f), ratio %.2f (%.2f); reference %.0f ms\n",
           r->field->name, r->size, tc_type_name(r->type), r->emit_ms.median, r->emit_ms.min, r->carry_ms.median,
           r->carry_ms.min, r->carry_ms.median / r->emit_ms.median, r->carry_ms.min / r->emit_ms.min, r->reference_ms);
    fflush(stdout);
}

static int cases_run(const carry_options *o) {
    static const char *const names[] = {"sphere", "gyroid"};
    static const tc_type types[] = {TC_F32, TC_U8};
    json_t *cases = json_array();
    carry_result result;
    int status = 0;
    for (int n = 0; n < 4 && !status; n++) {
        status = case_run(o, field_find(names[n / 2]), types[n % 2], &result);
        if (!status && o->json) json_array_append_new(cases, result_json(&result));
        if (!status && !o->json) print_row(&result);
    }
    json_t *report = json_pack("{s:o}", "cases", cases);
    if (!status && o->json && json_dumpf(report, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(6)))
        status = fail(STATUS_FAILED, "could not print the report: out of memory, or standard output is full");
    if (!status && o->json) printf("\n");
    json_decref(report);
    return status;
}

/* ------------------------------------------------------------------------------------------------------------ main */

static int parse_number(const char *text, int least, int most, int *number) {
    char *end;
    const long value = strtol(text, &end, 10);
    *number = (int)value;
    if (end != text && !*end && value >= least && value <= most) return 0;
    return fail(STATUS_USAGE, "'%s' is no whole number from %d to %d; see --help", text, least, most);
}

static int options_parse(int argc, char **argv, carry_options *o) {
    int numbers = 0;
    *o = (carry_options){.size = 256, .repeats = 31};
    for (int n = 1; n < argc; n++) {
        int status = 0;
        if (!strcmp(argv[n], "--json"))
            o->json = 1;
        else if (!strcmp(argv[n], "--help"))
            o->help = 1;
        else if (numbers == 2)
            status = fail(STATUS_USAGE, "'%s' is one argument too many; see --help", argv[n]);
        else
            status =
                numbers++ ? parse_number(argv[n], 1, 100000, &o->repeats) : parse_number(argv[n], 2, 2048, &o->size);
        if (status) return status;
    }
    return 0;
}

int main(int argc, char **argv) {
    carry_options o;
    int status = options_parse(argc, argv, &o);
    if (!status && o.help)
        fputs(usage, stdout);
    else if (!status)
        status = cases_run(&o);
    if (status) fprintf(stderr, "tetracubes-bench-carry: %s\n", failure_text());
    return status;
}
