/*
 * vtk_legacy.c - VTK legacy files ("# vtk DataFile Version"), 1.0 to 5.1, ASCII and BINARY: images, rectilinear,
 * structured and unstructured grids
 *
 * Source: VTK's file formats document, and its vtkDataReader and descendants where that is silent: keywords in any
 * case, ASPECT_RATIO for SPACING, EXTENT for DIMENSIONS, BLANKING (0 hides a point), CELL_DATA of flat grids
 * with a cell per square. First comes the geometry, then attributes of points and cells; once these begin the geometry
 * is fixed, and each of its sections may appear once.
 */
#include "vtk_legacy/vtk_legacy.h"

#include "dataset/world.h"
#include "exit_status.h"
#include "failure.h"
#include "vtk_legacy/vtk_legacy_array.h"
#include "vtk_legacy/vtk_legacy_attributes.h"
#include "vtk_legacy/vtk_legacy_cells.h"
#include "vtk_legacy/vtk_legacy_text.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { NEWEST_MAJOR = 5, NEWEST_MINOR = 1 };

/* -------------------------------------------------------------------------------------------------------- header */

/* "3.0". Returns 0 where the text does not begin with two such numbers. */
static int parse_version(const char *text, int *major, int *minor) {
    char *end;
    *major = (int)strtoul(text, &end, 10);
    if (end == text || *end != '.') return 0;
    text = end + 1;
    *minor = (int)strtoul(text, &end, 10);
    return end != text && *major >= 0 && *minor >= 0;
}

static int read_version(legacy *r) {
    static const char magic[] = "# vtk DataFile Version";
    size_t length = sizeof magic - 1;
    int minor = 0;
    char number[16] = "";
    if (r->size < length || memcmp(r->bytes, magic, length))
        return legacy_fail(r, "does not begin with '%s'; it is no VTK legacy file", magic);
    r->at = length;
    for (size_t i = 0; i < sizeof number - 1 && r->at + i < r->size && r->bytes[r->at + i] != '\n'; i++)
        number[i] = (char)r->bytes[r->at + i];
    if (!parse_version(number, &r->major, &minor))
        return legacy_fail(r, "has no number of its version behind '%s'", magic);
    if (r->major > NEWEST_MAJOR || (r->major == NEWEST_MAJOR && minor > NEWEST_MINOR))
        dataset_notice(r->out, "its version %d.%d is newer than %d.%d, the last one known", r->major, minor,
                       NEWEST_MAJOR, NEWEST_MINOR);
    legacy_skip_line(r);
    return 0;
}

static int read_kind(legacy *r) {
    static const struct {
        const char *name;
        enum block_kind kind;
    } kinds[] = {{"STRUCTURED_POINTS", BLOCK_UNIFORM},
                 {"RECTILINEAR_GRID", BLOCK_RECTILINEAR},
                 {"STRUCTURED_GRID", BLOCK_CURVILINEAR},
                 {"UNSTRUCTURED_GRID", BLOCK_UNSTRUCTURED}};
    char word[LEGACY_WORD];
    int status = legacy_need(r, "DATASET", word);
    if (status) return status;
    if (strcasecmp(word, "DATASET")) return legacy_fail(r, "has '%.40s' where DATASET must be: it holds no grid", word);
    if ((status = legacy_need(r, "the kind of DATASET", word))) return status;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (!strcasecmp(word, kinds[i].name)) {
            r->block->kind = kinds[i].kind;
            return 0;
        }
    return legacy_fail(r,
                       "holds %s%.40s, which has no isosurface; STRUCTURED_POINTS, RECTILINEAR_GRID, "
                       "STRUCTURED_GRID and UNSTRUCTURED_GRID are read",
                       strcasecmp(word, "POLYDATA") ? "" : "a surface, ", word);
}

static int read_header(legacy *r) {
    char word[LEGACY_WORD];
    int status = read_version(r);
    if (status) return status;
    legacy_skip_line(r);
    if ((status = legacy_need(r, "ASCII or BINARY", word))) return status;
    if (strcasecmp(word, "ASCII") && strcasecmp(word, "BINARY"))
        return legacy_fail(r, "has '%.40s' where ASCII or BINARY must be", word);
    r->is_binary = !strcasecmp(word, "BINARY");
    return read_kind(r);
}

/* ------------------------------------------------------------------------------------------------------ geometry */

