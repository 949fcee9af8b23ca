#include "pieces.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct side {
    uint32_t low, high, corner;
    bool forward;
} side;

static int side_order(const void *a, const void *b) {
    const side *p = a, *q = b;
    if (p->low != q->low) return p->low < q->low ? -1 : 1;
    return p->high < q->high ? -1 : p->high > q->high;
}

static int piece_order(const void *a, const void *b) {
    const piece *p = a, *q = b;
    if (p->euler != q->euler) return p->euler < q->euler ? -1 : 1;
    return p->borders < q->borders ? -1 : p->borders > q->borders;
}

static uint32_t root(uint32_t *parents, uint32_t n) {
    while (parents[n] != n) n = parents[n] = parents[parents[n]];
    return n;
}

static void join(uint32_t *parents, uint32_t a, uint32_t b) { parents[root(parents, a)] = root(parents, b); }

static uint32_t corner_next(uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

/* Corners of triangles are joined three times: around a vertex (fans), along borders, and in pieces. */
typedef struct joined {
    uint32_t *fans, *borders, *pieces;
} joined;

/* The triangles at an edge: sides[0] to sides[count - 1]. */
static void edge_join(const side *sides, size_t count, joined *j, pieces *p) {
    if (count > 2) p->fault = "an edge has more than two triangles";
    if (count == 2 && sides[0].forward == sides[1].forward) p->fault = "two triangles pass an edge in one direction";
    if (count != 2 || p->fault) return;
    const uint32_t a = sides[0].corner, b = sides[1].corner;
    join(j->fans, a, corner_next(b));
    join(j->fans, corner_next(a), b);
    join(j->pieces, a, b);
}

/* Vertices, edges and triangles of each piece are summed at its root. */
static void pieces_sum(const side *sides, size_t count, joined *j, pieces *p) {
    int64_t *euler = memory_get(count, sizeof *euler), *borders = memory_get(count, sizeof *borders);
    for (size_t n = 0, end; n < count; n = end) {
        const uint32_t from = sides[n].corner;
        for (end = n + 1; end < count && !side_order(&sides[n], &sides[end]);) end++;
        euler[root(j->pieces, from)]--;
        if (end - n > 1) continue;
        p->sides[p->side_count][0] = sides[n].low, p->sides[p->side_count++][1] = sides[n].high;
        join(j->borders, root(j->fans, from), root(j->fans, corner_next(from)));
        borders[root(j->pieces, from)]++; /* a side; below, each fan that one joins takes one back */
    }
    for (uint32_t n = 0; n < count; n++) {
        euler[root(j->pieces, n)] += (n % 3 == 0) + (j->fans[n] == n);
        p->pinches += j->fans[n] == n;
        /* each side joins two fans, so a border has as many of either: what is left are the fans that were not joined
         */
        if (j->fans[n] == n && j->borders[n] != n) borders[root(j->pieces, n)]--;
    }
    for (uint32_t n = 0; n < count; n++)
        if (j->pieces[n] == n) p->list[p->count++] = (piece){euler[n], borders[n]};
    qsort(p->list, p->count, sizeof *p->list, piece_order);
    free(euler);
    free(borders);
}

pieces pieces_of(const tc_mesh_data *mesh) {
    const size_t count = 3 * (size_t)mesh->triangle_count;
    pieces p = {.list = memory_get(count, sizeof *p.list), .sides = memory_get(count, sizeof *p.sides)};
    side *sides = memory_get(count, sizeof *sides);
    uint8_t *used = memory_get(mesh->vertex_count, 1);
    joined j = {memory_get(count, 4), memory_get(count, 4), memory_get(count, 4)};
    for (uint32_t n = 0; n < count; n++) {
        const uint32_t from = mesh->triangles[n], to = mesh->triangles[corner_next(n)];
        if (from >= mesh->vertex_count || from == to) p.fault = "a triangle names no vertex, or one twice";
        if (from < mesh->vertex_count) used[from] = 1;
        sides[n] = (side){from < to ? from : to, from < to ? to : from, n, from < to};
        j.fans[n] = j.borders[n] = n;
        j.pieces[n] = n - n % 3;
    }
    for (uint64_t n = 0; n < mesh->vertex_count; n++)
        if (!used[n]) p.fault = "a vertex has no triangle";
    qsort(sides, count, sizeof *sides, side_order);
    for (size_t n = 0, end; n < count && !p.fault; n = end) {
        for (end = n + 1; end < count && !side_order(&sides[n], &sides[end]);) end++;
        edge_join(&sides[n], end - n, &j, &p);
    }
    if (!p.fault) pieces_sum(sides, count, &j, &p);
    p.pinches -= p.fault ? 0 : mesh->vertex_count;
    free(sides);
    free(used);
    free(j.fans);
    free(j.borders);
    free(j.pieces);
    return p;
}

void pieces_free(pieces *p) {
    free(p->list);
    free(p->sides);
}

const char *pieces_differ(const pieces *tetra, const pieces *snap) {
    if (tetra->fault || snap->fault) return tetra->fault ? tetra->fault : snap->fault;
    if (tetra->count != snap->count) return "pieces differ in number";
    if (tetra->pinches != snap->pinches) return "fans at vertices differ in number";
    for (uint32_t n = 0; n < tetra->count; n++) {
        if (tetra->list[n].euler != snap->list[n].euler) return "Euler characteristics of pieces differ";
        if (tetra->list[n].borders != snap->list[n].borders) return "borders of pieces differ in number";
    }
    return NULL;
}
