/*
 * complex_check.c - folded and non-manifold faces of tetrahedra, found by looking at the faces of every point
 *
 * Method. A face is kept at its lowest point, as the two other points in the order in which they are seen from outside
 * its tetrahedron. A counting sort groups the faces by lowest point; then the faces of each point are sorted by the two
 * others. The same face of several tetrahedra now lies side by side, and the order of its two points tells the
 * direction. Several threads sort; the sums of what they count do not depend on how many threads there are.
 */
#include "complex_check.h"

#include "exit_status.h"
#include "failure.h"
#include "parallel.h"

#include <stdlib.h>
#include <string.h>

enum { CHUNK_POINTS = 1 << 12, INSERTION_SORT_MOST = 48 };

typedef struct face {
    uint32_t next, previous;
} face;

typedef struct workspace {
    uint64_t point_count;
    const uint32_t *tetrahedra;
    uint64_t tetrahedron_count;
    const uint8_t *sides;
    uint64_t *starts; /* of each point's faces */
    face *faces;
    uint64_t next_chunk; /* shared by the threads, as the next two are */
    uint64_t folded_faces, nonmanifold_faces;
} workspace;

/* Opposite to corner n: counter-clockwise seen from outside a positive tetrahedron. */
static const uint8_t face_corners[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

static int is_valid(const workspace *w, const uint32_t v[4]) {
    for (int n = 0; n < 4; n++)
        if (v[n] >= w->point_count) return 0;
    return v[0] != v[1] && v[0] != v[2] && v[0] != v[3] && v[1] != v[2] && v[1] != v[3] && v[2] != v[3];
}

static int is_present(const workspace *w, const uint32_t v[4]) {
    if (!is_valid(w, v)) return 0;
    for (int n = 0; n < 4 && w->sides; n++)
        if (w->sides[v[n]] == SIDE_MISSING) return 0;
    return 1;
}

/* The face opposite corner n, its lowest point first; false where it does not count. */
static int face_take(const workspace *w, const uint32_t v[4], int n, uint32_t points[3]) {
    const uint8_t *at = face_corners[n];
    int lowest = 0;
    for (int k = 1; k < 3; k++)
        if (v[at[k]] < v[at[lowest]]) lowest = k;
    for (int k = 0; k < 3; k++) points[k] = v[at[(lowest + k) % 3]];
    return !w->sides || w->sides[points[0]] != w->sides[points[1]] || w->sides[points[0]] != w->sides[points[2]];
}

/* Counts each point's faces into starts[point + 1] and makes sums of them. */
static void count_faces(workspace *w, complex_faces *result) {
    uint32_t points[3];
    for (uint64_t t = 0; t < w->tetrahedron_count; t++) {
        const uint32_t *v = w->tetrahedra + 4 * t;
        result->invalid_tetrahedra += !is_valid(w, v);
        if (!is_present(w, v)) continue;
        for (int n = 0; n < 4; n++)
            if (face_take(w, v, n, points)) w->starts[(uint64_t)points[0] + 1]++;
    }
    for (uint64_t p = 0; p < w->point_count; p++) w->starts[p + 1] += w->starts[p];
}

/* starts[p] moves from the start to the end of p's faces, which is the start of those of p + 1. */
static void group_faces(workspace *w) {
    uint32_t points[3];
    for (uint64_t t = 0; t < w->tetrahedron_count; t++) {
        const uint32_t *v = w->tetrahedra + 4 * t;
        if (!is_present(w, v)) continue;
        for (int n = 0; n < 4; n++)
            if (face_take(w, v, n, points)) w->faces[w->starts[points[0]]++] = (face){points[1], points[2]};
    }
}

/* ----------------------------------------------------------------------------------------------- faces of one point */

static uint64_t face_key(face f) {
    return f.next < f.previous ? (uint64_t)f.next << 32 | f.previous : (uint64_t)f.previous << 32 | f.next;
}

static int compare_faces(const void *a, const void *b) {
    uint64_t x = face_key(*(const face *)a), y = face_key(*(const face *)b);
    return (x > y) - (x < y);
}

static void sort_faces(face *faces, uint64_t count) {
    if (count > INSERTION_SORT_MOST) {
        qsort(faces, count, sizeof *faces, compare_faces);
        return;
    }
    for (uint64_t i = 1; i < count; i++) {
        face value = faces[i];
        uint64_t j = i;
        for (; j > 0 && face_key(faces[j - 1]) > face_key(value); j--) faces[j] = faces[j - 1];
        faces[j] = value;
    }
}

static void inspect_point(face *faces, uint64_t count, uint64_t *folded, uint64_t *nonmanifold) {
    sort_faces(faces, count);
    for (uint64_t first = 0, end; first < count; first = end) {
        for (end = first + 1; end < count && face_key(faces[end]) == face_key(faces[first]);) end++;
        *folded += end - first == 2 && faces[first].next == faces[first + 1].next;
        *nonmanifold += end - first > 2;
    }
}

static void inspect_points(void *shared) {
    workspace *w = shared;
    uint64_t folded = 0, nonmanifold = 0, first;
    while ((first = __atomic_fetch_add(&w->next_chunk, 1, __ATOMIC_RELAXED) * CHUNK_POINTS) < w->point_count)
        for (uint64_t p = first; p < first + CHUNK_POINTS && p < w->point_count; p++) {
            uint64_t start = p ? w->starts[p - 1] : 0;
            inspect_point(w->faces + start, w->starts[p] - start, &folded, &nonmanifold);
        }
    __atomic_fetch_add(&w->folded_faces, folded, __ATOMIC_RELAXED);
    __atomic_fetch_add(&w->nonmanifold_faces, nonmanifold, __ATOMIC_RELAXED);
}

int complex_check(uint64_t point_count, const uint32_t *tetrahedra, uint64_t tetrahedron_count, const uint8_t *sides,
                  complex_faces *result) {
    workspace w = {
        .point_count = point_count, .tetrahedra = tetrahedra, .tetrahedron_count = tetrahedron_count, .sides = sides};
    memset(result, 0, sizeof *result);
    w.starts = calloc((size_t)point_count + 1, sizeof *w.starts);
    if (w.starts) {
        count_faces(&w, result);
        w.faces = malloc((size_t)(w.starts[point_count] + 1) * sizeof *w.faces);
    }
    if (w.faces) {
        group_faces(&w);
        parallel_run((point_count + CHUNK_POINTS - 1) / CHUNK_POINTS, inspect_points, &w);
    }
    result->folded_faces = w.folded_faces;
    result->nonmanifold_faces = w.nonmanifold_faces;
    int is_done = w.faces != NULL;
    free(w.starts);
    free(w.faces);
    if (is_done) return 0;
    return fail(STATUS_FAILED,
                "no memory to check the faces of %llu tetrahedra at %llu points: 32 bytes per tetrahedron and 8 per "
                "point are needed",
                (unsigned long long)tetrahedron_count, (unsigned long long)point_count);
}
