/*
 * test_contexts.c - what contexts promise besides meshes
 *
 * Devices are named and found; callers built against older headers are served; progress runs forward and cancels,
 * after which everything works; what kernels took until they were ready; contexts in several threads at once; no
 * OpenCL platform at all.
 */
#include "api.h"
#include "folder.h"

#include <pthread.h>
#include <stddef.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Callers built when the structs ended earlier: what they do not know has its default. */
static void test_older_callers(const tc_mesh_data *expected) {
    tc_context_options options;
    tc_grid_options grid_options;
    tc_extract_options how;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    memset(&options, 0xee, sizeof options);
    memset(&grid_options, 0xee, sizeof grid_options);
    memset(&how, 0xee, sizeof how);
    options.struct_size = offsetof(tc_context_options, device);
    options.engine = TC_ENGINE_REFERENCE;
    grid_options.struct_size = offsetof(tc_grid_options, matrix);
    for (int axis = 0; axis < 3; axis++) {
        grid_options.dims[axis] = SIZE;
        grid_options.first_index[axis] = 0;
    }
    grid_options.type = TC_U8;
    grid_options.samples = samples;
    how.struct_size = offsetof(tc_extract_options, normals);
    how.isovalue = 127.5;
    tc_context *context = context_open(&options);
    tc_status status = tc_grid_create(context, &grid_options, &grid);
    if (!status) status = tc_extract(grid, &how, &mesh);
    if (!status) status = tc_mesh_get(mesh, &data);
    EXPECT(status == TC_OK, "%s", tc_message());
    const char *difference = mesh_difference(expected, &data);
    EXPECT(!difference, "of an older caller: %s", difference);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
}

static void test_devices(tc_context *device) {
    int count = -1;
    tc_device_info info = {.struct_size = sizeof info}, again = info;
    EXPECT(tc_device_count(&count) == TC_OK && count > 0, "%d devices: %s", count, tc_message());
    for (int n = 0; n < count; n++) {
        EXPECT(tc_device_get(n, &info) == TC_OK, "%s", tc_message());
        EXPECT(info.name[0] && info.platform[0] && info.version[0] && info.type[0] && info.compute_units &&
                   info.max_work_group_size && info.global_memory_bytes && info.max_buffer_bytes &&
                   info.platform_index >= 0 && info.device_index >= 0,
               "device %d is described in part", n);
        char specifications[2][32];
        snprintf(specifications[0], sizeof specifications[0], "%d", n);
        snprintf(specifications[1], sizeof specifications[1], "%d:%d", info.platform_index, info.device_index);
        for (int s = 0; s < 2; s++) {
            tc_context_options options;
            tc_context_options_init(&options);
            options.device = specifications[s];
            tc_context *context = context_open(&options);
            EXPECT(tc_context_device(context, &again) == TC_OK && !strcmp(again.name, info.name), "device %s is %s",
                   specifications[s], again.name);
            tc_context_destroy(context);
        }
    }
    EXPECT_REFUSED(tc_device_get(count, &info), TC_ERROR_ARGUMENT, "a device too many");
    EXPECT_REFUSED(tc_device_get(-1, &info), TC_ERROR_ARGUMENT, "device -1");
    EXPECT(tc_context_device(device, &info) == TC_OK && tc_context_cl_context(device) && tc_context_cl_queue(device),
           "the context does not tell its device");
}

static double clock_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

/* The first surface makes kernels ready, the second one finds them; timings of surfaces and of label maps have neither
 * that nor the trial. */
static void test_build_time(void) {
    uint8_t small[8 * 8 * 8] = {0};
    small[3 * 64 + 3 * 8 + 3] = 1;
    tc_context_options options;
    tc_grid_options how;
    tc_extract_options surface;
    tc_labels_options labels;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    double built[3], walls[3];
    tc_context_options_init(&options);
    options.check_device = 1;
    tc_context *context = context_open(&options);
    tc_grid_options_init(&how);
    tc_extract_options_init(&surface);
    tc_labels_options_init(&labels);
    for (int axis = 0; axis < 3; axis++) how.dims[axis] = 8;
    how.samples = small;
    surface.isovalue = 0.5;
    EXPECT(tc_context_build_ms(context) == 0, "kernels before any call");
    EXPECT(tc_grid_create(context, &how, &grid) == TC_OK, "%s", tc_message());
    for (int n = 0; n < 3; n++) {
        tc_mesh_data data = {.struct_size = sizeof data};
        const double before = tc_context_build_ms(context), start = clock_ms();
        const tc_status status = n < 2 ? tc_extract(grid, &surface, &mesh) : tc_extract_labels(grid, &labels, &mesh);
        walls[n] = clock_ms() - start;
        built[n] = tc_context_build_ms(context) - before;
        EXPECT(status == TC_OK && tc_mesh_get(mesh, &data) == TC_OK, "%s", tc_message());
        EXPECT(built[n] + data.timings.total_ms <= walls[n], "call %d: %g ms for kernels, %g of %g for the mesh", n,
               built[n], data.timings.total_ms, walls[n]);
    }
    EXPECT(built[0] > 0 && built[1] == 0 && built[2] > 0, "kernels took %g, %g, %g ms", built[0], built[1], built[2]);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
}

