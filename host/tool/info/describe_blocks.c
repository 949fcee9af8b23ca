#include "describe_blocks.h"

#include "counted.h"
#include "dataset/cell_types.h"
#include "input/region_report.h"
#include "input/statistics.h"
#include "input/used_points.h"
#include "shortest.h"
#include "terminal/json_report.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { CELL_TYPES = 256, RANGES_SHOWN = 9 };

static const char *const kind_names[] = {"uniform", "rectilinear", "curvilinear", "unstructured"};

/* ----------------------------------------------------------------------------------------------------------- facts */

typedef struct bounds {
    double low[3], high[3]; /* infinities where there are no points */
} bounds;

static void include(bounds *b, const double p[3]) {
    for (int r = 0; r < 3; r++) {
        b->low[r] = fmin(b->low[r], p[r]);
        b->high[r] = fmax(b->high[r], p[r]);
    }
}

/* The eight corners of a uniform grid. */
static void include_corners(bounds *all, const dataset_block *b) {
    for (int corner = 0; corner < 8; corner++) {
        double index[3], p[3];
        for (int axis = 0; axis < 3; axis++)
            index[axis] = (double)(b->first[axis] + (corner >> axis & 1 ? b->dims[axis] - 1 : 0));
        for (int r = 0; r < 3; r++)
            p[r] =
                b->matrix[r][0] * index[0] + b->matrix[r][1] * index[1] + b->matrix[r][2] * index[2] + b->matrix[r][3];
        include(all, p);
    }
}

double describe_spacing(const dataset_block *b, int axis) {
    return hypot(hypot(b->matrix[0][axis], b->matrix[1][axis]), b->matrix[2][axis]);
}

static bounds bounds_of(const dataset_block *b) {
    bounds all = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int axis = 0; b->kind == BLOCK_RECTILINEAR && axis < 3; axis++)
        for (int64_t n = 0; n < b->dims[axis]; n++) {
            all.low[axis] = fmin(all.low[axis], coordinate_at(b->axes[axis], n));
            all.high[axis] = fmax(all.high[axis], coordinate_at(b->axes[axis], n));
        }
    if (b->kind == BLOCK_UNIFORM) include_corners(&all, b);
    for (int64_t n = 0; (b->kind == BLOCK_CURVILINEAR || b->kind == BLOCK_UNSTRUCTURED) && n < b->point_count; n++) {
        double p[3];
        for (int axis = 0; axis < 3; axis++) p[axis] = coordinate_at(b->points, 3 * n + axis);
        include(&all, p);
    }
    return all;
}

static void count_types(const dataset_block *b, uint64_t counts[CELL_TYPES]) {
    memset(counts, 0, CELL_TYPES * sizeof *counts);
    for (int64_t n = 0; n < b->cell_count; n++) counts[b->cell_types[n]]++;
}

static const char *type_name(int type, char text[16]) {
    if (cell_type_name((uint8_t)type)) return cell_type_name((uint8_t)type);
    snprintf(text, 16, "type %d", type);
    return text;
}

/* Range of one component; 0 where it has no finite value. */
static int range_of(const dataset_block *b, const dataset_field *f, int component, double range[2]) {
    uint64_t tuples = (uint64_t)(f->on_cells ? b->cell_count : b->point_count);
    const sample_array all = {.type = f->type, .samples = f->values, .count = tuples * (uint64_t)f->components};
    return statistics_range(&all, component, f->components, range);
}

/* ------------------------------------------------------------------------------------------------------------ JSON */

static json_t *field_json(const dataset_block *b, const dataset_field *f) {
    json_t *ranges = json_array();
    for (int c = 0; c < f->components; c++) {
        double range[2];
        json_array_append_new(ranges, range_of(b, f, c, range) ? reals_json(range, 2) : json_null());
    }
    return json_pack("{s:o, s:s, s:i, s:s, s:o}", "name", string_json(f->name), "on", f->on_cells ? "cells" : "points",
                     "components", f->components, "type", tc_type_name(f->type), "ranges", ranges);
}

static json_t *types_json(const dataset_block *b) {
    uint64_t counts[CELL_TYPES];
    char text[16];
    json_t *object = json_object();
    count_types(b, counts);
    for (int type = 0; type < CELL_TYPES; type++)
        if (counts[type]) json_object_set_new(object, type_name(type, text), json_integer((json_int_t)counts[type]));
    return object;
}

static json_t *block_json(const dataset_block *b) {
    int structured = b->kind != BLOCK_UNSTRUCTURED;
    bounds all = bounds_of(b);
    json_t *object = json_object(), *fields = json_array();
    json_object_set_new(object, "kind", json_string(kind_names[b->kind]));
    json_object_set_new(object, "points", json_integer((json_int_t)b->point_count));
    json_object_set_new(object, "cells", json_integer((json_int_t)b->cell_count));
    json_object_set_new(object, "dims", structured ? integers_json(b->dims) : json_null());
    json_object_set_new(object, "first", structured ? integers_json(b->first) : json_null());
    json_object_set_new(object, "cell_types", structured ? json_null() : types_json(b));
    json_object_set_new(object, "bounds", json_pack("[o, o]", reals_json(all.low, 3), reals_json(all.high, 3)));
    json_object_set_new(object, "blanked_points",
                        json_integer((json_int_t)count_set(b->blanked_points, b->point_count)));
    json_object_set_new(object, "blanked_cells", json_integer((json_int_t)count_set(b->blanked_cells, b->cell_count)));
    for (int n = 0; n < b->field_count; n++) json_array_append_new(fields, field_json(b, &b->fields[n]));
    json_object_set_new(object, "fields", fields);
    return object;
}

