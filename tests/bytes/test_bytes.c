/*
 * test_bytes.c - one hash per case, however a device is told to work
 *
 * Every case (cases.h) is extracted by the scalar reference, then by the device in every variant: work-items, groups,
 * tiles, the scan's fallback, ways to divide, slabs, buffers of its own, and a second visit that knows the ranges of
 * bricks. Hashes are of positions, normals and triangles, with the labels of these; of interval volumes of positions
 * and tetrahedra. What else must not matter, number of threads and OpenCL implementation, is the environment's:
 * bytes.py runs this under several and compares what is printed.
 *
 * Usage: test_bytes [whole|sample|small|groups [TEXT]]: sample: some of the cases; small: all, of small grids, in the
 * variants that take other ways through the kernels, for devices that simulate; groups: likewise, of structured grids,
 * only variants of many work-items per group; planted: one case, in one variant of which a sample is changed, which has
 * to fail; TEXT: only cases that have it in their names; after "=" it is a whole name. Prints a line "case NAME: HASH"
 * for each; a difference names case and variant. Seeds are fixed. test_bytes driver [TEXT [WORK_ITEMS]]: all cases of
 * small grids once, for the table of drivers; WORK_ITEMS: which of the two variants of the kernels, left out what the
 * device gets. Prints what the device is, too, and "refused NAME: no fp64" for a case that is the reference's alone
 * there; "known fault: TEXT" where the library refuses the driver to who asks for a trial.
 */
#include "cases.h"

#include "engines.h"
#include "random.h"

#include <inttypes.h>

typedef struct variant {
    const char *name;
    uint32_t work_items, work_groups, tile_bricks, spin_limit;
    tc_division division;
    int always_copy;
    bool again;      /* another isovalue has been before */
    unsigned memory; /* bound on buffers, in percent of what is used without one, and more if need be; 0: none */
    bool small;      /* is one of those for small grids */
} variant;

static const variant variants[] = {
    {"defaults", 1, 0, 0, 0, 0, 0, false, 0, true},
    {"one group, tiles of one brick", 1, 1, 1, 0, 0, 0, false, 0, false},
    {"16 groups, tiles of one brick", 1, 16, 1, 0, 0, 0, false, 0, true},
    {"3 groups, tiles of 7 bricks", 1, 3, 7, 0, 0, 0, false, 0, false},
    {"every tile before recounted", 1, 16, 1, 1, 0, 0, false, 0, true},
    {"second visit", 1, 2, 1, 0, 0, 0, true, 0, true},
    {"second visit, one tile", 1, 1, 1000, 0, 0, 0, true, 0, false},
    {"buffers of its own", 1, 0, 0, 0, 0, 1, false, 0, false},
    {"some memory", 1, 2, 2, 0, 0, 0, false, 31, false},
    {"least memory", 1, 2, 1, 0, 0, 0, false, 7, true},
    {"least memory, buffers of its own", 1, 2, 1, 0, 0, 1, true, 7, false},
    {"division through fp64", 1, 0, 0, 0, TC_DIVISION_FP64, 0, false, 0, false},
    {"division in integers", 1, 0, 0, 0, TC_DIVISION_INTEGER, 0, false, 0, false},
    {"32 work-items", 32, 0, 0, 0, 0, 0, false, 0, true},
    {"32 work-items, 16 groups, tiles of one brick", 32, 16, 1, 0, 0, 0, false, 0, false},
    {"32 work-items, every tile before recounted", 32, 16, 1, 1, 0, 0, false, 0, true},
    {"32 work-items, second visit", 32, 2, 1, 0, 0, 0, true, 0, true},
    {"32 work-items, least memory", 32, 2, 1, 0, 0, 0, false, 7, false},
    {"64 work-items", 64, 0, 0, 0, 0, 0, false, 0, false},
    {"64 work-items, 3 groups, tiles of one brick", 64, 3, 1, 0, 0, 0, true, 0, false},
    {"256 work-items, 3 groups", 256, 3, 0, 0, 0, 0, false, 0, false},
    {"256 work-items, tiles of one brick", 256, 16, 1, 1, 0, 0, true, 0, false},
};

