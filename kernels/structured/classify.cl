/*
 * classify.cl - kernel 1: sign words, vertices and triangles of each row of 64 cubes, and their prefix sums
 *
 * Groups are persistent and take tiles (count.cl) by ticket. For each tile, a group
 *
 * 1. finds on which side of the isovalue its bricks are, makes the sign words of mixed bricks (sign.cl) and of the
 *    halo: the next row and the next plane of samples. In method snap, snap.cl has done this before, for all bricks;
 * 2. counts the vertices and triangles of every brick that may emit some, row by row, and stores where in the brick
 *    each row's output begins (count.cl);
 * 3. posts the tile's sums and, now or after its other tiles, obtains the sums over all tiles before it (scan.cl);
 * 4. adds these to the offsets of its bricks, and appends the bricks that emit something to the list for kernel 2.
 *
 * A loop over items has the same number of iterations for all work-items of a group, with a test inside: PoCL 3.1 runs
 * too many iterations where their numbers differ.
 */
#ifndef CLASSIFY_CL
#define CLASSIFY_CL

#include "cells.cl"
#include "count.cl"
#include "../base/scan.cl"

/* Words of local memory in which the leader tells its group how far it has come; at the end, the two sums. */
enum { PREFIX_COMPLETE, PREFIX_TILE, PREFIX_VERTICES, PREFIX_TRIANGLES, PREFIX_WORDS };

/* The sums over all tiles before this one. Called by the whole group; shared: PREFIX_WORDS words of local memory.
 * `prefix` holds the sums of tiles `back` to number - 1. Where tile back - 1, `unposted`, has posted nothing in time,
 * it is recounted. With spin_limit 1, which is for tests, the tile before is recounted every time. */
inline_always uint2 tile_prefix(const slab *s, uint tile_index, global const BITS *samples, global const ulong *cells,
                                tile_words signs, global uint *tiles, local uint *shared) {
    bool leader = get_local_id(0) == 0, complete = false, look = s->tiling.spin_limit > 1 || tile_index == 0;
    uint back[2] = {tile_index, tile_index}, prefix[2] = {0, 0};
    while (!complete) {
        group_barrier();
        if (leader) {
            bool done = look && scan_look_back(tiles, TILE_VERTICES, &back[0], &prefix[0], s->tiling.spin_limit);
            shared[PREFIX_COMPLETE] =
                done && scan_look_back(tiles, TILE_TRIANGLES, &back[1], &prefix[1], s->tiling.spin_limit);
            shared[PREFIX_TILE] = done ? back[1] : back[0];
            shared[PREFIX_VERTICES] = shared[PREFIX_TRIANGLES] = 0;
        }
        group_barrier();
        complete = shared[PREFIX_COMPLETE];
        uint unposted = shared[PREFIX_TILE] - 1;
        look = true;
        if (!complete) {
            emit_counts e = tile_recount(s, unposted, samples, cells, signs);
            atomic_add(&shared[PREFIX_VERTICES], e.vertices);
            atomic_add(&shared[PREFIX_TRIANGLES], e.triangles);
        }
        group_barrier();
        if (leader && !complete) {
            for (uint sum_index = 0; sum_index < 2; sum_index++) {
                scan_post_sum(tiles, unposted, sum_index, shared[PREFIX_VERTICES + sum_index]);
                if (back[sum_index] == unposted + 1)
                    prefix[sum_index] += shared[PREFIX_VERTICES + sum_index], back[sum_index] = unposted;
            }
        }
    }
    if (leader) {
        shared[PREFIX_VERTICES] = prefix[0];
        shared[PREFIX_TRIANGLES] = prefix[1];
    }
    group_barrier();
    return (uint2)(shared[PREFIX_VERTICES], shared[PREFIX_TRIANGLES]);
}

/* Adds the sums before the tile, `prefix`, to the offsets of its bricks, which so far count from the start of the tile.
 * Done for bricks that emit something, which are appended to the list, and for the first brick of a layer, which the
 * host reads. */
