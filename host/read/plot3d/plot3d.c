/*
 * plot3d.c - Plot3D: a grid file and, beside it, a solution (Q) or function file
 *
 * Which of the two is the grid, and how each was written, follows from the files (plot3d_form.h): of all pairs of forms
 * in which one is a grid and the other a solution of the same blocks, the pair with the least padding is taken; among
 * equals the one whose values are plausible. Two that are equally good are refused.
 *
 * Every block is a curvilinear grid. IBLANK 0 blanks a point; other values say what a point borders on and are present.
 * Pressure is derived as (gamma - 1) (energy - momentum^2 / (2 density)), gamma being 1.4 unless the file has its own.
 */
#include "plot3d/plot3d.h"

#include "exit_status.h"
#include "failure.h"
#include "plot3d/plot3d_form.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SOLUTION_VARIABLES = 5, GAMMA_VARIABLE = 5, NAME_BYTES = 32, LINE_BYTES = 64, CHUNK_POINTS = 512 };
static const double GAMMA = 1.4;

/* A form of each file; data is NULL where there is a grid only. */
typedef struct pairing {
    const plot3d_file *grid_file, *data_file;
    const plot3d_form *grid, *data;
} pairing;

typedef struct choice {
    pairing best, rival; /* rival.grid is NULL where nothing else is as good */
    uint64_t padding;
    int is_physical;
} choice;

/* ----------------------------------------------------------------------------------------------------------- choice */

static int is_grid(const plot3d_form *form) {
    /* Of forms that are there. NOLINTNEXTLINE(clang-analyzer-core.NullDereference) */
    return form->content == PLOT3D_GRID || form->content == PLOT3D_GRID_IBLANK;
}

/* The first block in which they differ, block_count where one has fewer blocks, -1 where they agree. */
static int64_t differing_block(const plot3d_form *a, const plot3d_form *b) {
    int64_t count = a->block_count < b->block_count ? a->block_count : b->block_count;
    for (int64_t n = 0; n < count; n++)
        if (memcmp(a->blocks[n].dims, b->blocks[n].dims, sizeof a->blocks[n].dims)) return n;
    return a->block_count == b->block_count ? -1 : count;
}

static void consider(choice *c, pairing p) {
    uint64_t padding = p.grid->padding + (p.data ? p.data->padding : 0);
    if (c->best.grid && padding > c->padding) return;
    int physical = plot3d_is_physical(p.grid_file, p.grid) && (!p.data || plot3d_is_physical(p.data_file, p.data));
    if (c->best.grid && padding == c->padding) {
        if (physical < c->is_physical) return;
        if (physical == c->is_physical) {
            c->rival = p;
            return;
        }
    }
    *c = (choice){.best = p, .padding = padding, .is_physical = physical};
}

static int refuse_rivals(const plot3d_file *file, const plot3d_form *a, const plot3d_form *b) {
    char one[128], other[128];
    return fail(STATUS_INPUT,
                "%s: reads as %s and as %s, and nothing in it tells which; write it in another of Plot3D's forms",
                file->path, plot3d_describe(a, one), plot3d_describe(b, other));
}

static int choose_grid(const plot3d_file *file, pairing *out) {
    choice c = {0};
    for (int n = 0; n < file->form_count; n++) consider(&c, (pairing){.grid_file = file, .grid = &file->forms[n]});
    if (c.rival.grid) return refuse_rivals(file, c.best.grid, c.rival.grid);
    if (!is_grid(c.best.grid))
        return fail(STATUS_INPUT, "%s: is a Plot3D solution or function file; give its grid file too: GRID SOLUTION",
                    file->path);
    *out = c.best;
    return 0;
}

static int has_grid(const plot3d_file *file, int wanted) {
    for (int n = 0; n < file->form_count; n++)
        if (is_grid(&file->forms[n]) == wanted) return 1;
    return 0;
}

