/*
 * test_stream_large.c - a stream of 2^33 samples and more, whose mesh has more than 2^32 vertices
 *
 * No volume is on a disk: planes repeat after every layer of bricks, so that all layers but the last have the same
 * triangles, and vertices at the same places, four planes further on. Counts are compared with those of a few layers,
 * pieces with each other. For the long tier: it takes minutes, and a device.
 *
 * Usage: test_stream_large [SIDE [PLANES]]
 */
#include "engines.h"
#include "random.h"

#include <inttypes.h>

enum { PERIOD = 4 };

typedef struct flow {
    int64_t side, planes;
    const uint8_t *period; /* samples of PERIOD planes */
    tc_counts counts;
    uint64_t vertices, triangles; /* taken so far */
    tc_mesh_data first; /* of the second piece: the first has the grid's border, and others of its size follow */
    uint32_t *indices;
    uint64_t compared;
} flow;

static int planes_give(void *user, tc_planes *planes) {
    const flow *f = user;
    const size_t plane = (size_t)(f->side * f->side);
    for (int64_t z = 0; z < planes->count; z++)
        memcpy((uint8_t *)planes->samples + (size_t)z * plane,
               f->period + (size_t)((planes->first + z) % PERIOD) * plane, plane);
    return 0;
}

static int counts_take(void *user, size_t surface, const tc_counts *counts) {
    EXPECT(surface == 0, "surface %zu of one", surface);
    ((flow *)user)->counts = *counts;
    return 0;
}

static int piece_take(void *user, const tc_mesh_piece *piece) {
    flow *f = user;
    const tc_mesh_data *m = piece->mesh;
    const size_t bytes = 3 * sizeof(uint32_t) * (size_t)m->triangle_count;
    EXPECT(piece->first_vertex == f->vertices && piece->first_triangle == f->triangles, "a piece at another place");
    f->vertices += m->vertex_count;
    f->triangles += m->triangle_count;
    if (!f->indices) {
        f->first = *m;
        f->indices = malloc(bytes);
        if (f->indices) memcpy(f->indices, m->triangles, bytes);
    } else if (m->vertex_count == f->first.vertex_count && m->triangle_count == f->first.triangle_count &&
               piece->first_plane + piece->plane_count + PERIOD < f->planes) { /* no layer behind that ends early */
        EXPECT(!memcmp(m->triangles, f->indices, bytes), "the piece from vertex %" PRIu64 " on has other triangles",
               piece->first_vertex);
        f->compared++;
    }
    return 0;
}

static bool flow_run(tc_context *context, flow *f, int64_t planes, bool emits) {
    tc_grid_options grid;
    tc_extract_options how;
    tc_stream_options o;
    tc_grid_options_init(&grid);
    tc_extract_options_init(&how);
    tc_stream_options_init(&o);
    grid.dims[0] = grid.dims[1] = f->side;
    grid.dims[2] = f->planes = planes;
    how.isovalue = 127.5;
    o.grid = &grid;
    o.surfaces = &how;
    o.surface_count = 1;
    o.read = planes_give;
    o.counted = counts_take;
    o.take = emits ? piece_take : NULL;
    o.user = f;
    o.max_memory_bytes = (uint64_t)(f->side * f->side) * 256; /* in many pieces */
    const bool done = tc_stream(context, &o) == TC_OK;
    EXPECT(done, "%d planes: %s", (int)planes, tc_message());
    return done;
}

int main(int argc, char **argv) {
    const int64_t side = argc > 1 ? atoll(argv[1]) : 2048, planes = argc > 2 ? atoll(argv[2]) : 2052;
    const size_t plane = (size_t)(side * side);
    uint8_t *period = malloc(PERIOD * plane);
    flow few[2] = {{.side = side, .period = period}, {.side = side, .period = period}}, f = few[0];
    tc_context_options options;
    if (!device_exists()) return SKIPPED;
    if (!period) return EXIT_FAILURE;
    random_state = 5;
    for (size_t n = 0; n < PERIOD * plane; n++) period[n] = random_below(10) ? 20 : 200;
    tc_context_options_init(&options);
    tc_context *context = context_open(&options);
    if (flow_run(context, &few[0], 64, false) && flow_run(context, &few[1], 128, false) &&
        flow_run(context, &f, planes, true)) {
        const uint64_t layers = (uint64_t)(planes - 64) / PERIOD;
        const uint64_t vertices = (few[1].counts.vertex_count - few[0].counts.vertex_count) / 16 * layers;
        const uint64_t triangles = (few[1].counts.triangle_count - few[0].counts.triangle_count) / 16 * layers;
        EXPECT(f.counts.vertex_count == few[0].counts.vertex_count + vertices &&
                   f.counts.triangle_count == few[0].counts.triangle_count + triangles,
               "%" PRIu64 " vertices are counted", f.counts.vertex_count);
        EXPECT(f.vertices == f.counts.vertex_count && f.triangles == f.counts.triangle_count, "%" PRIu64 " come",
               f.vertices);
        EXPECT(f.compared > 2, "%d pieces could be compared", (int)f.compared);
        EXPECT(argc > 1 || f.vertices > UINT32_MAX, "only %" PRIu64 " vertices", f.vertices);
        printf("%" PRIu64 " vertices, %" PRIu64 " triangles of %" PRId64 " samples\n", f.vertices, f.triangles,
               side * side * planes);
    }
    tc_context_destroy(context);
    free(f.indices);
    free(period);
    return EXPECT_DONE();
}
