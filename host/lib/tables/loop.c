/* loop.c - the triangulation of least cost, by dynamic programming (Gilbert 1979, Klincsek 1980); see loop.h */
#include "tables/loop.h"

#include <string.h>

typedef struct disk {
    const uint8_t *edges;
    uint8_t apex[LOOP_MOST][LOOP_MOST];
    uint8_t (*triangles)[3];
    unsigned triangle_count;
} disk;

/* The triangles between corners first and last of the loop, behind the side or chord that joins these. */
static void part_store(disk *d, int first, int last) {
    if (last - first < 2) return;
    const int corner = d->apex[first][last];
    const uint8_t triangle[3] = {d->edges[first], d->edges[corner], d->edges[last]};
    memcpy(d->triangles[d->triangle_count++], triangle, sizeof triangle);
    part_store(d, first, corner);
    part_store(d, corner, last);
}

/* Finds, for ever longer parts of the loop, the corner that makes the triangle at the chord which cuts the part off. */
unsigned loop_triangulate(const uint8_t *edges, int count, chord_cost *cost, const void *context,
                          uint8_t triangles[][3]) {
    int32_t costs[LOOP_MOST][LOOP_MOST] = {{0}};
    disk d = {.edges = edges, .triangles = triangles};
    for (int length = 2; length < count; length++)
        for (int first = 0; first + length < count; first++) {
            const int last = first + length;
            int32_t least = 0;
            for (int corner = first + 1; corner < last; corner++) {
                const int32_t sum = costs[first][corner] + costs[corner][last];
                if (corner > first + 1 && sum >= least) continue;
                least = sum;
                d.apex[first][last] = (uint8_t)corner;
            }
            costs[first][last] = least + cost(context, edges[first], edges[last]);
        }
    part_store(&d, 0, count - 1);
    return d.triangle_count;
}
