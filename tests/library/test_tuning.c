/*
 * test_tuning.c - launch parameters kept for a device: taken by contexts that ask for none, never trusted
 *
 * What a file holds is seen through tc_context_tuning; every line that is not one of the library's own has to leave the
 * defaults in place, and every mesh has to be the reference's.
 */
#include "api.h"
#include "folder.h"

#include <sys/stat.h>
#include <unistd.h>

static char path[sizeof folder + 16];

static tc_tuning tuning_of(const tc_context *context) {
    tc_tuning tuning = {.struct_size = sizeof tuning};
    EXPECT(tc_context_tuning(context, &tuning) == TC_OK, "%s", tc_message());
    return tuning;
}

static tc_context *open_with(uint32_t work_items, uint32_t work_groups, uint32_t tile_bricks) {
    tc_context_options options;
    tc_expert_options expert;
    options_init(&options, &expert);
    expert.work_items = work_items;
    expert.work_groups = work_groups;
    expert.tile_bricks = tile_bricks;
    return context_open(&options);
}

static tc_tuning tuning_with(uint32_t work_items, uint32_t work_groups, uint32_t tile_bricks) {
    tc_context *context = open_with(work_items, work_groups, tile_bricks);
    tc_tuning tuning = tuning_of(context);
    tc_context_destroy(context);
    return tuning;
}

static bool tuning_is(const tc_tuning *t, uint32_t work_items, uint32_t work_groups, uint32_t tile_bricks) {
    return t->work_items == work_items && t->work_groups == work_groups && t->tile_bricks == tile_bricks;
}

static void expect_tuning(tc_tuning t, uint32_t work_items, uint32_t work_groups, uint32_t tile_bricks,
                          const char *what) {
    EXPECT(tuning_is(&t, work_items, work_groups, tile_bricks), "%s: %u, %u, %u", what, t.work_items, t.work_groups,
           t.tile_bricks);
}

static void file_write(const char *text, size_t count) {
    FILE *file = fopen(path, "wb");
    EXPECT(file && fwrite(text, 1, count, file) == count && fclose(file) == 0, "%s cannot be written", path);
}

static size_t file_read(char *out, size_t room) {
    FILE *file = fopen(path, "rb");
    size_t count = file ? fread(out, 1, room - 1, file) : 0;
    out[count] = 0;
    if (file) fclose(file);
    return count;
}

static void keep(uint32_t work_items, uint32_t work_groups, uint32_t tile_bricks) {
    tc_context *context = open_with(work_items, work_groups, tile_bricks);
    EXPECT(tc_context_tuning_save(context) == TC_OK, "%s", tc_message());
    tc_context_destroy(context);
}

/* ------------------------------------------------------------------------------------------------------------ tests */

static void test_mesh(tc_context *context) {
    tc_grid_options grid;
    tc_extract_options how;
    tc_mesh *meshes[2] = {NULL, NULL};
    tc_mesh_data data[2];
    tc_context *reference = reference_open();
    grid_describe(&grid);
    tc_extract_options_init(&how);
    how.isovalue = 127.5;
    if (extract(context, &grid, &how, &meshes[0], &data[0]) && extract(reference, &grid, &how, &meshes[1], &data[1])) {
        const char *difference = mesh_difference(&data[1], &data[0]);
        EXPECT(!difference, "with what was kept: %s", difference);
    }
    tc_mesh_destroy(meshes[0]);
    tc_mesh_destroy(meshes[1]);
    tc_context_destroy(reference);
}

static void test_kept(const tc_tuning *built_in) {
    keep(64, 7, 5);
    tc_context *context = open_with(0, 0, 0);
    expect_tuning(tuning_of(context), 64, 7, 5, "what was kept is not taken");
    test_mesh(context);
    setenv("TETRACUBES_CACHE_DIR", "", 1); /* the kernels are not stored: PoCL would build them once more */
    tc_context_destroy(context);
    setenv("TETRACUBES_CACHE_DIR", folder, 1);
    expect_tuning(tuning_with(0, 3, 0), built_in->work_items, 3, 0, "kept values mixed with the caller's");
    expect_tuning(tuning_with(0, 0, 9), built_in->work_items, built_in->work_groups, 9,
                  "kept values mixed with bricks");
    keep(1, 2, 0);
    expect_tuning(tuning_with(0, 0, 0), 1, 2, 0, "kept anew");
}

/* Lines of other devices stay, those of this one are replaced, the rest goes. */
static void test_other_devices(void) {
    static const char other[] = "work_items=64 work_groups=9 tile_bricks=9 device=Another, 4 units\n";
    char text[8192];
    file_write(other, sizeof other - 1);
    keep(32, 6, 4);
    keep(32, 5, 3);
    file_read(text, sizeof text);
    const char *newline = strchr(text, '\n');
    EXPECT(strstr(text, other) && newline && strchr(newline + 1, '\n') == text + strlen(text) - 1, "file: %s", text);
    expect_tuning(tuning_with(0, 0, 0), 32, 5, 3, "beside another device");
}

