#include "vtk_parallel/pieces.h"

#include "exit_status.h"
#include "failure.h"
#include "sample_types.h"

#include <string.h>

const dataset_field *piece_field(const dataset_block *block, const dataset_block *of, int field) {
    const dataset_field *wanted = &of->fields[field];
    int nth = 0;
    for (int n = 0; n < field; n++)
        nth += of->fields[n].on_cells == wanted->on_cells && strcmp(of->fields[n].name, wanted->name) == 0;
    if (field < block->field_count) { /* pieces have their arrays in one order, as a rule */
        const dataset_field *same = &block->fields[field];
        if (!nth && same->on_cells == wanted->on_cells && strcmp(same->name, wanted->name) == 0) return same;
    }
    for (int n = 0; n < block->field_count; n++) {
        const dataset_field *f = &block->fields[n];
        if (f->on_cells == wanted->on_cells && strcmp(f->name, wanted->name) == 0 && !nth--) return f;
    }
    return NULL;
}

int pieces_add_fields(const piece_list *list, dataset *out, dataset_block *whole, unsigned char ***values) {
    const dataset_block *first = list->pieces->block;
    unsigned char **arrays = dataset_allocate(out, (uint64_t)(first->field_count + 1) * sizeof *arrays);
    *values = arrays;
    if (!arrays) return STATUS_FAILED;
    for (int n = 0; n < first->field_count; n++) {
        const dataset_field *f = &first->fields[n];
        const uint64_t tuples = (uint64_t)(f->on_cells ? whole->cell_count : whole->point_count);
        uint64_t bytes;
        dataset_field *added;
        if (__builtin_mul_overflow(tuples, (uint64_t)f->components * sample_bytes(f->type), &bytes))
            return fail(STATUS_INPUT, "%s: its array '%.60s' is too large", list->index->path, f->name);
        if (dataset_field_add(whole, &added)) return STATUS_FAILED;
        *added = *f;
        added->is_number = 0;
        added->name = dataset_text(out, f->name);
        added->values = arrays[n] = dataset_allocate(out, bytes);
        if (!added->name || !added->values) return STATUS_FAILED;
        for (size_t p = 0; p < list->count; p++)
            added->is_rounded |= piece_field(list->pieces[p].block, first, n)->is_rounded;
    }
    return 0;
}

int pieces_add_coordinates(dataset *out, coordinates like, uint64_t count, coordinates *to, unsigned char **memory) {
    *memory = dataset_allocate(out, count * coordinate_bytes(like));
    *to = (coordinates){.f32 = like.f64 ? NULL : (const float *)(const void *)*memory,
                        .f64 = like.f64 ? (const double *)(const void *)*memory : NULL};
    return *memory ? 0 : STATUS_FAILED;
}

int piece_coordinates_fit(const piece_list *list, const grid_piece *piece, coordinates own, coordinates first) {
    if (!own.f64 == !first.f64) return 0;
    return fail(STATUS_INPUT, "%s: its coordinates are of %s, those of %s of %s: pieces have to have one type",
                piece->path, own.f64 ? "double" : "float", list->pieces->path, first.f64 ? "double" : "float");
}
