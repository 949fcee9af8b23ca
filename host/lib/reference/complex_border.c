/*
 * Faces of present tetrahedra are entered into a hash table by their points; those that were met once are the border.
 * Only faces with a point inside are entered: the others add nothing to a surface. Of cells that are kept whole the
 * triangles of which their faces are fans are entered, so that a quadrilateral meets the two triangles beside it.
 */
#include "reference/complex_border.h"

#include "failure.h"
#include "tables/cell_cases.h"
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

/* The points of half n of a face, of a triangle half 0; false where it is none. */
static bool half_get(const border_face *face, int n, uint32_t points[3]) {
    const uint32_t *p = face->points;
    if (n + 2 >= face->corner_count) return false;
    points[0] = p[0], points[1] = p[n + 1], points[2] = p[n + 2];
    points_sort(points);
    return points[0] != points[1] && points[1] != points[2];
}

static tc_status face_enter(face_table *t, const border_face *face) {
    for (int n = 0; n < 2; n++) {
        face_entry f = {.met = 1};
        if (!half_get(face, n, f.points)) continue;
        if (!table_grow(t)) return memory_fail();
        face_entry *entry = face_find(t, f.points);
        f.met = entry->met ? 2 : 1;
        t->count += !entry->met;
        *entry = f;
    }
    return TC_OK;
}

/* Leaves of a face what is on the border; false where that is nothing. */
static bool face_limit(const face_table *t, border_face *face) {
    const uint32_t *p = face->points;
    const border_face first = {{p[2], p[0], p[1]}, 3, true}, second = {{p[0], p[2], p[3]}, 3, true};
    bool is_border[2];
    uint32_t points[3];
    for (int n = 0; n < 2; n++) is_border[n] = half_get(face, n, points) && face_find(t, points)->met == 1;
    if (face->corner_count == 4 && is_border[0] != is_border[1]) *face = is_border[0] ? first : second;
    return is_border[0] || is_border[1];
}

static tc_status face_append(const face_table *t, border_face face, complex_border *out) {
    if (!face_limit(t, &face)) return TC_OK;
    if (out->face_count == out->capacity) {
        const uint64_t capacity = out->capacity ? 2 * out->capacity : 256;
        border_face *grown = realloc(out->faces, (size_t)capacity * sizeof *grown);
        if (!grown) return memory_fail();
        out->faces = grown, out->capacity = capacity;
    }
    out->faces[out->face_count++] = face;
    return TC_OK;
}

/* ------------------------------------------------------------------------------------------------ tetrahedra, cells */

enum { FACES_MOST = 14 }; /* two hexagons of four triangles each, six quadrilaterals */

/* A tetrahedron or a cell, with the faces that have a point inside. */
typedef struct item {
    border_face faces[FACES_MOST];
    int face_count;
    uint32_t tetrahedron_count;
} item;

/* The points that are inside, a bit each; 0 where a sample is missing. */
static unsigned pattern_of(const tc_grid *grid, const uint32_t points[], int count, double isovalue) {
    unsigned pattern = 0;
    for (int v = 0; v < count; v++) {
        const double value = grid_value_at(grid, points[v]);
        if (!isfinite(value)) return 0;
        pattern |= (unsigned)(value >= isovalue) << v;
    }
    return pattern;
}

/* Adds a face of 3 or 4 corners. */
static void face_add(item *out, const uint32_t *points, unsigned pattern, const uint8_t *corners, int count) {
    border_face face = {.corner_count = (uint8_t)count};
    unsigned inside = 0;
    for (int n = 0; n < count; n++) face.points[n] = points[corners[n]], inside |= pattern >> corners[n] & 1;
    if (inside) out->faces[out->face_count++] = face;
}

static tc_status tetrahedron_get(const tc_grid *grid, double isovalue, uint32_t n, item *out) {
    const complex_grid *c = grid->complex;
    const uint32_t *points = c->tetrahedra + 4 * (uint64_t)n;
    *out = (item){.tetrahedron_count = 1};
    for (int v = 0; v < 4; v++)
        if (points[v] >= c->point_count) return complex_point_fail(c);
    const unsigned pattern = pattern_of(grid, points, 4, isovalue);
    for (int side = 0; side < 4; side++) face_add(out, points, pattern, sides[side], 3);
    return TC_OK;
}

