/*
 * Faces of present tetrahedra are entered into a hash table by their points; those that were met once are the border.
 * Only faces with a point inside are entered: the others add nothing to a surface.
 */
#include "reference/complex_border.h"

#include "failure.h"
#include "grid/complex.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The side of a tetrahedron opposite to each of its corners, counter-clockwise seen from outside. */
static const uint8_t sides[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

typedef struct face_entry {
    uint32_t points[3]; /* ascending */
    uint32_t met;       /* 0: free; 2: more than once */
} face_entry;

typedef struct face_table {
    face_entry *entries; /* open addressing, half full at most */
    uint64_t size, count;
} face_table;

static void points_sort(uint32_t p[3]) {
    for (int n = 0; n < 3; n++) {
        const int at = n % 2;
        const uint32_t low = p[at] < p[at + 1] ? p[at] : p[at + 1], high = p[at] < p[at + 1] ? p[at + 1] : p[at];
        p[at] = low, p[at + 1] = high;
    }
}

/* The face's entry, or the free entry for it. */
static face_entry *face_find(const face_table *t, const uint32_t points[3]) {
    const uint64_t hash =
        (((uint64_t)points[2] << 32 | points[1]) * 0x9e3779b97f4a7c15u ^ points[0]) * 0xbf58476d1ce4e5b9u;
    uint64_t n = (hash ^ hash >> 31) & (t->size - 1);
    while (t->entries[n].met && memcmp(t->entries[n].points, points, sizeof t->entries[n].points))
        n = (n + 1) & (t->size - 1);
    return &t->entries[n];
}

static bool table_grow(face_table *t) {
    const face_table old = *t;
    if (2 * (t->count + 1) < t->size) return true;
    t->size = old.size ? 2 * old.size : 1024;
    t->entries = calloc((size_t)t->size, sizeof *t->entries);
    for (uint64_t n = 0; n < old.size && t->entries; n++)
        if (old.entries[n].met) *face_find(t, old.entries[n].points) = old.entries[n];
    free(old.entries);
    return t->entries != NULL;
}

static tc_status memory_fail(void) { return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the border's faces"); }

static tc_status face_enter(face_table *t, const border_face *face) {
    face_entry f = {{face->points[0], face->points[1], face->points[2]}, 1};
    if (!table_grow(t)) return memory_fail();
    points_sort(f.points);
    face_entry *entry = face_find(t, f.points);
    f.met = entry->met ? 2 : 1;
    t->count += !entry->met;
    *entry = f;
    return TC_OK;
}

static tc_status face_append(const face_table *t, const border_face *face, complex_border *out) {
    uint32_t points[3] = {face->points[0], face->points[1], face->points[2]};
    points_sort(points);
    if (face_find(t, points)->met != 1) return TC_OK;
    if (out->face_count == out->room) {
        const uint64_t room = out->room ? 2 * out->room : 256;
        border_face *grown = realloc(out->faces, (size_t)room * sizeof *grown);
        if (!grown) return memory_fail();
        out->faces = grown, out->room = room;
    }
    out->faces[out->face_count++] = *face;
    return TC_OK;
}

/* The points of a tetrahedron that are inside, a bit each; 0 where a sample is missing. */
static unsigned pattern_of(const tc_grid *grid, const uint32_t points[4], double isovalue) {
    unsigned pattern = 0;
    for (int v = 0; v < 4; v++) {
        const double value = grid_value_at(grid, points[v]);
        if (!isfinite(value)) return 0;
        pattern |= (unsigned)(value >= isovalue) << v;
    }
    return pattern;
}

/* Enters all faces that have a point inside, or appends those of them that are the border's. */
static tc_status faces_visit(const tc_grid *grid, double isovalue, face_table *t, complex_border *out) {
    const complex_grid *c = grid->complex;
    tc_status status = TC_OK;
    for (uint32_t n = 0; n < c->tetrahedron_count && !status; n++) {
        const uint32_t *points = c->tetrahedra + 4 * (uint64_t)n;
        for (int v = 0; v < 4; v++)
            if (points[v] >= c->point_count) return complex_point_fail(c);
        const unsigned pattern = pattern_of(grid, points, isovalue);
        for (unsigned side = 0; side < 4 && !status; side++) {
            const uint8_t *of = sides[side];
            const border_face face = {{points[of[0]], points[of[1]], points[of[2]]}};
            if (pattern & ~(1u << side)) status = out ? face_append(t, &face, out) : face_enter(t, &face);
        }
    }
    return status;
}

tc_status complex_border_find(const tc_grid *grid, double isovalue, complex_border *out) {
    face_table table = {0};
    *out = (complex_border){0};
    tc_status status = table_grow(&table) ? TC_OK : memory_fail();
    if (!status) status = faces_visit(grid, isovalue, &table, NULL);
    if (!status) status = faces_visit(grid, isovalue, &table, out);
    free(table.entries);
    return status;
}

void complex_border_release(complex_border *border) {
    free(border->faces);
    *border = (complex_border){0};
}

int border_face_cut(const border_face *face, unsigned inside, border_vertex triangles[2][3]) {
    const uint32_t *p = face->points;
    border_vertex polygon[4];
    unsigned count = 0, first = 3;
    for (unsigned n = 0; n < 3; n++) /* the inside point that another one follows, else the only one */
        if ((inside >> n & 1) && (first == 3 || (inside >> (n + 1) % 3 & 1))) first = n;
    if (first == 3) return 0;
    for (unsigned n = first; n < first + 3; n++) {
        const unsigned a = n % 3, b = (n + 1) % 3;
        if (inside >> a & 1) polygon[count++] = (border_vertex){p[a], p[a]};
        if ((inside >> a & 1) != (inside >> b & 1)) polygon[count++] = (border_vertex){p[a], p[b]};
    }
    for (unsigned n = 0; n + 2 < count; n++) {
        triangles[n][0] = polygon[0];
        triangles[n][1] = polygon[n + 1];
        triangles[n][2] = polygon[n + 2];
    }
    return (int)count - 2;
}
