/*
 * reduced_alone.cl - regular points within the grid, for a work-item alone: links are reduced to their samples along
 * the axes
 *
 * The test asks whether the samples + of a link are connected, and the samples -. If the ring around a sample n of the
 * link changes between + and - exactly twice, n may take the other sign: the link keeps its number of components of +
 * and of -, for the reason that a regular sample may be snapped. So the samples across faces take the signs of their
 * neighbours along the axes, and only those six are left to look at.
 *
 * The six samples along the axes of an even link are odd: + or -, and no vertices yet. Each of the twelve others, n,
 * lies between two of them, p and q, and has this ring:
 *
 *       x1--x2
 *      / \ / \
 *     p---n---q
 *      \ / \ /
 *       x4--x3
 *
 * 1. Where n is a vertex, its ring has to change twice. From here on n counts as + or -, as p does.
 * 2. Where n differs from both p and q, look at the two sides of the ring, x1 with x2 and x3 with x4. If one side has a
 *    sample with the sign of n, n takes the sign of p. If none has, n is a component by itself, and is left out. If
 *    both have, the link is left to regular_alone.cl; smooth surfaces have no such links.
 * 3. Now no n connects or separates anything, and the samples along the axes are an octahedron. Where the two on one
 *    axis differ, + and - are connected. Where all six agree, exactly one n must have been left out. Otherwise two that
 *    have the same sign on an axis are not connected.
 *
 * An odd link is such an octahedron. Where two on an axis differ, the rings of vertices on the other axes change twice.
 */
#ifndef REDUCED_ALONE_CL
#define REDUCED_ALONE_CL

#include "link_alone.cl"

/* A sample across a face, and its ring. */
typedef struct link_ring {
    uint p, q, x1, x2, x3, x4;
} link_ring;

inline_always link_ring ring_of(uint n) {
    const uint face = (n - LINK_ODD) / 4, up_a = (n - LINK_ODD) % 2, up_b = (n - LINK_ODD) / 2 % 2;
    const uint a = face == 2, b = face == 0 ? 1 : 2, c = 3 - a - b;
    link_ring r = {LINK_AXIS(a, up_a),         LINK_AXIS(b, up_b),         link_across(a, up_a, c, 1),
                   link_across(b, up_b, c, 1), link_across(b, up_b, c, 0), link_across(a, up_a, c, 0)};
    return r;
}

/* Where sample n of a link is +, for bits set in `side`, or -, for the others. */
inline_always lanes as_side(const link_signs *l, uint n, lanes side) { return choose(side, l->plus[n], l->minus[n]); }

/* Whether the ring of a vertex changes between + and - twice, with vertices between them. Where p and q differ it
 * changes once on either side; where they agree, never on one side and twice on the other. */
inline_always lanes vertex_ring_regular(const link_signs *l, link_ring r) {
    const lanes p = l->plus[r.p], q = l->plus[r.q];
    const lanes x1 = as_side(l, r.x1, p), x2 = as_side(l, r.x2, q), x3 = as_side(l, r.x3, q), x4 = as_side(l, r.x4, p);
    const lanes twice12 = as_side(l, r.x1, ~p) | as_side(l, r.x2, ~q);
    const lanes twice34 = as_side(l, r.x4, ~p) | as_side(l, r.x3, ~q);
    return choose(p ^ q, (x1 | x2) & (x3 | x4), (x1 & x2 & twice34) | (x3 & x4 & twice12));
}

/* Samples in whose link some axis has + at one end and - at the other. */
inline_always lanes axes_differ(const link_signs *l) {
    lanes differ = 0;
#pragma unroll
    for (uint n = 0; n < LINK_ODD; n += 2) differ |= (l->plus[n] & l->minus[n + 1]) | (l->minus[n] & l->plus[n + 1]);
    return differ;
}

inline_always lanes vertices_wrong(const link_signs *l) {
    lanes wrong = 0;
#pragma unroll
    for (uint face = LINK_ODD; face < LINK_EVEN; face += 4) {
        if (!lanes_any(l->zero[face] | l->zero[face + 1] | l->zero[face + 2] | l->zero[face + 3])) continue;
#pragma unroll
        for (uint n = face; n < face + 4; n++) wrong |= l->zero[n] & ~vertex_ring_regular(l, ring_of(n));
    }
    return wrong;
}

/* Samples of an even link whose signs are reduced. */
typedef struct reduction {
    lanes plus[LINK_EVEN];
    lanes apart, more; /* a sample was a part by itself; several were */
    lanes open;        /* it is left to regular_alone.cl */
} reduction;

inline_always void sample_reduce(reduction *l, uint n) {
    const link_ring r = ring_of(n);
    const lanes p = l->plus[r.p], differs = (l->plus[n] ^ p) & ~(p ^ l->plus[r.q]);
    const lanes one = differs & ((l->plus[r.x1] ^ p) | (l->plus[r.x2] ^ p));
    const lanes other = differs & ((l->plus[r.x3] ^ p) | (l->plus[r.x4] ^ p));
    const lanes apart = differs & ~(one | other), both = one & other;
    l->more |= l->apart & apart, l->apart |= apart, l->open |= both;
    l->plus[n] ^= differs & ~both;
}

/* Which samples within the grid are regular points; *open: of these it is not known. */
inline_always lanes points_reduced(const link_signs *l, bool odd, lanes *open) {
    const lanes differ = axes_differ(l);
    reduction r = {{0}, 0, 0, 0};
    lanes all = ~(lanes)0, none = ~(lanes)0;
    *open = 0;
    if (odd) return differ;
#pragma unroll
    for (uint n = 0; n < LINK_EVEN; n++) r.plus[n] = l->plus[n];
#pragma unroll
    for (uint n = 0; n < LINK_ODD; n++) all &= l->plus[n], none &= ~l->plus[n];
#pragma unroll
    for (uint n = LINK_ODD; n < LINK_EVEN; n++) r.plus[n] |= l->zero[n] & l->plus[ring_of(n).p];
#pragma unroll
    for (uint n = LINK_ODD; n < LINK_EVEN; n++) sample_reduce(&r, n);
    const lanes right = ~vertices_wrong(l);
    *open = r.open & right;
    return right & ~r.open & ((differ & ~r.apart) | ((all | none) & r.apart & ~r.more));
}

#endif
