/*
 * test_plot3d.c - the Plot3D reader: every form that files come in, by all their values, and files that are damaged
 */
#include "plot3d_files.h"

#include "random.h"

static const char *describe(const variant *v) {
    static char text[128];
    static const char *const encodings[] = {"text", "4-byte records", "8-byte records", "C binary"};
    static const char *const contents[] = {"grid only", "solution", "OVERFLOW 5", "OVERFLOW 8", "function"};
    snprintf(text, sizeof text, "%s, %s-endian, f%d, %d blocks, %s%s", encodings[v->encoding],
             v->big ? "big" : "little", 8 * v->value_bytes, v->blocks, contents[v->content],
             v->iblank ? ", IBLANK" : "");
    return text;
}

/* ----------------------------------------------------------------------------------------------------------- values */

static void expect_points(const variant *v, int n, const dataset_block *block) {
    uint64_t wrong = 0, unblanked = 0;
    for (uint64_t i = 0; i < block_points(n); i++) {
        for (int a = 0; a < 3; a++)
            wrong += (v->value_bytes == 8 ? coordinate_at(block->points, 3 * (int64_t)i + a)
                                          : (double)(float)coordinate_at(block->points, 3 * (int64_t)i + a)) !=
                     plot3d_value(v, n, -1 - a, i);
        if (v->iblank) unblanked += !block->blanked_points || !block->blanked_points[i] != (iblank_value(n, i) != 0);
    }
    EXPECT(wrong == 0, "%s: %" PRIu64 " coordinates of block %d are wrong", describe(v), wrong, n);
    EXPECT(unblanked == 0, "%s: %" PRIu64 " points of block %d are blanked wrongly", describe(v), unblanked, n);
    EXPECT(v->iblank || !block->blanked_points, "%s: block %d has blanked points", describe(v), n);
    EXPECT((uintptr_t)block->points.f32 % 4 + (uintptr_t)block->points.f64 % 8 == 0 && !block->blanked_cells,
           "%s: block %d", describe(v), n);
}

static void expect_field(const variant *v, int n, const dataset_block *block, int variable) {
    static const char *const names[] = {"density", "momentum-x", "momentum-y", "momentum-z",
                                        "energy",  "gamma",      "q-7",        "q-8"};
    static const char *const functions[TEST_VARIABLES] = {"function-0", "function-1", "function-2"};
    const char *name = v->content == FUNCTION ? functions[variable] : names[variable];
    const dataset_field *f = find_field(block, name);
    EXPECT(f, "%s: block %d has no field %s", describe(v), n, name);
    if (!f) return;
    EXPECT(f->components == 1 && !f->on_cells, "%s: %s is no scalar of the points", describe(v), name);
    EXPECT(f->type == (v->value_bytes == 8 && v->encoding != TEXT ? TC_F64 : TC_F32), "%s: %s has type %d", describe(v),
           name, f->type);
    uint64_t wrong = 0;
    for (uint64_t i = 0; i < block_points(n); i++) wrong += field_value(f, i) != plot3d_value(v, n, variable, i);
    EXPECT(wrong == 0, "%s: %" PRIu64 " values of %s in block %d are wrong", describe(v), wrong, name, n);
}

static void expect_pressure(const variant *v, int n, const dataset_block *block) {
    const dataset_field *f = find_field(block, "pressure");
    EXPECT((f != NULL) == (v->content != FUNCTION), "%s: pressure is there or not", describe(v));
    if (!f) return;
    uint64_t wrong = 0;
    for (uint64_t i = 0; i < block_points(n); i++) {
        double q[6];
        for (int k = 0; k < 6; k++) q[k] = plot3d_value(v, n, k, i);
        double gamma = v->content == OVERFLOW_8 ? q[5] : 1.4;
        double kinetic = 0.5 * (q[1] * q[1] + q[2] * q[2] + q[3] * q[3]) / q[0];
        double wanted = (gamma - 1) * (q[4] - kinetic), got = field_value(f, i);
        double most = 1e-6 * (fabs(q[4]) + fabs(kinetic)) * fabs(gamma - 1);
        int right = q[0] == 0 ? !isfinite(got) : fabs(got - wanted) <= most;
        wrong += !right;
    }
    EXPECT(f->type == TC_F32 && wrong == 0, "%s: %" PRIu64 " pressures of block %d are wrong", describe(v), wrong, n);
}

