/*
 * tune.c - a search for launch parameters, one after the other
 *
 * The search starts from what contexts launch with at present. For each parameter in turn it tries the smaller values
 * of its list, then the larger ones, each way until one is far slower; it goes through the parameters again until
 * nothing changes.
 *
 * Two sets of parameters are compared by taking turns, extraction by extraction, so that whatever else the machine does
 * meets both. The figure is the geometric mean, over all cases, of the ratio of their medians. A new set has to be
 * clearly faster twice; otherwise the old one stays. A set that is far slower in one case is given up. Every set's mesh
 * has to be the reference's.
 */
#include "tune.h"

#include "exit_status.h"
#include "failure.h"
#include "library_status.h"
#include "measure.h"
#include "mesh_check.h"
#include "progress.h"
#include "samples.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>

enum { ROUNDS_MOST = 3, VALUES_MOST = 8 };

/* Ratios of times. One set compared with itself mostly comes closer to 1 than these. */
static const double clearly_faster = 0.97, far_slower = 1.5;

/* Values that are tried, ascending; per_unit: times the device's compute units. Zeros fill up the list. */
static const struct {
    const char *name;
    size_t offset; /* in tc_tuning */
    bool per_unit;
    uint32_t values[VALUES_MOST];
} parameters[] = {
    {"work_items", offsetof(tc_tuning, work_items), false, {1, 32, 64, 128, 256}},
    {"work_groups", offsetof(tc_tuning, work_groups), true, {1, 2, 4, 8, 16, 32}},
    {"tile_bricks", offsetof(tc_tuning, tile_bricks), false, {0, 8, 32, 128, 512}},
};
enum { PARAMETERS = sizeof parameters / sizeof *parameters };

static uint32_t *tuning_value(tc_tuning *tuning, int parameter) {
    return (uint32_t *)((char *)tuning + parameters[parameter].offset);
}

/* One set of parameters: its context, and the mesh whose memory is used again. */
typedef struct setting {
    tc_tuning tuning;
    tc_context *context;
    tc_mesh *mesh;
} setting;

typedef struct tune_case {
    samples s;
    uint64_t hash; /* of the reference's mesh */
} tune_case;

typedef struct search {
    const bench_options *o;
    tc_device_info device;
    tune_case *cases;
    int case_count;
    double *times; /* room for the repeats of two settings */
    setting best;
    int tried;
} search;

/* ------------------------------------------------------------------------------------------------------- extraction */

static int setting_open(const search *s, const tc_tuning *tuning, setting *out) {
    tc_context_options options;
    tc_expert_options expert;
    tc_context_options_init(&options);
    tc_expert_options_init(&expert);
    options.expert = &expert;
    options.device = s->o->device;
    expert.work_items = tuning->work_items;
    expert.work_groups = tuning->work_groups;
    expert.tile_bricks = tuning->tile_bricks;
    options.progress = progress_update;
    *out = (setting){.tuning = {.struct_size = sizeof out->tuning}};
    int status = library_status(tc_context_create(&options, &out->context));
    return status ? status : library_status(tc_context_tuning(out->context, &out->tuning));
}

static void setting_close(setting *s) {
    tc_mesh_destroy(s->mesh);
    tc_context_destroy(s->context);
    *s = (setting){0};
}

static int extract(const search *s, tc_grid *grid, setting *with, tc_mesh_data *data) {
    tc_extract_options how;
    tc_extract_options_init(&how);
    how.isovalue = s->o->iso;
    *data = (tc_mesh_data){.struct_size = sizeof *data};
    int status = library_status(tc_extract(grid, &how, &with->mesh));
    return status ? status : library_status(tc_mesh_get(with->mesh, data));
}

static uint64_t hash_of(const tc_mesh_data *data) {
    return mesh_hash(data->positions, data->vertex_count, data->triangles, data->triangle_count);
}

/* An extraction that is compared with the reference, not timed: it builds kernels and takes memory. */
static int extract_first(const search *s, const tune_case *c, tc_grid *grid, setting *with) {
    tc_mesh_data data;
    int status = extract(s, grid, with, &data);
    if (!status && hash_of(&data) != c->hash)
        status = fail(STATUS_CHECK, "%s: with work_items %u, work_groups %u, tile_bricks %u the mesh is another one",
                      c->s.name, with->tuning.work_items, with->tuning.work_groups, with->tuning.tile_bricks);
    return status;
}

