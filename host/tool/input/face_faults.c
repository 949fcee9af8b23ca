#include "face_faults.h"

#include "counted.h"
#include "exit_status.h"
#include "failure.h"
#include "sample_types.h"
#include "terminal/notice.h"

#include <math.h>
#include <stdlib.h>

/* A point_side for every point, from malloc; NULL where memory runs out. */
static uint8_t *point_sides(const prepared_block *b, double isovalue) {
    const uint64_t count = (uint64_t)b->source->point_count;
    uint8_t *sides = malloc((size_t)count + 1);
    for (uint64_t n = 0; sides && n < count; n++) {
        double value = value_at(b->scalar->type, b->scalar->samples, n);
        sides[n] = !isfinite(value) ? SIDE_MISSING : value >= isovalue ? SIDE_INSIDE : SIDE_OUTSIDE;
    }
    return sides;
}

static int check_block(const prepared_block *b, const double *isovalue, complex_faces *faces) {
    uint8_t *sides = NULL;
    if (isovalue && !(sides = point_sides(b, *isovalue)))
        return fail(STATUS_FAILED, "no memory to check the faces of a grid of %lld points",
                    (long long)b->source->point_count);
    int status = complex_check((uint64_t)b->source->point_count, b->complex.tetrahedra, b->complex.tetrahedron_count,
                               sides, faces);
    free(sides);
    return status;
}

int face_faults_find(const block_list *list, const double *isovalue, complex_faces *sum) {
    *sum = (complex_faces){0};
    for (int n = 0; n < list->count; n++) {
        const prepared_block *b = &list->blocks[n];
        complex_faces faces = {0};
        if (b->source->kind != BLOCK_UNSTRUCTURED) continue;
        int status = check_block(b, isovalue, &faces);
        if (status) return status;
        sum->folded_faces += faces.folded_faces;
        sum->nonmanifold_faces += faces.nonmanifold_faces;
        sum->invalid_tetrahedra += faces.invalid_tetrahedra;
    }
    return 0;
}

void face_faults_tell(const complex_faces *faces) {
    if (faces->folded_faces)
        notice("%s folded: both cells lie on the same side; a surface there is not oriented",
               counted(faces->folded_faces, "face is", "faces are").text);
    if (faces->nonmanifold_faces)
        notice("%s three cells or more; a surface there is not a manifold",
               counted(faces->nonmanifold_faces, "face has", "faces have").text);
}
