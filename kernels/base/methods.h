/*
 * methods.h - the methods of structured grids, a row each: read by both compilers
 */
#ifndef METHODS_H
#define METHODS_H

/* METHOD(name, types, most, usual)
 *
 * name: as the public header numbers methods, from 0 on; kernels are built with -DMETHOD=name
 * types: how many types of vertices it has, the first of these: on an edge x, y, z, xy, xz, yz; at a sample. Closed
 *        surfaces have the last one, too
 * most: triangles of a cube at the most; no more than 10, which fill CUBE_CASE_BYTES
 * usual: triangles that are copied for every cube, without a branch; others only where a cube has more
 *
 * A method also has the table name_cases_derive (declared in host/lib/tables/tables.h), which fills cubes with
 * triangles, and the function name_triangles (tetrahedra.cl), which counts them. Where samples can be vertices they
 * have a third sign, 0, and a cube has more cases (CASE_COUNT in slab.h). */
#define METHODS(METHOD)                                                                                                \
    METHOD(tetra, 6, 10, 5)                                                                                            \
    METHOD(hybrid, 3, 6, 3)                                                                                            \
    METHOD(snap, 7, 10, 3)

#define METHOD_NUMBER(name, types, most, usual) method_##name,
enum { METHODS(METHOD_NUMBER) METHOD_COUNT };

#endif
