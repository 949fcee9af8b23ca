#include "input/input_summary.h"

#include "counted.h"
#include "input/region_report.h"

#include <inttypes.h>
#include <stdio.h>

input_summary input_summarize(const options *o, const dataset *d, const scalar *field, const block_list *blocks) {
    const dataset_block *first = d->blocks;
    input_summary s = {.path = o->operands[0],
                       .grid = d->block_count == 1 && first->kind != BLOCK_UNSTRUCTURED ? first : NULL,
                       .block_count = d->block_count,
                       .field = field->name,
                       .type = field->blocks[0].type,
                       .cell_count = blocks->cell_count,
                       .tetrahedron_count = blocks->tetrahedron_count};
    for (int n = 0; n < d->block_count; n++) s.point_count += (uint64_t)first[n].point_count;
    return s;
}

void input_summary_text(const input_summary *s) {
    printf("%s: ", s->path);
    if (s->block_count > 1) printf("%d blocks, ", s->block_count);
    if (s->grid)
        printf("%" PRId64 " x %" PRId64 " x %" PRId64 " ", s->grid->dims[0], s->grid->dims[1], s->grid->dims[2]);
    else
        printf("%s ", counted(s->point_count, "point", "points").text);
    printf("%s%s%s, %s, %s\n", s->field, s->field[0] ? " " : "", tc_type_name(s->type),
           counted(s->cell_count, "cell", "cells").text,
           counted(s->tetrahedron_count, "tetrahedron", "tetrahedra").text);
    region_report_text("part: ", s->grid);
}
