/*
 * regular_alone.cl - regular points for a work-item alone: eight rows of samples at once
 *
 * Around a sample is its link (link.h), a sphere of triangles. The sample is a regular point if on the link the samples
 * inside are connected, those outside are too, and every sample there that is a vertex lies on a curve between them: in
 * the ring of link samples around it + and - change twice. On the grid's border links are disks and rings may be cut
 * open, with one change; and the ring in the border's plane is looked at too, so that the border's curves stay.
 */
#ifndef REGULAR_ALONE_CL
#define REGULAR_ALONE_CL

#include "link_alone.cl"

/* ------------------------------------------------------------------------------------------------------------ rings */

/* What has been met on the way around a ring. */
typedef struct ring {
    lanes one, two, more; /* changes between + and -, counted: 1, 2 or 3, more */
    lanes wrong;          /* a vertex that is not between + and - */
    lanes whole;          /* all samples are in the grid */
} ring;

inline_always void ring_add(ring *r, lanes change) {
    r->more |= r->one & r->two & change;
    lanes carry = r->one & change;
    r->one ^= change, r->two ^= carry;
}

/* Sample n of a ring, between samples `before` and `after`. */
inline_always void ring_step(ring *r, const link_signs *l, uint before, uint n, uint after) {
    const lanes between = (l->plus[before] & l->minus[after]) | (l->minus[before] & l->plus[after]);
    const lanes change = (l->plus[n] & l->minus[after]) | (l->minus[n] & l->plus[after]);
    ring_add(r, change | (l->zero[n] & between));
    r->wrong |= l->zero[n] & ~between;
    r->whole &= l->plus[n] | l->minus[n] | l->zero[n];
}

/* Two changes, or one where the ring is cut open. */
inline_always lanes ring_regular(const ring *r) {
    const lanes two = r->two & ~r->one, one = r->one & ~r->two;
    return ((r->whole & two) | (~r->whole & one)) & ~r->more & ~r->wrong;
}

/* Around a ring of samples, each joined to the next and the last to the first. */
inline_always lanes ring_walk(const link_signs *l, const uint *n, uint count) {
    ring r = {0, 0, 0, 0, ~(lanes)0};
#pragma unroll
    for (uint m = 0; m < count; m++) ring_step(&r, l, n[(m + count - 1) % count], n[m], n[(m + 1) % count]);
    return ring_regular(&r);
}

/* The ring around a sample across from the middle: along axis a to the side up_a, and likewise b; c is the third axis.
 */
inline_always lanes ring_around_across(const link_signs *l, uint a, uint up_a, uint b, uint up_b, uint c) {
    const uint n[6] = {LINK_AXIS(a, up_a), link_across(a, up_a, c, 1), link_across(b, up_b, c, 1),
                       LINK_AXIS(b, up_b), link_across(b, up_b, c, 0), link_across(a, up_a, c, 0)};
    return ring_walk(l, n, 6);
}

/* The ring around a sample of an odd link; a is its axis. It is also the ring in the plane across axis a. */
inline_always lanes ring_odd(const link_signs *l, uint a) {
    const uint b = (a + 1) % 3, c = (a + 2) % 3;
    const uint n[4] = {LINK_AXIS(b, 0), LINK_AXIS(c, 0), LINK_AXIS(b, 1), LINK_AXIS(c, 1)};
    return ring_walk(l, n, 4);
}

/* The ring of an even link in the plane across axis a. */
inline_always lanes ring_even(const link_signs *l, uint a) {
    const uint b = (a + 1) % 3, c = (a + 2) % 3;
    const uint n[8] = {LINK_AXIS(b, 0), link_across(b, 0, c, 0), LINK_AXIS(c, 0), link_across(b, 1, c, 0),
                       LINK_AXIS(b, 1), link_across(b, 1, c, 1), LINK_AXIS(c, 1), link_across(b, 0, c, 1)};
    return ring_walk(l, n, 8);
}

