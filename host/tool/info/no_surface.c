/* no_surface.c - looks for one cell that a surface could pass through; see no_surface.h */
#include "no_surface.h"

#include "exit_status.h"
#include "failure.h"
#include "input/blocks.h"
#include "sample_types.h"
#include "terminal/notice.h"

#include <math.h>
#include <stdio.h>

static int is_missing(const scalar_block *s, int64_t n) {
    const double value = value_at(s->type, s->samples, (uint64_t)n);
    return !isfinite(value) || (s->blanked_points && s->blanked_points[n]) || (s->has_nodata && value == s->nodata);
}

/* 1 where all samples are missing, or there are none. */
static int are_missing(const scalar_block *s, int64_t count) {
    for (int64_t n = 0; n < count; n++)
        if (!is_missing(s, n)) return 0;
    return 1;
}

static int cube_is_whole(const dataset_block *b, const scalar_block *s, int64_t x, int64_t y, int64_t z) {
    const int64_t *d = b->dims, cell = x + (d[0] - 1) * (y + (d[1] - 1) * z);
    if (s->blanked_cells && s->blanked_cells[cell]) return 0;
    for (int corner = 0; corner < 8; corner++)
        if (is_missing(s, x + (corner & 1) + d[0] * (y + (corner >> 1 & 1) + d[1] * (z + (corner >> 2))))) return 0;
    return 1;
}

static int has_whole_cube(const dataset_block *b, const scalar_block *s) {
    for (int64_t z = 0; z + 1 < b->dims[2]; z++)
        for (int64_t y = 0; y + 1 < b->dims[1]; y++)
            for (int64_t x = 0; x + 1 < b->dims[0]; x++)
                if (cube_is_whole(b, s, x, y, z)) return 1;
    return 0;
}

static int is_solid(const dataset_block *b) { return b->dims[0] > 1 && b->dims[1] > 1 && b->dims[2] > 1; }

/* Tetrahedra of the unstructured blocks; where they cannot be cut that is the reason. */
static int cut_cells(const options *o, const dataset *d, const scalar *field, uint64_t *count, char *reason) {
    block_list list;
    int status = blocks_cut(o, d, field, 0, &list);
    if (status == STATUS_INPUT) {
        snprintf(reason, NO_SURFACE_BYTES, "%s", failure_text());
        status = 0;
    }
    *count = 0;
    for (int n = 0; n < list.count; n++) *count += list.blocks[n].complex.tetrahedron_count;
    blocks_release(&list);
    return status;
}

int no_surface_reason(const options *o, const dataset *d, const scalar *field, char reason[NO_SURFACE_BYTES]) {
    int solid = 0, whole = 0, unstructured = 0, missing = 0, status = 0;
    uint64_t tetrahedra = 0;
    reason[0] = '\0';
    for (int n = 0; n < d->block_count; n++) {
        const dataset_block *b = &d->blocks[n];
        unstructured |= b->kind == BLOCK_UNSTRUCTURED;
        missing += field && are_missing(&field->blocks[n], b->point_count);
        if (b->kind == BLOCK_UNSTRUCTURED || !is_solid(b)) continue;
        solid = 1;
        whole = whole || !field || has_whole_cube(b, &field->blocks[n]);
    }
    if (unstructured) status = cut_cells(o, d, field, &tetrahedra, reason);
    if (status || *reason || !d->block_count) return status;
    if (missing && missing < d->block_count)
        notice("%s: every sample is missing in %d of %d blocks", o->operands[0], missing, d->block_count);
    if (missing == d->block_count)
        snprintf(reason, NO_SURFACE_BYTES, "every sample is missing");
    else if (!unstructured && !solid)
        snprintf(reason, NO_SURFACE_BYTES, "%s has one sample along an axis, a surface needs two or more",
                 d->block_count > 1 ? "every block" : "the grid");
    else if (unstructured ? !tetrahedra : !whole)
        snprintf(reason, NO_SURFACE_BYTES, "no cell of three dimensions %s",
                 field ? "has samples at all its corners" : "is there");
    return 0;
}