/* Why no form of one file goes with any of the other. */
static int refuse_pair(const plot3d_file *a, const plot3d_file *b) {
    if (!has_grid(a, 1) && !has_grid(b, 1))
        return fail(STATUS_INPUT, "%s, %s: both are Plot3D solution or function files; give a grid and its solution",
                    a->path, b->path);
    if (!has_grid(a, 0) && !has_grid(b, 0))
        return fail(STATUS_INPUT, "%s, %s: both are Plot3D grids; give a grid and its solution", a->path, b->path);
    const plot3d_form *one = &a->forms[0], *other = &b->forms[0];
    int64_t n = differing_block(one, other);
    if (n < 0 || n >= one->block_count || n >= other->block_count)
        return fail(STATUS_INPUT, "%s: has %" PRId64 " blocks, but %s has %" PRId64 "; they do not belong together",
                    a->path, one->block_count, b->path, other->block_count);
    const int64_t *p = one->blocks[n].dims, *q = other->blocks[n].dims;
    return fail(STATUS_INPUT,
                "%s: its block %" PRId64 " has %" PRId64 " x %" PRId64 " x %" PRId64 " points, but in %s %" PRId64
                " x %" PRId64 " x %" PRId64 "; they do not belong together",
                a->path, n + 1, p[0], p[1], p[2], b->path, q[0], q[1], q[2]);
}

static int choose_pair(const plot3d_file *a, const plot3d_file *b, pairing *out) {
    choice c = {0};
    for (int m = 0; m < a->form_count; m++)
        for (int n = 0; n < b->form_count; n++) {
            const plot3d_form *one = &a->forms[m], *other = &b->forms[n];
            if (is_grid(one) == is_grid(other) || differing_block(one, other) >= 0) continue;
            consider(&c, is_grid(one) ? (pairing){a, b, one, other} : (pairing){b, a, other, one});
        }
    if (!c.best.grid) return refuse_pair(a, b);
    if (c.rival.grid && (c.rival.grid_file != c.best.grid_file || c.rival.grid != c.best.grid))
        return refuse_rivals(c.best.grid_file, c.best.grid,
                             c.rival.grid_file == c.best.grid_file ? c.rival.grid : c.rival.data);
    if (c.rival.grid) return refuse_rivals(c.best.data_file, c.best.data, c.rival.data);
    *out = c.best;
    return 0;
}

/* ----------------------------------------------------------------------------------------------------------- memory */

/* One piece of memory for all blocks, however many and small these are. */
typedef struct arena {
    unsigned char *next;
} arena;

static uint64_t rounded(uint64_t bytes) { return (bytes + LINE_BYTES - 1) / LINE_BYTES * LINE_BYTES; }

static void *arena_take(arena *a, uint64_t bytes) {
    void *memory = a->next;
    a->next += rounded(bytes);
    return memory;
}

/* Of a coordinate. Text is read as doubles, since its numbers may have any count of digits. */
static uint64_t point_bytes(const pairing *p) { return (uint64_t)p->grid->value_bytes; }

static uint64_t field_bytes(const pairing *p) {
    return p->data->encoding != PLOT3D_TEXT && p->data->value_bytes == 8 ? 8 : 4;
}

static int has_pressure(const pairing *p) { return p->data->content != PLOT3D_FUNCTION; }

static int is_any_blanked(const pairing *p, const plot3d_block *block) {
    if (p->grid->content != PLOT3D_GRID_IBLANK) return 0;
    for (uint64_t i = 0; i < block->points; i++)
        if (plot3d_is_blanked(p->grid_file, p->grid, block, i)) return 1;
    return 0;
}

/* No product overflows: each is at most some tens of times the size of the files, or of the numbers of their text. */
static uint64_t count_bytes(const pairing *p) {
    uint64_t bytes = 0;
    for (int64_t n = 0; n < p->grid->block_count; n++) {
        uint64_t points = p->grid->blocks[n].points;
        bytes += rounded(points * 3 * point_bytes(p)) + rounded(points);
        if (!p->data) continue;
        bytes += p->data->blocks[n].variables * rounded(points * field_bytes(p));
        if (has_pressure(p)) bytes += rounded(points * sizeof(float));
    }
    return bytes;
}

/* ----------------------------------------------------------------------------------------------------------- blocks */

/* Returns the first point that is not blanked and has a coordinate that is not finite; count where there is none. Such
 * coordinates of blanked points become 0. */
