/*
 * test_trial.c - the library asks for trials of kernels and heeds their verdicts: a callback that is called once per
 * kind of kernels, verdicts kept across contexts, the other variant where one is bad, sentences where none is left
 *
 * The layer makes PoCL a driver that nobody knows. The callback does no trial, it says what the test wants it to say;
 * what a real one does, tests/drivers/test_trials.py shows.
 */
#define CL_TARGET_OPENCL_VERSION 120

#include "api.h"
#include "folder.h"
#include "layer_find.h"

#include <math.h>

/* What the callback is to say of jobs by their number of work-items, 0 for that of the device alone, and what it was
 * asked. */
typedef struct script {
    tc_verdict device, alone, groups;
    int asked_device, asked_alone, asked_groups;
    char job[256]; /* the last of kernels */
} script;

static tc_verdict told(void *user, const char *job, char *reason, size_t bytes) {
    script *s = user;
    int platform, device;
    unsigned kind, items = 99;
    EXPECT(sscanf(job, "tetracubes-trial-1 %d:%d %u %u", &platform, &device, &kind, &items) == 4, "job: %s", job);
    snprintf(reason, bytes, "as the test wants");
    if (items) snprintf(s->job, sizeof s->job, "%s", job);
    *(items == 0 ? &s->asked_device : items == 1 ? &s->asked_alone : &s->asked_groups) += 1;
    return items == 0 ? s->device : items == 1 ? s->alone : s->groups;
}

static tc_status context_try(script *s, uint32_t work_items, tc_context **context) {
    tc_context_options options;
    tc_expert_options expert;
    options_init(&options, &expert);
    expert.work_items = work_items;
    expert.child_trial = s ? told : NULL;
    expert.child_trial_user = s;
    return tc_context_create(&options, context);
}

/* Extracts by a new context; the mesh has to be the reference's. */
static tc_status extract_try(script *s, uint32_t work_items) {
    tc_context *contexts[2] = {NULL, NULL};
    tc_grid_options options;
    tc_extract_options how;
    tc_grid *grid = NULL;
    tc_mesh *meshes[2] = {NULL, NULL};
    tc_mesh_data data[2] = {{.struct_size = sizeof *data}, {.struct_size = sizeof *data}};
    grid_describe(&options);
    tc_extract_options_init(&how);
    how.isovalue = 127.5;
    tc_status status = context_try(s, work_items, &contexts[0]);
    if (!status) status = tc_grid_create(contexts[0], &options, &grid);
    if (!status) status = tc_extract(grid, &how, &meshes[0]);
    if (!status) status = tc_mesh_get(meshes[0], &data[0]);
    contexts[1] = reference_open();
    if (!status && extract(contexts[1], &options, &how, &meshes[1], &data[1])) {
        const char *differs = mesh_difference(&data[0], &data[1]);
        EXPECT(!differs && data[0].triangle_count > 100, "%s", differs ? differs : "a mesh too small to compare");
    }
    tc_grid_destroy(grid);
    for (int n = 0; n < 2; n++) {
        tc_mesh_destroy(meshes[n]);
        tc_context_destroy(contexts[n]);
    }
    return status;
}

static void expect_asked(const script *s, int device, int alone, int groups, const char *what) {
    EXPECT(s->asked_device == device && s->asked_alone == alone && s->asked_groups == groups,
           "%s: asked %d times for the device, %d and %d times for kernels", what, s->asked_device, s->asked_alone,
           s->asked_groups);
}

/* An unknown driver gets the variant for groups where its platform is unknown; PoCL's, of whatever version, that for
 * one work-item first. */
