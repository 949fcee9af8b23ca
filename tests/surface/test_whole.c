/*
 * test_whole.c - method hybrid on cells of all types, and closed surfaces of these by both methods: kernels against the
 * reference, bit for bit
 *
 * Blocks of mixed cells under random point numbers, whole or with collapsed cells, prisms, and blocks of hexahedra; of
 * all sample types, with ties and missing samples. Each is counted, extracted and has a field carried, by both variants
 * of the kernels, with the caller's lists of cells and with gathered ones, with ranges and without, in one piece and in
 * slabs down to the least memory that does.
 *
 * Usage: test_whole [always_copy] [SEED [COUNT]]. A failure names its seed.
 */
#include "cut.h"
#include "engines.h"
#include "random.h"
#include "samples.h"

#include <inttypes.h>
#include <math.h>

static tc_context *reference;
static bool always_copy, repeats; /* repeats: a surface again takes as many slabs */

static void *memory_get(uint64_t bytes) {
    void *memory = calloc(bytes + 1, 1);
    if (!memory) exit(EXIT_FAILURE);
    return memory;
}

/* -------------------------------------------------------------------------------------------------------- subjects */

enum { ISOVALUES = 4 };

typedef struct subject {
    char name[120];
    cell_list list;
    tc_cells cells;
    tc_tetrahedra complex;
    tc_tetrahedra_grid_options options;
    void *values;
    float *field;
    double isovalues[ISOVALUES];
    tc_method method;
    int closed;
    tc_mesh *wanted[ISOVALUES];
    float *carried[ISOVALUES];
} subject;

/* Gives a corner of every fourth cell a point of its own, so that cells share half a quadrilateral, or nothing. */
static void cells_tear(cell_list *list) {
    const uint64_t room = list->point_count + list->cell_count;
    list->points = realloc(list->points, 12 * room + 1);
    if (!list->points) exit(EXIT_FAILURE);
    for (uint64_t c = 0; c < list->cell_count; c++) {
        const uint32_t corners = (uint32_t)(list->offsets[c + 1] - list->offsets[c]), n = random_below(4 * corners);
        int64_t *point = list->connectivity + list->offsets[c] + n;
        const float *p = n < corners ? list->points + 3 * *point : NULL;
        if (p) *point = cell_list_point(list, p[0], p[1], p[2]);
    }
    cell_list_renumber(list);
}

enum { MIXED, COLLAPSED, PRISMS, HEXAHEDRA, IN_ORDER, TORN, KINDS };

/* Begins the random numbers of a seed. */
static uint32_t kind_of(uint64_t seed) {
    random_state = seed * 0x2545f4914f6cdd1du;
    return random_below(KINDS);
}

static cell_list list_make(uint64_t seed, char *name) {
    static const char *const kinds[KINDS] = {"mixed block", "collapsed",          "prisms",
                                             "hexahedra",   "hexahedra in order", "torn"};
    const uint32_t kind = kind_of(seed), size = 1 + random_below(6);
    const uint64_t block_seed = random_u64();
    cell_list list = kind == PRISMS      ? honeycomb_make(size, block_seed)
                     : kind >= HEXAHEDRA ? hexahedra_make((uint32_t[3]){size, size, size}, kind != IN_ORDER)
                                         : mixed_block_make(size, block_seed);
    if (kind == COLLAPSED) cell_list_collapse(&list);
    if (kind == PRISMS) cell_list_drop_polyhedra(&list);
    if (kind == TORN) cells_tear(&list);
    random_state = block_seed;
    sprintf(name, "seed %" PRIu64 ": %s of %u", seed, kinds[kind], size);
    return list;
}

/* Half of the surfaces are closed, half of these by method tetra. */
static int closed_of(uint64_t seed) { return seed / 3 % 2 == 1; }
static tc_method method_of(uint64_t seed) { return seed / 3 % 4 == 3 ? TC_METHOD_TETRA : TC_METHOD_HYBRID; }

