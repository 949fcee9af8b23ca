#include "surface_simplify.h"

#include "counted.h"
#include "exit_status.h"
#include "failure.h"
#include "mesh_distance.h"
#include "mesh_edges.h"
#include "mesh_simplify.h"
#include "progress.h"
#include "terminal/notice.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

int surface_simplify_check_usage(const options *o) {
    if (HAVE_MESHOPTIMIZER || !options_given(o, "--simplify")) return 0;
    return fail(STATUS_USAGE,
                "--simplify needs meshoptimizer, which this program was built without; build it with that "
                "(Debian: libmeshoptimizer-dev) and TETRACUBES_MESHOPTIMIZER=ON, or use --method snap, "
                "which makes fewer triangles");
}

#if HAVE_MESHOPTIMIZER

/* Triangles whose normals are 150 degrees apart or more are folded. */
static const double fold_cosine = -0.8660254037844386;

/* The surface of one block, as it was. */
typedef struct block_surface {
    const options *o;
    const typed_isovalue *iso;
    mesh_view view; /* its triangles count from the block's first vertex */
    double spacing; /* of samples of distances */
} block_surface;

typedef struct shape {
    mesh_topology topology;
    mesh_edges edges;
} shape;

/* -------------------------------------------------------------------------------------------------------- distances */

static int measure(const block_surface *b, const mesh_view *left, double *to, double *from) {
    int status = mesh_distance(&b->view, left, b->spacing, to);
    if (!status) status = mesh_distance(left, &b->view, b->spacing, from);
    return status ? status : progress_status();
}

static float *positions_of(const block_surface *b, const simplified_mesh *m) {
    float *positions = malloc((size_t)(3 * m->vertex_count + 1) * sizeof *positions);
    for (uint64_t v = 0; v < m->vertex_count && positions; v++)
        memcpy(positions + 3 * v, b->view.positions + 3 * (uint64_t)m->sources[v], 3 * sizeof *positions);
    if (!positions) fail(STATUS_FAILED, "out of memory to measure a simplified surface");
    return positions;
}

/* Of mesh_simplify: whether a stage's result is within --simplify-error. */
static int judge(void *user, const simplified_mesh *m, int *is_good) {
    const block_surface *b = user;
    double to = 0, from = 0;
    if (!options_given(b->o, "--simplify-error")) return progress_status();
    float *positions = positions_of(b, m);
    const mesh_view left = {positions, m->vertex_count, m->triangles, m->triangle_count};
    const int status = positions ? measure(b, &left, &to, &from) : STATUS_FAILED;
    *is_good = to <= b->o->simplify_error && from <= b->o->simplify_error;
    free(positions);
    return status;
}

/* ------------------------------------------------------------------------------------------------------------ check */

static int shape_find(const mesh_view *m, shape *out) {
    const int status = mesh_check(m->positions, m->vertex_count, m->triangles, m->triangle_count, &out->topology);
    if (status) return status;
    return mesh_edges_find(m->positions, m->vertex_count, m->triangles, m->triangle_count, fold_cosine, &out->edges);
}

/* Names the first promise that was broken; NULL where all are kept. */
static const char *broken_promise(const shape *before, const shape *after) {
    const mesh_topology *a = &before->topology, *b = &after->topology;
    if (b->invalid_triangles || b->orphan_vertices) return "has triangles that are none, or unused vertices";
    if (b->nonmanifold_edges > a->nonmanifold_edges) return "has edges of more than two triangles";
    if (b->nonmanifold_vertices > a->nonmanifold_vertices) return "has vertices with several fans of triangles";
    if (b->misoriented_edges > a->misoriented_edges) return "has misoriented edges";
    if (b->boundary_edges != a->boundary_edges || after->edges.border != before->edges.border)
        return "has another border";
    if (b->components != a->components) return "has another number of components";
    if (b->euler_characteristic != a->euler_characteristic) return "has another Euler characteristic";
    if (after->edges.folded > before->edges.folded) return "has more triangles folded onto each other";
    return NULL;
}

static int check(const block_surface *b, const mesh_view *left, int *good) {
    shape before, after;
    int status = shape_find(&b->view, &before);
    if (!status) status = shape_find(left, &after);
    const char *broken = status ? NULL : broken_promise(&before, &after);
    if (!broken) return status;
    *good = 0;
    message("isovalue %s: the simplified surface %s: leave out --simplify, or give a larger share; --method snap makes "
            "fewer triangles with the topology kept",
            b->iso->text, broken);
    return 0;
}

/* ----------------------------------------------------------------------------------------------------------- blocks */

/* All blocks' results, one behind the other. */
typedef struct left_mesh {
    uint32_t *triangles, *sources;
    uint64_t vertex_count, triangle_count;
} left_mesh;

static void append(const simplified_mesh *m, uint64_t first_vertex, left_mesh *to) {
    for (uint64_t v = 0; v < m->vertex_count; v++)
        to->sources[to->vertex_count + v] = (uint32_t)(first_vertex + m->sources[v]);
    for (uint64_t c = 0; c < 3 * m->triangle_count; c++)
        to->triangles[3 * to->triangle_count + c] = (uint32_t)(to->vertex_count + m->triangles[c]);
    to->vertex_count += m->vertex_count;
    to->triangle_count += m->triangle_count;
}

static int measure_and_check(const block_surface *b, const simplified_mesh *m, simplified_report *r, int *good) {
    float *positions = positions_of(b, m);
    const mesh_view left = {positions, m->vertex_count, m->triangles, m->triangle_count};
    double to = 0, from = 0;
    int status = positions ? measure(b, &left, &to, &from) : STATUS_FAILED;
    if (!status) status = check(b, &left, good);
    r->distance_to = fmax(r->distance_to, to);
    r->distance_from = fmax(r->distance_from, from);
    free(positions);
    return status;
}

