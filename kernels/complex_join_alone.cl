/*
 * complex_join_alone.cl - edges joined where a work-item has a tile to itself
 */
#ifndef COMPLEX_JOIN_ALONE_CL
#define COMPLEX_JOIN_ALONE_CL

#include "complex_join.cl"

/* Edges that a work-item has met lately: neighbours in the list share most. One more is never met. */
enum { RECENT_EDGES = 2048 };

/* New ones wait between being hashed and entered: what is fetched first is asked for at once, what that leads to half
 * way. */
enum { EDGE_WAIT = 16, EDGE_QUEUE = 32 };

typedef struct edge_work {
    uint2 points[RECENT_EDGES + 1];
    uint places[RECENT_EDGES + 1];
    uint queue[EDGE_QUEUE];
    uint hashed, asked, entered; /* new edges so far */
} edge_work;

/* An edge with this bit has been met before, at the place in the other bits. */
#define EDGE_MET 0x80000000u

/* Where in the table the edges of a tetrahedron are looked for first, which is asked for. Without branches, as nothing
 * foretells which are new. */
inline_always void edges_hash(const complex_job *c, uint a, global const active_tetrahedron *active,
                              global const uchar *cases, volatile global uint *table, global uint *entries,
                              edge_work *work) {
    uint2 edge[4];
    uint hash[4], edges = edges_of(a, active, cases), hashed = work->hashed;
    loop_unrolled for (uint n = 0; n < 4; n++) edge[n] = edge_points(active, 4 * a + n, cases),
                                               hash[n] = edge_hash(edge[n]);
    loop_unrolled for (uint n = 0; n < 4; n++) {
        uint place = 4 * a + n, exists = n < edges, first = hash[n] & c->table_mask & ~EDGE_MET;
        uint r = exists ? hash[n] >> 21 : RECENT_EDGES, where = work->places[r];
        bool met = (work->points[r].x == edge[n].x) & (work->points[r].y == edge[n].y) & exists;
        work->points[r] = edge[n];
        work->places[r] = met ? where : place;
        entries[place] = met ? EDGE_MET | where : first;
        line_prefetch(table + first);
        work->queue[hashed % EDGE_QUEUE] = place;
        hashed += exists & !met;
    }
    work->hashed = hashed;
}

/* Asks for what the table leads to, and enters edges, of those that have waited so long. */
inline_always void edges_enter(const complex_job *c, uint wait, global const active_tetrahedron *active,
                               global const uchar *cases, volatile global uint *table, global uint *entries,
                               edge_work *work, uint *full) {
    for (; work->asked + wait / 2 < work->hashed; work->asked++) {
        uint there = table[entries[work->queue[work->asked % EDGE_QUEUE]]];
        line_prefetch(active + (there == EDGE_NONE ? 0 : there / 4));
    }
    for (; work->entered + wait < work->hashed; work->entered++) {
        uint place = work->queue[work->entered % EDGE_QUEUE];
        entries[place] = edge_enter(c, place, entries[place], active, cases, table, full);
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
        for (uint place = 4 * first; place < 4 * (first + count); place++) {
            uint entry = entries[place]; /* of an edge met before: where that is found */
            entries[place] = entries[entry & EDGE_MET ? entry & ~EDGE_MET : place];
        }
        if (full) break; /* all begins again with a larger table */
    }
    if (full) atomic_or(&state[HEAD_FULL], 1u);
}

#endif