/* The quick tier builds kernels for some types only. */
static tc_type type_of(uint64_t seed) {
    static const tc_type quick[3] = {TC_U8, TC_F32, TC_F64};
    return tier_is_quick() ? quick[seed % (closed_of(seed) ? 2 : 3)] : (tc_type)(seed % 8);
}

/* Of a few values, or noise, or distances; some missing. */
static void values_choose(subject *s, tc_type type) {
    static const double odd[3] = {NAN, INFINITY, -INFINITY};
    const uint32_t kind = random_below(3), holes = type_is_floating(type) && random_below(3) == 0;
    for (uint64_t n = 0; n < s->list.point_count; n++) {
        const float *p = s->list.points + 3 * n;
        const double far = 2 * sqrt((double)(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]));
        const double value = kind == 0 ? random_below(5) : kind == 1 ? random_between(0, 100) : far;
        sample_set(s->values, type, (int64_t)n, holes && random_below(15) == 0 ? odd[random_below(3)] : value);
        s->field[n] = (float)random_between(-1, 1);
    }
    const double middle = kind == 0 ? 2 : kind == 1 ? 50.5 : 3.25;
    const double none = s->closed ? -1000 : 1000; /* all inside: of closed surfaces the border alone */
    for (int n = 0; n < ISOVALUES; n++) s->isovalues[n] = n == 1 ? 1.5 * middle : n == 3 ? none : middle;
    s->isovalues[0] = kind == 1 ? 30 : middle / 2;
}

static void field_carry(const subject *s, tc_grid *grid, const tc_extract_options *how, float *out, uint64_t count) {
    const tc_field field = {.struct_size = sizeof field, .type = TC_F32, .components = 1, .values = s->field};
    EXPECT(!tc_interpolate_field(grid, how, &field, out, count), "%s: %s", s->name, tc_message());
}

static tc_extract_options how_of(const subject *s, int n) {
    tc_extract_options how;
    tc_extract_options_init(&how);
    how.isovalue = s->isovalues[n], how.method = s->method, how.closed = s->closed;
    return how;
}

static tc_mesh_data mesh_of(tc_mesh *mesh) {
    tc_mesh_data data = {.struct_size = sizeof data};
    EXPECT(!tc_mesh_get(mesh, &data), "%s", tc_message());
    return data;
}

static void surfaces_of_reference(subject *s) {
    tc_grid *grid = NULL;
    EXPECT(!tc_tetrahedra_grid_create(reference, &s->options, &grid), "%s: %s", s->name, tc_message());
    for (int n = 0; n < ISOVALUES; n++) {
        const tc_extract_options how = how_of(s, n);
        EXPECT(!tc_extract(grid, &how, &s->wanted[n]), "%s: %s", s->name, tc_message());
        const uint64_t count = mesh_of(s->wanted[n]).vertex_count;
        s->carried[n] = memory_get(4 * count);
        field_carry(s, grid, &how, s->carried[n], count);
    }
    tc_grid_destroy(grid);
}

static void subject_make(subject *s, uint64_t seed, tc_type type) {
    *s = (subject){.name = "", .method = method_of(seed), .closed = closed_of(seed)};
    s->list = list_make(seed, s->name);
    s->values = memory_get(8 * s->list.point_count), s->field = memory_get(4 * s->list.point_count);
    s->cells = cell_list_view(&s->list);
    s->complex = cut(&s->cells, s->name);
    values_choose(s, type);
    snprintf(s->name + strlen(s->name), sizeof s->name - strlen(s->name), ", %s, %s%s", tc_type_name(type),
             tc_method_name(s->method), s->closed ? ", closed" : "");
    tc_tetrahedra_grid_options_init(&s->options);
    s->options.point_count = s->list.point_count, s->options.points = s->list.points;
    s->options.type = type, s->options.samples = s->values;
    s->options.tetrahedron_count = s->complex.tetrahedron_count, s->options.tetrahedra = s->complex.tetrahedra;
    s->options.source = &s->cells, s->options.cells = s->complex.cells;
    surfaces_of_reference(s);
}

