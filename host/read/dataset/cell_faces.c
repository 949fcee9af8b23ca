#include "dataset/cell_faces.h"

#include "exit_status.h"
#include "failure.h"

#include <inttypes.h>
#include <string.h>

/* In how many cells a face may be, on average. Two is what meshes have; without a bound a small file could ask for much
 * memory. */
enum { SHARED_MOST = 16 };

typedef struct face_counts {
    int64_t faces, corners;
} face_counts;

/* Adds the faces and corners of a cell. Returns 0 where the numbers are not exactly one stream. */
static int count_faces(const int64_t *from, const int64_t *end, face_counts *counts) {
    if (from == end) return 1;
    int64_t faces = *from++;
    if (faces < 0 || faces > end - from) return 0;
    counts->faces += faces;
    for (; faces; faces--) {
        int64_t corners = from < end ? *from++ : -1;
        if (corners < 0 || corners > end - from) return 0;
        counts->corners += corners;
        from += corners;
    }
    return from == end;
}

static int64_t *copy_faces(dataset_block *b, const int64_t *from, int64_t *offset, int64_t *to) {
    for (int64_t faces = *from++; faces; faces--) {
        int64_t corners = *from++;
        memcpy(to, from, (size_t)corners * sizeof *to);
        from += corners;
        to += corners;
        *++offset = to - b->face_points;
    }
    return to;
}

/* *end: where the stream of a polyhedron ends. Returns 0 where the bounds lie outside all the numbers. */
static int stream_bounds(const int64_t *ends, int64_t cell, uint64_t length, int64_t *begin, int64_t *end) {
    *end = ends[cell];
    return *begin >= 0 && *end >= *begin && (uint64_t)*end <= length;
}

static int refuse_stream(const char *path, int64_t cell) {
    return fail(STATUS_INPUT,
                "%s: cell %" PRId64 ", a polyhedron, has faces whose numbers do not fit what the file holds of it; the "
                "file is damaged",
                path, cell);
}

static int count_all(const dataset_block *b, const char *path, const int64_t *stream, uint64_t length,
                     const int64_t *ends, int of_all, face_counts *counts) {
    int64_t begin = 0, end;
    for (int64_t cell = 0; cell < b->cell_count; cell++) {
        if (b->cell_types[cell] == CELL_POLYHEDRON) {
            if (!stream_bounds(ends, cell, length, &begin, &end) || !count_faces(stream + begin, stream + end, counts))
                return refuse_stream(path, cell);
            begin = end;
        }
        if (of_all) begin = ends[cell];
    }
    return 0;
}

static int check_points(const dataset_block *b, const char *path, int64_t corners) {
    for (int64_t n = 0; n < corners; n++)
        if (b->face_points[n] < 0 || b->face_points[n] >= b->point_count)
            return fail(STATUS_INPUT,
                        "%s: a face of its polyhedra has the point %" PRId64 ", but the points are 0 to %" PRId64
                        "; the file is damaged",
                        path, b->face_points[n], b->point_count - 1);
    return 0;
}

/* Memory for the arrays of as many faces and corners. */
static int allocate_faces(dataset *d, dataset_block *b, const face_counts *counts, int64_t **starts, int64_t **offsets,
                          int64_t **points) {
    b->cell_faces = *starts = dataset_allocate(d, ((uint64_t)b->cell_count + 1) * sizeof **starts);
    b->face_offsets = *offsets = dataset_allocate(d, ((uint64_t)counts->faces + 1) * sizeof **offsets);
    b->face_points = *points = dataset_allocate(d, (uint64_t)counts->corners * sizeof **points);
    if (!*starts || !*offsets || !*points) return STATUS_FAILED;
    (*offsets)[0] = 0;
    return 0;
}

int cell_faces_take(dataset *d, dataset_block *b, const char *path, const int64_t *stream, uint64_t length,
                    const int64_t *ends, int of_all) {
    face_counts counts = {0};
    int64_t *starts, *offsets, *to, begin = 0, face = 0;
    int status = count_all(b, path, stream, length, ends, of_all, &counts);
    if (status || (status = allocate_faces(d, b, &counts, &starts, &offsets, &to))) return status;
    for (int64_t cell = 0; cell < b->cell_count; cell++) {
        starts[cell] = face;
        if (b->cell_types[cell] == CELL_POLYHEDRON) {
            if (ends[cell] > begin) {
                to = copy_faces(b, stream + begin, offsets + face, to);
                face += stream[begin];
            }
            begin = ends[cell];
        }
        if (of_all) begin = ends[cell];
    }
    starts[b->cell_count] = face;
    return check_points(b, path, counts.corners);
}

/* ------------------------------------------------------------------------------------------------------------ lists */

static int refuse_list(const char *path, const char *what) {
    return fail(STATUS_INPUT, "%s: %s of the faces of its polyhedra do not fit the others; the file is damaged", path,
                what);
}

static int rises(const int64_t *ends, int64_t count) {
    for (int64_t n = 0; n < count; n++)
        if (ends[n] < (n ? ends[n - 1] : 0)) return 0;
    return 1;
}

static int64_t begin_of(const int64_t *ends, int64_t n) { return n ? ends[n - 1] : 0; }

static int count_listed(const dataset_block *b, const char *path, const face_lists *l, face_counts *counts) {
    if (!rises(l->cell_ends, b->cell_count)) return refuse_list(path, "the numbers");
    if (!rises(l->face_ends, l->face_count)) return refuse_list(path, "the offsets");
    const int64_t most = begin_of(l->face_ends, l->face_count);
    counts->faces = begin_of(l->cell_ends, b->cell_count);
    for (int64_t n = 0; n < counts->faces; n++) {
        int64_t f = l->faces[n];
        if (f < 0 || f >= l->face_count) return refuse_list(path, "the numbers");
        counts->corners += l->face_ends[f] - begin_of(l->face_ends, f);
        if (counts->corners / SHARED_MOST > most)
            return fail(STATUS_INPUT, "%s: too many of its polyhedra share the same faces; the file is damaged", path);
    }
    return 0;
}

int cell_faces_gather(dataset *d, dataset_block *b, const char *path, const face_lists *l) {
    face_counts counts = {0};
    int64_t *starts, *offsets, *to;
    int status = count_listed(b, path, l, &counts);
    if (status || (status = allocate_faces(d, b, &counts, &starts, &offsets, &to))) return status;
    for (int64_t cell = 0; cell <= b->cell_count; cell++) starts[cell] = begin_of(l->cell_ends, cell);
    for (int64_t n = 0; n < counts.faces; n++) {
        int64_t begin = begin_of(l->face_ends, l->faces[n]), corners = l->face_ends[l->faces[n]] - begin;
        memcpy(to, l->points + begin, (size_t)corners * sizeof *to);
        to += corners;
        offsets[n + 1] = to - b->face_points;
    }
    return check_points(b, path, counts.corners);
}
