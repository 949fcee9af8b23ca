/* seeds_plot3d.c - Plot3D grids, alone and with solutions and functions; see seeds.h */
#include "seeds.h"

#include "plot3d_files.h"

void seeds_plot3d(void) {
    for (int n = 0; n < 4 * 2 * 2 * 2 * 5 * 2; n++) {
        variant v = {.encoding = n & 3,
                     .big = n >> 2 & 1,
                     .value_bytes = n >> 3 & 1 ? 8 : 4,
                     .iblank = n >> 4 & 1,
                     .blocks = n >> 5 & 1 ? 2 : 0,
                     .content = n >> 6};
        if (v.content > FUNCTION || (v.encoding == TEXT && (v.big || v.value_bytes == 8))) continue;
        char name[64];
        snprintf(name, sizeof name, "encoding-%d-big-%d-bytes-%d-iblank-%d-blocks-%d-content-%d", v.encoding, v.big,
                 v.value_bytes, v.iblank, v.blocks, v.content);
        bytes grid = grid_file(&v), data = {0};
        const char options[4] = {-1, -1, v.content == GRID_ONLY ? 4 : 0, 0};
        if (v.content != GRID_ONLY) data = data_file(&v);
        seed_file("plot3d", name, grid.data, grid.size, data.data, data.size, options);
        bytes_free(&grid);
        bytes_free(&data);
    }
}