static void subject_free(subject *s) {
    for (int n = 0; n < ISOVALUES; n++) {
        tc_mesh_destroy(s->wanted[n]);
        free(s->carried[n]);
    }
    tc_tetrahedra_release(&s->complex);
    cell_list_free(&s->list);
    free(s->values);
    free(s->field);
}

/* ------------------------------------------------------------------------------------------------------ comparison */

/* The surface of isovalue n is the reference's, by tc_count, tc_extract and tc_interpolate_field in random order.
 * Returns how many slabs it took, 0 where memory is too small even for one cluster. */
static uint32_t surface_compare(const subject *s, tc_grid *grid, tc_mesh **mesh, int n, const char *by) {
    const tc_extract_options how = how_of(s, n);
    const tc_mesh_data wanted = mesh_of(s->wanted[n]);
    tc_counts counts = {.struct_size = sizeof counts};
    float *carried = memory_get(4 * wanted.vertex_count);
    if (random_below(2)) {
        const tc_status status = tc_count(grid, &how, &counts);
        EXPECT(!status || status == TC_ERROR_MEMORY, "%s, %s: %s", s->name, by, tc_message());
        EXPECT(status ||
                   (counts.vertex_count == wanted.vertex_count && counts.triangle_count == wanted.triangle_count &&
                    counts.active_cell_count == wanted.active_cell_count),
               "%s, %s, isovalue %g: counts differ", s->name, by, how.isovalue);
    }
    const tc_status status = tc_extract(grid, &how, mesh);
    EXPECT(!status || status == TC_ERROR_MEMORY, "%s, %s, isovalue %g: %s", s->name, by, how.isovalue, tc_message());
    if (status) {
        free(carried);
        return 0;
    }
    const tc_mesh_data found = mesh_of(*mesh);
    const char *difference = mesh_difference(&wanted, &found);
    EXPECT(!difference, "%s, %s, isovalue %g, %u slabs: %s", s->name, by, how.isovalue, found.slab_count, difference);
    if (repeats) {
        EXPECT(!tc_extract(grid, &how, mesh) && mesh_of(*mesh).slab_count == found.slab_count,
               "%s, %s, isovalue %g: other slabs the second time", s->name, by, how.isovalue);
    }
    if (random_below(2)) tc_count(grid, &how, &counts); /* what is carried is that of the last call */
    field_carry(s, grid, &how, carried, wanted.vertex_count);
    EXPECT(!memcmp(carried, s->carried[n], 4 * wanted.vertex_count), "%s, %s, isovalue %g: the carried field differs",
           s->name, by, how.isovalue);
    free(carried);
    return found.slab_count;
}

static bool surfaces_compare(const subject *s, tc_context *context, const char *by, uint32_t *slabs) {
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_status status = tc_tetrahedra_grid_create(context, &s->options, &grid);
    bool fits = !status;
    EXPECT(!status || status == TC_ERROR_MEMORY, "%s, %s: %s", s->name, by, tc_message());
    for (int n = 0; n < ISOVALUES && fits; n++) {
        const uint32_t count = surface_compare(s, grid, &mesh, n, by);
        fits = count != 0;
        if (count > *slabs) *slabs = count;
    }
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    return fits;
}

static tc_context *device_open(uint64_t budget, bool groups) {
    tc_context_options how;
    tc_expert_options expert;
    options_init(&how, &expert);
    how.max_memory_bytes = budget;
    expert.always_copy = always_copy;
    if (groups) expert.work_items = 32, expert.work_groups = 3, expert.tile_bricks = 1, expert.spin_limit = 1;
    return context_open(&how);
}

static void run(uint64_t seed, tc_type type, tc_context *device, const char *by) {
    subject s;
    uint32_t slabs = 0;
    subject_make(&s, seed, type);
    EXPECT(surfaces_compare(&s, device, by, &slabs) && slabs == 1, "%s: %u slabs", s.name, slabs);
    subject_free(&s);
}

