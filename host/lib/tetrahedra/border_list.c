/*
 * Faces have hashes of 64 bits, and each point gathers those of its faces by exclusive or: those of a face that two
 * tetrahedra have cancel out. So what is left at a point is not 0 where it is on the border, but for a chance of one in
 * 2^64. Few tetrahedra have three such points; of these the faces are counted, in a table. Both passes over all
 * tetrahedra go by shares, whose order does not matter to the first; the second keeps what it finds by share.
 */
#include "tetrahedra/border_list.h"

#include "failure.h"
#include "tables/cell_cases.h"
#include "parallel.h"
#include "sample_types.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { SHARE = 1 << 16 };

/* Tetrahedra of a share that have three points or more on the border. */
typedef struct share_list {
    uint32_t *tetrahedra;
    uint32_t count, capacity;
} share_list;

/* A face, and how many tetrahedra have it; 0: free. */
typedef struct counted_face {
    uint32_t points[3], count;
} counted_face;

typedef struct search {
    const tc_grid *grid;
    const complex_grid *c;
    bool keeps_cells, has_gaps; /* has_gaps: a sample is missing */
    _Atomic uint64_t *hashes;   /* by point */
    uint64_t *marks;            /* a bit by point: it is on the border */
    uint64_t share_count;
    share_list *shares;
    _Atomic uint64_t next;
    atomic_bool failed;  /* there is no memory, or a point that the grid does not have */
    counted_face *table; /* open addressing, half full at most */
    uint64_t table_size;
    border_list *out;
    uint64_t capacity;
} search;

