/* seeds_grids.c - arguments of the library, as grid.c and cells.c take them apart; see seeds.h */
#include "seeds.h"

#include "read_files.h"

/* Every combination of what a grid may have, with samples of each type in turn. */
static void add_grid(int flags) {
    bytes b = {0};
    char name[32];
    int type = flags % 8;
    static const unsigned char how[8] = {0x83, 0x02, 0x83, 0x02,
                                         0x50, 0xf0, 0xd1, 0x02}; /* a complex too; snap, hybrid */
    bytes_put(&b, (uint64_t)flags, 1, 0);
    bytes_put(&b, how[flags % 8], 1, 0);
    bytes_put(&b, (uint64_t)type, 1, 0);
    for (int axis = 0; axis < 3; axis++) {
        static const unsigned char dims[3] = {5, 4, 3}, first[3] = {3, 0, 255};
        bytes_put(&b, dims[axis], flags & 32 ? 8 : 1, 0);
        bytes_put(&b, first[axis], flags & 32 ? 8 : 1, 0);
    }
    bytes_value(&b, TC_F64, test_value(type, 7), 0);
    bytes_value(&b, TC_F64, test_value(type, 30), 0);
    for (int n = 0; n < 12 && flags & 16; n++) bytes_value(&b, TC_F64, n % 5 == 0 ? -1.5 : 0.25, 0);
    for (int n = 0; n < 600; n++) bytes_put(&b, (uint64_t)(n * 37 % 101), 1, 0);
    snprintf(name, sizeof name, "flags-%d", flags);
    seed_write("grid", name, b.data, b.size);
    bytes_free(&b);
}

/* Two polyhedra, of a tetrahedron's faces and of a cube's, behind the others. */
static void add_faces(bytes *b, int flags, int cells, int points) {
    static const unsigned char faces[] = {0, 1, 2, 0, 1, 3, 3, 1, 2, 0, 2, 3, 0, 1, 3, 2, 4, 5,
                                          7, 6, 0, 1, 5, 4, 1, 3, 7, 5, 3, 2, 6, 7, 2, 0, 4, 6};
    uint64_t at = 0;
    for (int n = 0; n < cells; n++) {
        uint64_t count = n == cells - 2 ? 4 : n == cells - 1 ? 6 : 0;
        at += count;
        bytes_put(b, flags & 1 ? at : count, flags & 1 ? 8 : 1, 0);
    }
    if (flags & 1) bytes_put(b, 0, 8, 0);
    at = 0;
    for (int n = 0; n < 10; n++) {
        uint64_t count = n < 4 ? 3 : 4;
        at += count;
        bytes_put(b, flags & 1 ? at : count, flags & 1 ? 8 : 1, 0);
    }
    if (flags & 1) bytes_put(b, 0, 8, 0);
    for (size_t n = 0; n < sizeof faces; n++) bytes_put(b, (uint64_t)(faces[n] * 5 % points), flags & 2 ? 8 : 1, 0);
}

static void add_cells(int flags) {
    static const unsigned char types[] = {10, 12, 11, 13, 14, 24, 25, 5, 15, 16, 12, 42, 42},
                               counts[] = {4, 8, 8, 6, 5, 10, 20, 3, 10, 12, 20, 0, 0};
    enum { ALL_CELLS = sizeof types, POINTS = 40 };
    const int cells = flags & 64 ? ALL_CELLS : 8;
    bytes b = {0};
    char name[32];
    uint64_t links = 0;
    bytes_put(&b, (uint64_t)flags, 1, 0);
    bytes_put(&b, POINTS, 1, 0);
    bytes_put(&b, (uint64_t)cells, 1, 0);
    bytes_add(&b, types, (size_t)cells);
    for (int n = 0; n < POINTS && flags & 8; n++) bytes_put(&b, n == 33, 1, 0);
    for (int n = 0; n < cells && flags & 16; n++) bytes_put(&b, n == 3, 1, 0);
    for (int n = 0; n < cells; n++) {
        links += counts[n];
        bytes_put(&b, flags & 1 ? links : counts[n], flags & 1 ? 8 : 1, 0);
    }
    if (flags & 1) bytes_put(&b, 0, 8, 0);
    for (uint64_t n = 0; n < links; n++) bytes_put(&b, n * 7 % POINTS, flags & 2 ? 8 : 1, 0);
    for (int n = 0; n < 3 * POINTS; n++) {
        if (flags & 4)
            bytes_value(&b, TC_F32, test_value(TC_F32, (uint64_t)n), 0);
        else
            bytes_put(&b, (uint64_t)(n * 29 % 97), 1, 0);
    }
    if (flags & 64) add_faces(&b, flags, cells, POINTS);
    for (int n = 0; n < 4 * cells && flags & 32; n++) bytes_put(&b, (uint64_t)(n * 11 % POINTS), 4, 0);
    bytes_put(&b, TC_U8, 1, 0);
    bytes_put(&b, 0, 2, 0);
    bytes_value(&b, TC_F64, 50, 0);
    for (int n = 0; n < POINTS; n++) bytes_put(&b, (uint64_t)(n * 37 % 101), 1, 0);
    snprintf(name, sizeof name, "flags-%d", flags);
    seed_write("cells", name, b.data, b.size);
    bytes_free(&b);
}

void seeds_grids(void) {
    for (int flags = 0; flags < 256; flags++) {
        if (flags < 64) add_grid(flags);
        if (flags < 128 || flags % 64 == 0) add_cells(flags);
    }
}
