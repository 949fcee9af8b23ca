/*
 * oracle.h - what a surface must count to, from the signs of the samples alone
 *
 * Independent of any case table: one vertex per tetrahedron edge whose ends differ, one polygon per tetrahedron whose
 * corners differ (a quadrilateral counts as two triangles), one polygon side per tetrahedron face whose corners differ.
 * The Euler characteristic is vertices - sides + polygons; a side in a face that only one tetrahedron has is a boundary
 * edge. A cube with a missing corner has no tetrahedra.
 */
#ifndef ORACLE_H
#define ORACLE_H

#include <stdint.h>

typedef struct oracle_counts {
    uint64_t vertices, triangles, active_cells, boundary_edges;
    int64_t euler_characteristic;
} oracle_counts;

/* A byte per sample, x fastest; present may be NULL: all are. parity: of i + j + k at the first sample. Exits where
 * memory runs out. */
void oracle_count(const int64_t dims[3], unsigned parity, const uint8_t *inside, const uint8_t *present,
                  oracle_counts *counts);

#endif
