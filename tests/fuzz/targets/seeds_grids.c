/* seeds_grids.c - arguments of the library, as grid.c and cells.c take them apart; see seeds.h */
#include "seeds.h"

#include "read_files.h"

/* Every combination of what a grid may have, with samples of each type in turn. */
static void add_grid(int flags) {
    bytes b = {0};
    char name[32];
    int type = flags % 8;
    bytes_put(&b, (uint64_t)flags, 1, 0);
    bytes_put(&b, (uint64_t)(flags % 8 == 5 ? 0xf0 : flags & 1 ? 0x02 : 0x83), 1, 0); /* hybrid, or a complex too */
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

static void add_cells(int flags) {
    static const unsigned char types[] = {10, 12, 11, 13, 14, 24, 25, 5}, counts[] = {4, 8, 8, 6, 5, 10, 20, 3};
    enum { CELLS = 8, POINTS = 40 };
    bytes b = {0};
    char name[32];
    uint64_t links = 0;
    bytes_put(&b, (uint64_t)flags, 1, 0);
    bytes_put(&b, POINTS, 1, 0);
    bytes_put(&b, CELLS, 1, 0);
    bytes_add(&b, types, CELLS);
    for (int n = 0; n < POINTS && flags & 8; n++) bytes_put(&b, n == 33, 1, 0);
    for (int n = 0; n < CELLS && flags & 16; n++) bytes_put(&b, n == 3, 1, 0);
    for (int n = 0; n < CELLS; n++) {
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
    for (uint64_t n = 0; n < 4 * CELLS && flags & 32; n++) bytes_put(&b, n * 11 % POINTS, 4, 0);
    bytes_put(&b, TC_U8, 1, 0);
    bytes_put(&b, 0, 2, 0);
    bytes_value(&b, TC_F64, 50, 0);
    for (int n = 0; n < POINTS; n++) bytes_put(&b, (uint64_t)(n * 37 % 101), 1, 0);
    snprintf(name, sizeof name, "flags-%d", flags);
    seed_write("cells", name, b.data, b.size);
    bytes_free(&b);
}

void seeds_grids(void) {
    for (int flags = 0; flags < 64; flags++) {
        add_grid(flags);
        add_cells(flags);
    }
}
