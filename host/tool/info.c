/* info.c - what an input holds: blocks and fields; range, histogram and isovalues worth trying of the chosen one */
#include "command_line/option_effects.h"
#include "commands.h"
#include "counted.h"
#include "exit_status.h"
#include "failure.h"
#include "info/describe_blocks.h"
#include "info/no_surface.h"
#include "info/open_choices.h"
#include "info/slice_preview.h"
#include "input/input.h"
#include "input/region_report.h"
#include "input/statistics.h"
#include "output.h"
#include "progress.h"
#include "shortest.h"
#include "terminal/json_report.h"
#include "terminal/notice.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHART_ROWS  16
#define CHART_WIDTH 50

/* What the input holds, and the field that histogram and isovalues are of. */
typedef struct facts {
    const char *path;
    const dataset *d;
    const scalar *field; /* NULL where there is a choice that was not made, of fields or components */
    open_choices open;
    statistics s;
    char no_surface[NO_SURFACE_BYTES]; /* why there can be no surface, or "" */
} facts;

static json_t *histogram_json(const statistics *s) {
    json_t *counts = json_array();
    for (int n = 0; n < s->bin_count; n++) json_array_append_new(counts, json_integer((json_int_t)s->bins[n]));
    return json_pack("{s:o, s:o, s:o}", "low", real_json(s->low), "width", real_json(s->width), "counts", counts);
}

static int suggest(const facts *f, suggestion good[SUGGESTIONS_MAX]) {
    return *f->no_surface ? 0 : statistics_suggest(&f->s, good);
}

static json_t *suggestions_json(const facts *f) {
    suggestion good[SUGGESTIONS_MAX];
    int count = suggest(f, good);
    json_t *array = json_array();
    for (int n = 0; n < count; n++)
        json_array_append_new(array, json_pack("{s:o, s:s, s:s}", "iso", real_json(good[n].isovalue), "name",
                                               good[n].name, "reason", good[n].reason));
    return array;
}

/* The block that has dims, first, spacing and matrix: the only one, if it is structured; else NULL. */
static const dataset_block *only_block(const dataset *d) {
    return d->block_count == 1 && d->blocks->kind != BLOCK_UNSTRUCTURED ? d->blocks : NULL;
}

static void add_grid(json_t *object, const dataset_block *b) {
    double spacing[3];
    int is_uniform = b && b->kind == BLOCK_UNIFORM;
    for (int axis = 0; axis < 3; axis++) spacing[axis] = is_uniform ? describe_spacing(b, axis) : 0.0;
    json_object_set_new(object, "dims", b ? integers_json(b->dims) : json_null());
    json_object_set_new(object, "first", b ? integers_json(b->first) : json_null());
    json_object_set_new(object, "spacing", is_uniform ? reals_json(spacing, 3) : json_null());
    json_object_set_new(object, "matrix",
                        is_uniform ? json_pack("[o, o, o]", reals_json(b->matrix[0], 4), reals_json(b->matrix[1], 4),
                                               reals_json(b->matrix[2], 4))
                                   : json_null());
    region_report_json(object, b);
}

static void add_field(json_t *object, const facts *f) {
    const statistics *s = &f->s;
    json_object_set_new(object, "field", f->field ? string_json(f->field->name) : json_null());
    json_object_set_new(object, "type", f->field ? json_string(tc_type_name(f->field->blocks->type)) : json_null());
    json_object_set_new(object, "range",
                        s->finite_count ? reals_json((double[]){s->minimum, s->maximum}, 2) : json_null());
    json_object_set_new(object, "nonfinite", json_integer((json_int_t)s->nonfinite_count));
    json_object_set_new(object, "missing", json_integer((json_int_t)s->missing_count));
    json_object_set_new(object, "histogram", histogram_json(s));
    json_object_set_new(object, "isovalues", suggestions_json(f));
}

static int print_json(const facts *f) {
    json_t *object = json_object();
    json_object_set_new(object, "input", string_json(f->path));
    json_object_set_new(object, "format", json_string(f->d->format));
    add_grid(object, only_block(f->d));
    json_object_set_new(object, "space", string_json(f->d->space));
    json_object_set_new(object, "units", string_json(f->d->units));
    json_object_set_new(object, "notice", string_json(f->d->notice));
    add_field(object, f);
    json_object_set_new(object, "blocks", describe_blocks_json(f->d));
    json_object_set_new(object, "choices", open_choices_json(&f->open));
    json_object_set_new(object, "notices", notices_json());
    return json_report_print(object);
}

/* Neighbouring bins are merged into rows; bars show square roots, since most volumes are mostly air. */
static void print_chart(const statistics *s) {
    int merged = (s->bin_count + CHART_ROWS - 1) / CHART_ROWS;
    uint64_t rows[CHART_ROWS] = {0}, most = 1;
    for (int n = 0; n < s->bin_count; n++) {
        rows[n / merged] += s->bins[n];
        if (rows[n / merged] > most) most = rows[n / merged];
    }
    printf("histogram     (from, count, bar of its square root)\n");
    for (int r = 0; r * merged < s->bin_count; r++) {
        int width = (int)lround(CHART_WIDTH * sqrt((double)rows[r] / (double)most));
        printf("  %22s %11" PRIu64 " %.*s\n", shortest_number(s->low + r * merged * s->width).text, rows[r], width,
               "##################################################");
    }
}

