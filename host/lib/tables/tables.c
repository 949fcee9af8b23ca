#include "tables/tables.h"

const uint8_t tetrahedron_corners[2][TETRAHEDRA_PER_CUBE][4] = {
    {{0, 5, 3, 6}, {1, 0, 5, 3}, {2, 0, 3, 6}, {4, 0, 6, 5}, {7, 3, 5, 6}},
    {{1, 2, 4, 7}, {0, 4, 1, 2}, {3, 2, 1, 7}, {5, 7, 1, 4}, {6, 4, 2, 7}},
};

const uint8_t tetrahedron_edges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

const tetrahedron_case tetrahedron_cases[16] = {
    {0, {{0, 0, 0}, {0, 0, 0}}}, /* none inside */
    {1, {{0, 1, 2}, {0, 0, 0}}}, /* v0 */
    {1, {{0, 4, 3}, {0, 0, 0}}}, /* v1 */
    {2, {{1, 2, 4}, {1, 4, 3}}}, /* v0 v1 */
    {1, {{5, 1, 3}, {0, 0, 0}}}, /* v2 */
    {2, {{2, 0, 3}, {2, 3, 5}}}, /* v0 v2 */
    {2, {{0, 4, 5}, {0, 5, 1}}}, /* v1 v2 */
    {1, {{5, 2, 4}, {0, 0, 0}}}, /* all but v3 */
    {1, {{5, 4, 2}, {0, 0, 0}}}, /* v3 */
    {2, {{0, 1, 5}, {0, 5, 4}}}, /* v0 v3 */
    {2, {{2, 5, 3}, {2, 3, 0}}}, /* v1 v3 */
    {1, {{5, 3, 1}, {0, 0, 0}}}, /* all but v2 */
    {2, {{1, 3, 4}, {1, 4, 2}}}, /* v2 v3 */
    {1, {{0, 3, 4}, {0, 0, 0}}}, /* all but v1 */
    {1, {{0, 2, 1}, {0, 0, 0}}}, /* all but v0 */
    {0, {{0, 0, 0}, {0, 0, 0}}}, /* all inside */
};

const owned_vertex cube_edges[CUBE_EDGES] = {
    {0, 0, 0, EDGE_X},  {0, 0, 0, EDGE_Y}, {0, 0, 0, EDGE_Z},  {0, 0, 0, EDGE_XY}, {0, 0, 0, EDGE_XZ},
    {0, 0, 0, EDGE_YZ}, {0, 1, 0, EDGE_X}, {0, 1, 0, EDGE_Z},  {0, 1, 0, EDGE_XZ}, /* row y + 1 */
    {0, 0, 1, EDGE_X},  {0, 0, 1, EDGE_Y}, {0, 0, 1, EDGE_XY},                     /* row z + 1 */
    {0, 1, 1, EDGE_X},                                                             /* row y + 1, z + 1 */
    {1, 0, 0, EDGE_Y},  {1, 0, 0, EDGE_Z}, {1, 0, 0, EDGE_YZ}, {1, 1, 0, EDGE_Z},  {1, 0, 1, EDGE_Y}, /* at x + 1 */
};

owned_vertex edge_between(unsigned corner_a, unsigned corner_b) {
    static const uint8_t type_of_axes[8] = {
        [1] = EDGE_X, [2] = EDGE_Y, [4] = EDGE_Z, [3] = EDGE_XY, [5] = EDGE_XZ, [6] = EDGE_YZ};
    unsigned low = corner_a & corner_b;
    return (owned_vertex){low & 1, low >> 1 & 1, (uint8_t)(low >> 2), type_of_axes[corner_a ^ corner_b]};
}

uint8_t cube_edge_index(unsigned corner_a, unsigned corner_b) {
    const owned_vertex e = edge_between(corner_a, corner_b);
    uint8_t n = 0;
    while (cube_edges[n].dx != e.dx || cube_edges[n].dy != e.dy || cube_edges[n].dz != e.dz ||
           cube_edges[n].type != e.type)
        n++;
    return n;
}

owned_vertex cube_vertex(unsigned index) {
    if (index < CUBE_EDGES) return cube_edges[index];
    const unsigned corner = (index - CUBE_EDGES) & 7;
    return (owned_vertex){corner & 1, corner >> 1 & 1, (uint8_t)(corner >> 2), VERTEX_SAMPLE};
}

/* On an edge whose ends differ; one that ends in a corner of `zeros` has its vertex there. */
static uint8_t vertex_between(unsigned zeros, unsigned corner_a, unsigned corner_b) {
    if (zeros >> corner_a & 1) return (uint8_t)(CUBE_EDGES + corner_a);
    if (zeros >> corner_b & 1) return (uint8_t)(CUBE_EDGES + corner_b);
    return cube_edge_index(corner_a, corner_b);
}

/* inside, zeros: corners as bits; zeros are vertices themselves, and count as outside. Triangles of which two vertices
 * fall together are left out. */
static void cube_case_derive(cube_case *out, unsigned parity, unsigned inside, unsigned zeros, int mirrored) {
    *out = (cube_case){0};
    for (unsigned t = 0; t < TETRAHEDRA_PER_CUBE; t++) {
        const uint8_t *corners = tetrahedron_corners[parity][t];
        unsigned index = 0;
        for (unsigned v = 0; v < 4; v++) index |= (inside >> corners[v] & 1) << v;
        const tetrahedron_case *c = &tetrahedron_cases[index];
        for (unsigned n = 0; n < c->triangle_count; n++) {
            uint8_t *edges = out->vertices[out->triangle_count];
            for (unsigned m = 0; m < 3; m++) {
                const uint8_t *ends = tetrahedron_edges[c->triangles[n][mirrored ? (3 - m) % 3 : m]];
                edges[m] = vertex_between(zeros, corners[ends[0]], corners[ends[1]]);
            }
            if (edges[0] != edges[1] && edges[1] != edges[2] && edges[2] != edges[0]) out->triangle_count++;
        }
    }
}

void tetra_cases_derive(cube_case *cases, int mirrored) {
    for (unsigned n = 0; n < 2 * CASES_TWO_SIGNS; n++)
        cube_case_derive(&cases[n], n / CASES_TWO_SIGNS, n % CASES_TWO_SIGNS, 0, mirrored);
}

uint16_t bits_as_digits(unsigned bits) {
    unsigned digits = 0;
    for (int c = 7; c >= 0; c--) digits = 3 * digits + (bits >> c & 1);
    return (uint16_t)digits;
}

void snap_cases_derive(cube_case *cases, int mirrored) {
    for (unsigned n = 0; n < 2 * CASES_THREE_SIGNS; n++) {
        unsigned inside = 0, zeros = 0, digits = n % CASES_THREE_SIGNS;
        for (unsigned c = 0; c < 8; c++, digits /= 3) inside |= (digits % 3 / 2) << c, zeros |= (digits % 3 & 1) << c;
        cube_case_derive(&cases[n], n / CASES_THREE_SIGNS, inside, zeros, mirrored);
    }
}
