/*
 * methods.h - the methods of structured grids, a row each: read by both compilers
 */
#ifndef METHODS_H
#define METHODS_H

/* METHOD(name, types, most, usual)
 *
 * name: as the public header numbers methods, from 0 on; kernels are built with -DMETHOD=name
 * types: types of edges that have vertices, the first so many of x, y, z, xy, xz, yz
 * most: triangles of a cube at the most; no more than 10, which fill CUBE_CASE_BYTES
 * usual: triangles that are copied without a branch; more only where a cube has more
 *
 * A method also has the table name_cases_derive (declared in host/lib/grid/tables.h), which fills cubes with triangles,
 * and the function name_triangles (tetrahedra.cl), which counts them. */
#define METHODS(METHOD)                                                                                                \
    METHOD(tetra, 6, 10, 5)                                                                                            \
    METHOD(hybrid, 3, 6, 3)

#define METHOD_NUMBER(name, types, most, usual) method_##name,
enum { METHODS(METHOD_NUMBER) METHOD_COUNT };

#endif
