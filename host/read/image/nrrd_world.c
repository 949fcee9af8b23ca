/*
 * nrrd_world.c - axes and world space of an NRRD header
 *
 * Source: "Definition of NRRD File Format", teem.sourceforge.net/nrrd/format.html, sections 3 to 6. "space directions"
 * and "space origin" place the first sample itself, whatever the centering. Without them the axes are scaled by
 * "spacings", and "axis mins" says where the first sample (node) or its cell's lower border (cell, the default) lies.
 * NaN is the format's word for what is not known or makes no sense.
 */
#include "image/nrrd_world.h"

#include "dataset/world.h"
#include "exit_status.h"
#include "failure.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Parses "(a,b,c)" or "(a,b,c,t)" at *text, which moves behind it. Returns the count of numbers; 0 where it is no such
 * vector. Either all or none of the numbers may be NaN. */
static int parse_vector(const char **text, double vector[3]) {
    const char *at = *text;
    int count = 0, unknown = 0;
    if (*at++ != '(') return 0;
    for (;;) {
        char *end;
        double value = strtod(at, &end);
        if (end == at || count == 4 || isinf(value)) return 0;
        if (count < 3) vector[count] = value;
        count++;
        unknown += isnan(value) != 0;
        at = end;
        while (isspace((unsigned char)*at)) at++;
        if (*at == ')') break;
        if (*at++ != ',') return 0;
    }
    if (unknown && unknown != count) return 0;
    for (int i = 0; unknown && i < 3; i++) vector[i] = NAN;
    *text = at + 1;
    return count;
}

int nrrd_vectors(const nrrd_header *h, const char *text, const char *field, double (*vectors)[3], int count) {
    const char *at = text;
    int n = 0;
    for (;;) {
        while (isspace((unsigned char)*at)) at++;
        if (!*at) break;
        if (n == count)
            return fail(STATUS_INPUT, "%s: '%s' has more vectors than the %d wanted", h->path, field, count);
        for (int i = 0; i < 3; i++) vectors[n][i] = 0;
        if (strncmp(at, "none", 4) == 0) {
            for (int i = 0; i < 3; i++) vectors[n][i] = NAN;
            at += 4;
        } else {
            int numbers = parse_vector(&at, vectors[n]);
            if (!numbers)
                return fail(STATUS_INPUT, "%s: '%s: %.80s' is no list of vectors (x,y,z)", h->path, field, text);
            if (numbers == 4 && vectors[n][0] == 0 && vectors[n][1] == 0 && vectors[n][2] == 0 && count > 1)
                for (int i = 0; i < 3; i++) vectors[n][i] = NAN; /* along time alone */
        }
        n++;
    }
    if (n != count) return fail(STATUS_INPUT, "%s: '%s' has %d vectors, not %d", h->path, field, n, count);
    return 0;
}

/* Where no axis has a direction, the first three are those of space, as in files without directions. ITK does so, too.
 */
void nrrd_settle_directions(nrrd_header *h, dataset *out) {
    int known = 0;
    for (int a = 0; a < h->dimension && h->has_directions; a++) known += !isnan(h->directions[a][0]);
    if (!h->has_directions || known) return;
    h->has_directions = 0;
    if (!h->has_spacings && !h->request->has_spacing)
        dataset_notice(out, "none of its space directions is known, the spacing is taken for 1");
}

/* Whether NaN spacings tell which of more than three axes, none with a kind, are not of space: three others are left.
 */
static int spacings_tell_space(const nrrd_header *h) {
    int spaced = 0;
    if (!h->has_spacings || h->has_directions || h->dimension <= 3) return 0;
    for (int a = 0; a < h->dimension; a++) {
        if (h->kinds[a] != KIND_UNKNOWN) return 0;
        spaced += !isnan(h->spacings[a]);
    }
    return spaced == 3;
}

static int is_outside(const nrrd_header *h, int axis) {
    if (h->has_directions) return isnan(h->directions[axis][0]) && (h->kinds[axis] != KIND_SPACE || h->dimension > 3);
    return spacings_tell_space(h) && isnan(h->spacings[axis]);
}

void nrrd_axes(const nrrd_header *h, axes *out) {
    int space = 0;
    *out = (axes){.count = h->dimension};
    for (int a = 0; a < h->dimension; a++) {
        out->size[a] = h->sizes[a];
        if (h->kinds[a] == KIND_COMPONENT)
            out->role[a] = AXIS_COMPONENT;
        else if (h->kinds[a] == KIND_TIME)
            out->role[a] = AXIS_FRAME;
        else if (is_outside(h, a)) /* the format does not say more; values vary fastest, volumes slowest */
            out->role[a] = a == 0 ? AXIS_COMPONENT : AXIS_FRAME;
        else
            out->role[a] = space++ < 3 ? AXIS_SPACE : AXIS_FRAME;
    }
}

