#include "structured/crossed_rows.h"

#include "structured/structured_run.h"

#include <string.h>

/* ------------------------------------------------------------------------------------------------------- sign words */

static const uint64_t outside[BRICK_WORDS];

static const uint64_t *words_of(const classified_rows *r, uint64_t brick) {
    static const uint64_t inside[BRICK_WORDS] = {
        [0 ... BRICK_WORDS - 1] = UINT64_MAX,
    };
    const uint32_t sign = r->bricks[brick].sign;
    return sign == SIGN_MIXED ? r->words + BRICK_WORDS * brick : sign == SIGN_INSIDE ? inside : outside;
}

static const uint64_t *zeros_of(const classified_rows *r, uint64_t brick) {
    return r->bricks[brick].sign == SIGN_MIXED ? r->zeros + BRICK_WORDS * brick : outside;
}

/* Of a brick at higher y and z (side) only the first row and plane are needed. */
static void words_copy(const uint64_t *words, const int side[3], uint64_t out[BRICK_PLANES + 1][BRICK_ROWS + 1]) {
    const int planes = side[2] ? 1 : BRICK_PLANES;
    for (int z = 0; z < planes; z++, words += BRICK_ROWS) {
        uint64_t *to = out[side[2] ? BRICK_PLANES : z];
        if (side[1])
            to[BRICK_ROWS] = words[0];
        else
            memcpy(to, words, BRICK_ROWS * sizeof *words);
    }
}

void brick_words_load(const classified_rows *r, uint64_t brick, const uint32_t at[3], brick_words *w) {
    const uint64_t beside[3] = {1, r->plan->words_x, plan_bricks_per_layer(r->plan)};
    const uint32_t count[3] = {r->plan->words_x, r->plan->bricks_y, r->plan->layer_count};
    for (int n = 0; n < 8; n++) {
        const int side[3] = {n & 1, n >> 1 & 1, n >> 2};
        uint64_t other = brick;
        bool exists = true;
        for (int axis = 0; axis < 3; axis++) {
            exists = exists && at[axis] + (uint32_t)side[axis] < count[axis];
            other += side[axis] ? beside[axis] : 0;
        }
        words_copy(exists ? words_of(r, other) : outside, side, w->word[side[0]]);
        if (r->zeros) words_copy(exists ? zeros_of(r, other) : outside, side, w->zero[side[0]]);
    }
}

/* ------------------------------------------------------------------------------------------------------------ edges */

/* Rows of samples of a cube, and the same shifted to x + 1. */
typedef struct row_pair {
    uint64_t at, next, zero_at, zero_next;
} row_pair;

static row_pair row_of(const brick_words *w, int y, int z, uint64_t valid) {
    const uint64_t at = w->word[0][z][y] & valid, zero = w->zero[0][z][y];
    return (row_pair){at, at >> 1 | w->word[1][z][y] << 63, zero, zero >> 1 | w->zero[1][z][y] << 63};
}

/* Where the samples at the ends of an edge are on different sides. */
static uint64_t crossed_at(uint64_t p, uint64_t q, uint64_t zero_p, uint64_t zero_q) {
    return (p ^ q) & ~(zero_p | zero_q);
}

/* Samples of a word that exist. */
static uint64_t row_valid(const classified_rows *r, int64_t x) {
    const int64_t left = r->grid->dims[0] - x;
    return left >= 64 ? UINT64_MAX : (UINT64_C(1) << left) - 1;
}

/* As crossings_owned in kernels/structured/tetrahedra.cl: crossed edges that the samples of a row own. */
static void crossings_of(const classified_rows *r, const brick_words *w, int row, int plane, const int64_t p[3],
                         uint64_t crossed[EDGES_PER_SAMPLE]) {
    const int64_t *dims = r->grid->dims;
    const uint64_t valid = row_valid(r, p[0]), has_x = dims[0] - p[0] > 64 ? valid : valid >> 1;
    const uint64_t has_y = p[1] + 1 < dims[1] ? UINT64_MAX : 0, has_z = p[2] + 1 < dims[2] ? UINT64_MAX : 0;
    const bool odd = (grid_parity(r->grid) + (unsigned)(p[1] + p[2])) & 1;
    const uint64_t even = odd ? UINT64_C(0xaaaaaaaaaaaaaaaa) : UINT64_C(0x5555555555555555);
    const row_pair a = row_of(w, row, plane, valid), b = row_of(w, row + 1, plane, valid);
    const row_pair c = row_of(w, row, plane + 1, valid), d = row_of(w, row + 1, plane + 1, valid);
    const uint64_t xy = crossed_at(a.at, b.next, a.zero_at, b.zero_next),
                   yx = crossed_at(a.next, b.at, a.zero_next, b.zero_at);
    const uint64_t xz = crossed_at(a.at, c.next, a.zero_at, c.zero_next),
                   zx = crossed_at(a.next, c.at, a.zero_next, c.zero_at);
    const uint64_t yz = crossed_at(a.at, d.at, a.zero_at, d.zero_at), zy = crossed_at(b.at, c.at, b.zero_at, c.zero_at);
    crossed[EDGE_X] = crossed_at(a.at, a.next, a.zero_at, a.zero_next) & has_x;
    crossed[EDGE_Y] = crossed_at(a.at, b.at, a.zero_at, b.zero_at) & valid & has_y;
    crossed[EDGE_Z] = crossed_at(a.at, c.at, a.zero_at, c.zero_at) & valid & has_z;
    crossed[EDGE_XY] = ((even & xy) | (~even & yx)) & has_x & has_y;
    crossed[EDGE_XZ] = ((even & xz) | (~even & zx)) & has_x & has_z;
    crossed[EDGE_YZ] = ((even & yz) | (~even & zy)) & valid & has_y & has_z;
}