enum { VARIANTS = sizeof variants / sizeof *variants };

typedef enum tier { WHOLE, SAMPLE, SMALL, GROUPS, PLANTED, DRIVER } tier;

static const char *const tier_names[] = {"whole", "sample", "small", "groups", "planted", "driver"};

static variant for_driver = {.name = "as asked for"};
static bool takes_alone, has_fp64; /* the device takes kernels for one work-item per group; knows double */

static struct {
    long cases, meshes, slab_meshes;
    bool used[VARIANTS];
} done;

/* What a grid gives, whichever it is. */
typedef struct product {
    tc_mesh *mesh;
    tc_interval_volume *interval;
    uint32_t slabs;
    uint64_t hash; /* of all its arrays; 0 where there is nothing */
} product;

static tc_status surface_make(tc_grid *grid, const case_data *data, bool again, product *p) {
    tc_mesh_data made = {.struct_size = sizeof made};
    tc_extract_options other = data->how;
    other.isovalue += 2.5;
    tc_status status = again ? tc_extract(grid, &other, &p->mesh) : TC_OK;
    if (!status) status = tc_extract(grid, &data->how, &p->mesh);
    if (!status) status = tc_mesh_get(p->mesh, &made);
    p->slabs = made.slab_count;
    p->hash = made.triangle_count ? mesh_bytes_hash(&made) : 0;
    return status;
}

static tc_status labels_make(tc_grid *grid, const case_data *data, bool again, product *p) {
    static const uint32_t one = 1;
    tc_mesh_data made = {.struct_size = sizeof made};
    tc_labels_options other = data->labels;
    other.labels = &one;
    other.label_count = 1;
    tc_status status = again ? tc_extract_labels(grid, &other, &p->mesh) : TC_OK;
    if (!status) status = tc_extract_labels(grid, &data->labels, &p->mesh);
    if (!status) status = tc_mesh_get(p->mesh, &made);
    p->slabs = made.slab_count;
    p->hash = made.triangle_count ? mesh_bytes_hash(&made) : 0;
    return status;
}

static tc_status interval_make(tc_grid *grid, const case_data *data, bool again, product *p) {
    tc_interval_volume_data made = {.struct_size = sizeof made};
    tc_interval_volume_options other = data->interval;
    other.low += 2.5;
    tc_status status = again ? tc_extract_interval_volume(grid, &other, &p->interval) : TC_OK;
    if (!status) status = tc_extract_interval_volume(grid, &data->interval, &p->interval);
    if (!status) status = tc_interval_volume_get(p->interval, &made);
    p->slabs = made.slab_count;
    p->hash = made.tetrahedron_count ? interval_bytes_hash(&made) : 0;
    return status;
}

/* The hash of all that comes out; 0 where a memory bound does not suffice. */
static uint64_t hash_of(tc_context *context, const bytes_case *c, const case_data *data, bool again, uint32_t *slabs,
                        const char *what) {
    tc_grid *grid = NULL;
    product p = {0};
    tc_status status = data->complex.points ? tc_tetrahedra_grid_create(context, &data->complex, &grid)
                                            : tc_grid_create(context, &data->grid, &grid);
    if (!status)
        status = c->flags & CASE_LABELS     ? labels_make(grid, data, again, &p)
                 : c->flags & CASE_INTERVAL ? interval_make(grid, data, again, &p)
                                            : surface_make(grid, data, again, &p);
    EXPECT(!status || (status == TC_ERROR_MEMORY && slabs), "%s: %s", what, tc_message());
    if (slabs) *slabs = p.slabs;
    EXPECT(status || p.hash, "%s: nothing comes out", what);
    tc_mesh_destroy(p.mesh);
    tc_interval_volume_destroy(p.interval);
    tc_grid_destroy(grid);
    return status ? 0 : p.hash;
}

