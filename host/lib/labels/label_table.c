/* label_table.c - the tables of label_tables.h as kernel 2 reads them */
#include "tables/label_tables.h"
#include "kernels/labels/label_job.h"
#include "labels/label_run.h"

#include <string.h>

_Static_assert((int)LABEL_ROW_TYPES == (int)LABEL_TYPES, "kernels count them so");
_Static_assert((int)LABEL_SHARED_TYPES == (int)LABEL_TYPE_INNER, "kernels share them so");

/* The word of a row that has the vertex, and whether it is the next sample's along x. */
static uint32_t vertex_word(owned_vertex v) {
    const uint32_t first = v.dy && v.dz ? LABEL_WORD_YZ1 : v.dy ? LABEL_WORD_Y1 : v.dz ? LABEL_WORD_Z1 : 0;
    return LABEL_VERTEX(first + v.type, (uint32_t)v.dx);
}

/* The slot of an edge of a cube: that of the same edge at the cube's own x, or so many more. */
static uint8_t edge_slot(unsigned edge) {
    const owned_vertex *e = &cube_edges[edge];
    unsigned same = 0;
    while (cube_edges[same].dy != e->dy || cube_edges[same].dz != e->dz || cube_edges[same].type != e->type) same++;
    return (uint8_t)(same + (e->dx ? LABEL_SLOT_NEXT : 0));
}

static uint32_t interface_word(const label_interface *i) {
    uint32_t vertices = 0;
    for (unsigned n = 0; n < 4; n++) vertices |= (uint32_t)i->vertices[n] << 4 * n;
    return LABEL_INTERFACE(vertices, (uint32_t)i->inner, (uint32_t)i->outer, i->vertex_count - 2u);
}

/* Cubes with two labels are those of an isovalue between them. */
static void cubes_make(bool mirrored, uint32_t *words) {
    cube_case cases[2 * CASES_TWO_SIGNS];
    _Static_assert(sizeof(cube_case) == LABEL_CASE_WORDS * sizeof(uint32_t), "kernels read it so");
    tetra_cases_derive(cases, mirrored);
    for (unsigned n = 0; n < 2 * CASES_TWO_SIGNS; n++) {
        cube_case *c = &cases[n];
        for (unsigned at = 0; at < 3u * c->triangle_count; at++)
            c->vertices[at / 3][at % 3] = edge_slot(c->vertices[at / 3][at % 3]);
    }
    memcpy(words, cases, sizeof cases);
}

void label_table_make(bool mirrored, uint32_t *words) {
    label_tables tables;
    label_tables_derive(&tables);
    memset(words, 0, LABEL_TABLE_WORDS * sizeof *words);
    for (unsigned pattern = 0; pattern < LABEL_PATTERNS; pattern++) {
        const label_case *c = &tables.cases[pattern];
        words[LABEL_CASE_WORDS * pattern] = c->interface_count;
        for (unsigned n = 0; n < c->interface_count; n++)
            words[LABEL_CASE_WORDS * pattern + 1 + n] = interface_word(&c->interfaces[n]);
    }
    for (unsigned n = 0; n < 2 * TETRAHEDRA_PER_CUBE; n++) {
        const unsigned parity = n / TETRAHEDRA_PER_CUBE, t = n % TETRAHEDRA_PER_CUBE;
        uint32_t *map = words + LABEL_MAPS + n * LABEL_MAP_WORDS;
        for (unsigned v = 0; v < LABEL_VERTICES; v++) map[v] = vertex_word(tables.owners[parity][t][v]);
        for (unsigned c = 0; c < 4; c++) map[LABEL_MAP_CORNERS] |= (uint32_t)tetrahedron_corners[parity][t][c] << 4 * c;
    }
    memcpy(words + LABEL_POSITIONS, tables.offsets, sizeof tables.offsets);
    cubes_make(mirrored, words + LABEL_CUBES);
}
