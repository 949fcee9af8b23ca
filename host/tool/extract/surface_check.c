#include "surface_check.h"

#include "counted.h"
#include "input/face_faults.h"
#include "mesh_check.h"
#include "mesh_compare.h"
#include "precision.h"
#include "terminal/notice.h"

int surface_verify(engine *reference_engine, block_range blocks, const tc_extract_options *how, const tc_mesh_data *m,
                   surface_report *s) {
    tc_mesh_data reference;
    char text[256];
    int status = engine_extract(reference_engine, blocks, how, &reference);
    if (status) return status;
    const int is_same = meshes_are_same(m, &reference, text, sizeof text);
    s->verified = is_same && (s->verified || !s->has_verdict);
    s->has_verdict = 1;
    if (!is_same) message("isovalue %s: verification failed: %s", s->iso->text, text);
    return 0;
}

/* A surface can be no better than its input. *good is set where the cells explain all faults: each misoriented edge
 * lies in a face that has both its cells on the same side, and nothing else is wrong. */
static int explain_faults(const block_list *blocks, const surface_report *s, int *good) {
    const mesh_topology *t = &s->topology;
    void (*tell)(const char *format, ...) __attribute__((format(printf, 1, 2)));
    complex_faces crossed;
    int status = face_faults_find(blocks, &s->iso->value, &crossed);
    if (status) return status;
    int is_explained = crossed.folded_faces && crossed.folded_faces == t->misoriented_edges;
    *good = is_explained && !t->nonmanifold_edges && !t->orphan_vertices && !t->invalid_triangles;
    tell = *good ? notice : message; /* the second with --quiet too */
    if (crossed.folded_faces)
        tell("isovalue %s: cells of the input overlap or have no volume: the surface crosses %llu faces that have "
             "both cells on the same side%s",
             s->iso->text, (unsigned long long)crossed.folded_faces,
             is_explained ? "; these are its misoriented edges" : "");
    if (crossed.nonmanifold_faces)
        tell("isovalue %s: cells of the input overlap: the surface crosses %llu faces of three cells or more",
             s->iso->text, (unsigned long long)crossed.nonmanifold_faces);
    return 0;
}

int surface_check(const tc_mesh_data *m, surface_report *s) {
    mesh_topology *sum = &s->topology, t;
    int status = mesh_check(m->positions, m->vertex_count, m->triangles, m->triangle_count, &t);
    if (status) return status;
    s->has_topology = 1;
    sum->boundary_edges += t.boundary_edges;
    sum->nonmanifold_edges += t.nonmanifold_edges;
    sum->nonmanifold_vertices += t.nonmanifold_vertices;
    sum->misoriented_edges += t.misoriented_edges;
    sum->unbalanced_edges += t.unbalanced_edges;
    sum->orphan_vertices += t.orphan_vertices;
    sum->invalid_triangles += t.invalid_triangles;
    sum->euler_characteristic += t.euler_characteristic;
    sum->components += t.components;
    sum->area += t.area;
    sum->volume += t.volume;
    mesh_shapes_add(m->positions, m->vertex_count, m->triangles, m->triangle_count, &s->shapes);
    return 0;
}

int surface_judge(const block_list *blocks, const surface_report *s, int is_closed, int *good) {
    const mesh_topology *t = &s->topology;
    int status = 0;
    *good = !t->nonmanifold_edges && !t->misoriented_edges && !t->orphan_vertices && !t->invalid_triangles &&
            (!t->nonmanifold_vertices || blocks_may_touch(blocks));
    if ((t->misoriented_edges || t->nonmanifold_edges) && (status = explain_faults(blocks, s, good))) return status;
    if (!*good)
        message("isovalue %s: check failed: %s, %s, %s, %s, %s", s->iso->text,
                counted(t->nonmanifold_edges, "non-manifold edge", "non-manifold edges").text,
                counted(t->nonmanifold_vertices, "non-manifold vertex", "non-manifold vertices").text,
                counted(t->misoriented_edges, "misoriented edge", "misoriented edges").text,
                counted(t->orphan_vertices, "unused vertex", "unused vertices").text,
                counted(t->invalid_triangles, "invalid triangle", "invalid triangles").text);
    if (!*good && is_closed && t->nonmanifold_edges && blocks_have_missing(blocks, 1))
        message(
            "isovalue %s: where two present cells meet only along an edge, beside missing ones, a closed surface has "
            "four triangles at that edge: leave out one of them, or take in their neighbours",
            s->iso->text);
    if (*good && t->nonmanifold_vertices)
        notice(
            "isovalue %s: %s, where cells meet in a point or along an edge only, beside missing ones or in the input: "
            "no fault of the surface",
            s->iso->text, counted(t->nonmanifold_vertices, "non-manifold vertex", "non-manifold vertices").text);
    if (!s->coarse_vertices) return 0;
    *good = 0;
    message("isovalue %s: check failed: %s where cells are thinner than %d steps of the numbers that coordinates are: "
            "shapes are lost there",
            s->iso->text, counted(s->coarse_vertices, "vertex lies", "vertices lie").text, COARSE_STEPS_LEAST);
    return 0;
}