inline_always void tile_finish(const slab *s, tile t, uint2 prefix, uint emitting, global brick_state *bricks,
                               global uint *active, global uint *head, local uint *shared) {
    uint first = brick_index(s, t.y0, t.z0, 0), layer = layer_bricks(s, t);
    uint layers = (t.z1 - t.z0 + BRICK_PLANES - 1) / BRICK_PLANES;
    group_barrier();
    if (get_local_id(0) == 0) {
        shared[0] = emitting;
        shared[1] = emitting ? atomic_add(&head[STATE_ACTIVE_BRICKS], emitting) : 0;
    }
    group_barrier();
    uint count = shared[0] ? layer : 1;
    for (uint z = 0; z < layers; z++, first += layer)
        for (uint start = 0; start < count; start += WORK_ITEMS) {
            uint n = start + (uint)get_local_id(0);
            bool emits = n < layer && bricks[first + n].rows;
            if (emits || n == 0) bricks[first + n].vertices += prefix.x, bricks[first + n].triangles += prefix.y;
            if (emits) active[atomic_inc(&shared[1])] = first + n;
        }
}

/* For a tile whose sums are posted: looks back, posts its prefix and completes its bricks. */
inline_always void tile_complete(const slab *s, uint tile_index, global const BITS *samples, global const ulong *cells,
                                 tile_words signs, global uint *active, global uint *head, global uint *tiles,
                                 local uint *shared) {
    uint2 prefix = tile_prefix(s, tile_index, samples, cells, signs, tiles, shared);
    uint emitting = tiles[TILE_WORDS * tile_index + TILE_BRICKS];
    if (get_local_id(0) == 0) {
        uint vertices = prefix.x + scan_own_sum(tiles, tile_index, TILE_VERTICES);
        uint triangles = prefix.y + scan_own_sum(tiles, tile_index, TILE_TRIANGLES);
        scan_post_prefix(tiles, tile_index, TILE_VERTICES, vertices);
        scan_post_prefix(tiles, tile_index, TILE_TRIANGLES, triangles);
        if (tile_index + 1 == s->tiling.tile_count) head[STATE_VERTICES] = vertices, head[STATE_TRIANGLES] = triangles;
    }
    tile_finish(s, tile_locate(s, tile_index), prefix, emitting, signs.bricks, active, head, shared);
}

/* state: heads and tiles of the slabs, cleared. scratch: per group, memory for the halo of a tile. */
kernel void classify(slab s, global const BITS *samples, global const ulong *cells, global brick_range *ranges,
                     global ulong *words, global ulong *offsets, global ushort *triangle_offsets,
                     global brick_state *bricks, global uint *active, global uint *state, global ulong *scratch,
                     uint scratch_words) {
    local uint shared[PREFIX_WORDS];
    local sign_memory for_sign;
    local count_memory for_count;
    words += UNIFORM_BRICKS * BRICK_WORDS;
    global uint *head = state + s.results.head_offset, *tiles = state + s.results.tiles_offset;
    tile_words signs = {words, scratch + get_group_id(0) * (size_t)scratch_words, bricks};
    active += s.results.active_offset;
    uint tile_index = 0, cell_count = 0;
    own_tiles own = {NO_TILE, NO_TILE};
    while (tile_index < s.tiling.tile_count) {
        group_barrier();
        if (get_local_id(0) == 0) shared[0] = atomic_inc(&head[STATE_TICKET]);
        group_barrier();
        tile_index = shared[0];
        group_barrier();
        if (tile_index < s.tiling.tile_count) {
            tile t = tile_locate(&s, tile_index);
            emit_counts sums = {0, 0, 0};
            for (uint z = ZEROS ? t.z1 : t.z0; z < t.z1; z += BRICK_PLANES)
                layer_sign(&s, t.y0, t.y1, z, samples, words, bricks, ranges, &head[STATE_NONFINITE], &for_sign);
            if (!ZEROS) halo_make(&s, t, samples, ranges, signs.scratch);
            group_barrier();
            for (uint z = t.z0; z < t.z1; z += BRICK_PLANES)
                layer_count(&s, t, z, signs, cells, ranges, offsets, triangle_offsets, &sums,
                            &tiles[TILE_WORDS * tile_index + TILE_BRICKS], &for_count);
            cell_count += sums.cells;
            if (get_local_id(0) == 0) {
                scan_post_sum(tiles, tile_index, TILE_VERTICES, sums.vertices);
                scan_post_sum(tiles, tile_index, TILE_TRIANGLES, sums.triangles);
            }
            if (SETTLES_LATER)
                own_append(&own, tile_index, tiles);
            else
                tile_complete(&s, tile_index, samples, cells, signs, active, head, tiles, shared);
        }
    }
    for (uint n = own.first; SETTLES_LATER && n != NO_TILE; n = tiles[TILE_WORDS * n + TILE_NEXT])
        tile_complete(&s, n, samples, cells, signs, active, head, tiles, shared);
    if (get_local_id(0) == 0 && cell_count) atomic_add(&head[STATE_ACTIVE_CELLS], cell_count);
}

#endif