/* ---------------------------------------------------------------------------------------------------------- slabs */

/* Whether the budget does; *slabs: the most of any isovalue. */
static bool budget_compare(const subject *s, uint64_t budget, bool groups, uint32_t *slabs) {
    char by[60];
    tc_context *context = device_open(budget, groups);
    snprintf(by, sizeof by, "%" PRIu64 " bytes", budget);
    const bool fits = surfaces_compare(s, context, by, slabs);
    expect_within(context, budget, s->name);
    tc_context_destroy(context);
    return fits;
}

/* From more than enough down to the least that does. */
static void budgets_run(uint64_t seed, bool groups) {
    subject s;
    uint32_t slabs = 0;
    subject_make(&s, seed, type_of(seed));
    uint64_t budget = 1200 * s.list.cell_count + 20000;
    while (s.list.cell_count && budget_compare(&s, budget, groups, &slabs)) budget = budget / 20 * (slabs > 1 ? 9 : 16);
    uint64_t least = s.list.cell_count ? bytes_advised(s.name) : 0; /* without cells nothing takes memory */
    EXPECT(!least || least > budget, "%s: refused at %" PRIu64 " bytes, though %" PRIu64 " would do", s.name, budget,
           least);
    slabs = 0;
    if (least && !budget_compare(&s, least, groups, &slabs)) { /* that was for the tetrahedra, as the grid was made */
        least = bytes_advised(s.name);
        EXPECT(budget_compare(&s, least, groups, &slabs), "%s: %s", s.name, tc_message());
    }
    EXPECT(slabs >= s.list.cell_count / 16, "%s: %u slabs at the least", s.name, slabs);
    if (s.list.cell_count > 60)
        EXPECT(!budget_compare(&s, least - 1, groups, &slabs), "%s: less than the least does", s.name);
    subject_free(&s);
}

/* ------------------------------------------------------------------------------------------------------- refusals */

static tc_status hybrid_try(tc_context *context, const tc_tetrahedra_grid_options *o) {
    tc_extract_options how;
    tc_counts counts = {.struct_size = sizeof counts};
    tc_grid *grid = NULL;
    tc_extract_options_init(&how);
    how.isovalue = 0.5, how.method = TC_METHOD_HYBRID;
    tc_status status = tc_tetrahedra_grid_create(context, o, &grid);
    if (!status) status = tc_count(grid, &how, &counts);
    tc_grid_destroy(grid);
    return status;
}

/* A point that the cell does not have. */
static int64_t point_beside(const cell_list *list, uint64_t cell) {
    int64_t found = 0;
    for (int64_t n = list->offsets[cell]; n < list->offsets[cell + 1];)
        n = list->connectivity[n] == found ? (found++, list->offsets[cell]) : n + 1;
    return found;
}

/* Every cell is active, and each in its turn is not what its tetrahedra were cut from: refused as by the reference. */
static void refusals_run(tc_context *device) {
    cell_list list = mixed_block_make(3, 9);
    float *values = memory_get(4 * list.point_count);
    char wanted[400];
    tc_cells cells = cell_list_view(&list);
    tc_tetrahedra complex = cut(&cells, "refusals");
    tc_tetrahedra_grid_options o;
    tc_tetrahedra_grid_options_init(&o);
    o.point_count = list.point_count, o.points = list.points, o.type = TC_F32, o.samples = values;
    o.tetrahedron_count = complex.tetrahedron_count, o.tetrahedra = complex.tetrahedra;
    o.source = &cells, o.cells = complex.cells;
    for (uint64_t c = 0; c < list.cell_count; c++) {
        int64_t *point = list.connectivity + list.offsets[c], old = *point;
        const int64_t beside = point_beside(&list, c);
        const int64_t bad[5] = {point[1], (int64_t)list.point_count, -1, old + (INT64_C(1) << 32), beside};
        memset(values, 0, 4 * list.point_count);
        values[old] = 1;
        EXPECT(!hybrid_try(device, &o), "cell %" PRIu64 ": %s", c, tc_message());
        values[point[2]] = 1, values[old] = 0;
        for (int n = 0; n < 5; n++) {
            *point = bad[n];
            EXPECT_REFUSED(hybrid_try(reference, &o), TC_ERROR_DATA, "a changed corner, the reference");
            snprintf(wanted, sizeof wanted, "%s", tc_message());
            EXPECT_REFUSED(hybrid_try(device, &o), TC_ERROR_DATA, "a changed corner");
            EXPECT(!strcmp(wanted, tc_message()), "told \"%s\", not \"%s\"", tc_message(), wanted);
        }
        *point = old;
    }
    tc_tetrahedra_release(&complex);
    cell_list_free(&list);
    free(values);
}

