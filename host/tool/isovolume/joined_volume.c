#include "joined_volume.h"

#include "exit_status.h"
#include "failure.h"
#include "library_status.h"
#include "mesh_write.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

int joined_volume_count(engine *e, const tc_interval_volume_options *how, volume_report *v) {
    for (int n = 0; n < e->block_count; n++) {
        tc_interval_volume_counts one = {.struct_size = sizeof one};
        tc_status status = e->grids[n] ? tc_count_interval_volume(e->grids[n], how, &one) : TC_OK;
        if (status) return library_status(status);
        v->sample_count += one.sample_count;
        v->low_count += one.low_count;
        v->high_count += one.high_count;
        v->tetrahedron_count += one.tetrahedron_count;
        v->bytes += one.interval_bytes;
        v->classify_ms += one.classify_ms;
    }
    return 0;
}

/* ----------------------------------------------------------------------------------------------------------- making */

static void add_sizes(const tc_interval_volume_data *one, tc_interval_volume_data *sum) {
    sum->vertex_count += one->vertex_count;
    sum->sample_count += one->sample_count;
    sum->low_count += one->low_count;
    sum->high_count += one->high_count;
    sum->tetrahedron_count += one->tetrahedron_count;
    if (one->slab_count > sum->slab_count) sum->slab_count = one->slab_count;
    sum->timings.classify_ms += one->timings.classify_ms;
    sum->timings.emit_ms += one->timings.emit_ms;
    sum->timings.readback_ms += one->timings.readback_ms;
    sum->timings.total_ms += one->timings.total_ms;
}

static int block_get(const joined_volume *v, int n, tc_interval_volume_data *one) {
    *one = (tc_interval_volume_data){.struct_size = sizeof *one};
    return v->blocks[n] ? library_status(tc_interval_volume_get(v->blocks[n], one)) : 0;
}

/* One block's arrays are used where they are. */
static int blocks_join(joined_volume *v) {
    tc_interval_volume_data one;
    uint64_t vertex = 0, corner = 0;
    if (v->block_count == 1) {
        int status = block_get(v, 0, &one);
        v->sum.positions = one.positions;
        v->sum.tetrahedra = one.tetrahedra;
        return status;
    }
    if (v->sum.vertex_count > UINT32_MAX)
        return fail(STATUS_FAILED,
                    "the blocks' volumes have %" PRIu64 " vertices together, more than the 2^32 - 1 that one file "
                    "numbers; take the blocks from files of their own",
                    v->sum.vertex_count);
    v->positions = malloc((size_t)v->sum.vertex_count * 12 + 1);
    v->tetrahedra = malloc((size_t)v->sum.tetrahedron_count * 16 + 1);
    if (!v->positions || !v->tetrahedra) return fail(STATUS_FAILED, "out of memory for the volumes of all blocks");
    for (int n = 0; n < v->block_count; n++) {
        int status = block_get(v, n, &one);
        if (status) return status;
        if (one.vertex_count) memcpy(v->positions + 3 * vertex, one.positions, (size_t)one.vertex_count * 12);
        for (uint64_t m = 0; m < 4 * one.tetrahedron_count; m++)
            v->tetrahedra[corner++] = one.tetrahedra[m] + (uint32_t)vertex;
        vertex += one.vertex_count;
    }
    v->sum.positions = v->positions;
    v->sum.tetrahedra = v->tetrahedra;
    return 0;
}

static int field_carry(engine *e, const tc_interval_volume_options *how, const point_field *from,
                       const joined_volume *v, float *values) {
    for (int n = 0; n < v->block_count; n++) {
        const dataset_field *f = &from->blocks[n];
        const tc_field field = {sizeof field, f->type, f->components, f->values};
        tc_interval_volume_data one;
        int status = block_get(v, n, &one);
        const uint64_t count = one.vertex_count * (uint64_t)f->components;
        if (!status && count)
            status = library_status(tc_interpolate_interval_volume(e->grids[n], how, &field, values, count));
        if (status) return status;
        values += count;
    }
    return 0;
}

static int fields_carry(engine *e, const tc_interval_volume_options *how, const carried_fields *carried,
                        joined_volume *v) {
    v->values = calloc((size_t)carried->count + 1, sizeof *v->values);
    if (!v->values) return fail(STATUS_FAILED, "out of memory for the fields to carry");
    for (int n = 0; n < carried->count; n++) {
        const size_t bytes = (size_t)v->sum.vertex_count * (size_t)carried->from[n].components * sizeof(float);
        v->values[v->field_count] = malloc(bytes + 1);
        if (!v->values[v->field_count++])
            return fail(STATUS_FAILED, "out of memory for field '%s' in the volume", carried->from[n].name);
        int status = field_carry(e, how, &carried->from[n], v, v->values[n]);
        if (status) return status;
    }
    return 0;
}

int joined_volume_make(engine *e, const tc_interval_volume_options *how, const carried_fields *carried,
                       joined_volume *v) {
    *v = (joined_volume){.block_count = e->block_count, .sum = {.struct_size = sizeof v->sum}};
    v->blocks = calloc((size_t)e->block_count + 1, sizeof *v->blocks);
    if (!v->blocks) return fail(STATUS_FAILED, "out of memory for %d blocks", e->block_count);
    int status = 0;
    for (int n = 0; n < e->block_count && !status; n++) {
        tc_interval_volume_data one;
        const tc_status made = e->grids[n] ? tc_extract_interval_volume(e->grids[n], how, &v->blocks[n]) : TC_OK;
        e->fails_alike = made == TC_ERROR_LIMIT;
        status = library_status(made);
        if (!status) status = block_get(v, n, &one);
        if (!status) add_sizes(&one, &v->sum);
    }
    if (!status) status = blocks_join(v);
    return status ? status : fields_carry(e, how, carried, v);
}