static int reference_hash(const search *s, tune_case *c) {
    tc_context_options options;
    setting reference = {0};
    tc_grid *grid = NULL;
    tc_mesh_data data;
    tc_context_options_init(&options);
    options.engine = TC_ENGINE_REFERENCE;
    options.progress = progress_update;
    int status = library_status(tc_context_create(&options, &reference.context));
    if (!status) status = library_status(tc_grid_create(reference.context, &c->s.grid, &grid));
    if (!status) status = extract(s, grid, &reference, &data);
    if (!status) c->hash = hash_of(&data);
    tc_grid_destroy(grid);
    setting_close(&reference);
    return status;
}

/* ------------------------------------------------------------------------------------------------------- comparison */

/* Extracts from a new grid, of which nothing is known; *ms NULL: checked instead of timed. */
static int extract_new(const search *s, const tune_case *c, setting *with, double *ms) {
    tc_grid *grid = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    int status = library_status(tc_grid_create(with->context, &c->s.grid, &grid));
    if (!status) status = ms ? extract(s, grid, with, &data) : extract_first(s, c, grid, with);
    if (!status && ms) *ms = data.timings.total_ms;
    tc_grid_destroy(grid);
    return status;
}

/* Median time of b's extractions, by that of a's; both take turns. */
static int case_compare(const search *s, const tune_case *c, setting *a, setting *b, double *ratio) {
    setting *both[2] = {a, b};
    int repeat = s->o->repeat, status = 0;
    for (int n = 0; n < 2 && !status; n++) status = extract_new(s, c, both[n], NULL);
    for (int turn = 0; turn < 2 * repeat && !status; turn++)
        status = extract_new(s, c, both[turn % 2], &s->times[turn % 2 * repeat + turn / 2]);
    if (!status) *ratio = spread_of(s->times + repeat, repeat).median / spread_of(s->times, repeat).median;
    return status;
}

/* *ratio: the mean over all cases; where b is far slower in one case, that of this case alone. */
static int settings_compare(const search *s, setting *a, setting *b, double *ratio) {
    double sum = 0, of_case = 1;
    for (int n = 0; n < s->case_count; n++) {
        int status = case_compare(s, &s->cases[n], a, b, &of_case);
        if (status) return status;
        sum += log(of_case);
        if (of_case > far_slower) break;
    }
    *ratio = of_case > far_slower ? of_case : exp(sum / s->case_count);
    return 0;
}

/* ----------------------------------------------------------------------------------------------------------- search */

static void show(const search *s, const tc_tuning *t, double ratio, const char *note) {
    progress_clear();
    if (!s->o->json)
        printf("  %10" PRIu32 "  %11" PRIu32 "  %11" PRIu32 "  %6.3f%s\n", t->work_items, t->work_groups,
               t->tile_bricks, ratio, note);
    fflush(stdout);
}

/* Replaces the best where the new set is clearly faster; *ratio: its time by that of the best. A set that the device
 * cannot run is passed over. */
static int candidate_try(search *s, const tc_tuning *tuning, double *ratio) {
    setting candidate;
    double again = 0;
    *ratio = 1;
    int status = setting_open(s, tuning, &candidate);
    if (!status) status = settings_compare(s, &s->best, &candidate, ratio);
    if (!status && *ratio < clearly_faster) status = settings_compare(s, &s->best, &candidate, &again);
    *ratio = fmax(*ratio, again);
    if (progress_cancelled()) status = progress_status();
    if (!status) {
        show(s, &candidate.tuning, *ratio, *ratio < clearly_faster ? "  better" : "");
        s->tried++;
    }
    if (!status && *ratio < clearly_faster) {
        setting before = s->best;
        s->best = candidate;
        candidate = before;
    }
    setting_close(&candidate);
    return status == STATUS_CHECK || progress_cancelled() ? status : 0;
}

/* From the present value of parameter n, one way through its list: up or down. */
static int parameter_search(search *s, int n, bool up, bool *changed) {
    uint32_t unit = parameters[n].per_unit ? s->device.compute_units : 1;
    uint32_t present = *tuning_value(&s->best.tuning, n);
    double ratio = 1;
    for (int step = 0; step < VALUES_MOST && ratio <= far_slower; step++) {
        int v = up ? step : VALUES_MOST - 1 - step;
        tc_tuning tuning = s->best.tuning;
        uint32_t value = parameters[n].values[v] * unit;
        if ((v && !value) || (up ? value <= present : value >= present)) continue;
        *tuning_value(&tuning, n) = value;
        int status = candidate_try(s, &tuning, &ratio);
        if (status) return status;
        *changed |= ratio < clearly_faster;
    }
    return 0;
}