/* Tetrahedra of cells in another order, of a cell twice, and not of all cells: as the reference has them. */
static void orders_run(tc_context *device) {
    subject s;
    uint32_t slabs = 0;
    for (int change = 0; change < 3; change++) {
        subject_make(&s, 3, TC_F32);
        const uint64_t count = s.complex.tetrahedron_count;
        uint32_t *tetrahedra = memory_get(32 * count), *numbers = memory_get(8 * count);
        uint64_t kept = 0;
        for (uint64_t n = 0, end; n < count; n = end) {
            for (end = n; end < count && s.complex.cells[end] == s.complex.cells[n];) end++;
            const int times = change == 0 ? 1 : change == 1 ? 1 + (int)random_below(2) : (int)random_below(2);
            for (int time = 0; time < times; time++, kept += end - n) {
                const uint64_t at = change ? kept : count - end; /* in reverse */
                memcpy(tetrahedra + 4 * at, s.complex.tetrahedra + 4 * n, 16 * (end - n));
                memcpy(numbers + at, s.complex.cells + n, 4 * (end - n));
            }
        }
        for (int n = 0; n < ISOVALUES; n++) tc_mesh_destroy(s.wanted[n]), s.wanted[n] = NULL, free(s.carried[n]);
        s.options.tetrahedra = tetrahedra, s.options.cells = numbers, s.options.tetrahedron_count = kept;
        snprintf(s.name, sizeof s.name, "order %d", change);
        surfaces_of_reference(&s);
        EXPECT(mesh_of(s.wanted[0]).triangle_count > 0, "%s: no surface", s.name);
        surfaces_compare(&s, device, "alone", &slabs);
        subject_free(&s);
        free(tetrahedra);
        free(numbers);
    }
}

int main(int argc, char **argv) {
    always_copy = argc > 1 && !strcmp(argv[1], "always_copy");
    argc -= always_copy, argv += always_copy;
    const uint64_t seed = argc > 1 ? strtoull(argv[1], NULL, 10) : 1,
                   count = argc > 2 ? strtoull(argv[2], NULL, 10) : tier_count(400);
    if (!device_exists()) return SKIPPED;
    reference = reference_open();
    tc_context *device = device_open(0, false);
    for (uint64_t n = seed; n < seed + count && test_chosen("alone"); n++) run(n, type_of(n), device, "alone");
    repeats = true;
    for (uint64_t n = seed; n < seed + count / 4 && test_chosen("slabs"); n++) {
        const bool halves = closed_of(n) && method_of(n) == TC_METHOD_HYBRID && kind_of(n) == TORN;
        if (n < seed + count / 20 || halves) budgets_run(n, false);
    }
    repeats = false;
    if (test_chosen("refusals")) refusals_run(device);
    if (test_chosen("orders")) orders_run(device);
    tc_context_destroy(device);
    if (test_chosen("groups")) {
        device = device_open(0, true);
        for (uint64_t n = seed; n < seed + count / 2; n++) run(n, TC_F32, device, "groups");
        tc_context_destroy(device);
    }
    tc_context_destroy(reference);
    return EXPECT_DONE();
}