static void test_good(void) {
    script s = {TC_VERDICT_GOOD, TC_VERDICT_GOOD, TC_VERDICT_GOOD, 0, 0, 0, ""};
    EXPECT(extract_try(&s, 0) == TC_OK, "%s", tc_message());
    expect_asked(&s, 1, 1, 0, "a good driver");
    EXPECT(extract_try(&s, 0) == TC_OK, "%s", tc_message());
    expect_asked(&s, 1, 1, 0, "a good driver, again");
    EXPECT(extract_try(NULL, 0) == TC_OK, "%s", tc_message());
    EXPECT(tc_trial_run(s.job, NULL, NULL) == TC_OK, "%s: %s", s.job, tc_message());
    s.job[strlen(s.job) - 1] ^= 1;
    EXPECT_REFUSED(tc_trial_run(s.job, NULL, NULL), TC_ERROR_DEVICE, "a job for another device");
    EXPECT_REFUSED(tc_trial_run("", NULL, NULL), TC_ERROR_ARGUMENT, "no job");
    EXPECT_REFUSED(tc_trial_run("tetracubes-trial-1 0:0 100000 1 1 1 x", NULL, NULL), TC_ERROR_ARGUMENT,
                   "no such kind");
}

/* Counting asks for less; emitting then for the rest, and where that is bad the caller counts again. */
static void test_cancel_and_none(void) {
    script cancels = {TC_VERDICT_GOOD, TC_VERDICT_CANCELLED, TC_VERDICT_GOOD, 0, 0, 0, ""};
    script stops = {TC_VERDICT_GOOD, TC_VERDICT_STOPPED, TC_VERDICT_STOPPED, 0, 0, 0, ""};
    script none = {TC_VERDICT_NONE, TC_VERDICT_NONE, TC_VERDICT_NONE, 0, 0, 0, ""};
    EXPECT_REFUSED(extract_try(&cancels, 0), TC_ERROR_CANCELLED, "a trial that is cancelled");
    EXPECT_REFUSED(extract_try(&stops, 0), TC_ERROR_DEVICE, "a trial that is stopped");
    expect_asked(&stops, 0, 1, 1, "a stopped trial, of either variant");
    EXPECT(extract_try(&none, 0) == TC_OK, "without a trial: %s", tc_message());
    expect_asked(&none, 0, 1, 0, "no trial");
    EXPECT(extract_try(&none, 0) == TC_OK, "without a trial: %s", tc_message());
    expect_asked(&none, 0, 2, 0, "no trial is no verdict");
}

static void test_other_variant(void) {
    for (tc_verdict bad = TC_VERDICT_WRONG_RESULT; bad <= TC_VERDICT_HUNG; bad++) {
        char name[sizeof folder + 16];
        snprintf(name, sizeof name, "%s/%d", folder, (int)bad);
        setenv("TETRACUBES_CACHE_DIR", name, 1);
        script s = {TC_VERDICT_GOOD, bad, TC_VERDICT_GOOD, 0, 0, 0, ""};
        script none = {bad, bad, bad, 0, 0, 0, ""};
        const tc_status wanted = bad == TC_VERDICT_WRONG_RESULT ? TC_ERROR_WRONG_RESULT : TC_ERROR_DEVICE;
        EXPECT_REFUSED(extract_try(&s, 1), wanted, "one work-item is what the caller wants");
        EXPECT(strstr(tc_message(), "as the test wants") && strstr(tc_message(), name), "message: %s", tc_message());
        expect_asked(&s, 1, 1, 0, "one work-item is what the caller wants");
        EXPECT(extract_try(&s, 0) == TC_OK, "with the other variant: %s", tc_message());
        expect_asked(&s, 1, 1, 1, "the other variant");
        EXPECT(extract_try(NULL, 0) == TC_OK, "a context without a callback: %s", tc_message());
        EXPECT(extract_try(&none, 0) == TC_OK, "what is kept: %s", tc_message());
        expect_asked(&none, 0, 0, 0, "what is kept");
    }
    setenv("TETRACUBES_CACHE_DIR", "", 1);
    script none = {TC_VERDICT_GOOD, TC_VERDICT_CRASHED, TC_VERDICT_HUNG, 0, 0, 0, ""};
    EXPECT_REFUSED(extract_try(&none, 0), TC_ERROR_DEVICE, "no variant is left");
    EXPECT(strstr(tc_message(), "driver 9.") && strstr(tc_message(), "hangs"), "message: %s", tc_message());
    expect_asked(&none, 1, 1, 1, "no variant is left");
    script closed = {TC_VERDICT_CRASHED, TC_VERDICT_GOOD, TC_VERDICT_GOOD, 0, 0, 0, ""};
    EXPECT_REFUSED(extract_try(&closed, 0), TC_ERROR_DEVICE, "a device that cannot be opened");
    expect_asked(&closed, 1, 0, 0, "a device that cannot be opened");
}

