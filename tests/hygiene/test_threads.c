/*
 * test_threads.c - a context per thread, all at once: grids of every kind, the same bytes as alone
 *
 * Each thread has contexts of its own, on one engine or on both, and shares with the others nothing but samples,
 * coordinates and tetrahedra. The library's own threads, which check coordinates and cut cells, run beside them. Built
 * with the thread sanitizer this shows that the host's code shares nothing else; of the OpenCL implementation, which is
 * not built so, only the answers are seen.
 *
 *     test_threads [ROUNDS [reference]]
 */
#include "kinds.h"

#include <pthread.h>

enum { THREADS = 4 };

typedef struct worker {
    pthread_t thread;
    int number, rounds;
    tc_engine engine;
    const tc_mesh_data (*expected)[2];
    const char *fault;
} worker;

static int progress(void *user, const char *stage, double fraction) {
    *(double *)user = fraction;
    return !stage;
}

static const char *kind_run(tc_context *context, enum kind kind, const tc_mesh_data expected[2]) {
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    const char *fault = kind_open(context, kind, &grid) ? "no grid" : NULL;
    for (int isovalue = 0; isovalue < 2 && !fault; isovalue++) {
        tc_extract_options how;
        tc_counts counts = {.struct_size = sizeof counts};
        tc_mesh_data data = {.struct_size = sizeof data};
        kind_how(kind, isovalue, &how);
        if (tc_count(grid, &how, &counts) || tc_extract(grid, &how, &mesh) || tc_mesh_get(mesh, &data))
            fault = "a call fails";
        else
            fault =
                counts.vertex_count == data.vertex_count ? mesh_difference(&expected[isovalue], &data) : "the count";
    }
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    return fault;
}

/* Messages are those of the thread. */
static const char *message_check(int number) {
    char wanted[32];
    if (tc_type_name(TC_U8) == NULL || tc_device_get(-1 - number, NULL) == TC_OK) return "a wrong call passes";
    tc_grid_options options;
    tc_grid *grid = NULL;
    tc_context *context = NULL;
    tc_context_options reference;
    tc_context_options_init(&reference);
    reference.engine = TC_ENGINE_REFERENCE;
    kind_describe(KIND_U8, &options);
    options.dims[0] = -1 - number;
    snprintf(wanted, sizeof wanted, "%d samples", -1 - number);
    if (tc_context_create(&reference, &context)) return "no context";
    bool own = true;
    for (int n = 0; n < 2000 && own; n++) {
        tc_grid_create(context, &options, &grid);
        own = strstr(tc_message(), wanted) != NULL;
    }
    tc_context_destroy(context);
    return own ? NULL : "the message of another thread";
}

/* No EXPECT here: its counters are not shared between threads. */
static void *worker_run(void *user) {
    worker *w = user;
    for (int n = 0; n < w->rounds && !w->fault; n++) {
        double done = 0;
        tc_context *context = NULL;
        tc_context_options options;
        tc_tetrahedra complex = {.struct_size = sizeof complex};
        tc_grid_options grid;
        tc_context_options_init(&options);
        options.engine = w->engine;
        options.progress = progress;
        options.progress_user = &done;
        if (tc_context_create(&options, &context)) w->fault = "no context";
        for (int kind = 0; kind < KINDS && !w->fault; kind++) {
            const enum kind turned = (enum kind)((kind + w->number) % KINDS);
            w->fault = kind_run(context, turned, w->expected[turned]);
        }
        tc_context_destroy(context);
        kind_describe(KIND_COMPLEX, &grid);
        if (!w->fault && (tc_tetrahedralize_grid(&grid, &complex) ||
                          complex.tetrahedron_count != kind_complex.tetrahedron_count || done < 0.999))
            w->fault = "tetrahedra, or progress";
        tc_tetrahedra_release(&complex);
        if (!w->fault) w->fault = message_check(w->number);
    }
    return NULL;
}

int main(int argc, char **argv) {
    const int rounds = argc > 1 ? (int)strtol(argv[1], NULL, 10) : 2;
    tc_mesh_data expected[KINDS][2];
    tc_mesh *meshes[KINDS][2];
    worker workers[THREADS];
    kinds_fill();
    tc_context *reference = reference_open();
    for (int n = 0; n < 2 * KINDS; n++)
        meshes[n / 2][n % 2] = kind_expected(reference, (enum kind)(n / 2), n % 2, &expected[n / 2][n % 2]);
    const bool device = argc < 3 && device_exists();
    for (int n = 0; n < THREADS; n++) {
        const tc_engine engine = device && n % 2 ? TC_ENGINE_OPENCL : TC_ENGINE_REFERENCE;
        workers[n] =
            (worker){.number = n, .rounds = rounds, .engine = engine, .expected = (const tc_mesh_data(*)[2])expected};
        EXPECT(pthread_create(&workers[n].thread, NULL, worker_run, &workers[n]) == 0, "no thread");
    }
    for (int n = 0; n < THREADS; n++) {
        pthread_join(workers[n].thread, NULL);
        EXPECT(!workers[n].fault, "thread %d: %s", n, workers[n].fault);
    }
    for (int n = 0; n < 2 * KINDS; n++) tc_mesh_destroy(meshes[n / 2][n % 2]);
    tc_context_destroy(reference);
    kinds_release();
    const int failed = EXPECT_DONE();
    return failed || device || argc > 2 ? failed : SKIPPED;
}
