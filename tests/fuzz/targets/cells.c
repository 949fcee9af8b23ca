/*
 * cells.c - unstructured cells and complexes of any kind: types, offsets, points and coordinates of any value
 *
 * All arrays are as large as the counts say, connectivity as large as the last offset.
 */
#include "bytes.h"
#include "check.h"
#include "hang.h"
#include "surface.h"

#include <math.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { LINKS_MOST = 1 << 12 };
enum {
    WIDE_OFFSETS = 1,
    WIDE_LINKS = 2,
    ANY_COORDINATES = 4,
    HAS_BLANKED = 8,
    HAS_BLANKED_CELLS = 16,
    RAW_TETRAHEDRA = 32,
    HAS_FACES = 64,
    SKIP_UNSUPPORTED = 128
};

/* Rising by small steps, or of any value but the last, which tells how large the connectivity is. */
static int64_t *take_offsets(bytes *b, uint64_t cell_count, int wide) {
    int64_t *offsets = malloc((cell_count + 1) * sizeof *offsets), at = 0;
    for (uint64_t n = 0; n <= cell_count; n++) {
        if (n) at = wide ? bytes_i64(b) : at + bytes_u8(b) % 32;
        offsets[n] = at;
    }
    if (wide) offsets[0] = bytes_i64(b);
    if (offsets[cell_count] > LINKS_MOST) offsets[cell_count] %= LINKS_MOST;
    return offsets;
}

static int64_t *take_links(bytes *b, int64_t count, uint64_t point_count, int wide) {
    int64_t *links = malloc((size_t)(count > 0 ? count : 0) * sizeof *links);
    for (int64_t n = 0; n < count; n++)
        links[n] = wide ? bytes_i64(b) : point_count ? (int64_t)(bytes_u8(b) % point_count) : 0;
    return links;
}

static float *take_points(bytes *b, uint64_t count, int any) {
    float *points = malloc(3 * count * sizeof *points);
    for (uint64_t n = 0; n < 3 * count; n++) {
        if (any)
            bytes_take(b, points + n, sizeof *points);
        else
            points[n] = (int8_t)bytes_u8(b) / 4.0f;
    }
    return points;
}

/* source, cells: of tetrahedra that were cut from cells; or NULL. */
static void extract(bytes *b, uint64_t point_count, const float *points, uint64_t tetrahedron_count,
                    const uint32_t *tetrahedra, const tc_cells *source, const uint32_t *cells) {
    tc_tetrahedra_grid_options o;
    tc_extract_options how;
    tc_grid *grid = NULL;
    tc_tetrahedra_grid_options_init(&o);
    tc_extract_options_init(&how);
    o.type = (tc_type)(bytes_u8(b) % (TC_F64 + 2));
    how.normals = bytes_u8(b) == 1;
    how.method = (tc_method)(bytes_u8(b) == 1);
    how.isovalue = bytes_f64(b);
    void *samples = bytes_array(b, point_count * tc_type_bytes(o.type));
    o.point_count = point_count;
    o.points = points;
    o.samples = samples;
    o.tetrahedron_count = tetrahedron_count;
    o.tetrahedra = tetrahedra;
    o.source = source;
    o.cells = cells;
    tc_status status = tc_tetrahedra_grid_create(surface_context(), &o, &grid);
    surface_check_status(status);
    CHECK((status == TC_OK) == (grid != NULL));
    if (grid) (void)surface_check(grid, &how, o.type, samples);
    tc_grid_destroy(grid);
    free(samples);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    hang_watch();
    bytes in = {data, size};
    uint8_t flags = bytes_u8(&in);
    uint64_t point_count = bytes_u8(&in), cell_count = bytes_u8(&in);
    tc_cells cells = {.struct_size = sizeof cells, .point_count = point_count, .cell_count = cell_count};
    uint8_t *types = bytes_array(&in, cell_count), *blanked = bytes_array(&in, flags & HAS_BLANKED ? point_count : 0);
    uint8_t *blanked_cells = bytes_array(&in, flags & HAS_BLANKED_CELLS ? cell_count : 0);
    int64_t *offsets = take_offsets(&in, cell_count, flags & WIDE_OFFSETS);
    int64_t *links = take_links(&in, offsets[cell_count], point_count, flags & WIDE_LINKS);
    float *points = take_points(&in, point_count, flags & ANY_COORDINATES);
    cells.types = types;
    cells.offsets = offsets;
    cells.connectivity = links;
    cells.points = points;
    cells.blanked_points = flags & HAS_BLANKED ? blanked : NULL;
    cells.blanked_cells = flags & HAS_BLANKED_CELLS ? blanked_cells : NULL;

    int64_t *starts = NULL, *face_offsets = NULL, *face_links = NULL;
    if (flags & HAS_FACES) {
        starts = take_offsets(&in, cell_count, flags & WIDE_OFFSETS);
        uint64_t face_count = starts[cell_count] > 0 ? (uint64_t)starts[cell_count] : 0;
        face_offsets = take_offsets(&in, face_count, flags & WIDE_OFFSETS);
        face_links = take_links(&in, face_offsets[face_count], point_count, flags & WIDE_LINKS);
    }
    cells.cell_faces = starts;
    cells.face_offsets = face_offsets;
    cells.face_connectivity = face_links;
    cells.skip_unsupported = flags & SKIP_UNSUPPORTED;

    tc_tetrahedra complex = {.struct_size = sizeof complex};
    tc_status status = tc_tetrahedralize(&cells, &complex);
    surface_check_status(status);
    if (status) CHECK(!complex.tetrahedra && !complex.cells && complex.tetrahedron_count == 0);
    surface_check_complex(&complex, point_count, cell_count);
    if (flags & RAW_TETRAHEDRA) {
        /* What tc_tetrahedralize would refuse is the caller's to keep from tc_tetrahedra_grid_create: points are finite
         * there.
         */
        for (uint64_t n = 0; n < 3 * point_count; n++)
            if (!(fabsf(points[n]) < 0x1p127f)) points[n] = 0;
        uint32_t *tetrahedra = bytes_array(&in, cell_count * 4 * sizeof *tetrahedra);
        extract(&in, point_count, points, cell_count, tetrahedra, NULL, NULL);
        free(tetrahedra);
    } else {
        extract(&in, point_count, points, complex.tetrahedron_count, complex.tetrahedra, status ? NULL : &cells,
                complex.cells);
    }
    tc_tetrahedra_release(&complex);
    free(face_links);
    free(face_offsets);
    free(starts);
    free(points);
    free(links);
    free(offsets);
    free(blanked_cells);
    free(blanked);
    free(types);
    return 0;
}
