#include "label_samples.h"

#include "exit_status.h"
#include "failure.h"
#include "sample_types.h"
#include "shortest.h"

#include <math.h>

static int make_labels(const char *path, const scalar_block *from, int64_t count, uint32_t *to) {
    for (int64_t n = 0; n < count; n++) {
        const double value = value_at(from->type, from->samples, (uint64_t)n);
        if (isfinite(value) && !(from->has_nodata && value == from->nodata) && value > 0) {
            if (value > UINT32_MAX || value != floor(value))
                return fail(STATUS_INPUT,
                            "%s: the sample %s is no label: labels are whole numbers below 2^32; 'tetracubes extract' "
                            "makes isosurfaces",
                            path, shortest_number(value).text);
            to[n] = (uint32_t)value;
        } else {
            to[n] = 0;
        }
    }
    return 0;
}

int label_samples_make(const char *path, dataset *d, scalar *field) {
    scalar_block *block = &field->blocks[0];
    if (block->type != TC_F32 && block->type != TC_F64) return 0;
    uint32_t *labels = dataset_allocate(d, (uint64_t)d->blocks[0].point_count * sizeof *labels);
    if (!labels) return STATUS_FAILED;
    const int status = make_labels(path, block, d->blocks[0].point_count, labels);
    block->samples = labels;
    block->type = TC_U32;
    block->has_nodata = 0;
    return status;
}
