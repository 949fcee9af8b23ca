/*
 * complex_join_alone.cl - edges joined where a work-item has a tile to itself
 */
#ifndef COMPLEX_JOIN_ALONE_CL
#define COMPLEX_JOIN_ALONE_CL

#include "complex_join.cl"

/* A cache of the edges that a work-item has met lately: neighbours in the list share most edges. One more entry takes
 * edges that do not exist and is never matched. */
enum { RECENT_EDGES = 2048 };

/* A new edge is entered EDGE_WAIT new edges after it was hashed. Prefetch has two stages: its entry in the table at
 * once, and the item which that entry names EDGE_WAIT / 2 edges later. */
enum { EDGE_WAIT = 16, EDGE_QUEUE = WHOLE ? 64 : 32 }; /* an item has up to 30 edges, or 4 */

typedef struct edge_work {
    uint2 points[RECENT_EDGES + 1];
    uint slots[RECENT_EDGES + 1];
    uint queue[EDGE_QUEUE];
    uint hashed, prefetched, entered; /* new edges so far */
} edge_work;

/* This bit marks an edge that has been met before; the other bits are the slot where. */
#define EDGE_MET 0x80000000u

/* For an edge of an item: stores where the search in the table begins, and prefetches that entry. For an edge met
 * lately it stores the slot where that was. Without branches, as which edges are new is hard to predict. The upper 11
 * bits of the hash choose among the RECENT_EDGES edges met lately. */
inline_always void edge_queue(const complex_job *c, uint slot, uint2 edge, uint hash, uint exists,
                              volatile global uint *table, global uint *entries, edge_work *work) {
    uint first = hash & c->table_mask & ~EDGE_MET;
    uint r = exists ? hash >> 21 : RECENT_EDGES, where = work->slots[r];
    bool met = (work->points[r].x == edge.x) & (work->points[r].y == edge.y) & exists;
    work->points[r] = edge;
    work->slots[r] = met ? where : slot;
    entries[slot] = met ? EDGE_MET | where : first;
    line_prefetch(table + first);
    work->queue[work->hashed % EDGE_QUEUE] = slot;
    work->hashed += exists & !met;
}

#if WHOLE

inline_always void edges_hash(const complex_job *c, uint a, global const active_cell *active, global const uchar *cases,
                              volatile global uint *table, global uint *entries, edge_work *work) {
    for (uint rest = own_edges(a, active, cases); rest; rest &= rest - 1) {
        const uint n = lowest_bit(rest);
        const uint2 edge = candidate_points(active + a, n, cases);
        edge_queue(c, slot_of(c, a, n), edge, edge_hash(edge), 1, table, entries, work);
    }
}

/* An edge met before has the slot of that meeting in place of an entry: replaces it by that slot's entry. */
inline_always void entries_share(const complex_job *c, uint a, global const active_cell *active,
                                 global const uchar *cases, global uint *entries) {
    for (uint rest = own_edges(a, active, cases); rest; rest &= rest - 1) {
        const uint slot = slot_of(c, a, lowest_bit(rest)), entry = entries[slot];
        entries[slot] = entries[entry & EDGE_MET ? entry & ~EDGE_MET : slot];
    }
}

#else

inline_always void edges_hash(const complex_job *c, uint a, global const active_tetrahedron *active,
                              global const uchar *cases, volatile global uint *table, global uint *entries,
                              edge_work *work) {
    uint2 edge[4];
    uint hash[4], edges = edges_of(a, active, cases);
    loop_unrolled for (uint n = 0; n < 4; n++) edge[n] = edge_points(c, active, 4 * a + n, cases),
                                               hash[n] = edge_hash(edge[n]);
    loop_unrolled for (uint n = 0; n < 4; n++)
        edge_queue(c, 4 * a + n, edge[n], hash[n], n < edges, table, entries, work);
}

/* An edge met before has the slot of that meeting in place of an entry: replaces it by that slot's entry. */
inline_always void entries_share(const complex_job *c, uint a, global const active_tetrahedron *active,
                                 global const uchar *cases, global uint *entries) {
    for (uint slot = 4 * a; slot < 4 * a + 4; slot++) {
        uint entry = entries[slot];
        entries[slot] = entries[entry & EDGE_MET ? entry & ~EDGE_MET : slot];
    }
}

#endif

/* For queued edges: prefetches the items that their table entries name after half of `wait`, and enters the edges
 * after all of it. */
inline_always void edges_enter(const complex_job *c, uint wait, global const active_item *active,
                               global const uchar *cases, volatile global uint *table, global uint *entries,
                               edge_work *work, global uint *full) {
    for (; work->prefetched + wait / 2 < work->hashed; work->prefetched++) {
        uint there = table[entries[work->queue[work->prefetched % EDGE_QUEUE]]];
        line_prefetch(active + (there == EDGE_NONE ? 0 : slot_item(c, there)));
    }
    for (; work->entered + wait < work->hashed; work->entered++) {
        uint slot = work->queue[work->entered % EDGE_QUEUE];
        entries[slot] = edge_enter(c, slot, entries[slot], active, cases, table, full);
    }
}

kernel void complex_join(complex_job c, global const active_item *active, global const uchar *cases, global uint *state,
                         global uint *table, global uint *entries) {
    local uint shared[4];
    uint tile_index = 0;
    edge_work work;
    for (uint n = 0; n < RECENT_EDGES; n++) work.points[n] = 0;
    work.hashed = work.prefetched = work.entered = 0;
    while (tile_index < c.active_tiles) {
        tile_index = ticket_take(&state[HEAD_TICKETS + KERNEL_JOIN], shared);
        uint first = tile_index * c.tile_actives, count = 0;
        if (tile_index < c.active_tiles) count = min(c.tile_actives, c.active_count - first);
        for (uint n = 0; n < count; n++) {
            edges_hash(&c, first + n, active, cases, table, entries, &work);
            edges_enter(&c, EDGE_WAIT, active, cases, table, entries, &work, &state[HEAD_FULL]);
        }
        edges_enter(&c, 0, active, cases, table, entries, &work, &state[HEAD_FULL]);
        for (uint n = 0; n < count; n++) entries_share(&c, first + n, active, cases, entries);
        if (state[HEAD_FULL]) break;
    }
}

#endif