static tc_context *variant_open(const variant *v, uint64_t memory) {
    tc_context_options options;
    tc_expert_options expert;
    options_init(&options, &expert);
    expert.work_items = v->work_items;
    expert.work_groups = v->work_groups;
    expert.tile_bricks = v->tile_bricks;
    expert.spin_limit = v->spin_limit;
    expert.division = v->division;
    expert.always_copy = v->always_copy || getenv("TEST_BYTES_ALWAYS_COPY");
    options.max_memory_bytes = memory;
    return context_open(&options);
}

static bool case_wanted(const bytes_case *c, tier t) {
    return t == SAMPLE   ? c->sampled
           : t == GROUPS ? c->groups & 1 && c->kind != CASE_COMPLEX
                         : t != PLANTED || c == cases;
}

static bool variant_wanted(const bytes_case *c, const variant *v, tier t, bool groups) {
    if (groups != (v->work_items != 1) || (!groups && !takes_alone)) return false;
    if (v->memory && !(c->flags & CASE_DEEP)) return false;
    if (v->memory && t >= SMALL && c->method == TC_METHOD_SNAP) return false; /* slabs of a small grid are the whole */
    if (t >= SMALL && c->flags & CASE_DEEP && !v->memory && v != variants) return false;
    if (v->division && (c->kind == CASE_COMPLEX || c->type != TC_F32 || t != WHOLE)) return false;
    if (t >= SMALL && !v->small) return false;
    if (t == GROUPS && !groups) return false;
    if (t == SAMPLE && c->kind == CASE_COMPLEX && v->work_items > 32) return false;
    return v->work_items == 1 || (c->groups * 32 & v->work_items);
}

/* The least difference: a sample that equals the isovalue is lowered by one, or put back. */
static void tie_add(case_data *data, int step) {
    static uint8_t *tie;
    if (step < 0)
        for (tie = data->samples; *tie != data->how.isovalue;) tie++;
    *tie = (uint8_t)(*tie + step);
}

/* The hash in a variant. A bound on memory that does not suffice is raised until it does. */
static uint64_t variant_run(const bytes_case *c, const variant *v, const case_data *data, uint64_t *memory,
                            const char *what) {
    uint64_t hash = 0;
    for (unsigned percent = v->memory; !hash && percent < 100; percent += 4) {
        uint32_t slabs = 0;
        tc_context *device = variant_open(v, *memory * percent / 100);
        hash = hash_of(device, c, data, v->again, percent ? &slabs : NULL, what);
        if (!*memory) tc_context_device_bytes(device, memory);
        tc_context_destroy(device);
        done.slab_meshes += slabs > 1;
        if (!percent) break;
    }
    done.meshes += hash != 0;
    return hash;
}

static void variant_compare(const bytes_case *c, const variant *v, case_data *data, uint64_t wanted, uint64_t *memory,
                            tier t) {
    char what[240];
    snprintf(what, sizeof what, "%s, %s", case_name(c), v->name);
    if (t == PLANTED && v->spin_limit) tie_add(data, -1);
    uint64_t hash = variant_run(c, v, data, memory, what);
    if (t == PLANTED && v->spin_limit) tie_add(data, 1);
    EXPECT(hash == wanted, "%s: hash %016" PRIx64 ", the reference's is %016" PRIx64, what, hash, wanted);
}

static bool case_has_variants(const bytes_case *c, tier t, bool groups) {
    for (int n = 0; n < VARIANTS && t != DRIVER; n++)
        if (variant_wanted(c, &variants[n], t, groups)) return true;
    return false;
}

/* A device without fp64 refuses tetrahedra and interval volumes whose vertices are made in double. */
static bool case_refused(const bytes_case *c) {
    return !has_fp64 && (c->kind == CASE_COMPLEX || c->flags & CASE_INTERVAL) &&
           (c->type == TC_U32 || c->type == TC_I32 || c->type == TC_F64);
}

