/*
 * mesh_write.h - a mesh to a file: the format follows the file's ending
 *
 * Written beside the final name and renamed when complete, so that a failed run leaves no partial file and an older
 * file under the name stays whole until then. A name that exists and is no regular file (/dev/stdout, a FIFO) is
 * written directly; "-" is standard output. Symbolic links are followed, also to where nothing is yet.
 */
#ifndef MESH_WRITE_H
#define MESH_WRITE_H

#include "tetracubes.h"
#include "vertex_values.h"

/*
 * The table of formats that are written (host/README.md says what a new one needs). ROW is applied to each:
 *
 *     ROW(name, label, roles, has_doubles, counts, fits, pieces)
 *
 *     name         of --format, and the ending; the writer of a mesh is name_write (formats.h)
 *     roles        of values that vertices have beside their positions; HAS_LABELS: triangles have their labels
 *     has_doubles  of coordinates
 *     counts       what the format counts in 32 bits: vertices, triangles or nothing
 *     fits         of a format whose files have a limit of size: the function that tells whether a mesh keeps it
 *     pieces       how a mesh may be written piece by piece: triangles by NUMBERS of their vertices, by their CORNERS,
 *                  or NOT, as places in the file are not known before
 */
/* clang-format off */
#define MESH_FORMATS(ROW)                                                                                              \
    ROW(ply, "PLY", HAS_NORMALS | HAS_DATA | HAS_LABELS, 1, vertices, NULL, NUMBERS)                                   \
    ROW(vtp, "VTP", HAS_NORMALS | HAS_DATA | HAS_LABELS, 1, nothing, NULL, NUMBERS)                                    \
    ROW(stl, "STL", 0, 0, triangles, NULL, CORNERS)                                                                    \
    ROW(obj, "OBJ", HAS_NORMALS, 1, vertices, NULL, NOT)                                                               \
    ROW(off, "OFF", 0, 1, vertices, NULL, NOT)                                                                         \
    ROW(glb, "GLB", HAS_NORMALS | HAS_LABELS, 0, vertices, glb_fits, NOT)                                              \
    ROW(html, "HTML", HAS_NORMALS | HAS_LABELS, 0, vertices, html_fits, NOT)                                           \
    ROW(npz, "NPZ", HAS_NORMALS | HAS_DATA | HAS_LABELS, 1, vertices, NULL, NOT)                                       \
    ROW(vtkhdf, "VTKHDF", HAS_NORMALS | HAS_DATA | HAS_LABELS, 1, nothing, NULL, NUMBERS)

/* Of complexes: name and label. */
#define COMPLEX_FORMATS(ROW) ROW(vtu, "VTU")
/* clang-format on */

enum { HAS_DATA = 1 << ROLE_DATA, HAS_NORMALS = 1 << ROLE_NORMALS, HAS_LABELS = 1 << ROLE_COUNT };

/* One block's part of a mesh: consecutive vertices, and consecutive triangles that use no others. */
typedef struct mesh_part {
    uint64_t vertex_count, triangle_count;
    double origin[3]; /* that their positions are relative to */
} mesh_part;

typedef struct mesh_write_options {
    const char *format;         /* a name of MESH_FORMATS, in any case; NULL: the file's ending */
    int soup;                   /* nonzero: three vertices of its own for every triangle (STL has no other form) */
    const vertex_array *fields; /* beside the channels of the mesh */
    int field_count;
    const mesh_part
        *parts; /* in the order of vertices; together all of them. part_count 0: one, with the mesh's origin */
    int part_count;
    const char *world, *units;  /* of coordinates, as "LPS" and "mm", which go into headers; NULL or "": not known */
    const double *origin_at;    /* the world position that becomes 0, 0, 0 in the file. NULL: the file has world
                                   coordinates; STL, which has only float32, has them relative to the mesh's origin */
    struct output_group *group; /* where the file waits until it appears with others (output_group.h); NULL: it appears
                                   at once */
    const struct output_shared *shared; /* of a file that several processes write piece by piece, each with pieces of
                                           its own (output.h); NULL: this one alone */
} mesh_write_options;

/* Whether triangles share vertices in the file: not in STL. */
int mesh_write_shares_vertices(const char *path, const mesh_write_options *options);

/* Adds the writer of VTKHDF, which is refused without it: a part of the library mesh_write_hdf5, so that programs that
 * do without libhdf5 need not have it. To be called once, before the others. */