/* One context over several calls: the kernels of missing samples are met within a call, and are the first to fail. */
static tc_verdict bad_with_missing(void *user, const char *job, char *reason, size_t bytes) {
    unsigned kind = 0, items = 0;
    int *asked = user, platform, device;
    (void)reason, (void)bytes;
    sscanf(job, "tetracubes-trial-1 %d:%d %u %u", &platform, &device, &kind, &items);
    *asked += items != 0;
    return items == 1 && kind >> 1 & 1 ? TC_VERDICT_CRASHED : TC_VERDICT_GOOD;
}

static void test_within_a_call(void) {
    static float values[SAMPLES];
    int asked = 0;
    tc_context_options options;
    tc_expert_options expert;
    tc_grid_options volume;
    tc_extract_options how;
    tc_counts counts = {.struct_size = sizeof counts};
    tc_tuning tuning = {.struct_size = sizeof tuning};
    tc_context *contexts[2];
    tc_grid *grid = NULL;
    tc_mesh *meshes[2] = {NULL, NULL};
    tc_mesh_data data[2] = {{.struct_size = sizeof *data}, {.struct_size = sizeof *data}};
    options_init(&options, &expert);
    tc_extract_options_init(&how);
    expert.child_trial = bad_with_missing, expert.child_trial_user = &asked;
    contexts[0] = context_open(&options), contexts[1] = reference_open();
    grid_describe(&volume);
    for (int n = 0; n < SAMPLES; n++) values[n] = n == SAMPLES / 2 ? NAN : (float)samples[n];
    volume.type = TC_F32, volume.samples = values, volume.has_nodata = 0;
    how.isovalue = 127.5;
    how.normals = 1;
    EXPECT(!tc_grid_create(contexts[0], &volume, &grid) && !tc_count(grid, &how, &counts), "%s", tc_message());
    EXPECT(asked == 3 && !tc_context_tuning(contexts[0], &tuning) && tuning.work_items > 1,
           "asked %d times, work-items %u", asked, tuning.work_items);
    EXPECT(!tc_extract(grid, &how, &meshes[0]) && !tc_mesh_get(meshes[0], &data[0]), "%s", tc_message());
    EXPECT(extract(contexts[1], &volume, &how, &meshes[1], &data[1]), "%s", tc_message());
    const char *differs = mesh_difference(&data[0], &data[1]);
    EXPECT(!differs && counts.triangle_count == data[1].triangle_count, "%s", differs ? differs : "counts differ");
    tc_grid_destroy(grid);
    for (int n = 0; n < 2; n++) {
        tc_mesh_destroy(meshes[n]);
        tc_context_destroy(contexts[n]);
    }
}

int main(void) {
    if (!device_exists()) return SKIPPED;
    const layer_functions *layer = layer_find();
    EXPECT(layer && layer->command("lacks fame"), "the layer is not there");
    if (!layer) return EXPECT_DONE();
    samples_fill();
    folder_make("trial");
    setenv("TETRACUBES_CACHE_DIR", folder, 1);
    test_good();
    setenv("TETRACUBES_CACHE_DIR", "", 1);
    test_within_a_call();
    test_other_variant();
    folder_remove();
    folder_make("trial");
    setenv("TETRACUBES_CACHE_DIR", folder, 1);
    test_cancel_and_none();
    folder_remove();
    return EXPECT_DONE();
}
