/*
 * test_fork.c - processes forked from one that uses OpenCL: refused in plain words, never hanging; the reference engine
 * works in them, contexts of the parent can be destroyed there, and the parent goes on
 */
#include "api.h"

#include <sys/wait.h>
#include <unistd.h>

static tc_context *parents, *parents_reference;
static tc_grid *parents_grid, *reference_grid;
static tc_mesh *parents_mesh;
static tc_mesh_data expected;

static tc_extract_options how(void) {
    tc_extract_options options;
    tc_extract_options_init(&options);
    options.isovalue = 127.5;
    return options;
}

/* A hang ends by SIGALRM. */
static void child_run(void (*work)(void), const char *what) {
    int status = -1;
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        expect_failures = 0;
        alarm(60);
        work();
        fflush(stdout);
        _exit(expect_failures != 0);
    }
    waitpid(child, &status, 0);
    EXPECT(WIFEXITED(status) && WEXITSTATUS(status) == 0, "%s: the child ends with status %x", what, (unsigned)status);
}

static void mesh_expect(tc_context *context, const char *who) {
    tc_grid_options grid;
    tc_mesh *mesh = NULL;
    tc_mesh_data data;
    const tc_extract_options options = how();
    grid_describe(&grid);
    if (extract(context, &grid, &options, &mesh, &data)) {
        const char *difference = mesh_difference(&expected, &data);
        EXPECT(!difference, "%s: %s", who, difference);
    }
    tc_mesh_destroy(mesh);
}

static void own_context(void) {
    tc_context_options options;
    tc_context *context = NULL;
    tc_device_info info = {.struct_size = sizeof info};
    int count = -1;
    tc_context_options_init(&options);
    EXPECT_REFUSED(tc_context_create(&options, &context), TC_ERROR_DEVICE, "a context of the child's own");
    EXPECT(!context && strstr(tc_message(), "fork") && strstr(tc_message(), "exec"), "%s", tc_message());
    EXPECT_REFUSED(tc_device_count(&count), TC_ERROR_DEVICE, "counting devices in the child");
    EXPECT_REFUSED(tc_device_get(0, &info), TC_ERROR_DEVICE, "a device in the child");
}

static void own_reference(void) {
    tc_context *context = reference_open();
    mesh_expect(context, "the child's reference");
    tc_context_destroy(context);
    mesh_expect(parents_reference, "the parent's reference in the child");
}

static void parents_objects(void) {
    tc_grid_options grid;
    tc_tetrahedra_grid_options complex;
    tc_grid *made = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    tc_counts counts = {.struct_size = sizeof counts};
    tc_device_mesh on_device = {.struct_size = sizeof on_device};
    const tc_extract_options options = how();
    grid_describe(&grid);
    tc_tetrahedra_grid_options_init(&complex);
    EXPECT_REFUSED(tc_grid_create(parents, &grid, &made), TC_ERROR_DEVICE, "a grid in the parent's context");
    EXPECT_REFUSED(tc_tetrahedra_grid_create(parents, &complex, &made), TC_ERROR_DEVICE,
                   "a complex in the parent's context");
    EXPECT_REFUSED(tc_count(parents_grid, &options, &counts), TC_ERROR_DEVICE, "counting the parent's grid");
    EXPECT_REFUSED(tc_emit(parents_grid, &options, &on_device, NULL), TC_ERROR_DEVICE, "emitting the parent's grid");
    EXPECT_REFUSED(tc_extract(parents_grid, &options, &mesh), TC_ERROR_DEVICE, "extracting the parent's grid");
    EXPECT(!made && !mesh && strstr(tc_message(), "fork"), "%s", tc_message());
    EXPECT(!tc_mesh_get(parents_mesh, &data) && !mesh_difference(&expected, &data), "the parent's mesh has changed");
}

static void parents_destroyed(void) {
    tc_mesh_destroy(parents_mesh);
    tc_grid_destroy(parents_grid);
    tc_context_destroy(parents);
    tc_grid_destroy(reference_grid);
    tc_context_destroy(parents_reference);
}

static void grandchild(void) { child_run(own_context, "a child's child"); }

static void before_any(void) {
    tc_context_options options;
    tc_context_options_init(&options);
    tc_context *context = context_open(&options);
    mesh_expect(context, "a child of a process without OpenCL");
    tc_context_destroy(context);
}

static void device_look(void) { expect_failures = !device_exists(); }

int main(void) {
    int status = -1;
    fflush(stdout);
    pid_t child = fork(); /* this process is not to use OpenCL yet */
    if (child == 0) _exit((device_look(), fflush(stdout), expect_failures != 0));
    waitpid(child, &status, 0);
    if (status) return SKIPPED;

    samples_fill();
    tc_grid_options grid;
    tc_context_options options;
    const tc_extract_options surface = how();
    grid_describe(&grid);
    tc_context_options_init(&options);
    parents_reference = reference_open();
    EXPECT(!tc_grid_create(parents_reference, &grid, &reference_grid), "%s", tc_message());
    EXPECT(extract(parents_reference, &grid, &surface, &parents_mesh, &expected), "%s", tc_message());
    EXPECT(expected.triangle_count > 100, "a mesh too small to tell");
    child_run(before_any, "before any use of OpenCL");
    child_run(before_any, "once more");

    parents = context_open(&options);
    child_run(own_context, "after a context was made");
    EXPECT(!tc_grid_create(parents, &grid, &parents_grid), "%s", tc_message());
    mesh_expect(parents, "the parent");
    child_run(own_context, "after a mesh was made");
    child_run(own_reference, "reference engine");
    child_run(parents_objects, "the parent's objects");
    child_run(parents_destroyed, "the parent's objects, destroyed");
    child_run(grandchild, "a child's child");
    mesh_expect(parents, "the parent, at last");
    parents_destroyed();
    return EXPECT_DONE();
}