static void expect_dataset(const variant *v, const char *first, const char *second) {
    dataset d;
    int status = read_plot3d(first, second, &d);
    EXPECT(status == 0, "%s: status %d: %s", describe(v), status, failure_text());
    if (status) return;
    EXPECT(d.block_count == block_count(v), "%s: %d blocks", describe(v), d.block_count);
    EXPECT(!strcmp(d.format, "Plot3D") && !*d.notice, "%s: format %s, notice %s", describe(v), d.format, d.notice);
    for (int n = 0; n < d.block_count && n < block_count(v); n++) {
        const dataset_block *block = &d.blocks[n];
        const int64_t *size = block_dims[n];
        EXPECT(block->kind == BLOCK_CURVILINEAR && !memcmp(block->dims, size, sizeof block->dims) &&
                   block->point_count == size[0] * size[1] * size[2] &&
                   block->cell_count == (size[0] - 1) * (size[1] - 1) * (size[2] - 1),
               "%s: sizes of block %d", describe(v), n);
        if (memcmp(block->dims, size, sizeof block->dims)) continue;
        int has_pressure = v->content != GRID_ONLY && v->content != FUNCTION;
        EXPECT(block->field_count == variable_count(v->content) + has_pressure, "%s: %d fields", describe(v),
               block->field_count);
        expect_points(v, n, block);
        for (int f = 0; f < variable_count(v->content); f++) expect_field(v, n, block, f);
        if (has_pressure) expect_pressure(v, n, block);
    }
    dataset_release(&d);
    EXPECT(!d.blocks && !d.memory, "%s: not zeroed by its release", describe(v));
}

static void test_variant(const variant *v) {
    bytes grid = grid_file(v);
    const char *grid_path = file_write("grid.xyz", grid.data, grid.size), *data_path = NULL;
    if (v->content != GRID_ONLY) {
        bytes data = data_file(v);
        data_path = file_write("data.q", data.data, data.size);
        bytes_free(&data);
        expect_dataset(v, data_path, grid_path);
    }
    expect_dataset(v, grid_path, data_path);
    bytes_free(&grid);
}

static void test_variants(void) {
    for (int n = 0; n < 4 * 2 * 2 * 2 * 5 * (MAX_BLOCKS + 1); n++) {
        variant v = {.encoding = n & 3,
                     .big = n >> 2 & 1,
                     .value_bytes = n >> 3 & 1 ? 8 : 4,
                     .iblank = n >> 4 & 1,
                     .content = (n >> 5) % 5,
                     .blocks = (n >> 5) / 5};
        if (v.encoding == TEXT && (v.big || v.value_bytes == 8)) continue;
        test_variant(&v);
    }
}

/* The two files of a pair need not have been written the same way. */
static void test_mixed(void) {
    variant v = {BINARY, 1, 4, 1, SOLUTION, 2}, other = {RECORDS_4, 0, 4, 0, SOLUTION, 2};
    bytes grid = grid_file(&v), data = data_file(&other);
    file_write("grid.xyz", grid.data, grid.size);
    file_write("data.q", data.data, data.size);
    expect_dataset(&v, file_path("grid.xyz"), file_path("data.q"));
    bytes_free(&grid);
    bytes_free(&data);
}

/* ------------------------------------------------------------------------------------------------------------- text */

static void expect_text_points(const char *what, const char *text, const float wanted[12]) {
    dataset d;
    int status = read_plot3d(file_text("text.xyz", text), NULL, &d);
    EXPECT(status == 0, "%s: %s", what, failure_text());
    if (status) return;
    for (int i = 0; i < 12; i++)
        EXPECT((float)coordinate_at(d.blocks[0].points, i) == wanted[i], "%s: %g, not %g", what,
               coordinate_at(d.blocks[0].points, i), (double)wanted[i]);
    dataset_release(&d);
}