/* -------------------------------------------------------------------------------------------------------- progress */

typedef struct watch {
    int calls, cancel_at, wrong;
    double last;
    char stage[32];
} watch;

static int watch_progress(void *user, const char *stage, double fraction) {
    watch *w = user;
    if (strcmp(stage, w->stage)) w->last = 0;
    snprintf(w->stage, sizeof w->stage, "%s", stage);
    w->wrong += !(fraction >= w->last && fraction <= 1) || !*stage;
    w->last = fraction;
    return ++w->calls == w->cancel_at;
}

/* Cancelled at every call in turn; then everything can be used again. */
static void test_progress(tc_engine engine, const tc_mesh_data *expected) {
    tc_context_options options;
    tc_grid_options grid_options;
    tc_extract_options how;
    watch w = {0};
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    tc_context_options_init(&options);
    options.engine = engine;
    options.progress = watch_progress;
    options.progress_user = &w;
    grid_describe(&grid_options);
    tc_extract_options_init(&how);
    how.isovalue = 127.5;
    tc_context *context = context_open(&options);
    EXPECT(tc_grid_create(context, &grid_options, &grid) == TC_OK, "%s", tc_message());
    for (int n = 0; n < 2; n++) { /* the first call builds kernels, and reports that as progress */
        w.calls = 0;
        EXPECT(tc_extract(grid, &how, &mesh) == TC_OK, "%s", tc_message());
        tc_mesh_destroy(mesh);
        mesh = NULL;
    }
    int calls = w.calls;
    EXPECT(calls >= 2 && !w.wrong && w.last > 0.999, "%d calls of progress, %d wrong, the last at %g", calls, w.wrong,
           w.last);
    for (int n = 1; n <= calls; n++) {
        w = (watch){.cancel_at = n};
        EXPECT_REFUSED(tc_extract(grid, &how, &mesh), TC_ERROR_CANCELLED, "cancelling");
        EXPECT(!mesh && w.calls == n, "a mesh after cancelling, or %d calls", w.calls);
    }
    w = (watch){.cancel_at = 1};
    tc_counts counts = {.struct_size = sizeof counts};
    EXPECT_REFUSED(tc_count(grid, &how, &counts), TC_ERROR_CANCELLED, "cancelling a count");
    EXPECT(counts.vertex_count == 0 && counts.triangle_count == 0 && counts.mesh_bytes == 0, "counts after cancelling");
    w = (watch){0};
    bool done = tc_extract(grid, &how, &mesh) == TC_OK && tc_mesh_get(mesh, &data) == TC_OK;
    EXPECT(done, "after cancelling: %s", tc_message());
    const char *difference = done ? mesh_difference(expected, &data) : NULL;
    EXPECT(!difference, "after cancelling: %s", difference);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
}

/* --------------------------------------------------------------------------------------------------------- threads */

typedef struct worker {
    pthread_t thread;
    const tc_mesh_data *expected;
    tc_engine engine;
    const char *fault;
} worker;

/* No EXPECT here: its counters are not shared between threads. */
static void *worker_run(void *user) {
    worker *w = user;
    tc_context_options options;
    tc_grid_options grid_options;
    tc_extract_options how;
    tc_context_options_init(&options);
    tc_extract_options_init(&how);
    grid_describe(&grid_options);
    options.engine = w->engine;
    how.isovalue = 127.5;
    for (int n = 0; n < 10 && !w->fault; n++) {
        tc_context *context = NULL;
        tc_grid *grid = NULL;
        tc_mesh *mesh = NULL;
        tc_mesh_data data = {.struct_size = sizeof data};
        tc_status status = tc_context_create(&options, &context);
        if (!status) status = tc_grid_create(context, &grid_options, &grid);
        if (!status) status = tc_extract(grid, &how, &mesh);
        if (!status) status = tc_mesh_get(mesh, &data);
        w->fault = status ? "a call fails" : mesh_difference(w->expected, &data);
        tc_mesh_destroy(mesh);
        tc_grid_destroy(grid);
        tc_context_destroy(context);
        if (tc_device_get(-1, NULL) == TC_OK || !strstr(tc_message(), "tc_device_get")) w->fault = "a message got lost";
    }
    return NULL;
}

