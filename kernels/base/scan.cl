/*
 * scan.cl - single-pass chained scan with decoupled look-back and fallback
 *
 * Every tile posts its sum, and later its inclusive prefix: its own sum and those of all tiles before it. It finds
 * these by looking back, adding sums until it meets a prefix. Value and state share one atomic word, so no fence is
 * needed. Tiles are taken by ticket, so all earlier tiles have been started. As a device may let a started group
 * starve, there is a fallback: after spin_limit polls the waiting group computes the missing sum itself. Where a group
 * is one thread of a CPU, which the system may suspend at any time, groups post the sums of all their tiles before they
 * look back for any.
 *
 * Merrill, Garland, "Single-pass Parallel Prefix Scan with Decoupled Look-back" (2016); fallback after Smith, Levien,
 * Owens, "Decoupled Fallback" (2025).
 */
#ifndef SCAN_CL
#define SCAN_CL

#include "common.cl"

#define SCAN_EMPTY  0u
#define SCAN_SUM    1u
#define SCAN_PREFIX 2u

inline_always uint scan_word(uint state, uint value) { return state << 30 | value; }

inline_always volatile global uint *scan_at(global uint *tiles, uint tile, uint sum_index) {
    return tiles + TILE_WORDS * tile + sum_index;
}

inline_always void scan_post_sum(global uint *tiles, uint tile, uint sum_index, uint sum) {
    atomic_cmpxchg(scan_at(tiles, tile, sum_index), scan_word(SCAN_EMPTY, 0), scan_word(SCAN_SUM, sum));
}

/* The sum that a group has posted for one of its own tiles. */
inline_always uint scan_own_sum(global uint *tiles, uint tile, uint sum_index) {
    return atomic_or(scan_at(tiles, tile, sum_index), 0u) & SCAN_VALUE;
}

inline_always void scan_post_prefix(global uint *tiles, uint tile, uint sum_index, uint prefix) {
    atomic_xchg(scan_at(tiles, tile, sum_index), scan_word(SCAN_PREFIX, prefix));
}

/* Walks back from *tile on, adding to *sum. Returns true when all tiles before are in the sum, false when tile
 * *tile - 1 has posted nothing within the limit of polls. */
inline_always bool scan_look_back(global uint *tiles, uint sum_index, uint *tile, uint *sum, uint spin_limit) {
    uint polls = 0;
    while (*tile > 0 && polls <= spin_limit) {
        uint word = atomic_or(scan_at(tiles, *tile - 1, sum_index), 0u);
        if (word >> 30 == SCAN_EMPTY) {
            polls++;
            continue;
        }
        *sum += word & SCAN_VALUE;
        *tile = word >> 30 == SCAN_PREFIX ? 0 : *tile - 1;
        polls = 0;
    }
    return *tile == 0;
}

/* To settle a tile: look back for the sums before it, post its prefix, then complete what the tile has stored. A
 * group that posts the sums of all its tiles before it settles any lists them, in the order in which it took them. */
#define SETTLES_LATER (WORK_ITEMS == 1)
#define NO_TILE       0xffffffffu

typedef struct own_tiles {
    uint first, last;
} own_tiles;

inline_always void own_append(own_tiles *own, uint tile_index, global uint *tiles) {
    if (own->first == NO_TILE)
        own->first = tile_index;
    else
        tiles[TILE_WORDS * own->last + TILE_NEXT] = tile_index;
    tiles[TILE_WORDS * tile_index + TILE_NEXT] = NO_TILE;
    own->last = tile_index;
}

#endif