static void expect_text_failure(const char *what, const char *text, const char *part) {
    dataset d;
    int status = read_plot3d(file_text("text.xyz", text), NULL, &d);
    EXPECT(status == STATUS_INPUT && strstr(failure_text(), part), "%s: status %d: %s", what, status, failure_text());
    if (!status) dataset_release(&d);
}

static void test_text(void) {
    static const float wanted[12] = {1, 5, 9, 2, 5, 9, 3, 5, -10, 4, 5, 0.5F};
    expect_text_points("plain", "2 2 1\n1 2 3 4\n5 5 5 5\n9 9 -10 0.5\n", wanted);
    expect_text_points("repeats", "2 2 1\n1 2 3 4 4*5 2*9.0 -10 .5", wanted);
    expect_text_points("repeated dims", "2*2 1 1. 2. 3. 4. 3*5 5 9 9 -1.0E1 5e-1", wanted);
    expect_text_points("Fortran exponents", "1 2 2 1 1D0 2d+00 3 4E0 4*5.0D+000 9 9 -1.0+001 5.-001", wanted);
    expect_text_points("no blanks", "2 2 1 1.0E+002.0E+003.00E+00 4 5 5.0D+00+5.+000+5 9 9-1.0E1 5e-1", wanted);
    expect_text_points("commas and lines", "2,2,1\r\n1,2,3,4\r\n5,5,5,5\r\n9,9,-10,0.5", wanted);
    expect_text_failure("a word", "2 2 1\n1 2 3 4 5 5 x 5", "value 10, 'x'");
    expect_text_failure("stars", "2 2 1\n1 2 3 4 5 5 ****** 5", "'******'");
    expect_text_failure("nothing repeated", "2 2 1\n1 2 3 4 4* 9 9 9 9", "'4*'");
    expect_text_failure("repeated nought times", "2 2 1\n0*1", "'0*1'");
    expect_text_failure("two repeats", "2 2 1\n3*4*1", "'3*4*1'");
    expect_text_failure("too few", "2 2 1\n1 2 3 4 5 5 5 5 9 9 9", "1 values are missing");
    expect_text_failure("too many", "2 2 1\n1 2 3 4 5 5 5 5 9 9 9 9 9", "the numbers of its text");
    expect_text_failure("a fraction for dims", "2 2.5 1 1 2 3 4 5 5 5 5 9 9 9 9", "the numbers of its text");
    expect_text_failure("dims of a billion", "1000 1000 1000 1", "values are missing");
    expect_text_failure("absurd repeats", "1000 1000 1000 3000000000*1", "repeat counts");
    expect_text_failure("repeats beyond 64 bits", "2 2 1 99999999999999999999999*1", "is no number");
    expect_text_failure("repeats that overflow", "18446744073709551615*1 18446744073709551615*1", "is no number");
    expect_text_failure("a word without end",
                        "2 2 1 0000000000000000000000000000000000000000000000000000000000000000000000000001",
                        "more than");
    expect_text_failure("infinity", "2 2 1\n1 2 3 4 5 Inf 5 5 9 9 9 9", "point 1 of block 1");
    expect_text_failure("a number beyond f64", "2 2 1\n1 2 3 4 5 5 5 1e399 9 9 9 9", "point 3 of block 1");
}

/* ----------------------------------------------------------------------------------------------------------- damage */

static void expect_refused(const char *what, const char *first, const char *second, const char *part) {
    dataset d;
    int status = read_plot3d(first, second, &d);
    EXPECT(status == STATUS_INPUT && strstr(failure_text(), part), "%s: status %d: %s", what, status, failure_text());
    if (!status) dataset_release(&d);
}