static tc_status memory_fail(void) { return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the border's faces"); }

/* -------------------------------------------------------------------------------------------------------- presence */

/* The end of a tetrahedron's cell; by method tetra it is one by itself. */
static uint64_t run_end(const search *s, uint64_t n) {
    const uint32_t cell = s->keeps_cells ? s->c->cells[n] : 0;
    for (n++; s->keeps_cells && n < s->c->tetrahedron_count && s->c->cells[n] == cell;) n++;
    return n;
}

/* The first run that begins from n on. */
static uint64_t run_begin(const search *s, uint64_t n) {
    const uint64_t count = s->c->tetrahedron_count;
    while (s->keeps_cells && n && n < count && s->c->cells[n] == s->c->cells[n - 1]) n++;
    return n < count ? n : count;
}

/* Of points that the grid does not have, which are found later, no sample is looked at. */
static bool run_is_present(const search *s, uint64_t first, uint64_t end) {
    const uint32_t *points = s->c->tetrahedra;
    bool missing = false;
    for (uint64_t n = 4 * first; n < 4 * end; n++)
        missing = missing || (points[n] < s->c->point_count && complex_point_missing(s->grid, points[n]));
    return !missing;
}

typedef bool run_visit(search *s, uint64_t share, uint64_t first, uint64_t end);

/* Visits the runs that begin in a share and are present; all at once where no sample is missing. */
static void share_walk(search *s, uint64_t share, run_visit *visit) {
    const uint64_t first = run_begin(s, share * SHARE), end = run_begin(s, (share + 1) * SHARE);
    bool done = s->has_gaps || visit(s, share, first, end);
    for (uint64_t n = first, behind; n < end && s->has_gaps && done; n = behind) {
        behind = run_end(s, n);
        done = !run_is_present(s, n, behind) || visit(s, share, n, behind);
    }
    if (!done) s->failed = true;
}

/* ---------------------------------------------------------------------------------------------------------- hashes */

static void pair_sort(uint32_t *a, uint32_t *b) {
    const uint32_t low = *a < *b ? *a : *b, high = *a < *b ? *b : *a;
    *a = low, *b = high;
}

/* points: ascending. */
static uint64_t face_hash(uint32_t a, uint32_t b, uint32_t c) {
    uint64_t hash = ((uint64_t)b << 32 | c) * 0x9e3779b97f4a7c15u;
    hash = ((hash ^ hash >> 32) + a) * 0xbf58476d1ce4e5b9u;
    return hash ^ hash >> 29;
}

static void hash_add(search *s, uint32_t point, uint64_t hash) {
    atomic_fetch_xor_explicit(&s->hashes[point], hash, memory_order_relaxed);
}

static bool run_hash(search *s, uint64_t share, uint64_t first, uint64_t end) {
    uint64_t gathered = 0; /* of the smallest point, which the tetrahedra of a cell share */
    uint32_t smallest = 0;
    (void)share;
    for (uint64_t n = first; n < end; n++) {
        uint32_t p[4];
        memcpy(p, s->c->tetrahedra + 4 * n, sizeof p);
        pair_sort(&p[0], &p[1]), pair_sort(&p[2], &p[3]), pair_sort(&p[0], &p[2]);
        pair_sort(&p[1], &p[3]), pair_sort(&p[1], &p[2]);
        if (p[3] >= s->c->point_count) return false;
        const uint64_t h0 = face_hash(p[1], p[2], p[3]), h1 = face_hash(p[0], p[2], p[3]),
                       h2 = face_hash(p[0], p[1], p[3]), h3 = face_hash(p[0], p[1], p[2]), all = h0 ^ h1 ^ h2 ^ h3;
        if (p[0] != smallest) hash_add(s, smallest, gathered), gathered = 0;
        smallest = p[0], gathered ^= all ^ h0;
        hash_add(s, p[1], all ^ h1), hash_add(s, p[2], all ^ h2), hash_add(s, p[3], all ^ h3);
    }
    hash_add(s, smallest, gathered);
    return true;
}

static void shares_hash(void *shared) {
    search *s = shared;
    uint64_t n;
    while ((n = atomic_fetch_add(&s->next, 1)) < s->share_count && !s->failed) share_walk(s, n, run_hash);
}

/* Hashes give way to marks. */
static tc_status points_mark(search *s) {
    const uint32_t count = s->c->point_count;
    s->marks = calloc(count / 64 + (size_t)1, sizeof *s->marks);
    if (!s->marks) return memory_fail();
    for (uint32_t n = 0; n < count; n++)
        s->marks[n / 64] |= (uint64_t)(atomic_load_explicit(&s->hashes[n], memory_order_relaxed) != 0) << n % 64;
    free(s->hashes);
    s->hashes = NULL;
    return TC_OK;
}

/* ------------------------------------------------------------------------------------------------------ candidates */

static unsigned is_marked(const search *s, uint32_t point) { return s->marks[point / 64] >> point % 64 & 1; }

static bool candidate_add(share_list *list, uint64_t tetrahedron) {
    if (list->count == list->capacity) {
        const uint32_t capacity = list->capacity ? 2 * list->capacity : 64;
        uint32_t *grown = realloc(list->tetrahedra, (size_t)capacity * sizeof *grown);
        if (!grown) return false;
        list->tetrahedra = grown, list->capacity = capacity;
    }
    list->tetrahedra[list->count++] = (uint32_t)tetrahedron;
    return true;
}

static bool run_collect(search *s, uint64_t share, uint64_t first, uint64_t end) {
    for (uint64_t n = first; n < end; n++) {
        const uint32_t *p = s->c->tetrahedra + 4 * n;
        const unsigned marked = is_marked(s, p[0]) + is_marked(s, p[1]) + is_marked(s, p[2]) + is_marked(s, p[3]);
        if (marked >= 3 && !candidate_add(&s->shares[share], n)) return false;
    }
    return true;
}

static void shares_collect(void *shared) {
    search *s = shared;
    uint64_t n;
    while ((n = atomic_fetch_add(&s->next, 1)) < s->share_count && !s->failed) share_walk(s, n, run_collect);
}

/* ----------------------------------------------------------------------------------------------------------- faces */

/* The side of a tetrahedron opposite to each of its corners, counter-clockwise seen from outside. */
static const uint8_t sides[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

/* The face's entry, or the free entry for it. */
static counted_face *face_find(const search *s, uint32_t a, uint32_t b, uint32_t c) {
    pair_sort(&a, &b), pair_sort(&b, &c), pair_sort(&a, &b);
    uint64_t n = face_hash(a, b, c) & (s->table_size - 1);
    for (counted_face *f;; n = (n + 1) & (s->table_size - 1)) {
        f = &s->table[n];
        if (!f->count) memcpy(f->points, (uint32_t[3]){a, b, c}, sizeof f->points);
        if (f->points[0] == a && f->points[1] == b && f->points[2] == c) return f;
    }
}

static bool may_be_border(const search *s, uint32_t a, uint32_t b, uint32_t c) {
    return is_marked(s, a) & is_marked(s, b) & is_marked(s, c);
}

static bool is_border_face(const search *s, uint32_t a, uint32_t b, uint32_t c) {
    return a != b && b != c && c != a && may_be_border(s, a, b, c) && face_find(s, a, b, c)->count == 1;
}

/* Counts the faces of a tetrahedron that may be on the border; in the table, once it is there. */
static uint64_t faces_enter(search *s, uint32_t tetrahedron) {
    const uint32_t *p = s->c->tetrahedra + 4 * (uint64_t)tetrahedron;
    uint64_t count = 0;
    for (int side = 0; side < 4; side++) {
        const uint32_t a = p[sides[side][0]], b = p[sides[side][1]], c = p[sides[side][2]];
        if (!may_be_border(s, a, b, c)) continue;
        if (s->table) face_find(s, a, b, c)->count++;
        count++;
    }
    return count;
}

static uint64_t candidates_enter(search *s) {
    uint64_t count = 0;
    for (uint64_t n = 0; n < s->share_count; n++)
        for (uint32_t m = 0; m < s->shares[n].count; m++) count += faces_enter(s, s->shares[n].tetrahedra[m]);
    return count;
}

static tc_status faces_count(search *s) {
    const uint64_t count = candidates_enter(s);
    for (s->table_size = 64; s->table_size < 2 * count;) s->table_size *= 2;
    s->table = calloc((size_t)s->table_size, sizeof *s->table);
    if (!s->table) return memory_fail();
    candidates_enter(s);
    return TC_OK;
}

static tc_status face_append(search *s, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    border_list *out = s->out;
    if (out->face_count == s->capacity) {
        const uint64_t capacity = s->capacity ? 2 * s->capacity : 256;
        cap_face *grown = realloc(out->faces, (size_t)capacity * sizeof *grown);
        if (!grown) return memory_fail();
        out->faces = grown, s->capacity = capacity;
    }
    out->faces[out->face_count++] = (cap_face){{a, b, c, d}};
    return TC_OK;
}

static tc_status tetrahedron_append(search *s, uint32_t n) {
    const uint32_t *p = s->c->tetrahedra + 4 * (uint64_t)n;
    tc_status status = TC_OK;
    for (int side = 0; side < 4 && !status; side++) {
        const uint32_t a = p[sides[side][0]], b = p[sides[side][1]], c = p[sides[side][2]];
        if (is_border_face(s, a, b, c)) status = face_append(s, a, b, c, CAP_TRIANGLE);
    }
    return status;
}

static tc_status cell_face_append(search *s, const uint32_t *points, const cell_face *face) {
    uint32_t p[CELL_FACE_CORNERS_MAX];
    tc_status status = TC_OK;
    for (int n = 0; n < face->corner_count; n++) p[n] = points[face->corners[n]];
    if (face->corner_count == 4) {
        const bool first = is_border_face(s, p[0], p[1], p[2]), second = is_border_face(s, p[0], p[2], p[3]);
        if (first && second) return face_append(s, p[0], p[1], p[2], p[3]);
        if (first) return face_append(s, p[2], p[0], p[1], CAP_HALF);
        return second ? face_append(s, p[0], p[2], p[3], CAP_HALF) : TC_OK;
    }
    for (int n = 1; n + 1 < face->corner_count && !status; n++)
        if (is_border_face(s, p[0], p[n], p[n + 1])) status = face_append(s, p[0], p[n], p[n + 1], CAP_TRIANGLE);
    return status;
}

/* The cells of the run in which tetrahedron n is; *end: of the run. */
static tc_status run_append(search *s, uint32_t n, uint64_t *end) {
    whole_cell cell;
    cell_frame frame;
    tc_status status = TC_OK;
    *end = run_end(s, n);
    while (n && s->c->cells[n - 1] == s->c->cells[n]) n--;
    for (; n < *end && !status; n += cell.tetrahedron_count) {
        status = complex_cell_get(s->c, n, &cell);
        if (status) break;
        cell_frame_begin(cell.shape, cell.corners, cell.mirrored, &frame);
        for (int f = 0; f < frame.face_count && !status; f++)
            status = cell_face_append(s, cell.corners, &frame.faces[f]);
    }
    return status;
}

static tc_status faces_append(search *s) {
    tc_status status = TC_OK;
    uint64_t end = 0;
    for (uint64_t n = 0; n < s->share_count; n++)
        for (uint32_t m = 0; m < s->shares[n].count && !status; m++) {
            const uint32_t tetrahedron = s->shares[n].tetrahedra[m];
            if (!s->keeps_cells)
                status = tetrahedron_append(s, tetrahedron);
            else if (tetrahedron >= end)
                status = run_append(s, tetrahedron, &end);
        }
    return status;
}

/* ---------------------------------------------------------------------------------------------------------- points */

/* The index of a point in the list; before: how many are marked before each word of marks. */
static uint32_t index_of(const search *s, const uint32_t *before, uint32_t point) {
    const uint64_t lower = s->marks[point / 64] & ((UINT64_C(1) << point % 64) - 1);
    return before[point / 64] + (uint32_t)__builtin_popcountll(lower);
}

/* Lists the points of faces, which are marked now, and gives faces their indices there. */
static tc_status points_list(search *s) {
    border_list *out = s->out;
    const uint64_t words = s->c->point_count / 64 + UINT64_C(1);
    uint32_t *before = malloc((size_t)words * sizeof *before);
    if (!before) return memory_fail();
    memset(s->marks, 0, (size_t)words * sizeof *s->marks);
    for (uint64_t n = 0; n < 4 * out->face_count; n++) {
        const uint32_t point = out->faces[n / 4].points[n % 4];
        if (point < CAP_HALF) s->marks[point / 64] |= UINT64_C(1) << point % 64;
    }
    for (uint64_t n = 0; n < words; n++) {
        before[n] = (uint32_t)out->point_count;
        out->point_count += (uint64_t)__builtin_popcountll(s->marks[n]);
    }
    out->points = malloc((size_t)out->point_count * sizeof *out->points + 1);
    uint32_t *points = out->points;
    for (uint64_t n = 0; n < words && points; n++)
        for (uint64_t rest = s->marks[n]; rest; rest &= rest - 1)
            *points++ = (uint32_t)(64 * n) + (uint32_t)__builtin_ctzll(rest);
    for (uint64_t n = 0; n < 4 * out->face_count; n++) {
        uint32_t *point = &out->faces[n / 4].points[n % 4];
        if (*point < CAP_HALF) *point = index_of(s, before, *point);
    }
    free(before);
    out->greatest = -INFINITY;
    for (uint64_t n = 0; n < out->point_count && points; n++)
        out->greatest = fmax(out->greatest, grid_value_at(s->grid, out->points[n]));
    return points ? TC_OK : memory_fail();
}

static tc_status search_run(search *s) {
    s->has_gaps = complex_has_gaps(s->grid);
    s->hashes = calloc((size_t)s->c->point_count, sizeof *s->hashes);
    s->shares = calloc((size_t)s->share_count + 1, sizeof *s->shares);
    if (!s->hashes || !s->shares) return memory_fail();
    parallel_run(s->share_count, shares_hash, s);
    if (s->failed) return complex_point_fail(s->c);
    tc_status status = points_mark(s);
    s->next = 0;
    if (!status) parallel_run(s->share_count, shares_collect, s);
    if (!status && s->failed) status = memory_fail();
    if (!status) status = faces_count(s);
    if (!status) status = faces_append(s);
    return status ? status : points_list(s);
}

tc_status border_list_provide(const tc_grid *grid, bool keeps_cells, border_list **out) {
    search s = {.grid = grid, .c = grid->complex, .keeps_cells = keeps_cells};
    if (*out) return TC_OK;
    if (grid->complex->point_count > CAP_HALF)
        return (tc_status)fail(TC_ERROR_LIMIT,
                               "surfaces of grids of %lu points are not closed: cut the grid into parts",
                               (unsigned long)grid->complex->point_count);
    s.share_count = (s.c->tetrahedron_count + (uint64_t)SHARE - 1) / SHARE;
    s.out = calloc(1, sizeof *s.out);
    if (!s.out) return memory_fail();
    tc_status status = search_run(&s);
    for (uint64_t n = 0; s.shares && n < s.share_count; n++) free(s.shares[n].tetrahedra);
    free(s.shares);
    free(s.hashes);
    free(s.marks);
    free(s.table);
    if (status)
        border_list_release(grid->context, s.out);
    else
        *out = s.out;
    return status;
}

void border_buffers_release(tc_context *context, border_list *border) {
    if (!border) return;
    buffer_release(context, &border->points_buffer);
    buffer_release(context, &border->faces_buffer);
}

void border_list_release(tc_context *context, border_list *border) {
    border_buffers_release(context, border);
    if (!border) return;
    free(border->points);
    free(border->faces);
    free(border);
}
