/* surface_simplify.h - --simplify: fewer triangles, the result checked and its distance measured */
#ifndef SURFACE_SIMPLIFY_H
#define SURFACE_SIMPLIFY_H

#include "result_mesh.h"

/* Before any work: STATUS_USAGE where --simplify is given and the program was built without meshoptimizer. */
int surface_simplify_check_usage(const options *o);

/*
 * Simplifies what each block gave to the mesh (mesh_simplify.h), after its triangles of zero area were dropped. Then
 * the result is checked by code that knows nothing of that (host/check): it has to have the border, the Euler
 * characteristic and the components that it had, and no more faults or folded edges. *good is set to 0 where it has
 * not, with a message. Adds to s what was done, and how far the surfaces are apart. Returns 0 or a status.
 */
int surface_simplify(const options *o, result_mesh *mesh, surface_report *s, int *good);

/* A notice where much more is left than was asked for. */
void surface_simplify_tell(const options *o, const surface_report *s);

#endif
