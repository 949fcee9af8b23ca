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
 * once, and the tetrahedron which that entry names EDGE_WAIT / 2 edges later. */
enum { EDGE_WAIT = 16, EDGE_QUEUE = 32 };

typedef struct edge_work {
    uint2 points[RECENT_EDGES + 1];
    uint slots[RECENT_EDGES + 1];
    uint queue[EDGE_QUEUE];
    uint hashed, asked, entered; /* new edges so far */
} edge_work;

/* This bit marks an edge that has been met before; the other bits are the slot where. */
#define EDGE_MET 0x80000000u

/* For each edge of tetrahedron a: stores where the search in the table begins, and prefetches that entry. For an edge
 * met lately it stores the slot where that was. Without branches, as which edges are new is hard to predict. The upper
 * 11 bits of the hash choose among the RECENT_EDGES edges met lately. */
inline_always void edges_hash(const complex_job *c, uint a, global const active_tetrahedron *active,
                              global const uchar *cases, volatile global uint *table, global uint *entries,
                              edge_work *work) {
    uint2 edge[4];
    uint hash[4], edges = edges_of(a, active, cases), hashed = work->hashed;
    loop_unrolled for (uint n = 0; n < 4; n++) edge[n] = edge_points(active, 4 * a + n, cases),
                                               hash[n] = edge_hash(edge[n]);
    loop_unrolled for (uint n = 0; n < 4; n++) {
        uint slot = 4 * a + n, exists = n < edges, first = hash[n] & c->table_mask & ~EDGE_MET;
        uint r = exists ? hash[n] >> 21 : RECENT_EDGES, where = work->slots[r];
        bool met = (work->points[r].x == edge[n].x) & (work->points[r].y == edge[n].y) & exists;
        work->points[r] = edge[n];
        work->slots[r] = met ? where : slot;
        entries[slot] = met ? EDGE_MET | where : first;
        line_prefetch(table + first);
        work->queue[hashed % EDGE_QUEUE] = slot;
        hashed += exists & !met;
    }
    work->hashed = hashed;
}

/* For queued edges: prefetches the tetrahedra that their table entries name after half of `wait`, and enters the edges
 * after all of it. */
inline_always void edges_enter(const complex_job *c, uint wait, global const active_tetrahedron *active,
                               global const uchar *cases, volatile global uint *table, global uint *entries,
                               edge_work *work, uint *full) {
    for (; work->asked + wait / 2 < work->hashed; work->asked++) {
        uint there = table[entries[work->queue[work->asked % EDGE_QUEUE]]];
        line_prefetch(active + (there == EDGE_NONE ? 0 : there / 4));
    }
    for (; work->entered + wait < work->hashed; work->entered++) {
        uint slot = work->queue[work->entered % EDGE_QUEUE];
        entries[slot] = edge_enter(c, slot, entries[slot], active, cases, table, full);
    }
}

kernel void complex_join(complex_job c, global const active_tetrahedron *active, global const uchar *cases,
                         global uint *state, global uint *table, global uint *entries) {
    local uint shared[4];
    uint number = 0, full = 0;
    edge_work work;
    for (uint n = 0; n < RECENT_EDGES; n++) work.points[n] = 0;
    work.hashed = work.asked = work.entered = 0;
    while (number < c.active_tiles) {
        number = ticket_take(&state[HEAD_TICKETS + KERNEL_JOIN], shared);
        uint first = number * c.tile_actives, count = 0;
        if (number < c.active_tiles) count = min(c.tile_actives, c.active_count - first);
        for (uint n = 0; n < count; n++) {
            edges_hash(&c, first + n, active, cases, table, entries, &work);
            edges_enter(&c, EDGE_WAIT, active, cases, table, entries, &work, &full);
        }
        edges_enter(&c, 0, active, cases, table, entries, &work, &full);
        for (uint slot = 4 * first; slot < 4 * (first + count); slot++) {
            uint entry = entries[slot]; /* of an edge met before: the slot whose entry it shares */
            entries[slot] = entries[entry & EDGE_MET ? entry & ~EDGE_MET : slot];
        }
        if (full) break; /* the host starts again with a larger table */
    }
    if (full) atomic_or(&state[HEAD_FULL], 1u);
}

#endif