void joined_volume_release(joined_volume *v) {
    for (int n = 0; n < v->block_count && v->blocks; n++) tc_interval_volume_destroy(v->blocks[n]);
    for (int n = 0; n < v->field_count; n++) free(v->values[n]);
    free(v->blocks);
    free(v->values);
    free(v->positions);
    free(v->tetrahedra);
    *v = (joined_volume){0};
}

/* --------------------------------------------------------------------------------------------------------- figures */

int joined_volume_measure(const joined_volume *v, const carried_fields *carried, volume_report *report) {
    const tetrahedra_view view = {v->sum.positions, v->sum.vertex_count, v->sum.tetrahedra, v->sum.tetrahedron_count};
    size_t components = 0;
    for (int n = 0; n < carried->count; n++) components += (size_t)carried->from[n].components;
    report->sample_count = v->sum.sample_count;
    report->low_count = v->sum.low_count;
    report->high_count = v->sum.high_count;
    report->tetrahedron_count = v->sum.tetrahedron_count;
    report->bytes = 12 * v->sum.vertex_count + 16 * v->sum.tetrahedron_count;
    report->classify_ms = v->sum.timings.classify_ms;
    report->emit_ms = v->sum.timings.emit_ms;
    report->readback_ms = v->sum.timings.readback_ms;
    report->slab_count = v->sum.slab_count;
    report->has_volume = 1;
    report->integrals = calloc(components + 1, sizeof *report->integrals);
    if (!report->integrals) return fail(STATUS_FAILED, "out of memory for the report");
    double *integrals = report->integrals;
    int status = tetrahedra_integrate(&view, NULL, 0, &report->volume, NULL);
    for (int n = 0; n < carried->count && !status; integrals += carried->from[n++].components)
        status = tetrahedra_integrate(&view, v->values[n], carried->from[n].components, &report->volume, integrals);
    return status;
}

static int same(const void *a, const void *b, uint64_t bytes) { return !bytes || memcmp(a, b, (size_t)bytes) == 0; }

int joined_volume_verify(engine *reference, const tc_interval_volume_options *how, const joined_volume *v,
                         int *is_same) {
    static const carried_fields none;
    joined_volume r;
    int status = joined_volume_make(reference, how, &none, &r);
    *is_same = !status && r.sum.sample_count == v->sum.sample_count && r.sum.low_count == v->sum.low_count &&
               r.sum.high_count == v->sum.high_count && r.sum.tetrahedron_count == v->sum.tetrahedron_count &&
               same(r.sum.positions, v->sum.positions, 12 * v->sum.vertex_count) &&
               same(r.sum.tetrahedra, v->sum.tetrahedra, 16 * v->sum.tetrahedron_count);
    joined_volume_release(&r);
    return status;
}

/* --------------------------------------------------------------------------------------------------------- writing */

/* World coordinates in double precision, where blocks have an origin; NULL with *status 0 where none has. */
static double *world_points(const joined_volume *v, const engine *e, int *status) {
    int has_origin = 0;
    for (int n = 0; n < v->block_count; n++)
        for (int axis = 0; axis < 3; axis++) has_origin = has_origin || e->parts[n].origin[axis] != 0;
    *status = 0;
    if (!has_origin) return NULL;
    double *points = malloc((size_t)v->sum.vertex_count * 24 + 1), *to = points;
    const float *from = v->sum.positions;
    if (!points) *status = fail(STATUS_FAILED, "out of memory for coordinates in double precision");
    for (int n = 0; n < v->block_count && !*status; n++) {
        tc_interval_volume_data one;
        *status = block_get(v, n, &one);
        for (uint64_t m = 0; m < 3 * one.vertex_count && !*status; m++)
            *to++ = e->parts[n].origin[m % 3] + (double)*from++;
    }
    return points;
}

int joined_volume_write(const joined_volume *v, const engine *e, const carried_fields *carried, const dataset *d,
                        const char *path) {
    int status;
    double *points = world_points(v, e, &status);
    dataset_field *fields = calloc((size_t)carried->count + 1, sizeof *fields);
    if (!fields && !status) status = fail(STATUS_FAILED, "out of memory for the fields to carry");
    for (int n = 0; n < carried->count && !status; n++)
        fields[n] = (dataset_field){.name = carried->from[n].name,
                                    .components = carried->from[n].components,
                                    .type = TC_F32,
                                    .values = v->values[n]};
    const complex_file file = {.point_count = v->sum.vertex_count,
                               .points = points ? NULL : v->sum.positions,
                               .points_f64 = points,
                               .tetrahedron_count = v->sum.tetrahedron_count,
                               .tetrahedra = v->sum.tetrahedra,
                               .fields = fields,
                               .field_count = carried->count,
                               .world = d->world,
                               .units = d->units};
    if (!status) status = complex_write(path, &file);
    free(points);
    free(fields);
    return status;
}
