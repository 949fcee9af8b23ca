/* world.c - the matrix of a uniform grid; see world.h */
#include "dataset/world.h"

#include "exit_status.h"
#include "failure.h"

#include <math.h>

static double determinant(double m[3][4]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

static double step_length(double m[3][4], int axis) { return hypot(hypot(m[0][axis], m[1][axis]), m[2][axis]); }

static void set_spacing(double matrix[3][4], int axis, double spacing) {
    double length = step_length(matrix, axis);
    for (int r = 0; r < 3; r++)
        matrix[r][axis] = isnormal(length) ? matrix[r][axis] / length * spacing : r == axis ? spacing : 0;
}

int world_spans(double matrix[3][4]) {
    double spanned = determinant(matrix);
    int is_finite = isfinite(spanned);
    for (int n = 0; n < 12; n++) is_finite &= isfinite(matrix[n / 4][n % 4]) != 0;
    return is_finite && spanned != 0;
}

/* Cramer's rule. */
void world_index(double matrix[3][4], const double point[3], double index[3]) {
    for (int a = 0; a < 3; a++) {
        double replaced[3][4];
        for (int n = 0; n < 12; n++) {
            const int r = n / 4, c = n % 4;
            replaced[r][c] = c == a ? point[r] - matrix[r][3] : matrix[r][c];
        }
        index[a] = determinant(replaced) / determinant(matrix);
    }
}

int world_no_direction(const char *path, const char *name, int axis) {
    return fail(STATUS_INPUT,
                "%s: its %s has only zeros for axis %d, which then has no direction: correct it, or give --spacing",
                path, name, axis);
}

int world_complete(const read_request *request, const char *path, double matrix[3][4]) {
    for (int a = 0; a < 3 && request->has_spacing; a++) set_spacing(matrix, a, request->spacing[a]);
    for (int r = 0; r < 3 && request->has_origin; r++) matrix[r][3] = request->origin[r];

    for (int a = 0; a < 3; a++) {
        double length = step_length(matrix, a);
        if (!isfinite(length) || length == 0)
            return fail(
                STATUS_INPUT,
                "%s: its spacing along axis %d is %g, so that its axes do not span space; a finite number other "
                "than 0 is needed: correct it, or give --spacing",
                path, a + 1, length);
    }
    for (int r = 0; r < 3; r++)
        if (!isfinite(matrix[r][3]))
            return fail(STATUS_INPUT, "%s: its origin is not finite; correct it, or give --origin", path);
    if (world_spans(matrix)) return 0;
    return fail(STATUS_INPUT, "%s: its spacing and directions do not span space (determinant %g); correct them", path,
                determinant(matrix));
}