static int simplify_block(block_surface *b, uint64_t first_vertex, left_mesh *to, simplified_report *r, int *good) {
    const simplify_options how = {b->o->simplify, fold_cosine, judge, b};
    const mesh_view *v = &b->view;
    simplified_mesh m;
    b->spacing = 2 * mesh_spacing(v);
    int status = mesh_simplify(v->positions, v->vertex_count, v->triangles, v->triangle_count, &how, &m);
    if (!status) status = measure_and_check(b, &m, r, good);
    if (!status) append(&m, first_vertex, to);
    simplified_mesh_release(&m);
    return status;
}

static int simplify_blocks(const options *o, const result_mesh *mesh, surface_report *s, left_mesh *to, int *good) {
    const tc_mesh_data *m = &mesh->mesh;
    uint64_t vertex = 0, triangle = 0;
    int status = 0;
    for (int n = 0; n < mesh->part_count && !status; n++) {
        const mesh_part *part = &mesh->parts[n];
        block_surface b = {.o = o, .iso = s->iso};
        uint32_t *triangles = malloc((size_t)(3 * part->triangle_count + 1) * sizeof *triangles);
        if (!triangles) status = fail(STATUS_FAILED, "out of memory to simplify the surface of a block");
        for (uint64_t c = 0; c < 3 * part->triangle_count && triangles; c++)
            triangles[c] = m->triangles[3 * triangle + c] - (uint32_t)vertex;
        b.view = (mesh_view){m->positions + 3 * vertex, part->vertex_count, triangles, part->triangle_count};
        if (!status) status = simplify_block(&b, vertex, to, &s->simplified, good);
        free(triangles);
        vertex += part->vertex_count;
        triangle += part->triangle_count;
    }
    return status;
}

/* Distances and contractions have no meaning where vertices are nowhere. */
static int check_finite(const tc_mesh_data *m, const typed_isovalue *iso) {
    mesh_summary summary;
    mesh_summarize(m->positions, m->vertex_count, m->triangles, m->triangle_count, &summary);
    if (!summary.nonfinite_vertices) return 0;
    return fail(STATUS_FAILED,
                "isovalue %s: %" PRIu64 " vertices have coordinates that are not finite: leave out --simplify",
                iso->text, summary.nonfinite_vertices);
}

int surface_simplify(const options *o, result_mesh *mesh, surface_report *s, int *good) {
    const tc_mesh_data *m = &mesh->mesh;
    const double begin = now_ms();
    left_mesh left = {malloc((size_t)(3 * m->triangle_count + 1) * sizeof *left.triangles),
                      malloc((size_t)(m->vertex_count + 1) * sizeof *left.sources), 0, 0};
    int status = left.triangles && left.sources ? 0 : fail(STATUS_FAILED, "out of memory for the simplified surface");
    if (!status) status = check_finite(m, s->iso);
    s->has_simplified = 1;
    s->simplified.vertices_before += m->vertex_count;
    s->simplified.triangles_before += m->triangle_count;
    if (!status) status = simplify_blocks(o, mesh, s, &left, good);
    s->simplified.ms += now_ms() - begin;
    if (!status) return result_mesh_keep(mesh, left.vertex_count, left.sources, left.triangle_count, left.triangles);
    free(left.triangles);
    free(left.sources);
    return status;
}

#else

int surface_simplify(const options *o, result_mesh *mesh, surface_report *s, int *good) {
    (void)mesh, (void)s, (void)good;
    return surface_simplify_check_usage(o);
}

#endif

/* The greatest distance that simplifying has made, as a part of the size of what is left. */
static double part_lost(const surface_report *s) {
    const double *low = s->summary.bounds[0], *high = s->summary.bounds[1];
    const double size = hypot(hypot(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
    const double distance = fmax(s->simplified.distance_to, s->simplified.distance_from);
    return size > 0 ? distance / size : 0;
}

/* Less is left than shows the shape: of a ball, that fewer than some 25 triangles are. */
static void tell_shapeless(const options *o, const surface_report *s) {
    static const double much = 0.05;
    const double lost = part_lost(s);
    if (lost > much)
        notice("isovalue %s: %s, which differs from the surface before by %.2g%% of its size: its shape is lost; %s "
               "keeps it",
               s->iso->text, counted(s->triangle_count, "triangle is left", "triangles are left").text, 100 * lost,
               options_given(o, "--simplify-error") ? "a smaller --simplify-error"
                                                    : "a larger RATIO, or --simplify-error D,");
}

void surface_simplify_tell(const options *o, const surface_report *s) {
    static const double tolerance = 1.05;
    const double goal = o->simplify * (double)s->simplified.triangles_before;
    const int has_error = options_given(o, "--simplify-error");
    if (!s->has_simplified) return;
    tell_shapeless(o, s);
    if ((double)s->triangle_count <= tolerance * goal + 8) return;
    notice("isovalue %s: %s, not %.0f: %sthe border, which stays, and topology keep %s; %s", s->iso->text,
           counted(s->triangle_count, "triangle is left", "triangles are left").text, ceil(goal),
           has_error ? "--simplify-error, " : "", s->triangle_count == 1 ? "it" : "them",
           has_error ? "a larger one leaves fewer"
                     : "for fewer, smooth or thin (--step) the samples first, so that pieces and holes go");
}