void mesh_write_add_hdf5(void);

/* To be called before any work is done. 0 where path's ending, or options->format, is a format that is written and
 * takes the fields; else STATUS_USAGE with a message that names the formats. options may be NULL here and below. */
int mesh_write_check(const char *path, const mesh_write_options *options);

/* Whether the format has coordinates in double precision. */
int mesh_write_has_doubles(const char *path, const mesh_write_options *options);

/* Whether the format is known and has no values of that role. */
int mesh_write_lacks(const char *path, const mesh_write_options *options, vertex_role role);

/* Whether the format is known and has nowhere to put the labels of triangles. */
int mesh_write_lacks_labels(const char *path, const mesh_write_options *options);

/* Whether the file would hold coordinates relative to the mesh's origin, as its format has float32 alone. */
int mesh_write_is_relative(const char *path, const tc_mesh_data *mesh, const mesh_write_options *options);

/*
 * Writes positions (in double precision where they differ from those of the mesh by an offset), the other channels that
 * the mesh has, as far as the format takes their roles, the fields, and triangles, whose indices must be below
 * vertex_count; of a label map's mesh its labels, where the format has them: of cells as "BoundaryLabels", in PLY as
 * properties "boundary_labels_0" and "boundary_labels_1" of faces, in NPZ as "boundary_labels". Returns 0 or
 * STATUS_FAILED / STATUS_USAGE with its message (failure.h).
 *
 * Values that have a name of their own in the format, like normals, get that. In PLY each component of others is a
 * property: NAME, or NAME_0, NAME_1, ...; characters other than letters and digits become '_'. In PLY and VTP '_' is
 * appended to a name that is taken already, by values before or by the format (x, nx, Points, ...).
 */
int mesh_write(const char *path, const tc_mesh_data *mesh, const mesh_write_options *options);

/*
 * A mesh written piece by piece, for meshes larger than memory: the same bytes as mesh_write makes of all of it. The
 * pieces come in the order of the mesh, and triangles of a piece may use vertices of the next one: vertex_count + n is
 * vertex n of that.
 */
typedef struct mesh_file mesh_file;

/* 0 where the format can be written so: to be called before any work is done. */
int mesh_file_check(const char *path, const mesh_write_options *options);

/* Whether the vertices and the triangles of a piece may be added one after the other, as pieces without the other. */
int mesh_file_takes_halves(const char *path, const mesh_write_options *options);

/* whole: counts, origin, and which channels there are (pointers that are not NULL); of options->fields only names and
 * components matter. *file is to be closed or discarded; NULL after a failure. path and options outlive it. */
int mesh_file_open(const char *path, const mesh_write_options *options, const tc_mesh_data *whole, mesh_file **file);

/* fields: of the piece's vertices, as many as options->fields has. Errors that last are told by mesh_file_close too. */
int mesh_file_add(mesh_file *file, uint64_t first_vertex, uint64_t first_triangle, const tc_mesh_data *piece,
                  const vertex_array *fields);

/* Whether triangles wait for vertices of the next piece. Where another process has that, and writes all else of it,
 * mesh_file_complete writes them. */
int mesh_file_waits(const mesh_file *file);
int mesh_file_complete(mesh_file *file, const tc_mesh_data *next);

/* Puts the file under its name, or into options->group. Both accept NULL, and free the mesh_file. */
int mesh_file_close(mesh_file *file);
void mesh_file_discard(mesh_file *file);

/* A tetrahedral complex as the file of an unstructured grid, VTK XML .vtu, with the fields that are given. */
typedef struct complex_file {
    uint64_t point_count;
    const float *points;      /* x, y, z each */
    const double *points_f64; /* instead of points */
    uint64_t tetrahedron_count;
    const uint32_t *tetrahedra;         /* 4 points each */
    const struct dataset_field *fields; /* of the points: host/read/dataset/dataset.h */
    int field_count;
    const char *world, *units; /* as above */
} complex_file;

/* format: a name of COMPLEX_FORMATS, in any case; NULL: the path's ending, and for "-" the first of them. 0, or
 * STATUS_USAGE with its message: to be called before any work is done. */
int complex_write_check(const char *path, const char *format);

/* path is one that complex_write_check takes. */
int complex_write(const char *path, const complex_file *complex);

#endif
