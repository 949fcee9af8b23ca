/*
 * tiles.cl - tiles of items that follow each other: taken by ticket, summed, and settled by the scan (scan.cl)
 *
 * The work-items of a group count a tile's items, one each at a time. The prefix sum within the tile is stored with the
 * item, the prefix sum over the tiles before with the tile.
 */
#ifndef TILES_CL
#define TILES_CL

#include "lanes.cl"
#include "scan.cl"

typedef struct tile_scan {
    uint spin_limit;
    global uint *tiles;
    local uint *shared; /* 2 words */
    local uint2 *sums;  /* one per work-item and one more */
} tile_scan;

/* Takes the group's next tile number. Called by the whole group. */
inline_always uint ticket_take(global uint *ticket, local uint *shared) {
    group_barrier();
    if (get_local_id(0) == 0) shared[0] = atomic_inc(ticket);
    group_barrier();
    uint tile_index = shared[0];
    group_barrier();
    return tile_index;
}

/* Returns *running plus the values of the work-items before this one; adds the values of all to *running. */
inline_always uint2 group_prefix(uint2 value, uint2 *running, local uint2 *sums) {
    if (WORK_ITEMS == 1) {
        *running += value;
        return *running - value;
    }
    sums[get_local_id(0)] = value;
    group_barrier();
    if (get_local_id(0) == 0) {
        uint2 sum = 0;
        for (uint n = 0; n <= WORK_ITEMS; n++) {
            uint2 own = n < WORK_ITEMS ? sums[n] : (uint2)0;
            sums[n] = sum;
            sum += own;
        }
    }
    group_barrier();
    uint2 before = *running + sums[get_local_id(0)];
    *running += sums[WORK_ITEMS];
    group_barrier();
    return before;
}

/* The sum over all tiles before a tile; valid once the last of them has posted its prefix. */
inline_always uint tile_before(global const uint *tiles, uint tile_index, uint sum_index) {
    return tile_index ? tiles[TILE_WORDS * (tile_index - 1) + sum_index] & SCAN_VALUE : 0;
}

inline_always void tile_post(tile_scan scan, uint tile_index, uint2 sums) {
    if (get_local_id(0) != 0) return;
    scan_post_sum(scan.tiles, tile_index, TILE_SUM_X, sums.x);
    scan_post_sum(scan.tiles, tile_index, TILE_SUM_Y, sums.y);
}

/* Looks back from a tile for the sum over all tiles before it. Where that is not complete, shared[1] - 1 is the tile
 * whose sum is not posted. */
inline_always bool tile_look_back(tile_scan scan, uint tile_index, uint sum_index, uint *prefix) {
    uint back = tile_index;
    bool done = scan_look_back(scan.tiles, sum_index, &back, prefix, scan.spin_limit);
    scan.shared[1] = back;
    return done;
}

/* Looks back from a tile whose sums are posted, and posts its prefix. Returns true when that is done; else tile
 * *unposted has to be recounted first. With spin_limit 1, which is for tests, the tile before is recounted every time.
 */
inline_always bool tile_settle(tile_scan scan, uint tile_index, bool look, uint *unposted) {
    bool done = false;
    group_barrier();
    if (get_local_id(0) == 0) {
        uint sum_x = 0, sum_y = 0;
        scan.shared[1] = tile_index;
        done = (look || scan.spin_limit > 1 || tile_index == 0) &&
               tile_look_back(scan, tile_index, TILE_SUM_X, &sum_x) &&
               tile_look_back(scan, tile_index, TILE_SUM_Y, &sum_y);
        if (done) {
            sum_x += scan_own_sum(scan.tiles, tile_index, TILE_SUM_X);
            sum_y += scan_own_sum(scan.tiles, tile_index, TILE_SUM_Y);
            scan_post_prefix(scan.tiles, tile_index, TILE_SUM_X, sum_x);
            scan_post_prefix(scan.tiles, tile_index, TILE_SUM_Y, sum_y);
        }
        scan.shared[0] = done;
    }
    group_barrier();
    done = scan.shared[0];
    *unposted = scan.shared[1] - 1;
    group_barrier();
    return done;
}

#endif
