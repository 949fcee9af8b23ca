#include "planes_cut.h"

#include "counted.h"
#include "exit_status.h"
#include "failure.h"
#include "parts/part_header.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNKS_EACH = 16, MESH_WEIGHT = 2 };

static int64_t min_i64(int64_t a, int64_t b) { return a < b ? a : b; }

int planes_cut_check(const options *o, const team *t, int64_t nz, int64_t count) {
    const cut_request *cut = &o->cut;
    const char *what = t ? "ranks" : "parts";
    if (!options_given(o, "--cut")) return 0;
    if (!t && !o->part[1])
        return fail(STATUS_USAGE, "--cut says where ranks or parts begin: give --part I/N, or run tetracubes-mpi");
    if (!t && cut->kind == CUT_COST)
        return fail(STATUS_USAGE, "--cut cost is for ranks, which count together: give parts planes to begin at");
    if (cut->kind != CUT_PLANES) return 0;
    if (cut->count != (size_t)count - 1)
        return fail(STATUS_USAGE, "--cut names %s, where all but the first of %zu %s begin; there are %" PRId64,
                    counted(cut->count, "plane", "planes").text, cut->count + 1, what, count);
    for (size_t n = 0; n < cut->count; n++) {
        const int64_t plane = cut->planes[n], before = n ? cut->planes[n - 1] : 0;
        if (plane < before || plane > nz)
            return fail(STATUS_USAGE, "--cut: plane %" PRId64 " is not from %" PRId64 " to %" PRId64, plane, before,
                        nz);
        if (plane % LAYER_PLANES && plane < nz)
            return fail(STATUS_USAGE, "--cut: plane %" PRId64 " is no multiple of %d, as layers are: give %" PRId64,
                        plane, LAYER_PLANES, plane / LAYER_PLANES * LAYER_PLANES);
    }
    return 0;
}

void planes_cut_of(const options *o, const int64_t *begins, int64_t nz, int64_t number, int64_t count,
                   int64_t planes[2]) {
    if (!begins && o->cut.kind == CUT_PLANES) begins = o->cut.planes;
    part_planes(nz, number, count, planes);
    if (!begins) return;
    planes[0] = number ? begins[number - 1] : 0;
    planes[1] = number + 1 < count ? begins[number] : nz;
}

/* ------------------------------------------------------------------------------------------------------------- cost */

/* Counts in place of the stream that is described; both have the same source. */
typedef struct cost_count {
    const tc_stream_options *how;
    uint64_t mesh_bytes;
} cost_count;

static int read_planes(void *user, tc_planes *planes) {
    const cost_count *c = user;
    return c->how->read(c->how->user, planes);
}

static int take_counts(void *user, size_t surface, const tc_counts *counts) {
    cost_count *c = user;
    (void)surface;
    c->mesh_bytes += counts->mesh_bytes;
    return 0;
}

static tc_status chunk_cost(tc_context *context, const tc_stream_options *how, const int64_t planes[2],
                            uint64_t *cost) {
    const tc_grid_options *g = how->grid;
    cost_count count = {.how = how};
    tc_stream_options o = *how;
    memcpy(o.owned, planes, sizeof o.owned);
    o.read = read_planes;
    o.counted = take_counts;
    o.take = NULL;
    o.user = &count;
    const tc_status status = tc_stream(context, &o);
    *cost = (uint64_t)(planes[1] - planes[0]) * (uint64_t)(g->dims[0] * g->dims[1]) * tc_type_bytes(g->type) +
            MESH_WEIGHT * count.mesh_bytes;
    return status;
}

/* Where members begin: of the layer within whose chunk so much of all costs lies before, as if its layers were alike.
 */
static void begins_find(const uint64_t *costs, int64_t chunk_count, int64_t nz, int64_t count, uint64_t *begins) {
    double all = 0, before = 0;
    int64_t chunk = 0, planes[2];
    for (int64_t n = 0; n < chunk_count; n++) all += (double)costs[n];
    for (int64_t member = 1; member < count; member++) {
        const double wanted = all * (double)member / (double)count;
        while (chunk + 1 < chunk_count && before + (double)costs[chunk] <= wanted) before += (double)costs[chunk++];
        part_planes(nz, chunk, chunk_count, planes);
        const double layers = (double)(planes[1] - planes[0]) / LAYER_PLANES;
        const int64_t layer = (int64_t)((wanted - before) / (double)costs[chunk] * layers + 0.5);
        begins[member - 1] = (uint64_t)min_i64(planes[0] + LAYER_PLANES * layer, planes[1]);
    }
}

tc_status planes_cut_by_cost(team *t, tc_context *context, const tc_stream_options *how, int64_t **begins) {
    const int64_t nz = how->grid->dims[2], layers = (nz + LAYER_PLANES - 1) / LAYER_PLANES;
    const int64_t chunks = min_i64(layers, (int64_t)CHUNKS_EACH * t->size);
    const size_t most = (size_t)(chunks > t->size ? chunks : t->size);
    uint64_t *costs = calloc(most, sizeof *costs), *before = calloc(most, sizeof *before);
    uint64_t *found = calloc((size_t)t->size, sizeof *found);
    tc_status status = costs && before && found ? TC_OK : TC_ERROR_MEMORY;
    const int64_t first = t->rank * chunks / t->size, end = (t->rank + 1) * chunks / t->size;
    for (int64_t n = first; n < end && !status; n++) {
        int64_t planes[2];
        part_planes(nz, n, chunks, planes);
        status = chunk_cost(context, how, planes, &costs[n]);
    }
    if (status) goto cleanup;
    t->sum(t, costs, before, (size_t)chunks);
    if (!t->rank) begins_find(costs, chunks, nz, t->size, found); /* by one: all have the same numbers */
    t->sum(t, found, before, (size_t)t->size);
    *begins = (int64_t *)(void *)found;
    found = NULL;
cleanup:
    free(found);
    free(before);
    free(costs);
    return status;
}
