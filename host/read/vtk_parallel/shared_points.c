/*
 * shared_points.c - which points of the pieces of an unstructured grid are one; see shared_points.h
 *
 * Points are sorted by a key, their global number or a hash of their position, by a sort that takes time in proportion
 * to their count whatever they are. Those of one key follow each other then.
 */
#include "vtk_parallel/shared_points.h"

#include "exit_status.h"
#include "failure.h"
#include "sample_types.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct point_join {
    const piece_list *list;
    const int64_t *starts;
    shared_points *out;
} point_join;

/* ---------------------------------------------------------------------------------------------------------- sorting */

void entries_sort(sort_entry *entries, sort_entry *spare, size_t count) {
    sort_entry *from = entries, *to = spare;
    for (int shift = 0; shift < 64; shift += 8) {
        size_t starts[256] = {0}, at = 0;
        for (size_t n = 0; n < count; n++) starts[from[n].key >> shift & 255]++;
        if (count && starts[from[0].key >> shift & 255] == count) continue; /* all have this digit */
        for (int digit = 0; digit < 256; digit++) {
            const size_t here = starts[digit];
            starts[digit] = at;
            at += here;
        }
        for (size_t n = 0; n < count; n++) to[starts[from[n].key >> shift & 255]++] = from[n];
        sort_entry *other = from;
        from = to;
        to = other;
    }
    if (from != entries) memcpy(entries, from, count * sizeof *entries);
}

/* ---------------------------------------------------------------------------------------------------------- numbers */

const dataset_field *piece_numbers(const grid_piece *piece, int on_cells) {
    for (int n = 0; n < piece->block->field_count; n++) {
        const dataset_field *f = &piece->block->fields[n];
        if (f->is_number && f->on_cells == on_cells && f->components == 1 && !f->is_rounded) return f;
    }
    return NULL;
}

int pieces_have_numbers(const piece_list *list, int on_cells) {
    for (size_t p = 0; p < list->count; p++)
        if (!piece_numbers(&list->pieces[p], on_cells)) return 0;
    return 1;
}

/* In the order of the numbers, which may be below 0. Double has integers of 64 bits, too (load_field). */
uint64_t number_key(const dataset_field *f, int64_t n) {
    const double value = value_at(f->type, f->values, (uint64_t)n), most = (double)(INT64_C(1) << 62);
    const int64_t number = fabs(value) <= most ? (int64_t)value : 0;
    return (uint64_t)number ^ UINT64_C(1) << 63;
}

/* ----------------------------------------------------------------------------------------------------------- points */