/* Coordinates in the precision of the file; integers of 32 bits and more become doubles. */
static int read_coordinates(legacy *r, const char *what, int64_t count, int64_t components, coordinates *out) {
    void *values = NULL;
    uint64_t unfit = 0;
    int type = 0, status = legacy_type(r, &type);
    if (status) return status;
    if (type >= LEGACY_STRING) return legacy_fail(r, "has texts for %s; numbers are needed", what);
    const int is_narrow = type == LEGACY_BIT || (type < SAMPLE_TYPE_COUNT && !type_is_wide((tc_type)type));
    const int wanted = is_narrow ? TC_F32 : TC_F64;
    if ((status = legacy_array(r, what, type, count, components, wanted, &values, &unfit))) return status;
    const int is_real = element_is_real(type); /* unfit integers are only rounded */
    if (unfit && is_real)
        return legacy_fail(r, "has %" PRIu64 " numbers in %s that are not finite; correct them", unfit, what);
    if (wanted == TC_F32)
        out->f32 = values;
    else
        out->f64 = values;
    return 0;
}

static int read_dimensions(legacy *r) {
    int status = 0;
    for (int a = 0; a < 3 && !status; a++) status = legacy_integer(r, "DIMENSIONS", 1, INT32_MAX, &r->block->dims[a]);
    return status;
}

static int read_extent(legacy *r) {
    int status = 0;
    for (int a = 0; a < 3 && !status; a++) {
        int64_t last = 0;
        if ((status = legacy_integer(r, "EXTENT", INT32_MIN, INT32_MAX, &r->block->first[a]))) break;
        status = legacy_integer(r, "EXTENT", r->block->first[a], INT32_MAX, &last);
        r->block->dims[a] = last - r->block->first[a] + 1;
    }
    return status;
}

static int read_three(legacy *r, const char *what, double values[3]) {
    int status = 0;
    for (int a = 0; a < 3 && !status; a++) status = legacy_number(r, what, &values[a]);
    return status;
}

static int read_spacing(legacy *r) { return read_three(r, "SPACING", r->spacing); }

static int read_origin(legacy *r) { return read_three(r, "ORIGIN", r->origin); }

static int read_axis(legacy *r, int axis) {
    static const char *const names[] = {"X_COORDINATES", "Y_COORDINATES", "Z_COORDINATES"};
    int status = legacy_integer(r, names[axis], 1, INT32_MAX, &r->axis_counts[axis]);
    return status ? status : read_coordinates(r, names[axis], r->axis_counts[axis], 1, &r->block->axes[axis]);
}

static int read_x(legacy *r) { return read_axis(r, 0); }

static int read_y(legacy *r) { return read_axis(r, 1); }

static int read_z(legacy *r) { return read_axis(r, 2); }

static int read_points(legacy *r) {
    int status = legacy_integer(r, "the number of POINTS", 0, INT64_MAX / 64, &r->block->point_count);
    return status ? status : read_coordinates(r, "POINTS", r->block->point_count, 3, &r->block->points);
}

static int read_blanking(legacy *r) {
    void *values = NULL;
    int type = 0, status;
    if ((status = legacy_integer(r, "BLANKING", 0, INT64_MAX / 64, &r->blanking_count)) ||
        (status = legacy_type(r, &type)))
        return status;
    if (type != TC_U8 && type != LEGACY_BIT)
        return legacy_fail(r, "has BLANKING that is neither unsigned_char nor bit");
    uint64_t unfit;
    if ((status = legacy_array(r, "BLANKING", type, r->blanking_count, 1, TC_U8, &values, &unfit))) return status;
    uint8_t *hidden = dataset_allocate(r->out, (uint64_t)r->blanking_count);
    if (!hidden) return STATUS_FAILED;
    for (int64_t i = 0; i < r->blanking_count; i++) hidden[i] = ((const uint8_t *)values)[i] == 0;
    return legacy_blank(r, 0, hidden, r->blanking_count, 1);
}

enum {
    IMAGES = 1 << BLOCK_UNIFORM,
    RECTILINEAR = 1 << BLOCK_RECTILINEAR,
    CURVILINEAR = 1 << BLOCK_CURVILINEAR,
    UNSTRUCTURED = 1 << BLOCK_UNSTRUCTURED,
    STRUCTURED = IMAGES | RECTILINEAR | CURVILINEAR
};

static const struct {
    const char *name;
    int (*read)(legacy *r);
    int kinds;
} sections[] = {{"DIMENSIONS", read_dimensions, STRUCTURED},
                {"EXTENT", read_extent, STRUCTURED},
                {"SPACING", read_spacing, IMAGES},
                {"ASPECT_RATIO", read_spacing, IMAGES},
                {"ORIGIN", read_origin, IMAGES},
                {"X_COORDINATES", read_x, RECTILINEAR},
                {"Y_COORDINATES", read_y, RECTILINEAR},
                {"Z_COORDINATES", read_z, RECTILINEAR},
                {"POINTS", read_points, CURVILINEAR | UNSTRUCTURED},
                {"BLANKING", read_blanking, CURVILINEAR},
                {"CELLS", legacy_cells, UNSTRUCTURED},
                {"CELL_TYPES", legacy_cell_types, UNSTRUCTURED}};