json_t *describe_blocks_json(const dataset *d) {
    json_t *array = json_array();
    for (int n = 0; n < d->block_count; n++) json_array_append_new(array, block_json(&d->blocks[n]));
    return array;
}

/* ------------------------------------------------------------------------------------------------------------ text */

static void field_text(const dataset_block *b, const dataset_field *f) {
    printf("  %s '%s' %s", f->on_cells ? "cell" : "point", f->name, tc_type_name(f->type));
    if (f->components > 1) printf(", %d components", f->components);
    for (int c = 0; c < f->components && c < RANGES_SHOWN; c++) {
        double range[2];
        if (range_of(b, f, c, range))
            printf("%s %s to %s", c ? ";" : ",", shortest_number(range[0]).text, shortest_number(range[1]).text);
        else
            printf("%s nothing finite", c ? ";" : ",");
    }
    printf(f->components > RANGES_SHOWN ? "; ...\n" : "\n");
}

static void cells_text(const dataset_block *b) {
    uint64_t counts[CELL_TYPES];
    char text[16];
    const char *separator = "";
    count_types(b, counts);
    printf("cells         %" PRId64 ": ", b->cell_count);
    for (int type = 0; type < CELL_TYPES; type++) {
        if (!counts[type]) continue;
        printf("%s%s %" PRIu64, separator, type_name(type, text), counts[type]);
        separator = ", ";
    }
    printf("%s\n", b->cell_count ? "" : "none");
}

void describe_world_text(const dataset *d, const dataset_block *b) {
    printf("spacing      ");
    for (int axis = 0; axis < 3; axis++) printf(" %s", shortest_number(describe_spacing(b, axis)).text);
    printf("\nworld space   %s", d->space[0] ? d->space : "not named");
    if (d->world[0] && !strstr(d->space, d->world)) printf(" (%s)", d->world);
    printf("%s%s\n", d->units[0] ? ", in " : "", d->units);
    for (int r = 0; r < 3; r++)
        printf("%s%s i + %s j + %s k + %s\n", r ? "              " : "index->world  ",
               shortest_number(b->matrix[r][0]).text, shortest_number(b->matrix[r][1]).text,
               shortest_number(b->matrix[r][2]).text, shortest_number(b->matrix[r][3]).text);
}

void describe_values_text(const dataset_block *b) {
    const dataset_field *f = b->fields;
    if (f->components == 1) return;
    printf("values        %d per sample%s%s%s\n", f->components, f->meaning ? " (" : "", f->meaning ? f->meaning : "",
           f->meaning ? ")" : "");
    for (int c = 0; c < f->components && c < RANGES_SHOWN; c++) {
        double range[2];
        if (range_of(b, f, c, range))
            printf("  %-11d %s to %s\n", c, shortest_number(range[0]).text, shortest_number(range[1]).text);
    }
}

static void block_text(const dataset *d, const dataset_block *b) {
    bounds all = bounds_of(b);
    uint64_t points = count_set(b->blanked_points, b->point_count), cells = count_set(b->blanked_cells, b->cell_count);
    printf("grid          %s, ", kind_names[b->kind]);
    if (b->kind == BLOCK_UNSTRUCTURED) {
        printf("%s\n", counted((uint64_t)b->point_count, "point", "points").text);
        cells_text(b);
    } else {
        printf("%" PRId64 " x %" PRId64 " x %" PRId64 " points\n", b->dims[0], b->dims[1], b->dims[2]);
        if (b->first[0] || b->first[1] || b->first[2])
            printf("first point   %" PRId64 " %" PRId64 " %" PRId64 "\n", b->first[0], b->first[1], b->first[2]);
    }
    region_report_text("part          ", b);
    if (b->kind == BLOCK_UNIFORM) describe_world_text(d, b);
    if (points || cells)
        printf("blanked       %s, %s\n", counted(points, "point", "points").text, counted(cells, "cell", "cells").text);
    if (b->point_count)
        printf("bounds        %s %s %s to %s %s %s\n", shortest_coordinate(all.low[0]).text,
               shortest_coordinate(all.low[1]).text, shortest_coordinate(all.low[2]).text,
               shortest_coordinate(all.high[0]).text, shortest_coordinate(all.high[1]).text,
               shortest_coordinate(all.high[2]).text);
    printf(b->field_count ? "fields\n" : "fields        none\n");
    for (int n = 0; n < b->field_count; n++) field_text(b, &b->fields[n]);
}

void describe_blocks_text(const dataset *d) {
    for (int n = 0; n < d->block_count; n++) {
        if (d->block_count > 1) printf("block %d of %d\n", n, d->block_count);
        block_text(d, &d->blocks[n]);
    }
}
