/*
 * nrrd_world.c - axes and world space of an NRRD header
 *
 * Source: "Definition of NRRD File Format", teem.sourceforge.net/nrrd/format.html, sections 3 to 6. "space directions"
 * and "space origin" place the first sample itself, whatever the centering. Without them the axes are scaled by
 * "spacings", and "axis mins" says where the first sample (node) or its cell's lower border (cell, the default) lies.
 */
#include "nrrd.h"

#include "exit_status.h"
#include "failure.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One "(a,b,c)" or "(a,b,c,t)" at *text, which moves behind it. The count of numbers; 0 where it is none. */
static int parse_vector(const char **text, double vector[3]) {
    const char *at = *text;
    int count = 0;
    if (*at++ != '(') return 0;
    for (;;) {
        char *end;
        double value = strtod(at, &end);
        if (end == at || count == 4 || !isfinite(value)) return 0;
        if (count < 3) vector[count] = value;
        count++;
        at = end;
        while (isspace((unsigned char)*at)) at++;
        if (*at == ')') break;
        if (*at++ != ',') return 0;
    }
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

void nrrd_axes(const nrrd_header *h, axes *out) {
    int space = 0;
    *out = (axes){.count = h->dimension};
    for (int a = 0; a < h->dimension; a++) {
        int outside = h->has_directions && isnan(h->directions[a][0]);
        out->size[a] = h->sizes[a];
        if (h->kinds[a] == KIND_COMPONENT)
            out->role[a] = AXIS_COMPONENT;
        else if (h->kinds[a] == KIND_TIME)
            out->role[a] = AXIS_FRAME;
        else if (outside) /* the format does not say more; values vary fastest, volumes slowest */
            out->role[a] = a == 0 ? AXIS_COMPONENT : AXIS_FRAME;
        else
            out->role[a] = space++ < 3 ? AXIS_SPACE : AXIS_FRAME;
    }
}

/* Length of a step along axis a, where there are no directions. */
static double axis_step(const nrrd_header *h, int a) {
    if (h->has_spacings) return h->spacings[a];
    if (!h->has_mins || !h->has_maxs) return 1;
    int64_t steps = h->sizes[a] - (h->centers[a] == CENTER_NODE);
    return steps > 0 ? (h->maxs[a] - h->mins[a]) / (double)steps : 1;
}

int nrrd_matrix(const nrrd_header *h, const axes *a, double matrix[3][4]) {
    int space = 0;
    for (int i = 0; i < a->count; i++) {
        if (a->role[i] != AXIS_SPACE) continue;
        double step = axis_step(h, i);
        if (!h->has_directions && (!isfinite(step) || step == 0))
            return fail(STATUS_INPUT, "%s: the spacing along axis %d is %g; give a finite number other than 0", h->path,
                        i + 1, step);
        for (int r = 0; r < 3; r++) matrix[r][space] = h->has_directions ? h->directions[i][r] : r == space ? step : 0;
        if (h->has_mins && !h->has_directions)
            matrix[space][3] = h->mins[i] + (h->centers[i] == CENTER_NODE ? 0 : step / 2);
        space++;
    }
    for (int r = 0; r < 3 && h->has_origin; r++) matrix[r][3] = h->origin[r];
    if (space == 3) return matrix_check(h->path, matrix);
    for (; space < 3; space++) /* one sample: any direction does */
        for (int r = 0; r < 3; r++) matrix[r][space] = r == space;
    return 0;
}