/* In the variants of one work-item per group, or in those of many. */
static void case_run(const bytes_case *c, tc_context *reference, tier t, bool groups) {
    case_data data;
    char name[120];
    uint64_t memory = 0;
    if (groups && !case_has_variants(c, t, groups)) return; /* the reference would be made for nothing */
    snprintf(name, sizeof name, "%s", case_name(c));
    case_fill(c, t >= SMALL, &data);
    uint64_t wanted = hash_of(reference, c, &data, false, NULL, name);
    if (t == DRIVER && !groups && case_refused(c)) printf("refused %s: no fp64\n", name);
    if (t == DRIVER && !groups && !case_refused(c)) variant_compare(c, &for_driver, &data, wanted, &memory, t);
    for (int n = 0; n < VARIANTS && t != DRIVER; n++) {
        if (!variant_wanted(c, &variants[n], t, groups)) continue;
        variant_compare(c, &variants[n], &data, wanted, &memory, t);
        done.used[n] = true;
    }
    if (!groups) printf("case %s: %016" PRIx64 "\n", name, wanted);
    fflush(stdout);
    done.cases += !groups;
    case_free(&data);
}

/* Whether a name has the text in it, or is it, where the text begins with "=". */
static bool name_wanted(const char *name, const char *text) {
    return *text == '=' ? !strcmp(name, text + 1) : strstr(name, text) != NULL;
}

/* Says what the device is, and finds out what it takes. */
static void device_tell(void) {
    tc_device_info info = {.struct_size = sizeof info};
    tc_tuning tuning = {.struct_size = sizeof tuning};
    tc_context_options options;
    tc_expert_options expert;
    tc_context *device = variant_open(&for_driver, 0), *alone = NULL, *checked = NULL;
    EXPECT(!tc_context_device(device, &info) && !tc_context_tuning(device, &tuning), "%s", tc_message());
    has_fp64 = info.has_fp64;
    printf("device %s, %s, driver %s\n", info.platform, info.name, info.driver);
    printf("launched with %u work-items as %s, version %s\n", tuning.work_items, info.type, info.version);
    tc_context_destroy(device);
    options_init(&options, &expert);
    expert.work_items = 1;
    takes_alone = !tc_context_create(&options, &alone);
    tc_context_destroy(alone);
    options_init(&options, &expert);
    options.check_device = 1;
    if (tc_context_create(&options, &checked) == TC_ERROR_WRONG_RESULT) printf("known fault: %s\n", tc_message());
    tc_context_destroy(checked);
}

int main(int argc, char **argv) {
    tier t = DRIVER;
    while (t > WHOLE && (argc < 2 || strcmp(argv[1], tier_names[t]) != 0)) t--;
    const char *text = argc > 2 ? argv[2] : "";
    if (t == DRIVER && argc > 3) for_driver.work_items = (uint32_t)strtoul(argv[3], NULL, 10);
    int used = 0;
    if (!device_exists()) return SKIPPED;
    device_tell();
    tc_context *reference = reference_open();
    for (int groups = 0; groups < 2; groups++) {
        if (groups) groups_begin();
        for (int n = 0; n < case_count; n++)
            if (case_wanted(&cases[n], t) && name_wanted(case_name(&cases[n]), text))
                case_run(&cases[n], reference, t, groups);
    }
    for (int n = 0; n < VARIANTS; n++) used += done.used[n];
    EXPECT(done.slab_meshes > 1 || t >= GROUPS || *text || !takes_alone, "%ld meshes made in slabs", done.slab_meshes);
    EXPECT(done.cases > 0, "no case has %s in its name", text);
    printf("figures %ld cases, %d variants, %ld meshes, %ld in slabs\n", done.cases, used, done.meshes,
           done.slab_meshes);
    tc_context_destroy(reference);
    return EXPECT_DONE();
}
