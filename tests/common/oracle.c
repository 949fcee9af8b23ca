#include "oracle.h"

#include "split.h"

#include <stdio.h>
#include <stdlib.h>

/* How often each key was seen: open addressing, 0 is an empty place. */
typedef struct tally {
    uint64_t *keys, mask;
    uint8_t *uses;
    uint64_t distinct;
} tally;

static void tally_open(tally *t, uint64_t most) {
    uint64_t places = 16;
    while (places < 2 * most) places *= 2;
    *t = (tally){calloc(places, sizeof *t->keys), places - 1, calloc(places, 1), 0};
    if (t->keys && t->uses) return;
    fprintf(stderr, "the oracle has no memory\n");
    exit(EXIT_FAILURE);
}

static void tally_close(tally *t) {
    free(t->keys);
    free(t->uses);
}

static void tally_add(tally *t, uint64_t key) {
    uint64_t place = (key * 0x9e3779b97f4a7c15u >> 20) & t->mask;
    while (t->keys[place] && t->keys[place] != key) place = (place + 1) & t->mask;
    t->distinct += !t->keys[place];
    t->keys[place] = key;
    t->uses[place]++;
}

static uint64_t tally_seen_once(const tally *t) {
    uint64_t count = 0;
    for (uint64_t n = 0; n <= t->mask; n++) count += t->uses[n] == 1;
    return count;
}

typedef struct cell {
    uint64_t samples[8];
    unsigned inside;
    bool present, odd;
} cell;

static cell cell_at(const int64_t dims[3], unsigned parity, const uint8_t *inside, const uint8_t *present, int64_t x,
                    int64_t y, int64_t z) {
    cell c = {.present = true, .odd = (parity + (uint64_t)(x + y + z)) & 1};
    for (unsigned n = 0; n < 8; n++) {
        int64_t sample = ((z + (n >> 2)) * dims[1] + y + (n >> 1 & 1)) * dims[0] + x + (n & 1);
        c.samples[n] = (uint64_t)sample;
        c.inside |= (unsigned)(inside[sample] != 0) << n;
        c.present = c.present && (!present || present[sample]);
    }
    return c;
}

/* The name of a set of samples of one cube that holds its least sample n: n, and which of the 27 neighbours of n. */
static uint64_t key_of(const cell *c, unsigned corners) {
    unsigned least = 0, key[3];
    while (!(corners >> least & 1)) least++;
    uint64_t set = 0;
    for (unsigned n = 0; n < 8; n++) {
        if (!(corners >> n & 1)) continue;
        for (unsigned axis = 0; axis < 3; axis++) key[axis] = 1 + (n >> axis & 1) - (least >> axis & 1);
        set |= UINT64_C(1) << (key[0] + 3 * key[1] + 9 * key[2]);
    }
    return c->samples[least] << 27 | set;
}

static void tetrahedron_tally(const cell *c, const unsigned corners[4], tally *edges, tally *faces) {
    unsigned all = 0;
    for (unsigned n = 0; n < 4; n++) all |= 1u << corners[n];
    for (unsigned n = 0; n < 4; n++) {
        unsigned face = all & ~(1u << corners[n]);
        if ((face & c->inside) && (face & ~c->inside)) tally_add(faces, key_of(c, face));
        for (unsigned m = 0; m < n; m++) {
            unsigned edge = 1u << corners[n] | 1u << corners[m];
            if ((edge & c->inside) && (edge & ~c->inside)) tally_add(edges, key_of(c, edge));
        }
    }
}

static uint64_t active_count(const int64_t dims[3], unsigned parity, const uint8_t *inside, const uint8_t *present) {
    uint64_t count = 0;
    for (int64_t z = 0; z + 1 < dims[2]; z++)
        for (int64_t y = 0; y + 1 < dims[1]; y++)
            for (int64_t x = 0; x + 1 < dims[0]; x++) {
                cell c = cell_at(dims, parity, inside, present, x, y, z);
                count += c.present && c.inside != 0 && c.inside != 255;
            }
    return count;
}

void oracle_count(const int64_t dims[3], unsigned parity, const uint8_t *inside, const uint8_t *present,
                  oracle_counts *counts) {
    tally edges, faces;
    int64_t polygons = 0;
    *counts = (oracle_counts){.active_cells = active_count(dims, parity, inside, present)};
    tally_open(&edges, 18 * counts->active_cells);
    tally_open(&faces, 16 * counts->active_cells);
    for (int64_t z = 0; z + 1 < dims[2]; z++)
        for (int64_t y = 0; y + 1 < dims[1]; y++)
            for (int64_t x = 0; x + 1 < dims[0]; x++) {
                cell c = cell_at(dims, parity, inside, present, x, y, z);
                for (unsigned t = 0; t < 5 && c.present; t++) {
                    unsigned corners[4];
                    split_tetrahedron(c.odd, t, corners);
                    unsigned triangles = split_triangle_count(split_inside_count(corners, c.inside));
                    counts->triangles += triangles;
                    polygons += triangles > 0;
                    if (triangles) tetrahedron_tally(&c, corners, &edges, &faces);
                }
            }
    counts->vertices = edges.distinct;
    counts->boundary_edges = tally_seen_once(&faces);
    counts->euler_characteristic = (int64_t)edges.distinct - (int64_t)faces.distinct + polygons;
    tally_close(&edges);
    tally_close(&faces);
}