/* The text tells what the file looked like. */
static void test_nearest(void) {
    variant v = {RECORDS_4, 1, 8, 0, SOLUTION, 2};
    bytes grid = grid_file(&v);
    expect_refused("cut records", file_write("cut.xyz", grid.data, grid.size - 6), NULL,
                   "Nearest: big-endian Fortran records of 4-byte marks, f64, multi-block grid, but of a block of 2 x "
                   "5 x 3 points at least 6 bytes");
    bytes_free(&grid);
    v = (variant){BINARY, 0, 4, 1, SOLUTION, 0};
    grid = grid_file(&v);
    expect_refused("cut data", file_write("cut.xyz", grid.data, 12 + 12 * 24 - 5), NULL,
                   "Nearest: little-endian C binary, f32, single-block grid, but of a block of 4 x 3 x 2 points at "
                   "least 5 bytes");
    bytes_free(&grid);
}

static const char *write_grid(const char *name, variant v) {
    bytes grid = grid_file(&v);
    const char *path = file_write(name, grid.data, grid.size);
    bytes_free(&grid);
    return path;
}

static const char *write_data(const char *name, variant v) {
    bytes data = data_file(&v);
    const char *path = file_write(name, data.data, data.size);
    bytes_free(&data);
    return path;
}

static void test_pairs(void) {
    variant v = {BINARY, 1, 4, 1, SOLUTION, 2}, three = {BINARY, 1, 4, 1, SOLUTION, 3};
    char grid[256], data[256];
    snprintf(grid, sizeof grid, "%s", write_grid("two.xyz", v));
    snprintf(data, sizeof data, "%s", write_data("two.q", v));
    expect_refused("a solution alone", data, NULL, "give its grid file too");
    expect_refused("two grids", grid, write_grid("three.xyz", three), "both are Plot3D grids");
    expect_refused("two solutions", data, write_data("three.q", three), "both are Plot3D solution");
    expect_refused("other blocks", grid, file_path("three.q"), "has 2 blocks");
    expect_refused("no second file", grid, file_path("none.q"), "cannot be opened");
    expect_refused("an empty file", grid, file_text("empty.q", ""), "empty.q");
    expect_refused("an empty grid", file_path("empty.q"), data, "empty.q");

    bytes other = data_file(&v); /* the first block turned: 3 x 4 x 2 */
    other.data[7] = 3, other.data[11] = 4;
    expect_refused("other dims", grid, file_write("turned.q", other.data, other.size), "block 1 has 4 x 3 x 2 points");
    bytes_free(&other);
}

static void test_padding(void) {
    variant v = {BINARY, 1, 4, 1, SOLUTION, 0};
    const char *grid = write_grid("grid.xyz", v);
    bytes data = data_file(&v);
    static const unsigned char zeros[8192];
    size_t size = data.size;
    bytes_add(&data, zeros, 484);
    dataset d;
    int status = read_plot3d(grid, file_write("padded.q", data.data, data.size), &d);
    EXPECT(status == 0 && strstr(d.notice, "484 bytes after the data of padded.q are"), "padding: status %d, %s; %s",
           status, failure_text(), status ? "" : d.notice);
    if (!status) dataset_release(&d);
    data.data[size + 483] = 1;
    expect_refused("what is no padding", grid, file_write("padded.q", data.data, data.size), "padded.q: its size fits");
    data.data[size + 483] = 0;
    bytes_add(&data, zeros, 4096); /* enough for a padded f64 solution, but that would have a subnormal density */
    memset(data.data + 44, 0, 4);
    expect_refused("padding of another form", grid, file_write("padded.q", data.data, data.size),
                   "padded.q: its size fits");
    bytes_add(&data, zeros, sizeof zeros);
    expect_refused("too much padding", grid, file_write("padded.q", data.data, data.size), "padded.q: its size fits");
    bytes_free(&data);
}

