/*
 * cut.h - cells cut into tetrahedra by the library, and what must hold of them
 */
#ifndef CUT_H
#define CUT_H

#include "complex.h"
#include "expect.h"

/* To be released. */
static inline tc_tetrahedra cut(const tc_cells *cells, const char *what) {
    tc_tetrahedra complex = {.struct_size = sizeof complex};
    tc_status status = tc_tetrahedralize(cells, &complex);
    EXPECT(status == TC_OK, "%s: status %d: %s", what, (int)status, tc_message());
    return complex;
}

/* Tetrahedra that meet agree on the face between them, boundary_faces faces have one alone, and together they fill the
 * volume. volume: six times it. */
static inline void expect_conforming(const tc_tetrahedra *complex, const tc_cells *cells, uint64_t boundary_faces,
                                     double volume, const char *what) {
    complex_facts f = complex_facts_of(complex, cells->points, cells->point_count);
    EXPECT(!f.bad_tetrahedra && !f.bad_faces && !f.not_positive,
           "%s: %llu bad tetrahedra, %llu not positive, %llu bad faces", what, (unsigned long long)f.bad_tetrahedra,
           (unsigned long long)f.not_positive, (unsigned long long)f.bad_faces);
    EXPECT(f.boundary_faces == boundary_faces, "%s: %llu faces at the boundary, not %llu", what,
           (unsigned long long)f.boundary_faces, (unsigned long long)boundary_faces);
    EXPECT(f.volume == volume, "%s: volume %g, not %g", what, f.volume, volume);
}

#endif