static int parameters_search(search *s) {
    bool changed = true;
    int status = 0;
    for (int round = 0; round < ROUNDS_MOST && changed && !status; round++) {
        changed = false;
        for (int n = 0; n < 2 * PARAMETERS && !status; n++) status = parameter_search(s, n / 2, n % 2, &changed);
    }
    return status;
}

/* ----------------------------------------------------------------------------------------------------------- report */

static int report_best(const search *s, double ratio) {
    const tc_tuning *t = &s->best.tuning;
    if (!s->o->json) {
        printf("best: work_items %u, work_groups %u, tile_bricks %u: %.2f times as fast as before; kept\n",
               t->work_items, t->work_groups, t->tile_bricks, 1 / ratio);
        return 0;
    }
    json_t *report = json_pack("{s:s, s:s, s:i, s:i, s:i, s:i, s:f}", "device", s->device.name, "driver",
                               s->device.driver, "work_items", (int)t->work_items, "work_groups", (int)t->work_groups,
                               "tile_bricks", (int)t->tile_bricks, "tried", s->tried, "times_as_fast", 1 / ratio);
    int status = report && !json_dumpf(report, stdout, JSON_INDENT(2)) ? 0 : fail(STATUS_FAILED, "no memory to report");
    printf("\n");
    json_decref(report);
    return status;
}

/* The search's winner against what it began with, once more: noise may have led it astray. */
static int best_confirm(search *s, setting *first, double *ratio) {
    if (s->best.tuning.work_items == first->tuning.work_items &&
        s->best.tuning.work_groups == first->tuning.work_groups &&
        s->best.tuning.tile_bricks == first->tuning.tile_bricks)
        return 0;
    int status = settings_compare(s, first, &s->best, ratio);
    if (status || *ratio < 1) return status;
    setting_close(&s->best);
    s->best = *first;
    *first = (setting){0};
    *ratio = 1;
    return 0;
}

static int search_run(search *s) {
    setting first = {0};
    double ratio = 1;
    int status = setting_open(s, &(tc_tuning){0}, &s->best);
    if (!status) status = setting_open(s, &s->best.tuning, &first);
    if (!status) status = library_status(tc_context_device(first.context, &s->device));
    if (!status) status = library_status(tc_context_tuning_save(first.context)); /* fails now, not after the search */
    if (!status && !s->o->json)
        printf("%s (driver %s); times are those of the best before\n  work_items  work_groups  tile_bricks    time\n",
               s->device.name, s->device.driver);
    if (!status) show(s, &first.tuning, 1, "  at present");
    if (!status) status = parameters_search(s);
    if (!status) status = best_confirm(s, &first, &ratio);
    if (!status) status = library_status(tc_context_tuning_save(s->best.context));
    if (!status) status = report_best(s, ratio);
    setting_close(&first);
    setting_close(&s->best);
    return status;
}

static int cases_make(search *s) {
    const bench_options *o = s->o;
    int status = 0;
    if (o->input) status = samples_read(o, &s->cases[s->case_count++].s);
    for (int f = 0; f < o->field_count && !o->input; f++)
        for (int type = 0; type < o->type_count; type++)
            for (int size = 0; size < o->dims_count && !status; size++) {
                samples *made = &s->cases[s->case_count++].s;
                status = samples_describe(o->fields[f], o->dims[size], o->types[type], made);
                if (!status) samples_place(made, o->grid);
                if (!status) status = samples_make(made);
            }
    for (int n = 0; n < s->case_count && !status; n++) status = reference_hash(s, &s->cases[n]);
    return status;
}

int tune_run(const bench_options *o) {
    size_t most = o->input ? 1 : (size_t)o->field_count * (size_t)o->type_count * (size_t)o->dims_count;
    search s = {.o = o, .device = {.struct_size = sizeof s.device}};
    s.cases = calloc(most, sizeof *s.cases);
    s.times = calloc(2 * (size_t)o->repeat, sizeof *s.times);
    int status = s.cases && s.times ? cases_make(&s) : fail(STATUS_FAILED, "no memory for the cases");
    if (!status) status = search_run(&s);
    for (int n = 0; n < s.case_count; n++) samples_release(&s.cases[n].s);
    free(s.cases);
    free(s.times);
    return status;
}