static uint64_t settle_points(coordinates points, uint64_t count, const uint8_t *blanked) {
    for (uint64_t i = 0; i < count; i++) {
        int64_t at = 3 * (int64_t)i;
        if (isfinite(coordinate_at(points, at)) && isfinite(coordinate_at(points, at + 1)) &&
            isfinite(coordinate_at(points, at + 2)))
            continue;
        if (!blanked || !blanked[i]) return i;
        for (int64_t a = at; a < at + 3; a++) {
            if (points.f64) ((double *)(uintptr_t)points.f64)[a] = 0;
            if (points.f32) ((float *)(uintptr_t)points.f32)[a] = 0;
        }
    }
    return count;
}

static int load_points(const pairing *p, int64_t n, arena *memory, dataset_block *out) {
    const plot3d_block *from = &p->grid->blocks[n];
    void *points = arena_take(memory, from->points * 3 * point_bytes(p));
    for (uint64_t a = 0; a < 3; a++) {
        uint64_t values = from->values + a * from->points * (uint64_t)p->grid->value_bytes;
        if (point_bytes(p) == 8)
            plot3d_load_f64(p->grid_file, p->grid, values, from->points, (double *)points + a, 3);
        else
            plot3d_load_f32(p->grid_file, p->grid, values, from->points, (float *)points + a, 3);
    }
    uint8_t *blanked = is_any_blanked(p, from) ? arena_take(memory, from->points) : NULL;
    for (uint64_t i = 0; blanked && i < from->points; i++)
        blanked[i] = (uint8_t)plot3d_is_blanked(p->grid_file, p->grid, from, i);
    if (point_bytes(p) == 8)
        out->points.f64 = points;
    else
        out->points.f32 = points;
    out->blanked_points = blanked;
    uint64_t fault = settle_points(out->points, from->points, blanked);
    if (fault == from->points) return 0;
    return fail(STATUS_INPUT,
                "%s: point %" PRIu64 " of block %" PRId64
                " has a coordinate that is not finite; blank the point or correct it",
                p->grid_file->path, fault, n + 1);
}

static const char *variable_name(char *names, uint64_t variable) { return names + variable * NAME_BYTES; }

static int add_field(dataset_block *out, const char *name, tc_type type, const void *values) {
    dataset_field *field;
    int status = dataset_field_add(out, &field);
    if (!status) *field = (dataset_field){.name = name, .components = 1, .type = type, .values = values};
    return status;
}

/* Of up to CHUNK_POINTS points. */
static void derive_chunk(const pairing *p, const plot3d_block *from, uint64_t first, uint64_t count, float *out) {
    double q[SOLUTION_VARIABLES + 1][CHUNK_POINTS];
    int has_gamma = p->data->content == PLOT3D_OVERFLOW && from->variables > GAMMA_VARIABLE;
    for (uint64_t v = 0; v < SOLUTION_VARIABLES + (has_gamma ? 1U : 0U); v++)
        plot3d_load_f64(p->data_file, p->data,
                        from->values + (v * from->points + first) * (uint64_t)p->data->value_bytes, count, q[v], 1);
    for (uint64_t i = 0; i < count; i++) {
        double gamma = has_gamma ? q[GAMMA_VARIABLE][i] : GAMMA;
        double square = q[1][i] * q[1][i] + q[2][i] * q[2][i] + q[3][i] * q[3][i];
        out[i] = q[0][i] == 0 ? NAN : (float)((gamma - 1) * (q[4][i] - 0.5 * square / q[0][i]));
    }
}

static void derive_pressure(const pairing *p, const plot3d_block *from, float *out) {
    for (uint64_t first = 0; first < from->points; first += CHUNK_POINTS) {
        uint64_t rest = from->points - first;
        derive_chunk(p, from, first, rest < CHUNK_POINTS ? rest : CHUNK_POINTS, out + first);
    }
}

