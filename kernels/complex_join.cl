/*
 * complex_join.cl - one vertex for each crossed edge: edges of active tetrahedra that have the same two points are
 * joined, and the first tetrahedron with an edge owns its vertex
 *
 * A table with open addressing, proportional to the crossed edges. An entry is the place of an edge in the list of
 * active tetrahedra, where its points are read, so that 32-bit atomics are enough: an entry once taken only changes
 * to an earlier place of the same edge. In the end it holds the first, whatever the order of the insertions.
 */

/* The two points of an edge, the lower first. */
inline_always uint2 edge_points(global const active_tetrahedron *active, uint place, global const uchar *cases) {
    global const active_tetrahedron *t = active + place / 4;
    global const uchar *ends = cases + CASE_BYTES * t->pattern + CASE_ENDS + 2 * (place % 4);
    uint a = t->points[ends[0]], b = t->points[ends[1]];
    return (uint2)(min(a, b), max(a, b));
}

inline_always uint edge_hash(uint2 edge) {
    uint x = edge.x * 0x9e3779b1u ^ (edge.y + 0x7f4a7c15u) * 0x85ebca6bu;
    x ^= x >> 15;
    x *= 0x2c1b3c6du;
    return x ^ x >> 13;
}

inline_always uint edges_of(uint a, global const active_tetrahedron *active, global const uchar *cases) {
    return cases[CASE_BYTES * active[a].pattern + CASE_EDGES];
}

#if WORK_ITEMS == 1

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
#pragma unroll
    for (uint n = 0; n < 4; n++) edge[n] = edge_points(active, 4 * a + n, cases), hash[n] = edge_hash(edge[n]);
#pragma unroll
    for (uint n = 0; n < 4; n++) {
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

#endif

/* Enters an edge, from the entry where it is looked for first; returns its entry, or 0 with *full set where none was
 * found. */
inline_always uint edge_enter(const complex_job *c, uint place, uint entry, global const active_tetrahedron *active,
                              global const uchar *cases, volatile global uint *table, uint *full) {
    uint2 edge = edge_points(active, place, cases);
    for (uint probe = 0; probe <= c->probe_limit; probe++) {
        uint there = table[entry];
        if (there == EDGE_NONE) there = atomic_cmpxchg(&table[entry], EDGE_NONE, place);
        if (there == EDGE_NONE) return entry;
        uint2 other = edge_points(active, there, cases);
        if (other.x == edge.x && other.y == edge.y) {
            if (place < there) atomic_min(&table[entry], place);
            return entry;
        }
        entry = (entry + 1) & c->table_mask;
    }
    *full = 1;
    return 0;
}

#if WORK_ITEMS == 1
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
#endif

kernel void complex_join(complex_job c, global const active_tetrahedron *active, global const uchar *cases,
                         global uint *state, global uint *table, global uint *entries) {
    local uint shared[4];
    uint number = 0, full = 0;
#if WORK_ITEMS == 1
    edge_work work;
    for (uint n = 0; n < RECENT_EDGES; n++) work.points[n] = 0;
    work.hashed = work.asked = work.entered = 0;
#endif
    while (number < c.active_tiles) {
        number = ticket_take(&state[HEAD_TICKETS + KERNEL_JOIN], shared);
        uint first = number * c.tile_actives, count = 0;
        if (number < c.active_tiles) count = min(c.tile_actives, c.active_count - first);
#if WORK_ITEMS == 1
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
#else
        for (uint n = (uint)get_local_id(0); n < count; n += WORK_ITEMS) {
            uint a = first + n, edges = edges_of(a, active, cases);
            for (uint place = 4 * a; place < 4 * a + edges; place++) {
                uint entry = edge_hash(edge_points(active, place, cases)) & c.table_mask;
                entries[place] = edge_enter(&c, place, entry, active, cases, table, &full);
            }
        }
#endif
    }
    if (full) atomic_or(&state[HEAD_FULL], 1u);
}

/* Which vertices tetrahedron a owns. */
inline_always uint owned_edges(uint a, global const active_tetrahedron *active, global const uchar *cases,
                               global const uint *table, global const uint *entries) {
    uint owned = 0, edges = edges_of(a, active, cases);
    for (uint n = 0; n < edges; n++) owned |= (uint)(table[entries[4 * a + n]] == 4 * a + n) << n;
    return owned;
}

/* The vertices of a tile of active tetrahedra; out NULL: nothing is stored. */
inline_always uint2 tile_number(tile_tools k, uint number, global const active_tetrahedron *active,
                                global const uchar *cases, global const uint *table, global const uint *entries,
                                global active_tetrahedron *out) {
    uint2 running = 0;
    for (uint start = 0; start < k.c->tile_actives; start += WORK_ITEMS) {
        uint a = number * k.c->tile_actives + start + (uint)get_local_id(0), owned = 0;
        bool exists = start + (uint)get_local_id(0) < k.c->tile_actives && a < k.c->active_count;
        if (WORK_ITEMS == 1 && a + FETCH_AHEAD < k.c->active_count)
            for (uint n = 0; n < 4; n++) line_prefetch(table + entries[4 * (a + FETCH_AHEAD) + n]);
        if (exists) owned = owned_edges(a, active, cases, table, entries);
        uint2 before = group_prefix((uint2)((uint)popcount(owned), 0), &running, k.sums);
        if (exists && out) out[a].vertex = before.x, out[a].owned = owned;
    }
    return running;
}

inline_always void active_tile_settle(tile_tools k, uint number, global const active_tetrahedron *active,
                                      global const uchar *cases, global const uint *table, global const uint *entries,
                                      global uint *head) {
    uint missing;
    bool look = false;
    while (!tile_settle(k, number, look, &missing)) {
        tile_post(k, missing, tile_number(k, missing, active, cases, table, entries, NULL));
        look = true;
    }
    if (get_local_id(0) == 0 && number + 1 == k.c->active_tiles)
        head[HEAD_VERTICES] = tile_before(k.tiles, number + 1, TILE_VERTICES);
}

/* Numbers the vertices in the order of their owners. tiles: cleared. */
kernel void complex_number(slab s, complex_job c, global active_tetrahedron *active, global const uchar *cases,
                           global uint *state, global uint *tiles, global const uint *table,
                           global const uint *entries) {
    local uint shared[4];
    local uint2 sums[WORK_ITEMS + 1];
    tile_tools k = {&s, &c, tiles, shared, sums};
    uint number = 0, first_own = c.active_tiles, last_own = c.active_tiles;
#if WORK_ITEMS == 1
    if (state[HEAD_FULL]) return; /* entries are incomplete */
#endif
    while (number < c.active_tiles) {
        number = ticket_take(&state[HEAD_TICKETS + KERNEL_NUMBER], shared);
        if (number < c.active_tiles) {
            tile_post(k, number, tile_number(k, number, active, cases, table, entries, active));
#if WORK_ITEMS == 1
            if (first_own == c.active_tiles)
                first_own = number;
            else
                tiles[TILE_WORDS * last_own + TILE_NEXT] = number;
            tiles[TILE_WORDS * number + TILE_NEXT] = c.active_tiles;
            last_own = number;
#else
            active_tile_settle(k, number, active, cases, table, entries, state);
#endif
        }
    }
#if WORK_ITEMS == 1
    for (uint own = first_own; own < c.active_tiles; own = tiles[TILE_WORDS * own + TILE_NEXT])
        active_tile_settle(k, own, active, cases, table, entries, state);
#endif
}