/* The start of this device's line, replaced by what is none of the library's. */
static void test_nonsense(const tc_tuning *built_in) {
    static const char *const starts[] = {
        "work_items=33 work_groups=2 tile_bricks=0 ",
        "work_items=2048 work_groups=2 tile_bricks=0 ",
        "work_items=4294967297 work_groups=2 tile_bricks=0 ",
        "work_items=99999999999999999999999 work_groups=2 tile_bricks=0 ",
        "work_items=-1 work_groups=2 tile_bricks=0 ",
        "work_items=32 work_groups=4000000000 tile_bricks=0 ",
        "work_items=32 work_groups=2 tile_bricks=4000000000 ",
        "work_items= work_groups=2 tile_bricks=0 ",
        "work_items=32 work_groups=2 ",
        "work_items=32  work_groups=2 tile_bricks=0 ",
        "work_groups=2 work_items=32 tile_bricks=0 ",
        "work_items=32,work_groups=2,tile_bricks=0,",
        "work_items=32 work_groups=2 tile_bricks=0 other=1 ",
        "",
        " ",
        "\n\n",
    };
    char kept[8192], text[2 * sizeof kept];
    unlink(path);
    keep(32, 7, 5);
    file_read(kept, sizeof kept);
    const char *device = strstr(kept, "device=");
    EXPECT(device != NULL, "file: %s", kept);
    for (size_t n = 0; device && n < sizeof starts / sizeof *starts; n++) {
        int count = snprintf(text, sizeof text, "%s%s", starts[n], device);
        file_write(text, (size_t)count);
        expect_tuning(tuning_with(0, 0, 0), built_in->work_items, built_in->work_groups, 0, starts[n]);
    }
    file_write(kept, strlen(kept) - 4);
    expect_tuning(tuning_with(0, 0, 0), built_in->work_items, built_in->work_groups, 0, "cut short");
    memset(text, 'w', sizeof text);
    file_write(text, sizeof text);
    expect_tuning(tuning_with(0, 0, 0), built_in->work_items, built_in->work_groups, 0, "a long line");
    memset(text, 0, sizeof text);
    file_write(text, sizeof text);
    expect_tuning(tuning_with(0, 0, 0), built_in->work_items, built_in->work_groups, 0, "zeros");
    file_write(kept, strlen(kept));
    expect_tuning(tuning_with(0, 0, 0), 32, 7, 5, "the file as it was");
}

static void test_refused(tc_context *context) {
    tc_context *reference = reference_open();
    tc_tuning tuning = {.struct_size = sizeof tuning}, small = {.struct_size = 4};
    EXPECT_REFUSED(tc_context_tuning(NULL, &tuning), TC_ERROR_ARGUMENT, "tuning of no context");
    EXPECT_REFUSED(tc_context_tuning(context, NULL), TC_ERROR_ARGUMENT, "no place for the tuning");
    EXPECT_REFUSED(tc_context_tuning(context, &small), TC_ERROR_ARGUMENT, "tuning of no size");
    EXPECT_REFUSED(tc_context_tuning(reference, &tuning), TC_ERROR_ARGUMENT, "tuning of the reference");
    EXPECT_REFUSED(tc_context_tuning_save(NULL), TC_ERROR_ARGUMENT, "keeping that of no context");
    EXPECT_REFUSED(tc_context_tuning_save(reference), TC_ERROR_ARGUMENT, "keeping that of the reference");
    setenv("TETRACUBES_CACHE_DIR", "", 1);
    EXPECT_REFUSED(tc_context_tuning_save(context), TC_ERROR_FILE, "keeping without a cache");
    setenv("TETRACUBES_CACHE_DIR", "/dev/null/cache", 1);
    EXPECT_REFUSED(tc_context_tuning_save(context), TC_ERROR_FILE, "keeping where nothing can be written");
    tc_context_destroy(reference);
}

int main(void) {
    if (!device_exists()) return SKIPPED;
    samples_fill();
    umask(022); /* files that others may write are passed over */
    folder_make("tuning");
    snprintf(path, sizeof path, "%s/tuning", folder);
    setenv("TETRACUBES_CACHE_DIR", folder, 1);
    tc_context *context = open_with(0, 0, 0);
    tc_tuning built_in = tuning_of(context);
    test_kept(&built_in);
    test_other_devices();
    test_nonsense(&built_in);
    test_refused(context);
    tc_context_destroy(context);
    folder_remove();
    return EXPECT_DONE();
}
