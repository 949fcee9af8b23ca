/*
 * report.h - what extract found out, as the JSON object of README.md or as text for people
 *
 * Numbers are printed so that they can be typed back: text has the fewest digits that read back the same double.
 */
#ifndef REPORT_H
#define REPORT_H

#include "mesh_check.h"
#include "command_line/options.h"
#include "dataset/dataset.h"
#include "file_names.h"
#include "input/input_summary.h"
#include "terminal/run_times.h"
#include "tetracubes.h"

/* Vertices in cells that are only few steps of floating-point numbers thick (precision.h). */
typedef struct coarse_count {
    uint64_t vertices; /* of all meshes that were looked at */
    uint64_t coarse;   /* where it shows */
    uint64_t lost;     /* where the shape is lost */
    double fewest;     /* steps, where coarse is not 0 */
} coarse_count;

/* What --simplify has made of a surface: sums over its meshes, and of distances the greatest. */
typedef struct simplified_report {
    uint64_t vertices_before, triangles_before; /* behind triangles of zero area that were dropped */
    double distance_to, distance_from; /* Hausdorff distance by samples: of the surface before from what is left of it,
                                          and of that from the surface before */
    double ms;
} simplified_report;

/* One isovalue's results: those of its mesh, or sums over its meshes. */
typedef struct surface_report {
    const typed_isovalue *iso;
    uint64_t vertex_count, triangle_count, active_cell_count;
    double classify_ms, emit_ms, readback_ms;
    uint32_t slab_count;
    int has_mesh;               /* 0: counted only; then the rest is not filled */
    int is_streamed;            /* no hash and no triangles of zero area are known */
    uint64_t piece_count;       /* then: pieces that it was written in */
    double write_ms;            /* then: of all of them */
    mesh_summary summary;       /* bounds in world space. This and the hash: not where no report is printed */
    uint64_t hash;              /* of several meshes: mesh_hash_add of each in turn */
    int has_origin;             /* 0: blocks that lie far from each other have origins of their own */
    double origin[3];           /* that positions in memory, and so the hash, are relative to */
    uint64_t soup_vertex_count; /* of the file: three of its own for every triangle; 0 where it shares them */
    int has_dropped;
    uint64_t dropped_count;     /* triangles of zero area: the other figures are of what is left */
    uint64_t nonmanifold_edges; /* that dropping has left: of more than two triangles */
    int has_simplified;
    simplified_report simplified;
    int has_topology;
    mesh_topology topology;
    mesh_shapes shapes;
    coarse_count coarse_in_mesh, coarse_in_file; /* float32 of the mesh; the numbers in the file */
    uint64_t coarse_vertices;                    /* with --check: where the shape is lost in one of them */
    int is_relative;                             /* the file holds coordinates relative to the mesh's origin */
    int has_verdict;
    int verified;
    file_names outputs, previews; /* that are written: meshes, pictures */
} surface_report;

typedef struct extract_report {
    const options *o;
    tc_engine engine; /* the one that made the surfaces; with --engine auto the last one */
    input_summary input;
    int has_tetrahedra; /* unstructured, and not kept whole: active cells are tetrahedra */
    char device[160];   /* "" for the reference engine */
    run_times times;
    int rank_count;        /* processes that made the surfaces together; 0: this one alone */
    const int64_t *begins; /* then: as in team.h */
    uint64_t sent_bytes;   /* then: to the others, at most by one of them */
    surface_report *surfaces;
    size_t surface_count;
} extract_report;

/* Prints the whole report on standard output. Returns 0 or STATUS_FAILED where memory runs out. */
int extract_report_json(const extract_report *report);
void extract_report_text(const extract_report *report);

#endif
