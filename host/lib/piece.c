/*
 * The public calls for pieces of a grid: seams are checked and handed to the grid, for the length of the call.
 */
#include "base/structs.h"
#include "failure.h"
#include "grid/grid.h"
#include "grid/mesh.h"

#include <string.h>

uint64_t tc_seam_size(const tc_grid *grid) { return grid && !grid->complex ? grid_layer_bricks(grid) : 0; }

static tc_status seam_check(const tc_grid *grid, const void *seam, uint64_t seam_size, bool may_lack) {
    if (!grid || grid->complex)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "pieces are of structured grids: there is %s",
                               grid ? "a grid of tetrahedra" : "no grid");
    if (may_lack && !seam && seam_size == 0) return TC_OK;
    if (seam && (uintptr_t)seam % sizeof(uint32_t) == 0 && seam_size == tc_seam_size(grid)) return TC_OK;
    return (tc_status)fail(TC_ERROR_ARGUMENT, "the seam has %llu numbers, not the %llu of this grid, or is not aligned",
                           (unsigned long long)(seam ? seam_size : 0), (unsigned long long)tc_seam_size(grid));
}

tc_status tc_count_piece(tc_grid *grid, const tc_extract_options *options, tc_counts *counts, uint32_t *seam,
                         uint64_t seam_size) {
    tc_status status = struct_clear(counts, sizeof *counts, "tc_count_piece: counts");
    if (!status) status = seam_check(grid, seam, seam_size, false);
    if (status) return status;
    memset(seam, 0, (size_t)seam_size * sizeof *seam);
    grid->seams.own = seam;
    status = tc_count(grid, options, counts);
    grid->seams = (piece_seams){0};
    return status;
}

tc_status tc_extract_piece(tc_grid *grid, const tc_extract_options *options, const uint32_t *next_seam,
                           uint64_t seam_size, tc_mesh **mesh) {
    if (mesh && *mesh) mesh_clear(*mesh);
    tc_status status = seam_check(grid, next_seam, seam_size, true);
    if (!status && !next_seam == grid_has_seam(grid))
        status = (tc_status)fail(TC_ERROR_ARGUMENT, next_seam ? "the whole ends with this piece: it takes no seam"
                                                              : "the seam of the piece behind is needed");
    if (status) return status;
    grid->seams.next = next_seam;
    status = tc_extract(grid, options, mesh);
    grid->seams = (piece_seams){0};
    return status;
}
