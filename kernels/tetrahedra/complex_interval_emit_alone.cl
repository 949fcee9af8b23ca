/*
 * complex_interval_emit_alone.cl - tetrahedra where a work-item has a tile to itself: eight that lie wholly within at a
 * time; of others all numbers are read first, as which ones a case takes is hard to predict
 */
#ifndef COMPLEX_INTERVAL_EMIT_ALONE_CL
#define COMPLEX_INTERVAL_EMIT_ALONE_CL

#include "complex_interval_entry.cl"

#ifdef REAL

/* A work-item prefetches what clusters need so many before it comes to them. */
enum { CLUSTERS_AHEAD = 8 };

/* ---------------------------------------------------------------------------- tetrahedra that lie wholly within */

/* Orders each pair a[n], b[n]; returns which pairs were exchanged. */
inline_always int8 pairs_order(uint8 *a, uint8 *b) {
    const uint8 low = min(*a, *b), high = max(*a, *b);
    const int8 exchanged = *a > *b;
    *a = low, *b = high;
    return exchanged;
}

/* Eight tetrahedra: their points by number, the last two exchanged where that takes an odd number of exchanges. Numbers
 * of vertices are in the order of the points. first, second: the numbers of four tetrahedra, which are replaced. */
inline_always void eight_order(uint16 *first, uint16 *second) {
    uint8 a = __builtin_shufflevector(*first, *second, 0, 4, 8, 12, 16, 20, 24, 28);
    uint8 b = __builtin_shufflevector(*first, *second, 1, 5, 9, 13, 17, 21, 25, 29);
    uint8 c = __builtin_shufflevector(*first, *second, 2, 6, 10, 14, 18, 22, 26, 30);
    uint8 d = __builtin_shufflevector(*first, *second, 3, 7, 11, 15, 19, 23, 27, 31);
    int8 odd = pairs_order(&a, &b) ^ pairs_order(&c, &d);
    odd ^= pairs_order(&a, &c) ^ pairs_order(&b, &d);
    odd ^= pairs_order(&b, &c);
    const uint16 ab = (uint16)(a, b), cd = (uint16)(odd ? d : c, odd ? c : d);
    *first = __builtin_shufflevector(ab, cd, 0, 8, 16, 24, 1, 9, 17, 25, 2, 10, 18, 26, 3, 11, 19, 27);
    *second = __builtin_shufflevector(ab, cd, 4, 12, 20, 28, 5, 13, 21, 29, 6, 14, 22, 30, 7, 15, 23, 31);
}

/* The vertices at 16 points. */
inline_always uint16 numbers_at(uint16 p, const volume_emit *e) {
    global const uint *n = e->numbers;
    if (!e->v->word_count) return p;
    return min((uint16)(n[p.s0], n[p.s1], n[p.s2], n[p.s3], n[p.s4], n[p.s5], n[p.s6], n[p.s7], n[p.s8], n[p.s9],
                        n[p.sa], n[p.sb], n[p.sc], n[p.sd], n[p.se], n[p.sf]),
               (uint16)e->v->point_last);
}

/* A cluster whose tetrahedra all lie wholly within. */
inline_always uint *within_store(global const uint *points, const volume_emit *e, uint *out) {
    for (uint m = 0; m < 4; m += 2) {
        uint16 first = numbers_at(vload16(m, points), e), second = numbers_at(vload16(m + 1, points), e);
        eight_order(&first, &second);
        vstore16(first, m, out);
        vstore16(second, m + 1, out);
    }
    return out + CLUSTER_POINTS;
}

/* ------------------------------------------------------------------------------------------- tetrahedra in part */

/* Numbers of a tetrahedron's vertices: at points, on the edges of its first cut, of its second one. */
typedef struct part_numbers {
    uint4 points, first, second;
} part_numbers;

inline_always uint4 four_numbers(uint4 at, global const uint *of) {
    return (uint4)(of[at.x], of[at.y], of[at.z], of[at.w]);
}

/* The vertices at a tetrahedron's points. */
inline_always uint4 point_numbers(global const uint *points, const volume_emit *e) {
    const uint4 p = vload4(0, points);
    return e->v->word_count ? min(four_numbers(p, e->numbers), (uint4)e->v->point_last) : p;
}

/* slots: those of its cuts, behind the tile's first entry. Numbers of cuts that it does not have are not used. */
inline_always part_numbers part_read(global const uint *points, global const ushort *slots, bool has_both,
                                     global const uint *entries, const volume_emit *e) {
    part_numbers n;
    n.points = point_numbers(points, e);
    n.first = n.second = four_numbers(convert_uint4(vload4(0, slots)), entries);
    if (has_both) n.second = four_numbers(convert_uint4(vload4(1, slots)), entries);
    return n;
}

/* What lies within of a tetrahedron; up to 24 words may be written. */
inline_always void parts_store(global const uchar *entry, part_numbers n, uint *out) {
    const uint16 numbers = (uint16)(n.points, n.first, n.second, n.second);
#ifdef WORD_SHUFFLES
    vstore16(words_shuffled(numbers, numbers, vload16(0, entry + 1), false), 0, out);
    if (entry[0] > 4) vstore8(words_shuffled(numbers, numbers, vload16(0, entry + 17), false).lo, 2, out);
#else
    uint number[16];
    vstore16(numbers, 0, number);
    for (uint corner = 0; corner < 4 * (uint)entry[0]; corner++) out[corner] = number[entry[1 + corner]];
#endif
}