static void test_threads(const tc_mesh_data *expected, bool device) {
    worker workers[4];
    for (int n = 0; n < 4; n++) {
        workers[n] = (worker){.expected = expected, .engine = device && n < 2 ? TC_ENGINE_OPENCL : TC_ENGINE_REFERENCE};
        EXPECT(pthread_create(&workers[n].thread, NULL, worker_run, &workers[n]) == 0, "no thread");
    }
    for (int n = 0; n < 4; n++) {
        pthread_join(workers[n].thread, NULL);
        EXPECT(!workers[n].fault, "thread %d: %s", n, workers[n].fault);
    }
}

static void *contexts_open_and_close(void *failed) {
    for (int n = 0; n < 10; n++) {
        tc_context_options options;
        tc_context *context = NULL;
        tc_context_options_init(&options);
        if (tc_context_create(&options, &context)) ++*(int *)failed;
        tc_context_destroy(context);
    }
    return NULL;
}

/* Threads wake the driver, and let it sleep, all at once. */
static void test_first_contexts(void) {
    pthread_t threads[4];
    int failed[4] = {0};
    for (int n = 0; n < 4; n++)
        EXPECT(pthread_create(&threads[n], NULL, contexts_open_and_close, &failed[n]) == 0, "no thread");
    for (int n = 0; n < 4; n++) pthread_join(threads[n], NULL);
    int wanted = device_exists() ? 0 : 10;
    for (int n = 0; n < 4; n++)
        EXPECT(failed[n] == wanted, "thread %d: %d of 10 contexts fail, not %d", n, failed[n], wanted);
}

/* Without a platform (an empty folder of vendors, before the loader has looked) devices are refused in plain words, and
 * the reference works. Runs in a process of its own. */
static void test_no_platform(void) {
    folder_make("vendors");
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        tc_context_options options;
        tc_context *context = NULL;
        int count = -1;
        setenv("OCL_ICD_VENDORS", folder, 1);
        tc_context_options_init(&options);
        EXPECT_REFUSED(tc_device_count(&count), TC_ERROR_DEVICE, "counting devices without a platform");
        EXPECT(count == 0 && strstr(tc_message(), "install"), "%d devices: %s", count, tc_message());
        EXPECT_REFUSED(tc_context_create(&options, &context), TC_ERROR_DEVICE, "a context without a platform");
        EXPECT(!context, "a context without a platform");
        context = reference_open();
        tc_grid_options grid;
        tc_extract_options how;
        tc_mesh *mesh = NULL;
        tc_mesh_data data;
        tc_device_info info = {.struct_size = sizeof info};
        grid_describe(&grid);
        tc_extract_options_init(&how);
        how.isovalue = 127.5;
        EXPECT(extract(context, &grid, &how, &mesh, &data) && data.triangle_count > 0,
               "the reference needs a platform");
        EXPECT_REFUSED(tc_context_device(context, &info), TC_ERROR_ARGUMENT, "the device of the reference");
        EXPECT(!tc_context_cl_context(context) && !tc_context_cl_queue(context), "OpenCL objects of the reference");
        tc_mesh_destroy(mesh);
        tc_context_destroy(context);
        int failed = EXPECT_DONE();
        fflush(stdout);
        _exit(failed);
    }
    int status = -1;
    waitpid(child, &status, 0);
    EXPECT(WIFEXITED(status) && WEXITSTATUS(status) == 0, "without a platform: exit status %d", status);
    folder_remove();
}

int main(void) {
    tc_grid_options grid;
    tc_extract_options how;
    tc_mesh *mesh = NULL;
    tc_mesh_data expected;
    samples_fill();
    grid_describe(&grid);
    tc_extract_options_init(&how);
    how.isovalue = 127.5;
    test_no_platform();
    test_first_contexts();
    tc_context *reference = reference_open();
    bool device = device_exists();
    if (!extract(reference, &grid, &how, &mesh, &expected)) return EXIT_FAILURE;
    EXPECT(expected.triangle_count > 100, "a mesh too small to compare with");
    test_older_callers(&expected);
    test_progress(TC_ENGINE_REFERENCE, &expected);
    test_threads(&expected, device);
    if (device) {
        tc_context_options options;
        tc_context_options_init(&options);
        tc_context *context = context_open(&options);
        test_devices(context);
        test_build_time();
        test_progress(TC_ENGINE_OPENCL, &expected);
        tc_context_destroy(context);
    }
    tc_mesh_destroy(mesh);
    tc_context_destroy(reference);
    int failed = EXPECT_DONE();
    return failed || device ? failed : SKIPPED;
}
