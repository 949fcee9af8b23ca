/* info.c - what a volume holds: description, range, histogram, isovalues worth trying */
#include "commands.h"
#include "exit_status.h"
#include "failure.h"
#include "progress.h"
#include "report.h"
#include "statistics.h"

#include <inttypes.h>
#include <math.h>

#define CHART_ROWS  16
#define CHART_WIDTH 50

/* Distance of neighbouring samples in world space: the length of the matrix's columns. */
static void spacing_of(const volume *v, double spacing[3]) {
    for (int axis = 0; axis < 3; axis++)
        spacing[axis] = hypot(hypot(v->matrix[0][axis], v->matrix[1][axis]), v->matrix[2][axis]);
}

static json_t *integers_json(const int64_t values[3]) {
    return json_pack("[I, I, I]", (json_int_t)values[0], (json_int_t)values[1], (json_int_t)values[2]);
}

static json_t *histogram_json(const statistics *s) {
    json_t *counts = json_array();
    for (int n = 0; n < s->bin_count; n++) json_array_append_new(counts, json_integer((json_int_t)s->bins[n]));
    return json_pack("{s:o, s:o, s:o}", "low", report_real(s->low), "width", report_real(s->width), "counts", counts);
}

static json_t *suggestions_json(const statistics *s) {
    suggestion good[SUGGESTIONS_MAX];
    int count = statistics_suggest(s, good);
    json_t *array = json_array();
    for (int n = 0; n < count; n++)
        json_array_append_new(array, json_pack("{s:o, s:s, s:s}", "iso", report_real(good[n].isovalue), "name",
                                               good[n].name, "reason", good[n].reason));
    return array;
}

/* So many that range and isovalues read back exactly. */
static int exact_digits(const statistics *s) {
    suggestion good[SUGGESTIONS_MAX];
    int count = statistics_suggest(s, good), digits = report_digits(s->minimum), needed = report_digits(s->maximum);
    if (needed > digits) digits = needed;
    for (int n = 0; n < count; n++)
        if ((needed = report_digits(good[n].isovalue)) > digits) digits = needed;
    return digits;
}

static int print_json(const char *path, const volume *v, const statistics *s) {
    double spacing[3];
    spacing_of(v, spacing);
    json_t *object = json_object();
    json_object_set_new(object, "input", report_string(path));
    json_object_set_new(object, "format", json_string(v->format));
    json_object_set_new(object, "dims", integers_json(v->dims));
    json_object_set_new(object, "first", integers_json(v->first));
    json_object_set_new(object, "type", json_string(tc_type_name(v->type)));
    json_object_set_new(object, "spacing", report_reals(spacing, 3));
    json_object_set_new(object, "matrix",
                        json_pack("[o, o, o]", report_reals(v->matrix[0], 4), report_reals(v->matrix[1], 4),
                                  report_reals(v->matrix[2], 4)));
    json_object_set_new(object, "space", report_string(v->space));
    json_object_set_new(object, "notice", report_string(v->notice));
    json_object_set_new(object, "range",
                        s->finite_count ? report_reals((double[]){s->minimum, s->maximum}, 2) : json_null());
    json_object_set_new(object, "nonfinite", json_integer((json_int_t)s->nonfinite_count));
    json_object_set_new(object, "histogram", histogram_json(s));
    json_object_set_new(object, "isovalues", suggestions_json(s));
    return report_print(object, exact_digits(s));
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
        printf("  %11.5g %11" PRIu64 " %.*s\n", s->low + r * merged * s->width, rows[r], width,
               "##################################################");
    }
}

static void print_suggestions(const statistics *s) {
    suggestion good[SUGGESTIONS_MAX];
    int count = statistics_suggest(s, good);
    printf("isovalues     %s\n", count ? "worth trying:" : "none: no value separates the samples");
    for (int n = 0; n < count; n++) printf("  %11.7g %s\n", good[n].isovalue, good[n].reason);
}

static void print_text(const char *path, const volume *v, const statistics *s) {
    double spacing[3];
    spacing_of(v, spacing);
    printf("%s\n", path);
    printf("format        %s\n", v->format);
    printf("dimensions    %" PRId64 " x %" PRId64 " x %" PRId64 " %s\n", v->dims[0], v->dims[1], v->dims[2],
           tc_type_name(v->type));
    if (v->first[0] || v->first[1] || v->first[2])
        printf("first sample  %" PRId64 " %" PRId64 " %" PRId64 "\n", v->first[0], v->first[1], v->first[2]);
    printf("spacing       %.9g %.9g %.9g\n", spacing[0], spacing[1], spacing[2]);
    printf("world space   %s\n", v->space[0] ? v->space : "not named");
    for (int r = 0; r < 3; r++)
        printf("%s%.9g i + %.9g j + %.9g k + %.9g\n", r ? "              " : "index->world  ", v->matrix[r][0],
               v->matrix[r][1], v->matrix[r][2], v->matrix[r][3]);
    if (s->finite_count) printf("range         %.9g to %.9g\n", s->minimum, s->maximum);
    if (s->nonfinite_count) printf("not finite    %" PRIu64 " samples, treated as missing\n", s->nonfinite_count);
    if (v->notice[0]) printf("notice        %s\n", v->notice);
    if (s->bin_count) print_chart(s);
    print_suggestions(s);
}

int info_run(const options *o) {
    read_request request;
    volume v = {0};
    statistics s;
    int status = input_request(o, &request);
    if (!status) status = volume_read(&request, &v);
    if (!status) status = progress_status();
    if (status) goto cleanup;
    statistics_of(&v, &s);
    if (o->json)
        status = print_json(request.path, &v, &s);
    else
        print_text(request.path, &v, &s);
cleanup:
    volume_release(&v);
    return status;
}