/* Four points: a solution in f32 has as many bytes as a grid in f64. */
static void test_ambiguity(void) {
    variant f32 = {BINARY, 0, 4, 0, SOLUTION, 0}, f64 = {BINARY, 0, 8, 0, SOLUTION, 0};
    bytes either = {0}, doubles = {0};
    for (int a = 0; a < 3; a++) put_integer(&either, &f32, a == 2 ? 1 : 2);
    bytes_add(&doubles, either.data, either.size);
    for (int i = 0; i < 24; i++) put_value(&either, &f32, 1 + i);
    expect_refused("either", file_write("either.xyz", either.data, either.size), NULL, "reads as");
    for (int i = 0; i < 12; i++) put_value(&doubles, &f64, 1.0 / (3 + i));
    for (int i = 0; i < 12; i++) memset(doubles.data + 12 + 8 * i, 0xff, 4); /* NaN in the lower half, were it f32 */
    dataset d;
    int status = read_plot3d(file_write("either.xyz", doubles.data, doubles.size), NULL, &d);
    EXPECT(status == 0, "by its values a grid: %s", failure_text());
    if (!status) {
        EXPECT(fabs(coordinate_at(d.blocks[0].points, 0) - 1.0 / 3) < 1e-6, "by its values f64: %g",
               coordinate_at(d.blocks[0].points, 0));
        dataset_release(&d);
    }
    bytes_free(&either);
    bytes_free(&doubles);
}

static void test_headers(void) {
    static const struct {
        const char *what;
        uint32_t words[8];
    } cases[] = {{"dims that overflow", {0x7fffffff, 0x7fffffff, 0x7fffffff}},
                 {"dims whose product is 0 in 64 bits", {0x40000000, 0x40000000, 0x10}},
                 {"no points", {4, 0, 2}},
                 {"negative dims", {0xffffffff, 0xffffffff, 4}},
                 {"a billion points", {1000, 1000, 1000}},
                 {"two billion blocks", {0x7fffffff, 2, 2, 2}},
                 {"minus one block", {0xffffffff, 2, 2, 2}},
                 {"a record of 2 GB", {0x7ffffff0, 2, 2, 2, 0x7ffffff0}},
                 {"a record of -1 bytes", {0xffffffff, 2, 2, 2, 0xffffffff}},
                 {"a record that is not there", {12, 2, 2, 2, 12, 96}},
                 {"a record of 8-byte marks that overflows", {0xfffffff8, 0xffffffff, 2, 2, 2}},
                 {"many variables", {4, 2, 2, 0x7fffffff}}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++)
        for (int big = 0; big < 2; big++) {
            bytes b = {0};
            for (int i = 0; i < 8; i++) bytes_put(&b, cases[n].words[i], 4, big);
            expect_refused(cases[n].what, file_write("hostile.xyz", b.data, b.size), NULL,
                           "its size fits no 3D Plot3D");
            bytes_free(&b);
        }
    expect_refused("some words", file_text("hostile.xyz", "# vtk DataFile"), NULL, "value 1, '#'");
    expect_refused("a few bytes", file_write("hostile.xyz", "\1\0\2", 3), NULL, "its size fits no 3D Plot3D");
}

/* A blanked point may lie anywhere, others may not. */
static void test_coordinates(void) {
    variant v = {BINARY, 0, 8, 1, GRID_ONLY, 0};
    bytes grid = grid_file(&v);
    double far = INFINITY;
    memcpy(grid.data + 12 + 8 * 2, &far, 8); /* point 2 is blanked */
    dataset d;
    int status = read_plot3d(file_write("far.xyz", grid.data, grid.size), NULL, &d);
    EXPECT(status == 0, "a blanked point far away: %s", failure_text());
    if (!status) {
        EXPECT(d.blocks[0].blanked_points[2] && isfinite(coordinate_at(d.blocks[0].points, 6)),
               "a blanked point far away");
        dataset_release(&d);
    }
    memcpy(grid.data + 12 + 8 * 3, &far, 8);
    expect_refused("a point far away", file_write("far.xyz", grid.data, grid.size), NULL, "point 3 of block 1");
    bytes_free(&grid);
}

/* A pair of which one file is damaged: never a crash; where the damage must show, never a dataset. */
static void expect_damage_seen(const variant *v, const char *what, size_t at, const char *first, const char *second,
                               int must_fail) {
    dataset d;
    int status = read_plot3d(first, second, &d);
    EXPECT(status == STATUS_INPUT || (status == 0 && !must_fail), "%s: %s %zu: status %d: %s", describe(v), what, at,
           status, failure_text());
    if (!status) dataset_release(&d);
}