static int read_section(legacy *r, const char *keyword, int *known) {
    size_t count = sizeof sections / sizeof *sections, i = 0;
    while (i < count && (strcasecmp(keyword, sections[i].name) || !(sections[i].kinds >> r->block->kind & 1))) i++;
    *known = i < count;
    if (!*known) return 0;
    if (r->section != SECTION_GEOMETRY)
        return legacy_fail(r, "has %s behind the first POINT_DATA or CELL_DATA; it must stand before", keyword);
    if (r->seen >> i & 1) return legacy_fail(r, "has %s twice; one must go", keyword);
    r->seen |= 1u << i;
    return sections[i].read(r);
}

/* ---------------------------------------------------------------------------------- the whole, once it is read */

static int has_points(const dataset_block *b) { return b->points.f32 || b->points.f64; }

static int count_structured(legacy *r) {
    dataset_block *b = r->block;
    int64_t points = 1, cells = 1;
    if (!b->dims[0]) return legacy_fail(r, "has no DIMENSIONS of its grid");
    for (int a = 0; a < 3; a++) {
        if (__builtin_mul_overflow(points, b->dims[a], &points))
            return legacy_fail(r, "has DIMENSIONS of more than 2^63 points; it is damaged");
        if (b->dims[a] > 1) cells *= b->dims[a] - 1;
    }
    if (b->kind == BLOCK_CURVILINEAR && (!has_points(b) || b->point_count != points))
        return legacy_fail(r, "has %" PRId64 " POINTS, but DIMENSIONS of %" PRId64, b->point_count, points);
    b->point_count = points;
    b->cell_count = cells;
    return 0;
}

static int check_geometry(legacy *r) {
    dataset_block *b = r->block;
    if (b->kind == BLOCK_UNSTRUCTURED) return has_points(b) ? legacy_check_cells(r) : legacy_fail(r, "has no POINTS");
    int status = count_structured(r);
    if (status) return status;
    for (int a = 0; a < 3; a++) {
        b->matrix[a][a] = r->spacing[a]; /* of images alone, as the defaults are */
        b->matrix[a][3] = r->origin[a];
        if (b->kind == BLOCK_RECTILINEAR && r->axis_counts[a] != b->dims[a])
            return legacy_fail(r, "has %" PRId64 " coordinates along axis %d, but DIMENSIONS of %" PRId64 " there",
                               r->axis_counts[a], a + 1, b->dims[a]);
    }
    if (r->blanking_count && r->blanking_count != b->point_count)
        return legacy_fail(r, "has BLANKING of %" PRId64 " points, but %" PRId64 " points", r->blanking_count,
                           b->point_count);
    return b->kind == BLOCK_UNIFORM ? world_complete(r->request, r->path, b->matrix) : 0;
}

/* POINT_DATA and CELL_DATA, which end the geometry. */
static int begin_attributes(legacy *r, enum legacy_section section) {
    int64_t count = 0;
    int status = r->section == SECTION_GEOMETRY ? check_geometry(r) : 0;
    if (status ||
        (status = legacy_integer(r, section == SECTION_CELLS ? "CELL_DATA" : "POINT_DATA", 0, INT64_MAX / 16, &count)))
        return status;
    int64_t expected = section == SECTION_CELLS ? r->block->cell_count : r->block->point_count;
    if (count != expected)
        return legacy_fail(r, "has %s of %" PRId64 ", but %" PRId64 " %s",
                           section == SECTION_CELLS ? "CELL_DATA" : "POINT_DATA", count, expected,
                           section == SECTION_CELLS ? "cells" : "points");
    r->section = section;
    return 0;
}

static int read_keyword(legacy *r, const char *keyword) {
    int known = 0, status;
    if (!strcasecmp(keyword, "POINT_DATA")) return begin_attributes(r, SECTION_POINTS);
    if (!strcasecmp(keyword, "CELL_DATA")) return begin_attributes(r, SECTION_CELLS);
    status = read_section(r, keyword, &known);
    if (!status && !known) status = legacy_attribute(r, keyword, &known);
    if (!status && !known)
        status = legacy_fail(r,
                             "has '%.40s' where a keyword must be; what stands before may hold more values, or fewer, "
                             "than it says",
                             keyword);
    return status;
}

int vtk_legacy_read(const read_request *request, const mapping *file, dataset *out) {
    legacy r = {.request = request,
                .path = request->path,
                .bytes = file->bytes,
                .size = file->size,
                .out = out,
                .spacing = {1, 1, 1}};
    char keyword[LEGACY_WORD];
    int status = dataset_block_add(out, &r.block);
    if (status || (status = read_header(&r))) return status;
    snprintf(out->format, sizeof out->format, "VTK legacy");
    while (!(status = legacy_word(&r, keyword)) && *keyword)
        if ((status = read_keyword(&r, keyword))) return status;
    if (!status && r.section == SECTION_GEOMETRY) status = check_geometry(&r);
    r.block->blanked_points = r.blanked_points;
    r.block->blanked_cells = r.blanked_cells;
    return status;
}