/* The cell of tetrahedron n. */
static tc_status cell_get(const tc_grid *grid, double isovalue, uint32_t n, item *out) {
    whole_cell cell;
    cell_frame frame;
    *out = (item){.tetrahedron_count = 0};
    tc_status status = complex_cell_get(grid->complex, n, &cell);
    if (status) return status;
    out->tetrahedron_count = cell.tetrahedron_count;
    const unsigned pattern = pattern_of(grid, cell.corners, cell.corner_count, isovalue);
    cell_frame_begin(cell.shape, cell.corners, cell.mirrored, &frame);
    for (int f = 0; f < frame.face_count; f++) {
        const cell_face *face = &frame.faces[f];
        const uint8_t *corners = face->corners;
        if (face->corner_count <= 4) face_add(out, cell.corners, pattern, corners, face->corner_count);
        for (int m = 1; m + 1 < face->corner_count && face->corner_count > 4; m++)
            face_add(out, cell.corners, pattern, (uint8_t[3]){corners[0], corners[m], corners[m + 1]}, 3);
    }
    return TC_OK;
}

/* Enters all faces that have a point inside, or appends those of them that are the border's. Halves without such a
 * point do no harm: of them nothing is cut off. */
static tc_status faces_visit(const tc_grid *grid, double isovalue, bool keeps_cells, face_table *t,
                             complex_border *out) {
    item i;
    tc_status status = TC_OK;
    for (uint32_t n = 0; n < grid->complex->tetrahedron_count && !status; n += i.tetrahedron_count) {
        status = keeps_cells ? cell_get(grid, isovalue, n, &i) : tetrahedron_get(grid, isovalue, n, &i);
        for (int f = 0; f < i.face_count && !status; f++)
            status = out ? face_append(t, i.faces[f], out) : face_enter(t, &i.faces[f]);
    }
    return status;
}

tc_status complex_border_find(const tc_grid *grid, double isovalue, bool keeps_cells, complex_border *out) {
    face_table table = {0};
    *out = (complex_border){0};
    tc_status status = table_grow(&table) ? TC_OK : memory_fail();
    if (!status) status = faces_visit(grid, isovalue, keeps_cells, &table, NULL);
    if (!status) status = faces_visit(grid, isovalue, keeps_cells, &table, out);
    free(table.entries);
    return status;
}

void complex_border_release(complex_border *border) {
    free(border->faces);
    *border = (complex_border){0};
}

/* ----------------------------------------------------------------------------------------------------- inside parts */

/* The part of a polygon that is inside, fanned around its point `apex`, which is. Returns the number of triangles. */
static int polygon_cut(const uint32_t *points, int count, unsigned inside, int apex, border_vertex triangles[][3]) {
    border_vertex polygon[5];
    int found = 0;
    for (int n = apex; n < apex + count; n++) {
        const int a = n % count, b = (n + 1) % count;
        if (inside >> a & 1) polygon[found++] = (border_vertex){points[a], points[a]};
        if ((inside >> a & 1) != (inside >> b & 1)) polygon[found++] = (border_vertex){points[a], points[b]};
    }
    for (int n = 0; n + 2 < found; n++) {
        triangles[n][0] = polygon[0];
        triangles[n][1] = polygon[n + 1];
        triangles[n][2] = polygon[n + 2];
    }
    return found - 2;
}

/* Around the inside point that another one follows, else the only one. */
static int triangle_cut(const uint32_t points[3], unsigned inside, border_vertex triangles[][3]) {
    int apex = 3;
    for (int n = 0; n < 3; n++)
        if ((inside >> n & 1) && (apex == 3 || (inside >> (n + 1) % 3 & 1))) apex = n;
    return apex == 3 ? 0 : polygon_cut(points, 3, inside, apex, triangles);
}

int border_face_cut(const border_face *face, unsigned inside, bool has_diagonal,
                    border_vertex triangles[BORDER_TRIANGLES_MAX][3]) {
    const uint32_t *p = face->points, second[3] = {p[0], p[2], p[3]};
    if (face->corner_count == 3) return triangle_cut(p, inside, triangles);
    if (!has_diagonal) return polygon_cut(p, 4, inside, inside & 1 ? 0 : 2, triangles); /* its end that is inside */
    const int count = triangle_cut(p, inside, triangles);
    return count + triangle_cut(second, (inside & 1) | (inside >> 2 & 3) << 1, triangles + count);
}