static bool cube_present(const tc_grid *grid, const int64_t p[3]) {
    const int64_t *dims = grid->dims;
    for (int axis = 0; axis < 3; axis++)
        if (p[axis] < 0 || p[axis] + 1 >= dims[axis]) return false;
    if (grid->blanked_cells && grid->blanked_cells[(p[2] * (dims[1] - 1) + p[1]) * (dims[0] - 1) + p[0]]) return false;
    for (int c = 0; c < 8; c++)
        if (grid_sample_missing(grid, ((p[2] + (c >> 2)) * dims[1] + p[1] + (c >> 1 & 1)) * dims[0] + p[0] + (c & 1)))
            return false;
    return true;
}

const uint8_t edge_type_axes[EDGES_PER_SAMPLE] = {1, 2, 4, 3, 5, 6};

/* Those of the crossed edges of a type that a present cube contains. */
static uint64_t present_only(const classified_rows *r, uint64_t crossed, int type, const int64_t first[3]) {
    uint64_t kept = 0;
    for (uint64_t rest = crossed; rest; rest &= rest - 1) {
        bool present = false;
        for (int back = 0; back < 8 && !present; back++) {
            const int64_t cube[3] = {first[0] + __builtin_ctzll(rest) - (back & 1), first[1] - (back >> 1 & 1),
                                     first[2] - (back >> 2)};
            present = !(back & edge_type_axes[type]) && cube_present(r->grid, cube);
        }
        if (present) kept |= rest & -rest;
    }
    return kept;
}

static bool at_border_of_cubes(const tc_grid *grid, const int64_t p[3]) {
    int present = 0;
    for (int c = 0; c < 8; c++)
        present += cube_present(grid, (int64_t[3]){p[0] - (c & 1), p[1] - (c >> 1 & 1), p[2] - (c >> 2)});
    return present > 0 && present < 8;
}

/* As border_samples in kernels/structured/border.cl: those of the samples of a row, from `first` on. */
static uint64_t border_only(const classified_rows *r, uint64_t samples, const int64_t first[3]) {
    const int64_t *dims = r->grid->dims, last = dims[0] - 1 - first[0];
    uint64_t kept = first[0] == 0 ? 1 : 0;
    if (!r->grid->device->missing) {
        const bool all = first[1] == 0 || first[1] + 1 == dims[1] || first[2] == 0 || first[2] + 1 == dims[2];
        if (last < 64) kept |= UINT64_C(1) << last;
        return all ? samples : samples & kept;
    }
    kept = 0;
    for (uint64_t rest = samples; rest; rest &= rest - 1)
        if (at_border_of_cubes(r->grid, (int64_t[3]){first[0] + __builtin_ctzll(rest), first[1], first[2]}))
            kept |= rest & -rest;
    return kept;
}

/* Where a row's vertices of a type end, counted from its first, as kernel 1 has packed it
 * (kernels/structured/tetrahedra.cl: offsets_pack). The end of the last type is not packed. */
static uint32_t type_end(uint64_t packed, int type) {
    static const uint8_t shift[] = {14, 21, 29, 37, 46}, width[] = {7, 8, 8, 9, 9};
    return (uint32_t)(packed >> shift[type]) & ((1u << width[type]) - 1);
}

/* Cells are looked at only where kernel 1 has counted fewer vertices than edges are crossed, and for the last type. */
static void crossings_keep(const classified_rows *r, uint64_t packed, const int64_t first[3],
                           uint64_t crossed[EDGES_PER_SAMPLE]) {
    uint32_t begin = 0;
    for (int type = 0; type < r->edge_types; type++) {
        const uint32_t end = type == EDGE_YZ ? begin : type_end(packed, type);
        if (begin + (uint32_t)__builtin_popcountll(crossed[type]) != end)
            crossed[type] = present_only(r, crossed[type], type, first);
        begin = end;
    }
}

crossed_row crossed_row_of(const classified_rows *r, const brick_words *w, int row, int plane, const int64_t p[3],
                           uint64_t packed) {
    crossed_row out = {.border = 0};
    crossings_of(r, w, row, plane, p, out.crossed);
    if (r->grid->device->missing) crossings_keep(r, packed, p, out.crossed);
    const row_pair own = row_of(w, row, plane, row_valid(r, p[0]));
    out.zeros = own.zero_at;
    if (r->is_closed) out.border = border_only(r, own.at, p);
    return out;
}