static void print_suggestions(const facts *f) {
    suggestion good[SUGGESTIONS_MAX];
    int count = suggest(f, good);
    printf("isovalues     %s%s\n", *f->no_surface ? "none: " : "",
           *f->no_surface ? f->no_surface
           : count        ? "worth trying:"
                          : "none: no value separates the samples");
    for (int n = 0; n < count; n++) printf("  %22s %s\n", shortest_number(good[n].isovalue).text, good[n].reason);
}

static void print_image(const facts *f) {
    const dataset_block *b = f->d->blocks;
    printf("dimensions    %" PRId64 " x %" PRId64 " x %" PRId64 " %s\n", b->dims[0], b->dims[1], b->dims[2],
           tc_type_name(b->fields->type));
    if (b->first[0] || b->first[1] || b->first[2])
        printf("first sample  %" PRId64 " %" PRId64 " %" PRId64 "\n", b->first[0], b->first[1], b->first[2]);
    region_report_text("part          ", b);
    describe_world_text(f->d, b);
    describe_values_text(b);
}

static void print_field(const facts *f) {
    const statistics *s = &f->s;
    open_choices_text(&f->open);
    if (!f->field) {
        const int has_field = f->d->block_count && f->d->blocks->field_count;
        printf("isovalues     none%s%s\n", has_field && !*f->no_surface ? " before that is chosen" : ": ",
               !has_field ? "there is no field" : f->no_surface);
        return;
    }
    if (f->field->name[0]) printf("field '%s'%s\n", f->field->name, f->field->is_averaged ? ", averaged" : "");
    if (s->finite_count)
        printf("range         %s to %s\n", shortest_number(s->minimum).text, shortest_number(s->maximum).text);
    if (s->nonfinite_count)
        printf("not finite    %s, treated as missing\n", counted(s->nonfinite_count, "sample", "samples").text);
    if (s->missing_count)
        printf("missing       %s, blanked or equal to --nodata\n", counted(s->missing_count, "sample", "samples").text);
    if (s->bin_count) print_chart(s);
    print_suggestions(f);
}

static void print_text(const options *o, const facts *f) {
    printf("%s\n", f->path);
    printf("format        %s\n", f->d->format);
    if (f->d->frames)
        print_image(f);
    else
        describe_blocks_text(f->d);
    print_field(f);
    if (o->preview) printf("preview       %s\n", output_is_dash(o->preview) ? "standard output" : o->preview);
}

/* A notice for each field that was rounded in some block; input_select gives that of the chosen one. */
static void tell_rounded(const facts *f) {
    const dataset_block *first = f->d->blocks;
    for (int n = 0; f->d->block_count && n < first->field_count; n++) {
        const char *name = first->fields[n].name;
        int is_rounded = 0;
        for (int b = 0; b < f->d->block_count; b++) {
            const dataset_field *same = block_field(&f->d->blocks[b], name);
            is_rounded |= same && same->is_rounded;
        }
        if (is_rounded && !(f->field && f->field->is_rounded && strcmp(f->field->name, name) == 0))
            input_tell_rounded(name);
    }
}

/* Over the points of all blocks. */
static int find_statistics(facts *f) {
    if (!f->field) return 0;
    sample_array *arrays = input_samples(f->d, f->field);
    if (!arrays) return STATUS_FAILED;
    statistics_of(arrays, f->d->block_count, &f->s);
    if (f->s.finite_count > 1 && f->s.minimum == f->s.maximum)
        notice("%s: the field%s%s is constant: every sample is %s", f->path, f->field->name[0] ? " " : "",
               f->field->name, shortest_number(f->s.minimum).text);
    free(arrays);
    return 0;
}

/* Reads the input also where the options leave a choice open; the field's samples only where they do not. */
static int read_facts(const options *o, dataset *d, scalar *field, facts *f) {
    read_request request;
    int status = input_request(o, &request);
    request.describe = 1;
    if (!status && o->preview) status = slice_preview_check(o, NULL);
    if (!status) status = input_read(&request, d);
    if (!status && o->preview) status = slice_preview_check(o, d);
    if (!status) status = progress_status();
    if (!status) status = open_choices_find(&request, d, &f->open);
    if (!status) status = option_effects_check_input(o, d, !f->open.can_select);
    if (!status && f->open.can_select) {
        status = input_select(&request, d, field);
        f->field = field;
    }
    if (!status) tell_rounded(f);
    if (!status) status = find_statistics(f);
    if (!status) status = input_take_parts(d);
    if (!status) status = no_surface_reason(o, d, f->field, f->no_surface);
    if (!status && *f->no_surface) notice("%s: nothing can be extracted: %s", f->path, f->no_surface);
    return status ? status : progress_status();
}

int info_run(const options *o) {
    dataset d = {0};
    scalar field;
    facts f = {.path = o->operand_count ? o->operands[0] : "", .d = &d};
    int status = read_facts(o, &d, &field, &f);
    if (!status && o->preview && f.field) status = slice_preview_write(o, &d, f.field, &f.s);
    if (status) goto cleanup;
    if (o->json)
        status = print_json(&f);
    else if (!o->quiet)
        print_text(o, &f);
cleanup:
    open_choices_release(&f.open);
    dataset_release(&d);
    return status;
}