/* ------------------------------------------------------------------------------------------------------- connection */

/* The samples of the set that are joined to sample n of an even link. */
inline_always lanes joined_even(const lanes set[LINK_EVEN], uint n) {
    if (n < LINK_ODD) {
        const uint a = n / 2, up = n % 2, b = (a + 1) % 3, c = (a + 2) % 3;
        return set[link_across(a, up, b, 0)] | set[link_across(a, up, b, 1)] | set[link_across(a, up, c, 0)] |
               set[link_across(a, up, c, 1)];
    }
    const uint face = (n - LINK_ODD) / 4, up_a = (n - LINK_ODD) % 2, up_b = (n - LINK_ODD) / 2 % 2;
    const uint a = face == 2, b = face == 0 ? 1 : 2, c = 3 - a - b;
    return set[LINK_AXIS(a, up_a)] | set[LINK_AXIS(b, up_b)] | set[link_across(a, up_a, c, 0)] |
           set[link_across(a, up_a, c, 1)] | set[link_across(b, up_b, c, 0)] | set[link_across(b, up_b, c, 1)];
}

/* Of an odd link: all but itself and the one on the other side. */
inline_always lanes joined_odd(const lanes set[LINK_EVEN], uint n) {
    const uint b = (n / 2 + 1) % 3, c = (n / 2 + 2) % 3;
    return set[LINK_AXIS(b, 0)] | set[LINK_AXIS(b, 1)] | set[LINK_AXIS(c, 0)] | set[LINK_AXIS(c, 1)];
}

/* For which samples a set of link samples is connected and not empty; only those of `wanted` matter. Starts from the
 * first sample of the set and adds what is joined. */
inline_always lanes connected(const lanes set[LINK_EVEN], lanes wanted, bool odd) {
    const uint count = odd ? LINK_ODD : LINK_EVEN;
    lanes seen[LINK_EVEN], any = 0, added, missed;
#pragma unroll
    for (uint n = 0; n < count; n++) seen[n] = set[n] & ~any, any |= set[n];
    do {
        added = missed = 0;
#pragma unroll
        for (uint n = 0; n < count; n++) {
            const lanes left = set[n] & ~seen[n], more = left & (odd ? joined_odd(seen, n) : joined_even(seen, n));
            seen[n] |= more, added |= more, missed |= left & ~more;
        }
        missed &= wanted;
    } while (lanes_any(missed) && lanes_any(added));
    return any & ~missed & wanted;
}

/* ------------------------------------------------------------------------------------------------------------- test */

/* Which of the wanted samples are regular points. border[a]: samples on the grid's border across axis a. */
inline_always lanes points_regular(const link_signs *l, const lanes border[3], lanes wanted, bool odd) {
    wanted = connected(l->plus, wanted, odd);
    wanted = connected(l->minus, wanted, odd);
    if (odd) {
#pragma unroll
        for (uint a = 0; a < 3; a++) {
            const lanes zero = l->zero[LINK_AXIS(a, 0)] | l->zero[LINK_AXIS(a, 1)];
            wanted &= ~(zero | border[a]) | ring_odd(l, a);
        }
        return wanted;
    }
#pragma unroll
    for (uint n = LINK_ODD; n < LINK_EVEN; n++) { /* those along axes are odd, and snapped last */
        const uint face = (n - LINK_ODD) / 4, a = face == 2, b = face == 0 ? 1 : 2;
        if (!lanes_any(l->zero[n] & wanted)) continue;
        wanted &= ~l->zero[n] | ring_around_across(l, a, (n - LINK_ODD) % 2, b, (n - LINK_ODD) / 2 % 2, 3 - a - b);
    }
#pragma unroll
    for (uint a = 0; a < 3; a++)
        if (lanes_any(border[a] & wanted)) wanted &= ~border[a] | ring_even(l, a);
    return wanted;
}

#endif