/* Length of a step along axis a, where there are no directions; NaN where it is not known. */
static double axis_step(const nrrd_header *h, int a) {
    if (h->has_spacings && !isnan(h->spacings[a])) return h->spacings[a];
    if (!h->has_mins || !h->has_maxs) return h->has_spacings ? NAN : 1;
    int64_t steps = h->sizes[a] - (h->centers[a] == CENTER_NODE);
    return steps > 0 ? (h->maxs[a] - h->mins[a]) / (double)steps : 1;
}

/* Fills the column of an axis of one sample. Any direction will do that spans a volume with the columns before it: the
 * axis itself, or else the first one that none of them uses. */
static void complete_matrix(double matrix[3][4], int column) {
    int axis = column;
    for (int n = 0; n < 4; n++) {
        int tried = n ? n - 1 : column, is_free = 1;
        for (int c = 0; c < column; c++) is_free &= matrix[tried][c] == 0;
        if (!is_free) continue;
        axis = tried;
        break;
    }
    for (int r = 0; r < 3; r++) matrix[r][column] = r == axis;
}

/* Fills the matrix for one axis of space, which is axis a of the file. Without a direction it runs along its own axis.
 */
static void set_axis(const nrrd_header *h, int a, int space, dataset *out) {
    if (h->has_directions && !isnan(h->directions[a][0])) {
        for (int r = 0; r < 3; r++) out->blocks->matrix[r][space] = h->directions[a][r];
        return;
    }
    double step = h->has_directions ? NAN : axis_step(h, a), least = h->has_mins ? h->mins[a] : 0;
    if (isnan(step) && !h->request->has_spacing)
        dataset_notice(out, "the spacing along axis %d is not known (NaN), it is taken for 1", a + 1);
    if (isnan(least) && !h->request->has_origin)
        dataset_notice(out, "the minimum of axis %d is not known (NaN), its origin is taken for 0", a + 1);
    if (isnan(step)) step = 1;
    out->blocks->matrix[space][space] = step;
    if (h->has_mins && !h->has_directions && !isnan(least))
        out->blocks->matrix[space][3] = least + (h->centers[a] == CENTER_NODE ? 0 : step / 2);
}

int nrrd_matrix(const nrrd_header *h, const axes *a, dataset *out) {
    int space = 0;
    for (int i = 0; i < a->count; i++)
        if (a->role[i] == AXIS_SPACE) set_axis(h, i, space++, out);
    int is_known = h->has_origin && !isnan(h->origin[0]);
    for (int r = 0; r < 3 && is_known; r++) out->blocks->matrix[r][3] = h->origin[r];
    if (h->has_origin && !is_known && !h->request->has_origin)
        dataset_notice(out, "the space origin is not known (NaN), it is taken for 0");
    for (; space < 3; space++) complete_matrix(out->blocks->matrix, space);
    return world_complete(h->request, h->path, out->blocks->matrix);
}

void nrrd_units(nrrd_header *h, const char *text) {
    char first[sizeof h->units] = "";
    for (const char *at = strchr(text, '"'); at; at = strchr(at + 1, '"')) {
        const size_t length = strcspn(++at, "\"");
        if (length >= sizeof first || (length && *first && (strncmp(first, at, length) != 0 || first[length]))) return;
        if (length) snprintf(first, sizeof first, "%.*s", (int)length, at);
        at += length;
        if (!*at) break;
    }
    snprintf(h->units, sizeof h->units, "%s", first);
}

void nrrd_name_world(const nrrd_header *h, dataset *out) {
    static const struct {
        const char *world, *names;
    } spaces[] = {{"RAS", "|right-anterior-superior|RAS|right-anterior-superior-time|RAST|"},
                  {"LAS", "|left-anterior-superior|LAS|left-anterior-superior-time|LAST|"},
                  {"LPS", "|left-posterior-superior|LPS|left-posterior-superior-time|LPST|"}};
    snprintf(out->space, sizeof out->space, "%s", h->space);
    for (size_t n = 0; n < sizeof spaces / sizeof *spaces; n++)
        if (*h->space && names_have(spaces[n].names, h->space))
            snprintf(out->world, sizeof out->world, "%s", spaces[n].world);
    if (!h->request->has_spacing) dataset_set_units(out, h->units);
}