static size_t piece_of(const point_join *j, int64_t point) {
    size_t low = 0, high = j->list->count;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        if (j->starts[middle] <= point)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* The bits of a coordinate; 0 and -0 are one position. */
static uint64_t position_bits(const dataset_block *b, int64_t n) {
    const double at = coordinate_at(b->points, n) + 0.0;
    uint64_t bits;
    memcpy(&bits, &at, sizeof bits);
    return bits;
}

static uint64_t position_key(const dataset_block *b, int64_t n) {
    uint64_t key = 0;
    for (int a = 0; a < 3; a++) key = mixed(key + position_bits(b, 3 * n + a) + UINT64_C(0x9e3779b97f4a7c15));
    return key;
}

static int compare_positions(const point_join *j, int64_t p, int64_t q) {
    const size_t of_p = piece_of(j, p), of_q = piece_of(j, q);
    for (int a = 0; a < 3; a++) {
        const uint64_t own = position_bits(j->list->pieces[of_p].block, 3 * (p - j->starts[of_p]) + a);
        const uint64_t other = position_bits(j->list->pieces[of_q].block, 3 * (q - j->starts[of_q]) + a);
        if (own != other) return own < other ? -1 : 1;
    }
    return 0;
}

static int compare_values(const point_join *j, int64_t p, int64_t q) {
    const size_t of_p = piece_of(j, p), of_q = piece_of(j, q);
    const dataset_block *first = j->list->pieces->block, *b = j->list->pieces[of_p].block,
                        *c = j->list->pieces[of_q].block;
    for (int n = 0; n < first->field_count; n++) {
        const dataset_field *f = &first->fields[n];
        const size_t bytes = (size_t)f->components * sample_bytes(f->type);
        if (f->on_cells) continue;
        const int order = memcmp(
            (const unsigned char *)piece_field(b, first, n)->values + bytes * (size_t)(p - j->starts[of_p]),
            (const unsigned char *)piece_field(c, first, n)->values + bytes * (size_t)(q - j->starts[of_q]), bytes);
        if (order) return order;
    }
    return 0;
}

static int by_index(const sort_entry *e, const sort_entry *f) { return (e->of > f->of) - (e->of < f->of); }

static int by_position(const void *first, const void *second, void *join) {
    const int order = compare_positions(join, ((const sort_entry *)first)->of, ((const sort_entry *)second)->of);
    return order ? order : by_index(first, second);
}

static int by_values(const void *first, const void *second, void *join) {
    const int order = compare_values(join, ((const sort_entry *)first)->of, ((const sort_entry *)second)->of);
    return order ? order : by_index(first, second);
}

/* ----------------------------------------------------------------------------------------------------------- groups */

/* Whether no piece has two of the points, which are in order. */
static int is_one_of_each(const point_join *j, const sort_entry *e, size_t count) {
    for (size_t n = 1; n < count; n++)
        if (piece_of(j, e[n].of) == piece_of(j, e[n - 1].of)) return 0;
    return 1;
}

static void join_group(point_join *j, const sort_entry *e, size_t count) {
    int differs = 0;
    for (size_t n = 0; n < count; n++) {
        j->out->sources[e[n].of] = e[0].of;
        j->out->is_shared[e[n].of] = count > 1;
        differs |= n && (compare_values(j, e[0].of, e[n].of) != 0 || compare_positions(j, e[0].of, e[n].of) != 0);
    }
    j->out->differing += differs;
}

static void join_by_values(point_join *j, sort_entry *e, size_t count) {
    qsort_r(e, count, sizeof *e, by_values, j);
    for (size_t n = 0, end; n < count; n = end) {
        for (end = n + 1; end < count && compare_values(j, e[n].of, e[end].of) == 0;) end++;
        if (is_one_of_each(j, e + n, end - n)) {
            join_group(j, e + n, end - n);
        } else {
            for (size_t m = n; m < end; m++) join_group(j, e + m, 1);
            j->out->unclear++;
        }
    }
}

/* Points of one position. */
static void join_position(point_join *j, sort_entry *e, size_t count) {
    if (is_one_of_each(j, e, count))
        join_group(j, e, count);
    else
        join_by_values(j, e, count);
}

/* Points of one key: nearly always of one position. */
static void join_positions(point_join *j, sort_entry *e, size_t count) {
    int is_one = 1;
    for (size_t n = 1; n < count && is_one; n++) is_one = compare_positions(j, e[0].of, e[n].of) == 0;
    if (!is_one) qsort_r(e, count, sizeof *e, by_position, j);
    for (size_t n = 0, end; n < count; n = end) {
        end = is_one ? count : n + 1;
        while (end < count && compare_positions(j, e[n].of, e[end].of) == 0) end++;
        join_position(j, e + n, end - n);
    }
}

static int join_number(point_join *j, const sort_entry *e, size_t count) {
    if (!is_one_of_each(j, e, count))
        return fail(STATUS_INPUT, "%s: has several points of the global number %" PRId64 "; the file is damaged",
                    j->list->pieces[piece_of(j, e[0].of)].path, (int64_t)(e[0].key ^ UINT64_C(1) << 63));
    join_group(j, e, count);
    for (size_t n = 0; n < count; n++) j->out->numbers[e[n].of] = j->out->count;
    j->out->count++;
    return 0;
}

static int join_all(point_join *j, sort_entry *entries, size_t count) {
    int status = 0;
    for (size_t n = 0, end; n < count && !status; n = end) {
        for (end = n + 1; end < count && entries[end].key == entries[n].key;) end++;
        if (j->out->by_number)
            status = join_number(j, entries + n, end - n);
        else
            join_positions(j, entries + n, end - n);
    }
    return status;
}

/* Points joined by their position keep the order of the pieces. */
static void number_in_order(point_join *j, int64_t total) {
    for (int64_t n = 0; n < total; n++) {
        const int64_t source = j->out->sources[n];
        if (source >= 0) j->out->numbers[n] = source == n ? j->out->count++ : j->out->numbers[source];
    }
}

static size_t make_entries(const point_join *j, const uint8_t *is_left_out, sort_entry *entries) {
    size_t count = 0;
    for (size_t p = 0; p < j->list->count; p++) {
        const grid_piece *piece = &j->list->pieces[p];
        const dataset_field *numbers = piece_numbers(piece, 0);
        for (int64_t n = 0; n < piece->block->point_count; n++) {
            const int64_t point = j->starts[p] + n;
            if (is_left_out[point]) continue;
            entries[count++] =
                (sort_entry){j->out->by_number ? number_key(numbers, n) : position_key(piece->block, n), point};
        }
    }
    return count;
}

int shared_points_find(const piece_list *list, const int64_t *starts, const uint8_t *is_left_out, shared_points *out) {
    const size_t total = (size_t)starts[list->count];
    point_join j = {list, starts, out};
    sort_entry *entries = malloc((total + 1) * sizeof *entries), *spare = malloc((total + 1) * sizeof *spare);
    *out = (shared_points){.numbers = malloc((total + 1) * sizeof *out->numbers),
                           .sources = malloc((total + 1) * sizeof *out->sources),
                           .is_shared = calloc(total + 1, 1),
                           .by_number = pieces_have_numbers(list, 0)};
    int status = 0;
    if (!entries || !spare || !out->numbers || !out->sources || !out->is_shared)
        status = fail(STATUS_FAILED, "%s: no memory to find the points that its pieces share", list->index->path);
    for (size_t n = 0; n < total && !status; n++) out->numbers[n] = out->sources[n] = -1;
    if (!status) {
        const size_t count = make_entries(&j, is_left_out, entries);
        entries_sort(entries, spare, count);
        status = join_all(&j, entries, count);
        if (!status && !out->by_number) number_in_order(&j, (int64_t)total);
    }
    free(entries);
    free(spare);
    return status;
}

void shared_points_release(shared_points *s) {
    free(s->numbers);
    free(s->sources);
    free(s->is_shared);
    *s = (shared_points){0};
}
