/*
 * simplify_fault.c - a library that simplifies badly: preloaded into the tool, it damages all that meshoptimizer makes
 *
 * Method: stands before meshopt_simplify (LD_PRELOAD) and changes its triangles, as SIMPLIFY_FAULT says: "hole" leaves
 * the last one out; "double" writes the first one once more in place of the last; "turn" swaps corners of the last;
 * "pinch" makes two vertices far from each other one; "split" turns the diagonal between two triangles, whatever then
 * lies on each other; "half" leaves out every second one; "all" leaves none. "once" as "hole", in the first call alone.
 */
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

typedef size_t simplify(unsigned *, const unsigned *, size_t, const float *, size_t, size_t, size_t, float, unsigned,
                        float *);

static void pinch(unsigned *indices, size_t count) {
    const unsigned here = indices[0], there = indices[count / 6 * 3];
    for (size_t n = 0; n < count; n++)
        if (indices[n] == there) indices[n] = here;
}

static size_t halve(unsigned *indices, size_t count) {
    size_t left = 0;
    for (size_t n = 0; n + 3 <= count; n += 6, left += 3) memmove(indices + left, indices + n, 3 * sizeof *indices);
    return left;
}

/* Turns the diagonal of the first pair of triangles that share an edge, behind the middle. */
static void split(unsigned *t, size_t count) {
    for (size_t a = count / 6 * 3; a + 3 <= count; a += 3)
        for (size_t b = 0; b < a; b += 3)
            for (size_t e = 0; e < 9; e++) {
                const size_t i = e % 3, k = e / 3;
                if (t[a + i] != t[b + (k + 1) % 3] || t[a + (i + 1) % 3] != t[b + k]) continue;
                const unsigned far = t[a + (i + 2) % 3], near = t[b + (k + 2) % 3];
                t[a + (i + 1) % 3] = near;
                t[b + (k + 1) % 3] = far;
                return;
            }
}

__attribute__((visibility("default"))) size_t meshopt_simplify(unsigned *out, const unsigned *indices, size_t count,
                                                               const float *positions, size_t vertex_count,
                                                               size_t stride, size_t goal, float error,
                                                               unsigned options, float *result_error);

size_t meshopt_simplify(unsigned *out, const unsigned *indices, size_t count, const float *positions,
                        size_t vertex_count, size_t stride, size_t goal, float error, unsigned options,
                        float *result_error) {
    static int calls;
    const char *fault = getenv("SIMPLIFY_FAULT");
    simplify *real = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, "meshopt_simplify");
    const size_t left = real(out, indices, count, positions, vertex_count, stride, goal, error, options, result_error);
    const int is_first = calls++ == 0;
    if (!fault || left < 6) return left;
    if (!strcmp(fault, "hole") || (is_first && !strcmp(fault, "once"))) return left - 3;
    if (!strcmp(fault, "double")) memcpy(out + left - 3, out, 3 * sizeof *out);
    if (!strcmp(fault, "turn")) memcpy(out + left - 3, (unsigned[2]){out[left - 2], out[left - 3]}, 2 * sizeof *out);
    if (!strcmp(fault, "pinch")) pinch(out, left);
    if (!strcmp(fault, "split")) split(out, left);
    if (!strcmp(fault, "half")) return halve(out, left);
    return strcmp(fault, "all") ? left : 0;
}
