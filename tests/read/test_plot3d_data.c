/*
 * test_plot3d_data.c - published Plot3D files: sizes, ranges and blanking, and the same blocks in four encodings
 *
 * They are found through the environment variable TETRACUBES_DATA; where it is unset, this test says so and skips
 * (status 77).
 */
#include "plot3d_files.h"

enum { SKIPPED = 77 };

static const char *data_folder;

static int read_data(const char *grid, const char *data, dataset *d) {
    char grid_path[1024], data_path[1024];
    snprintf(grid_path, sizeof grid_path, "%s/curvilinear/%s", data_folder, grid);
    snprintf(data_path, sizeof data_path, "%s/curvilinear/%s", data_folder, data);
    int status = read_plot3d(grid_path, data_path, d);
    EXPECT(status == 0, "%s: %s", grid, failure_text());
    return status;
}

static void expect_range(const char *what, const dataset_block *block, const char *name, double low, double high) {
    const dataset_field *f = find_field(block, name);
    EXPECT(f, "%s: no %s", what, name);
    if (!f) return;
    double least = INFINITY, most = -INFINITY;
    for (int64_t i = 0; i < block->point_count; i++) {
        double value = field_value(f, (uint64_t)i);
        if (!isfinite(value)) continue;
        least = fmin(least, value);
        most = fmax(most, value);
    }
    EXPECT(fabs(least - low) < 5e-4 && fabs(most - high) < 5e-3, "%s: %s is in %.6g..%.6g, not %g..%g", what, name,
           least, most, low, high);
}

typedef struct data_case {
    const char *grid, *data;
    int64_t dims[3];
    const char *field;
    double low, high;
    int64_t blanked;
    const char *notice; /* a part of it; NULL: none */
} data_case;

static const data_case cases[] = {
    {"bluntfinxyz.bin", "bluntfinq.bin", {40, 32, 32}, "density", 0.1926, 4.9775, 0, "484 bytes"},
    {"bluntfinq.bin", "bluntfinxyz.bin", {40, 32, 32}, "density", 0.1926, 4.9775, 0, "484 bytes"},
    {"combxyz.bin", "combq.bin", {57, 33, 25}, "density", 0.198, 0.710, 0, NULL},
    {"combxyz.bin", "combq.bin", {57, 33, 25}, "energy", 0, 0, 0, NULL},
    {"postxyz.bin", "postq.bin", {38, 76, 38}, "energy", -0.5415, 4.396, 0, NULL},
    {"postxyz.bin", "postq.bin", {38, 76, 38}, "density", 1, 1, 0, NULL},
};

static void test_case(const data_case *c) {
    dataset d;
    if (read_data(c->grid, c->data, &d)) return;
    const dataset_block *block = &d.blocks[0];
    EXPECT(d.block_count == 1 && !memcmp(block->dims, c->dims, sizeof c->dims),
           "%s: %d blocks, %" PRId64 " x %" PRId64 " x %" PRId64, c->grid, d.block_count, block->dims[0],
           block->dims[1], block->dims[2]);
    expect_range(c->grid, block, c->field, c->low, c->high);
    int64_t blanked = 0;
    for (int64_t i = 0; block->blanked_points && i < block->point_count; i++) blanked += block->blanked_points[i];
    EXPECT(blanked == c->blanked, "%s: %" PRId64 " points are blanked", c->grid, blanked);
    EXPECT(c->notice ? strstr(d.notice, c->notice) != NULL : !*d.notice, "%s: notice '%s'", c->grid, d.notice);
    dataset_release(&d);
}

/* One grid and solution in text, Fortran records (f64), C binary and as OVERFLOW writes it; text has six digits. */
static void test_encodings(void) {
    static const char *const pairs[][2] = {{"multi-bin.xyz", "multi-bin.q"},
                                           {"multi-bin-C.xyz", "multi-bin-C.q"},
                                           {"multi-bin.xyz", "multi-bin-oflow.q"},
                                           {"multi-ascii.xyz", "multi-ascii.q"}};
    static const char *const fields[] = {"density", "momentum-x", "momentum-y", "momentum-z", "energy", "pressure"};
    dataset first, d;
    if (read_data(pairs[0][0], pairs[0][1], &first)) return;
    for (size_t n = 0; n < sizeof pairs / sizeof *pairs; n++) {
        if (read_data(pairs[n][0], pairs[n][1], &d)) continue;
        EXPECT(d.block_count == 2, "%s: %d blocks", pairs[n][0], d.block_count);
        for (int b = 0; b < d.block_count && d.block_count == 2; b++) {
            const dataset_block *block = &d.blocks[b], *other = &first.blocks[b];
            uint64_t wrong = 0;
            EXPECT(block->point_count == 1152 && block->dims[0] == 8 && block->dims[1] == 12 && block->dims[2] == 12,
                   "%s: block %d", pairs[n][0], b);
            for (int i = 0; i < 3 * 1152; i++)
                wrong += fabs(coordinate_at(block->points, i) - coordinate_at(other->points, i)) > 1e-6;
            for (int f = 0; f < 6; f++)
                for (uint64_t i = 0; i < 1152; i++)
                    wrong += fabs(field_value(find_field(block, fields[f]), i) -
                                  field_value(find_field(other, fields[f]), i)) > 2e-5;
            EXPECT(wrong == 0, "%s: %" PRIu64 " values of block %d differ", pairs[n][1], wrong, b);
        }
        dataset_release(&d);
    }
    dataset_release(&first);
}

static void test_tiny(void) {
    dataset d;
    if (read_data("tiny.xyz", "tiny.q", &d)) return;
    EXPECT(d.block_count == 5, "tiny: %d blocks", d.block_count);
    for (int b = 0; b < d.block_count; b++) EXPECT(d.blocks[b].point_count == 8, "tiny: block %d", b);
    expect_range("tiny", &d.blocks[0], "density", 0.9, 0.9);
    dataset_release(&d);
}

int main(void) {
    data_folder = getenv("TETRACUBES_DATA");
    if (!data_folder || !*data_folder) {
        printf("skipped: TETRACUBES_DATA is unset\n");
        return SKIPPED;
    }
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) test_case(&cases[n]);
    test_encodings();
    test_tiny();
    return EXPECT_DONE();
}