/* Some of the cluster's tetrahedra are cut. The cuts of a cluster have slots one after the other. */
inline_always uint *cuts_store(const volume_cluster *c, global const uint *points, global const uint *entries,
                               global const ushort *first, const volume_emit *e, uint *out) {
    const ulong low = nibbles_mixed(c->low), high = nibbles_mixed(c->high);
    global const ushort *slots = first;
    for (ulong rest = cluster_reached(c); rest; rest &= rest - 1) {
        const uint bit = lowest_bit(rest), cuts = (uint)(low >> bit & 1) + (uint)(high >> bit & 1);
        global const uchar *entry = entry_of(points + bit, pattern_of(c, bit / 4), e->cases);
        parts_store(entry, part_read(points + bit, cuts ? slots : first, cuts == 2, entries, e), out);
        out += 4 * (uint)entry[0];
        slots += 4 * cuts;
    }
    return out;
}

/* No tetrahedron is cut. Some do not exist, as the cluster is the last one, have a missing point, or lie
 * outside. */
inline_always uint *few_store(ulong reached, global const uint *points, const volume_emit *e, uint *out) {
    for (ulong rest = reached; rest; rest &= rest - 1, out += 4) {
        uint16 numbers = 0, none = 0;
        numbers.s0123 = point_numbers(points + lowest_bit(rest), e);
        eight_order(&numbers, &none);
        vstore4(numbers.s0123, 0, out);
    }
    return out;
}

/* Returns where the next tetrahedra go. */
inline_always uint *cluster_emit(uint n, uint first_slot, const volume_emit *e, uint *out) {
    const volume_cluster c = e->clusters[n];
    global const uint *points = e->tetrahedra + (ulong)CLUSTER_POINTS * n;
    if (c.low == ~0ul && !c.high) return within_store(points, e, out);
    if (nibbles_mixed(c.low) | nibbles_mixed(c.high))
        return cuts_store(&c, points, e->entries + first_slot, e->slots + first_slot + 4 * c.cuts, e, out);
    return few_store(cluster_reached(&c), points, e, out);
}

/* ------------------------------------------------------------------------------------------------------------ tiles */

/* Prefetches a cluster's tetrahedra; then numbers of every fourth one's points, as those of the others lie close to
 * them. */
inline_always void emit_prefetch(uint n, const volume_emit *e) {
    if (n + CLUSTERS_AHEAD < e->c->cluster_count && e->clusters[n + CLUSTERS_AHEAD].low)
        points_prefetch(e->c, n + CLUSTERS_AHEAD, (complex_arrays){0, e->tetrahedra});
    n += CLUSTERS_AHEAD / 2;
    if (n >= e->c->cluster_count || !e->clusters[n].low || cluster_size(e->c, n) < CLUSTER_TETRAHEDRA) return;
    loop_unrolled for (uint m = 0; m < CLUSTER_POINTS; m += m % 16 < 3 ? 1 : 13)
        line_prefetch(e->numbers + e->tetrahedra[(ulong)CLUSTER_POINTS * n + m]);
}

/* Entries of a tile's edges have named the edges that own their vertices; they then name vertices. */
inline_always void entries_resolve(edge_span span, const volume_emit *e) {
    for (uint n = span.first; n < span.end; n++) {
        if (n + FETCH_AHEAD < span.end) line_prefetch(e->edges + (e->entries[n + FETCH_AHEAD] & ~EDGE_RESOLVED));
        e->entries[n] = e->edges[e->entries[n] & ~EDGE_RESOLVED].x;
    }
}

/* A copy of the end of the output. It begins at the cache line that the next tetrahedron goes to; the line's first
 * `skip` words belong to the tile before. Lines are stored when they are whole. */
enum { LINE_WORDS = 16, STAGE_FROM = 512, STAGE_WORDS = STAGE_FROM + 6 * 4 * CLUSTER_TETRAHEDRA + 2 * LINE_WORDS };

typedef struct out_stage {
    uint16 lines[STAGE_WORDS / LINE_WORDS];
    uint skip;
    global uint *out;
} out_stage;

inline_always uint *stage_open(out_stage *s, global uint *out) {
    s->skip = (uint)((size_t)out / 4 % LINE_WORDS);
    s->out = out - s->skip;
    return (uint *)s->lines + s->skip;
}

inline_always void words_copy(const uint *words, uint first, uint end, global uint *out) {
    loop_short for (uint n = first; n < end; n++) out[n] = words[n];
}

/* Stores whole lines of what ends at `end`; returns where the rest ends then. */
inline_always uint *stage_flush(out_stage *s, const uint *end) {
    uint *words = (uint *)s->lines;
    const uint lines = (uint)(end - words) / LINE_WORDS, rest = (uint)(end - words) % LINE_WORDS;
    if (!lines) return words + rest;
    if (s->skip) words_copy(words, s->skip, LINE_WORDS, s->out);
    for (uint n = s->skip != 0; n < lines; n++) line_store(s->lines[n], (global uint16 *)(s->out + LINE_WORDS * n));
    s->lines[0] = s->lines[lines];
    s->out += LINE_WORDS * lines, s->skip = 0;
    return words + rest;
}

inline_always void tile_emit(uint tile_index, const volume_emit *e) {
    const uint items = 1u << e->v->tile_shift, end = min((tile_index + 1) * items, e->c->cluster_count);
    const edge_span span = tile_edges(tile_index, e->state, e->v);
    out_stage stage;
    uint *out = stage_open(&stage, tile_out(tile_index, e)), *words = (uint *)stage.lines;
    entries_resolve(span, e);
    for (uint n = tile_index * items; n < end; n++) {
        emit_prefetch(n, e);
        out = cluster_emit(n, span.first, e, out);
        if (out >= words + STAGE_FROM) out = stage_flush(&stage, out);
    }
    out = stage_flush(&stage, out);
    words_copy(words, stage.skip, (uint)(out - words), stage.out);
}

#endif

#endif
