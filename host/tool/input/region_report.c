#include "region_report.h"

#include "dataset/region.h"
#include "terminal/json_report.h"

#include <inttypes.h>
#include <stdio.h>

void region_report_json(json_t *object, const dataset_block *b) {
    const int is_part = b && b->whole;
    json_t *roi = is_part ? json_array() : json_null();
    for (int axis = 0; axis < 3 && is_part; axis++) {
        int64_t begin, end;
        region_range(b, axis, &begin, &end);
        json_array_append_new(roi, json_pack("[I, I]", (json_int_t)begin, (json_int_t)end));
    }
    json_object_set_new(object, "roi", roi);
    json_object_set_new(object, "step", is_part ? integers_json(b->region.step) : json_null());
}

void region_report_text(const char *label, const dataset_block *b) {
    if (!b || !b->whole) return;
    const int64_t *step = b->region.step, *dims = b->whole->dims;
    printf("%s", label);
    for (int axis = 0; axis < 3; axis++) {
        int64_t begin, end;
        region_range(b, axis, &begin, &end);
        printf("%s%" PRId64 ":%" PRId64, axis ? ", " : "", begin, end);
    }
    printf(" of %" PRId64 " x %" PRId64 " x %" PRId64 " samples", dims[0], dims[1], dims[2]);
    if (step[0] > 1 || step[1] > 1 || step[2] > 1)
        printf(", in steps of %" PRId64 ", %" PRId64 ", %" PRId64, step[0], step[1], step[2]);
    printf("\n");
}
