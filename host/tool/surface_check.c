#include "surface_check.h"

#include "coarse.h"
#include "commands.h"
#include "faces.h"
#include "mesh_check.h"
#include "notice.h"
#include "verify.h"

int surface_verify(engine *reference_engine, const tc_extract_options *how, const tc_mesh_data *m, surface_report *s) {
    tc_mesh_data reference;
    char text[256];
    int status = engine_extract(reference_engine, how, &reference);
    if (status) return status;
    s->has_verdict = 1;
    s->verified = verify_same(m, &reference, text, sizeof text);
    if (!s->verified) message("isovalue %s: verification failed: %s", s->iso->text, text);
    return 0;
}

/* A surface can be no better than its input. Where each misoriented edge lies in a face whose two cells are on one side
 * of it, and nothing else is wrong, *good is set. */
static int explain_faults(const block_list *blocks, const surface_report *s, int *good) {
    const mesh_topology *t = &s->topology;
    void (*tell)(const char *format, ...) __attribute__((format(printf, 1, 2)));
    complex_faces crossed;
    int status = blocks_check_faces(blocks, &s->iso->value, &crossed);
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

int surface_check(const block_list *blocks, const tc_mesh_data *m, surface_report *s, int *good) {
    const mesh_topology *t = &s->topology;
    int status = mesh_check(m->positions, m->vertex_count, m->triangles, m->triangle_count, &s->topology);
    if (status) return status;
    s->has_topology = 1;
    *good = !t->nonmanifold_edges && !t->misoriented_edges && !t->orphan_vertices && !t->invalid_triangles &&
            (!t->nonmanifold_vertices || blocks_may_touch(blocks));
    if ((t->misoriented_edges || t->nonmanifold_edges) && (status = explain_faults(blocks, s, good))) return status;
    if (!*good)
        message("isovalue %s: check failed: %llu non-manifold edges, %llu non-manifold vertices, %llu misoriented "
                "edges, %llu unused vertices, %llu invalid triangles",
                s->iso->text, (unsigned long long)t->nonmanifold_edges, (unsigned long long)t->nonmanifold_vertices,
                (unsigned long long)t->misoriented_edges, (unsigned long long)t->orphan_vertices,
                (unsigned long long)t->invalid_triangles);
    if (!s->coarse_vertices) return 0;
    *good = 0;
    message("isovalue %s: check failed: %llu vertices lie where cells are thinner than %d steps of the numbers that "
            "coordinates are: shapes are lost there",
            s->iso->text, (unsigned long long)s->coarse_vertices, COARSE_STEPS_LEAST);
    return 0;
}