static int load_fields(const pairing *p, int64_t n, arena *memory, char *names, dataset_block *out) {
    const plot3d_block *from = &p->data->blocks[n];
    int status = 0;
    for (uint64_t v = 0; v < from->variables && !status; v++) {
        void *values = arena_take(memory, from->points * field_bytes(p));
        uint64_t offset = from->values + v * from->points * (uint64_t)p->data->value_bytes;
        if (field_bytes(p) == 8)
            plot3d_load_f64(p->data_file, p->data, offset, from->points, values, 1);
        else
            plot3d_load_f32(p->data_file, p->data, offset, from->points, values, 1);
        status = add_field(out, variable_name(names, v), field_bytes(p) == 8 ? TC_F64 : TC_F32, values);
    }
    if (status || !has_pressure(p)) return status;
    float *pressure = arena_take(memory, from->points * sizeof *pressure);
    derive_pressure(p, from, pressure);
    return add_field(out, "pressure", TC_F32, pressure);
}

/* The names of all variables that a block may have, one every NAME_BYTES. */
static char *make_names(const pairing *p, dataset *out) {
    static const char *const solution[] = {"density", "momentum-x", "momentum-y", "momentum-z", "energy", "gamma"};
    uint64_t count = 0;
    for (int64_t n = 0; n < p->data->block_count; n++)
        if (p->data->blocks[n].variables > count) count = p->data->blocks[n].variables;
    char *names = dataset_allocate(out, count * NAME_BYTES);
    for (uint64_t v = 0; names && v < count; v++) {
        if (p->data->content == PLOT3D_FUNCTION)
            snprintf(names + v * NAME_BYTES, NAME_BYTES, "function-%" PRIu64, v);
        else if (v < sizeof solution / sizeof *solution)
            snprintf(names + v * NAME_BYTES, NAME_BYTES, "%s", solution[v]);
        else
            snprintf(names + v * NAME_BYTES, NAME_BYTES, "q-%" PRIu64, v + 1);
    }
    return names;
}

static int load_block(const pairing *p, int64_t n, arena *memory, char *names, dataset *out) {
    const plot3d_block *from = &p->grid->blocks[n];
    dataset_block *block;
    int status = dataset_block_add(out, &block);
    if (status) return status;
    block->kind = BLOCK_CURVILINEAR;
    block->point_count = (int64_t)from->points;
    block->cell_count = 1;
    for (int a = 0; a < 3; a++) {
        block->dims[a] = from->dims[a];
        block->cell_count *= from->dims[a] - 1;
    }
    status = load_points(p, n, memory, block);
    return status || !p->data ? status : load_fields(p, n, memory, names, block);
}

static void note_padding(dataset *out, const plot3d_file *file, const plot3d_form *form) {
    const char *slash = strrchr(file->path, '/');
    if (form->padding)
        dataset_notice(out, "%" PRIu64 " bytes after the data of %.80s are left unread", form->padding,
                       slash ? slash + 1 : file->path);
}

static int load(const pairing *p, dataset *out) {
    char *names = NULL;
    if (p->grid->block_count > INT_MAX)
        return fail(STATUS_INPUT, "%s: has more than %d blocks", p->grid_file->path, INT_MAX);
    arena memory = {dataset_allocate(out, count_bytes(p))};
    if (!memory.next || (p->data && !(names = make_names(p, out)))) return STATUS_FAILED;
    for (int64_t n = 0; n < p->grid->block_count; n++) {
        int status = load_block(p, n, &memory, names, out);
        if (status) return status;
    }
    snprintf(out->format, sizeof out->format, "Plot3D");
    note_padding(out, p->grid_file, p->grid);
    if (p->data) note_padding(out, p->data_file, p->data);
    return 0;
}

int plot3d_read(const read_request *request, const mapping *grid, dataset *out) {
    plot3d_file first, second = {0};
    mapping other = {0};
    pairing chosen = {0};
    int status = plot3d_open(request->path, grid, &first);
    if (status) goto cleanup;
    if (request->path2) {
        if ((status = dataset_map(out, request->path2, &other)) ||
            (status = plot3d_open(request->path2, &other, &second)))
            goto cleanup;
        status = choose_pair(&first, &second, &chosen);
    } else {
        status = choose_grid(&first, &chosen);
    }
    if (!status) status = load(&chosen, out);
cleanup:
    plot3d_release(&first);
    plot3d_release(&second);
    mapping_close(&other);
    return status;
}
