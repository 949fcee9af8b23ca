#include "field/average.h"

#include "dataset/cell_types.h"
#include "exit_status.h"
#include "failure.h"
#include "sample_types.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Sums at the points while cells are gone through. */
typedef struct sums {
    const dataset_block *b;
    const uint8_t *blanked_cells;
    const dataset_field *of_cells;
    double *total;   /* components per point */
    uint32_t *cells; /* present cells around the point; saturates */
} sums;

static int is_present(const sums *s, int64_t cell, const int64_t *points, int64_t point_count) {
    if (s->blanked_cells && s->blanked_cells[cell]) return 0;
    for (int64_t n = 0; s->b->blanked_points && n < point_count; n++)
        if (s->b->blanked_points[points[n]]) return 0;
    for (int c = 0; c < s->of_cells->components; c++)
        if (!isfinite(value_at(s->of_cells->type, s->of_cells->values,
                               (uint64_t)cell * (uint64_t)s->of_cells->components + (uint64_t)c)))
            return 0;
    return 1;
}

static void add_cell(sums *s, int64_t cell, const int64_t *points, int64_t point_count) {
    uint64_t components = (uint64_t)s->of_cells->components;
    if (!is_present(s, cell, points, point_count)) return;
    for (uint64_t c = 0; c < components; c++) {
        double value = value_at(s->of_cells->type, s->of_cells->values, (uint64_t)cell * components + c);
        for (int64_t n = 0; n < point_count; n++) s->total[(uint64_t)points[n] * components + c] += value;
    }
    for (int64_t n = 0; n < point_count; n++)
        if (s->cells[points[n]] < UINT32_MAX) s->cells[points[n]]++;
}

static void add_structured(sums *s) {
    const int64_t *d = s->b->dims;
    int64_t cell = 0;
    for (int64_t k = 0; k + 1 < d[2]; k++)
        for (int64_t j = 0; j + 1 < d[1]; j++)
            for (int64_t i = 0; i + 1 < d[0]; i++) {
                int64_t points[8];
                for (int corner = 0; corner < 8; corner++)
                    points[corner] = i + (corner & 1) + d[0] * (j + (corner >> 1 & 1) + d[1] * (k + (corner >> 2 & 1)));
                add_cell(s, cell++, points, 8);
            }
}

static void add_unstructured(sums *s) {
    for (int64_t cell = 0; cell < s->b->cell_count; cell++) {
        const uint8_t type = s->b->cell_types[cell];
        int64_t begin = s->b->cell_offsets[cell], count = s->b->cell_offsets[cell + 1] - begin;
        if (cell_type_points(type) && count > cell_type_points(type)) count = cell_type_points(type);
        if (cell_type_dimension(type) == 3) add_cell(s, cell, s->b->cell_points + begin, count);
    }
}

static void divide(const sums *s, dataset_field *out, void *values) {
    uint64_t components = (uint64_t)out->components;
    for (uint64_t p = 0; p < (uint64_t)s->b->point_count; p++)
        for (uint64_t c = 0; c < components; c++) {
            double mean = s->cells[p] ? s->total[p * components + c] / s->cells[p] : NAN;
            if (out->type == TC_F64)
                ((double *)values)[p * components + c] = mean;
            else
                ((float *)values)[p * components + c] = (float)mean;
        }
    out->values = values;
}

int average_to_points(dataset *d, const dataset_block *b, const uint8_t *blanked_cells, const dataset_field *of_cells,
                      dataset_field *out) {
    sums s = {.b = b, .blanked_cells = blanked_cells, .of_cells = of_cells};
    uint64_t count;
    *out = (dataset_field){.name = of_cells->name, .components = of_cells->components};
    out->type = type_is_wide(of_cells->type) ? TC_F64 : TC_F32;
    if (__builtin_mul_overflow((uint64_t)b->point_count, (uint64_t)out->components, &count) || count > INT64_MAX / 8)
        return fail(STATUS_FAILED, "field \"%s\" has more values than memory can hold", out->name);
    s.total = calloc(count ? count : 1, sizeof *s.total);
    s.cells = calloc(b->point_count ? (size_t)b->point_count : 1, sizeof *s.cells);
    void *values = s.total && s.cells ? dataset_allocate(d, count * sample_bytes(out->type)) : NULL;
    if (values) {
        if (b->kind == BLOCK_UNSTRUCTURED)
            add_unstructured(&s);
        else
            add_structured(&s);
        divide(&s, out, values);
    }
    free(s.total);
    free(s.cells);
    return values ? 0 : fail(STATUS_FAILED, "no memory to average field \"%s\" to points", out->name);
}