/* What is cut from a text's last number, begins with the zero bytes of a value, or has the very size of the same
 * header's f32 grid, solution or function, can look whole. */
static int may_look_whole(const variant *v, const bytes *whole, size_t size, int has_iblank) {
    size_t points = block_points(0);
    if (v->encoding == TEXT) return whole->size - size <= 10;
    if (v->encoding != BINARY) return 0;
    return has_iblank || size == 12 + 12 * points || size == 12 + 16 * points || size == 12 + 16 + 20 * points ||
           size == 16 + 4 * TEST_VARIABLES * points;
}

static void test_truncation(void) {
    static const variant variants[] = {{BINARY, 1, 4, 1, SOLUTION, 2},    {BINARY, 0, 8, 0, FUNCTION, 0},
                                       {RECORDS_4, 0, 4, 1, SOLUTION, 2}, {RECORDS_4, 1, 8, 0, OVERFLOW_8, 0},
                                       {RECORDS_8, 0, 4, 0, FUNCTION, 2}, {TEXT, 0, 4, 0, SOLUTION, 2}};
    for (size_t n = 0; n < sizeof variants / sizeof *variants; n++) {
        const variant *v = &variants[n];
        bytes grid = grid_file(v), data = data_file(v);
        file_write("whole.xyz", grid.data, grid.size);
        file_write("whole.q", data.data, data.size);
        for (size_t size = 0; size < grid.size; size++)
            expect_damage_seen(v, "grid cut to", size, file_write("cut", grid.data, size), file_path("whole.q"),
                               !may_look_whole(v, &grid, size, v->iblank));
        for (size_t size = 0; size < data.size; size++)
            expect_damage_seen(v, "data cut to", size, file_path("whole.xyz"), file_write("cut", data.data, size),
                               !may_look_whole(v, &data, size, 0));
        bytes_free(&grid);
        bytes_free(&data);
    }
}

/* Every bit of header and record marks counts. */
static void test_marks(void) {
    variant v = {RECORDS_4, 1, 4, 0, SOLUTION, 0};
    bytes grid = grid_file(&v);
    write_data("whole.q", v);
    for (size_t at = 0; at < grid.size; at++) {
        if (at >= 24 && at < grid.size - 4) continue; /* the values */
        for (int bit = 0; bit < 8; bit++) {
            grid.data[at] ^= (unsigned char)(1 << bit);
            expect_damage_seen(&v, "bit flipped in byte", at, file_write("flipped", grid.data, grid.size),
                               file_path("whole.q"), 1);
            grid.data[at] ^= (unsigned char)(1 << bit);
        }
    }
    bytes_free(&grid);
}

static void test_random_damage(void) {
    random_state = 7;
    for (int round = 0; round < 600; round++) {
        variant v = {.encoding = round & 3, .big = 0, .value_bytes = 4, .content = 1 + (round >> 2) % 4};
        v.iblank = round >> 4 & 1;
        v.blocks = (round >> 5) % 4;
        bytes grid = grid_file(&v), data = data_file(&v);
        bytes *damaged = round & 1 ? &grid : &data;
        for (int hits = 0; hits < 3; hits++) {
            uint32_t range = hits ? (uint32_t)damaged->size : 40;
            damaged->data[random_below(range)] = (unsigned char)random_below(256);
        }
        file_write("grid.xyz", grid.data, grid.size);
        expect_damage_seen(&v, "random damage of round", (size_t)round, file_path("grid.xyz"),
                           file_write("data.q", data.data, data.size), 0);
        bytes_free(&grid);
        bytes_free(&data);
    }
}

int main(void) {
    folder_make("plot3d");
    test_variants();
    test_mixed();
    test_text();
    test_nearest();
    test_pairs();
    test_padding();
    test_ambiguity();
    test_headers();
    test_coordinates();
    test_truncation();
    test_marks();
    test_random_damage();
    folder_remove();
    return EXPECT_DONE();
}
